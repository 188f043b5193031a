//! Intervals, and functions on them with their first and second derivatives.

use std::ops::{Add, Mul, Sub};

/// All numbers from `low` to `high`. Rounding is not counted: 1e-15 of a number, far below what is asked of a bound here.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Interval {
    pub low: f64,
    pub high: f64,
}

impl Interval {
    /// A number.
    pub const fn point(value: f64) -> Self {
        Self { low: value, high: value }
    }

    /// Largest absolute value.
    pub fn size(self) -> f64 {
        self.low.abs().max(self.high.abs())
    }

    /// The middle.
    pub fn middle(self) -> f64 {
        0.5 * (self.low + self.high)
    }
}

impl Add for Interval {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { low: self.low + other.low, high: self.high + other.high }
    }
}

impl Sub for Interval {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { low: self.low - other.high, high: self.high - other.low }
    }
}

impl Mul for Interval {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let all = [self.low * other.low, self.low * other.high, self.high * other.low, self.high * other.high];
        Self {
            low: all.into_iter().fold(f64::INFINITY, f64::min),
            high: all.into_iter().fold(f64::NEG_INFINITY, f64::max),
        }
    }
}

/// A function of some variables over a box: enclosures of its value, its slopes and its second derivatives.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Jet {
    pub value: Interval,
    /// By variable; empty for a constant.
    pub slopes: Vec<Interval>,
    /// By pairs `(i, j <= i)` in rows; empty for a linear function.
    pub curves: Vec<Interval>,
}

impl Jet {
    /// A constant.
    pub fn constant(value: f64) -> Self {
        Self { value: Interval::point(value), slopes: Vec::new(), curves: Vec::new() }
    }

    /// Variable `i` of `count` with its range.
    pub fn variable(range: Interval, i: usize, count: usize) -> Self {
        let slopes = (0..count).map(|j| Interval::point(if i == j { 1.0 } else { 0.0 })).collect();
        Self { value: range, slopes, curves: Vec::new() }
    }

    /// Times a number.
    pub fn scaled(&self, factor: f64) -> Self {
        let by = |list: &[Interval]| list.iter().map(|x| *x * Interval::point(factor)).collect();
        Self { value: self.value * Interval::point(factor), slopes: by(&self.slopes), curves: by(&self.curves) }
    }

    /// The sum.
    pub fn plus(&self, other: &Self) -> Self {
        Self {
            value: self.value + other.value,
            slopes: summed(&self.slopes, &other.slopes),
            curves: summed(&self.curves, &other.curves),
        }
    }

    /// The product.
    pub fn times(&self, other: &Self) -> Self {
        let by = |list: &[Interval], factor: Interval| list.iter().map(|x| *x * factor).collect::<Vec<_>>();
        let slopes = summed(&by(&self.slopes, other.value), &by(&other.slopes, self.value));
        let mut curves = summed(&by(&self.curves, other.value), &by(&other.curves, self.value));
        if !self.slopes.is_empty() && !other.slopes.is_empty() {
            let (p, q) = (&self.slopes, &other.slopes);
            let cross: Vec<Interval> = (0..p.len())
                .flat_map(|i| (0..=i).map(move |j| (i, j)))
                .map(|(i, j)| p[i] * q[j] + p[j] * q[i])
                .collect();
            curves = summed(&curves, &cross);
        }
        Self { value: self.value * other.value, slopes, curves }
    }

    /// The slope by variable `i`.
    pub fn slope(&self, i: usize) -> Interval {
        self.slopes.get(i).copied().unwrap_or(Interval::point(0.0))
    }

    /// By how much the function differs from its tangent in the middle of a box of these half widths, at most.
    pub fn bend(&self, halves: &[f64]) -> f64 {
        let pairs = (0..halves.len()).flat_map(|i| (0..=i).map(move |j| (i, j)));
        let part = |((i, j), curve): ((usize, usize), &Interval)| {
            curve.size() * halves[i] * halves[j] * if i == j { 0.5 } else { 1.0 }
        };
        pairs.zip(&self.curves).map(part).sum()
    }
}

/// Sum of lists of which one may be empty, all zeros.
fn summed(a: &[Interval], b: &[Interval]) -> Vec<Interval> {
    match (a.is_empty(), b.is_empty()) {
        (true, _) => b.to_vec(),
        (_, true) => a.to_vec(),
        _ => a.iter().zip(b).map(|(x, y)| *x + *y).collect(),
    }
}
