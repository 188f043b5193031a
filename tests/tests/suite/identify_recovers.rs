//! A material is recovered from data made on a finer mesh than the model's, with noise and
//! unknown contact points; and what cannot be identified says why.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::path::PathBuf;

use lut_gen::solid::contact::Ball;
use lut_gen::solid::law::{Hyperfoam, Term};
use lut_gen::solid::model::{Indentation, Resolution, Specimen as Block};
use palpate::experiment::{Base, BaseLaw, Experiment, Indenter, Length, Recording, Run, Sensor, Specimen};
use palpate::identify::spec::FitSpec;
use palpate::identify::{self, Outcome, identify, json};

const MU_MPA: f64 = 0.188;
const ALPHA: f64 = 11.16;
const HEIGHT_MM: f64 = 19.05;

/// Fixed pseudo-random numbers, normal by the sum of twelve uniforms.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        (0..12)
            .map(|_| {
                self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                (self.0 >> 11) as f64 / (1_u64 << 53) as f64
            })
            .sum::<f64>()
            - 6.0
    }
}

/// Forces of a ball on a mesh 1.5 times as fine as the identification's.
fn fine(ball_mm: f64, depths: &[f64]) -> Vec<f64> {
    let problem = Indentation {
        law: Hyperfoam::new(vec![Term { mu_mpa: MU_MPA, alpha: ALPHA, nu: 0.0 }]).unwrap(),
        specimen: Block::of_height(HEIGHT_MM),
        ball: Ball { radius_mm: ball_mm },
        depth_mm: 3.5,
        resolution: Resolution::Fine,
    };
    problem.solve_at(depths).unwrap().force_n
}

fn experiment(balls: &[f64]) -> Experiment {
    Experiment {
        name: "made on a finer mesh".to_owned(),
        folder: PathBuf::new(),
        specimens: vec![Specimen {
            name: "foam".to_owned(),
            material: "foam".to_owned(),
            base_law: BaseLaw::Hyperfoam,
            terms: 1,
            height_mm: Length::Known(HEIGHT_MM),
            radius_mm: Length::Known(25.0),
            base: Base::Bonded,
        }],
        indenters: balls.iter().map(|mm| Indenter { name: format!("r{mm}"), radius_mm: Length::Known(*mm) }).collect(),
        sensor: Sensor::default(),
        runs: Vec::new(),
    }
}

/// A run at 1 mm/s and 50 Hz whose ball touches at `contact_mm`; noise is 1 % of the peak force.
fn run(indenter: usize, forces: &[f64], contact_mm: f64, noise: &mut Noise) -> Run {
    let before = (contact_mm / 0.02).round() as usize;
    let peak = forces.last().unwrap();
    let count = before + forces.len();
    let time: Vec<f64> = (0..count).map(|i| i as f64 * 0.02).collect();
    // Sample `before + k` lies at (k + 1) steps past contact, as the forces do.
    let depth = (0..count).map(|i| (i as f64 + 1.0 - before as f64) * 0.02 + contact_mm).collect();
    let force =
        (0..count).map(|i| if i < before { 0.0 } else { forces[i - before] } + 0.01 * peak * noise.next()).collect();
    Run::indentation(format!("run at {contact_mm} mm"), 0, indenter, Recording::from_samples(time, depth, force))
}

