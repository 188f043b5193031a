//! Magnets beside those of another solver and of a closed form.

mod designs;

use std::path::Path;

use lut_gen::magnet::design::{Design, Edge, OutOfPlane};
use lut_gen::magnet::study::{Flux, State, Wanted};

pub use designs::{arrangement, c_core, cylinder, law, pot_a, ring_a, rows};

/// What was compared, with its largest difference.
#[derive(Debug, Clone, PartialEq)]
pub struct Compared {
    /// File or problem of the reference.
    pub reference: String,
    /// What of it.
    pub what: String,
    /// Largest difference.
    pub error: f64,
    /// What it may be.
    pub allowed: f64,
    /// Unit of both: a part of the value, T, or parts of what is allowed.
    pub unit: &'static str,
    /// Equations of the mesh.
    pub unknowns: usize,
}

impl Compared {
    /// True when the reference is met.
    #[must_use]
    pub fn is_met(&self) -> bool {
        self.error < self.allowed
    }
}

/// What a comparison may fail with.
pub type Failure = Box<dyn std::error::Error>;

/// The references' folder, with the tables of the materials in it.
#[derive(Debug, Clone, Copy)]
pub struct Shared<'a>(pub &'a Path);

impl Shared<'_> {
    fn read(self, name: &str) -> Result<String, Failure> {
        Ok(std::fs::read_to_string(self.0.join("reference/display").join(name))?)
    }

    fn table(self, name: &str) -> Result<lut_gen::magnet::bh::Law, Failure> {
        Ok(law(&std::fs::read_to_string(self.0.join("data/bh_tables").join(name))?)?)
    }
}

/// All comparisons.
///
/// # Errors
/// A file that is absent, a field that cannot be found.
pub fn all(shared: Shared<'_>) -> Result<Vec<Compared>, Failure> {
    let mut list = ring(shared, true)?;
    list.extend(ring(shared, false)?);
    list.extend(pot(shared)?);
    for name in ["pm_a", "pm_b", "pm_c", "pm_d"] {
        list.push(permanent(shared, name)?);
    }
    for edge in CYLINDER_ENDS {
        list.push(magnetised(shared, edge)?);
    }
    list.extend(c_cores()?);
    list.extend(finite_depth(shared)?);
    Ok(list)
}

fn solved(design: &Design, points: &[[f64; 2]], currents: &[f64]) -> Result<(Vec<State>, usize), Failure> {
    let wanted = Wanted { points: points.to_vec(), coarser: 1.0, ..Wanted::default() };
    let study = design.study(&wanted, currents, &mut |_| {})?;
    Ok((study.states, study.field.unknowns()))
}

/// `ring_A.csv` and `ring_A_noprobe.csv`: centre, all points, linkage.
///
/// # Errors
/// As [`all`].
pub fn ring(shared: Shared<'_>, probe: bool) -> Result<Vec<Compared>, Failure> {
    let name = if probe { "ring_A" } else { "ring_A_noprobe" };
    let rows = rows(&shared.read(&format!("{name}.csv"))?);
    let design = ring_a(shared.table("1018_Steel.csv")?, probe);
    let across = [0.0, 0.25, 0.9, 2.0, 3.0, 4.0].map(|x| [x, 17.0]);
    let along = [-3.0, -1.5, 1.5, 3.0, 4.0].map(|y| [0.0, 17.0 + y]);
    let points: Vec<[f64; 2]> = across.into_iter().chain(along).chain([[0.0, -17.0]]).collect();
    let currents: Vec<f64> = rows.iter().map(|row| row[0]).collect();
    let (states, unknowns) = solved(&design, &points, &currents)?;
    let (mut centre, mut linkage, mut worst) = (0.0_f64, 0.0_f64, 0.0_f64);
    for (state, row) in states.iter().zip(&rows) {
        let found: Vec<f64> = state.points.iter().map(|flux| flux.size_t()).collect();
        centre = centre.max((found[0] / row[1] - 1.0).abs());
        linkage = linkage.max((state.linkage_wb[0].value / row[13] - 1.0).abs());
        for (b, r) in found.iter().zip(&row[1..13]) {
            // The reference's own uncertainty, and a thousandth of the centre.
            worst = worst.max((b - r).abs() / (6e-4 * r + 1e-3 * row[1]));
        }
    }
    let compared = |what: &str, error, allowed, unit| Compared {
        reference: name.to_owned(),
        what: what.to_owned(),
        error,
        allowed,
        unit,
        unknowns,
    };
    Ok(vec![
        compared("flux density at the centre, 16 currents", centre, if probe { 3e-4 } else { 1e-3 }, "of it"),
        compared("flux linkage, 16 currents", linkage, 1e-3, "of it"),
        compared("flux density at 12 points, 16 currents", worst, 1.0, "of what is allowed"),
    ])
}

