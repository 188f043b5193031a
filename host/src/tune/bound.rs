//! A bound of what a step does for every plant of a small box: continuous loops.
//!
//! With a plant `b/a`, a controller `d/e` and `chi = a e + b d`, plants that differ by `da`, `db` from the middle of the box change
//! the error by exactly
//!
//! ```text
//! De = w - (Dchi/chi) De,   w = e d (b da - a db) / chi^2 times the step,   Dchi = da e + db d,
//! ```
//!
//! all of the middle. Where the impulse response of `Dchi/chi` has an absolute integral `gamma < 1` for every plant of the box, the
//! loop is stable for every one (small gain), and `De` differs from `w` by at most `gamma/(1 - gamma)` times the size of `w`, in its
//! peak and in its integral (Desoer and Vidyasagar, Feedback Systems, 1975). `w` is linear in the plant, so cost and peaks of `error + w`
//! are convex in it and largest at a corner of the box. The same holds for the command with `d` in place of the first `e`.

use super::continuous::Loop;
use super::cubic::Cubic;
use super::gains::Gains;
use super::modal::{Modal, Signal};
use super::read::{Reader, Sample};
use super::step::Step;
use crate::actuator::polynomial::Polynomial;
use crate::actuator::uncertain::{Coefficient, Uncertain};

/// Finer steps than a single response needs: what is largest between two points is looked for with a cubic.
const FINER: f64 = 1.0;
/// Integrals of absolute values are taken on points; this covers what they miss.
const POINTS: f64 = 1.02;

/// Largest gain that counts as small: at 1 there is no bound, and near it none that is worth having.
pub(super) const SMALL_GAIN: f64 = 0.9;

/// Bounds over a box.
#[derive(Debug, Clone)]
pub(super) struct Bound {
    /// No plant of the box does worse in any of the four.
    pub most: Step,
    /// How much each coefficient adds to what is not known: the one to divide is the largest.
    pub shares: Vec<f64>,
}

/// Derivatives of the plant's polynomials by a coefficient.
fn direction(which: Coefficient) -> (Polynomial, Polynomial) {
    let none = Polynomial::new(vec![0.0]);
    match which {
        Coefficient::Numerator(i) => (none, Polynomial::monomial(1.0, i)),
        Coefficient::Denominator(i) => (Polynomial::monomial(1.0, i), none),
        Coefficient::Delay => (none.clone(), none),
    }
}

/// Signals of the middle of a box.
struct Signals {
    error: [Signal; 2],
    command: [Signal; 2],
    /// Changes of error and command by each coefficient, with their slopes.
    by: Vec<([Signal; 2], [Signal; 2])>,
}

/// Bounds over the box, or none where no bound is found: divide the box.
pub(super) fn bound(uncertain: &Uncertain, gains: &Gains, middle: &[f64], halves: &[f64]) -> Result<Bound, Vec<f64>> {
    let plant = uncertain.at(middle);
    let own = Loop::continuous(&plant, gains);
    let even = vec![1.0; halves.len()];
    let modal = Modal::new(&own.chi).filter(Modal::is_stable).ok_or(even)?;
    let ways: Vec<_> = uncertain.bounds.iter().map(|(which, _, _)| direction(*which)).collect();
    let gammas = gammas(&own, &modal, &ways, halves);
    let gamma: f64 = gammas.iter().sum();
    let small = gamma < SMALL_GAIN;
    if !small {
        return Err(gammas);
    }
    let rest = gamma / (1.0 - gamma);
    let lead = own.chi.leading();
    let twice = modal.squared();
    let signal = |numerator: &Polynomial| {
        let signal = twice.step_of(numerator, lead * lead);
        let slope = twice.slope(&signal);
        [signal, slope]
    };
    let signals = Signals {
        error: signal(&(&(&own.e * &own.a) * &own.chi)),
        command: signal(&(&(&own.d * &own.a) * &own.chi)),
        by: ways
            .iter()
            .zip(halves)
            .map(|((da, db), half)| {
                let change = &(&own.b * da) + &(&own.a * db).scaled(-1.0);
                let change = (&own.d * &change).scaled(*half);
                (signal(&(&own.e * &change)), signal(&(&own.d * &change)))
            })
            .collect(),
    };
    Ok(read(&twice, &signals, rest, &gammas))
}

/// Parts of gamma by coefficient.
fn gammas(own: &Loop, modal: &Modal, ways: &[(Polynomial, Polynomial)], halves: &[f64]) -> Vec<f64> {
    let signals: Vec<Signal> = ways
        .iter()
        .zip(halves)
        .map(|((da, db), half)| {
            let change = (&(da * &own.e) + &(db * &own.d)).scaled(*half);
            modal.impulse_of(&change, own.chi.leading())
        })
        .collect();
    let (mut sums, mut last) = (vec![0.0; signals.len()], vec![0.0; signals.len()]);
    modal.walk(f64::INFINITY, FINER, |_, step, state| {
        for ((signal, sum), last) in signals.iter().zip(&mut sums).zip(&mut last) {
            let now = signal.at(state).abs();
            *sum += 0.5 * step * (now + *last);
            *last = now;
        }
    });
    sums.iter().map(|sum| POINTS * sum).collect()
}

