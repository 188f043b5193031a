//! Runs that a ball on the foam has no part in: in air, under a known mass and on a stiff block, which show sensor and machine alone, and coupons of the foam,
//! which show its law without ball, friction and contact.

mod alone;
mod coupon;

use lut_gen::chain::{Model, Sides};
use nalgebra::DMatrix;

use crate::experiment::{BaseLaw, Experiment, Run, Test};

use super::scatter::{Jitter, SensorNoise};
use super::variable::Variable;
use alone::Alone;
pub use alone::Touched;
pub use coupon::Coupon;

/// What was touched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Nothing.
    Air,
    /// A known load.
    Mass,
    /// A stiff block.
    Block,
    /// A coupon of the foam between platens, its sides free.
    Uniaxial,
    /// A coupon of the foam in a ring.
    Confined,
}

/// One such run.
#[derive(Debug, Clone, PartialEq)]
pub struct Check {
    /// What was touched.
    pub kind: Kind,
    /// Start on the session clock, s, if known.
    pub start_s: Option<f64>,
    /// Largest force of the experiment's other runs, N: the zero wanders by a part of it.
    pub scale_n: f64,
    shown: Shown,
}

/// What a run shows.
#[derive(Debug, Clone, PartialEq)]
enum Shown {
    Alone(Alone),
    Coupon(Coupon),
}

/// All such runs of an experiment, with what the reader should know of those that say nothing. Coupons are those of one material.
pub(super) fn of(experiment: &Experiment, material: &str, scale_n: f64) -> (Vec<Check>, Vec<String>) {
    let mut checks: Vec<Check> = Vec::new();
    let mut messages = Vec::new();
    for (at, run) in experiment.runs.iter().enumerate() {
        let specimen = run.specimen.map(|at| &experiment.specimens[at]);
        let rigid = specimen.is_some_and(|its| its.base_law == BaseLaw::Rigid);
        let ball_mm = run.indenter.and_then(|at| experiment.indenters[at].radius_mm.known());
        let found = match run.test {
            Test::Air => Alone::standing(run, Touched::Nothing, 0.0).map(Shown::Alone),
            Test::Mass => match run.load_n {
                Some(load_n) => Alone::standing(run, Touched::Load, load_n).map(Shown::Alone),
                None => Err("a mass without load_N says nothing of the sensor".to_owned()),
            },
            Test::Indentation if rigid => match ball_mm {
                Some(ball_mm) => Alone::on_block(run, ball_mm).map(Shown::Alone),
                None => Err("a ball of unknown radius on a stiff block says nothing of the machine".to_owned()),
            },
            Test::Uniaxial | Test::Confined if specimen.is_some_and(|its| its.material == material) => {
                let before_mm = shortened_before(experiment, at);
                Coupon::of(experiment, run, before_mm, &mut messages).map(Shown::Coupon)
            }
            _ => continue,
        };
        match found {
            Ok(shown) => checks.push(Check { kind: shown.kind(), start_s: run.start_s, scale_n, shown }),
            Err(why) => messages.push(format!("{}: {why}", run.file)),
        }
    }
    (checks, messages)
}

/// Largest recorded shortening (mm) of the coupon of a run in earlier runs: those on its spot where spots are labelled, else those of its specimen if it is a later
/// cycle; minus infinity for a fresh one.
fn shortened_before(experiment: &Experiment, at: usize) -> f64 {
    let run = &experiment.runs[at];
    let same = |other: &&Run| {
        let labelled = if run.spot.is_some() { other.spot == run.spot } else { run.cycle.unwrap_or(1) > 1 };
        other.test == run.test && other.specimen == run.specimen && labelled
    };
    let depths = experiment.runs[..at].iter().filter(same).flat_map(|other| other.recording.depth_mm.iter().copied());
    depths.fold(f64::NEG_INFINITY, f64::max)
}

