//! Which curve the display shows, and how it goes over to another one.
//!
//! # The transition
//! Curves are exchanged by mixing: over [`FADE_TICKS`] the share of the new one rises evenly from 0 to 1, at
//! every force between what both ask for. So an exchange in the middle of a press moves shaft and current by a
//! fiftieth of the difference of both a tick, and nothing jumps. A curve that is asked for meanwhile waits for
//! the end of the transition.

use crate::display::DisplayConfig;
use crate::finger::pulp;
use crate::number::{larger, limit};
use protocol::TICK_HZ;
use protocol::lut::{Between, Current, Table, mixed};
use protocol::message::Curve;

/// Ticks of a transition: one second. A tick then changes what is felt by 2 % of the difference of both curves.
/// Of two materials that differ by all of the felt force that is an eighth of the least change that a finger
/// tells (Weber fraction 15 %).
pub const FADE_TICKS: u16 = TICK_HZ as u16;

/// What a curve asks for at a force.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Wanted {
    /// Shaft position that the force asks for, mm.
    pub shaft_mm: f32,
    /// What the finger's place adds to it, mm: 0 where that is not known.
    pub leads_mm: f32,
    /// Coil current; `None` without control curve.
    pub current: Option<Current>,
    /// Error bound of the current, A; 0 without control curve.
    pub bound_a: f32,
    /// What the material bears at the finger's place, N, where that decides the current.
    pub bears_n: Option<f32>,
    /// It is one curve's, and not what two are mixed to: only then does a force tell how a curve is off.
    pub is_settled: bool,
}

/// The force that shaft and coil answer to: what is read, and while that is less, what they wait at.
///
/// A sensor with a threshold tells no force below it. The shaft waits where the threshold's force will have it, so
/// nothing jumps when the finger begins to be felt.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Felt {
    /// The shaft's, N.
    pub shaft_n: f32,
    /// The coil's, N; the least of it where the finger's place decides.
    pub coil_n: f32,
    /// Place of the finger below the surface, mm, where that decides the current: the coil answers to the force
    /// that the material would bear there (`docs/decisions/0024-the-fingers-place.md`).
    pub place_mm: Option<f32>,
    /// Where the finger will be when the shaft has followed, mm below the surface, if that decides with the force
    /// where the shaft is wanted (`docs/decisions/0031-ahead-of-the-lag.md`).
    pub ahead_mm: Option<f32>,
}

/// Where a curve comes from.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Origin {
    /// Number of the palpation; 0 for a curve that was asked for by itself.
    pub of_palpation: u32,
    /// How far travel may be off that of the identified material, as fraction of it.
    pub departs: f32,
    /// The material lies not between entries.
    pub outside: bool,
}

/// The curve that is shown, the one before it during a transition, and the next one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Showing {
    from: Curve,
    to: (Curve, Origin),
    next: (Curve, Origin),
    /// Ticks until the end of the transition.
    left: u16,
}

impl Showing {
    /// Nothing is shown.
    pub const NOTHING: Showing = Showing::of(Curve::NONE, Origin::ASKED);

    /// A curve that is shown from the beginning.
    pub const fn of(curve: Curve, origin: Origin) -> Self {
        Showing { from: Curve::NONE, to: (curve, origin), next: (Curve::NONE, Origin::ASKED), left: 0 }
    }

    /// True if there is no curve.
    pub const fn is_nothing(&self) -> bool {
        self.to.0.low == Curve::NO_ENTRY
    }

    /// The curve that is shown, or gone over to.
    pub const fn to(&self) -> Curve {
        self.to.0
    }

    /// Where it comes from.
    pub const fn origin(&self) -> Origin {
        self.to.1
    }

    /// How far it has been gone over to, 0 to 1.
    pub fn share(&self) -> f32 {
        1.0 - f32::from(self.left) / f32::from(FADE_TICKS)
    }

    /// Goes over to a curve. None changes nothing, and the one that is shown only where it comes from.
    pub fn go_over(&mut self, curve: Curve, origin: Origin) {
        if curve == Curve::NONE {
            return;
        }
        if self.left > 0 {
            self.next = (curve, origin);
        } else if curve == self.to() {
            self.to.1 = origin;
        } else {
            *self = Showing { from: self.to(), left: FADE_TICKS, ..Showing::of(curve, origin) };
        }
    }

