//! Blind recovery: foams drawn from the thesis' ranges, recordings of two balls made on a finer mesh than the fit's, with noise and
//! unknown contact points; what the fit finds is held against the Cramer-Rao bound of each case.

use lut_gen::solid::contact::Ball;
use lut_gen::solid::law::Hyperfoam;
use lut_gen::solid::model::{ForceModel, Indentation, ModelSpec, Resolution, Specimen as Block};
use lut_gen::solid::solve::SolveError;
use palpate::experiment::{self, BaseLaw, Experiment};
use palpate::identify::newton::condition::{Condition, Source};
use palpate::identify::newton::problem::Weight;
use palpate::identify::newton::setup;
use palpate::identify::spec::{FitSpec, Loss};
use palpate::identify::{Identification, data, fe::ModelError, identify_from};
use palpate::infer::covariance::standard_errors;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use rayon::prelude::*;

use crate::bench::{Bench, RADIUS_MM, STEP_MM};

/// Ranges of the thesis' grid (section 3.2.2).
const MU_MPA: (f64, f64) = (0.0005, 0.3);
const ALPHA: (f64, f64) = (1.0, 24.0);
/// Height of the block, that of the thesis' B1.
const HEIGHT_MM: f64 = 19.05;
/// Depth past contact, a little above the equator of the smaller ball.
const DEPTH_MM: f64 = 3.9;
/// Noise of a sample as a share of the run's largest force.
const NOISE: f64 = 0.01;
/// The balls of thesis section 2.6.
pub const BALLS_MM: [f64; 2] = [4.0, 6.0];
/// The recordings' mesh is this much finer than the fit's.
const FINER: f64 = 1.5;

/// A foam and what chance adds to its recordings.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Shear modulus, MPa.
    pub mu_mpa: f64,
    /// Exponent.
    pub alpha: f64,
    /// The recordings.
    pub experiment: Experiment,
}

/// What was recovered of a case.
#[derive(Debug, Clone)]
pub struct Recovered {
    /// Truth: mu (MPa), alpha.
    pub truth: [f64; 2],
    /// Estimates.
    pub value: [f64; 2],
    /// Their 95 % intervals.
    pub interval: [(f64, f64); 2],
    /// Cramer-Rao bound of the standard deviations of ln mu and ln alpha, with the noise and the truth known.
    pub bound: [f64; 2],
    /// Word of the outcome.
    pub outcome: &'static str,
    /// Finite-element solves.
    pub solves: usize,
    /// Wall time, s.
    pub seconds: f64,
}

/// Draws `count` foams and makes their recordings, in parallel; draws that cannot be solved are left out and counted.
#[must_use]
pub fn cases(seed: u64, count: usize) -> (Vec<Case>, usize) {
    let made: Vec<Option<Case>> = (0..count).into_par_iter().map(|at| case(seed, at).ok()).collect();
    let failed = made.iter().filter(|case| case.is_none()).count();
    (made.into_iter().flatten().collect(), failed)
}

fn case(seed: u64, at: usize) -> Result<Case, SolveError> {
    let (mu_mpa, alpha, chance) = drawn(seed, at);
    let mut bench = Bench::new(BaseLaw::Hyperfoam, NOISE, chance);
    bench.specimen("foam", HEIGHT_MM);
    for &radius_mm in &BALLS_MM {
        let indenter = bench.ball(radius_mm);
        let depths: Vec<f64> = (1..=(DEPTH_MM / STEP_MM) as usize).map(|i| STEP_MM * i as f64).collect();
        let problem = Indentation {
            law: Hyperfoam::one_term(mu_mpa, alpha)?,
            specimen: block(),
            ball: Ball { radius_mm },
            depth_mm: DEPTH_MM,
            resolution: Resolution::Refined(FINER),
        };
        let forces = problem.solve_at(&depths)?.force_n;
        bench.press(0, indenter, &forces);
    }
    Ok(Case { mu_mpa, alpha, experiment: bench.experiment })
}

/// A foam's mu (MPa), even in its logarithm, and alpha, and what draws the rest of its case.
fn drawn(seed: u64, at: usize) -> (f64, f64, Pcg64) {
    let mut chance = Pcg64::seed_from_u64(seed.wrapping_add(at as u64));
    let mu_mpa = MU_MPA.0 * (MU_MPA.1 / MU_MPA.0).powf(chance.random::<f64>());
    let alpha = chance.random_range(ALPHA.0..ALPHA.1);
    (mu_mpa, alpha, chance)
}

/// The block under the balls.
#[must_use]
pub fn block() -> Block {
    Block { height_mm: HEIGHT_MM, radius_mm: RADIUS_MM, base: lut_gen::solid::solve::Base::Bonded }
}

/// One force model a ball, on the fit's mesh: a thousand fits then need no solve of their own.
///
/// # Errors
/// When a solve fails.
pub fn models() -> Result<Vec<ForceModel>, SolveError> {
    let model = |radius_mm: &f64| {
        let mut spec = ModelSpec::new(block(), Ball { radius_mm: *radius_mm }, 1.05 * DEPTH_MM);
        (spec.alpha, spec.alpha_nodes) = (setup::ALPHA, 14);
        ForceModel::build(&spec, &|_, _| {})
    };
    BALLS_MM.iter().map(model).collect()
}

