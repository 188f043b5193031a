//! A finger that a machine presses: on a rigid cap, or into the fluid above a coil.

use std::f64::consts::TAU;

use crate::magnet::circuit::Circuit;
use crate::plant::{Coil, Core, Dented, Fluid, Pulp, PulpLaw};

use super::run::{Chance, Columns, STEPS, rounded};
use super::{DisplayEffect, DisplayRun, DisplaySpec, TICK_S};

/// What of a finger and of a fluid is otherwise than it is taken for.
struct Flaws {
    softness: f64,
    relaxing: (f64, f64),
    ridges: (f64, f64),
    most_kpa: f64,
    rest_kpa: f64,
    kpa_s_per_mm: f64,
    response_s: f64,
    cup: f64,
}

impl Flaws {
    fn of(spec: &DisplaySpec) -> Self {
        let mut out = Self {
            softness: 1.0,
            relaxing: (0.0, 1.0),
            ridges: (0.0, 1.0),
            most_kpa: f64::INFINITY,
            rest_kpa: 0.0,
            kpa_s_per_mm: 0.0,
            response_s: 0.0,
            cup: 0.0,
        };
        for effect in &spec.effects {
            match *effect {
                DisplayEffect::PulpSize { ratio } => out.softness = ratio,
                DisplayEffect::PulpRelaxation { part, tau_s } => out.relaxing = (part, tau_s),
                DisplayEffect::YieldLaw { most_kpa } => out.most_kpa = most_kpa,
                DisplayEffect::FluidRest { kpa } => out.rest_kpa = kpa,
                DisplayEffect::FluidViscosity { kpa_s_per_mm } => out.kpa_s_per_mm = kpa_s_per_mm,
                DisplayEffect::FluidResponse { seconds } => out.response_s = seconds,
                DisplayEffect::OutsideRidges { part, pitch_mm } => out.ridges = (part, pitch_mm),
                DisplayEffect::OutsideCup { part } => out.cup = part,
                _ => {}
            }
        }
        out
    }

    fn pulp(&self) -> Pulp {
        Pulp::new(PulpLaw::round(self.softness, self.relaxing))
    }
}

/// Where a run's finger touches, and what its readings add.
struct Read {
    chance: Chance,
    touch_mm: f64,
    noise: (f64, f64),
}

/// Travel at which a cup is felt as told, mm.
const CUP_MM: f64 = 3.0;
/// Scatter of the place where a finger that is laid on anew touches, mm.
const TOUCH_MM: f64 = 0.01;

impl Read {
    fn new(spec: &DisplaySpec, mut chance: Chance) -> Self {
        let touch_mm = if spec.noise.gain_jitter > 0.0 { TOUCH_MM * chance.normal() } else { 0.0 };
        Self { chance, touch_mm, noise: (spec.noise.finger_mm, spec.noise.finger_n) }
    }

    fn place_mm(&mut self, mm: f64) -> f64 {
        rounded(mm + self.noise.0 * self.chance.normal(), 1e-4)
    }

    fn force_n(&mut self, force_n: f64) -> f64 {
        rounded(self.chance.gain * force_n + self.noise.1 * (self.chance.noise.next() + self.chance.zero), 1e-4)
    }
}

/// A finger on a cap that stands.
pub(super) fn pulp(spec: &DisplaySpec, run: &DisplayRun, time_s: &[f64], chance: Chance) -> Columns {
    let flaws = Flaws::of(spec);
    let (mut pulp, mut read) = (flaws.pulp(), Read::new(spec, chance));
    let (mut finger_mm, mut force_n) = (Vec::new(), Vec::new());
    let dt_s = TICK_S / STEPS as f64;
    for t in time_s {
        let mm = run.at(*t) - read.touch_mm;
        let ridges = 1.0 + flaws.ridges.0 * (TAU * mm / flaws.ridges.1).sin();
        force_n.push(read.force_n(ridges * pulp.force_n(mm)));
        finger_mm.push(read.place_mm(run.at(*t)));
        for i in 0..STEPS {
            pulp.step(run.at(t + (i as f64 + 0.5) * dt_s) - read.touch_mm, dt_s);
        }
    }
    vec![("finger_mm", finger_mm), ("position_mm", vec![0.0; time_s.len()]), ("reference_N", force_n)]
}

/// A finger in the fluid, under the current of its program.
pub(super) fn fluid(spec: &DisplaySpec, run: &DisplayRun, time_s: &[f64], chance: Chance) -> Columns {
    let flaws = Flaws::of(spec);
    let (mut pulp, mut read) = (flaws.pulp(), Read::new(spec, chance));
    let Ok(force) = crate::feel::fluid_force() else { return Vec::new() };
    let mut dented = Dented::new(force.of_a_finger(flaws.softness));
    let circuit = Circuit::ring();
    let cold_ohm = circuit.winding.ohm(circuit.winding.room_c);
    let (mut coil, mut fluid) = (Coil::new(circuit), Fluid::with(Core::default()));
    let (mut finger_mm, mut force_n, mut flux_t) = (Vec::new(), Vec::new(), Vec::new());
    let (mut yield_kpa, mut before_mm) = (0.0, run.at(0.0));
    let dt_s = TICK_S / STEPS as f64;
    for t in time_s {
        // the step of this tick has been made when it is read
        for i in 1..=STEPS {
            let now_s = t - TICK_S + i as f64 * dt_s;
            let mm = run.at(now_s.max(0.0)) - read.touch_mm;
            coil.step(run.current_at(now_s.max(0.0)) * cold_ohm, dt_s);
            fluid.step(coil.current_a(), dt_s);
            let kpa = fluid.yield_kpa();
            let kpa = if flaws.most_kpa.is_finite() { flaws.most_kpa * (kpa / flaws.most_kpa).tanh() } else { kpa };
            yield_kpa += (kpa - yield_kpa) * (1.0 - (-dt_s / flaws.response_s.max(1e-6)).exp());
            let down_mm_s = ((mm - before_mm) / dt_s).clamp(0.0, 100.0);
            before_mm = mm;
            let cup = 1.0 + flaws.cup * (mm / CUP_MM).powi(3);
            let bears_kpa = cup * yield_kpa + flaws.rest_kpa + flaws.kpa_s_per_mm * down_mm_s;
            let place_mm = dented.under(mm, bears_kpa, &pulp);
            if i == STEPS {
                force_n.push(read.force_n(pulp.force_n(mm - place_mm)));
            }
            pulp.step(mm - place_mm, dt_s);
        }
        finger_mm.push(read.place_mm(run.at(*t)));
        flux_t.push(rounded(fluid.flux_t() + spec.noise.flux_t * read.chance.normal(), 1e-5));
    }
    vec![("finger_mm", finger_mm), ("flux_T", flux_t), ("reference_N", force_n)]
}
