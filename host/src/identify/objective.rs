//! Thesis Eq. 14 with the contact points profiled out.

use super::data::{Height, LoadingCurve, Selection};
use super::model::{ForwardModel, Shape, UnitCurve};

/// Steps of the coarse scan of a contact point, and of the golden section that follows.
const SCAN: usize = 12;
const SECTIONS: usize = 26;

/// Parameters of a fit: alpha, ln mu and the free heights, in this order, as one vector.
pub const ALPHA: usize = 0;
/// Position of ln(mu / MPa).
pub const LN_MU: usize = 1;
/// Position of the first free height.
pub const FIRST_HEIGHT: usize = 2;

/// A selection of curves seen through a model.
pub struct Objective<'a> {
    /// The data.
    pub selection: &'a Selection,
    /// The forward model.
    pub model: &'a dyn ForwardModel,
}

impl Objective<'_> {
    /// Curves for mu = 1 MPa, one a pairing, at the given parameters.
    pub fn unit_curves(&self, point: &[f64]) -> Vec<UnitCurve> {
        let pairings = self.selection.pairings.iter().enumerate();
        pairings
            .map(|(at, pairing)| {
                let height_mm = match pairing.height {
                    Height::Known(mm) => mm,
                    Height::Free(n) => point[FIRST_HEIGHT + n],
                };
                self.model.curve(at, Shape { alpha: point[ALPHA], height_mm })
            })
            .collect()
    }

    /// Sum over the fitted runs of absolute force differences in N, each at its best contact
    /// point (Eq. 14).
    pub fn at(&self, point: &[f64]) -> f64 {
        self.with_curves(&self.unit_curves(point), point[LN_MU].exp())
    }

    /// As [`Objective::at`], for curves that are already there.
    pub fn with_curves(&self, curves: &[UnitCurve], mu_mpa: f64) -> f64 {
        let fitted = self.selection.curves.iter().filter(|curve| !curve.hold_out);
        fitted.map(|data| best_contact(data, &curves[data.pairing], mu_mpa).1).sum()
    }

    /// Number of fitted samples.
    pub fn samples(&self) -> usize {
        let fitted = self.selection.curves.iter().filter(|curve| !curve.hold_out);
        fitted.map(|curve| curve.depth_mm.len()).sum()
    }
}

/// Contact point (mm) with the least sum of absolute differences, and that sum (N).
///
/// The sum has one valley over the contact point for a rising curve and small noise, but noise
/// and a bad mu can make shallow side valleys: a scan first, golden section in the best cell.
pub fn best_contact(data: &LoadingCurve, curve: &UnitCurve, mu_mpa: f64) -> (f64, f64) {
    let misfit = |contact: f64| misfit(data, curve, mu_mpa, contact);
    let (low, high) = (data.contact.low_mm, data.contact.high_mm);
    let step = (high - low) / SCAN as f64;
    let mut best = (low, misfit(low));
    for i in 1..=SCAN {
        let contact = low + i as f64 * step;
        let value = misfit(contact);
        if value < best.1 {
            best = (contact, value);
        }
    }
    let golden = (5.0_f64.sqrt() - 1.0) / 2.0;
    let (mut a, mut b) = ((best.0 - step).max(low), (best.0 + step).min(high));
    let mut left = (b - golden * (b - a), 0.0);
    let mut right = (a + golden * (b - a), 0.0);
    left.1 = misfit(left.0);
    right.1 = misfit(right.0);
    for _ in 0..SECTIONS {
        if left.1 < right.1 {
            b = right.0;
            right = left;
            left.0 = b - golden * (b - a);
            left.1 = misfit(left.0);
        } else {
            a = left.0;
            left = right;
            right.0 = a + golden * (b - a);
            right.1 = misfit(right.0);
        }
    }
    for candidate in [left, right] {
        if candidate.1 < best.1 {
            best = candidate;
        }
    }
    best
}

/// Sum of absolute force differences in N for one run and a given contact point.
pub fn misfit(data: &LoadingCurve, curve: &UnitCurve, mu_mpa: f64, contact_mm: f64) -> f64 {
    let samples = data.depth_mm.iter().zip(&data.force_n);
    samples.map(|(depth, force)| (mu_mpa * curve.at(depth - contact_mm) - force).abs()).sum()
}

/// The mu with the least sum of absolute differences for given curves and contact points, exactly:
/// the median of force / unit force, weighted by unit force, because mu is linear.
pub fn best_mu(selection: &Selection, curves: &[UnitCurve]) -> Option<f64> {
    let mut ratios: Vec<(f64, f64)> = Vec::new();
    for data in selection.curves.iter().filter(|curve| !curve.hold_out) {
        for (depth, force) in data.depth_mm.iter().zip(&data.force_n) {
            let unit = curves[data.pairing].at(depth - data.contact.contact_mm);
            if unit > 0.0 {
                ratios.push((force / unit, unit));
            }
        }
    }
    ratios.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = 0.5 * ratios.iter().map(|(_, weight)| weight).sum::<f64>();
    let mut sum = 0.0;
    let at = ratios.iter().position(|(_, weight)| {
        sum += weight;
        sum >= half
    })?;
    Some(ratios[at].0).filter(|mu| *mu > 0.0 && mu.is_finite())
}
