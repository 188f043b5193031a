//! The bounding benchmark of thesis Figs. 33 and 34: one identification from each of 20 x 20 initial estimates.

use firmware::kalman::bounds::{Bounding, Estimator, Region};
use firmware::kalman::identify::identify;
use firmware::kalman::indentation::Indentation;
use firmware::search::Slice;
use firmware::surface::Surface;
use lut_gen::solid::contact::Ball;
use lut_gen::solid::model::Specimen;
use lut_gen::table::{ForceGrid, Form, GridSpec, LutError, write};
use protocol::lut::Table;

/// Feasible region of the benchmark: mu MPa, alpha.
pub const LOW: [f64; 2] = [0.005, 0.5];
/// Its upper corner.
pub const HIGH: [f64; 2] = [0.1, 24.0];

/// One benchmark: what is identified, and how.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Benchmark {
    /// True shear modulus, MPa.
    pub mu_mpa: f32,
    /// True exponent.
    pub alpha: f32,
    /// Samples of the press, evenly to 4 mm; 100 at 2 mm/s and 50 Hz.
    pub samples: u16,
    /// R of Eq. 20 as a standard deviation, N. The curve itself has no noise, as the thesis' reference data.
    pub error_n: f32,
    /// An identification succeeds if both parameters end within this fraction of the truth.
    pub tolerance: f32,
}

impl Benchmark {
    /// Near the edge of mu (5 % of its range away), and at the edge of what foams have for alpha: Fig. 33.
    ///
    /// The thesis gives neither the target nor R. Of 4,000 combinations of target, R (10 uN to 0.3 N), number of samples and tolerance,
    /// about 160 show its order at the edge; most do at a soft exponent. This one shows the order of both figures with the same R and tolerance.
    pub const EDGE: Self = Self { mu_mpa: 0.01, alpha: 1.0, samples: 100, error_n: 2e-4, tolerance: 0.05 };
    /// In the middle of the region: Fig. 34.
    pub const CENTRE: Self = Self { mu_mpa: 0.06, alpha: 12.25, ..Self::EDGE };
}

/// The boundings that are compared, in the order of the thesis, then the printed penalty and our own.
pub const BOUNDINGS: [(&str, Bounding); 5] = [
    ("projection", Bounding::Projection),
    ("penalty", Bounding::Penalty { coefficient: 0.5 }),
    ("nearest neighbour", Bounding::NearestNeighbour),
    ("penalty as printed", Bounding::PrintedPenalty { coefficient: 0.5 }),
    ("constrained", Bounding::Constrained { linearisations: 2 }),
];

/// The 20 x 20 initial estimates (mu MPa, alpha), evenly over the region, edges included.
#[must_use]
pub fn initial_estimates() -> Vec<[f32; 2]> {
    let at = |low: f64, high: f64, i: u32| (low + (high - low) * f64::from(i) / 19.0) as f32;
    (0..20).flat_map(|i| (0..20).map(move |j| [at(LOW[0], HIGH[0], i), at(LOW[1], HIGH[1], j)])).collect()
}

/// Bytes of a table over the region: 30 exponents, 200 depths to 4 mm, the thesis' ball on a 19.05 mm foam; ten finite-element solves.
///
/// # Errors
/// A failing solve.
pub fn table() -> Result<Vec<u8>, LutError> {
    let even = |i: usize, n: usize, k: usize| LOW[k] + (HIGH[k] - LOW[k]) * i as f64 / (n - 1) as f64;
    let spec = GridSpec {
        mu_mpa: (0..30).map(|i| even(i, 30, 0)).collect(),
        alpha: (0..30).map(|i| even(i, 30, 1)).collect(),
        ..GridSpec::thesis(Specimen::of_height(19.05), Ball { radius_mm: 4.0 })
    };
    let grid = ForceGrid::build(&spec, &|_, _| ())
        .map_err(|source| LutError::Material { name: "bounding benchmark".to_owned(), source })?;
    write(&[grid], Form::Factored, Vec::new())
}

/// Where an identification ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct End {
    /// Initial estimate: mu MPa, alpha.
    pub initial: [f32; 2],
    /// Last estimate, as the filter left it: nearest neighbour may leave it outside the region.
    pub estimate: [f32; 2],
    /// Both parameters are within the tolerance.
    pub success: bool,
}

/// Runs one benchmark with one bounding from every initial estimate. `None` if the table has no slice for it.
#[must_use]
pub fn run(table: &Table<'_>, benchmark: &Benchmark, bounding: Bounding, initial: &[[f32; 2]]) -> Option<Vec<End>> {
    let slice = Slice::nearest(table, 19.05, 2.0)?;
    let surface = Surface::new(table, &slice)?;
    let region = Region {
        low: nalgebra::Vector2::from(LOW.map(|x| x as f32)),
        high: nalgebra::Vector2::from(HIGH.map(|x| x as f32)),
    };
    let press: Option<Vec<(f32, f32)>> = (1..=benchmark.samples)
        .map(|i| 4.0 * f32::from(i) / f32::from(benchmark.samples))
        .map(|depth_mm| Some((depth_mm, surface.at(benchmark.mu_mpa, benchmark.alpha, depth_mm)?.force_n)))
        .collect();
    let (press, model) = (press?, Indentation { surface });
    let end = |initial: &[f32; 2]| {
        let mut estimator = Estimator::new(nalgebra::Vector2::from(*initial), region, bounding);
        identify(&mut estimator, &model, press.iter().copied(), benchmark.error_n * benchmark.error_n, 1);
        let estimate: [f32; 2] = estimator.filter.state.into();
        let near = |x: f32, truth: f32| (x / truth - 1.0).abs() <= benchmark.tolerance;
        let success = near(estimate[0], benchmark.mu_mpa) && near(estimate[1], benchmark.alpha);
        End { initial: *initial, estimate, success }
    };
    Some(initial.iter().map(end).collect())
}

/// Successful identifications of every bounding of [`BOUNDINGS`]. `None` as for [`run`].
#[must_use]
pub fn successes(table: &Table<'_>, benchmark: &Benchmark, initial: &[[f32; 2]]) -> Option<[usize; 5]> {
    let mut counts = [0; 5];
    for (count, (_, bounding)) in counts.iter_mut().zip(BOUNDINGS) {
        *count = run(table, benchmark, bounding, initial)?.iter().filter(|end| end.success).count();
    }
    Some(counts)
}
