//! Is the minimum one? `cargo run --release -p tests --example brute [-- COUNT [SEED [NAME]]]`; only cases whose name holds NAME.
//!
//! Every experiment under `tests/experiments` whose recordings are there, and COUNT (200) random ones are identified; an independent search
//! (random points, simplexes, forces solved at every point) then looks for a lower value of the same objective. A fit passes within 0.1 %. A law
//! with a second term or a second relaxation must end no higher than the best of the simpler one in its own objective.

mod draw;
mod real;
mod search;

use std::time::Instant;

use lut_gen::solid::model::{ForceModel, Resolution};
use palpate::experiment::Experiment;
use palpate::identify::newton::condition::{Condition, Source};
use palpate::identify::newton::fit::Newton;
use palpate::identify::newton::problem::Problem;
use palpate::identify::spec::FitSpec;
use palpate::identify::{Identification, identify_from, materials};
use rand::SeedableRng;
use rand_pcg::Pcg64;
use rayon::prelude::*;

use search::{Effort, best, objective, simplex};

type Outcome<T> = Result<T, Box<dyn std::error::Error + Send + Sync>>;

/// Rise above the best that is found otherwise which a minimum may have.
const WITHIN: f64 = 1e-3;
/// Where a force costs next to nothing, and where it is solved.
const CHEAP: Effort = Effort { points: 60, followed: 4, evaluations: 300 };
const DEAR: Effort = Effort { points: 30, followed: 2, evaluations: 60 };

/// An experiment and how it is fitted.
pub struct Case {
    name: String,
    experiment: Experiment,
    spec: FitSpec,
    /// Force models by ball; none where forces are solved.
    models: Vec<ForceModel>,
    /// Made here, not recorded.
    hidden: bool,
}

/// What became of one material of a case.
struct Judged {
    line: String,
    passes: bool,
    nested: bool,
    converged: bool,
}

fn main() -> Outcome<()> {
    let mut arguments = std::env::args().skip(1);
    let count: usize = arguments.next().map_or(Ok(200), |text| text.parse())?;
    let seed: u64 = arguments.next().map_or(Ok(1), |text| text.parse())?;
    let only = arguments.next().unwrap_or_default();
    let models = if count > 0 { tests::recovery::models()? } else { Vec::new() };
    let mut all = real::cases()?;
    all.extend(draw::draw(seed, count, &models)?);
    all.retain(|case| case.name.contains(&only));
    let judged: Outcome<Vec<Vec<Judged>>> = all.par_iter().map(judge).collect();
    let judged: Vec<Judged> = judged?.into_iter().flatten().collect();
    let number = |of: &dyn Fn(&&Judged) -> bool| judged.iter().filter(of).count();
    println!("\n{} fits", judged.len());
    println!("within {:.1} % of the best known: {}", 100.0 * WITHIN, number(&|j| j.passes));
    println!("ended above the simpler law: {}", number(&|j| !j.nested));
    println!("told converged: {}, of these within: {}", number(&|j| j.converged), number(&|j| j.converged && j.passes));
    for judged in judged.iter().filter(|j| !j.passes || !j.nested) {
        println!("{}", judged.line);
    }
    Ok(())
}

fn fitted(case: &Case, material: &str, spec: &FitSpec) -> Outcome<Identification> {
    let source = |condition: &Condition| match condition.grip.indenter().and_then(|ball| case.models.get(ball)) {
        Some(model) => Source::Model(Box::new(model.clone())),
        None => Source::Solves(Resolution::Standard),
    };
    Ok(identify_from(&case.experiment, material, spec, &source)?)
}

fn judge(case: &Case) -> Outcome<Vec<Judged>> {
    materials(&case.experiment).iter().filter_map(|material| one(case, material).transpose()).collect()
}

