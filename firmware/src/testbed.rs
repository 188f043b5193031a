//! Surroundings for unit tests: a made-up family of foams, tables of it, and presses with noise.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::coil::winding::{LINKAGE_STEP_A, LINKAGES, Winding};
use crate::contact::Sample;
use protocol::lut::{AxisSpec, CoilSpec, DisplaySpec, MaterialSpec, Role, Scale, TableSpec, axis_name};

/// Force over mu, mm^2: Hertz for E = 2 mu and a 4 mm ball times a factor that imitates how Hyperfoams soften with alpha.
/// It is no physics; it has the shape that makes contact point, mu and alpha hard to tell apart.
pub fn shape_mm2(alpha: f64, height_mm: f64, depth_mm: f64) -> f64 {
    let d = depth_mm.max(0.0);
    let hertz = 4.0 / 3.0 * 2.0 * 4f64.sqrt() * d.powf(1.5);
    let softening = 0.5 + 0.45 / (1.0 + 1.3 * d) + 0.09 * alpha * d / (d + 0.45);
    hertz / softening * (1.0 + 0.5 * d / height_mm)
}

/// A foam of the made-up family.
#[derive(Debug, Clone, Copy)]
pub struct Foam {
    pub name: &'static str,
    pub mu_mpa: f64,
    pub alpha: f64,
    pub height_mm: f64,
}

const fn foam(name: &'static str, mu_mpa: f64, alpha: f64, height_mm: f64) -> Foam {
    Foam { name, mu_mpa, alpha, height_mm }
}

/// Parameters of the thesis' foams, and four dummies.
pub const LIBRARY: [Foam; 8] = [
    foam("EVA", 0.22, 10.53, 12.7),
    foam("B1", 0.188, 11.16, 19.05),
    foam("ICF", 0.0137, 14.8, 25.4),
    foam("A2", 0.05, 6.0, 19.05),
    foam("dummy 1", 0.004, 12.0, 25.4),
    foam("dummy 2", 0.025, 9.0, 19.05),
    foam("dummy 3", 0.11, 10.0, 19.05),
    foam("dummy 4", 0.3, 8.0, 12.7),
];

impl Foam {
    pub fn force_n(&self, depth_mm: f64) -> f64 {
        self.mu_mpa * shape_mm2(self.alpha, self.height_mm, depth_mm)
    }
}

pub const ROWS: usize = 200;

fn depths() -> Vec<f64> {
    (1..=ROWS).map(|i| 4.0 * i as f64 / ROWS as f64).collect()
}

/// The thesis' grid: 30 values of mu, evenly in the logarithm, and 30 of alpha.
pub fn mus() -> Vec<f64> {
    (0..30).map(|i| 0.0005 * 600f64.powf(f64::from(i) / 29.0)).collect()
}

pub fn alphas() -> Vec<f64> {
    (0..30).map(|i| 1.0 + 23.0 * f64::from(i) / 29.0).collect()
}

fn axis(name: &str, unit: &str, role: Role, values: Vec<f64>) -> AxisSpec {
    AxisSpec::new(name, unit, role, Scale::Listed, values)
}

/// Displacement at every 0.1 N to 5 N, and half an ampere a newton, which the magnet makes from 0.1 to 4 N; the dummies have
/// no control curve.
fn display(foam: &Foam) -> DisplaySpec {
    let displacement_mm: Vec<f64> = (1..=50).map(|i| 0.02 * f64::from(i) / foam.mu_mpa.sqrt()).collect();
    let even = DisplaySpec::even(0.1, &displacement_mm);
    let current_a = even.force_n.iter().map(|force_n| 0.5 * force_n).collect();
    let coil = CoilSpec { current_a, reachable_n: REACHABLE_N, bound_a: 0.02 };
    DisplaySpec { coil: (!foam.name.starts_with("dummy")).then_some(coil), ..even }
}

/// Forces between which the made-up magnet makes what is wanted, N.
pub const REACHABLE_N: (f64, f64) = (0.1, 4.0);

