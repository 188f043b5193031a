//! The rivals.

use std::cell::{Cell, RefCell};

use argmin::core::{CostFunction, Error, Executor, Gradient};
use argmin::solver::linesearch::MoreThuenteLineSearch;
use argmin::solver::particleswarm::ParticleSwarm;
use argmin::solver::quasinewton::BFGS;
use argmin::solver::simulatedannealing::{Anneal, SATempFunc, SimulatedAnnealing};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

use crate::identify::simplex::{self, Bounds, Stop};
use crate::infer::descent::{Region, Rule, Together, minimise};

use super::evolution::{cma_es, hooke_jeeves};
use super::landscape::Counted;

/// Most evaluations of one search.
pub const BUDGET: usize = 4000;
/// Relative change of the objective, and move as a share of the box, below which the methods of the crates end.
const TOLERANCE: f64 = 1e-10;
const STILL: f64 = 1e-8;
/// Particles of the swarm.
const PARTICLES: usize = 20;
/// Temperatures of the annealing, in units of ln objective, first and last.
const HOT: f64 = 1.0;
const COLD: f64 = 1e-4;
/// Step of the annealing at unit temperature, and the least one, as shares of the box.
const HOT_STEP: f64 = 0.3;
const COLD_STEP: f64 = 1e-4;

/// A rival.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Gauss-Newton (Levenberg-Marquardt), slopes from sensitivities.
    GaussNewton,
    /// The same, slopes from difference quotients.
    GaussNewtonQuotients,
    /// Nelder-Mead with the thesis' coefficients.
    Simplex,
    /// Quasi-Newton, slopes from quotients.
    Bfgs,
    /// Sequential quadratic programming, slopes from quotients.
    Sqp,
    /// Linear approximations in a trust region.
    Cobyla,
    /// Pattern search.
    HookeJeeves,
    /// Particle swarm.
    Swarm,
    /// Evolution strategy.
    CmaEs,
    /// Simulated annealing.
    Annealing,
}

impl Method {
    /// All of them.
    pub const ALL: [Method; 10] = [
        Self::GaussNewton,
        Self::GaussNewtonQuotients,
        Self::Sqp,
        Self::Bfgs,
        Self::Cobyla,
        Self::Simplex,
        Self::HookeJeeves,
        Self::CmaEs,
        Self::Swarm,
        Self::Annealing,
    ];

    /// Its name.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::GaussNewton => "Gauss-Newton, sensitivities",
            Self::GaussNewtonQuotients => "Gauss-Newton, quotients",
            Self::Simplex => "simplex (Nelder-Mead)",
            Self::Bfgs => "BFGS",
            Self::Sqp => "SQP",
            Self::Cobyla => "COBYLA",
            Self::HookeJeeves => "Hooke-Jeeves",
            Self::Swarm => "particle swarm",
            Self::CmaEs => "CMA-ES",
            Self::Annealing => "simulated annealing",
        }
    }

    /// Whose code runs.
    #[must_use]
    pub fn code(self) -> &'static str {
        match self {
            Self::GaussNewton | Self::GaussNewtonQuotients => "that of identify",
            Self::Simplex => "that of identify",
            Self::Bfgs | Self::Swarm | Self::Annealing => "argmin",
            Self::Sqp => "slsqp",
            Self::Cobyla => "cobyla",
            Self::HookeJeeves | Self::CmaEs => "own",
        }
    }

    /// Searches from a point of the unit cube; what was found stands in the trace of `problem`. The swarm knows no start, only the seed.
    pub fn search(self, problem: &Counted<'_>, start: &[f64], seed: u64) {
        match self {
            Self::GaussNewton => gauss_newton(problem, start, true),
            Self::GaussNewtonQuotients => gauss_newton(problem, start, false),
            Self::Simplex => nelder_mead(problem, start),
            Self::Bfgs => bfgs(problem, start),
            Self::Sqp => sqp(problem, start),
            Self::Cobyla => by_cobyla(problem, start),
            Self::HookeJeeves => hooke_jeeves(problem, start, BUDGET),
            Self::Swarm => swarm(problem, start.len(), seed),
            Self::CmaEs => cma_es(problem, start, seed, BUDGET),
            Self::Annealing => annealing(problem, start, seed),
        }
    }
}

fn gauss_newton(problem: &Counted<'_>, start: &[f64], sensitivities: bool) {
    let region = Region { low: vec![0.0; start.len()], high: vec![1.0; start.len()], held: None };
    let best = Cell::new(f64::INFINITY);
    let model = |u: &[f64]| {
        let quadratic = problem.quadratic(u, sensitivities, best.get());
        best.set(best.get().min(quadratic.value));
        quadratic
    };
    minimise(&Together(model), &region, start, &Rule::default());
}

fn nelder_mead(problem: &Counted<'_>, start: &[f64]) {
    let bounds = Bounds { low: vec![0.0; start.len()], high: vec![1.0; start.len()] };
    // Every iteration but a shrink costs one or two evaluations.
    let stop = Stop { size: STILL, spread: TOLERANCE, iterations: BUDGET / 2 };
    simplex::descend(&|u: &[f64]| problem.value(u), &bounds, start, 0.08, stop);
}