fn one(case: &Case, material: &str) -> Outcome<Option<Judged>> {
    let begun = Instant::now();
    let found = fitted(case, material, &case.spec)?;
    let took_s = begun.elapsed().as_secs_f64();
    let Some(newton) = found.fit.as_ref().and_then(|fit| fit.newton.as_ref()) else {
        println!("{}, {material}: {}", case.name, found.outcome.word());
        return Ok(None);
    };
    let problem = newton.solved.on(&found.selection);
    let (value, rms_n) = objective(&problem, &newton.minimum.x);
    let is_dear = problem.conditions.iter().any(|c| matches!(c.source, Source::Solves(_)) && !c.is_homogeneous());
    let mut random =
        Pcg64::seed_from_u64(case.name.bytes().fold(7, |hash, byte| hash * 31 % 1_000_003 + u64::from(byte)));
    let (mut other, mut other_rms_n, mut point) = best(&problem, if is_dear { DEAR } else { CHEAP }, &mut random);
    // The same search from where the fit ended: a point beside it that is lower counts as well.
    let beside = simplex(&problem, &newton.minimum.x, 0.01, if is_dear { 60 } else { 200 });
    let (near, near_rms_n) = objective(&problem, &beside);
    if near < other {
        (other, other_rms_n, point) = (near, near_rms_n, beside);
    }
    let simpler = simpler(case, material, &problem)?;
    let nested = simpler.is_none_or(|simpler| value <= simpler * (1.0 + WITHIN));
    let passes = value <= other * (1.0 + WITHIN);
    let shown = |x: &[f64]| -> String {
        let all = problem.unknowns.iter().zip(x).map(|(u, x)| format!("{} {:.4}", u.name, u.value(*x)));
        all.collect::<Vec<_>>().join(", ")
    };
    let line = format!(
        "{} {}{}, {material}, {} terms {} relax {}, {:?}: objective {value:.4} (the fit's own {:.4}), otherwise {other:.4} ({:+.3} %), rms {rms_n:.4} and {other_rms_n:.4} N{}, {}, {} solves, {took_s:.1} s\n    found {}\n    other {}",
        if passes && nested { "ok  " } else { "FAIL" },
        if case.hidden { "simulated " } else { "" },
        case.name,
        found.law.word(),
        case.spec.resolved(&case.experiment, material).1,
        case.spec.relaxation,
        case.spec.loss,
        newton.minimum.at.value,
        100.0 * (value / other - 1.0),
        simpler.map_or(String::new(), |simpler| format!(", simpler law {simpler:.4}")),
        if newton.converged { "converged" } else { "not converged" },
        found.fe_solves,
        shown(&newton.minimum.x),
        shown(&point),
    );
    println!("{line}");
    Ok(Some(Judged { line, passes, nested, converged: newton.converged }))
}

/// The objective at the best of the law with one term, or one relaxation, less; `None` where there is no such law.
fn simpler(case: &Case, material: &str, problem: &Problem<'_>) -> Outcome<Option<f64>> {
    let (terms, relaxation) = (case.spec.resolved(&case.experiment, material).1, case.spec.relaxation);
    let spec = match (terms, relaxation) {
        (2, _) => FitSpec { terms: Some(1), ..case.spec.clone() },
        (_, 2) => FitSpec { relaxation: 1, ..case.spec.clone() },
        _ => return Ok(None),
    };
    let found = fitted(case, material, &spec)?;
    let Some(newton) = found.fit.as_ref().and_then(|fit| fit.newton.as_ref()) else { return Ok(None) };
    Ok(Some(objective(problem, &embedded(problem, newton)).0))
}

/// The point of a simpler law in a richer one's coordinates.
fn embedded(problem: &Problem<'_>, newton: &Newton) -> Vec<f64> {
    let of = |name: &str| {
        newton.solved.unknowns.iter().zip(&newton.minimum.x).find(|(u, _)| u.name == name).map(|(_, x)| *x)
    };
    let coordinate = |unknown: &palpate::identify::newton::coordinate::Unknown| {
        let nothing = match unknown.name.as_str() {
            "share_2" => Some(unknown.low),
            "g_2" | "k_2" => Some(0.0),
            _ => None,
        };
        let alone = unknown.name.replace("_1", "");
        of(&unknown.name)
            .or_else(|| of(&alone))
            .unwrap_or_else(|| unknown.coordinate(nothing.unwrap_or(unknown.start).clamp(unknown.low, unknown.high)))
    };
    problem.unknowns.iter().map(coordinate).collect()
}