/// What is kept of one corner on the way.
#[derive(Default)]
struct Corner {
    reader: Reader,
    last: (f64, f64),
    /// Largest error since the target may have been reached, and since it was for certain.
    late: [f64; 2],
}

fn read(twice: &Modal, signals: &Signals, rest: f64, gammas: &[f64]) -> Bound {
    let count = signals.by.len();
    let mut corners: Vec<Corner> =
        (0..1 << count).map(|_| Corner { late: [f64::NEG_INFINITY; 2], ..Corner::default() }).collect();
    // Sizes of the changes: integral and peak of the error's, peak of its slope and of the command's, by coefficient.
    let mut sizes = vec![[0.0f64; 4]; count];
    let mut before = vec![0.0; count];
    walk(twice, signals, |_, step, now, by| {
        for ((size, last), change) in sizes.iter_mut().zip(&mut before).zip(by) {
            size[0] += 0.5 * step * (change[0].abs() + *last);
            for (k, j) in [(1, 0), (2, 1), (3, 2)] {
                size[k] = size[k].max(change[j].abs());
            }
            *last = change[0].abs();
        }
        let _ = now;
    });
    let total = |k: usize| POINTS * rest * sizes.iter().map(|size| size[k]).sum::<f64>();
    let [area, peak, slope, command] = [0, 1, 2, 3].map(total);
    // The target may have been reached, it has been for certain, and in between the shaft only rose.
    let (mut maybe, mut certain, mut rising) = (false, false, true);
    walk(twice, signals, |time, step, now, by| {
        let (mut lowest, mut highest, mut steepest) = (f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY);
        for (bits, corner) in corners.iter_mut().enumerate() {
            let mut own = *now;
            for (i, change) in by.iter().enumerate() {
                let sign = if bits >> i & 1 == 0 { -1.0 } else { 1.0 };
                own.iter_mut().zip(change).for_each(|(value, change)| *value += sign * change);
            }
            let [error, slope, volts, volts_slope] = own;
            corner.reader.see(
                time,
                step,
                Sample { error, slope, command: volts, command_slope: volts_slope, area: None },
            );
            lowest = lowest.min(error);
            highest = highest.max(error);
            steepest = steepest.max(slope);
            if maybe {
                let mut top = error;
                if step > 0.0 && corner.last.1 > 0.0 && slope <= 0.0 {
                    let cubic = Cubic::new((corner.last.0, error), (step * corner.last.1, step * slope));
                    top = cubic.flat().map(|x| cubic.at(x)).fold(top, f64::max);
                }
                corner.late[0] = corner.late[0].max(top);
                if certain {
                    corner.late[1] = corner.late[1].max(top);
                }
            }
            corner.last = (error, slope);
        }
        maybe |= lowest - peak <= 0.0;
        certain |= highest + peak <= 0.0;
        rising &= !maybe || certain || steepest + slope < 0.0;
    });
    let late = usize::from(certain && rising);
    let under = corners.iter().map(|corner| corner.late[late]).fold(f64::NEG_INFINITY, f64::max) + peak;
    let ends: Vec<Step> = corners.into_iter().map(|corner| corner.reader.finish()).collect();
    let most = |of: fn(&Step) -> f64| ends.iter().map(of).fold(0.0, f64::max);
    let step = Step {
        cost: most(|end| end.cost) + area,
        overshoot: most(|end| end.overshoot) + peak,
        undershoot: if maybe { under.max(0.0) } else { 0.0 },
        command: most(|end| end.command) + command,
    };
    Bound { most: step, shares: gammas.to_vec() }
}

/// Calls `see` with time, step, `[error, slope, command, slope]` of the middle, and the same changes by each coefficient.
fn walk(twice: &Modal, signals: &Signals, mut see: impl FnMut(f64, f64, &[f64; 4], &[[f64; 4]])) {
    let mut by = vec![[0.0; 4]; signals.by.len()];
    twice.walk(f64::INFINITY, FINER, |time, step, state| {
        let of = |error: &[Signal; 2], command: &[Signal; 2]| {
            [error[0].at(state), error[1].at(state), command[0].at(state), command[1].at(state)]
        };
        let now = of(&signals.error, &signals.command);
        for (out, (error, command)) in by.iter_mut().zip(&signals.by) {
            *out = of(error, command);
        }
        see(time, step, &now, &by);
    });
}
