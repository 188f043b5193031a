//! Signals of a linear loop between samples: one state for all of them, propagated exactly.
//!
//! All signals of a loop share its characteristic polynomial `chi`. The state is the impulse response of `1/chi` and its
//! derivatives; a signal is a row of numbers on it. Time is counted in units of the roots' mean size, so that rows and
//! matrices hold numbers of like size.

use nalgebra::{Complex, DMatrix};

use crate::actuator::polynomial::Polynomial;

/// A step turns the fastest living mode by this angle at most: a cubic between samples then errs by 3e-7 of the mode.
const TURN: f64 = 0.1;
/// A mode is taken as gone after it has fallen by `exp(-GONE)`, and the response as over after [`OVER`].
const GONE: f64 = 18.0;
/// As [`GONE`].
const OVER: f64 = 24.0;
/// Squarings at most, of the first step.
const LEVELS: usize = 40;

/// A signal: constant part and row on the state.
#[derive(Debug, Clone)]
pub(super) struct Signal {
    /// What it tends to.
    pub rest: f64,
    /// Numbers on the state.
    pub row: Vec<f64>,
}

impl Signal {
    /// Its value at a state.
    pub fn at(&self, state: &[f64]) -> f64 {
        self.rest + self.row.iter().zip(state).map(|(a, b)| a * b).sum::<f64>()
    }
}

/// The loop's modes.
#[derive(Debug, Clone)]
pub(super) struct Modal {
    /// Monic characteristic polynomial in scaled time.
    chi: Polynomial,
    /// 1/s a unit of scaled time.
    rate: f64,
    roots: Vec<Complex<f64>>,
}

impl Modal {
    /// Of a characteristic polynomial in `s`; none if its roots cannot be found.
    pub fn new(chi: &Polynomial) -> Option<Self> {
        let size = (chi.at(0) / chi.leading()).abs().powf(1.0 / chi.degree().max(1) as f64);
        let rate = if size.is_finite() && size > 0.0 { size } else { 1.0 };
        let chi = chi.stretched(rate);
        let chi = chi.scaled(1.0 / chi.leading());
        let roots = chi.roots()?;
        Some(Self { chi, rate, roots })
    }

    /// The modes of the squared characteristic polynomial.
    pub fn squared(&self) -> Self {
        let roots = self.roots.iter().chain(&self.roots).copied().collect();
        Self { chi: &self.chi * &self.chi, rate: self.rate, roots }
    }

    /// Largest real part of a root, 1/s.
    pub fn growth(&self) -> f64 {
        self.roots.iter().map(|root| root.re * self.rate).fold(f64::NEG_INFINITY, f64::max)
    }

    /// True if every mode dies away.
    pub fn is_stable(&self) -> bool {
        self.growth() < 0.0
    }

    /// Order of the loop.
    pub fn order(&self) -> usize {
        self.chi.degree()
    }

    /// The response of `numerator / chi` to a unit step; `lead` is the leading coefficient that `chi` was given with.
    pub fn step_of(&self, numerator: &Polynomial, lead: f64) -> Signal {
        let scale = 1.0 / (lead * self.rate.powi(self.order() as i32));
        let own = numerator.stretched(self.rate).scaled(scale);
        let rest = own.at(0) / self.chi.at(0);
        let left = &own + &self.chi.scaled(-rest);
        self.signal(rest, &left.lowered())
    }

    /// The response of `numerator / chi` to a unit impulse, in 1/s.
    pub fn impulse_of(&self, numerator: &Polynomial, lead: f64) -> Signal {
        let scale = self.rate / (lead * self.rate.powi(self.order() as i32));
        self.signal(0.0, &numerator.stretched(self.rate).scaled(scale))
    }

    fn signal(&self, rest: f64, numerator: &Polynomial) -> Signal {
        Signal { rest, row: (0..self.order()).map(|i| numerator.at(i)).collect() }
    }

