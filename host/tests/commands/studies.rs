//! The studies: as a command, and their searches where the answer is known.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::process::{Command, Output};

use lut_gen::solid::model::Resolution;
use palpate::identify::model::{ForwardModel, Shape, UnitCurve};
use palpate::study::rivals::landscape::{Ground, Landscape};
use palpate::study::rivals::method::Method;
use palpate::study::rivals::{Race, race};
use palpate::study::subject::of_balls;
use palpate::study::terms::{Effort, Optimum, ends};
use palpate::study::{Foam, StudyError, Subject};
use serde_json::Value;

fn study(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_palpate")).arg("study").args(arguments).output().unwrap()
}

#[test]
fn a_wrong_name_is_answered_with_the_known_ones() {
    let out = study(&["objectives"]);
    assert_eq!(out.status.code(), Some(2));
    let text = String::from_utf8(out.stderr).unwrap();
    assert!(text.contains("[possible values: objective, depth, curve, terms, rivals, script]"), "{text}");
}

#[test]
fn bad_parameters_are_named() {
    for (arguments, expected) in [
        (["objective", "--alpha", "40"], "--alpha = 40 must lie in 1..=24"),
        (["objective", "--noise", "80"], "--noise = 80 must lie in 0..=50 percent"),
        (["objective", "--balls-mm", "0.2"], "--balls-mm = 0.2 must lie in 1..=8 mm"),
    ] {
        let out = study(&arguments);
        let text = String::from_utf8(out.stderr).unwrap();
        assert!(out.status.code() == Some(2) && text.contains(expected), "{text}");
    }
}

#[test]
fn an_unknown_material_is_answered_with_the_known_ones() {
    let mut foam = coarse();
    foam.balls_mm = vec![4.0];
    let experiment = foam.experiment().unwrap();
    let error = Subject::measured(experiment, Some("rubber")).unwrap_err();
    assert_eq!(error.to_string(), "no run indents a material named \"rubber\"; the experiment has: EVA");
}

#[test]
fn the_objective_of_one_ball_as_json_and_as_files() {
    let folder = tempfile::tempdir().unwrap();
    let report = folder.path().to_str().unwrap();
    let out = study(&["objective", "--balls-mm", "4", "--json", "--report", report]);
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let answer: Value = serde_json::from_slice(&out.stdout).unwrap();
    assert_eq!(answer["study"], "objective");
    let panel = &answer["panels"][0];
    assert_eq!(panel["balls"], "ball of 4 mm");
    assert!(panel["starts"].as_array().unwrap().len() > 1);
    assert_eq!(panel["map"]["objective_N"].as_array().unwrap().len(), 144);
    assert_eq!(panel["converged"], true);
    // Both minimise over the same recordings, but by other weights: half of what noise scatters them apart from the truth.
    let apart = panel["gauss_newton"]["standard_errors_from_multistart"].as_f64().unwrap();
    assert!(apart < 1.0, "{apart}");
    for file in ["objective.html", "study-objective-1.svg"] {
        let text = std::fs::read_to_string(folder.path().join(file)).unwrap();
        assert!(text.contains("Gauss-Newton, solved") && text.contains("truth"), "{file}");
    }
}

/// The thesis' EVA on a coarse mesh, recordings and fits alike, so that a test takes seconds.
fn coarse() -> Foam {
    Foam { depth_mm: 3.0, noise: 0.005, resolution: COARSE, ..Foam::eva() }
}

const COARSE: Resolution = Resolution::Refined(0.4);

#[test]
fn two_terms_end_where_they_are_one() {
    let subject = Subject::simulated(Foam { balls_mm: vec![4.0], ..coarse() }).unwrap();
    let selection = of_balls(&subject.selection().unwrap(), &[0]);
    let effort = Effort { starts: 8, resolution: COARSE };
    let (ends, solves) = ends(&subject, &selection, &effort, &|_, _, _| {}).unwrap();
    assert_eq!(ends.len(), 8);
    assert!(solves >= 26, "the grid alone has 26 points: {solves}");
    for end in &ends {
        assert_eq!(Optimum::of(end.alpha, end.share_2), end.optimum);
        // All are one optimum: within a quarter of the 95 % width of one parameter.
        assert!((0.0..0.96).contains(&end.above_best), "{end:?}");
    }
    let degenerate = ends.iter().filter(|end| end.optimum != Optimum::Mixture).count();
    // The valley between them is flat: a mixture of exponents that differ by a tenth rises by less than a tenth of the above.
    assert!(2 * degenerate > ends.len(), "most ends lie where two terms are one: {ends:?}");
}

#[test]
fn other_laws_are_refused_by_name() {
    let mut subject = Subject::simulated(Foam { balls_mm: vec![4.0], ..coarse() }).unwrap();
    subject.experiment.specimens[0].terms = 2;
    let error = subject.foam_selection("depth", false).unwrap_err();
    assert!(matches!(error, StudyError::NotOneTermFoam { .. }));
    assert!(error.to_string().contains("\"EVA\" is declared as hyperfoam, 2 term(s)"), "{error}");
}

/// Hertz's law, softened with depth by alpha: of the shape of the real model, and read in no time.
struct ClosedForm(Vec<f64>);

impl ForwardModel for ClosedForm {
    fn curve(&self, pairing: usize, shape: Shape) -> UnitCurve {
        let ball_mm = self.0[pairing];
        let force = |d: f64| 8.0 / 3.0 * (ball_mm * d.powi(3)).sqrt() / (1.0 + 0.05 * shape.alpha * d / ball_mm);
        UnitCurve::sampled(4.0, 200, force)
    }
    fn alpha_bounds(&self) -> (f64, f64) {
        (1.0, 24.0)
    }
    fn relative_error(&self) -> f64 {
        0.0
    }
    fn solves(&self) -> usize {
        0
    }
}

fn small_race() -> Race {
    let subject = Subject::simulated(coarse()).unwrap();
    let selection = subject.selection().unwrap();
    let model = ClosedForm(selection.pairings.iter().map(|pairing| pairing.grip.ball_mm()).collect());
    let landscape = Landscape::new(&selection, &model).unwrap();
    assert_eq!((landscape.dimension(), landscape.conditions()), (4, 2));
    race(&landscape, 3, 7, &|_, _, _| {})
}

#[test]
fn rivals_are_counted_alike_and_repeat_themselves() {
    let (first, second) = (small_race(), small_race());
    assert_eq!(first.best, second.best);
    for (one, two) in first.records.iter().zip(&second.records) {
        let counts = |record: &palpate::study::rivals::Record| {
            record.searches.iter().map(|search| (search.evaluations, search.to_success)).collect::<Vec<_>>()
        };
        assert_eq!(counts(one), counts(two), "{}", one.method.word());
        // A line search or a generation may run a little past the budget.
        assert!(one.searches.iter().all(|s| (2..4100).contains(&s.evaluations)), "{one:?}");
        assert!(one.searches.iter().all(|s| s.to_success.is_none_or(|at| at <= s.evaluations)));
        assert!(one.searches.iter().all(|s| s.value >= first.best.0));
    }
    let record = |method: Method| first.records.iter().find(|record| record.method == method).unwrap();
    let (newton, quotients) = (record(Method::GaussNewton), record(Method::GaussNewtonQuotients));
    assert!(newton.success() > 0.0 && quotients.success() > 0.0);
    // Four unknowns: a quotient each makes a step cost up to five evaluations.
    assert!(newton.price().unwrap() < quotients.price().unwrap());
    assert!(quotients.price().unwrap() < record(Method::Simplex).price().unwrap_or(f64::INFINITY));
}
