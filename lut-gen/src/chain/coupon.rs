//! Force readings that a model predicts for a coupon: a piece of the foam between faces, in which every point deforms alike.
//!
//! Nothing of ball, friction and contact is in it. With one Poisson's ratio for all terms the free sides of a Hyperfoam follow the axis by
//! `s = l^(-nu)` whatever the stress, so that free and held sides share one closed form ([`Column`]); and since no work is done on the sides,
//! relaxation and softening multiply and convolve the axial stress alone, exactly (`tests/coupon.rs` compares with
//! [`crate::solid::homogeneous::Coupon::follow`]). A rubber's sides follow by `l^(-1/2)`, and its platens may rub ([`Rubbing`]).

use std::sync::Arc;

use super::{Model, Rubbing};
use crate::effect::{compliance, friction, poisson, relaxation, second_term, softening};
use crate::solid::homogeneous::Mode;
use crate::solid::law::OgdenRoxburgh;

/// What holds the sides of a coupon.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sides {
    /// Nothing: between lubricated platens ("uniaxial").
    Free,
    /// A rigid, lubricated ring that it fills ("confined").
    Held,
}

impl Sides {
    /// The homogeneous state.
    #[must_use]
    pub fn mode(self) -> Mode {
        match self {
            Self::Free => Mode::Uniaxial,
            Self::Held => Mode::Confined,
        }
    }

    /// `m` of [`Column`] at a Poisson's ratio.
    fn spread(self, nu: f64) -> f64 {
        match self {
            Self::Free => nu,
            Self::Held => nu / (1.0 - 2.0 * nu),
        }
    }
}

/// Recorded shortening of one coupon, thinned to the places where force is predicted.
#[derive(Debug, Clone, PartialEq)]
pub struct Shortening {
    /// Its sides.
    pub sides: Sides,
    /// Declared height (mm).
    pub height_mm: f64,
    /// Undeformed cross-section (mm^2).
    pub area_mm2: f64,
    /// Index of the specimen in the experiment, the owner of its height.
    pub specimen: usize,
    /// Poisson's ratio that its law states: 0.5 of a rubber, whose sides are free then. None of a foam, which
    /// has that of the model.
    pub nu: Option<f64>,
    /// What friction on its platens adds; none where it is not solved, and platens do not rub.
    pub rubbing: Option<Arc<Rubbing>>,
    /// Time since the first sample (s), rising.
    pub time_s: Vec<f64>,
    /// Recorded shortening (mm), as long as `time_s`; 0 at first touch.
    pub depth_mm: Vec<f64>,
    /// Start on the session clock (s), if it is known.
    pub start_s: f64,
    /// Largest recorded shortening of the same coupon in earlier runs (mm).
    pub before_mm: f64,
}

/// Rounds of Newton's method in which machine and coupon share the recorded depth: a coupon's force bends towards the depth axis, so that the
/// depth rises to its solution after the first round, and its error is squared in each.
const ROUNDS: usize = 8;
/// A correction of the depth below which the next one is rounding (mm).
const SHARED_MM: f64 = 1e-6;
/// Stretches below this are none that a foam has.
const SHORTEST: f64 = 0.05;

/// Axial stress of a Hyperfoam whose sides are free or held, a sum over its terms with `m = nu` (free) or `nu / (1 - 2 nu)` (held), for
/// then `J^(-alpha b) = l^(-alpha m)`:
///
/// ```text
/// P       = sum 2 mu / alpha   (l^alpha - l^(-alpha m)) / l
/// dP / dl = sum 2 mu / alpha   ((alpha - 1) l^alpha + (alpha m + 1) l^(-alpha m)) / l^2
/// U       = sum 2 mu / alpha^2 (l^alpha - 1 + (l^(-alpha m) - 1) / m)
/// ```
///
/// (thesis Eq. 1; `U` is the integral of `P`, the sides doing no work; `(l^(-alpha m) - 1) / m` is `-alpha ln l` where `m` is 0.)
struct Column {
    /// `mu` (MPa) and `alpha` of each term.
    terms: Vec<(f64, f64)>,
    spread: f64,
}

/// Pressure (MPa, positive in compression), its slope over shortening as a part of the height (MPa), and energy (MPa).
#[derive(Clone, Copy)]
struct State {
    pressure: f64,
    slope: f64,
    energy: f64,
}

