//! The same bound as [`super::bound`] for sampled loops, at their ticks.
//!
//! The plant's coefficients in `z` are smooth functions of the uncertain ones: a tangent in the middle of the box, and a bend that
//! interval arithmetic bounds. The tangent takes the place of the coefficients there, the bend is added by its size.

use super::bound::{Bound, SMALL_GAIN};
use super::continuous::Loop;
use super::discrete::Held;
use super::gains::Gains;
use super::sampled::Sampling;
use super::step::Step;
use crate::actuator::plant::Plant;
use crate::actuator::polynomial::Polynomial;
use crate::actuator::uncertain::{Coefficient, Uncertain};

/// A loop has settled when its slowest mode has fallen by `exp(-OVER)`.
const OVER: f64 = 30.0;
/// Ticks at most.
const TICKS: f64 = 20_000.0;

/// A signal of a loop over ticks.
type Series = Vec<f64>;

/// Impulse responses of `z^m/chi` and of `z^(2m)/chi^2`.
struct Responses {
    order: usize,
    once: Series,
    twice: Series,
}

impl Responses {
    fn of(chi: &Polynomial, ticks: usize) -> Self {
        let order = chi.degree();
        let filtered = |input: &dyn Fn(usize) -> f64| {
            let mut out = vec![0.0; ticks];
            for k in 0..ticks {
                let before = (0..order).filter(|i| k + i >= order).map(|i| chi.at(i) * out[k + i - order]);
                out[k] = input(k) - before.sum::<f64>();
            }
            out
        };
        let once = filtered(&|k| if k == 0 { 1.0 } else { 0.0 });
        let twice = filtered(&|k| once[k]);
        Self { order, once, twice }
    }

    fn through(of: &Series, delay: usize, numerator: &Polynomial) -> Series {
        let at = |k: usize| {
            let parts = numerator.coefficients().iter().enumerate().filter(|(j, _)| k + j >= delay);
            parts.map(|(j, c)| c * of[k + j - delay]).sum()
        };
        (0..of.len()).map(at).collect()
    }

    /// Impulse response of `numerator/chi`.
    fn first(&self, numerator: &Polynomial) -> Series {
        Self::through(&self.once, self.order, numerator)
    }

    /// Step response of `numerator/chi^2`.
    fn second(&self, numerator: &Polynomial) -> Series {
        summed(Self::through(&self.twice, 2 * self.order, numerator))
    }
}

fn summed(mut series: Series) -> Series {
    let mut sum = 0.0;
    for x in &mut series {
        sum += *x;
        *x = sum;
    }
    series
}

fn size(series: &Series) -> f64 {
    series.iter().map(|x| x.abs()).sum()
}

fn peak(series: &Series) -> f64 {
    series.iter().fold(0.0, |most, x| most.max(x.abs()))
}

fn jumps(series: &Series) -> f64 {
    series.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max)
}

/// A change of the plant's polynomials.
type Change = (Polynomial, Polynomial);

/// Changes by the tangent of each coefficient over its half width, and the bends of the coefficients in `z`.
fn changes(
    uncertain: &Uncertain,
    tick_s: f64,
    middle: &[f64],
    halves: &[f64],
) -> (Change, usize, Vec<Change>, Vec<Change>) {
    let point = Held::of(uncertain, tick_s, middle, &vec![0.0; halves.len()]);
    let whole = Held::of(uncertain, tick_s, middle, halves);
    let by = |list: &[super::interval::Jet], of: &dyn Fn(&super::interval::Jet) -> f64| {
        Polynomial::new(list.iter().map(of).collect())
    };
    let own = (by(&point.numerator, &|jet| jet.value.middle()), by(&point.denominator, &|jet| jet.value.middle()));
    let tangents = halves.iter().enumerate().map(|(i, half)| {
        let slope = |jet: &super::interval::Jet| jet.slope(i).middle() * half;
        (by(&point.numerator, &slope), by(&point.denominator, &slope))
    });
    let none = Polynomial::new(vec![0.0]);
    let mut bends = Vec::new();
    for (k, jet) in whole.numerator.iter().enumerate() {
        bends.push((Polynomial::monomial(jet.bend(halves), k), none.clone()));
    }
    for (k, jet) in whole.denominator.iter().enumerate() {
        bends.push((none.clone(), Polynomial::monomial(jet.bend(halves), k)));
    }
    bends.retain(|(b, a)| *b != none || *a != none);
    (own, point.ticks, tangents.collect(), bends)
}

/// The closed loop in `z`.
pub(super) fn closed(plant: &Plant, sampling: Sampling, gains: &Gains) -> Loop {
    let exact = Uncertain { plant: plant.clone(), bounds: Vec::new() };
    let ((b, a), ticks, _, _) = changes(&exact, sampling.tick_s, &[], &[]);
    let (d, e) = gains.sampled(sampling.tick_s, sampling.ticks_late + ticks);
    Loop::of(b, a, d, e)
}

