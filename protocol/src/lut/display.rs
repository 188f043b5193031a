//! How the display shows a material: shaft position and coil current over the finger's force.

use super::bytes::{f32_at, u16_at, u32_at};
use super::{CURRENT_MAX_A, MAX_NODES, is_scale};

/// What of a display curve breaks a rule.
pub(super) type Rule = &'static str;

/// Slack of a comparison of two numbers that are rounded to f32.
const ROUNDED: f32 = 1.0 + 1e-6;

/// Display curve, borrowed from the table.
#[derive(Debug, Clone, Copy)]
pub(super) struct DisplayCurve<'a> {
    nodes: Nodes<'a>,
    mm_per_count: f32,
    shaft: &'a [u8],
    coil: Option<Coil<'a>>,
}

/// Forces of the nodes.
#[derive(Debug, Clone, Copy)]
enum Nodes<'a> {
    /// Version 1: the point i is at (i + 1) steps of this force, N; without force there is no
    /// displacement, and no point.
    Even(f32),
    /// Version 2: counts of this many N, rising from 0.
    Listed(f32, &'a [u8]),
}

/// Control curve of the coil.
#[derive(Debug, Clone, Copy)]
struct Coil<'a> {
    a_per_count: f32,
    counts: &'a [u8],
    limits: CoilLimits,
}

/// What a material's control curve of the coil is good for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoilLimits {
    /// Forces, N, between which the magnet can make what is wanted.
    pub reachable_n: (f32, f32),
    /// Largest error of the current, A.
    pub bound_a: f32,
}

/// Coil current that a material asks for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Current {
    /// The current, A: 0 to [`CURRENT_MAX_A`].
    pub a: f32,
    /// The magnet cannot make what is wanted at this force: the current is that at the nearest force
    /// for which it can.
    pub unreachable: bool,
}

/// A force as a place between nodes.
struct Place {
    lower: usize,
    /// Weight of the node above, 0 to 1.
    weight: f32,
}

impl<'a> DisplayCurve<'a> {
    /// Version 1: points every `step_n` newtons.
    pub fn even(step_n: f32, mm_per_count: f32, shaft: &'a [u8]) -> Self {
        DisplayCurve { nodes: Nodes::Even(step_n), mm_per_count, shaft, coil: None }
    }

    /// Version 2: reads the record at `at`; what is in its counts is looked at by
    /// [`DisplayCurve::check`].
    pub fn listed(data: &'a [u8], at: usize, n_per_count: f32, mm_per_count: f32) -> Result<Self, Rule> {
        let nodes = usize::from(u16_at(data, at + 72));
        if !(2..=MAX_NODES).contains(&nodes) {
            return Err("a display curve has 2 to 256 nodes");
        }
        let from = u32_at(data, at + 48) as usize;
        let counts = |number: usize| {
            from.checked_add(2 * nodes * number)
                .filter(|_| from >= super::HEADER_LEN)
                .and_then(|start| data.get(start..start.checked_add(2 * nodes)?))
                .ok_or("a curve lies outside the table")
        };
        let [a_per_count, bound_a, first_n, last_n] = [56, 60, 64, 68].map(|field| f32_at(data, at + field));
        let limits = CoilLimits { reachable_n: (first_n, last_n), bound_a };
        let coil = if a_per_count == 0.0 {
            if [bound_a, first_n, last_n].iter().any(|x| *x != 0.0) {
                return Err("limits of a coil curve that is not there");
            }
            None
        } else {
            if !(is_scale(a_per_count) && a_per_count * f32::from(u16::MAX) <= CURRENT_MAX_A * ROUNDED) {
                return Err("a coil current is beyond 2.5 A");
            }
            if !(0.0..=CURRENT_MAX_A).contains(&bound_a) {
                return Err("the error bound of the coil current is not 0 to 2.5 A");
            }
            Some(Coil { a_per_count, counts: counts(2)?, limits })
        };
        Ok(DisplayCurve { nodes: Nodes::Listed(n_per_count, counts(0)?), mm_per_count, shaft: counts(1)?, coil })
    }

