//! The way down: from one depth to the next with the pattern, the factor and the direction of the last.

use super::body::Body;
use super::body::section::{Rule, Section};
use super::contact::energy::Penalty;
use super::contact::rigid::Rigid;
use super::error::{PadError, demand};
use super::law::material::Material;
use super::law::plastic::LOG_VOLUME;
use super::model::{Counter, Model, Moment, Potential};
use super::state::State;
use crate::fem::newton::{Found, Newton};
use crate::fem::operator::PointLaw;

/// One side of a contact.
#[derive(Debug, Clone, PartialEq)]
pub enum Side {
    /// A soft body.
    Soft(Body),
    /// A rigid one.
    Rigid(Rigid),
}

/// A yield stress (MPa, Cauchy) over travel (mm).
pub type Programme<'a> = &'a (dyn Fn(f64) -> f64 + Sync);

/// A body pressed on another. At travel 0 they just touch or are apart.
pub struct Press<'a> {
    /// Plane or ring.
    pub section: Section,
    /// The side that moves down.
    pub upper: Side,
    /// The side that stays.
    pub lower: Side,
    /// Penetration is measured on the upper side where both are soft.
    pub from_above: bool,
    /// Pressure per penetration on the reference surface (MPa/mm); `None` for [`AGAINST_RIGID`] or [`BETWEEN_SOFT`]
    /// shear moduli.
    pub penalty_mpa_per_mm: Option<f64>,
    /// Points of the elements.
    pub rule: Rule,
    /// Yield stress of plastic materials.
    pub yields: Programme<'a>,
    /// Longest step (mm).
    pub step_mm: f64,
}

/// Default penalty over the shear modulus of the softer body's stiffest part (1/mm), against a rigid body: pressures reach
/// about half the modulus, so that penetration stays below 2e-4 mm.
pub const AGAINST_RIGID: f64 = 2500.0;
/// The same between two soft bodies, whose curved edges cannot lie on each other point by point: a penalty much above ten
/// moduli over the length of their elements lets the pressure swing from point to point near the contact's edge. Foam
/// then bears its pressure with a penetration of 1e-3 mm.
pub const BETWEEN_SOFT: f64 = 500.0;

/// Residual that ends a solve, over the force: a part of it at every node far below what meshes leave. Never less than
/// [`ROUNDING`] stiffest shear moduli over 1 mm2, and looser, [`LOOSE`] of them, until the force is known.
const CLOSE: f64 = 1e-6;
const ROUNDING: f64 = 1e-12;
const LOOSE: f64 = 1e-6;
/// Solves of a moment until its residual suits its force; the force is right to 1e-3 after the first.
const TIGHTENED: usize = 3;
/// Factorisations before a step is halved.
const STEPS: usize = 25;
/// Fall of the residual for which a correction by the last factor is made.
const CHORD: f64 = 0.3;
/// Shortest step over the longest.
const SHORTEST: f64 = 1.0 / 1024.0;
/// Along x, how far edges may be from each other to have a place in the pattern (mm).
const REACH_MM: f64 = 1.0;
/// Passes over a step for the volume ratio in the yield stress, and its change (of the logarithm) that ends them: an
/// error of the yield stress of the same part.
const PASSES: usize = 8;
const SAME_VOLUME: f64 = 1e-6;

impl<'a> Press<'a> {
    /// A press of `upper` on `lower` with defaults.
    #[must_use]
    pub fn new(section: Section, upper: Side, lower: Side) -> Self {
        Self {
            section,
            upper,
            lower,
            from_above: true,
            penalty_mpa_per_mm: None,
            rule: Rule::Reduced,
            yields: &|_| f64::INFINITY,
            step_mm: 0.25,
        }
    }

