//! Random experiments: coupons of every law, with and without memory, and foams under two balls.

use std::f64::consts::PI;
use std::path::PathBuf;

use lut_gen::solid::homogeneous::{Coupon, Mode, Programme};
use lut_gen::solid::law::{Hyperfoam, Material, Ogden, OgdenTerm, PronyTerm, Term};
use lut_gen::solid::model::ForceModel;
use palpate::experiment::{Base, BaseLaw, Experiment, Length, Recording, Run, Sensor, Specimen, Test};
use palpate::identify::spec::{Extra, FitSpec, FittedLaw, Loss};
use rand::{Rng, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use tests::recovery::cases;
use tests::tissue::{LIVER, Pressed, Tissue, six};

use crate::{Case, Outcome};

const HEIGHT_MM: f64 = 12.0;
const RADIUS_MM: f64 = 10.0;
/// Samples of a loading, and of the hold after it.
const LOADING: usize = 120;
const HOLD: usize = 80;
const RATE_MM_S: f64 = 1.0;
const HOLD_S: f64 = 20.0;
/// Of a hundred experiments so many are foams under balls, and so many tissues pressed and held, which cost solves.
const FOAMS: usize = 30;
const TISSUES: usize = 2;

/// `count` experiments; those of every seed are its own.
pub fn draw(seed: u64, count: usize, models: &[ForceModel]) -> Outcome<Vec<Case>> {
    let (foams, tissues) = (count * FOAMS / 100, count * TISSUES / 100);
    let mut all = Vec::new();
    for (at, case) in cases(seed, foams).0.into_iter().enumerate() {
        let loss = [Loss::Huber, Loss::Squares, Loss::Absolute][at % 3];
        let name = format!("foam under two balls, mu {:.4}, alpha {:.1}", case.mu_mpa, case.alpha);
        let spec = FitSpec { loss, ..FitSpec::default() };
        all.push(Case { name, experiment: case.experiment, spec, models: models.to_vec(), hidden: true });
    }
    for at in 0..tissues {
        let mut random = Pcg64::seed_from_u64(seed.wrapping_add(5_000 + at as u64));
        let tissue = Tissue { alpha: random.random_range(4.0..20.0), g: random.random_range(0.1..0.6), ..LIVER };
        let experiment = Pressed { finer: 1.0, ..Pressed::default() }.record(&tissue, seed + at as u64)?;
        let name = format!("tissue, alpha {:.1}, g {:.2}", tissue.alpha, tissue.g);
        all.push(Case { name, experiment, spec: six(), models: Vec::new(), hidden: true });
    }
    for at in all.len()..count {
        all.push(coupons(seed.wrapping_add(10_000 + at as u64))?);
    }
    Ok(all)
}

/// A law, its relaxation, and what a fit of it asks for.
struct Drawn {
    material: Material,
    law: FittedLaw,
    terms: usize,
    relaxation: usize,
}

fn law(random: &mut Pcg64) -> Outcome<Drawn> {
    let mu_mpa = 0.001 * 100.0_f64.powf(random.random::<f64>());
    let terms = if random.random_bool(0.4) { 2 } else { 1 };
    let share = if terms == 2 { random.random_range(0.1..0.9) } else { 0.0 };
    let alpha = [random.random_range(1.5..16.0), random.random_range(1.5..16.0)];
    let parts: Vec<(f64, f64)> = [1.0 - share, share].into_iter().zip(alpha).take(terms).collect();
    let (law, elastic): (FittedLaw, Material) = if random.random_bool(0.6) {
        let nu = if random.random_bool(0.5) { 0.0 } else { random.random_range(0.05..0.4) };
        let terms = parts.iter().map(|(part, alpha)| Term { mu_mpa: mu_mpa * part, alpha: *alpha, nu }).collect();
        (FittedLaw::Hyperfoam, Hyperfoam::new(terms)?.into())
    } else {
        let d = 10.0_f64.powf(random.random_range(-2.5..0.0)) / mu_mpa;
        let term = |(at, (part, alpha)): (usize, &(f64, f64))| OgdenTerm {
            mu_mpa: mu_mpa * part,
            alpha: *alpha,
            d_per_mpa: if at == 0 { d } else { 0.0 },
        };
        (FittedLaw::Ogden, Ogden::new(parts.iter().enumerate().map(term).collect())?.into())
    };
    let relaxation = if random.random_bool(0.4) { random.random_range(1..=2) } else { 0 };
    let prony = (0..relaxation).map(|at| {
        let g = random.random_range(0.1..0.4);
        PronyTerm {
            g,
            k: random.random_range(0.0..0.4),
            tau_s: [0.6, 6.0][at] * 2.0_f64.powf(random.random_range(-1.0..1.0)),
        }
    });
    let prony = prony.collect();
    Ok(Drawn { material: elastic.relaxing(prony)?, law, terms, relaxation })
}

fn coupons(seed: u64) -> Outcome<Case> {
    let mut random = Pcg64::seed_from_u64(seed);
    let drawn = law(&mut random)?;
    let modes: &[Test] = match random.random_range(0..4) {
        0 => &[Test::Uniaxial],
        1 => &[Test::Uniaxial, Test::Confined],
        2 => &[Test::Uniaxial, Test::Tension],
        _ => &[Test::Uniaxial, Test::Confined, Test::Tension],
    };
    let noise = 0.002 * 10.0_f64.powf(random.random::<f64>());
    let runs: Outcome<Vec<Run>> = modes.iter().map(|&test| run(test, &drawn, noise, &mut random)).collect();
    let loss = [Loss::Huber, Loss::Huber, Loss::Squares, Loss::Absolute][random.random_range(0..4)];
    // One in four is fitted with another number of terms than it has.
    let terms = if random.random_bool(0.25) { 3 - drawn.terms } else { drawn.terms };
    let free = if drawn.law == FittedLaw::Hyperfoam && random.random_bool(0.5) { vec![Extra::Nu] } else { Vec::new() };
    let spec = FitSpec {
        law: Some(drawn.law),
        terms: Some(terms),
        relaxation: drawn.relaxation,
        free,
        loss,
        ..FitSpec::default()
    };
    let name = format!(
        "{} coupons, {} of {} terms, {} relaxing",
        modes.len(),
        drawn.law.word(),
        drawn.terms,
        drawn.relaxation
    );
    let experiment = Experiment {
        name: name.clone(),
        folder: PathBuf::new(),
        specimens: vec![Specimen {
            name: "piece".to_owned(),
            material: "piece".to_owned(),
            base_law: BaseLaw::Hyperfoam,
            terms: 1,
            height_mm: Length::Known(HEIGHT_MM),
            radius_mm: Length::Known(RADIUS_MM),
            base: Base::Bonded,
        }],
        indenters: Vec::new(),
        sensor: Sensor::default(),
        runs: runs?,
    };
    Ok(Case { name, experiment, spec, models: Vec::new(), hidden: true })
}

/// One recording: a loading at a steady rate, and a hold where the material relaxes.
fn run(test: Test, drawn: &Drawn, noise: f64, random: &mut Pcg64) -> Outcome<Run> {
    let (mode, sense) = match test {
        Test::Confined => (Mode::Confined, -1.0),
        Test::Tension => (Mode::Uniaxial, 1.0),
        _ => (Mode::Uniaxial, -1.0),
    };
    let depth_mm = HEIGHT_MM * random.random_range(0.3..0.55);
    let contact_mm = random.random_range(0.1..0.3);
    let ramp_s = (depth_mm + contact_mm) / RATE_MM_S;
    let mut time_s: Vec<f64> = (0..=LOADING).map(|i| ramp_s * i as f64 / LOADING as f64).collect();
    if drawn.relaxation > 0 {
        time_s.extend((1..=HOLD).map(|i| ramp_s + HOLD_S * i as f64 / HOLD as f64));
    }
    let depths: Vec<f64> = time_s.iter().map(|t| (t * RATE_MM_S).min(depth_mm + contact_mm)).collect();
    let area_mm2 = PI * RADIUS_MM * RADIUS_MM;
    let coupon = Coupon { material: drawn.material.clone(), mode, area_mm2 };
    let stretch = depths.iter().map(|d| 1.0 + sense * (d - contact_mm).max(0.0) / HEIGHT_MM).collect();
    let response = coupon.follow(&Programme { time_s: time_s.clone(), stretch }, &[])?;
    let clean: Vec<f64> = response.force_n(&coupon).iter().map(|f| sense * f).collect();
    let peak = clean.iter().copied().fold(0.0, f64::max);
    let force = clean.iter().map(|f| {
        let drawn: f64 = StandardNormal.sample(random);
        f + noise * peak * drawn
    });
    let force = force.collect();
    let recording = Recording::from_samples(time_s, depths, force);
    Ok(Run { indenter: None, test, ..Run::indentation(format!("{test:?}"), 0, 0, recording) })
}