/// Points of the pot magnet that are read, (r, z) in mm.
const POT: [[f64; 2]; 7] = [[0.05, 1.0], [0.05, 2.5], [3.0, 2.5], [8.5, 2.5], [12.5, 2.5], [8.5, 1.0], [0.05, -8.0]];

/// The pot magnet, beside `pot_A.csv` from 1 A on, and beside NGSolve with resolved corners below.
///
/// Each point of the file may be off by the file's uncertainty and a thousandth of the centre. Below 1 A, where the steel is
/// far from saturation, the file's meshes miss more than that at the corners: `bench/versus-ngsolve/pot.py` resolves them.
///
/// # Errors
/// As [`all`].
pub fn pot(shared: Shared<'_>) -> Result<Vec<Compared>, Failure> {
    // Uncertainty of each column as the file's head says, as a part.
    const UNCERTAIN: [f64; 7] = [0.002_093, 0.001_161, 0.000_136, 0.001_087, 0.000_533, 0.0015, 0.001_525];
    const RESOLVED: &str = include_str!("../../../bench/versus-ngsolve/pot.csv");
    let file = rows(&shared.read("pot_A.csv")?);
    let resolved = rows(RESOLVED);
    let currents: Vec<f64> = file.iter().map(|row| row[0]).collect();
    let (states, unknowns) = solved(&pot_a(shared.table("1018_Steel.csv")?), &POT, &currents)?;
    let found = |state: &State| -> Vec<f64> {
        let size = |(i, flux): (usize, &Flux)| if i == 6 { flux.b_t[1].abs() } else { flux.size_t() };
        state.points.iter().enumerate().map(size).collect()
    };
    let (mut from_1_a, mut below, mut corners) = (0.0_f64, 0.0_f64, 0.0_f64);
    for (state, row) in states.iter().zip(&file) {
        let found = found(state);
        let share = |i: usize| (found[i] - row[1 + i]).abs() / (UNCERTAIN[i] * row[1 + i] + 1e-3 * row[2]);
        let worst = (0..7).map(share).fold(0.0, f64::max);
        if state.ampere < 1.0 {
            below = below.max(worst)
        } else {
            from_1_a = from_1_a.max(worst)
        }
        for own in resolved.iter().filter(|own| own[0] == state.ampere) {
            let off = (2..7).map(|i| (found[i] / own[i - 1] - 1.0).abs()).fold(0.0, f64::max);
            corners = corners.max(off);
        }
    }
    let compared = |reference: &str, what: &str, error, allowed, unit| Compared {
        reference: reference.to_owned(),
        what: what.to_owned(),
        error,
        allowed,
        unit,
        unknowns,
    };
    let what =
        format!("flux density at 7 points, 1 to 4 A (below 1 A: {below:.1} of what is allowed, see the next row)");
    Ok(vec![
        compared("pot_A", &what, from_1_a, 1.0, "of what is allowed"),
        compared("pot magnet, NGSolve", "flux density at 5 points, 0.25 to 1 A", corners, 5e-4, "of it"),
    ])
}

/// One of `pm_a.csv` to `pm_d.csv`: the vector of flux density along two lines.
///
/// # Errors
/// As [`all`], and a head that is no arrangement.
pub fn permanent(shared: Shared<'_>, name: &str) -> Result<Compared, Failure> {
    let text = shared.read(&format!("{name}.csv"))?;
    let (alnico, steel) = (shared.table("Alnico_5.csv")?, shared.table("1018_Steel.csv")?);
    let design = arrangement(&text, &alnico, &steel).ok_or_else(|| format!("{name}: its head is no arrangement"))?;
    let rows = rows(&text);
    let points: Vec<[f64; 2]> = rows.iter().flat_map(|row| [[row[0], 0.02], [row[0], 2.0]]).collect();
    let (states, unknowns) = solved(&design, &points, &[0.0])?;
    let mut error = 0.0_f64;
    for (pair, row) in states[0].points.chunks(2).zip(&rows) {
        for (flux, at) in pair.iter().zip([1, 5]) {
            error = error.max((flux.b_t[0] - row[at]).hypot(flux.b_t[1] - row[at + 1]));
        }
    }
    let what = format!("flux density, {} points", points.len());
    Ok(Compared { reference: name.to_owned(), what, error, allowed: 2e-4, unit: "T", unknowns })
}

/// Where the magnetised cylinder's field ends: in a box so large that it does not matter, and nowhere.
pub const CYLINDER_ENDS: [Edge; 2] = [Edge::Box { half: 240.0 }, Edge::Open];