/// Bounds over the box, or none where no bound is found: divide the box.
pub(super) fn bound(
    uncertain: &Uncertain,
    sampling: Sampling,
    gains: &Gains,
    middle: &[f64],
    halves: &[f64],
) -> Result<Bound, Vec<f64>> {
    if let Some(shares) = across(uncertain, sampling.tick_s, middle, halves) {
        return Err(shares);
    }
    let ((b, a), ticks, tangents, bends) = changes(uncertain, sampling.tick_s, middle, halves);
    let (d, e) = gains.sampled(sampling.tick_s, sampling.ticks_late + ticks);
    let own = Loop::of(b, a, d, e);
    let even = || vec![1.0; halves.len()];
    let roots = own.chi.roots().ok_or_else(even)?;
    let slowest = roots.iter().map(|root| root.norm()).fold(0.0, f64::max);
    let stable = slowest < 1.0;
    if !stable {
        return Err(even());
    }
    let length = (OVER / -slowest.ln()).min(TICKS) as usize + 3 * own.chi.degree();
    let responses = Responses::of(&own.chi, length);
    let gamma_of = |(db, da): &Change| size(&responses.first(&(&(da * &own.e) + &(db * &own.d))));
    let mut shares: Vec<f64> = tangents.iter().map(gamma_of).collect();
    let bent: f64 = bends.iter().map(gamma_of).sum();
    let gamma = shares.iter().sum::<f64>() + bent;
    // A bend is divided by dividing whatever bends most; all share it.
    shares.iter_mut().for_each(|share| *share += bent / halves.len() as f64);
    let small = gamma < SMALL_GAIN;
    if !small {
        return Err(shares);
    }
    let signals = |(db, da): &Change| {
        let change = &own.d * &(&(&own.b * da) + &(&own.a * db).scaled(-1.0));
        [responses.second(&(&own.e * &change)), responses.second(&(&own.d * &change))]
    };
    let by: Vec<[Series; 2]> = tangents.iter().map(signals).collect();
    let extra: Vec<[Series; 2]> = bends.iter().map(signals).collect();
    let error = summed(responses.first(&(&own.e * &own.a)));
    let command = summed(responses.first(&(&own.d * &own.a)));
    // What is not in the tangent: the bends themselves, and the remainder of both.
    let rest = gamma / (1.0 - gamma);
    let left = |which: usize, of: fn(&Series) -> f64| {
        let total = |list: &[[Series; 2]]| list.iter().map(|pair| of(&pair[which])).sum::<f64>();
        rest * total(&by) + (1.0 + rest) * total(&extra)
    };
    let room = [left(0, size), left(0, peak), left(0, jumps), left(1, peak)];
    Ok(Bound { most: read(&error, &command, &by, room, sampling.tick_s), shares })
}

/// If the dead time crosses a tick within the box: a wish to divide it along the dead time.
fn across(uncertain: &Uncertain, tick_s: f64, middle: &[f64], halves: &[f64]) -> Option<Vec<f64>> {
    let i = uncertain.bounds.iter().position(|(which, _, _)| *which == Coefficient::Delay)?;
    let ticks = |value: f64| (value / tick_s + 1e-9).floor();
    let same = ticks(middle[i] - halves[i]) == ticks(middle[i] + halves[i] - 2e-9 * tick_s);
    (!same).then(|| (0..halves.len()).map(|j| if i == j { 1.0 } else { 0.0 }).collect())
}

/// Cost and peaks at the worst corner, with room for what is not linear.
fn read(error: &Series, command: &Series, by: &[[Series; 2]], room: [f64; 4], tick_s: f64) -> Step {
    let [area, peak, jump, volts] = room;
    let corners = 1usize << by.len();
    let at = |bits: usize, which: usize, base: &Series, k: usize| {
        let sign = |i: usize| if bits >> i & 1 == 0 { -1.0 } else { 1.0 };
        base[k] + by.iter().enumerate().map(|(i, pair)| sign(i) * pair[which][k]).sum::<f64>()
    };
    let mut most = Step { cost: 0.0, overshoot: 0.0, undershoot: 0.0, command: 0.0 };
    let errors: Vec<Series> =
        (0..corners).map(|bits| (0..error.len()).map(|k| at(bits, 0, error, k)).collect()).collect();
    for (bits, errors) in errors.iter().enumerate() {
        most.cost = most.cost.max(tick_s * (size(errors) + area));
        most.overshoot = errors.iter().fold(most.overshoot, |most, e| most.max(peak - e));
        let commands = (0..command.len()).map(|k| at(bits, 1, command, k).abs() + volts);
        most.command = commands.fold(most.command, f64::max);
    }
    let over = |k: usize, of: fn(f64, f64) -> f64| errors.iter().map(|e| e[k]).reduce(of).unwrap_or(0.0);
    let first = (0..error.len()).find(|k| over(*k, f64::min) - peak <= 0.0);
    let Some(first) = first else { return most };
    let certain = (first..error.len()).find(|k| over(*k, f64::max) + peak <= 0.0);
    let rises = |k: usize| errors.iter().all(|e| e[k] - e[k - 1] + jump < 0.0);
    let from = certain.filter(|certain| (first + 1..=*certain).all(rises)).unwrap_or(first);
    most.undershoot = (from..error.len()).map(|k| over(k, f64::max) + peak).fold(0.0, f64::max);
    most
}
