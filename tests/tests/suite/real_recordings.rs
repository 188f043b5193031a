//! `palpate identify` runs through real recordings and shows where the model is wrong.
//!
//! The recordings are not part of this repository; without them the tests say SKIPPED.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::path::Path;

use crate::MODELS;
use palpate::diagnose::{Diagnosis, diagnose};
use palpate::experiment::{self, Experiment, motion};
use palpate::identify::spec::FitSpec;
use palpate::identify::{self, Identification, Outcome, identify};
use palpate::report;

/// The experiment of the name of its recordings, or `None` with a visible message if they are absent.
fn experiment(name: &str) -> Option<Experiment> {
    of_recordings(name, name)
}

fn of_recordings(name: &str, recordings: &str) -> Option<Experiment> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    tests::shared_or_skipped(&format!("data/{recordings}"))?;
    Some(experiment::read(&root.join("experiments").join(name)).unwrap())
}

/// What must hold however wrong the model is.
fn check(experiment: &Experiment, found: &[Identification]) {
    for one in found {
        let fit = one.fit.as_ref().expect("a curve with contact can be fitted");
        assert!(matches!(one.outcome, Outcome::Fitted | Outcome::OutsideGrid), "{:?}", one.outcome);
        for parameter in &fit.parameters {
            let interval = parameter.interval95;
            println!("{} {} [{}, {}]", parameter.name, parameter.value, interval.low, interval.high);
            assert!(interval.low <= parameter.value && parameter.value <= interval.high);
            assert!(parameter.bounds.0 <= interval.low * 1.0001 && interval.high <= parameter.bounds.1 * 1.0001);
        }
        // Interpolation against a direct solve: its stated bound is of the order of 0.1 %.
        assert!(one.direct_check.unwrap() < 0.01, "{:?}", one.direct_check);
        let said = one.messages.join("\n");
        assert!(said.contains("systematically wrong"), "the misfit must be told: {said}");
        assert!(said.contains("equator"), "the cut must be told: {said}");
        for message in &one.messages {
            println!("{message}");
        }
    }
    let html = report::identification::page(experiment, found).html();
    for needed in ["Measured minus fitted", "Objective around the minimum", "Assumptions", "systematically wrong"] {
        assert!(html.contains(needed), "{needed}");
    }
    assert!(!html.contains("NaN") && !html.contains("<script"));
}

#[test]
fn silicone_of_unknown_height() {
    let Some(experiment) = experiment("silicone_ball") else { return };
    let found = identify(&experiment, &FitSpec::default(), &|_, _, _| {}).unwrap();
    check(&experiment, &found);
    let fit = found[0].fit.as_ref().unwrap();
    assert!(fit.parameters.iter().any(|p| p.name == "height_mm"), "the height is a free parameter");
    let said = found[0].messages.join("\n");
    assert!(said.contains("P002-7.csv: force falls by 0.236 N"), "{said}");
}

#[test]
fn beef_of_two_muscles() {
    let Some(experiment) = experiment("beef_ball") else { return };
    let found = identify(&experiment, &FitSpec::default(), &|_, _, _| {}).unwrap();
    assert_eq!(found.iter().map(|one| one.material.as_str()).collect::<Vec<_>>(), ["FF", "RDG"]);
    check(&experiment, &found);
}

/// Beef relaxes by half in a hold of ten seconds, and that is named; parts of the path that no fit has seen are predicted twice as well with it. The base that is shown beside it is a
/// fit of the data.
#[test]
fn beef_relaxes_beside_a_base_that_is_a_fit_of_it() {
    let Some(experiment) = of_recordings("beef_diagnosed", "beef_ball") else { return };
    let found = diagnose(&experiment, &MODELS, &|_, _, _| {}).unwrap();
    assert_eq!(found.len(), 2);
    for one in &found {
        let Diagnosis { material, evidence, findings, .. } = one;
        let evidence = evidence.as_ref().unwrap();
        assert_eq!(findings.iter().map(|f| f.code).collect::<Vec<_>>(), ["relaxation"], "{material}");
        let held_out = one.held_out().unwrap();
        assert!(held_out.rmse_after_n < 0.5 * held_out.rmse_before_n, "{material}: {held_out:?}");
        let (mut left, mut whole) = (0.0, 0.0);
        for (series, base) in evidence.design.series.iter().zip(&evidence.before.curves) {
            for (node, force) in series.nodes.iter().zip(&base.force_n) {
                left += (node.force_n - force).powi(2);
                whole += node.force_n.powi(2);
            }
        }
        let share = (left / whole).sqrt();
        assert!(share < 0.5, "{material}: the base leaves {share:.2} of the forces");
    }
}

/// Branches as a reader of the files would set them: figures read off the recordings.
#[test]
fn branches_of_real_runs() {
    let Some(experiment) = experiment("silicone_ball") else { return };
    for (run, motion) in experiment.runs.iter().zip(identify::motions(&experiment)) {
        let motion = motion.unwrap();
        // 10 mm/min in every run, whatever the machine's summary says of its speed.
        assert!((motion.rate_mm_per_s - 0.1667).abs() < 0.001, "{} {motion:?}", run.file);
        let hold = motion.hold.clone().unwrap();
        let time = &run.recording.time_s;
        let held_s = time[hold.end - 1] - time[hold.start];
        assert!((held_s - 10.3).abs() < 0.7, "{} held {held_s} s", run.file);
        assert!(motion.unloading.is_some() && motion.loadings.len() == 1, "{} {motion:?}", run.file);
        let faulty = run.file.contains("P002-7");
        assert_eq!(motion.events.len(), usize::from(faulty), "{} {:?}", run.file, motion.events);
        if faulty {
            assert!(
                matches!(motion.events[0], motion::Event::ForceDrop { depth_mm, .. } if (depth_mm - 9.63).abs() < 0.02)
            );
        }
    }
    let Some(experiment) = self::experiment("beef_ball") else { return };
    for motion in identify::motions(&experiment) {
        let motion = motion.unwrap();
        assert!((motion.rate_mm_per_s - 1.0).abs() < 0.02, "{motion:?}");
        assert!(motion.hold.is_some() && motion.unloading.is_none(), "{motion:?}");
    }
}
