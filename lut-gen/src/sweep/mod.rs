//! High-dimensional tables: force curves over any number of parameters.
//!
//! A [`SweepSpec`] names the axes, what is fixed, and the motion. Its points are numbered ([`SweepSpec::point`]);
//! [`run`] solves any set of them in parallel and hands over every one as it ends; a [`Journal`] keeps them, so that
//! a killed run continues and a [`Shard`] can run on another machine; [`merge`] turns the journals of all shards into
//! one [`SweepTable`], whose bytes do not depend on how the work was divided.
//!
//! ```
//! use lut_gen::sweep::{Finished, Journal, JournalHead, Parameter, Shard, SweepAxis, SweepLaw, SweepSpec, merge, run};
//!
//! let spec = SweepSpec::new("two foams", SweepLaw::Hyperfoam)
//!     .over(SweepAxis::listed(Parameter::Mu, &[0.1, 0.2]))
//!     .over(SweepAxis::listed(Parameter::Alpha, &[4.0, 8.0]));
//! spec.check()?;
//! let mut bytes = JournalHead { spec: spec.clone(), engine: "an example".into(), shard: Shard::WHOLE }.bytes();
//! let jobs: Vec<usize> = (0..spec.jobs()).collect();
//! // In place of `sweep::solve_point`: the force is mu times depth.
//! let solve = |point: &lut_gen::sweep::Point| {
//!     let mu = point.get(Parameter::Mu).unwrap_or(0.0);
//!     Ok(vec![spec.motion.depths_mm.iter().map(|d| mu * d).collect()])
//! };
//! run(&spec, &jobs, 2, &solve, |finished: Finished| {
//!     bytes.extend(finished.record());
//!     Ok::<(), std::io::Error>(())
//! })?;
//! let table = merge(&spec, &[("example".into(), Journal::parse(&bytes)?)])?;
//! assert!((table.forces_at(&[0.15, 5.0])?[0][199] - 0.1414 * 4.0).abs() < 1e-3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod axis;
mod journal;
mod merge;
mod parameter;
mod point;
mod run;
mod shard;
mod solve;
mod spec;
mod table;

pub use axis::{Spacing, SweepAxis};
pub use journal::{Journal, JournalError, JournalHead};
pub use merge::{MergeError, difference, merge};
pub use parameter::Parameter;
pub use point::{Point, Purpose};
pub use run::{Finished, Forces, run};
pub use shard::{Shard, ShardError};
pub use solve::{engine, solve_point};
pub use spec::{MOST_POINTS, SpecError, SweepBase, SweepLaw, SweepMotion, SweepSpec};
pub use table::{SweepErrorBound, SweepTable, TABLE_MAGIC, TableError};
