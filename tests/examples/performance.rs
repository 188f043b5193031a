//! Where the time of a solve goes, and what whole products cost: rewrites the marked section of
//! `docs/performance.md`. `cargo run --release -p tests --example performance`.

use std::fmt::Write as _;
use std::path::Path;
use std::time::Instant;

use lut_gen::solid::contact::{Ball, Interface};
use lut_gen::solid::law::{Hyperfoam, Material, Ogden, Parameter, PronyTerm};
use lut_gen::solid::mesh::BlockMesh;
use lut_gen::solid::model::{ForceModel, ModelSpec, Resolution, Simulation, Specimen, Watcher};
use lut_gen::solid::solve::{Accepted, Motion, Observer, SolveError, System};
use lut_gen::table::{ForceGrid, GridSpec};
use tests::document;

/// Repetitions of which the fastest counts: other jobs only ever slow a run down.
const REPEATS: usize = 15;

const BALL: Ball = Ball { radius_mm: 4.0 };

/// Fastest of some runs (s).
fn fastest<T>(repeats: usize, mut run: impl FnMut() -> T) -> f64 {
    (0..repeats)
        .map(|_| {
            let start = Instant::now();
            std::hint::black_box(run());
            start.elapsed().as_secs_f64()
        })
        .fold(f64::INFINITY, f64::min)
}

/// Times the parts of a correction at the last equilibrium of a path.
#[derive(Default)]
struct Parts {
    depth_mm: f64,
    unknowns: usize,
    evaluate: f64,
    assemble: f64,
    factorise: f64,
    solve: f64,
}

impl Observer for Parts {
    fn accepted(&mut self, at: &Accepted) -> Result<(), SolveError> {
        if at.station.depth_mm < self.depth_mm * (1.0 - 1e-9) {
            return Ok(());
        }
        let mut state = at.system.state();
        let mut matrix = at.system.matrix(true)?;
        let mut right = vec![1.0; at.system.unknowns()];
        self.unknowns = at.system.unknowns();
        self.evaluate = fastest(200, || at.system.evaluate(at.step, at.u, &mut state));
        self.assemble = fastest(200, || at.system.assemble(at.step, at.u, &mut state, &mut matrix));
        self.factorise = fastest(200, || matrix.factorise());
        self.solve = fastest(200, || matrix.correct(&mut right));
        Ok(())
    }
}

impl Watcher for Parts {
    fn begins(&mut self, _: &Simulation, _: &BlockMesh, _: f64, _: &System) -> Result<(), SolveError> {
        Ok(())
    }
    fn restarted(&mut self) {}
}

fn case(material: Material, friction: f64) -> Simulation {
    Simulation {
        material,
        specimen: Specimen::of_height(12.7),
        ball: BALL,
        interface: Interface { friction, adhesion: None },
        motion: Motion::ramp(4.0, 1.0),
        resolution: Resolution::Standard,
    }
}

fn parts(out: &mut String) -> Result<(), Box<dyn std::error::Error>> {
    let eva = case(Hyperfoam::one_term(0.22, 10.526)?.into(), 0.0);
    let mut parts = Parts { depth_mm: 4.0, ..Parts::default() };
    let record = eva.watch(&mut parts)?;
    let whole = fastest(REPEATS, || eva.solve());
    let corrections = record.iterations as f64;
    let factors = record.factorisations as f64;
    writeln!(
        out,
        "One curve: EVA, ball 4 mm, 4 mm deep, {} unknowns, {} steps; fastest of {REPEATS}.\n",
        parts.unknowns,
        record.stations.len()
    )?;
    writeln!(out, "| part | calls | us a call | ms | share |\n|---|---|---|---|---|")?;
    let rows = [
        ("residual (material points, contact)", corrections + record.stations.len() as f64, parts.evaluate),
        ("residual and tangent, assembled", factors, parts.assemble),
        ("Cholesky factor", factors, parts.factorise),
        ("solution with the factor", corrections + factors, parts.solve),
    ];
    let mut rest = whole;
    for (name, calls, each) in rows {
        rest -= calls * each;
        writeln!(
            out,
            "| {name} | {calls:.0} | {:.0} | {:.0} | {:.0} % |",
            1e6 * each,
            1e3 * calls * each,
            100.0 * calls * each / whole
        )?;
    }
    writeln!(
        out,
        "| the rest: mesh, symbolic analysis, copies | | | {:.0} | {:.0} % |",
        1e3 * rest,
        100.0 * rest / whole
    )?;
    writeln!(out, "| **whole** | | | **{:.0}** | |\n", 1e3 * whole)?;
    Ok(())
}