    /// The equations.
    ///
    /// # Errors
    /// [`PadError::Value`].
    pub fn model(&self) -> Result<Model, PadError> {
        // of every soft body the stiffest and the softest part
        let extremes = |side: &Side| match side {
            Side::Soft(body) => {
                let shears = || body.materials.iter().map(Material::shear_mpa);
                (shears().fold(0.0, f64::max), shears().fold(f64::INFINITY, f64::min))
            }
            Side::Rigid(_) => (f64::INFINITY, f64::INFINITY),
        };
        let (upper, lower) = (extremes(&self.upper), extremes(&self.lower));
        let softest = upper.1.min(lower.1);
        let soft = [&self.upper, &self.lower].iter().filter(|side| matches!(side, Side::Soft(_))).count();
        demand(soft > 0, "the number of soft bodies", soft as f64, "1 or 2")?;
        let stiffness = if soft == 1 { AGAINST_RIGID } else { BETWEEN_SOFT };
        let penalty = self.penalty_mpa_per_mm.unwrap_or(stiffness * upper.0.min(lower.0));
        demand(penalty > 0.0 && penalty.is_finite(), "the penalty (MPa/mm)", penalty, "more than 0")?;
        let of = |above: f64| Penalty::new(penalty, self.section, above, softest);
        let shifted = |edges: &[[usize; 3]], by: usize| edges.iter().map(|e| e.map(|n| n + by)).collect::<Vec<_>>();
        match (&self.upper, &self.lower) {
            (Side::Soft(body), Side::Rigid(rigid)) => {
                let edges = |_: &[usize]| (body.surface.clone(), Counter::Rigid(*rigid));
                Model::new(&[(body, true)], self.rule, of(1.0), edges)
            }
            (Side::Rigid(rigid), Side::Soft(body)) => {
                let edges = |_: &[usize]| (body.surface.clone(), Counter::Rigid(*rigid));
                Model::new(&[(body, false)], self.rule, of(-1.0), edges)
            }
            (Side::Soft(upper), Side::Soft(lower)) => {
                let edges = |first: &[usize]| {
                    let (up, low) = (shifted(&upper.surface, first[0]), shifted(&lower.surface, first[1]));
                    if self.from_above { (up, Counter::Edges(low)) } else { (low, Counter::Edges(up)) }
                };
                let above = if self.from_above { 1.0 } else { -1.0 };
                Model::new(&[(upper, true), (lower, false)], self.rule, of(above), edges)
            }
            (Side::Rigid(_), Side::Rigid(_)) => {
                Err(PadError::Value { parameter: "the number of soft bodies", value: 0.0, expected: "1 or 2" })
            }
        }
    }

    /// The equilibria at the given travels (mm), which rise.
    ///
    /// # Errors
    /// [`PadError`].
    pub fn solve(&self, travels_mm: &[f64]) -> Result<Vec<State>, PadError> {
        let mut before = 0.0;
        for &travel in travels_mm {
            demand(travel >= before && travel.is_finite(), "a travel (mm)", travel, "numbers that rise from 0")?;
            before = travel;
        }
        demand(self.step_mm > 0.0, "the longest step (mm)", self.step_mm, "more than 0")?;
        let model = self.model()?;
        let stiffest = model.materials.iter().map(|m| m.shear_mpa()).fold(0.0, f64::max);
        let mut path = Path {
            u: vec![0.0; 2 * model.nodes.len()],
            before: None,
            memory: vec![0.0; model.states()],
            travel_mm: 0.0,
            steps: 0,
            stiffest_mpa: stiffest,
            wanted_n: LOOSE * stiffest,
            model,
            yields: self.yields,
        };
        travels_mm.iter().map(|travel| path.go(*travel, self.step_mm)).collect()
    }
}

/// Where a press has come to.
struct Path<'a> {
    model: Model,
    stiffest_mpa: f64,
    /// Residual that would have ended the last solve.
    wanted_n: f64,
    yields: Programme<'a>,
    /// Displacements at this travel, and those at one before.
    u: Vec<f64>,
    before: Option<(f64, Vec<f64>)>,
    memory: Vec<f64>,
    travel_mm: f64,
    steps: usize,
}

