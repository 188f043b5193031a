//! Noise, contact points and base of a data set, each found from the others.

use lut_gen::chain::{Chain, Model};
use nalgebra::DVector;
use rayon::prelude::*;

use super::coordinate::{Coordinate, coordinates};
use super::design::{Design, Series};
use super::fit::{Fit, Problem};
use super::jitter::Posterior;
use super::noise::{self, Curve, Jitter, Noise, SensorNoise, Source};
use super::spike;
use super::whiten::Whitening;

/// A problem whose noise is known and whose base is fitted.
#[derive(Debug)]
pub struct Prepared<'a> {
    /// Data, model and whitening.
    pub problem: Problem<'a>,
    /// The base.
    pub base: Fit,
    /// The noise.
    pub noise: Noise,
}

/// Where the recorded zero is not the contact, predictions are linearised about contact points within this many standard deviations of
/// their jitter; where it is, about the zero itself: a few hundredths of a millimetre of jitter bend no curve.
const CONTACTS: f64 = 2.0;
/// No contact point lies farther off than this share of the largest depth: without an end a base that is wrong and a jitter that grows with what it
/// leaves drive each other (beef, held for 10 s: a jitter of kilometres, in which nothing was wrong).
const FARTHEST: f64 = 0.1;
/// Rounds in which noise, contact points and base are found, each from the others.
const ROUNDS: usize = 3;

impl<'a> Prepared<'a> {
    /// Finds noise, contact points and base parameters. `None` when the noise cannot be found, or no covariance is positive definite.
    #[must_use]
    pub fn new(design: &'a Design, chain: &'a Chain, stated_n: Option<f64>) -> Option<Self> {
        let peak = |s: &Series| s.nodes.iter().map(|n| n.force_n).fold(0.0, f64::max);
        let largest = design.series.iter().map(peak).fold(0.0, f64::max);
        // before anything is known: a percent of the peak, contacts to a twentieth of a millimetre
        let jitter = Jitter { contact_mm: 0.05, gain: 0.02, zero_n: 0.0 };
        let noise = Noise {
            source: Source::Stated,
            sensor: SensorNoise { sigma_n: 0.01 * largest, white: 0.5, correlation_s: 0.1, relative: 0.0 },
            jitter,
            posterior: Posterior::stated(jitter, 5.0),
            sensor_freedom: 50.0,
        };
        let measured = |s: &Series| s.nodes.iter().map(|n| n.force_n.max(0.0)).collect();
        let curves: Vec<Curve> =
            design.series.iter().map(|s| Curve { force_n: measured(s), slope_n_per_mm: slopes(s) }).collect();
        let problem = placed((design, chain), &noise, &curves, vec![0.0; design.series.len()])?;
        let base = base_fit(&problem, 0.05 * largest.max(1e-6));
        let mut found = Self { problem, base, noise };
        for _ in 0..ROUNDS {
            found = found.about(&found.base.model, stated_n)?;
        }
        Some(found)
    }