    /// The time derivative of a signal, 1/s.
    pub fn slope(&self, of: &Signal) -> Signal {
        let n = self.order();
        let last = of.row[n - 1];
        let row = (0..n).map(|i| {
            let shifted = if i == 0 { 0.0 } else { of.row[i - 1] };
            self.rate * (shifted - last * self.chi.at(i))
        });
        Signal { rest: 0.0, row: row.collect() }
    }

    /// A signal whose increase over a time is the integral of the transient part of `of`.
    pub fn integral(&self, of: &Signal) -> Signal {
        let own = Polynomial::new(of.row.clone());
        let rest = own.at(0) / self.chi.at(0);
        let left = &own + &self.chi.scaled(-rest);
        self.signal(0.0, &left.lowered().scaled(1.0 / self.rate))
    }

    /// Calls `see` with the state at `count` even times, from 0 on.
    pub fn even(&self, every_s: f64, count: usize, mut see: impl FnMut(&[f64])) {
        let n = self.order();
        let phi = self.propagator(every_s * self.rate);
        let (mut state, mut next) = (vec![0.0; n], vec![0.0; n]);
        state[n - 1] = 1.0;
        for _ in 0..count {
            see(&state);
            moved(&phi, &state, &mut next);
            std::mem::swap(&mut state, &mut next);
        }
    }

    /// The exact motion over a step of scaled time, in rows.
    fn propagator(&self, h: f64) -> Vec<f64> {
        let n = self.order();
        let f =
            DMatrix::from_fn(n, n, |i, j| if i + 1 == n { -self.chi.at(j) } else { f64::from(u8::from(j == i + 1)) });
        (f * h).exp().transpose().as_slice().to_vec()
    }

    /// Calls `see` with time, step and state at the end of every step, from the state at time 0 on (with a step of 0), until
    /// every mode is gone or the horizon is reached. `finer` divides the usual step.
    pub fn walk(&self, horizon_s: f64, finer: f64, mut see: impl FnMut(f64, f64, &[f64])) {
        let n = self.order();
        let fastest = self.roots.iter().map(|root| root.norm()).fold(1e-3, f64::max);
        let slowest = self.roots.iter().map(|root| -root.re).fold(f64::INFINITY, f64::min);
        let end = (OVER / slowest.max(1e-12)).min(horizon_s * self.rate);
        let mut h = (TURN / finer / fastest).min(end);
        let mut powers = vec![self.propagator(h)];
        let (mut state, mut next) = (vec![0.0; n], vec![0.0; n]);
        state[n - 1] = 1.0;
        let (mut time, mut level) = (0.0, 0);
        see(0.0, 0.0, &state);
        while time < end {
            let living = |root: &&Complex<f64>| time * -root.re < GONE;
            let turn = self.roots.iter().filter(living).map(|root| root.norm()).fold(0.0, f64::max);
            while turn * 2.0 * h <= TURN / finer && level < LEVELS && time + 2.0 * h < end {
                if powers.len() == level + 1 {
                    powers.push(squared(&powers[level], n));
                }
                (level, h) = (level + 1, 2.0 * h);
            }
            moved(&powers[level], &state, &mut next);
            std::mem::swap(&mut state, &mut next);
            time += h;
            see(time / self.rate, h / self.rate, &state);
        }
    }
}

/// A matrix in rows times a state.
fn moved(matrix: &[f64], state: &[f64], next: &mut [f64]) {
    for (row, out) in matrix.chunks_exact(state.len()).zip(next) {
        *out = row.iter().zip(state).map(|(a, b)| a * b).sum();
    }
}

/// The square of a matrix in rows.
fn squared(matrix: &[f64], n: usize) -> Vec<f64> {
    let mut square = vec![0.0; n * n];
    for i in 0..n {
        for k in 0..n {
            let factor = matrix[i * n + k];
            for j in 0..n {
                square[i * n + j] += factor * matrix[k * n + j];
            }
        }
    }
    square
}