    /// One tick.
    pub fn step(&mut self) {
        self.left = self.left.saturating_sub(1);
        if self.left == 0 {
            let (next, origin) = self.next;
            *self = Showing::of(self.to(), self.origin());
            self.go_over(next, origin);
        }
    }

    /// What is wanted at a force; nothing without a curve, or without its entries in the table. `still_mm` is
    /// where the shaft stays as long as nothing is shown.
    pub fn at(&self, table: &Table<'_>, felt: Felt, still_mm: f32) -> Option<Wanted> {
        let of = |curve: Curve| {
            let between = Between::new(table, curve.low, curve.high, curve.weight)?;
            let bears_n = felt.place_mm.map(|mm| between.force_at(mm, pulp::compression_mm));
            let coil_n = bears_n.map_or(felt.coil_n, |n| larger(n, felt.coil_n));
            Some(Wanted {
                shaft_mm: between.shaft_mm(felt.shaft_n),
                leads_mm: felt.leads_mm(&between),
                current: between.current(coil_n),
                bound_a: between.bound_a(coil_n).unwrap_or(0.0),
                bears_n,
                is_settled: true,
            })
        };
        let to = of(self.to())?;
        if self.left == 0 {
            return Some(to);
        }
        let from = of(self.from).unwrap_or(Wanted { shaft_mm: still_mm, ..Wanted::default() });
        Some(from.mixed(&to, self.share()))
    }
}

impl Origin {
    /// Asked for by itself.
    pub const ASKED: Origin = Origin { of_palpation: 0, departs: 0.0, outside: false };
}

impl Felt {
    /// Of a reading and the least that the sensor tells, both N.
    pub fn new(config: &DisplayConfig, read_n: f32, least_n: f32) -> Self {
        let shaft_n = larger(read_n, limit(least_n, 0.0, config.least_max_n));
        Felt { shaft_n, coil_n: larger(shaft_n, config.coil_standby_n), place_mm: None, ahead_mm: None }
    }

    /// The same where the finger's place, mm, decides the current.
    #[must_use]
    pub fn at_place(self, config: &DisplayConfig, place_mm: f32) -> Self {
        Felt { coil_n: config.coil_standby_n, place_mm: Some(place_mm), ..self }
    }

    /// How much farther the finger's place wants the shaft than its force does, mm: half of it, for both are heard alike.
    ///
    /// What the place wants is taken along the curve's tangent: a finger's travel is shared by surface and pulp as they
    /// give way. On a soft material a force that is read changes by every step of the shaft; the place does not.
    fn leads_mm(&self, between: &Between<'_>) -> f32 {
        /// Part of the place in what is wanted: with all of it an error of the force would take seconds to go.
        const BY_PLACE: f32 = 0.5;
        /// Length of the tangent, N: a few steps of a curve.
        const TANGENT_N: f32 = 0.05;
        let Some(ahead_mm) = self.ahead_mm else { return 0.0 };
        let force_n = self.shaft_n;
        let (shaft_mm, pulp_mm) = (between.shaft_mm(force_n), pulp::compression_mm(force_n));
        let gives_mm = between.shaft_mm(force_n + TANGENT_N) - shaft_mm;
        let both_mm = gives_mm + pulp::compression_mm(force_n + TANGENT_N) - pulp_mm;
        let share = if gives_mm > 0.0 { gives_mm / both_mm } else { 0.0 };
        BY_PLACE * share * (ahead_mm - shaft_mm - pulp_mm)
    }
}

impl Wanted {
    /// Mixed with the share `share` of another one. What has no control curve mixes as no current.
    fn mixed(&self, to: &Wanted, share: f32) -> Wanted {
        let none = Current { a: 0.0, unreachable: false };
        let current = match (self.current, to.current) {
            (None, None) => None,
            (from, to) => {
                let (from, to) = (from.unwrap_or(none), to.unwrap_or(none));
                Some(Current { a: mixed(from.a, to.a, share), unreachable: from.unreachable || to.unreachable })
            }
        };
        Wanted {
            shaft_mm: mixed(self.shaft_mm, to.shaft_mm, share),
            leads_mm: mixed(self.leads_mm, to.leads_mm, share),
            current,
            bound_a: mixed(self.bound_a, to.bound_a, share),
            bears_n: to.bears_n,
            is_settled: false,
        }
    }
}

#[cfg(test)]
mod tests;
