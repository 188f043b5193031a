//! Newton's method for one step, with corrections by the last factor in between.

use super::{History, Matrix, SolveError, State, Step, System};
use crate::fem::krylov::dot;
use crate::solid::law::{Material, Relaxation};

/// Settings of Newton's method.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Newton {
    /// Converged when the residual's norm is below this part of the contact force's norm.
    pub tolerance: f64,
    /// Factorisations before the step is given up.
    pub iterations: usize,
    /// Halvings of one correction before the step is given up.
    pub halvings: usize,
    /// Iterations a correction that raised the residual is given to prove itself.
    pub trust: usize,
    /// A correction by an old factor is kept when the residual falls to this part of itself.
    pub chord: f64,
}

impl Default for Newton {
    fn default() -> Self {
        Self { tolerance: 3e-4, iterations: 14, halvings: 6, trust: 2, chord: 0.3 }
    }
}

/// What is prescribed at the end of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Control {
    /// The depth (mm).
    Depth(f64),
    /// The force on the ball (N); the depth follows.
    Force(f64),
}

/// A system with its material on the way from one equilibrium to the next.
#[derive(Debug)]
pub struct Problem<'a> {
    /// The equations.
    pub system: &'a System,
    /// The material.
    pub material: &'a Material,
    /// History at the step's start.
    pub old: &'a History,
    /// Duration of the step (s).
    pub dt_s: f64,
    /// What is prescribed.
    pub control: Control,
}

/// Displacement (mm) of the free dofs and depth of the ball (mm).
#[derive(Debug, Clone, PartialEq)]
pub struct Configuration {
    /// Displacement.
    pub u: Vec<f64>,
    /// Depth.
    pub depth_mm: f64,
}

/// Scratch of the iteration, kept between steps.
pub struct Workspace {
    /// State at the last accepted displacement.
    pub state: State,
    /// Tangent of the last assembly.
    pub matrix: Matrix,
    trial: State,
    correction: Vec<f64>,
    rate: Vec<f64>,
    rated: bool,
    /// Largest norm of the contact force so far (N).
    scale: f64,
    /// Residual that the rounding of positions leaves (N).
    rounding: f64,
    factored: bool,
    /// The factor is that of a place where no equilibrium was found: its tangent leads nowhere.
    astray: bool,
    /// Corrections so far.
    pub iterations: usize,
    /// Factorisations so far.
    pub factorisations: usize,
}

impl Workspace {
    /// Scratch for a system; `symmetric` as in [`System::matrix`].
    ///
    /// # Errors
    /// [`SolveError::Memory`].
    pub fn new(system: &System, symmetric: bool) -> Result<Self, SolveError> {
        Ok(Self {
            state: system.state(),
            matrix: system.matrix(symmetric)?,
            trial: system.state(),
            correction: vec![0.0; system.unknowns()],
            rate: vec![0.0; system.unknowns()],
            rated: true,
            scale: 0.0,
            rounding: 0.0,
            factored: false,
            astray: false,
            iterations: 0,
            factorisations: 0,
        })
    }
}

impl Workspace {
    /// `du / d depth` by the last factor; 0 before the first.
    pub fn rate(&mut self) -> &[f64] {
        if !self.rated {
            for (v, b) in self.rate.iter_mut().zip(&self.matrix.drive) {
                *v = -b;
            }
            self.matrix.correct(&mut self.rate);
            self.rated = true;
        }
        &self.rate
    }

    /// `dF / d depth` along the path by the last factor (N/mm).
    pub(super) fn slope(&mut self) -> f64 {
        self.rate();
        self.matrix.direct + dot(&self.matrix.pull, &self.rate)
    }

    /// Assembles and factorises the stiffness at a displacement; false when that is impossible.
    fn renew(&mut self, problem: &Problem, step: &Step, u: &[f64]) -> bool {
        self.factored = problem.system.assemble(step, u, &mut self.state, &mut self.matrix) && self.matrix.factorise();
        if !self.factored {
            return false;
        }
        self.factorisations += 1;
        self.astray = false;
        self.rounding = ROUNDING_OF_POSITIONS * self.matrix.diagonal_norm() * problem.system.height_mm();
        self.rated = false;
        true
    }

    /// No equilibrium was found: the next step begins with the stiffness where the last one was.
    pub(super) fn went_astray(&mut self) {
        self.astray = true;
    }

    /// True where [`Workspace::went_astray`] was called since the last factorisation.
    pub(super) fn is_astray(&self) -> bool {
        self.astray
    }

    /// The factor is no longer one of a stiffness to correct with.
    pub(super) fn forget(&mut self) {
        self.factored = false;
    }
}

/// Fall of the energy still to be gained, relative to the first correction's, at which
/// rounding decides: reached before the tolerance where the contact force is tiny.
const ROUNDING: f64 = 1e-12;

