//! One law from several modes of deformation at once: what was put in lies in the intervals, and what the modes do not
//! show is said.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::path::PathBuf;

use lut_gen::solid::law::{Hyperfoam, Term};
use lut_gen::solid::verify::confined_stress_mpa;
use palpate::experiment::{Base, BaseLaw, Experiment, Indenter, Length, Recording, Run, Sensor, Specimen, Test};
use palpate::identify::newton::verdict::Standing;
use palpate::identify::spec::{Extra, FitSpec, FittedLaw, Loss, Method};
use palpate::identify::{Identification, Outcome, identify, json};
use palpate::report;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

const MU_MPA: f64 = 0.05;
const ALPHA: f64 = 8.0;
const NU: f64 = 0.2;
const HEIGHT_MM: f64 = 12.0;
const RADIUS_MM: f64 = 10.0;

/// Nominal stress (MPa) of a one-term Hyperfoam with free sides: the lateral stretch is `l^-nu` at any strain (thesis Eq. 1).
fn uniaxial_mpa(stretch: f64) -> f64 {
    2.0 * MU_MPA / ALPHA * (stretch.powf(ALPHA - 1.0) - stretch.powf(-NU * ALPHA - 1.0))
}

fn confined_mpa(stretch: f64) -> f64 {
    confined_stress_mpa(&Hyperfoam::new(vec![Term { mu_mpa: MU_MPA, alpha: ALPHA, nu: NU }]).unwrap(), stretch)
}

/// Force (N) of a test at a depth (mm).
fn force_n(test: Test, depth_mm: f64) -> f64 {
    let area = std::f64::consts::PI * RADIUS_MM * RADIUS_MM;
    let strain = depth_mm / HEIGHT_MM;
    match test {
        Test::Uniaxial => -area * uniaxial_mpa(1.0 - strain),
        Test::Confined => -area * confined_mpa(1.0 - strain),
        _ => area * uniaxial_mpa(1.0 + strain),
    }
}

/// A run at 1 mm/s to a depth past `contact_mm`; noise is 1 % of the peak.
fn run(test: Test, contact_mm: f64, depth_mm: f64, random: &mut Pcg64) -> Run {
    let peak = force_n(test, depth_mm);
    let time: Vec<f64> = (0..).map(|i| f64::from(i) * 0.02).take_while(|t| *t <= contact_mm + depth_mm).collect();
    let clean = |depth: f64| if depth > 0.0 { force_n(test, depth) } else { 0.0 };
    let force = time.iter().map(|t| {
        let noise: f64 = StandardNormal.sample(random);
        clean(t - contact_mm) + 0.01 * peak * noise
    });
    let force: Vec<f64> = force.collect();
    Run {
        indenter: None,
        test,
        ..Run::indentation(
            format!("{test:?} from {contact_mm} mm"),
            0,
            0,
            Recording::from_samples(time.clone(), time, force),
        )
    }
}

fn experiment(tests: &[(Test, f64)]) -> Experiment {
    let mut random = Pcg64::seed_from_u64(5);
    let pairs = tests.iter().flat_map(|&(test, depth)| [(test, depth, 0.3), (test, depth, 0.46)]);
    let runs = pairs.map(|(test, depth, contact)| run(test, contact, depth, &mut random)).collect();
    Experiment {
        name: "made in closed form".to_owned(),
        folder: PathBuf::new(),
        specimens: vec![Specimen {
            name: "foam".to_owned(),
            material: "foam".to_owned(),
            base_law: BaseLaw::Hyperfoam,
            terms: 1,
            height_mm: Length::Known(HEIGHT_MM),
            radius_mm: Length::Known(RADIUS_MM),
            base: Base::Bonded,
        }],
        indenters: vec![Indenter { name: "ball".to_owned(), radius_mm: Length::Known(4.0) }],
        sensor: Sensor::default(),
        runs,
    }
}

fn only(experiment: &Experiment, spec: &FitSpec) -> Identification {
    let mut found = identify(experiment, spec, &|_, _, _| {}).unwrap();
    assert_eq!(found.len(), 1);
    found.remove(0)
}

const MODES: [(Test, f64); 3] = [(Test::Uniaxial, 7.0), (Test::Confined, 7.0), (Test::Tension, 6.0)];

