//! What a search among effects works on, and how one effect more is fitted.

mod begin;
mod form_error;
mod rounds;
mod signature;
mod solve;

use lut_gen::effect::{CATALOGUE, Owner, sensor_creep, thickness};
use nalgebra::DMatrix;
use rayon::prelude::*;

use super::check::Check;
use super::coordinate::{Candidate, Coordinate};
use super::design::{Branch, Design, Series};
use super::fit::{Fit, Problem};
use super::noise::{Curve, Noise};
use super::prepared::Prepared;
pub(super) use form_error::form_error;
pub use form_error::{allowed, form_error_range};
pub(super) use signature::changes;
pub use signature::signature;
pub(super) use signature::starts;

/// Data, noise and base, with all that a search among effects needs of them.
#[derive(Debug, Clone)]
pub struct Search<'a> {
    /// Data and model.
    pub problem: Problem<'a>,
    /// The noise.
    pub noise: Noise,
    /// Fit of the base.
    pub base: Fit,
    /// What the base predicts.
    pub curves: Vec<Curve>,
    /// Candidates that this design could have.
    pub candidates: Vec<Candidate>,
    /// Signature of every candidate at the base fit.
    pub signatures: Vec<DMatrix<f64>>,
}

impl<'a> Search<'a> {
    /// Of what is prepared.
    #[must_use]
    pub fn new(prepared: Prepared<'a>, candidates: Vec<Candidate>) -> Self {
        let Prepared { problem, base, noise } = prepared;
        let curves = Problem::curves(problem.design, problem.chain, &base.model, &problem.contacts_mm);
        let signatures = candidates.par_iter().map(|c| signature(&problem, &base, c)).collect();
        Self { problem, noise, base, curves, candidates, signatures }
    }

    /// The same with noise and contact points as a fit sees them; none where that finds no noise, or one in which no foam at all is the likeliest base: where spots
    /// differ by a tenth as a gain, each may well have none.
    #[must_use]
    pub fn about(&self, fit: &Fit, stated_n: Option<f64>) -> Option<Self> {
        let own = Prepared { problem: self.problem.clone(), base: self.base.clone(), noise: self.noise.clone() };
        let (softest, _) = Coordinate::LnMu.bounds();
        let told = own.about(&fit.model, stated_n).filter(|told| told.base.x[0] > softest + 1e-2)?;
        Some(Self::new(told, self.candidates.clone()))
    }
}

/// Candidates that a design can have at all: an effect of the clock needs a clock.
#[must_use]
pub fn candidates(design: &Design) -> Vec<Candidate> {
    let mut list = Vec::new();
    // of presses, or where there are none of what was compressed instead
    let clock = match design.series.len() {
        0 => design.checks.iter().all(|check| check.start_s.is_some()),
        _ => design.series.iter().all(|series| series.start_s.is_some()),
    };
    let coupons = || design.checks.iter().filter_map(Check::coupon);
    let runs = || design.series.iter().map(|s| &s.nodes[..]).chain(coupons().map(|coupon| coupon.nodes()));
    let has = |branch: Branch| runs().any(|nodes| nodes.iter().any(|n| n.branch == branch));
    let cycles = design.series.iter().any(|s| s.cycle > 1) || coupons().any(|coupon| coupon.before_mm() > 0.0);
    let owners = |of: &dyn Fn(&Series) -> usize| {
        let mut all: Vec<usize> = design.series.iter().map(of).collect();
        all.sort_unstable();
        all.dedup();
        all
    };
    // a coupon has no base, but a height that may be wrong
    let measured = || {
        let mut all = owners(&|s| s.specimen);
        all.extend(design.checks.iter().filter_map(Check::coupon_of));
        all.sort_unstable();
        all.dedup();
        all
    };
    for effect in CATALOGUE {
        let possible = match effect.code {
            "drift" => clock,
            // every time is recorded on the one clock: no run tells its gain
            "time-gain" => false,
            "softening" => cycles || has(Branch::Unloading),
            // what only ever rises turns nowhere
            _ if *effect == sensor_creep::HYSTERESIS => cycles || has(Branch::Unloading),
            "contact-offset" => design.zero_is_contact,
            _ => true,
        };
        if !possible {
            continue;
        }
        match effect.owner {
            // of one specimen it is that specimen's
            Owner::All if *effect == thickness::EVERY_HEIGHT && measured().len() < 2 => {}
            Owner::All => list.push(Candidate { effect, owner: 0 }),
            Owner::Indenter => {
                let balls = owners(&|s| s.indenter);
                if balls.len() > 1 {
                    list.extend(balls.into_iter().map(|owner| Candidate { effect, owner }));
                }
            }
            Owner::Specimen => {
                let specimens = if *effect == thickness::HEIGHT { measured() } else { owners(&|s| s.specimen) };
                list.extend(specimens.into_iter().map(|owner| Candidate { effect, owner }));
            }
        }
    }
    list
}
