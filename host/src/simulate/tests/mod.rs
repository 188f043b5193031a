#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod coupon;
mod effects;
mod folder;
mod noise;
mod text;

use std::sync::LazyLock;

use lut_gen::solid::law::PronyTerm;

use super::*;

/// Cases that several tests share are solved once.
pub(super) static SOLVER: LazyLock<Solver> = LazyLock::new(Solver::new);

/// One press of 2 mm with a hold and back, without noise, on the standard mesh (a third of the finer one's time).
pub(super) fn press() -> Spec {
    let mut spec = Spec::new("press", 7).foam("foam", 0.1, 8.0, 12.7).ball("r4", 4.0);
    spec.refinement = 1.0;
    spec.session.random_order = false;
    let run = RunTemplate { hold_s: 4.0, unload: true, ..RunTemplate::ramp("foam", "r4", 2.0, 4.0) };
    spec.runs.push(run);
    spec
}

pub(super) fn made(spec: &Spec) -> SimulatedExperiment {
    simulate(spec, &SOLVER, &|_, _, _| {}).unwrap_or_else(|error| panic!("{error}"))
}
