//! The force of a true specimen at a true depth: a smooth elastic curve, and what history makes of it.
//!
//! The elastic curve `E(d)` is one solve. With relaxation, softening, friction or adhesion the whole motion is solved, and the
//! force `F` at its equilibria is kept as the ratio `F / E` (with adhesion, whose force changes sign, as the difference `F - E`), both on one mesh:
//! that is smooth, and it carries the history over to the slightly different depths of another spot.

use std::sync::Arc;

use lut_gen::solid::model::Record;

use super::effect::{Effect, outside};
use super::interpolation::Smooth;
use super::solver::Curve;

/// Depths below this part of the largest say nothing about `F / E`, both being small.
const SHALLOW: f64 = 0.004;

/// The elastic force of one spot.
#[derive(Debug, Clone)]
pub(super) struct Elastic {
    /// Curves for a shear modulus of 1 MPa, and their weights.
    pub parts: Vec<(f64, Arc<Curve>)>,
    /// Factor on the force: the shear modulus.
    pub scale: f64,
    /// Factor (N/mm^1.5) of Hertz's contact on a rigid block.
    pub hertz: f64,
    /// Radius of the ball, mm.
    pub radius_mm: f64,
    /// Cosine of a slope under the specimen.
    pub cosine: f64,
    /// Responses outside the catalogue.
    pub effects: Arc<Vec<Effect>>,
}

impl Elastic {
    /// Force (N) and about its slope (N/mm) at a depth (mm).
    pub fn at(&self, depth_mm: f64) -> (f64, f64) {
        let normal = depth_mm * self.cosine;
        if normal <= 0.0 {
            return (0.0, 0.0);
        }
        let root = normal.sqrt();
        let (mut force, mut slope) = (self.hertz * normal * root, 1.5 * self.hertz * root);
        for (weight, curve) in &self.parts {
            let (f, s) = curve.profile.force_and_slope(normal);
            force += self.scale * weight * f;
            slope += self.scale * weight * s;
        }
        let (factor, addend) = outside::reshaped(&self.effects, normal, self.radius_mm);
        let along = self.cosine * self.cosine;
        (self.cosine * (factor * force + addend), along * (factor * slope + 3.0 * addend / normal))
    }
}

/// The elastic press on the mesh of a motion: the marks that the lines of the mesh leave in both forces are the same at the same depth.
pub(super) struct Twin {
    /// Depth (mm) and force over its power of 3/2 (N/mm^1.5).
    points: Vec<(f64, f64)>,
}

impl Twin {
    /// From equilibria at rising depths and their forces (N).
    pub fn of(press: &Record, force_n: &[f64]) -> Self {
        let each = press.stations.iter().zip(force_n).filter(|(s, _)| s.depth_mm > 0.0);
        Self { points: each.map(|(s, f)| (s.depth_mm, f / (s.depth_mm * s.depth_mm.sqrt()))).collect() }
    }

    /// Force (N) at a depth (mm).
    pub fn at(&self, depth_mm: f64) -> f64 {
        let next = self.points.partition_point(|p| p.0 < depth_mm);
        let factor = match (next.checked_sub(1).and_then(|i| self.points.get(i)), self.points.get(next)) {
            (Some(a), Some(b)) => a.1 + (b.1 - a.1) * (depth_mm - a.0) / (b.0 - a.0),
            (Some(end), None) | (None, Some(end)) => end.1,
            (None, None) => 0.0,
        };
        let depth = depth_mm.max(0.0);
        factor * depth * depth.sqrt()
    }
}

/// What history makes of the elastic force.
#[derive(Debug, Clone)]
pub(super) enum History {
    /// Nothing.
    None,
    /// No time in it: functions of depth on the way down, and of the part of the largest depth that is behind on the way back,
    /// by cycle. What the material remembers of `peak_mm` moves with the largest depth of a spot.
    Branches { down: Vec<Smooth>, back: Vec<Smooth>, added: bool, peak_mm: f64 },
    /// Functions of the time in the run, by cycle.
    Timed { cycles: Vec<Smooth>, added: bool },
}

/// Runs within one record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Timing {
    /// Start of the first run on the record's clock, s.
    pub start_s: f64,
    /// From start to start, s.
    pub period_s: f64,
    /// Runs.
    pub cycles: usize,
}

/// What the recorded depth does at a moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Phase {
    /// Down, until a time (s) of the run.
    Down { end_s: f64 },
    /// Standing.
    Hold,
    /// Back, since a time (s) of the run.
    Back { start_s: f64 },
}

/// Where a ball is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Moment {
    pub time_s: f64,
    pub depth_mm: f64,
    /// Depth that the nominal spot has at this time, mm.
    pub nominal_mm: f64,
    /// Rate of the recorded depth, mm/s.
    pub rate_mm_s: f64,
    /// What the recorded depth does.
    pub phase: Phase,
    /// Largest depth of the run so far, mm.
    pub peak_mm: f64,
    /// Largest depth of earlier runs on the spot, mm; 0 on a fresh one.
    pub before_mm: f64,
    /// On the way back.
    pub back: bool,
    /// From 1.
    pub cycle: usize,
    /// What history does to the force here, of what it does on the nominal spot.
    pub memory: f64,
}