/// Positions are known to this part of the height; the stiffness times that is a residual no
/// correction removes. It matters for nearly incompressible blocks only.
const ROUNDING_OF_POSITIONS: f64 = 2.0 * f64::EPSILON;

/// Residual, as part of the contact force, above which rounding is no excuse.
const NEAR: f64 = 3e-3;

/// Part of the largest contact force so far that the residual is measured by when the ball leaves.
const LEAST_SCALE: f64 = 1e-3;

fn norm(x: &[f64]) -> f64 {
    dot(x, x).sqrt()
}

/// Where corrections on trust began.
struct Anchor {
    at: Configuration,
    state: State,
    correction: Vec<f64>,
    climb: f64,
    rest: f64,
    age: usize,
}

/// Residual of one configuration, and how much of it is allowed.
#[derive(Debug, Clone, Copy)]
struct Balance {
    /// Norm of the residual, with the miss of a prescribed force.
    rest: f64,
    /// Norm of the contact force.
    contact: f64,
}

impl Problem<'_> {
    fn step(&self, relaxation: &Relaxation, depth_mm: f64) -> Step<'_> {
        Step { material: self.material, relaxation: relaxation.clone(), old: self.old, depth_mm }
    }

    pub(super) fn by_force(&self) -> bool {
        matches!(self.control, Control::Force(_))
    }

    fn balance(&self, state: &State) -> Balance {
        let miss = match self.control {
            Control::Depth(_) => 0.0,
            Control::Force(wanted) => state.sum.force_n - wanted,
        };
        Balance { rest: norm(&state.residual).hypot(miss), contact: norm(&state.contact) }
    }
}

impl Newton {
    /// Renews the factor at an equilibrium.
    pub(super) fn refactorise(&self, problem: &Problem, at: &Configuration, w: &mut Workspace) -> bool {
        let relaxation = problem.material.relaxation(problem.dt_s);
        w.renew(problem, &problem.step(&relaxation, at.depth_mm), &at.u)
    }

    /// Corrects `at` until it is in equilibrium. Returns the number of factorisations,
    /// or `None` when it did not converge (`at` is then spoilt).
    pub fn equilibrate(&self, problem: &Problem, at: &mut Configuration, w: &mut Workspace) -> Option<usize> {
        let relaxation = problem.material.relaxation(problem.dt_s);
        if let Control::Depth(depth) = problem.control {
            at.depth_mm = depth;
        }
        if !problem.system.evaluate(&problem.step(&relaxation, at.depth_mm), &at.u, &mut w.state) {
            return None;
        }
        if w.factored && self.chords(problem, &relaxation, at, w) {
            return Some(0);
        }
        let mut first = None;
        let mut anchor: Option<Anchor> = None;
        for k in 1..=self.iterations {
            let step = problem.step(&relaxation, at.depth_mm);
            if !w.renew(problem, &step, &at.u) {
                return None;
            }
            let climb = self.direction(problem, w);
            let slope = dot(&w.correction, &w.state.residual).abs();
            let start = *first.get_or_insert(slope);
            self.proceed(problem, &relaxation, climb, at, w, &mut anchor)?;
            let settled = slope <= ROUNDING * start && self.is_near(problem, w);
            if self.is_balanced(problem, w) || settled || (anchor.is_none() && self.chords(problem, &relaxation, at, w))
            {
                return Some(k);
            }
        }
        None
    }

    /// Takes a correction. The full one when it pays; else it is taken on trust for up to
    /// `trust` iterations, because a residual of nearly incompressible or just touched points may
    /// rise once and then fall to nothing; when it has not, back to the anchor, and shorter.
    fn proceed(
        &self,
        problem: &Problem,
        relaxation: &Relaxation,
        climb: f64,
        at: &mut Configuration,
        w: &mut Workspace,
        anchor: &mut Option<Anchor>,
    ) -> Option<()> {
        if let Some(a) = anchor {
            let fallen = self.advance(problem, relaxation, climb, at, w, 0).is_some()
                && problem.balance(&w.state).rest < 0.9 * a.rest;
            if fallen {
                *anchor = None;
                return Some(());
            }
            a.age += 1;
            if a.age < self.trust && self.leap(problem, relaxation, climb, at, w) {
                return Some(());
            }
            let a = anchor.take()?;
            *at = a.at;
            w.state = a.state;
            w.correction = a.correction;
            return self.advance(problem, relaxation, a.climb, at, w, self.halvings);
        }
        if self.advance(problem, relaxation, climb, at, w, 0).is_some() {
            return Some(());
        }
        let here = Anchor {
            at: at.clone(),
            state: w.state.clone(),
            correction: w.correction.clone(),
            climb,
            rest: problem.balance(&w.state).rest,
            age: 0,
        };
        if self.leap(problem, relaxation, climb, at, w) {
            *anchor = Some(here);
            return Some(());
        }
        self.advance(problem, relaxation, climb, at, w, self.halvings)
    }