/// `linear_cylinder.csv`: a closed form.
///
/// # Errors
/// As [`all`].
pub fn magnetised(shared: Shared<'_>, edge: Edge) -> Result<Compared, Failure> {
    let rows = rows(&shared.read("linear_cylinder.csv")?);
    let points: Vec<[f64; 2]> = rows.iter().map(|row| [row[0], row[1]]).collect();
    let (states, unknowns) = solved(&Design { edge, ..cylinder() }, &points, &[0.0])?;
    let off = |(flux, row): (&Flux, &Vec<f64>)| (flux.b_t[1] - row[2]).abs().max((flux.b_t[0] - row[3]).abs());
    let error = states[0].points.iter().zip(&rows).map(off).fold(0.0, f64::max);
    let end = if edge == Edge::Open { "open boundary" } else { "box of 240 mm" };
    let what = format!("flux density, {} points, {end}", points.len());
    Ok(Compared { reference: "linear_cylinder".to_owned(), what, error, allowed: 1e-4, unit: "T", unknowns })
}

/// Flux densities of the linear C-core at 1 A by the references' README: gap (mm), by finite elements (T), by a reluctance
/// without fringing (T).
const C_CORES: [(f64, f64, f64); 4] =
    [(1.0, 0.8377, 0.8750), (2.0, 0.4420, 0.4597), (4.0, 0.2270, 0.2358), (10.0, 0.0860, 0.0958)];

/// What a gap leaks beside itself: the linear C-core.
///
/// # Errors
/// As [`all`].
pub fn c_cores() -> Result<Vec<Compared>, Failure> {
    let mut list = Vec::new();
    for (gap, reference, without_fringing) in C_CORES {
        let (states, unknowns) = solved(&c_core(gap), &[[0.0, 17.0]], &[1.0])?;
        let found = states[0].points[0].size_t();
        list.push(Compared {
            reference: format!("C-core, gap {gap} mm"),
            what: format!(
                "flux density at the centre, {:.1} % under no fringing",
                100.0 * (1.0 - found / without_fringing)
            ),
            error: (found / reference - 1.0).abs(),
            allowed: 3e-3,
            unit: "of it",
            unknowns,
        });
    }
    Ok(list)
}

/// The ring of finite depth, beside magnetostatics in three dimensions (`bench/versus-ngsolve/depth.py`): 6 to 48 mm.
///
/// # Errors
/// As [`all`].
pub fn finite_depth(shared: Shared<'_>) -> Result<Vec<Compared>, Failure> {
    const DEEP: &str = include_str!("../../../bench/versus-ngsolve/depth.csv");
    let deep = rows(DEEP);
    let mut list = Vec::new();
    for depth in [6.0, 12.0, 24.0, 48.0] {
        // Gap 10, radii 14 and 20, with a probe, steel and fluid.
        let own: Vec<&Vec<f64>> =
            deep.iter().filter(|r| r[..6] == [depth, 10.0, 14.0, 20.0, 1.0, 0.0] && r[6] == 1.0).collect();
        let mut design = ring_a(shared.table("1018_Steel.csv")?, true);
        design.depth_mm = depth;
        design.out_of_plane = Some(OutOfPlane { mean_radius_mm: 17.0, width_mm: 6.0, gap_mm: 10.0 });
        let currents: Vec<f64> = own.iter().map(|row| row[7]).collect();
        let (states, unknowns) = solved(&design, &[[0.0, 17.0]], &currents)?;
        let off = |(state, row): (&State, &&Vec<f64>)| (state.points[0].size_t() / row[8] - 1.0).abs();
        let error = states.iter().zip(&own).map(off).fold(0.0, f64::max);
        list.push(Compared {
            reference: format!("ring, {depth} mm deep, NGSolve in 3-D"),
            what: format!("flux density at the centre, {} currents", own.len()),
            error,
            allowed: 0.035,
            unit: "of it",
            unknowns,
        });
    }
    Ok(list)
}

/// The comparisons as the table of docs/verification.md.
#[must_use]
pub fn table(compared: &[Compared]) -> String {
    let figure = |value: f64| if value < 0.1 { format!("{value:.1e}") } else { format!("{value:.2}") };
    let row = |c: &Compared| {
        let verdict = if c.is_met() { "met" } else { "MISSED" };
        let (error, allowed) = (figure(c.error), figure(c.allowed));
        [&c.reference, &c.what, &error, &allowed, c.unit, &c.unknowns.to_string(), verdict].map(str::to_owned).to_vec()
    };
    let head = ["reference", "what", "largest difference", "allowed", "unit", "equations", ""];
    crate::document::table(&head, &compared.iter().map(row).collect::<Vec<_>>())
}
