//! The way of a press: from one moment to the next with the pattern, the factor and the direction
//! of the last.

use super::contact::friction::Grip;
use super::error::PadError;
use super::law::plastic::LOG_VOLUME;
use super::model::{Model, Moment};
use super::potential::Potential;
use super::press::{Now, Programme};
use super::state::State;
use crate::fem::newton::{Found, Newton};
use crate::fem::sparse::{Factor, Pattern};

/// Residual that ends a solve, over the force: a part of it at every node far below what meshes
/// leave. Never less than [`ROUNDING`] stiffest shear moduli over 1 mm2, and looser, [`LOOSE`] of
/// them, until the force is known.
const CLOSE: f64 = 1e-6;
const ROUNDING: f64 = 1e-10;
const LOOSE: f64 = 1e-6;
/// Solves of a moment until its residual suits its force; the force is right to 1e-3 after the
/// first.
const TIGHTENED: usize = 3;
/// Factorisations before a step is halved.
const STEPS: usize = 25;
/// Fall of the residual for which a correction by the last factor is made.
const CHORD: f64 = 0.5;
/// Growth of the diagonal of a stiffness that is not positive definite, as on the way of a body
/// that yields everywhere.
const GROWTH: f64 = 1e-3;
/// Factorisations of a pass over a step from which the next is half as long, and otherwise half as
/// long again.
const TEDIOUS: usize = 10;
/// Shortest step over the longest.
const SHORTEST: f64 = 1.0 / 1024.0;
/// Along x, how far edges may be from each other to have a place in the pattern (mm).
const REACH_MM: f64 = 1.0;
/// Passes over a step for the volume ratio in the yield stress and for friction, and the ratio's
/// change (of the logarithm) that ends them: an error of the yield stress of the same part.
const PASSES: usize = 16;
const SAME_VOLUME: f64 = 1e-6;

/// Change of the force, as a part of it, that ends the passes for friction.
const SAME_FORCE: f64 = 1e-5;

/// A solve that was not tried.
const NOT_TRIED: Found = Found { steps: 0, left: f64::INFINITY, closed: false };

/// Where a press has come to.
pub(super) struct Path<'a> {
    model: Model,
    yields: Programme<'a>,
    stiffest_mpa: f64,
    /// Residual that would have ended the last solve.
    wanted_n: f64,
    now: Now,
    /// Force now (N).
    force_n: f64,
    /// Displacements now, and those of a moment before.
    u: Vec<f64>,
    before: Option<(Now, Vec<f64>)>,
    /// What the points remember of now, and what they did before the last step, which is what the
    /// present stress is reckoned from, with the length of that step (s).
    memory: Vec<f64>,
    last: (Vec<f64>, f64),
    /// What grips now.
    grips: Vec<Grip>,
    steps: usize,
    /// Most factorisations of a pass over the last step.
    hardest: usize,
    /// Part of the longest step that is tried next.
    pace: f64,
}

impl<'a> Path<'a> {
    /// At the start.
    pub fn new(model: Model, yields: Programme<'a>) -> Self {
        let memory = vec![0.0; model.states()];
        let stiffest_mpa = model.materials.iter().map(|m| m.shear_mpa()).fold(0.0, f64::max);
        Self {
            u: vec![0.0; 2 * model.nodes.len()],
            before: None,
            now: Now::default(),
            force_n: 0.0,
            last: (memory.clone(), 0.0),
            grips: Vec::new(),
            memory,
            steps: 0,
            hardest: 0,
            pace: 1.0,
            stiffest_mpa,
            wanted_n: LOOSE * stiffest_mpa,
            model,
            yields,
        }
    }

    /// Goes to a moment in equal steps, which are halved where no equilibrium is found.
    pub fn go(&mut self, to: Now, longest_mm: f64, longest_s: f64) -> Result<State, PadError> {
        let from = self.now;
        let (travel_mm, time_s) = (to.travel_mm - from.travel_mm, to.time_s - from.time_s);
        let longest = 1.0 / (travel_mm.abs() / longest_mm).max(time_s / longest_s).max(1.0);
        let mut done = 0.0;
        self.steps = 0;
        while done < 1.0 {
            let count = ((1.0 - done) / (self.pace * longest) - 1e-9).ceil().max(1.0);
            let part = if count <= 1.0 { 1.0 } else { done + (1.0 - done) / count };
            let at = |a: f64, way: f64, b: f64| if part >= 1.0 { b } else { a + part * way };
            let next = Now {
                time_s: at(from.time_s, time_s, to.time_s),
                travel_mm: at(from.travel_mm, travel_mm, to.travel_mm),
                force_n: self.force_n,
            };
            self.hardest = 0;
            match self.step(next)? {
                Ok(()) => {
                    done = part;
                    let factor = if self.hardest > TEDIOUS { 0.5 } else { 1.5 };
                    self.pace = (factor * self.pace).min(1.0);
                }
                Err(found) => {
                    self.pace = 0.5 * (part - done) / longest;
                    if self.pace < SHORTEST {
                        let (reached_mm, left, wanted) = (self.now.travel_mm, found.left, self.wanted_n);
                        return Err(PadError::Stuck { reached_mm, left, wanted });
                    }
                }
            }
        }
        let moment = Moment {
            travel_mm: to.travel_mm,
            yield_mpa: (self.yields)(self.now),
            step_s: self.last.1,
            old: &self.last.0,
        };
        let x = self.model.values(&self.u);
        let mut state = State::of(&self.model, &x, &moment, &self.memory, &self.grips);
        (state.time_s, state.steps) = (to.time_s, self.steps);
        Ok(state)
    }

