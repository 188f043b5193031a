//! Solving many points in parallel.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;
use std::time::Instant;

use super::{Point, SweepSpec};
use crate::solid::solve::SolveError;

/// Forces of one point (N): `[rate][sample]`, samples being the depths and then the times of the hold.
pub type Forces = Vec<Vec<f64>>;

/// One finished job.
#[derive(Debug, Clone, PartialEq)]
pub struct Finished {
    /// Its number.
    pub job: usize,
    /// Time it took (s).
    pub seconds: f64,
    /// The forces, or why there are none.
    pub outcome: Result<Forces, String>,
}

/// Solves `jobs` on `threads` threads (at least one) and hands every finished one to `keep`, one at a time, in
/// the order in which they end. The outcome of a job depends on nothing but its number.
///
/// A job whose solver returns an error, panics, or gives forces of the wrong shape or that are not finite is
/// kept with that as its text.
///
/// # Errors
/// The first error of `keep`; no job is begun after it.
pub fn run<S, K, E>(spec: &SweepSpec, jobs: &[usize], threads: usize, solve: &S, keep: K) -> Result<(), E>
where
    S: Fn(&Point) -> Result<Forces, SolveError> + Sync,
    K: FnMut(Finished) -> Result<(), E> + Send,
    E: Send,
{
    let next = AtomicUsize::new(0);
    let stop = AtomicBool::new(false);
    let keeper = Mutex::new((keep, None));
    let work = || {
        while !stop.load(Ordering::Relaxed) {
            let Some(&job) = jobs.get(next.fetch_add(1, Ordering::Relaxed)) else { break };
            let finished = finish(spec, job, solve);
            let Ok(mut keeper) = keeper.lock() else { break };
            if keeper.1.is_none()
                && let Err(error) = (keeper.0)(finished)
            {
                keeper.1 = Some(error);
                stop.store(true, Ordering::Relaxed);
            }
        }
    };
    thread::scope(|scope| {
        for _ in 1..threads.min(jobs.len()) {
            scope.spawn(work);
        }
        work();
    });
    match keeper.into_inner() {
        Ok((_, Some(error))) => Err(error),
        _ => Ok(()),
    }
}

fn finish<S>(spec: &SweepSpec, job: usize, solve: &S) -> Finished
where
    S: Fn(&Point) -> Result<Forces, SolveError>,
{
    let start = Instant::now();
    let outcome = match spec.point(job) {
        None => Err("no such point".to_owned()),
        // A numerical library may panic on a matrix that went wrong; one point must not take the others along.
        Some(point) => match catch_unwind(AssertUnwindSafe(|| solve(&point))) {
            Err(_) => Err("the solver broke off in the middle (a defect; its message is above)".to_owned()),
            Ok(Err(error)) => Err(error.to_string()),
            Ok(Ok(forces)) => sound(spec, forces),
        },
    };
    Finished { job, seconds: start.elapsed().as_secs_f64(), outcome }
}

fn sound(spec: &SweepSpec, forces: Forces) -> Result<Forces, String> {
    let (rates, samples) = (spec.motion.rates_mm_s.len(), spec.motion.samples());
    if forces.len() != rates || forces.iter().any(|c| c.len() != samples) {
        return Err(format!("the solver did not return {rates} curves of {samples} forces"));
    }
    for (curve, rate) in forces.iter().zip(&spec.motion.rates_mm_s) {
        if let Some(i) = curve.iter().position(|f| !f.is_finite()) {
            return Err(format!("the force of sample {} at {rate} mm/s is {}", i + 1, curve[i]));
        }
    }
    Ok(forces)
}
