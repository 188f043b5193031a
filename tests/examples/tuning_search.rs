//! A long global search for the best gains that shares no code with `palpate tune`: differential evolution with Deb's rules for limits
//! (Comput. Methods Appl. Mech. Eng. 186, 2000, 311) over kp, ki, kd n and ln n, the loops of the thesis' plant written down again.
//!
//! `cargo run --release -p tests --example tuning_search -- [GENERATIONS] [SEEDS]`
#![allow(clippy::print_stdout)]

use nalgebra::{Matrix4, Vector4};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;

const U_MAX_V: f64 = 5.0;
const SHOOT_MM: f64 = 0.05;
const POPULATION: usize = 48;
const LOW: [f64; 4] = [0.0; 4];

/// Cost, overshoot, undershoot, largest command.
type Told = [f64; 4];

/// What a loop that runs away is told to be.
const LOST: Told = [100.0, 10.0, 10.0, 100.0];

/// Positions and commands one by one.
#[derive(Default)]
struct Seen {
    over: f64,
    under: f64,
    reached: bool,
    command: f64,
}

impl Seen {
    fn position(&mut self, y: f64) {
        self.reached |= y >= 1.0;
        self.over = self.over.max(y - 1.0);
        if self.reached {
            self.under = self.under.max(1.0 - y);
        }
    }
}

/// The continuous loop in exact steps of 0.5 ms, trapezoid with the zero crossing. The state is position less 1, speed, integral less
/// 1, filter.
fn continuous([kp, ki, kd, n]: [f64; 4]) -> Told {
    let (c, dt) = (kd * n, 5e-4);
    let k = kp + c;
    #[rustfmt::skip]
    let a = Matrix4::new(
        0.0, 1.0, 0.0, 0.0,
        -86.0 * k - 86.0, -23.4, 86.0, -86.0 * c,
        -ki, 0.0, 0.0, 0.0,
        -n, 0.0, 0.0, -n,
    );
    let (phi, mut x) = ((a * dt).exp(), Vector4::new(-1.0, 0.0, -1.0, 0.0));
    let (mut cost, mut seen, mut error) = (0.0, Seen { command: k, ..Seen::default() }, 1.0f64);
    for _ in 0..200_000 {
        x = phi * x;
        let next: f64 = -x[0];
        let crossed = error * next < 0.0;
        let triangles = (error * error + next * next) / (error - next).abs();
        cost += 0.5 * dt * if crossed { triangles } else { (error + next).abs() };
        error = next;
        seen.position(1.0 - error);
        seen.command = seen.command.max((k * error + x[2] + 1.0 - c * x[3]).abs());
        if error.is_nan() || error.abs() > 50.0 {
            return LOST;
        }
        if x.norm() < 1e-8 {
            break;
        }
    }
    [cost, seen.over, seen.under, seen.command]
}

/// The loop at 50 Hz with or without a tick of delay; the plant as the sum of its two modes, looked at ten times a tick.
fn sampled([kp, ki, kd, n]: [f64; 4], late: bool) -> Told {
    let t = 0.02;
    let root = (11.7f64 * 11.7 - 86.0).sqrt();
    let modes = [(-11.7 + root, 43.0 / root), (-11.7 - root, -43.0 / root)];
    let decays = modes.map(|(pole, _): (f64, f64)| (pole * t / 10.0).exp());
    let (mut x, mut integral, mut lead, mut before, mut held) = ([0.0f64; 2], 0.0, 0.0, 0.0, 0.0);
    let (mut cost, mut seen, mut still) = (0.0, Seen::default(), 0);
    for _ in 0..=5000 {
        let error = 1.0 - x[0] - x[1];
        if error.is_nan() || error.abs() > 50.0 {
            return LOST;
        }
        integral += ki * t * error;
        lead = (lead + kd * n * (error - before)) / (1.0 + n * t);
        before = error;
        let command: f64 = kp * error + integral + lead;
        seen.command = seen.command.max(command.abs());
        cost += t * error.abs();
        still = if error.abs() < 1e-9 { still + 1 } else { 0 };
        if still > 30 {
            break;
        }
        let acts = if late { held } else { command };
        held = command;
        for _ in 0..10 {
            for (x, ((pole, residue), decay)) in x.iter_mut().zip(modes.iter().zip(decays)) {
                *x = decay * *x + residue / pole * (decay - 1.0) * acts;
            }
            seen.position(x[0] + x[1]);
        }
    }
    [cost, seen.over, seen.under, seen.command]
}

fn gains(x: &[f64; 4]) -> [f64; 4] {
    let n = x[3].exp();
    [x[0], x[1], x[2] / n, n]
}

fn broken(told: &Told) -> f64 {
    (told[1] - SHOOT_MM).max(0.0) + (told[2] - SHOOT_MM).max(0.0) + (told[3] / U_MAX_V - 1.0).max(0.0)
}

fn better(a: &Told, b: &Told) -> bool {
    match (broken(a), broken(b)) {
        (0.0, 0.0) => a[0] < b[0],
        (own, other) => own < other,
    }
}

fn evolution(of: &dyn Fn([f64; 4]) -> Told, generations: usize, seed: u64) -> ([f64; 4], Told) {
    let high = [6.0, 100.0, 6.0, 1e4f64.ln()];
    let mut chance = Pcg64::seed_from_u64(seed);
    let first = (0..POPULATION).map(|_| {
        let x: [f64; 4] = std::array::from_fn(|k| chance.random_range(LOW[k]..high[k]));
        (x, of(gains(&x)))
    });
    let mut all: Vec<([f64; 4], Told)> = first.collect();
    for _ in 0..generations {
        for i in 0..POPULATION {
            let best = (0..POPULATION).fold(0, |best, j| if better(&all[j].1, &all[best].1) { j } else { best });
            let [a, b, c]: [usize; 3] = std::array::from_fn(|_| chance.random_range(0..POPULATION));
            let base = if chance.random_bool(0.3) { best } else { a };
            let (factor, sure) = (chance.random_range(0.4..0.95), chance.random_range(0..4));
            let mut x = all[i].0;
            for k in 0..4 {
                if k == sure || chance.random_bool(0.9) {
                    let moved: f64 = all[base].0[k] + factor * (all[b].0[k] - all[c].0[k]);
                    let inside = moved.clamp(LOW[k], high[k]);
                    x[k] = if moved == inside { moved } else { 0.5 * (all[i].0[k] + inside) };
                }
            }
            let told = of(gains(&x));
            if !better(&all[i].1, &told) {
                all[i] = (x, told);
            }
        }
    }
    all.into_iter().reduce(|a, b| if better(&b.1, &a.1) { b } else { a }).unwrap_or(([0.0; 4], LOST))
}

/// A loop by its name.
type Named<'a> = (&'a str, &'a dyn Fn([f64; 4]) -> Told);

fn main() {
    let argument = |i: usize, usual: usize| std::env::args().nth(i).and_then(|t| t.parse().ok()).unwrap_or(usual);
    let (generations, seeds) = (argument(1, 300), argument(2, 3));
    let loops: [Named<'_>; 3] =
        [("continuous", &continuous), ("sampled", &|g| sampled(g, false)), ("delayed", &|g| sampled(g, true))];
    for (name, of) in loops {
        for seed in 0..seeds {
            let (x, told) = evolution(of, generations, seed as u64);
            println!(
                "{name}, seed {seed}: kp, ki, kd, n {:?}; cost, overshoot, undershoot, command {told:?}",
                gains(&x)
            );
        }
    }
}
