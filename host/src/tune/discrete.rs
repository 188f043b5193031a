//! The plant behind a hold, as a transfer function in `z`, with its derivatives by uncertain coefficients.

use super::interval::{Interval, Jet};
use crate::actuator::uncertain::{Coefficient, Uncertain};

/// Terms of the exponential's series, for a matrix of norm below 1: what is left is below 1e-17.
const TERMS: usize = 18;

/// A plant in `z` over a box: coefficients of numerator and denominator, the constant first, as functions of the uncertain ones.
#[derive(Debug, Clone)]
pub(super) struct Held {
    pub numerator: Vec<Jet>,
    pub denominator: Vec<Jet>,
    /// Whole ticks of dead time, the same for the whole box.
    pub ticks: usize,
}

/// Square matrix of jets in rows.
type Matrix = Vec<Vec<Jet>>;

impl Held {
    /// Of a box `middle +- halves`; a dead time must keep within one tick (`split` says where it does not).
    pub fn of(uncertain: &Uncertain, tick_s: f64, middle: &[f64], halves: &[f64]) -> Self {
        let plant = uncertain.at(middle);
        let (n, count) = (plant.order(), middle.len());
        let jet = |which: Coefficient, value: f64| {
            let place = uncertain.bounds.iter().position(|(other, _, _)| *other == which);
            place.map_or_else(
                || Jet::constant(value),
                |i| Jet::variable(Interval { low: middle[i] - halves[i], high: middle[i] + halves[i] }, i, count),
            )
        };
        // Time in units of the plant's own: entries of like size.
        let unit = plant.denominator.at(0).abs().powf(1.0 / n as f64).max(1.0 / tick_s);
        let power = |k: usize| unit.powi(k as i32);
        let last: Vec<Jet> = (0..n)
            .map(|j| jet(Coefficient::Denominator(j), plant.denominator.at(j)).scaled(-1.0 / power(n - j)))
            .collect();
        let output: Vec<Jet> =
            (0..n).map(|j| jet(Coefficient::Numerator(j), plant.numerator.at(j)).scaled(1.0 / power(n - j))).collect();
        let delay = jet(Coefficient::Delay, plant.delay_s);
        let ticks = (delay.value.middle() / tick_s + 1e-9).floor();
        let rest = delay.plus(&Jet::constant(-ticks * tick_s));
        let constant = rest.slopes.is_empty() && rest.value.size() < 1e-9 * tick_s;
        let after = |h: &Jet| exponential(&augmented(&last, &h.scaled(unit)), n);
        let (phi, both) = after(&Jet::constant(tick_s));
        let denominator = characteristic(&phi);
        if constant {
            let numerator = through(&phi, &denominator.1, &output, &both);
            return Self { numerator, denominator: denominator.0, ticks: ticks as usize };
        }
        // The later command acts over the end of the tick, the earlier one over what is left.
        let (_, later) = after(&Jet::constant(tick_s).plus(&rest.scaled(-1.0)));
        let earlier: Vec<Jet> = both.iter().zip(&later).map(|(a, b)| a.plus(&b.scaled(-1.0))).collect();
        let of_later = through(&phi, &denominator.1, &output, &later);
        let of_earlier = through(&phi, &denominator.1, &output, &earlier);
        let none = Jet::constant(0.0);
        let raised = |list: &[Jet]| std::iter::once(none.clone()).chain(list.iter().cloned()).collect::<Vec<_>>();
        let mut numerator = raised(&of_later);
        for (sum, part) in numerator.iter_mut().zip(&of_earlier) {
            *sum = sum.plus(part);
        }
        Self { numerator, denominator: raised(&denominator.0), ticks: ticks as usize }
    }
}

/// The companion matrix with its input as one more column, times a length of time.
fn augmented(last: &[Jet], h: &Jet) -> Matrix {
    let n = last.len();
    let mut whole = vec![vec![Jet::constant(0.0); n + 1]; n + 1];
    for i in 0..n {
        if i + 1 < n {
            whole[i][i + 1] = h.clone();
        } else {
            for (j, own) in last.iter().enumerate() {
                whole[i][j] = own.times(h);
            }
        }
    }
    whole[n - 1][n] = h.clone();
    whole
}

/// The exponential by its series, halved until it converges fast: the upper left block, and the last column.
fn exponential(matrix: &Matrix, n: usize) -> (Matrix, Vec<Jet>) {
    let norm = matrix.iter().map(|row| row.iter().map(|x| x.value.size()).sum::<f64>()).fold(0.0, f64::max);
    let halvings = norm.log2().ceil().max(0.0) as i32;
    let scaled: Matrix =
        matrix.iter().map(|row| row.iter().map(|x| x.scaled(0.5f64.powi(halvings))).collect()).collect();
    let one = identity(n + 1);
    // Horner's rule: 1 + A (1 + A/2 (1 + A/3 ...)).
    let mut sum = one.clone();
    for k in (1..=TERMS).rev() {
        sum = product(&scaled, &sum);
        for (i, row) in sum.iter_mut().enumerate() {
            for (j, x) in row.iter_mut().enumerate() {
                *x = x.scaled(1.0 / k as f64).plus(&one[i][j]);
            }
        }
    }
    for _ in 0..halvings {
        sum = product(&sum, &sum);
    }
    let block = (0..n).map(|i| sum[i][..n].to_vec()).collect();
    let column = (0..n).map(|i| sum[i][n].clone()).collect();
    (block, column)
}

fn identity(n: usize) -> Matrix {
    (0..n).map(|i| (0..n).map(|j| Jet::constant(if i == j { 1.0 } else { 0.0 })).collect()).collect()
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let one = |row: &[Jet], j: usize| {
        let parts = row.iter().zip(b).map(|(x, other)| x.times(&other[j]));
        parts.fold(Jet::constant(0.0), |sum, part| sum.plus(&part))
    };
    a.iter().map(|row| (0..b.len()).map(|j| one(row, j)).collect()).collect()
}

/// The characteristic polynomial, and the matrices of the adjugate, of `z^0` first (Faddeev and LeVerrier).
fn characteristic(phi: &Matrix) -> (Vec<Jet>, Vec<Matrix>) {
    let n = phi.len();
    let mut coefficients = vec![Jet::constant(1.0); n + 1];
    let mut parts = vec![identity(n)];
    let mut own = identity(n);
    for k in 1..=n {
        let next = product(phi, &own);
        let trace = (0..n).fold(Jet::constant(0.0), |sum, i| sum.plus(&next[i][i]));
        coefficients[n - k] = trace.scaled(-1.0 / k as f64);
        own = next;
        for (i, row) in own.iter_mut().enumerate() {
            row[i] = row[i].plus(&coefficients[n - k]);
        }
        if k < n {
            parts.push(own.clone());
        }
    }
    parts.reverse();
    (coefficients, parts)
}

/// `output adj(z - phi) input`, the constant first.
fn through(phi: &Matrix, adjugate: &[Matrix], output: &[Jet], input: &[Jet]) -> Vec<Jet> {
    let n = phi.len();
    let dot = |row: &[Jet], other: &[Jet]| {
        row.iter().zip(other).fold(Jet::constant(0.0), |sum, (a, b)| sum.plus(&a.times(b)))
    };
    adjugate
        .iter()
        .map(|part| {
            let column: Vec<Jet> = (0..n).map(|i| dot(&part[i], input)).collect();
            dot(output, &column)
        })
        .collect()
}
