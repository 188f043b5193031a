//! The finite elements against closed forms, as one list.

use super::confined::{ConfinedBlock, confined_stress_mpa, confining_stress_mpa};
use super::indented_layer::IndentedLayer;
use super::thin_layer::ThinLayer;
use crate::solid::law::{Hyperfoam, Term};
use crate::solid::solve::{Base, SolveError};

/// One comparison of the finite elements with a closed form.
#[derive(Debug, Clone, PartialEq)]
pub struct Check {
    /// What is compared.
    pub quantity: &'static str,
    /// Where the closed form is from.
    pub source: &'static str,
    /// Parameters.
    pub case: String,
    /// Largest difference over the case, relative to the closed form.
    pub error: f64,
    /// Largest difference allowed.
    pub tolerance: f64,
}

impl Check {
    /// Whether the difference is within the tolerance; no number is not.
    #[must_use]
    pub fn met(&self) -> bool {
        self.error <= self.tolerance
    }
}

/// All comparisons.
///
/// # Errors
/// The first [`SolveError`].
pub fn closed_forms() -> Result<Vec<Check>, SolveError> {
    let mut out = confined_compression()?;
    out.extend(thin_layer()?);
    Ok(out)
}

/// Confined compression to a stretch of 0.6. The state is homogeneous and within the elements' reach, so the
/// difference is rounding: 1e-10, for a stop at corrections of 1e-13 mm and sums over 80 forces.
///
/// # Errors
/// [`SolveError`].
pub fn confined_compression() -> Result<Vec<Check>, SolveError> {
    let one = |mu_mpa, alpha, nu| Term { mu_mpa, alpha, nu };
    let laws = [
        ("alpha 10.5, nu 0", vec![one(0.22, 10.5, 0.0)]),
        ("alpha 4, nu 0.3", vec![one(0.1, 4.0, 0.3)]),
        ("alpha 8 and -4, nu 0.2 and 0.1", vec![one(0.15, 8.0, 0.2), one(0.05, -4.0, 0.1)]),
    ];
    let mut out = Vec::new();
    for (name, terms) in laws {
        let law = Hyperfoam::new(terms)?;
        let mut error = 0.0_f64;
        for l in [0.6, 0.8, 0.95, 1.2] {
            let block = ConfinedBlock::solve(&law, l)?;
            let axial = confined_stress_mpa(&law, l);
            // without Poisson's effect nothing presses on the side: relative to the axial stress
            let radial = block.radial_mpa - confining_stress_mpa(&law, l);
            error = error.max((block.axial_mpa / axial - 1.0).abs()).max((radial / axial).abs()).max(block.stray_mm);
        }
        out.push(Check {
            quantity: "confined compression: stress on top and side, stretch 0.6 to 1.2",
            source: "thesis Eq. 1 at the stretches (l, 1, 1)",
            case: name.into(),
            error,
            tolerance: 1e-10,
        });
    }
    Ok(out)
}

/// A sphere on a thin layer at small strain, against the exact solution for `chi = sqrt(R d)/h` from 0.3 to 1 and
/// against Dimitriadis' series around `chi = 0.2`.
///
/// The finite elements differ from small strain by the order a/R (measured 0.2 a/R on the half-space, here
/// below 0.1 %), by the finite width (0.1 %, worst when sliding), and by the scatter of the contact edge between mesh
/// lines, `0.2 (element / contact radius)^2`, 0.1 % at `chi = 0.3` and 0.2 % at 0.2: in square, with the penalty's rest,
/// 0.25 %. Dimitriadis' series may differ by its own error more, which is its distance to the exact solution.
///
/// # Errors
/// [`SolveError`].
pub fn thin_layer() -> Result<Vec<Check>, SolveError> {
    const TOLERANCE: f64 = 2.5e-3;
    let cases = [
        (Base::Bonded, 0.0),
        (Base::Bonded, 0.3),
        (Base::Bonded, 0.45),
        (Base::Sliding, 0.0),
        (Base::Sliding, 0.3),
        (Base::Sliding, 0.45),
    ];
    let mut out = Vec::new();
    for (base, nu) in cases {
        let layer = ThinLayer { mu_mpa: 0.1, nu, height_mm: 1.0, base };
        let indented = IndentedLayer::of(layer, 1.0)?;
        let case = format!("{base:?}, nu {nu}").to_lowercase();
        let exact = |chi: f64, depth: f64, force: f64| {
            (chi >= 0.3).then(|| (force / layer.force_n(indented.radius_mm, depth) - 1.0).abs())
        };
        out.push(Check {
            quantity: "sphere on a thin layer, chi 0.3 to 1: force",
            source: "Lebedev and Ufliand, J. Appl. Math. Mech. 22, 1958, 442-450",
            case: case.clone(),
            error: indented.largest(exact),
            tolerance: TOLERANCE,
        });
        let published = |depth: f64| layer.dimitriadis_force_n(indented.radius_mm, depth);
        let near = |chi: f64| (0.17..0.23).contains(&chi);
        let own = indented.largest(|chi, depth, _| {
            near(chi).then(|| (layer.force_n(indented.radius_mm, depth) / published(depth) - 1.0).abs())
        });
        out.push(Check {
            quantity: "sphere on a thin layer, chi near 0.2: force",
            source: "Dimitriadis et al. 2002, doi:10.1016/S0006-3495(02)75620-8",
            case: format!("{case}; the series' own error is {:.2} %", 100.0 * own),
            error: indented.largest(|chi, depth, force| near(chi).then(|| (force / published(depth) - 1.0).abs())),
            tolerance: TOLERANCE + own,
        });
    }
    Ok(out)
}