impl Moment {
    /// Time (s) at which the nominal spot was in the state in which this one is now. On the way down it is as long after touch; on
    /// the way back, as far back in parts of the largest depth.
    fn same_state_s(&self) -> f64 {
        let ahead_s = (self.depth_mm - self.nominal_mm) / self.rate_mm_s;
        match self.phase {
            Phase::Down { end_s } => (self.time_s + ahead_s).min(end_s),
            Phase::Hold => self.time_s,
            Phase::Back { start_s } => {
                let behind = (1.0 - self.depth_mm / self.peak_mm.max(1e-9)).clamp(0.0, 1.0);
                (self.time_s - behind * ahead_s).max(start_s)
            }
        }
    }
}

impl History {
    /// From the record of two (or four) ways: down, back, and once more, with its forces (N). `elastic` in the record's units.
    pub fn branches(record: &Record, force_n: &[f64], elastic: &dyn Fn(f64) -> f64, added: bool) -> Self {
        let peak = record.depth_mm.iter().copied().fold(0.0, f64::max);
        let ways = record.stations.iter().map(|s| s.segment).max().map_or(0, |last| last + 1);
        let (mut down, mut back) = (Vec::new(), Vec::new());
        let mut top = if added { 0.0 } else { 1.0 };
        for way in 0..ways {
            let mut points: Vec<(f64, f64)> = share(record, force_n, elastic, added, peak)
                .filter(|(i, _)| record.stations[*i].segment == way)
                .map(|(i, value)| (record.depth_mm[i], value))
                .collect();
            if way % 2 == 0 {
                top = points.last().map_or(top, |p| p.1);
                down.push(Smooth::through(points, top));
            } else {
                for point in &mut points {
                    point.0 = 1.0 - point.0 / peak;
                }
                let whole = std::iter::once((0.0, top)).chain(points.into_iter().filter(|p| p.0 > 1e-9));
                back.push(Smooth::through(whole, top));
            }
        }
        Self::Branches { down, back, added, peak_mm: peak }
    }

    /// From the record of several runs, with its forces (N).
    pub fn timed(record: &Record, force_n: &[f64], elastic: &dyn Fn(f64) -> f64, added: bool, timing: Timing) -> Self {
        let Timing { start_s, period_s, cycles } = timing;
        let peak = record.depth_mm.iter().copied().fold(0.0, f64::max);
        // where the ball begins to stand, or turns, what is left of the elastic force has a corner
        let depth = |i: usize| record.stations.get(i).map(|s| s.depth_mm);
        let way = |i: usize| depth(i + 1).zip(depth(i)).map(|(to, from)| (to - from).partial_cmp(&0.0));
        let corner = |i: usize| i > 0 && way(i) != way(i - 1);
        let all: Vec<(f64, f64, bool)> = share(record, force_n, elastic, added, peak)
            .map(|(i, value)| (record.stations[i].time_s - start_s, value, corner(i)))
            .collect();
        // touch itself: nothing has relaxed yet
        let begin = (-start_s, if added { 0.0 } else { 1.0 });
        let cycle = |n: usize| {
            let from = n as f64 * period_s;
            let inside = all.iter().filter(|(t, ..)| *t > from + begin.0 && *t < from + period_s + begin.0);
            let first = (n == 0).then_some((begin, false));
            Smooth::with_corners(first.into_iter().chain(inside.map(|(t, v, c)| ((t - from, *v), *c))), begin.1)
        };
        Self::Timed { cycles: (0..cycles).map(cycle).collect(), added }
    }

    /// Force (N) at a moment, and about its slope (N/mm).
    pub fn force_n(&self, elastic: &Elastic, at: &Moment) -> (f64, f64) {
        let (force, slope) = elastic.at(at.depth_mm);
        let nth = |all: &[Smooth], x: f64, otherwise: f64| {
            let cycle = at.cycle.saturating_sub(1).min(all.len().saturating_sub(1));
            all.get(cycle).map_or(otherwise, |one| one.at(x))
        };
        let (value, added) = match self {
            Self::None => return (force, slope),
            Self::Branches { down, added, peak_mm, .. } if !at.back => {
                // where an earlier run has turned the force is as on a fresh spot again, wherever that was
                let remembered = at.cycle > 1 && down.len() > 1 && at.before_mm > 0.0;
                let same_mm = if remembered { at.depth_mm * peak_mm / at.before_mm } else { at.depth_mm };
                (nth(down, same_mm, f64::from(u8::from(!added))), *added)
            }
            Self::Branches { back, added, .. } => {
                (nth(back, 1.0 - at.depth_mm / at.peak_mm.max(1e-9), f64::from(u8::from(!added))), *added)
            }
            Self::Timed { cycles, added } => (nth(cycles, at.same_state_s(), f64::from(u8::from(!added))), *added),
        };
        let value = if at.memory == 1.0 { value } else { scaled(value, at.memory, added) };
        if added { (force + elastic.scale * value, slope) } else { (force * value, slope * value.max(0.0)) }
    }
}

/// More or less of what history does: of a part added, or of what is missing from the whole force, which it never turns round.
fn scaled(value: f64, memory: f64, added: bool) -> f64 {
    if added { memory * value } else { (1.0 + memory * (value - 1.0)).max(value.min(0.0)) }
}

/// `F / E` or `F - E` at the stations where it means something.
fn share<'a>(
    record: &'a Record,
    force_n: &'a [f64],
    elastic: &'a dyn Fn(f64) -> f64,
    added: bool,
    peak: f64,
) -> impl Iterator<Item = (usize, f64)> + 'a {
    force_n.iter().zip(&record.depth_mm).enumerate().filter_map(move |(i, (&force, &depth))| {
        let expected = elastic(depth);
        if added {
            return Some((i, force - expected));
        }
        (depth > SHALLOW * peak && expected > 0.0).then(|| (i, force / expected))
    })
}
