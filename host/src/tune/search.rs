//! Several starts, and from each `cobyla` and then `slsqp`.

use super::gains::Gains;
use super::programme::{Programme, Values};

/// Points that are looked at before the searches begin.
const SCATTERED: usize = 96;
/// Searches.
const SEARCHES: usize = 4;
/// Distance of starts from each other, in variables of about unit size.
const APART: f64 = 0.25;

/// Variables of the search, all of about unit size: `kp`, `ki` and the first command of the derivative, `kd n`, in parts of their
/// scales, and the logarithm of `n`. The limit of the first command is a plane in them.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Space {
    /// Size of `kp` and `kd n`, V/mm.
    pub command: f64,
    /// Size of `ki`, V/(mm s).
    pub integral: f64,
    /// Bounds of `n`, rad/s.
    pub corner: (f64, f64),
    /// Largest gains.
    pub most: Gains,
}

impl Space {
    /// Gains of a point.
    pub fn gains(&self, x: &[f64]) -> Gains {
        let n = self.corner.0 * (self.corner.1 / self.corner.0).powf(x[3].clamp(0.0, 1.0));
        let within = |value: f64, most: f64| value.clamp(0.0, most);
        Gains {
            kp: within(self.command * x[0], self.most.kp),
            ki: within(self.integral * x[1], self.most.ki),
            kd: within(self.command * x[2] / n, self.most.kd),
            n,
        }
    }

    /// The point of gains.
    pub fn point(&self, gains: &Gains) -> Vec<f64> {
        let n = gains.n.clamp(self.corner.0, self.corner.1);
        vec![
            gains.kp / self.command,
            gains.ki / self.integral,
            gains.kd * gains.n / self.command,
            (n / self.corner.0).ln() / (self.corner.1 / self.corner.0).ln(),
        ]
    }

    /// Bounds of the variables.
    pub fn bounds(&self) -> [(f64, f64); 4] {
        [
            (0.0, (self.most.kp / self.command).min(3.0)),
            (0.0, (self.most.ki / self.integral).min(20.0)),
            (0.0, 3.0),
            (0.0, 1.0),
        ]
    }
}

/// Where a search ended.
#[derive(Debug, Clone)]
pub(super) struct Found {
    pub gains: Gains,
    pub values: Values,
    /// Points that were valued.
    pub calls: usize,
    /// Costs at the ends of the searches, the best first; of the good ones.
    pub ends: Vec<f64>,
}

/// Where searches begin.
#[derive(Debug, Clone)]
pub(super) enum Begin {
    /// At the best of many points all over the space, these among them.
    Scattered(Vec<Gains>),
    /// Here.
    From(Vec<Gains>),
}

/// How exact the values are, and what is to be spared.
#[derive(Debug, Clone, Copy)]
pub(super) struct Precision {
    /// Step of difference quotients.
    pub quotient: f64,
    /// Room that is left at limits.
    pub spare: f64,
}

/// The best gains of several searches.
pub(super) fn search(
    of: &dyn Fn(&Gains) -> Values,
    space: &Space,
    begin: &Begin,
    precision: Precision,
) -> Option<Found> {
    let bounds = space.bounds();
    let valued = |x: &[f64]| of(&space.gains(x));
    let programme = Programme::new(&valued, &bounds, precision.quotient, precision.spare);
    let starts = match begin {
        Begin::From(starts) => starts.iter().map(|gains| space.point(gains)).collect(),
        Begin::Scattered(starts) => {
            best_apart(&programme, starts.iter().map(|gains| space.point(gains)).chain(scattered()))
        }
    };
    let mut ends: Vec<(Vec<f64>, Values)> = Vec::new();
    for start in &starts {
        programme.forget();
        programme.cobyla(start, 0.1, 150);
        if let Some((x, _)) = programme.best() {
            programme.sqp(&x, 40);
        }
        ends.extend(programme.best());
    }
    ends.sort_by(|a, b| {
        if a.1.better(&b.1, programme.slack) { std::cmp::Ordering::Less } else { std::cmp::Ordering::Greater }
    });
    // The best end once more by small steps: kinks between worst cases stop a search that relies on slopes.
    let (x, _) = ends.first()?.clone();
    programme.cobyla(&x, 0.01, 150);
    let (x, values) =
        programme.best().filter(|best| !ends[0].1.better(&best.1, programme.slack)).unwrap_or_else(|| ends[0].clone());
    let good = |values: &Values| values.broken() <= programme.slack;
    let ends = ends.iter().filter(|end| good(&end.1)).map(|end| end.1.cost()).collect();
    Some(Found { gains: space.gains(&x), values, calls: programme.calls(), ends })
}

/// The best of some points that are apart from each other.
fn best_apart(programme: &Programme<'_>, points: impl Iterator<Item = Vec<f64>>) -> Vec<Vec<f64>> {
    // A start that breaks limits is worth a search if it costs little: both count.
    let worth = |x: &[f64]| {
        let values = programme.values(x);
        values.cost() * (1.0 + 10.0 * values.broken())
    };
    let mut points: Vec<(f64, Vec<f64>)> = points.map(|x| (worth(&x), x)).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut chosen: Vec<Vec<f64>> = Vec::new();
    for (_, x) in points {
        let near = |other: &Vec<f64>| other.iter().zip(&x).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt() < APART;
        if chosen.len() < SEARCHES && !chosen.iter().any(near) {
            chosen.push(x);
        }
    }
    chosen
}

/// Points that fill the space evenly: an additive recurrence with the powers of the root of x^5 = x + 1.
fn scattered() -> impl Iterator<Item = Vec<f64>> {
    let ratio = 1.0 / 1.167_303_978_261_418_7_f64;
    (1..=SCATTERED).map(move |i| {
        let part = |k: i32| (0.5 + i as f64 * ratio.powi(k)).fract();
        vec![part(1), 2.0 * part(2), part(3), part(4)]
    })
}
