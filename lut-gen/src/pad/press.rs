//! What is pressed on what, and how.

use super::body::Body;
use super::body::section::{Rule, Section};
use super::contact::energy::Penalty;
use super::contact::friction::Friction;
use super::contact::rigid::Rigid;
use super::error::{PadError, demand};
use super::law::material::Material;
use super::model::{Counter, Model};
use super::path::Path;
use super::state::State;

/// One side of a contact.
#[derive(Debug, Clone, PartialEq)]
pub enum Side {
    /// A soft body.
    Soft(Body),
    /// A rigid one.
    Rigid(Rigid),
}

/// A moment of a motion.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Now {
    /// Time since the start (s).
    pub time_s: f64,
    /// How far the upper side has come down (mm).
    pub travel_mm: f64,
    /// Force at the end of the step before (N), as a controller knows it. A motion leaves it 0.
    pub force_n: f64,
}

/// A yield stress (MPa, Cauchy) over time, travel and the force of the step before.
pub type Programme<'a> = &'a (dyn Fn(Now) -> f64 + Sync);

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
    /// Pressure per penetration on the reference surface (MPa/mm); `None` for [`AGAINST_RIGID`] or
    /// [`BETWEEN_SOFT`] shear moduli.
    pub penalty_mpa_per_mm: Option<f64>,
    /// Friction between the sides.
    pub friction: Option<Friction>,
    /// Points of the elements.
    pub rule: Rule,
    /// Yield stress of plastic materials.
    pub yields: Programme<'a>,
    /// Longest step (mm). Of bodies that yield the return is implicit: their force errs in
    /// proportion to the step, by about 0.5 % at 0.05 mm and 1 to 3 % at 0.25 mm.
    pub step_mm: f64,
    /// Longest step in time (s), for layers that relax.
    pub step_s: f64,
}

/// Default penalty over the shear modulus of the softer body's stiffest part (1/mm), against a
/// rigid body: pressures reach about half the modulus, so that penetration stays below 2e-4 mm.
pub const AGAINST_RIGID: f64 = 2500.0;
/// The same between two soft bodies, whose curved edges cannot lie on each other point by point: a
/// penalty much above ten moduli over the length of their elements lets the pressure swing from
/// point to point near the contact's edge. Foam then bears its pressure with a penetration of 1e-3
/// mm.
pub const BETWEEN_SOFT: f64 = 500.0;

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
            friction: None,
            rule: Rule::Reduced,
            yields: &|_| f64::INFINITY,
            step_mm: 0.25,
            step_s: f64::INFINITY,
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

    /// The equilibria at the given travels (mm), which rise at 1 mm/s.
    ///
    /// # Errors
    /// [`PadError`].
    pub fn solve(&self, travels_mm: &[f64]) -> Result<Vec<State>, PadError> {
        let mut before = 0.0;
        for &travel in travels_mm {
            demand(travel >= before && travel.is_finite(), "a travel (mm)", travel, "numbers that rise from 0")?;
            before = travel;
        }
        let motion: Vec<Now> =
            travels_mm.iter().map(|&travel_mm| Now { time_s: travel_mm, travel_mm, force_n: 0.0 }).collect();
        self.follow(&motion)
    }

    /// The equilibria at the moments of a motion that begins at time and travel 0.
    ///
    /// # Errors
    /// [`PadError`].
    pub fn follow(&self, motion: &[Now]) -> Result<Vec<State>, PadError> {
        self.follow_telling(motion, &mut |_| {})
    }

    /// As [`Press::follow`]; `told` hears of every moment as it is solved.
    ///
    /// # Errors
    /// [`PadError`].
    pub fn follow_telling(&self, motion: &[Now], told: &mut dyn FnMut(&State)) -> Result<Vec<State>, PadError> {
        demand(self.step_mm > 0.0, "the longest step (mm)", self.step_mm, "more than 0")?;
        demand(self.step_s > 0.0, "the longest step (s)", self.step_s, "more than 0")?;
        let mut before = 0.0;
        for now in motion {
            let rises = now.time_s >= before && now.time_s.is_finite();
            demand(rises, "a time of the motion (s)", now.time_s, "numbers that rise from 0")?;
            demand(now.travel_mm.is_finite(), "a travel of the motion (mm)", now.travel_mm, "a number")?;
            before = now.time_s;
        }
        let mut model = self.model()?;
        if let Some(Friction { coefficient, creep_mm }) = self.friction {
            demand((0.0..=2.0).contains(&coefficient), "the coefficient of friction", coefficient, "0 to 2")?;
            demand(creep_mm > 0.0, "the creep of friction (mm)", creep_mm, "more than 0")?;
            model.friction = self.friction.filter(|f| f.coefficient > 0.0);
        }
        let mut path = Path::new(model, self.yields);
        let go = |now: &Now| path.go(*now, self.step_mm, self.step_s).inspect(|state| told(state));
        motion.iter().map(go).collect()
    }
}