fn library(foams: &[Foam]) -> Vec<MaterialSpec> {
    foams
        .iter()
        .map(|foam| MaterialSpec {
            name: foam.name.into(),
            mu_mpa: foam.mu_mpa,
            alpha: foam.alpha,
            height_mm: foam.height_mm,
            acceptance: 0.03,
            rate_mm_s: 0.0,
            force_n: depths().iter().map(|d| foam.force_n(*d)).collect(),
            display: display(foam),
        })
        .collect()
}

fn spec(axes: Vec<AxisSpec>, columns: Vec<Vec<f64>>) -> TableSpec {
    TableSpec {
        axes,
        columns,
        library: library(&LIBRARY),
        discretisation: 0.001,
        interpolation: 0.001,
        provenance: "made up for tests".into(),
    }
}

/// 30-row form with three heights: mu is a factor.
pub fn factored_table() -> Vec<u8> {
    factored_spec().to_bytes().unwrap()
}

fn factored_spec() -> TableSpec {
    let heights = vec![12.7, 19.05, 25.4];
    let columns = heights
        .iter()
        .flat_map(|h| alphas().into_iter().map(move |a| depths().iter().map(|d| shape_mm2(a, *h, *d)).collect()))
        .collect();
    let axes = vec![
        axis(axis_name::DEPTH, "mm", Role::Row, depths()),
        axis(axis_name::HEIGHT, "mm", Role::Column, heights),
        axis(axis_name::ALPHA, "", Role::Column, alphas()),
        axis(axis_name::MU, "MPa", Role::Factor, mus()),
    ];
    spec(axes, columns)
}

/// The same with another library.
pub fn factored_table_with(foams: &[Foam]) -> Vec<u8> {
    TableSpec { library: library(foams), ..factored_spec() }.to_bytes().unwrap()
}

/// The first foams of the library, with their currents times these factors.
pub fn factored_table_scaled(scales: &[f64]) -> Vec<u8> {
    let mut materials = library(&LIBRARY[..scales.len()]);
    for (material, scale) in materials.iter_mut().zip(scales) {
        if let Some(coil) = &mut material.display.coil {
            coil.current_a.iter_mut().for_each(|a| *a = (*a * scale).min(2.5));
        }
    }
    TableSpec { library: materials, ..factored_spec() }.to_bytes().unwrap()
}

/// How much stiffer the made-up foams of [`rated_table`] are at 1, 2 and 4 mm/s.
pub const STIFFENING: [f64; 3] = [1.0, 1.1, 1.25];

/// 30-row form with three rates and three heights.
pub fn rated_table() -> Vec<u8> {
    let heights = [12.7, 19.05, 25.4];
    let curve = |by: f64, a: f64, h: f64| depths().iter().map(|d| by * shape_mm2(a, h, *d)).collect();
    let mut columns = vec![];
    for by in STIFFENING {
        for height in heights {
            columns.extend(alphas().into_iter().map(|alpha| curve(by, alpha, height)));
        }
    }
    let axes = vec![
        axis(axis_name::DEPTH, "mm", Role::Row, depths()),
        axis(axis_name::RATE, "mm/s", Role::Column, vec![1.0, 2.0, 4.0]),
        axis(axis_name::HEIGHT, "mm", Role::Column, heights.to_vec()),
        axis(axis_name::ALPHA, "", Role::Column, alphas()),
        axis(axis_name::MU, "MPa", Role::Factor, mus()),
    ];
    spec(axes, columns).to_bytes().unwrap()
}

/// 900-column form for one height, alpha slow and mu fast.
pub fn expanded_table(height_mm: f64) -> Vec<u8> {
    let columns = alphas()
        .into_iter()
        .flat_map(|a| {
            mus().into_iter().map(move |m| depths().iter().map(|d| m * shape_mm2(a, height_mm, *d)).collect())
        })
        .collect();
    let axes = vec![
        axis(axis_name::DEPTH, "mm", Role::Row, depths()),
        axis(axis_name::ALPHA, "", Role::Column, alphas()),
        axis(axis_name::MU, "MPa", Role::Column, mus()),
    ];
    spec(axes, columns).to_bytes().unwrap()
}

/// A source of chance with a seed (SplitMix64; Steele, Lea, Flood 2014).
pub struct Chance(pub u64);