    /// Takes the full correction whatever it does, as long as no element is turned inside out.
    fn leap(
        &self,
        problem: &Problem,
        relaxation: &Relaxation,
        climb: f64,
        at: &mut Configuration,
        w: &mut Workspace,
    ) -> bool {
        let mut next = at.clone();
        self.moved(at, w, 1.0, climb, &mut next);
        let step = problem.step(relaxation, next.depth_mm);
        if !problem.system.evaluate(&step, &next.u, &mut w.trial) || !problem.balance(&w.trial).rest.is_finite() {
            return false;
        }
        std::mem::swap(&mut w.state, &mut w.trial);
        *at = next;
        true
    }

    /// Fills the correction of the displacement from the factor; returns that of the depth.
    fn direction(&self, problem: &Problem, w: &mut Workspace) -> f64 {
        w.iterations += 1;
        for (c, r) in w.correction.iter_mut().zip(&w.state.residual) {
            *c = -r;
        }
        w.matrix.correct(&mut w.correction);
        let Control::Force(wanted) = problem.control else {
            return 0.0;
        };
        let miss = wanted - w.state.sum.force_n - dot(&w.matrix.pull, &w.correction);
        let climb = miss / w.slope();
        for (c, v) in w.correction.iter_mut().zip(&w.rate) {
            *c += climb * v;
        }
        climb
    }

    fn is_balanced(&self, problem: &Problem, w: &mut Workspace) -> bool {
        let b = problem.balance(&w.state);
        w.scale = w.scale.max(b.contact);
        let scale = b.contact.max(LEAST_SCALE * w.scale);
        b.rest <= (self.tolerance * scale).max(w.rounding.min(NEAR * scale))
    }

    /// Near enough to equilibrium to blame the rest on rounding.
    fn is_near(&self, problem: &Problem, w: &Workspace) -> bool {
        let b = problem.balance(&w.state);
        b.rest <= NEAR * b.contact.max(LEAST_SCALE * w.scale)
    }

    /// Takes the correction, halved until the residual falls or, at a prescribed depth, the
    /// potential's slope along the correction falls.
    fn advance(
        &self,
        problem: &Problem,
        relaxation: &Relaxation,
        climb: f64,
        at: &mut Configuration,
        w: &mut Workspace,
        halvings: usize,
    ) -> Option<()> {
        let slope = dot(&w.correction, &w.state.residual);
        let before = problem.balance(&w.state).rest;
        let by_slope = matches!(problem.control, Control::Depth(_));
        let mut part = 1.0;
        let mut next = at.clone();
        for _ in 0..=halvings {
            self.moved(at, w, part, climb, &mut next);
            if problem.system.evaluate(&problem.step(relaxation, next.depth_mm), &next.u, &mut w.trial) {
                let after = dot(&w.correction, &w.trial.residual);
                let rest = problem.balance(&w.trial).rest;
                if (by_slope && after.abs() <= 0.9 * slope.abs()) || rest < 0.9 * before {
                    if !rest.is_finite() {
                        return None;
                    }
                    std::mem::swap(&mut w.state, &mut w.trial);
                    *at = next;
                    return Some(());
                }
            }
            part *= 0.5;
        }
        None
    }

    fn moved(&self, at: &Configuration, w: &Workspace, part: f64, climb: f64, next: &mut Configuration) {
        for ((n, u), c) in next.u.iter_mut().zip(&at.u).zip(&w.correction) {
            *n = u + part * c;
        }
        next.depth_mm = at.depth_mm + part * climb;
    }

    /// Corrections by the last factor as long as each one pays: they cost a tenth of a
    /// factorisation. True when the step has converged.
    fn chords(&self, problem: &Problem, relaxation: &Relaxation, at: &mut Configuration, w: &mut Workspace) -> bool {
        let mut before = problem.balance(&w.state).rest;
        let mut next = at.clone();
        loop {
            let climb = self.direction(problem, w);
            self.moved(at, w, 1.0, climb, &mut next);
            if !problem.system.evaluate(&problem.step(relaxation, next.depth_mm), &next.u, &mut w.trial) {
                return false;
            }
            let rest = problem.balance(&w.trial).rest;
            if rest.is_nan() || rest > self.chord * before {
                return false;
            }
            before = rest;
            std::mem::swap(&mut w.state, &mut w.trial);
            std::mem::swap(at, &mut next);
            if self.is_balanced(problem, w) {
                return true;
            }
        }
    }
}
