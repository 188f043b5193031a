//! One run: commands into the plant, readings out of its sensors.

use std::f64::consts::TAU;

use firmware::sensor::{DEFAULT_CALIBRATION, fsr_n, shaft_mm};
use rand::Rng;
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;

use crate::experiment::{GAP_MM, Recording};
use crate::magnet::circuit::Circuit;
use crate::plant::{Actuator, ActuatorFlaws, ActuatorLaw, Coil, Converter, Core, Fluid, Fsr, FsrFlaws, Potentiometer};
use crate::simulate::chance::{Purpose, stream};
use crate::simulate::noise::Correlated;

use super::{DisplayEffect, DisplayRun, DisplaySpec, Subject, TICK_S, finger};

/// Steps of the surroundings a tick; finer than the bench's.
pub(super) const STEPS: usize = 80;
/// Shunt amplifier of the coil: reading without current, and A for the full reference.
const SHUNT: (f64, f64) = (0.05, 3.3);
/// Rounding of the gauss meter, T: one gauss.
const GAUSS_T: f64 = 1e-4;
/// Noise of the reference that weighs the load, N.
const REFERENCE_N: f64 = 0.002;

/// Chance of one run.
pub(super) struct Chance {
    pub noise: Correlated,
    own: Pcg64,
    pub gain: f64,
    pub zero: f64,
}

impl Chance {
    fn new(spec: &DisplaySpec, number: u64, gain_jitter: f64) -> Self {
        let noise = crate::simulate::Noise {
            correlation_s: spec.noise.correlation_s,
            heavy_tails: spec.noise.heavy_tails,
            ..Default::default()
        };
        let mut own = stream(spec.seed, Purpose::Spot, number);
        let mut normal = || own.sample::<f64, _>(StandardNormal);
        let (gain, zero) = (1.0 + gain_jitter * normal(), normal());
        Self { noise: Correlated::new(&noise, stream(spec.seed, Purpose::Sensor, number), TICK_S), own, gain, zero }
    }

    pub(super) fn normal(&mut self) -> f64 {
        self.own.sample(StandardNormal)
    }
}

/// The recording of the run with a number.
pub(super) fn recorded(spec: &DisplaySpec, run: &DisplayRun, number: u64) -> Recording {
    let ticks = (run.length_s() / TICK_S).round() as usize + 1;
    let time_s: Vec<f64> = (0..ticks).map(|k| rounded(k as f64 * TICK_S, 1e-6)).collect();
    let converter = Converter::new(spec.seed.wrapping_add((number + 1) << 32));
    let mut recording = Recording::default();
    recording.line = (2..ticks + 2).collect();
    let columns = match run.subject {
        Subject::Position => {
            position(spec, run, &time_s, (converter, Chance::new(spec, number, 0.1 * spec.noise.gain_jitter)))
        }
        Subject::Force => force(spec, run, &time_s, (converter, Chance::new(spec, number, spec.noise.gain_jitter))),
        Subject::Coil => coil(spec, run, &time_s, (converter, Chance::new(spec, number, 0.1 * spec.noise.gain_jitter))),
        Subject::Pulp => finger::pulp(spec, run, &time_s, Chance::new(spec, number, spec.noise.gain_jitter)),
        Subject::Fluid => finger::fluid(spec, run, &time_s, Chance::new(spec, number, spec.noise.gain_jitter)),
    };
    for (name, values) in columns {
        if name == "force_N" {
            recording.force_n = values;
        } else {
            recording.others.insert(name.to_owned(), values);
        }
    }
    recording.time_s = time_s;
    recording
}

