//! The Kalman filter on a press, and what it recognises (thesis Table 4).

use firmware::contact::{Contact, ContactConfig, Sample};
use firmware::kalman::bounds::Estimator;
use firmware::kalman::identify::identify;
use firmware::kalman::indentation::Indentation;
use firmware::kalman::{Bounding, Region};
use firmware::search::{Slice, Tolerance};
use firmware::surface::Surface;
use nalgebra::Vector3;
use protocol::lut::{Table, axis_name};

use super::DEPTH_MM;

/// What the filter finds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Filtered {
    /// Modulus (MPa).
    pub mu_mpa: f64,
    /// Exponent.
    pub alpha: f64,
    /// Height of the surface, mm.
    pub surface_mm: f64,
    /// Place of the recognised material in the library; none if nothing is near enough.
    pub named: Option<usize>,
}

/// How far the first estimate of the contact point may be off, mm: three deviations of the worst that the board's tests
/// allow (0.15 mm).
const REACH_MM: f32 = 0.45;

/// Samples above the first estimate of the surface that the filter takes, mm: contact may have been earlier.
const LEAD_MM: f32 = 0.3;

/// Passes over the press; the second is linearised at the estimate of the first.
const PASSES: u8 = 2;

/// Offsets of contact at which the estimate's curve is held against the library, as the board does with measured ones.
const OFFSETS: i32 = 12;
const OFFSET_MM: f32 = 0.02;

/// Depths at which curves are compared.
const DEPTHS: usize = 100;

/// The board's filter with modulus, exponent and contact point as states, from the middle of the grid, on the samples
/// of a press; then the library's curve that is nearest to the curve of the estimate. None without contact.
pub fn filter(table: &Table<'_>, samples: &[Sample], rate_mm_s: f64) -> Option<Filtered> {
    let config = ContactConfig::default();
    let mut contact = Contact::new();
    samples.iter().position(|s| contact.step(&config, *s))?;
    let point = contact.locate(&config);
    let slice = Slice::choose(table, point.height_mm, rate_mm_s as f32, &Tolerance::default()).ok()?;
    let surface = Surface::new(table, &slice)?;
    let mus = table.axis(axis_name::MU)?;
    let (alpha_low, alpha_high) = surface.alpha_range();
    let region = Region {
        low: Vector3::new(mus.value(0), alpha_low, -REACH_MM),
        high: Vector3::new(mus.value(mus.len() - 1), alpha_high, REACH_MM),
    };
    let bounding = Bounding::Constrained { linearisations: 2 };
    let mut estimator = Estimator::new(region.middle(), region, bounding);
    let deepest_mm = DEPTH_MM as f32 - REACH_MM;
    let taken = samples
        .iter()
        .map(|s| (point.height_mm - s.probe_mm, s.force_n - point.zero_n))
        .filter(|(depth_mm, _)| *depth_mm > -LEAD_MM && *depth_mm <= deepest_mm);
    let noise_n = point.noise_n.max(config.floor_n);
    identify(&mut estimator, &Indentation { surface }, taken, noise_n * noise_n, PASSES);
    let state = region.nearest(&estimator.filter.state);
    Some(Filtered {
        mu_mpa: f64::from(state[0]),
        alpha: f64::from(state[1]),
        surface_mm: f64::from(point.height_mm + state[2]),
        named: nearest(table, &surface, (state[0], state[1])),
    })
}

/// The material whose curve is nearest to the estimate's (mean absolute difference, each at its best offset), if it is within the
/// material's acceptance.
fn nearest(table: &Table<'_>, surface: &Surface<'_>, (mu_mpa, alpha): (f32, f32)) -> Option<usize> {
    let reach_mm = OFFSETS as f32 * OFFSET_MM;
    let step_mm = (table.depth_max_mm() - 2.0 * reach_mm) / DEPTHS as f32;
    let depths: Vec<f32> = (1..=DEPTHS).map(|i| reach_mm + step_mm * i as f32).collect();
    let found: Vec<f32> =
        depths.iter().map(|d| surface.at(mu_mpa, alpha, *d).map(|f| f.force_n)).collect::<Option<_>>()?;
    let mut best: Option<(usize, f32)> = None;
    for (i, material) in table.materials().enumerate() {
        for offset in -OFFSETS..=OFFSETS {
            let at = |depth_mm: f32| table.locate(depth_mm + OFFSET_MM * offset as f32).map(|p| material.force_n(p));
            let error_n: f32 =
                depths.iter().zip(&found).map(|(d, f)| (at(*d).unwrap_or(0.0) - f).abs()).sum::<f32>() / DEPTHS as f32;
            let accepted = error_n <= material.acceptance * material.peak_force_n();
            let nearer = best.is_none_or(|(_, least)| error_n < least);
            if nearer {
                best = Some((if accepted { i } else { usize::MAX }, error_n));
            }
        }
    }
    best.map(|(i, _)| i).filter(|i| *i < table.material_count())
}