fn products(out: &mut String) -> Result<(), Box<dyn std::error::Error>> {
    writeln!(out, "| product | time |\n|---|---|")?;
    let mut row = |name: &str, seconds: f64| {
        let time = if seconds < 1e-3 { format!("{:.2} us", 1e6 * seconds) } else { format!("{seconds:.3} s") };
        writeln!(out, "| {name} | {time} |")
    };
    let foam = || Hyperfoam::one_term(0.22, 10.526);
    let series = vec![PronyTerm { g: 0.4, k: 0.2, tau_s: 1.0 }];
    let eva = case(foam()?.into(), 0.0);
    row("curve, EVA 4 mm, with the smooth profile", fastest(REPEATS, || eva.curve(&[4.0])))?;
    let quick = Simulation { resolution: Resolution::Refined(0.8), ..eva.clone() };
    row("the same with elements larger by 1.25 (error below 0.5 %)", fastest(REPEATS, || quick.curve(&[4.0])))?;
    let rubbing = case(foam()?.into(), 0.3);
    row("curve with friction 0.3", fastest(5, || rubbing.curve(&[4.0])))?;
    let relaxing = case(Material::from(foam()?).relaxing(series.clone())?, 0.0);
    row("curve of a relaxing foam, g and k apart", fastest(5, || relaxing.curve(&[4.0])))?;
    let liver = case(Material::from(Ogden::one_term(0.02, 6.0, 5.0)?).relaxing(series.clone())?, 0.0);
    row("curve of a relaxing Ogden solid", fastest(5, || liver.curve(&[4.0])))?;
    let by = [Parameter::Mu(0), Parameter::Alpha(0), Parameter::Nu(0), Parameter::Height];
    row("EVA with its derivatives by mu, alpha, nu and height", fastest(5, || eva.sensitivities(&by)))?;
    let spec = GridSpec::thesis(Specimen::of_height(12.7), BALL);
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let table = fastest(3, || ForceGrid::build(&spec, &|_, _| ()));
    row(&format!("30 x 30 x 200 table with its error bound, {threads} cores"), table)?;
    let three = fastest(2, || {
        [1.0, 2.0, 4.0].map(|rate_mm_s| {
            let spec = GridSpec { relaxation: series.clone(), rate_mm_s, ..spec.clone() };
            ForceGrid::build(&spec, &|_, _| ()).map(|g| g.solves)
        })
    });
    row(&format!("three of them, at 1, 2 and 4 mm/s, of relaxing foams, {threads} cores"), three)?;
    let model = ForceModel::build(&ModelSpec::new(Specimen::of_height(12.7), BALL, 4.0), &|_, _| ())?;
    let many = fastest(20, || {
        (0..1000)
            .map(|i| model.gradient(0.2, 2.0 + 0.02 * f64::from(i), 0.5 + 0.003 * f64::from(i)).d_alpha)
            .sum::<f64>()
    });
    row("continuous model, force and all derivatives", many / 1000.0)?;
    Ok(())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut out = String::new();
    parts(&mut out)?;
    products(&mut out)?;
    println!("{out}");
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/performance.md");
    let text = document::replace_section(&std::fs::read_to_string(&path)?, "where the time goes", &out)?;
    std::fs::write(&path, text)?;
    println!("wrote {}", path.display());
    Ok(())
}