#[test]
fn three_modes_together_give_mu_alpha_and_nu() {
    let experiment = experiment(&MODES);
    let found = only(&experiment, &FitSpec::default());
    assert_eq!(found.outcome, Outcome::Fitted, "{:?}", found.messages);
    assert_eq!(found.fe_solves, 0, "nothing here needs finite elements");
    let fit = found.fit.as_ref().unwrap();
    for (name, truth) in [("mu_MPa", MU_MPA), ("alpha", ALPHA), ("nu", NU)] {
        let parameter = fit.parameters.iter().find(|p| p.name == name).expect("nu is free where modes show it");
        let interval = parameter.interval95;
        println!("{name}: {} [{}, {}], truth {truth}", parameter.value, interval.low, interval.high);
        assert!(interval.low < truth && truth < interval.high, "{name}: {parameter:?}");
        // 2,400 samples of 1 % noise: an interval of a tenth of the value would be ten times what they can tell.
        assert!((interval.high - interval.low) / truth < 0.1, "{name}: {parameter:?}");
        assert_eq!(parameter.verdict.as_ref().unwrap().standing, Standing::Identified, "{name}");
    }
    for (run, truth) in fit.runs.iter().zip([0.3, 0.46].repeat(3)) {
        // A sample is 0.02 mm of way.
        assert!((run.contact_mm - truth).abs() < 0.02, "{} {truth}", run.contact_mm);
    }
    // What is left over is the noise that was put in: 1 % of each mode's peak.
    let squares: Vec<f64> = MODES.iter().map(|&(test, depth)| (0.01 * force_n(test, depth)).powi(2)).collect();
    let lengths = [2.0 * 7.4, 2.0 * 7.4, 2.0 * 6.4];
    let put_in = squares.iter().zip(lengths).map(|(s, l)| s * l).sum::<f64>() / lengths.iter().sum::<f64>();
    // Loadings of more than 200 samples, here up to 374, are averaged by two.
    let put_in = (put_in / 2.0).sqrt();
    assert!((fit.rmse_n / put_in - 1.0).abs() < 0.05, "{} {put_in}", fit.rmse_n);
    let said = found.assumptions.join("\n");
    for part in ["one-term Hyperfoam (thesis Eq. 1)\n", "sides free", "fills its rigid ring", "pulled"] {
        assert!(said.contains(part), "{part}: {said}");
    }
    assert_eq!(json(&experiment, std::slice::from_ref(&found), None)["parameters"]["nu"]["standing"], "identified");
    let page = report::identification::page(&experiment, &[found]).html();
    for part in ["strain", "uniaxial compression", "confined compression", "tension"] {
        assert!(page.contains(part), "{part}");
    }
    assert!(!page.contains("NaN"));
}

/// One ramp between platens tells two exponents, `alpha` and `-nu alpha`; a ring alone tells no more than their sum of
/// effects. A stated ratio is not freed.
#[test]
fn nu_is_free_only_where_asked_or_shown() {
    let names = |tests: &[(Test, f64)], spec: &FitSpec| -> Vec<String> {
        let found = only(&experiment(tests), spec);
        found.fit.unwrap().parameters.iter().map(|p| p.name.clone()).collect()
    };
    assert_eq!(names(&MODES[..1], &FitSpec::default()), ["mu_MPa", "alpha"]);
    assert_eq!(names(&MODES[..1], &FitSpec { free: vec![Extra::Nu], ..FitSpec::default() }), ["mu_MPa", "alpha", "nu"]);
    assert_eq!(names(&MODES, &FitSpec { nu: NU, ..FitSpec::default() }), ["mu_MPa", "alpha"]);
}

#[test]
fn what_cannot_be_fitted_is_said() {
    let mut unmeasured = experiment(&MODES[..1]);
    unmeasured.specimens[0].height_mm = Length::Unknown;
    let found = only(&unmeasured, &FitSpec::default());
    assert_eq!(found.outcome, Outcome::TooFewPoints);
    let said = found.messages.join("\n");
    assert!(said.contains("the specimen's height and radius_mm (or area_mm2) must be known in this test"), "{said}");
}

/// The thesis' search serves coupons as well, and any number of parameters: here the three of a foam with a ratio.
#[test]
fn multistart_finds_one_law_for_all_modes() {
    let spec = FitSpec { method: Method::Simplex, free: vec![Extra::Nu], ..FitSpec::default() };
    let found = only(&experiment(&MODES), &spec);
    assert_eq!(found.outcome, Outcome::Fitted, "{:?}", found.messages);
    let fit = found.fit.as_ref().unwrap();
    for (name, truth) in [("mu_MPa", MU_MPA), ("alpha", ALPHA), ("nu", NU)] {
        let p = fit.parameters.iter().find(|p| p.name == name).unwrap();
        println!("{name}: {} {:?}", p.value, p.interval95);
        // Three standard errors: all three lie within but once in 120 times, were the intervals true.
        let error = (p.interval95.high - p.interval95.low) / 3.92;
        assert!((p.value - truth).abs() < 3.0 * error, "{name}: {p:?}");
    }
    let answer = json(&experiment(&MODES), &[found], None);
    assert_eq!((&answer["method"], &answer["converged"]), (&"simplex".into(), &true.into()));
    let start = &answer["starts"][0];
    assert!(start["nu"].is_number() && start["end"]["nu"].is_number() && start["objective"].is_number(), "{start}");
}