    /// Looks at every node.
    pub fn check(&self) -> Result<(), Rule> {
        let Nodes::Listed(_, forces) = self.nodes else { return Ok(()) };
        let mut last = None;
        for count in forces.as_chunks::<2>().0.iter().map(|pair| u16::from_le_bytes(*pair)) {
            match last {
                None if count != 0 => return Err("the first node of the display curve is not without force"),
                Some(last) if count <= last => return Err("forces of the display curve do not rise"),
                _ => last = Some(count),
            }
        }
        if let Some(Coil { limits: CoilLimits { reachable_n: (from, to), .. }, .. }) = self.coil
            && !(0.0 <= from && from <= to && to <= self.force_max_n() * ROUNDED)
        {
            return Err("forces that are reachable are not a stretch of the display curve");
        }
        Ok(())
    }

    /// Force at which the curve ends, N.
    pub fn force_max_n(&self) -> f32 {
        match self.nodes {
            Nodes::Even(step_n) => (self.shaft.len() / 2) as f32 * step_n,
            Nodes::Listed(n_per_count, forces) => f32::from(u16_at(forces, forces.len() - 2)) * n_per_count,
        }
    }

    /// The first node without force and for NaN, the last beyond the curve.
    fn place(&self, force_n: f32) -> Place {
        if force_n.is_nan() || force_n <= 0.0 {
            return Place { lower: 0, weight: 0.0 };
        }
        match self.nodes {
            Nodes::Even(step_n) => {
                let (at, last) = (force_n / step_n, self.shaft.len() / 2);
                if at >= last as f32 {
                    return Place { lower: last, weight: 0.0 };
                }
                let lower = at as usize;
                Place { lower, weight: at - lower as f32 }
            }
            Nodes::Listed(n_per_count, forces) => {
                let (at, nodes) = (force_n / n_per_count, forces.as_chunks::<2>().0);
                let count = |pair: &[u8; 2]| f32::from(u16::from_le_bytes(*pair));
                let above = nodes.partition_point(|pair| count(pair) <= at);
                let lower = above.saturating_sub(1);
                match (nodes.get(lower).map(count), nodes.get(above).map(count)) {
                    (Some(from), Some(to)) => Place { lower, weight: (at - from) / (to - from) },
                    _ => Place { lower, weight: 0.0 },
                }
            }
        }
    }

    /// Shaft position under a force, mm.
    pub fn shaft_mm(&self, force_n: f32) -> f32 {
        let place = self.place(force_n);
        // Of even points that without force is not among the counts.
        let missing = matches!(self.nodes, Nodes::Even(_));
        place.between(|node| match (missing, node) {
            (true, 0) => 0.0,
            (true, _) => f32::from(u16_at(self.shaft, 2 * (node - 1))),
            (false, _) => f32::from(u16_at(self.shaft, 2 * node)),
        }) * self.mm_per_count
    }

    /// Coil current under a force; `None` without a control curve.
    pub fn current(&self, force_n: f32) -> Option<Current> {
        let coil = self.coil.as_ref()?;
        if force_n.is_nan() || force_n <= 0.0 {
            return Some(Current { a: 0.0, unreachable: false });
        }
        let (from, to) = coil.limits.reachable_n;
        let held_n = if force_n < from {
            from
        } else if force_n > to {
            to
        } else {
            force_n
        };
        let counts = self.place(held_n).between(|node| f32::from(u16_at(coil.counts, 2 * node)));
        let a = counts * coil.a_per_count;
        Some(Current { a: if a < CURRENT_MAX_A { a } else { CURRENT_MAX_A }, unreachable: held_n != force_n })
    }

    /// Limits of the coil's control curve.
    pub fn coil(&self) -> Option<CoilLimits> {
        self.coil.map(|coil| coil.limits)
    }
}

impl Place {
    fn between(&self, value: impl Fn(usize) -> f32) -> f32 {
        let lower = value(self.lower);
        if self.weight > 0.0 { lower + self.weight * (value(self.lower + 1) - lower) } else { lower }
    }
}
