//! What a specification must hold before anything is computed; its fields are public.

use crate::experiment::Test;

use super::SimulateError;
use super::effect::Effect;
use super::spec::{RunTemplate, Spec, TrueLaw, TrueSpecimen};

/// Most runs of an experiment, and samples of a run.
const MOST_RUNS: usize = 10_000;
const MOST_SAMPLES: f64 = 1e6;

/// Depths beyond this part of the true height are refused (the finite elements go to 95 %).
pub(super) const DEEPEST: f64 = 0.9;

/// A number, the interval it must lie in, and how that is said.
type Demand<'a> = (&'static str, f64, f64, f64, &'a str);

fn demand(place: &str, all: &[Demand<'_>]) -> Result<(), SimulateError> {
    for (key, value, low, high, expected) in all {
        if !(*low..=*high).contains(value) {
            let (place, expected) = (place.to_owned(), (*expected).to_owned());
            return Err(SimulateError::Value { place, key, value: *value, expected });
        }
    }
    Ok(())
}

/// Checks everything that stands for itself.
///
/// # Errors
/// The first value that makes no sense.
pub(super) fn check(spec: &Spec) -> Result<(), SimulateError> {
    demand(
        "the specification",
        &[
            ("sample_hz", spec.sample_hz, 1.0, 1e4, "1 to 10000 samples a second"),
            ("refinement", spec.refinement, 0.3, 6.0, "0.3 to 6"),
        ],
    )?;
    for one in &spec.specimens {
        let place = format!("specimen \"{}\"", one.name);
        let length = "a length of 0.05 to 1000 mm";
        demand(
            &place,
            &[
                ("height_mm", one.height_mm, 0.05, 1000.0, length),
                ("radius_mm", one.radius_mm, 0.05, 1000.0, length),
                ("nu", one.nu, -0.9, 0.4999, "a ratio of -0.9 to 0.4999"),
            ],
        )?;
        if let TrueLaw::Rigid { reduced_modulus_mpa } = one.law {
            let expected = "a modulus of 1 to 1000000 MPa";
            demand(&place, &[("reduced_modulus_MPa", reduced_modulus_mpa, 1.0, 1e6, expected)])?;
        } else {
            demand(&place, &[("mu_MPa", one.mu_mpa, 1e-6, 1e4, "a shear modulus of 0.000001 to 10000 MPa")])?;
        }
    }
    for one in &spec.indenters {
        let place = format!("indenter \"{}\"", one.name);
        demand(&place, &[("radius_mm", one.radius_mm, 0.05, 1000.0, "a length of 0.05 to 1000 mm")])?;
    }
    noise(spec)?;
    if spec.runs.is_empty() {
        return Err(SimulateError::Empty);
    }
    for (at, run) in spec.runs.iter().enumerate() {
        template(spec, at, run)?;
    }
    for effect in &spec.effects {
        if let Effect::Radius { indenter, .. } = effect {
            known_ball(spec, "effect radius", indenter)?;
        }
    }
    let total: usize =
        spec.runs.iter().map(|run| run.replicates.saturating_mul(run.cycles)).fold(0, usize::saturating_add);
    demand("the specification", &[("number of runs", total as f64, 1.0, MOST_RUNS as f64, "1 to 10000")])
}

fn noise(spec: &Spec) -> Result<(), SimulateError> {
    let n = &spec.noise;
    demand(
        "[noise]",
        &[
            ("sensor_N", n.sensor_n, 0.0, 1e6, "a standard deviation of 0 N or more"),
            ("correlation_s", n.correlation_s, 0.0, 1e4, "a time of 0 to 10000 s"),
            ("contact_jitter_mm", n.contact_jitter_mm, 0.0, 1.0, "a standard deviation of 0 to 1 mm"),
            ("gain_jitter", n.gain_jitter, 0.0, 0.5, "a relative standard deviation of 0 to 0.5"),
            ("memory_jitter", n.memory_jitter, 0.0, 0.5, "a standard deviation of 0 to 0.5 of a logarithm"),
            ("quantum_N", n.quantum_n, 0.0, 1e6, "a step of 0 N or more"),
            ("drift_N_per_h", n.drift_n_per_h, 0.0, 1e6, "a standard deviation of 0 N or more after an hour"),
            ("proportional", n.proportional, 0.0, 1.0, "a part of 0 to 1"),
        ],
    )?;
    let time = |key, value| (key, value, 0.0, 1e6, "a time of 0 to 1000000 s");
    demand("[session]", &[time("gap_s", spec.session.gap_s), time("start_s", spec.session.start_s)])
}

fn template(spec: &Spec, at: usize, run: &RunTemplate) -> Result<(), SimulateError> {
    let place = format!("[[run]] {}", at + 1);
    demand(
        &place,
        &[
            ("cycles", run.cycles as f64, 1.0, 1000.0, "1 to 1000"),
            ("replicates", run.replicates as f64, 1.0, 1000.0, "1 to 1000"),
            ("hold_s", run.hold_s, 0.0, 1e5, "a time of 0 to 100000 s"),
            ("rest_s", run.rest_s, 0.0, 1e6, "a time of 0 to 1000000 s"),
            ("air_mm", run.air_mm, 0.0, 100.0, "a length of 0 to 100 mm"),
        ],
    )?;
    match run.test {
        Test::Air | Test::Mass => {
            demand(&place, &[("hold_s", run.hold_s, 0.1, 1e5, "the duration of an air or mass run, 0.1 to 100000 s")])?;
            if run.test == Test::Mass {
                demand(&place, &[("load_N", run.load_n, -1e6, 1e6, "a load of -1000000 to 1000000 N")])?;
            }
            demand(&place, &[("hold_s * sample_hz", run.hold_s * spec.sample_hz, 1.0, MOST_SAMPLES, "at most 1000000")])
        }
        Test::Indentation => indentation(spec, &place, run),
        Test::Uniaxial | Test::Confined => coupon(spec, &place, run),
        _ => Err(SimulateError::Unknown {
            place,
            kind: "test that can be simulated, named",
            name: format!("{:?}", run.test).to_lowercase(),
            known: "indentation, uniaxial, confined, air, mass".to_owned(),
        }),
    }
}

/// The specimen of a run.
fn known_specimen<'a>(spec: &'a Spec, place: &str, run: &RunTemplate) -> Result<&'a TrueSpecimen, SimulateError> {
    let name = run.specimen.as_deref().unwrap_or_default();
    spec.specimen(name).ok_or_else(|| {
        let known = list(spec.specimens.iter().map(|one| one.name.as_str()));
        SimulateError::Unknown { place: place.to_owned(), kind: "specimen", name: name.to_owned(), known }
    })
}