/// A ball's runs and those between platens share one law; neither disturbs the other.
#[test]
fn a_ball_and_platens_share_one_fit() {
    use lut_gen::solid::contact::{Ball, Interface};
    use lut_gen::solid::model::{Resolution, Simulation, Specimen as Block};
    use lut_gen::solid::solve::Motion;
    let mut both = experiment(&MODES[..1]);
    let law = Hyperfoam::new(vec![Term { mu_mpa: MU_MPA, alpha: ALPHA, nu: NU }]).unwrap();
    let press = Simulation {
        material: law.into(),
        specimen: Block { radius_mm: RADIUS_MM, ..Block::of_height(HEIGHT_MM) },
        ball: Ball { radius_mm: 4.0 },
        interface: Interface::default(),
        motion: Motion::ramp(3.0, 1.0),
        resolution: Resolution::Refined(1.5),
    };
    let depths: Vec<f64> = (1..=150).map(|i| 0.02 * f64::from(i)).collect();
    let forces = press.curve(&depths).unwrap().force_n;
    let mut random = Pcg64::seed_from_u64(8);
    let noisy = |f: &f64| {
        let noise: f64 = StandardNormal.sample(&mut random);
        f + 0.01 * forces[149] * noise
    };
    let noisy: Vec<f64> = forces.iter().map(noisy).collect();
    both.runs.push(Run {
        test: Test::Indentation,
        indenter: Some(0),
        recording: Recording::from_samples(depths.clone(), depths.clone(), noisy),
        ..both.runs[0].clone()
    });
    let spec = FitSpec { free: vec![Extra::Nu], law: Some(FittedLaw::Hyperfoam), ..FitSpec::default() };
    let found = only(&both, &spec);
    let fit = found.fit.as_ref().unwrap();
    assert!(found.fe_solves > 0 && fit.runs.len() == 3);
    for (name, truth) in [("mu_MPa", MU_MPA), ("alpha", ALPHA), ("nu", NU)] {
        let parameter = fit.parameters.iter().find(|p| p.name == name).unwrap();
        let interval = parameter.interval95;
        println!("{name}: {} [{}, {}], truth {truth}", parameter.value, interval.low, interval.high);
        assert!(interval.low < truth && truth < interval.high, "{name}: {parameter:?}");
    }
}

/// A second term or a free ratio may only lower what is left, whatever the loss; what the end says of itself is true of it.
#[test]
fn a_richer_law_ends_no_higher_and_a_spent_budget_is_told() {
    let experiment = experiment(&[(Test::Uniaxial, 7.0), (Test::Tension, 6.0)]);
    for loss in [Loss::Squares, Loss::Huber] {
        let spec = |terms| FitSpec { terms: Some(terms), loss, ..FitSpec::default() };
        let (one, two) = (only(&experiment, &spec(1)), only(&experiment, &spec(2)));
        let newton = two.fit.as_ref().unwrap().newton.as_ref().unwrap();
        let simple = one.fit.as_ref().unwrap().newton.as_ref().unwrap();
        // The same differences in the weights of the richer fit.
        let mut problem = simple.solved.on(&one.selection);
        problem.weights.clone_from(&newton.solved.weights);
        let (rich, simple) = (newton.minimum.at.value, problem.value(&simple.minimum.x));
        println!("{loss:?}: {simple} with one term, {rich} with two, {:?}", newton.came_back);
        assert!(rich <= simple * (1.0 + 1e-6), "{loss:?}: {rich} {simple}");
        assert!(newton.converged, "{:?}", two.messages);
    }
    let late = FitSpec { budget_s: Some(1e-9), ..FitSpec::default() };
    let found = only(&experiment, &late);
    let fit = found.fit.as_ref().unwrap();
    assert!(!fit.newton.as_ref().unwrap().converged && fit.rmse_n.is_finite());
    assert!(found.messages.iter().any(|m| m.contains("the budget ended the search")), "{:?}", found.messages);
}