pub(super) type Columns = Vec<(&'static str, Vec<f64>)>;

fn position(
    spec: &DisplaySpec,
    run: &DisplayRun,
    time_s: &[f64],
    (mut converter, mut chance): (Converter, Chance),
) -> Columns {
    let mut flaws = ActuatorFlaws::NONE;
    let (mut delay_s, mut play_mm, mut ripple, mut wobble) = (0.0, 0.0, (0.0, 1.0), (0.0, 1.0));
    for effect in &spec.effects {
        match *effect {
            DisplayEffect::Delay { seconds } => delay_s = seconds,
            DisplayEffect::RateLimit { mm_per_s } => flaws.rate_mm_s = mm_per_s,
            DisplayEffect::Stiction { mm } => flaws.friction_v = mm,
            DisplayEffect::Backlash { mm } => play_mm = mm,
            DisplayEffect::OutsideRipple { mm, pitch_mm } => ripple = (mm, pitch_mm),
            DisplayEffect::OutsideWobble { share, hz } => wobble = (share, hz),
            _ => {}
        }
    }
    let law = DEFAULT_CALIBRATION.potentiometer;
    let potentiometer = Potentiometer { slope_kohm_mm: -0.080_279, offset_kohm: 2.5829, divider_kohm: 1.6 };
    let start_mm = run.at(0.0);
    let mut actuator = Actuator::with(start_mm, ActuatorLaw::THESIS, flaws);
    let (mut felt_mm, mut mode) = (start_mm, (0.0, 0.0));
    let command: Vec<f64> = time_s.iter().map(|t| rounded(run.at(*t), 1e-6)).collect();
    let mut measured = Vec::with_capacity(command.len());
    for (k, t) in time_s.iter().enumerate() {
        let along_mm = felt_mm + mode.0 + ripple.0 * (TAU * felt_mm / ripple.1).sin();
        let read_mm = f64::from(shaft_mm(converter.ratio(potentiometer.ratio(along_mm)), &law));
        measured
            .push(rounded(chance.gain * read_mm + spec.noise.position_mm * (chance.noise.next() + chance.zero), 1e-4));
        if k + 1 == time_s.len() {
            break;
        }
        for i in 0..STEPS {
            let dt_s = TICK_S / STEPS as f64;
            // the drive holds what was commanded at the tick before its own, delayed time
            let late = ((t + (i as f64 + 0.5) * dt_s - delay_s) / TICK_S).floor().max(0.0) as usize;
            actuator.step(command[late.min(k)] - start_mm, 0.0, dt_s);
            let half_mm = 0.5 * play_mm;
            felt_mm = felt_mm.clamp(actuator.position_mm() - half_mm, actuator.position_mm() + half_mm);
            // a light mass on a spring, driven by the shaft's motion
            let w = TAU * wobble.1;
            let pull = wobble.0 * w * actuator.rate_mm_s();
            mode.1 += dt_s * (-w * w * mode.0 - 0.2 * w * mode.1 + w * pull);
            mode.0 += dt_s * mode.1;
        }
    }
    vec![("command_mm", command), ("position_mm", measured)]
}

fn force(
    spec: &DisplaySpec,
    run: &DisplayRun,
    time_s: &[f64],
    (mut converter, mut chance): (Converter, Chance),
) -> Columns {
    let mut flaws = FsrFlaws { noise: 0.0, ..FsrFlaws::NONE };
    let (mut memory, mut viscous_s) = ((0.0, 1.0), 0.0);
    for effect in &spec.effects {
        match *effect {
            DisplayEffect::Creep { per_decade } => flaws.creep = per_decade,
            DisplayEffect::Memory { amplitude, tau_s } => memory = (amplitude, tau_s),
            DisplayEffect::Hysteresis { half_width } => flaws.hysteresis = half_width,
            DisplayEffect::Nonlinearity { power } => flaws.power = power,
            DisplayEffect::OutsideViscous { seconds } => viscous_s = seconds,
            _ => {}
        }
    }
    let law = DEFAULT_CALIBRATION.fsr;
    let mut fsr = Fsr::new(0.079, -0.016, 10.0, spec.seed).with(flaws);
    let (mut late_n, mut reference, mut measured) = (run.at(0.0), Vec::new(), Vec::new());
    for (k, t) in time_s.iter().enumerate() {
        // the step of this tick has been made: a load that jumps is read after it
        let dt_s = TICK_S / STEPS as f64;
        for i in 1..=STEPS {
            let now_s = t - TICK_S + i as f64 * dt_s;
            let load_n = if k == 0 { run.at(0.0) } else { run.at(now_s) };
            let rate_n_s = if k == 0 { 0.0 } else { (load_n - run.at(now_s - dt_s)) / dt_s };
            // a step has no rate
            let rate_n_s = if rate_n_s.abs() > 100.0 { 0.0 } else { rate_n_s };
            late_n += dt_s / memory.1 * (load_n - late_n);
            if k > 0 || i == STEPS {
                fsr.step(load_n + memory.0 * late_n + viscous_s * rate_n_s, dt_s);
            }
        }
        let read_n = f64::from(fsr_n(converter.ratio(fsr.ratio()), &law));
        let noise = 1.0 + spec.noise.force_share * chance.noise.next();
        measured.push(rounded(chance.gain * noise * read_n, 1e-4));
        reference.push(rounded(run.at(*t) + REFERENCE_N * chance.normal(), 1e-4));
    }
    vec![("reference_N", reference), ("force_N", measured)]
}

fn coil(
    spec: &DisplaySpec,
    run: &DisplayRun,
    time_s: &[f64],
    (mut converter, mut chance): (Converter, Chance),
) -> Columns {
    let (mut core, mut heat, mut clip_a, mut eddy_s) = (Core::default(), f64::INFINITY, f64::INFINITY, 0.0);
    let mut offset_mm = 0.0;
    for effect in &spec.effects {
        match *effect {
            DisplayEffect::Heating { j_per_k } => heat = j_per_k,
            DisplayEffect::Saturation { tesla } => core.saturation_t = tesla,
            DisplayEffect::Remanence { tesla, ampere } => (core.remanence_t, core.coercive_a) = (tesla, ampere),
            DisplayEffect::Gap { mm } => offset_mm = mm,
            DisplayEffect::OutsideClip { ampere } => clip_a = ampere,
            DisplayEffect::OutsideEddy { seconds } => eddy_s = seconds,
            _ => {}
        }
    }
    let nominal_mm = 1.0;
    core.gap_mm = (nominal_mm, run.gap_mm + offset_mm);
    let circuit = Circuit::ring();
    // the drive takes a command for what the cold winding would have
    let cold_ohm = circuit.winding.ohm(circuit.winding.room_c);
    let (mut coil, mut fluid, mut late_t) = (Coil::new(circuit).with_heat(heat), Fluid::with(core), 0.0);
    let flux_noise = stream(spec.seed, Purpose::Phase, (1 + run.values.len()) as u64 + chance.zero.to_bits() % 1000);
    let plain = crate::simulate::Noise { correlation_s: spec.noise.correlation_s, ..Default::default() };
    let mut flux_noise = Correlated::new(&plain, flux_noise, TICK_S);
    let probe = 1.0 + 0.1 * spec.noise.gain_jitter * chance.normal();
    let command: Vec<f64> = time_s.iter().map(|t| rounded(run.at(*t), 1e-6)).collect();
    let (mut current, mut flux) = (Vec::new(), Vec::new());
    let dt_s = TICK_S / STEPS as f64;
    for told in &command {
        // the logged command has acted for a tick when current and flux are read
        for _ in 0..STEPS {
            let before_a = coil.current_a();
            coil.step(told.min(clip_a) * cold_ohm, dt_s);
            fluid.step(0.5 * (before_a + coil.current_a()), dt_s);
            late_t = if eddy_s > 0.0 { late_t + dt_s / eddy_s * (fluid.flux_t() - late_t) } else { fluid.flux_t() };
        }
        let ratio = f64::from(converter.ratio(SHUNT.0 + coil.current_a() / SHUNT.1));
        let read_a = (ratio - SHUNT.0) * SHUNT.1;
        current.push(rounded(chance.gain * read_a + spec.noise.current_a * (chance.noise.next() + chance.zero), 1e-5));
        flux.push(rounded(probe * late_t + spec.noise.flux_t * (flux_noise.next() + chance.zero), GAUSS_T / 10.0));
    }
    let gap_mm = vec![run.gap_mm; command.len()];
    vec![("command_A", command), ("current_A", current), ("flux_T", flux), (GAP_MM, gap_mm)]
}

pub(super) fn rounded(value: f64, unit: f64) -> f64 {
    // dividing by a whole number gives the shortest decimal
    let inverse = (1.0 / unit).round();
    (value * inverse).round() / inverse
}