impl Column {
    fn at(&self, stretch: f64) -> State {
        let ln = stretch.ln();
        let mut state = State { pressure: 0.0, slope: 0.0, energy: 0.0 };
        for &(mu_mpa, alpha) in &self.terms {
            let factor = 2.0 * mu_mpa / alpha;
            let (power, x) = ((alpha * ln).exp(), -alpha * self.spread * ln);
            let beyond = x.exp_m1();
            let volume = 1.0 + beyond;
            state.pressure -= factor * (power - volume) / stretch;
            state.slope +=
                factor * ((alpha - 1.0) * power + (alpha * self.spread + 1.0) * volume) / (stretch * stretch);
            // (e^x - 1) / m, its limit -alpha ln l for m -> 0
            let part = if self.spread.abs() < 1e-9 { -alpha * ln } else { beyond / self.spread };
            state.energy += factor / alpha * (power - 1.0 + part);
        }
        state
    }
}

impl Model {
    /// Readings (N) of a coupon that is shortened, one a place. `contact_mm` is what its first touch adds to the recorded depth of touch.
    #[must_use]
    pub fn shortened(&self, run: &Shortening, contact_mm: f64) -> Vec<f64> {
        let height_mm = run.height_mm + self.height_error_mm(run.specimen);
        let nu = run.nu.unwrap_or_else(|| self.first(&poisson::EFFECT, 0));
        let mut terms = vec![(self.mu_mpa, self.alpha)];
        terms.extend(self.of(&second_term::EFFECT).filter_map(|s| match s.values[..] {
            [ratio, alpha] => Some((ratio * self.mu_mpa, alpha)),
            _ => None,
        }));
        let column = Column { terms, spread: run.sides.spread(nu) };
        let recorded = self.driven(&run.time_s, &run.depth_mm, contact_mm);
        let before_mm = self.before_mm(run.before_mm, &run.depth_mm, &recorded);
        let stretch = |depth_mm: f64| (1.0 - depth_mm.max(0.0) / height_mm).max(SHORTEST);
        let before = column.at(stretch(before_mm)).energy;
        let force_on = |depth_mm: &[f64]| -> (Vec<f64>, Vec<State>) {
            let stretches: Vec<f64> = depth_mm.iter().map(|d| stretch(*d)).collect();
            let states: Vec<State> = stretches.iter().map(|l| column.at(*l)).collect();
            let mut force: Vec<f64> = states.iter().map(|state| run.area_mm2 * state.pressure).collect();
            for setting in self.of(&softening::EFFECT) {
                self.soften((setting.values[0], setting.values[1]), before, &states, &mut force);
            }
            let series = self.relaxing();
            if !series.is_empty() {
                relaxation::convolved(&run.time_s, &stretches, &series, &mut force);
            }
            self.rub(run, &stretches, &mut force);
            (force, states)
        };
        let mm_per_n = self.first(&compliance::EFFECT, 0);
        let (mut force, mut states) = force_on(&recorded);
        if mm_per_n != 0.0 {
            let mut depth = recorded.clone();
            for _ in 0..ROUNDS {
                let mut moved = 0.0_f64;
                for (((d, x), f), state) in depth.iter_mut().zip(&recorded).zip(&force).zip(&states) {
                    let slope = run.area_mm2 / height_mm * state.slope;
                    let next = *d + compliance::correction(*x, *d, *f, slope, mm_per_n);
                    let next = next.max(0.0).min(x.max(0.0));
                    moved = moved.max((next - *d).abs());
                    *d = next;
                }
                (force, states) = force_on(&depth);
                if moved < SHARED_MM {
                    break;
                }
            }
        }
        // platens push and never pull
        force.iter_mut().for_each(|f| *f = f.max(0.0));
        self.read(&run.time_s, run.start_s, &mut force);
        force
    }

    /// Friction on the platens: a share of the force, another one on the way back.
    fn rub(&self, run: &Shortening, stretches: &[f64], force_n: &mut [f64]) {
        let coefficient = self.first(&friction::EFFECT, 0);
        let Some(rubbing) = run.rubbing.as_ref().filter(|_| coefficient > 0.0) else { return };
        let mut deepest = 0.0_f64;
        for (force, stretch) in force_n.iter_mut().zip(stretches) {
            let share = 1.0 - stretch;
            deepest = deepest.max(share);
            let is_back = share < (1.0 - friction::TURN) * deepest;
            *force *= rubbing.factor((self.alpha, coefficient), share, is_back);
        }
    }

    /// Ogden and Roxburgh's factor of a material point, which all points are: the law behind what [`softening::factor`] is of a contact.
    /// `before` is the largest energy (MPa) of earlier runs.
    fn soften(&self, (loss, scale): (f64, f64), before: f64, states: &[State], force_n: &mut [f64]) {
        let (r, m_over_mu, beta) = softening::of_points(loss, scale);
        let law = OgdenRoxburgh { r, m_mpa: m_over_mu * self.mu_mpa, beta };
        let mut largest = before;
        for (force, state) in force_n.iter_mut().zip(states) {
            let (share, _, now) = law.factor(state.energy, largest);
            *force *= share;
            largest = now;
        }
    }
}