impl Check {
    /// A load (N) that stands for a time (s), recorded at a rate (Hz), for a plan: its readings are to come.
    pub(super) fn planned(touched: Touched, load: (f64, f64), sample_hz: f64, like: (Option<f64>, f64)) -> Self {
        let shown = Shown::Alone(Alone::planned(touched, load, sample_hz));
        Self { kind: shown.kind(), start_s: like.0, scale_n: like.1, shown }
    }

    /// A coupon that could be compressed, for a plan.
    pub(super) fn of_coupon(coupon: Coupon, like: (Option<f64>, f64)) -> Self {
        let shown = Shown::Coupon(coupon);
        Self { kind: shown.kind(), start_s: like.0, scale_n: like.1, shown }
    }

    /// The coupon, if it is one.
    pub(super) fn coupon(&self) -> Option<&Coupon> {
        match &self.shown {
            Shown::Alone(_) => None,
            Shown::Coupon(coupon) => Some(coupon),
        }
    }

    /// The coupon, to be told of its platens.
    pub(super) fn coupon_mut(&mut self) -> Option<&mut Coupon> {
        match &mut self.shown {
            Shown::Alone(_) => None,
            Shown::Coupon(coupon) => Some(coupon),
        }
    }

    /// The specimen that was shortened as a whole, as its index.
    pub(super) fn coupon_of(&self) -> Option<usize> {
        self.coupon().map(Coupon::specimen)
    }

    /// Number of rows: readings (N), then depths (mm).
    #[must_use]
    pub fn rows(&self) -> usize {
        match &self.shown {
            Shown::Alone(alone) => alone.rows(),
            Shown::Coupon(coupon) => coupon.rows(),
        }
    }

    /// What was recorded, a row each.
    pub(super) fn measured(&self) -> Vec<f64> {
        match &self.shown {
            Shown::Alone(alone) => alone.measured(),
            Shown::Coupon(coupon) => coupon.measured(),
        }
    }

    /// What a model makes of it.
    pub(super) fn predicted(&self, model: &Model) -> Vec<f64> {
        match &self.shown {
            Shown::Alone(alone) => alone.predicted(model, self.start_s),
            Shown::Coupon(coupon) => coupon.predicted(model),
        }
    }

    /// Lower triangular factor of the covariance of its rows; none where that is not positive definite.
    pub(super) fn factor(&self, noise: &SensorNoise) -> Option<DMatrix<f64>> {
        match &self.shown {
            Shown::Alone(alone) => alone.factor(noise),
            Shown::Coupon(coupon) => coupon.factor(noise),
        }
    }

    /// What its rows may be off by together, a column of unit variance each.
    pub(super) fn freedom(&self, jitter: &Jitter) -> DMatrix<f64> {
        match &self.shown {
            Shown::Alone(alone) => alone.freedom(jitter),
            Shown::Coupon(coupon) => coupon.freedom(jitter),
        }
    }

    /// Number of rows that are readings of the force, the first ones: the zero of the session is in them, and in no depth.
    pub(super) fn readings(&self) -> usize {
        match &self.shown {
            Shown::Alone(alone) => alone.readings(),
            Shown::Coupon(coupon) => coupon.rows(),
        }
    }

    /// Directions that a discrepancy may lie in: variable, label, and a weight a row.
    pub(super) fn directions(&self) -> Vec<(Variable, String, Vec<f64>)> {
        match &self.shown {
            Shown::Alone(alone) => alone.directions(),
            Shown::Coupon(coupon) => coupon.directions(),
        }
    }
}

impl Shown {
    fn kind(&self) -> Kind {
        match self {
            Self::Alone(alone) => match alone.touched {
                Touched::Nothing => Kind::Air,
                Touched::Load => Kind::Mass,
                Touched::Block => Kind::Block,
            },
            Self::Coupon(coupon) => match coupon.sides() {
                Sides::Free => Kind::Uniaxial,
                Sides::Held => Kind::Confined,
            },
        }
    }
}