impl Path<'_> {
    /// Goes to a travel in steps that are halved where no equilibrium is found.
    fn go(&mut self, travel_mm: f64, longest_mm: f64) -> Result<State, PadError> {
        let mut step = longest_mm;
        let mut old = self.memory.clone();
        self.steps = 0;
        while self.travel_mm < travel_mm {
            // equal steps to the end
            let count = ((travel_mm - self.travel_mm) / step - 1e-9).ceil().max(1.0);
            let next = if count <= 1.0 { travel_mm } else { self.travel_mm + (travel_mm - self.travel_mm) / count };
            let memory = self.memory.clone();
            match self.step(next)? {
                Ok(()) => {
                    old = memory;
                    step = (1.5 * step).min(longest_mm);
                }
                Err(found) => {
                    step = 0.5 * step.min(next - self.travel_mm);
                    if step < SHORTEST * longest_mm {
                        let (reached_mm, left, wanted) = (self.travel_mm, found.left, self.wanted_n);
                        return Err(PadError::Stuck { reached_mm, left, wanted });
                    }
                }
            }
        }
        let moment = Moment { travel_mm, yield_mpa: (self.yields)(travel_mm), old: &old };
        let x = self.model.values(&self.u);
        Ok(State::of(&self.model, &x, &moment, &self.memory, self.steps))
    }

    /// One step; the inner error tells where Newton's method stopped.
    fn step(&mut self, next_mm: f64) -> Result<Result<(), Found>, PadError> {
        // the way of the last step goes on; the first is the body's own frame
        let start = match &self.before {
            Some((travel, u)) => {
                let part = (next_mm - self.travel_mm) / (self.travel_mm - travel);
                self.u.iter().zip(u).map(|(now, before)| now + part * (now - before)).collect()
            }
            None => self.u.clone(),
        };
        self.model.prepare(&self.u, next_mm, REACH_MM)?;
        let tried = self.equilibrium(next_mm, &start);
        let tried = if tried.is_err() && self.before.is_some() {
            let here = self.u.clone();
            self.equilibrium(next_mm, &here)
        } else {
            tried
        };
        let (u, memory) = match tried {
            Ok(found) => found,
            Err(found) => return Ok(Err(found)),
        };
        self.before = Some((self.travel_mm, std::mem::replace(&mut self.u, u)));
        self.memory = memory;
        self.travel_mm = next_mm;
        Ok(Ok(()))
    }

    /// Displacements and memory at a travel, from a start.
    fn equilibrium(&mut self, travel_mm: f64, start: &[f64]) -> Result<(Vec<f64>, Vec<f64>), Found> {
        let mut x = self.model.values(start);
        let mut old = self.memory.clone();
        let mut last = Found { steps: 0, left: f64::INFINITY, closed: false };
        // the factor leaves the model so that both can be used
        let Some(mut matrix) = self.model.matrix.take() else { return Err(last) };
        let mut result = None;
        for _ in 0..PASSES {
            let (places, pattern, factor) = matrix.split();
            let moment = Moment { travel_mm, yield_mpa: (self.yields)(travel_mm), old: &old };
            let potential = Potential { model: &self.model, matrix: &places, moment };
            let mut close = LOOSE * self.stiffest_mpa;
            for _ in 0..TIGHTENED {
                let newton = Newton { close, steps: STEPS, chord: CHORD };
                last = newton.minimise(&potential, pattern, factor, &mut x);
                self.steps += last.steps;
                let force = self.model.force(&x, travel_mm).abs();
                close = (CLOSE * force).max(ROUNDING * self.stiffest_mpa);
                self.wanted_n = close;
                if !last.closed || last.left <= close {
                    break;
                }
            }
            let Some(new) = potential.remember(&x).filter(|_| last.closed) else { break };
            let changed = self.renew_volume(&mut old, &new);
            result = Some(new);
            if changed < SAME_VOLUME {
                break;
            }
        }
        self.model.matrix = Some(matrix);
        match result.filter(|_| last.closed) {
            Some(memory) => Ok((self.model.displacements(&x), memory)),
            None => Err(last),
        }
    }

    /// Puts the volume ratios of a pass into what the next one starts from; returns the largest change.
    fn renew_volume(&self, old: &mut [f64], new: &[f64]) -> f64 {
        let mut changed: f64 = 0.0;
        let mut at = 0;
        for (element, material) in self.model.domain.elements.iter().zip(&self.model.of) {
            let each = self.model.matter(*material, 0.0).states();
            for _ in 0..element.points.len() {
                if each > LOG_VOLUME {
                    changed = changed.max((new[at + LOG_VOLUME] - old[at + LOG_VOLUME]).abs());
                    old[at + LOG_VOLUME] = new[at + LOG_VOLUME];
                }
                at += each;
            }
        }
        changed
    }
}
