//! A Kalman filter over one press, with the bounding of choice, and the material that its curve is nearest to (thesis
//! sections 3.2.5 and 3.4, Table 4).

use firmware::kalman::bounds::{Bounding, Estimator, Region};
use firmware::kalman::identify::identify;
use firmware::kalman::indentation::Indentation;
use firmware::search::Slice;
use firmware::surface::Surface;
use nalgebra::Vector3;
use protocol::lut::Table;

/// The thesis' three boundings, and the board's own: word and what it is.
pub const BOUNDINGS: [(&str, Bounding); 4] = [
    ("penalty", Bounding::Penalty { coefficient: 0.5 }),
    ("projection", Bounding::Projection),
    ("nearest-neighbour", Bounding::NearestNeighbour),
    ("constrained", Bounding::Constrained { linearisations: 2 }),
];

/// What the filter finds.
#[derive(Debug, Clone, PartialEq)]
pub struct Filtered {
    /// Shear modulus, MPa.
    pub mu_mpa: f64,
    /// Exponent.
    pub alpha: f64,
    /// The library's material; none if nothing is near enough.
    pub named: Option<usize>,
}

/// Region of mu (MPa) and alpha, the thesis' grid, and of the depth at which contact was believed (mm).
const LOW: [f32; 3] = [0.0005, 1.0, -0.2];
const HIGH: [f32; 3] = [0.3, 24.0, 0.2];
/// Standard deviation of a force, as a part of the largest, and the least of it, N.
const ERROR: f32 = 0.01;
const LEAST_N: f32 = 1e-3;
/// Depths at which curves are compared, and offsets of contact that each material may have, as on the board.
const DEPTHS: u16 = 100;
const OFFSETS: i16 = 10;
const OFFSET_MM: f32 = 0.02;

/// The bounding of a word.
#[must_use]
pub fn bounding(word: &str) -> Option<Bounding> {
    BOUNDINGS.into_iter().find(|(known, _)| *known == word).map(|(_, bounding)| bounding)
}

/// Filters depths (mm) and forces (N) of one press from the middle of the region, in one pass, as the thesis does.
/// `None` where the table has nothing for the specimen.
#[must_use]
pub fn filtered(
    table: &Table<'_>,
    samples: &[(f64, f64)],
    (height_mm, rate_mm_s): (f32, f32),
    bounding: Bounding,
) -> Option<Filtered> {
    let slice = Slice::nearest(table, height_mm, rate_mm_s)?;
    let surface = Surface::new(table, &slice)?;
    let region = Region { low: Vector3::from(LOW), high: Vector3::from(HIGH) };
    let reach_mm = table.depth_max_mm() - HIGH[2];
    let used: Vec<(f32, f32)> = samples
        .iter()
        .map(|(depth, force)| (*depth as f32, *force as f32))
        .filter(|(depth, _)| *depth > 0.0 && *depth <= reach_mm)
        .collect();
    let peak_n = used.iter().map(|(_, force)| *force).fold(0.0, f32::max);
    let middle = region.middle();
    let mut estimator = Estimator::new(Vector3::new(middle[0], middle[1], 0.0), region, bounding);
    let model = Indentation { surface };
    let count = identify(&mut estimator, &model, used.iter().copied(), (ERROR * peak_n).max(LEAST_N).powi(2), 1);
    let state = region.nearest(&estimator.filter.state);
    let told = count > 0 && state.iter().all(|x| x.is_finite());
    told.then(|| Filtered {
        mu_mpa: f64::from(state[0]),
        alpha: f64::from(state[1]),
        named: recognised(table, &model.surface, (state[0], state[1]), OFFSETS),
    })
}

/// The library's material whose curve is nearest to that of the parameters, if within its acceptance. Parameters
/// themselves are not compared, because mu and alpha make up for each other. The contact of each material may be off
/// by `offsets` of 0.02 mm. `None` as well for parameters that the table has no curve for.
#[must_use]
pub fn recognised(
    table: &Table<'_>,
    surface: &Surface<'_>,
    (mu_mpa, alpha): (f32, f32),
    offsets: i16,
) -> Option<usize> {
    let reach_mm = f32::from(offsets) * OFFSET_MM;
    let step_mm = (table.depth_max_mm() - 2.0 * reach_mm) / f32::from(DEPTHS);
    let depths: Vec<f32> = (1..=DEPTHS).map(|i| reach_mm + step_mm * f32::from(i)).collect();
    let force = |d: &f32| surface.at(mu_mpa, alpha, *d).map(|f| f.force_n);
    let found: Vec<f32> = depths.iter().map(force).collect::<Option<_>>()?;
    let error_n = |material: &protocol::lut::Material<'_>, offset_mm: f32| {
        let at = |d: f32| table.locate(d + offset_mm).map_or(0.0, |p| material.force_n(p));
        depths.iter().zip(&found).map(|(d, f)| (at(*d) - f).abs()).sum::<f32>() / f32::from(DEPTHS)
    };
    let least = |material: &protocol::lut::Material<'_>| {
        let each = (-offsets..=offsets).map(|i| error_n(material, OFFSET_MM * f32::from(i)));
        each.fold(f32::INFINITY, f32::min)
    };
    let errors = table.materials().map(|m| (least(&m), m.acceptance * m.peak_force_n()));
    let (index, (error_n, accepted_n)) = errors.enumerate().min_by(|a, b| a.1.0.total_cmp(&b.1.0))?;
    (error_n <= accepted_n).then_some(index)
}