/// The problem as argmin sees it: no bounds, so that walls mirror.
struct Open<'a, 'b> {
    problem: &'a Counted<'b>,
    chance: RefCell<Pcg64>,
    logarithmic: bool,
}

impl CostFunction for Open<'_, '_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, u: &Vec<f64>) -> Result<f64, Error> {
        let value = self.problem.mirrored(u);
        Ok(if self.logarithmic { value.max(f64::MIN_POSITIVE).ln() } else { value })
    }
}

impl Gradient for Open<'_, '_> {
    type Param = Vec<f64>;
    type Gradient = Vec<f64>;

    fn gradient(&self, u: &Vec<f64>) -> Result<Vec<f64>, Error> {
        Ok(self.problem.mirrored_gradient(u))
    }
}

impl Anneal for Open<'_, '_> {
    type Param = Vec<f64>;
    type Output = Vec<f64>;
    type Float = f64;

    fn anneal(&self, u: &Vec<f64>, temperature: f64) -> Result<Vec<f64>, Error> {
        let step = (HOT_STEP * temperature.sqrt()).max(COLD_STEP);
        let mut chance = self.chance.borrow_mut();
        let moved = |u: &f64| {
            let normal: f64 = StandardNormal.sample(&mut *chance);
            u + step * normal
        };
        Ok(super::landscape::inside(&u.iter().map(moved).collect::<Vec<f64>>()))
    }
}

fn open<'a, 'b>(problem: &'a Counted<'b>, seed: u64, logarithmic: bool) -> Open<'a, 'b> {
    Open { problem, chance: RefCell::new(Pcg64::seed_from_u64(seed)), logarithmic }
}

/// A line search that fails ends the search where it stands: its best point is in the trace all the same.
fn bfgs(problem: &Counted<'_>, start: &[f64]) {
    let identity: Vec<Vec<f64>> =
        (0..start.len()).map(|i| (0..start.len()).map(|j| f64::from(u8::from(i == j))).collect()).collect();
    let solver = BFGS::new(MoreThuenteLineSearch::new());
    let Ok(solver) = solver.with_tolerance_cost(TOLERANCE * 1e-4) else { return };
    // The gradient's own error is about 1e-8 of the objective's scale.
    let Ok(solver) = solver.with_tolerance_grad(1e-9) else { return };
    let iterations = (BUDGET / (start.len() + 2)) as u64;
    let run = Executor::new(open(problem, 0, false), solver)
        .configure(|state| state.param(start.to_vec()).inv_hessian(identity).max_iters(iterations))
        .run();
    drop(run);
}

fn swarm(problem: &Counted<'_>, dimension: usize, seed: u64) {
    let solver = ParticleSwarm::new((vec![0.0; dimension], vec![1.0; dimension]), PARTICLES)
        .with_rng_generator(Pcg64::seed_from_u64(seed));
    let iterations = (BUDGET / PARTICLES).saturating_sub(1) as u64;
    let run = Executor::new(open(problem, seed, false), solver).configure(|state| state.max_iters(iterations)).run();
    drop(run);
}

fn annealing(problem: &Counted<'_>, start: &[f64], seed: u64) {
    let Ok(solver) = SimulatedAnnealing::new_with_rng(HOT, Pcg64::seed_from_u64(seed)) else { return };
    let cooling = (COLD / HOT).powf(1.0 / BUDGET as f64);
    let solver = solver.with_temp_func(SATempFunc::Exponential(cooling));
    let run = Executor::new(open(problem, seed.wrapping_add(1), true), solver)
        .configure(|state| state.param(start.to_vec()).max_iters(BUDGET as u64 - 1))
        .run();
    drop(run);
}

fn sqp(problem: &Counted<'_>, start: &[f64]) {
    let objective = |u: &[f64], gradient: Option<&mut [f64]>, (): &mut ()| {
        let value = problem.value(u);
        if let Some(slopes) = gradient {
            slopes.copy_from_slice(&problem.gradient(u, value));
        }
        value
    };
    let none: [&dyn slsqp::Func<()>; 0] = [];
    let tolerances = slsqp::StopTols { ftol_rel: TOLERANCE, xtol_abs: vec![STILL; start.len()], ..Default::default() };
    let bounds = vec![(0.0, 1.0); start.len()];
    // Its own count is of calls; each costs the quotients as well.
    let calls = BUDGET / (start.len() + 1);
    let outcome = slsqp::minimize(objective, start, &bounds, &none, (), calls, Some(tolerances));
    drop(outcome);
}

fn by_cobyla(problem: &Counted<'_>, start: &[f64]) {
    let objective = |u: &[f64], (): &mut ()| problem.value(u);
    let none: [&dyn cobyla::Func<()>; 0] = [];
    let tolerances = cobyla::StopTols { ftol_rel: TOLERANCE, xtol_abs: vec![STILL; start.len()], ..Default::default() };
    let bounds = vec![(0.0, 1.0); start.len()];
    let begin = cobyla::RhoBeg::All(0.2);
    let outcome = cobyla::minimize(objective, start, &bounds, &none, (), BUDGET, begin, Some(tolerances));
    drop(outcome);
}
