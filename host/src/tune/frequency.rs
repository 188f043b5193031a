//! Frequency responses of the open loop and what is read of them.

use nalgebra::Complex;
use serde::Serialize;
use std::f64::consts::PI;

use super::discrete::Held;
use super::gains::Gains;
use super::way::Way;
use crate::actuator::plant::Plant;
use crate::actuator::polynomial::Polynomial;
use crate::actuator::uncertain::Uncertain;

/// Points of the frequencies that margins are read from.
const POINTS: usize = 1500;
/// Points while gains are searched.
const COARSE: usize = 250;
/// Decades below and above the plant's own frequencies.
const BEYOND: f64 = 100.0;

/// The plant, as the loop sees it: behind a hold where it is sampled.
#[derive(Debug, Clone)]
enum Seen {
    Continuous(Plant),
    Sampled { numerator: Polynomial, denominator: Polynomial, tick_s: f64, late: i32 },
}

/// The open loop of a plant.
#[derive(Debug, Clone)]
pub struct OpenLoop {
    seen: Seen,
    /// Lowest and highest frequency that is looked at, rad/s.
    range: (f64, f64),
}

impl OpenLoop {
    /// Prepares a plant.
    pub fn new(way: Way, plant: &Plant) -> Self {
        let sizes: Vec<f64> = plant
            .denominator
            .roots()
            .unwrap_or_default()
            .iter()
            .map(|root| root.norm())
            .filter(|size| *size > 0.0)
            .collect();
        let low = sizes.iter().copied().fold(f64::INFINITY, f64::min);
        let high = sizes.iter().copied().fold(0.0, f64::max);
        let (low, high) = if high > 0.0 { (low / BEYOND, high * BEYOND) } else { (1.0 / BEYOND, BEYOND) };
        match way {
            Way::Continuous => Self { seen: Seen::Continuous(plant.clone()), range: (low, high) },
            Way::Sampled(sampling) => {
                let exact = Uncertain { plant: plant.clone(), bounds: Vec::new() };
                let held = Held::of(&exact, sampling.tick_s, &[], &[]);
                let values = |list: &[super::interval::Jet]| {
                    Polynomial::new(list.iter().map(|jet| jet.value.middle()).collect())
                };
                let top = PI / sampling.tick_s;
                let seen = Seen::Sampled {
                    numerator: values(&held.numerator),
                    denominator: values(&held.denominator),
                    tick_s: sampling.tick_s,
                    late: (held.ticks + sampling.ticks_late) as i32,
                };
                Self { seen, range: (low.min(top / BEYOND), top) }
            }
        }
    }

    /// The loop gain at a frequency.
    pub fn at(&self, gains: &Gains, w_rad_s: f64) -> Complex<f64> {
        self.plant(w_rad_s) * self.controller(gains, w_rad_s)
    }

    /// The plant alone, with the hold and every delay, mm/V.
    pub fn plant(&self, w_rad_s: f64) -> Complex<f64> {
        match &self.seen {
            Seen::Continuous(plant) => plant.response(w_rad_s),
            Seen::Sampled { numerator, denominator, tick_s, late } => {
                let z = Complex::from_polar(1.0, w_rad_s * tick_s);
                numerator.value(z) / denominator.value(z) * z.powi(-late)
            }
        }
    }

    fn controller(&self, gains: &Gains, w_rad_s: f64) -> Complex<f64> {
        let Gains { kp, ki, kd, n } = *gains;
        match &self.seen {
            Seen::Continuous(_) => {
                let s = Complex::new(0.0, w_rad_s);
                s.inv() * ki + s * (kd * n) / (s + n) + kp
            }
            Seen::Sampled { tick_s, .. } => {
                let back = Complex::from_polar(1.0, -w_rad_s * tick_s);
                let difference = Complex::new(1.0, 0.0) - back;
                let filter = Complex::new(1.0 + n * tick_s, 0.0) - back;
                difference.inv() * (ki * tick_s) + difference * (kd * n) / filter + kp
            }
        }
    }

    /// Frequencies on even steps of their logarithm, rad/s.
    pub fn frequencies(&self, count: usize) -> Vec<f64> {
        let (low, high) = self.range;
        let part = |i: usize| low * (high / low).powf(i as f64 / (count - 1) as f64);
        (0..count).map(part).collect()
    }