/// A specimen that is shortened as a whole: soft, and by no ball.
fn coupon(spec: &Spec, place: &str, run: &RunTemplate) -> Result<(), SimulateError> {
    let specimen = known_specimen(spec, place, run)?;
    if matches!(specimen.law, TrueLaw::Rigid { .. }) {
        let soft = spec.specimens.iter().filter(|one| !matches!(one.law, TrueLaw::Rigid { .. }));
        let known = list(soft.map(|one| one.name.as_str()));
        let (place, name) = (place.to_owned(), specimen.name.clone());
        return Err(SimulateError::Unknown { place, kind: "specimen that is not rigid", name, known });
    }
    if let Some(name) = &run.indenter {
        let (place, name, known) = (place.to_owned(), name.clone(), "none".to_owned());
        return Err(SimulateError::Unknown {
            place,
            kind: "ball in the compression of a coupon, such as",
            name,
            known,
        });
    }
    demand(
        place,
        &[
            ("rate_mm_s", run.rate_mm_s, 1e-5, 1e4, "a rate of 0.00001 to 10000 mm/s"),
            ("depth_mm", run.depth_mm, 0.01, 1000.0, "a depth of 0.01 mm or more"),
        ],
    )?;
    samples(spec, place, run)
}

fn indentation(spec: &Spec, place: &str, run: &RunTemplate) -> Result<(), SimulateError> {
    let specimen = known_specimen(spec, place, run)?;
    known_ball(spec, place, run.indenter.as_deref().unwrap_or_default())?;
    demand(place, &[("rate_mm_s", run.rate_mm_s, 1e-5, 1e4, "a rate of 0.00001 to 10000 mm/s")])?;
    if matches!(specimen.law, TrueLaw::Rigid { .. }) {
        demand(place, &[("load_N", run.load_n, 1e-6, 1e6, "a load above 0 N on a rigid block")])?;
    } else {
        demand(place, &[("depth_mm", run.depth_mm, 0.01, 1000.0, "a depth of 0.01 mm or more")])?;
    }
    samples(spec, place, run)
}

fn samples(spec: &Spec, place: &str, run: &RunTemplate) -> Result<(), SimulateError> {
    let way = 2.0 * (run.depth_mm + run.air_mm) / run.rate_mm_s + run.hold_s;
    demand(
        place,
        &[("duration (s) * sample_hz", way * spec.sample_hz, 1.0, MOST_SAMPLES, "at most 1000000 samples a run")],
    )
}

fn known_ball(spec: &Spec, place: &str, name: &str) -> Result<(), SimulateError> {
    if spec.indenter(name).is_some() {
        return Ok(());
    }
    let known = list(spec.indenters.iter().map(|one| one.name.as_str()));
    Err(SimulateError::Unknown { place: place.to_owned(), kind: "indenter", name: name.to_owned(), known })
}

fn list<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let names: Vec<&str> = names.collect();
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}