impl Chance {
    /// Even in [0, 1).
    pub fn even(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Normal with deviation 1 (Box and Muller).
    pub fn normal(&mut self) -> f64 {
        let (u, v) = (1.0 - self.even(), self.even());
        (-2.0 * u.ln()).sqrt() * (core::f64::consts::TAU * v).cos()
    }
}

/// One press at a constant rate from `start_mm` above the surface to `depth_mm`, one sample every 20 ms.
pub struct Press {
    pub foam: Foam,
    pub rate_mm_s: f64,
    pub start_mm: f64,
    pub depth_mm: f64,
    /// Standard deviation of white noise, fraction of the force at 4 mm.
    pub noise: f64,
    /// Factor on the force.
    pub gain: f64,
    /// Shift of the surface, mm.
    pub shift_mm: f64,
    /// Reading of the load cell without force, N.
    pub zero_n: f64,
}

impl Press {
    pub fn clean(foam: Foam, rate_mm_s: f64) -> Self {
        Press { foam, rate_mm_s, start_mm: 3.0, depth_mm: 5.0, noise: 0.0, gain: 1.0, shift_mm: 0.0, zero_n: 0.01 }
    }

    /// The noise of issue A: 1 % white noise of the foam's own peak, 1 % gain jitter, 0.02 mm contact jitter.
    pub fn noisy(foam: Foam, rate_mm_s: f64, chance: &mut Chance) -> Self {
        Press {
            noise: 0.01,
            gain: 1.0 + 0.01 * chance.normal(),
            shift_mm: 0.02 * chance.normal(),
            start_mm: 3.0 + chance.even(),
            ..Press::clean(foam, rate_mm_s)
        }
    }

    /// Height of the surface, mm.
    pub fn surface_mm(&self) -> f64 {
        self.foam.height_mm + self.shift_mm
    }

    pub fn samples(&self, chance: &mut Chance) -> Vec<Sample> {
        let noise_n = self.noise * self.foam.force_n(4.0);
        let step_mm = self.rate_mm_s / 50.0;
        let count = ((self.start_mm + self.depth_mm) / step_mm).ceil() as usize + 1;
        (0..count)
            .map(|i| {
                let depth_mm = step_mm * i as f64 - self.start_mm;
                let force_n = self.zero_n + self.gain * self.foam.force_n(depth_mm) + noise_n * chance.normal();
                Sample { probe_mm: (self.surface_mm() - depth_mm) as f32, force_n: force_n as f32 }
            })
            .collect()
    }
}

/// A coil under its switch, in steps of 10 us: the linkage that the board is told times `flux`,
/// resistance with all that is beside the winding, supply, and the voltage of the diode while the
/// switch is off.
#[derive(Debug, Clone)]
pub struct SwitchedCoil {
    pub ohm: f32,
    pub supply_v: f32,
    pub diode_v: f32,
    pub flux: f32,
    pub linkage_wb: f32,
}

impl SwitchedCoil {
    pub fn new(ohm: f32, supply_v: f32) -> Self {
        SwitchedCoil { ohm, supply_v, diode_v: 0.0, flux: 1.0, linkage_wb: 0.0 }
    }

    pub fn current_a(&self) -> f32 {
        let told = Winding::RING.linkage_wb.map(|wb| self.flux * wb);
        let k = (1..LINKAGES - 1).find(|k| told[*k] > self.linkage_wb).unwrap_or(LINKAGES - 1);
        LINKAGE_STEP_A * ((k - 1) as f32 + (self.linkage_wb - told[k - 1]) / (told[k] - told[k - 1]))
    }

    /// A millisecond with a duty; the mean current, A, as the board reads it.
    pub fn step(&mut self, duty: f32) -> f32 {
        let volt = duty * self.supply_v - (1.0 - duty) * self.diode_v;
        let mut mean_a = 0.0;
        for _ in 0..100 {
            self.linkage_wb = (self.linkage_wb + 1e-5 * (volt - self.ohm * self.current_a())).max(0.0);
            mean_a += 0.01 * self.current_a();
        }
        mean_a
    }
}