    /// One step; the inner error tells where Newton's method stopped.
    fn step(&mut self, next: Now) -> Result<Result<(), Found>, PadError> {
        // the way of the last step goes on; at first the upper body moves as a whole
        let gone = |(before, _): &(Now, Vec<f64>)| self.now.travel_mm - before.travel_mm;
        let start = self.before.as_ref().filter(|before| gone(before) != 0.0).map(|before| {
            let part = (next.travel_mm - self.now.travel_mm) / gone(before);
            self.u.iter().zip(&before.1).map(|(now, before)| now + part * (now - before)).collect::<Vec<f64>>()
        });
        self.model.prepare(&self.u, next.travel_mm, REACH_MM)?;
        let tried = match start {
            Some(start) => self.equilibrium(next, &start),
            None => Err(NOT_TRIED),
        };
        let tried = tried.or_else(|_| {
            let here = self.u.clone();
            self.equilibrium(next, &here)
        });
        let [old, memory, u] = match tried {
            Ok(found) => found,
            Err(found) => return Ok(Err(found)),
        };
        self.before = Some((self.now, std::mem::replace(&mut self.u, u)));
        self.memory = memory;
        self.last = (old, next.time_s - self.now.time_s);
        self.now = next;
        Ok(Ok(()))
    }

    /// What the points remembered with the volume ratios of now, what they will remember, and the
    /// displacements at a moment, from a start.
    fn equilibrium(&mut self, next: Now, start: &[f64]) -> Result<[Vec<f64>; 3], Found> {
        let mut x = self.model.values(start);
        let mut old = self.memory.clone();
        let mut last = (NOT_TRIED, self.wanted_n);
        // the factor leaves the model so that both can be used
        let Some(mut matrix) = self.model.matrix.take() else { return Err(NOT_TRIED) };
        let start = (self.model.values(&self.u), self.now.travel_mm);
        // the first pass has the friction of the last moment, every other that of the pass before
        let mut pass = start.clone();
        let (mut force, mut result) = (f64::NAN, None);
        for _ in 0..PASSES {
            let grips = self.model.grips((&pass.0, pass.1), (&start.0, start.1));
            let (places, pattern, factor) = matrix.split();
            let moment = Moment {
                travel_mm: next.travel_mm,
                yield_mpa: (self.yields)(next),
                step_s: next.time_s - self.now.time_s,
                old: &old,
            };
            let potential = Potential { model: &self.model, matrix: &places, moment, grips: &grips };
            last = tightened(&potential, (pattern, factor), &mut x, self.stiffest_mpa);
            self.steps += last.0.steps;
            self.hardest = self.hardest.max(last.0.steps);
            self.wanted_n = last.1;
            let Some(new) = potential.remember(&x).filter(|_| last.0.closed) else { break };
            let before = std::mem::replace(&mut force, self.model.force(&x, next.travel_mm, &grips));
            let rubbed = self.model.friction.is_none() || (force - before).abs() <= SAME_FORCE * force.abs();
            if self.renew_volume(&mut old, &new) < SAME_VOLUME && rubbed {
                result = Some(new);
                self.force_n = force;
                self.grips = grips;
                break;
            }
            pass = (x.clone(), next.travel_mm);
        }
        self.model.matrix = Some(matrix);
        result.map(|memory| [old, memory, self.model.displacements(&x)]).ok_or(last.0)
    }

    /// Puts the volume ratios of a pass into what the next one starts from; returns the largest
    /// change.
    fn renew_volume(&self, old: &mut [f64], new: &[f64]) -> f64 {
        let mut changed: f64 = 0.0;
        for at in self.model.yielding() {
            changed = changed.max((new[at + LOG_VOLUME] - old[at + LOG_VOLUME]).abs());
            old[at + LOG_VOLUME] = new[at + LOG_VOLUME];
        }
        changed
    }
}

/// Solves a moment until the residual suits its force; returns where it stopped and the residual
/// (N) that was wanted.
fn tightened(
    potential: &Potential,
    (pattern, factor): (&Pattern, &mut Factor),
    x: &mut Vec<f64>,
    stiffest_mpa: f64,
) -> (Found, f64) {
    let mut close = LOOSE * stiffest_mpa;
    let mut whole = NOT_TRIED;
    for _ in 0..TIGHTENED {
        let newton = Newton { close, steps: STEPS, chord: CHORD, growth: GROWTH };
        let found = newton.minimise(potential, pattern, factor, x);
        whole = Found { steps: whole.steps + found.steps, ..found };
        let force = potential.model.force(x, potential.moment.travel_mm, potential.grips).abs();
        close = (CLOSE * force).max(ROUNDING * stiffest_mpa);
        if !found.closed || found.left <= close {
            break;
        }
    }
    (whole, close)
}