    /// What is read of the loop.
    pub fn margins(&self, gains: &Gains) -> Margins {
        let w = self.frequencies(POINTS);
        let l = |w: f64| self.at(gains, w);
        let closed = |w: f64| (l(w) / (l(w) + 1.0)).norm();
        let sensitivity = |w: f64| (l(w) + 1.0).norm().recip();
        let crossings = downward(&w, &|w| l(w).norm() - 1.0);
        let phase = |w: &f64| wrapped(l(*w).arg() + PI);
        let worst = crossings.iter().copied().min_by(|a, b| phase(a).total_cmp(&phase(b)));
        // Angles that a delay may still turn by: from above -180 degrees down.
        let delay = crossings.iter().map(|w| phase(w).rem_euclid(2.0 * PI) / w).reduce(f64::min);
        let turned = downward(&w, &|w| -l(w).im).into_iter().chain(downward(&w, &|w| l(w).im));
        let gain = turned.filter(|w| l(*w).re < 0.0 && l(*w).re > -1.0).map(|w| -1.0 / l(w).re).reduce(f64::min);
        let top = w.iter().copied().max_by(|a, b| sensitivity(*a).total_cmp(&sensitivity(*b))).unwrap_or(1.0);
        let step = (w[1] / w[0]).powi(2);
        let peak_at = highest(&sensitivity, top / step, top * step);
        Margins {
            bandwidth_hz: downward(&w, &|w| closed(w) - 10f64.powf(-0.15)).last().map(|w| w / (2.0 * PI)),
            half_power_hz: downward(&w, &|w| closed(w) - 0.5f64.sqrt()).last().map(|w| w / (2.0 * PI)),
            phase_margin_deg: worst.map(|w| phase(&w).to_degrees()),
            crossover_rad_s: worst,
            gain_margin: gain,
            delay_margin_s: delay,
            peak_sensitivity: sensitivity(peak_at),
            peak_at_rad_s: peak_at,
        }
    }
}

/// Bandwidth and margins of a loop; what it does not have is none.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Margins {
    /// Where the closed loop has fallen by 3 dB, a factor `10^(-3/20)`, Hz.
    pub bandwidth_hz: Option<f64>,
    /// Where it has fallen to the root of one half, Hz.
    pub half_power_hz: Option<f64>,
    /// Smallest phase margin, degrees.
    pub phase_margin_deg: Option<f64>,
    /// Where it is, rad/s.
    pub crossover_rad_s: Option<f64>,
    /// Factor by which the gain may rise; none where it may rise without an end.
    pub gain_margin: Option<f64>,
    /// Delay that may be added, s.
    pub delay_margin_s: Option<f64>,
    /// Largest sensitivity, 1 over the distance of the open loop from -1.
    pub peak_sensitivity: f64,
    /// Where it is, rad/s.
    pub peak_at_rad_s: f64,
}

/// Peak sensitivity and phase margin (degrees) on few frequencies, with the plant's response known: while gains are searched.
#[derive(Debug, Clone)]
pub(super) struct Coarse {
    open: OpenLoop,
    points: Vec<(f64, Complex<f64>)>,
}

impl Coarse {
    pub fn new(open: OpenLoop) -> Self {
        let points = open.frequencies(COARSE).into_iter().map(|w| (w, open.plant(w))).collect();
        Self { open, points }
    }

    /// Peak sensitivity, and the smallest phase margin in degrees; 180 for a loop that never has a gain of 1.
    pub fn margins(&self, gains: &Gains) -> (f64, f64) {
        let l: Vec<Complex<f64>> =
            self.points.iter().map(|(w, plant)| plant * self.open.controller(gains, *w)).collect();
        let distance: Vec<f64> = l.iter().map(|l| (l + 1.0).norm()).collect();
        let mut phase = 180.0f64;
        for pair in l.windows(2) {
            let (a, b) = (pair[0].norm().ln(), pair[1].norm().ln());
            if a >= 0.0 && b < 0.0 {
                // The angle between the points, where the gain is 1.
                let turn = wrapped((pair[1] / pair[0]).arg());
                let angle = pair[0].arg() + turn * a / (a - b);
                phase = phase.min(wrapped(angle + PI).to_degrees());
            }
        }
        let near = (1..distance.len().saturating_sub(1)).min_by(|a, b| distance[*a].total_cmp(&distance[*b]));
        let peak = near.map_or(1.0, |i| {
            // The parabola through three points.
            let (a, b, c) = (distance[i - 1], distance[i], distance[i + 1]);
            let bend = a - 2.0 * b + c;
            let least = if bend > 0.0 { b - (a - c).powi(2) / (8.0 * bend) } else { b };
            1.0 / least.max(1e-9)
        });
        (peak, phase)
    }
}

/// An angle within half a turn of 0.
fn wrapped(angle: f64) -> f64 {
    (angle + PI).rem_euclid(2.0 * PI) - PI
}

/// Where a function falls through 0, by halving between points.
fn downward(w: &[f64], f: &dyn Fn(f64) -> f64) -> Vec<f64> {
    let values: Vec<f64> = w.iter().map(|w| f(*w)).collect();
    let falls = (1..w.len()).filter(|i| values[i - 1] >= 0.0 && values[*i] < 0.0);
    falls
        .map(|i| {
            let (mut low, mut high) = (w[i - 1], w[i]);
            for _ in 0..50 {
                let middle = 0.5 * (low + high);
                if f(middle) >= 0.0 { low = middle } else { high = middle }
            }
            0.5 * (low + high)
        })
        .collect()
}

/// Where a function with one peak between two points is highest, by the golden section.
fn highest(f: &dyn Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let part = 0.5 * (5f64.sqrt() - 1.0);
    for _ in 0..60 {
        let (a, b) = (high - part * (high - low), low + part * (high - low));
        if f(a) > f(b) { high = b } else { low = a }
    }
    0.5 * (low + high)
}
