//! Roots of the characteristic equation while its coefficients vary (thesis Eq. 56, Fig. 78).

use nalgebra::Complex;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use serde::Serialize;

use super::continuous::Loop;
use super::gains::Gains;
use crate::actuator::plant::Plant;
use crate::actuator::polynomial::Polynomial;
use crate::actuator::uncertain::Uncertain;

/// What varies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Varied {
    /// The plant's coefficients, as its box says; the controller is a program and does not vary.
    Plant,
    /// Every number that Eq. 56 prints, within the part: both polynomials of controller and plant without their leading ones.
    Equation,
}

/// Real parts of a group of roots: of a pair, or of a single one.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Group {
    /// Real part for the plant as it is, 1/s.
    pub nominal: f64,
    /// Smallest and largest over corners and samples, 1/s.
    pub range: (f64, f64),
}

impl Group {
    /// Midpoint and half width, as the thesis writes them.
    pub fn middle(&self) -> (f64, f64) {
        (0.5 * (self.range.0 + self.range.1), 0.5 * (self.range.1 - self.range.0))
    }
}

/// Where the roots are while something varies.
#[derive(Debug, Clone, PartialEq)]
pub struct Spread {
    /// What varies.
    pub varied: Varied,
    /// From the slowest on.
    pub groups: Vec<Group>,
    /// Real parts of every sample, 1/s.
    pub real: Vec<f64>,
    /// Samples that were drawn, beside the corners.
    pub samples: usize,
}

/// Corners are looked at for so many coefficients at most.
const CORNERS: usize = 10;
/// Real parts this close, as a part of the root's size, are one group.
const SAME: f64 = 1e-6;

/// Draws samples of the box, looks at its corners, and sorts the roots of each by their real parts.
pub fn spread(uncertain: &Uncertain, gains: &Gains, varied: Varied, part: f64, samples: usize) -> Option<Spread> {
    let (middle, bounds) = numbers(uncertain, gains, varied, part);
    let chi = |values: &[f64]| of_numbers(uncertain, gains, varied, values);
    let nominal = sorted(&chi(&middle))?;
    let mut ranges: Vec<(f64, f64)> = nominal.iter().map(|root| (root.re, root.re)).collect();
    let widen = |ranges: &mut Vec<(f64, f64)>, roots: &[Complex<f64>]| {
        for (range, root) in ranges.iter_mut().zip(roots) {
            *range = (range.0.min(root.re), range.1.max(root.re));
        }
    };
    if bounds.len() <= CORNERS {
        for bits in 0..1usize << bounds.len() {
            let end = |(i, (low, high)): (usize, &(f64, f64))| if bits >> i & 1 == 0 { *low } else { *high };
            let corner: Vec<f64> = bounds.iter().enumerate().map(end).collect();
            if let Some(roots) = sorted(&chi(&corner)) {
                widen(&mut ranges, &roots);
            }
        }
    }
    let mut chance = Pcg64::seed_from_u64(1);
    let mut real = Vec::with_capacity(samples * nominal.len());
    for _ in 0..samples {
        let values: Vec<f64> = bounds.iter().map(|(low, high)| chance.random_range(*low..=*high)).collect();
        if let Some(roots) = sorted(&chi(&values)) {
            real.extend(roots.iter().map(|root| root.re));
            widen(&mut ranges, &roots);
        }
    }
    let mut groups: Vec<Group> = Vec::new();
    for (root, range) in nominal.iter().zip(ranges) {
        match groups.last_mut().filter(|last| (last.nominal - root.re).abs() < SAME * root.norm()) {
            Some(last) => last.range = (last.range.0.min(range.0), last.range.1.max(range.1)),
            None => groups.push(Group { nominal: root.re, range }),
        }
    }
    Some(Spread { varied, groups, real, samples })
}

/// Roots, the slowest first.
fn sorted(chi: &Polynomial) -> Option<Vec<Complex<f64>>> {
    let mut roots = chi.roots()?;
    roots.sort_by(|a, b| b.re.total_cmp(&a.re));
    Some(roots)
}

/// The numbers that vary, and their bounds.
fn numbers(uncertain: &Uncertain, gains: &Gains, varied: Varied, part: f64) -> (Vec<f64>, Vec<(f64, f64)>) {
    match varied {
        Varied::Plant => {
            let own: Vec<(f64, f64)> = uncertain.bounds.iter().map(|(_, low, high)| (*low, *high)).collect();
            (uncertain.values(), own)
        }
        Varied::Equation => {
            let values = printed(&uncertain.plant, gains);
            let bounds = values.iter().map(|v| (v - part * v.abs(), v + part * v.abs())).collect();
            (values, bounds)
        }
    }
}

/// The numbers of the characteristic equation: controller's numerator, its denominator, plant's numerator, its denominator, each the
/// constant first, without zeros that are structure and without leading ones.
fn printed(plant: &Plant, gains: &Gains) -> Vec<f64> {
    let (d, e) = gains.continuous();
    let own = |polynomial: &Polynomial, leading: bool| {
        let count = polynomial.degree() + usize::from(leading);
        polynomial.coefficients()[..count].to_vec()
    };
    let all = [own(&d, true), own(&e, false), own(&plant.numerator, true), own(&plant.denominator, false)].concat();
    all.into_iter().filter(|value| *value != 0.0).collect()
}

fn of_numbers(uncertain: &Uncertain, gains: &Gains, varied: Varied, values: &[f64]) -> Polynomial {
    if varied == Varied::Plant {
        return Loop::continuous(&uncertain.at(values), gains).chi;
    }
    let (d, e) = gains.continuous();
    let mut values = values.iter();
    let mut filled = |polynomial: &Polynomial, leading: bool| {
        let count = polynomial.degree() + usize::from(leading);
        let one = |(i, own): (usize, &f64)| {
            if i < count && *own != 0.0 { values.next().copied().unwrap_or(*own) } else { *own }
        };
        Polynomial::new(polynomial.coefficients().iter().enumerate().map(one).collect())
    };
    let (d, e) = (filled(&d, true), filled(&e, false));
    let (b, a) = (filled(&uncertain.plant.numerator, true), filled(&uncertain.plant.denominator, false));
    Loop::of(b, a, d, e).chi
}