#[test]
fn mu_and_alpha_of_a_finer_mesh_lie_in_their_intervals() {
    let balls = [4.0, 6.0];
    let mut experiment = experiment(&balls);
    let mut noise = Noise(7);
    let depths: Vec<f64> = (1..=170).map(|i| f64::from(i) * 0.02).collect();
    let contacts = [[0.30, 0.12, 0.5], [0.22, 0.41, 0.08]];
    for (indenter, ball_mm) in balls.iter().enumerate() {
        let forces = fine(*ball_mm, &depths);
        for contact in contacts[indenter] {
            experiment.runs.push(run(indenter, &forces, contact, &mut noise));
        }
    }
    let found = identify(&experiment, &FitSpec::default(), &|_, _, _| {}).unwrap();
    let [one] = &found[..] else { panic!("one material, one answer") };
    assert_eq!(one.outcome, Outcome::Fitted, "{:?}", one.messages);
    let fit = one.fit.as_ref().unwrap();
    for (name, truth) in [("mu_MPa", MU_MPA), ("alpha", ALPHA)] {
        let parameter = fit.parameters.iter().find(|p| p.name == name).unwrap();
        let interval = parameter.interval95;
        println!("{name}: {} in [{}, {}], truth {truth}", parameter.value, interval.low, interval.high);
        assert!(interval.low < truth && truth < interval.high, "{name}: {parameter:?}");
        // An interval that held anything would prove nothing. With 1 % noise on 1000 samples and six
        // free contact points the linearised standard errors are 4 % (mu) and 6 % (alpha) from
        // noise and half of that from the model's 0.1 %: the width is 3.9 times their sum in squares.
        assert!((interval.high - interval.low) / truth < 0.35, "{name}: {parameter:?}");
    }
    // Replicates show the noise that was put in: 1 % of the peaks, pooled over both balls.
    let peak = |ball: usize| {
        let forces = &experiment.runs[3 * ball].recording.force_n;
        forces.iter().copied().fold(0.0, f64::max)
    };
    let put_in = 0.01 * ((peak(0).powi(2) + peak(1).powi(2)) / 2.0).sqrt();
    assert!((fit.noise.sigma_n / put_in - 1.0).abs() < 0.15, "{} {put_in}", fit.noise.sigma_n);
    for (run, contact) in fit.runs.iter().zip(contacts.iter().flatten()) {
        assert!((run.contact_mm - contact).abs() < 0.05, "{} {contact}", run.contact_mm);
    }
    assert!(one.direct_check.unwrap() < 0.005, "{:?}", one.direct_check);
    assert!(one.fe_solves > 10);
    let answer = json(&experiment, &found, None);
    assert_eq!(answer["outcome"], "fitted");
    assert!(answer["parameters"]["mu_MPa"]["interval95"][0].is_number());
    assert!(answer["starts"][0]["end"]["alpha"].is_number());
    assert!(answer["runs"][0]["contact_mm"].is_number());
}

#[test]
fn air_and_single_points_are_told_without_a_solve() {
    let mut noise = Noise(3);
    let mut air = experiment(&[4.0]);
    air.runs.push(run(0, &[0.0; 100], 0.2, &mut noise));
    for force in &mut air.runs[0].recording.force_n {
        *force = 0.002 * noise.next();
    }
    let found = identify(&air, &FitSpec::default(), &|_, _, _| panic!("nothing to solve")).unwrap();
    assert_eq!(found[0].outcome, Outcome::NoContact);
    assert_eq!(json(&air, &found, None)["outcome"], "no-contact");

    let mut short = experiment(&[4.0]);
    short.runs.push(run(0, &[0.1, 0.2, 0.3], 0.04, &mut noise));
    let found = identify(&short, &FitSpec::default(), &|_, _, _| panic!("nothing to solve")).unwrap();
    assert_eq!(found[0].outcome, Outcome::TooFewPoints);

    // Samples 0.8 mm apart down to 16 mm: five of them above the equator of the ball.
    let mut deep = experiment(&[4.0]);
    let depth: Vec<f64> = (0..20).map(|i| 0.8 * f64::from(i)).collect();
    let force = depth.iter().map(|d| 0.3 * d.powf(1.5)).collect();
    deep.specimens[0].height_mm = Length::Known(60.0);
    deep.runs.push(run(0, &[0.0], 0.0, &mut noise));
    deep.runs[0].recording = Recording::from_samples(depth.clone(), depth, force);
    let found = identify(&deep, &FitSpec::default(), &|_, _, _| panic!("nothing to solve")).unwrap();
    assert_eq!(found[0].outcome, Outcome::DeeperThanTable, "{:?}", found[0].messages);
    let said = found[0].messages.join("\n");
    assert!(said.contains("too few samples above the deepest point of the model"), "{said}");

    let nothing = experiment(&[4.0]);
    let found = identify::identify(&nothing, &FitSpec::default(), &|_, _, _| {}).unwrap();
    assert_eq!(json(&nothing, &found, None)["outcome"], "too-few-points");
}
