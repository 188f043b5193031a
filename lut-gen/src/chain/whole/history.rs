//! What a force remembers of its path, and what of the path has to be solved for that.

use super::contains::has;
use super::path::{along, deepest_mm, turns};
use super::run::Curve;
use crate::chain::Model;
use crate::effect::{friction, relaxation, softening};

/// What a force depends on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum History {
    /// The depth alone.
    None,
    /// The depths at which the motion turned.
    Turns,
    /// Everything, at its time.
    Time,
}

impl History {
    pub fn of(model: &Model) -> Self {
        match (has(model, &relaxation::ONE), has(model, &softening::EFFECT) || has(model, &friction::EFFECT)) {
            (true, _) => Self::Time,
            (false, true) => Self::Turns,
            (false, false) => Self::None,
        }
    }

    /// What of straight pieces has to be solved.
    pub fn path(self, pieces: Curve) -> Curve {
        match self {
            Self::Time => pieces,
            Self::Turns => turned(&pieces),
            Self::None => {
                vec![(0.0, 0.0), (1.0, deepest_mm(&pieces))]
            }
        }
    }

    /// Where on such a path a point (s, mm) lies.
    pub fn place(self, path: &[(f64, f64)], (time_s, depth_mm): (f64, f64)) -> f64 {
        match self {
            Self::Time => time_s,
            Self::Turns => along(path, (time_s, depth_mm.max(0.0))),
            Self::None => depth_mm / path.last().map_or(1.0, |p| p.1).max(f64::MIN_POSITIVE),
        }
    }
}

/// The turns of straight pieces, from the touch on and never above it.
fn turned(pieces: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut own = turns(pieces);
    own.iter_mut().for_each(|p| p.1 = p.1.max(0.0));
    own.iter_mut().take(1).for_each(|p| p.1 = 0.0);
    own
}

pub(super) fn a_second_a_millimetre(turns: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut at_s = 0.0;
    let mut before = None;
    turns
        .iter()
        .map(|(_, depth_mm)| {
            at_s += before.map_or(0.0, |b: f64| (depth_mm - b).abs());
            before = Some(*depth_mm);
            (at_s, *depth_mm)
        })
        .collect()
}
