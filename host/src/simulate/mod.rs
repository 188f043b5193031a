//! Experiments that never happened: recordings of a true specimen, machine and sensor that may differ from what the
//! experiment declares.
//!
//! A [`Spec`] says what is declared, what is done, what chance adds, and by which [`Effect`]s the truth differs from what is
//! declared. The forces are those of finite elements on a finer mesh along the whole motion of the ball (relaxation, softening,
//! friction and adhesion as in the material and the contact themselves); machine and sensor are differential equations over a
//! time grid finer than the samples. Nothing here uses the force model or the convolutions that a diagnosis works with.
//!
//! ```
//! use palpate::simulate::{Effect, RunTemplate, Solver, Spec, simulate};
//!
//! let mut spec = Spec::new("one press", 1).foam("foam", 0.1, 8.0, 12.7).ball("r4", 4.0);
//! spec.runs.push(RunTemplate::ramp("foam", "r4", 1.0, 2.0));
//! spec.refinement = 0.5; // coarse, for an example
//! let spec = spec.with(Effect::SensorGain { gain: 2.0 });
//! let made = simulate(&spec, &Solver::new(), &|_, _, _| {})?;
//! assert_eq!(made.runs[0].time_s.len(), 26);
//! # Ok::<(), palpate::simulate::SimulateError>(())
//! ```

mod body;
mod chance;
mod check;
mod condition;
mod coupon;
mod description;
pub mod display;
pub mod effect;
mod error;
mod folder;
mod interpolation;
mod motion;
mod noise;
mod path;
mod plan;
mod progress;
mod recorded;
mod response;
mod session;
mod solved;
mod solver;
mod spec;
#[cfg(test)]
mod tests;

pub use description::{EXAMPLE, parse, read};
pub use effect::{Along, Effect, Kernel, Rest, ShareOf, Variable};
pub use error::SimulateError;
pub use folder::{SimulatedExperiment, SimulatedRun, check_folder};
pub use progress::Progress;
pub use solver::Solver;
pub use spec::{FINER, Noise, RunTemplate, SAMPLE_HZ, SecondTerm, Session, Spec, TrueIndenter, TrueLaw, TrueSpecimen};

/// Simulates an experiment. The same specification gives the same bytes, whatever the number of threads and whatever the solver
/// has solved before.
///
/// # Errors
/// [`SimulateError`]: what does not go together, and solves that fail, named by specimen and ball.
pub fn simulate(spec: &Spec, solver: &Solver, progress: Progress<'_>) -> Result<SimulatedExperiment, SimulateError> {
    check::check(spec)?;
    let before = solver.solves();
    let conditions = solved::conditions(spec, solver, progress)?;
    let runs = recorded::runs(spec, &conditions)?;
    let (specimens, indenters) = folder::declared(spec);
    let noise_n = (spec.state_noise && spec.noise.sensor_n > 0.0).then_some(spec.noise.sensor_n);
    Ok(SimulatedExperiment {
        name: spec.name.clone(),
        specimens,
        indenters,
        sensor: crate::experiment::Sensor { noise_n, ..Default::default() },
        runs,
        truth: spec.clone(),
        solves: solver.solves() - before,
    })
}