    /// The same data with noise and contact points as another model sees them, and the base fitted to that: spots differ by shifts and gains of the forces
    /// that were measured, and where an effect is large the base's own are none of those.
    #[must_use]
    pub fn about(&self, model: &Model, stated_n: Option<f64>) -> Option<Self> {
        let Problem { design, chain, .. } = self.problem;
        let residual = self.problem.plain(model);
        let sigma_mm = self.noise.jitter.contact_mm;
        let spots = self.problem.whitening.contacts_mm(&residual, sigma_mm);
        let depths = design.series.iter().flat_map(|s| s.nodes.iter().map(|n| n.depth_mm));
        let farthest_mm = FARTHEST * depths.fold(0.0, f64::max);
        // a base that is wrong would push the contact points where no jitter puts them, and every extension with them
        let reach = if design.zero_is_contact { 0.0 } else { (CONTACTS * sigma_mm).min(farthest_mm) };
        let contacts_mm: Vec<f64> = design.series.iter().map(|s| spots[s.spot].clamp(-reach, reach)).collect();
        let curves = Problem::curves(design, chain, model, &contacts_mm);
        let at_zero: Vec<Curve> = curves
            .iter()
            .zip(&contacts_mm)
            .map(|(c, contact)| Curve {
                force_n: c.force_n.iter().zip(&c.slope_n_per_mm).map(|(f, s)| f + s * contact).collect(),
                slope_n_per_mm: c.slope_n_per_mm.clone(),
            })
            .collect();
        let noise = noise::estimate(design, &at_zero, stated_n)?;
        let mut problem = placed((design, chain), &noise, &curves, contacts_mm)?;
        let spikes = spike::of(design, &problem.whitening, &problem.residual(model));
        if !spikes.is_empty() {
            problem.whitening = Whitening::but_for(&spikes, design, &curves, &noise)?.for_rows(&problem.used)?;
        }
        // what the noise is told about may lie in another valley of the base than the base before did
        let mut there = self.base.x.clone();
        (there[0], there[1]) = (model.mu_mpa.ln(), model.alpha.ln());
        let each = [&self.base.x, &there].map(|start| problem.fit(&[], start));
        let base = each.into_iter().min_by(|a, b| a.square.total_cmp(&b.square))?;
        Some(Self { problem, base, noise })
    }
}

/// A problem with its whitening, linearised about curves at contact points (mm).
fn placed<'a>(
    (design, chain): (&'a Design, &'a Chain),
    noise: &Noise,
    curves: &[Curve],
    contacts_mm: Vec<f64>,
) -> Option<Problem<'a>> {
    let used = used(design);
    let whitening = Whitening::new(design, curves, noise)?.for_rows(&used)?;
    let back_n = back(design, curves, &contacts_mm, whitening.residuals());
    Some(Problem { design, chain, contacts_mm, back_n, whitening, used, whole: None })
}

/// Entries that are fitted: no held-out runs.
pub(super) fn used(design: &Design) -> Vec<bool> {
    let of = |s: &Series| -> Vec<bool> { s.nodes.iter().map(|n| !n.lifted && !s.hold_out).collect() };
    let mut used: Vec<bool> = design.series.iter().flat_map(of).collect();
    used.extend(design.checks.iter().flat_map(|check| (0..check.rows()).map(|_| true)));
    used
}

/// First-order step from the contact points back to contact 0.
fn back(design: &Design, curves: &[Curve], contacts_mm: &[f64], len: usize) -> DVector<f64> {
    let mut out = DVector::zeros(len);
    let mut at = 0;
    for (s, series) in design.series.iter().enumerate() {
        for k in 0..series.nodes.len() {
            out[at] = curves[s].slope_n_per_mm[k] * contacts_mm[s];
            at += 1;
        }
    }
    out
}

/// Slopes of measured forces over depth, for the very first round.
fn slopes(series: &Series) -> Vec<f64> {
    let nodes = &series.nodes;
    let deepest = nodes.iter().map(|n| n.depth_mm).fold(0.0, f64::max);
    let peak = nodes.iter().map(|n| n.force_n).fold(0.0, f64::max);
    nodes.iter().map(|n| 2.0 * peak / deepest * (n.depth_mm / deepest).clamp(0.0, 1.0)).collect()
}

/// The base fitted from several exponents.
pub(super) fn base_fit(problem: &Problem<'_>, peak_mpa: f64) -> Fit {
    const ALPHAS: [f64; 3] = [4.0, 9.0, 16.0];
    let list = coordinates(problem.design, &[]);
    let fits = ALPHAS.par_iter().map(|alpha| {
        let x = DVector::from_fn(list.len(), |i, _| match list[i] {
            Coordinate::LnMu => peak_mpa.ln(),
            Coordinate::LnAlpha | Coordinate::LnAlphaAlone => alpha.ln(),
            _ => 0.0,
        });
        problem.fit(&[], &x)
    });
    let mut fits: Vec<Fit> = fits.collect();
    fits.sort_by(|a, b| a.square.total_cmp(&b.square));
    fits.swap_remove(0)
}