/// Fits a case: with the models if there are any, with solves of its own otherwise.
///
/// # Errors
/// When the fit cannot begin.
pub fn recover(case: &Case, models: &[ForceModel], spec: &FitSpec) -> Result<Recovered, ModelError> {
    let source = |condition: &Condition| match condition.grip.indenter().and_then(|ball| models.get(ball)) {
        Some(model) => Source::Model(Box::new(model.clone())),
        None => Source::Solves(Resolution::Standard),
    };
    let found = identify_from(&case.experiment, "foam", spec, &source)?;
    let of = |name: &str| found.fit.as_ref().and_then(|fit| fit.parameters.iter().find(|p| p.name == name));
    let (mu, alpha) = (of("mu_MPa"), of("alpha"));
    let value = |p: Option<&palpate::identify::fit::Parameter>| p.map_or(f64::NAN, |p| p.value);
    let interval = |p: Option<&palpate::identify::fit::Parameter>| {
        p.map_or((f64::NAN, f64::NAN), |p| (p.interval95.low, p.interval95.high))
    };
    Ok(Recovered {
        truth: [case.mu_mpa, case.alpha],
        value: [value(mu), value(alpha)],
        interval: [interval(mu), interval(alpha)],
        bound: bound(case, &found, spec, &source),
        outcome: found.outcome.word(),
        solves: found.fe_solves,
        seconds: found.seconds,
    })
}

/// The Cramer-Rao bound: inverse Fisher information at the truth, with the true noise and free contact points.
fn bound(case: &Case, found: &Identification, spec: &FitSpec, source: &dyn Fn(&Condition) -> Source) -> [f64; 2] {
    let exact = FitSpec { loss: Loss::Squares, ..spec.clone() };
    let mut problem = setup::problem(&case.experiment, &found.selection, "foam", &exact, source);
    let peak = |force: &[f64]| force.iter().copied().fold(0.0, f64::max);
    problem.weights = found
        .selection
        .curves
        .iter()
        .map(|curve| Weight { sigma_n: NOISE * peak(&curve.force_n), correlated: 1.0 })
        .collect();
    let truth = vec![case.mu_mpa.ln(), case.alpha.ln()];
    if problem.solve_at(std::slice::from_ref(&truth)).is_err() {
        return [f64::NAN; 2];
    }
    let errors = standard_errors(&problem.quadratic(&truth).hessian);
    [errors[0], errors[1]]
}

/// What a set of recovered cases says.
#[derive(Debug, Clone, PartialEq)]
pub struct Statistics {
    /// Cases.
    pub cases: usize,
    /// Median of |error of the logarithm| over what a normal error of the Cramer-Rao bound's size would have, for mu and alpha.
    pub error_over_bound: [f64; 2],
    /// Median of the bound: relative standard deviation of mu and of alpha.
    pub bound: [f64; 2],
    /// Median relative error.
    pub error: [f64; 2],
    /// Share of the intervals that hold the truth.
    pub coverage: [f64; 2],
    /// Most and mean solves.
    pub solves: (usize, f64),
    /// Median time, s.
    pub seconds: f64,
}

/// Median of |x| for unit normal x.
const MEDIAN_OF_NORMAL: f64 = 0.674_489_75;

/// Summarises.
#[must_use]
pub fn statistics(all: &[Recovered]) -> Statistics {
    let each = |f: &dyn Fn(&Recovered, usize) -> f64| [0, 1].map(|p| median(all.iter().map(|r| f(r, p)).collect()));
    let error = |r: &Recovered, p: usize| (r.value[p] / r.truth[p]).ln().abs();
    let inside = |r: &&Recovered, p: usize| r.interval[p].0 <= r.truth[p] && r.truth[p] <= r.interval[p].1;
    let count = all.len().max(1) as f64;
    Statistics {
        cases: all.len(),
        error_over_bound: each(&|r, p| error(r, p) / (MEDIAN_OF_NORMAL * r.bound[p])),
        bound: each(&|r, p| r.bound[p]),
        error: each(&error),
        coverage: [0, 1].map(|p| all.iter().filter(|r| inside(r, p)).count() as f64 / count),
        solves: (
            all.iter().map(|r| r.solves).max().unwrap_or(0),
            all.iter().map(|r| r.solves as f64).sum::<f64>() / count,
        ),
        seconds: median(all.iter().map(|r| r.seconds).collect()),
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Motions of a case's runs, for those who select data themselves.
#[must_use]
pub fn selection(case: &Case) -> data::Selection {
    let motions: Vec<_> = case.experiment.runs.iter().map(|run| experiment::motion::of(&run.recording)).collect();
    data::select(&case.experiment, &motions, "foam", false)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tenth of a thousand draws in every tenth of both ranges, within four standard deviations of 9.5.
    #[test]
    fn draws_fill_the_ranges_evenly() {
        let mut counts = [[0_i32; 10]; 2];
        for at in 0..1000 {
            let (mu_mpa, alpha, _) = drawn(1, at);
            let shares =
                [(mu_mpa / MU_MPA.0).ln() / (MU_MPA.1 / MU_MPA.0).ln(), (alpha - ALPHA.0) / (ALPHA.1 - ALPHA.0)];
            for (counts, share) in counts.iter_mut().zip(shares) {
                counts[((10.0 * share) as usize).min(9)] += 1;
            }
        }
        assert!(counts.iter().flatten().all(|count| (count - 100).abs() < 38), "{counts:?}");
    }
}
