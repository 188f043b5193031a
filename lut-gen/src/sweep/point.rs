//! The points of a sweep, numbered.

use super::{Parameter, SweepSpec};

/// What a job of a sweep is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// A point of the grid.
    Grid,
    /// The grid point of the given number, on a finer mesh: states the error of discretisation.
    Finer(usize),
    /// The middle of the cell of the given number: states the error of interpolation.
    Between(usize),
}

/// One simulation of a sweep.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    values: [Option<f64>; Parameter::ALL.len()],
    /// Element sizes of the standard mesh are divided by this.
    pub refinement: f64,
    /// What it is for.
    pub purpose: Purpose,
}

impl Point {
    /// Value of a parameter in its unit, if the law has it. A factor is 1.
    #[must_use]
    pub fn get(&self, parameter: Parameter) -> Option<f64> {
        self.values[parameter as usize]
    }

    /// The same on a mesh of another refinement.
    #[must_use]
    pub fn on_mesh(self, refinement: f64) -> Self {
        Self { refinement, ..self }
    }

    /// The parameters and their values, for messages.
    #[must_use]
    pub fn label(&self, parameters: &[Parameter]) -> String {
        let texts = parameters.iter().filter_map(|p| Some(format!("{} {}", p.name(), self.get(*p)?)));
        let mut label = texts.collect::<Vec<_>>().join(", ");
        match self.purpose {
            Purpose::Grid => {}
            Purpose::Finer(_) => label.push_str(", on the finer mesh"),
            Purpose::Between(_) => label.push_str(", between the points"),
        }
        label
    }
}

/// How much finer the mesh of a check is.
const FINER: f64 = 1.5;

/// The golden section's stride through `count` things, made coprime with it: the first few
/// visited lie well apart, and none comes twice.
fn spread(count: usize, j: usize) -> usize {
    let gcd = |mut a: usize, mut b: usize| {
        while b != 0 {
            (a, b) = (b, a % b);
        }
        a
    };
    let mut stride = ((count as f64 * 0.618_033_988_749_895).round() as usize).max(1);
    while gcd(stride, count) != 1 {
        stride += 1;
    }
    // From the last one, where all parameters are largest.
    ((count - 1) as u128 + stride as u128 * j as u128).rem_euclid(count as u128) as usize
}

impl SweepSpec {
    /// Points of the grid that are solved; factor axes add none.
    #[must_use]
    pub fn grid(&self) -> usize {
        self.axes.iter().map(super::SweepAxis::solved).product()
    }

    fn cells(&self) -> usize {
        self.axes.iter().map(|a| a.solved().saturating_sub(1).max(1)).product()
    }

    /// Checks on the finer mesh, and between the points.
    #[must_use]
    pub fn checked(&self) -> (usize, usize) {
        let between = if self.axes.iter().all(|a| a.solved() < 2) { 0 } else { self.checks.min(self.cells()) };
        (self.checks.min(self.grid()), between)
    }

    /// Simulations in all: the grid, then the checks. They are numbered from 0.
    #[must_use]
    pub fn jobs(&self) -> usize {
        let (finer, between) = self.checked();
        self.grid() + finer + between
    }

    /// What the job of a number is for; numbers from [`SweepSpec::jobs`] on are none.
    #[must_use]
    pub fn purpose(&self, job: usize) -> Option<Purpose> {
        let grid = self.grid();
        let (finer, between) = self.checked();
        let check = job.checked_sub(grid);
        match check {
            None => Some(Purpose::Grid),
            Some(j) if j < finer => Some(Purpose::Finer(spread(grid, j))),
            Some(j) if j < finer + between => Some(Purpose::Between(spread(self.cells(), j - finer))),
            Some(_) => None,
        }
    }

    /// The simulation of a job.
    #[must_use]
    pub fn point(&self, job: usize) -> Option<Point> {
        let purpose = self.purpose(job)?;
        let mut values = [None; Parameter::ALL.len()];
        for (p, value) in &self.fixed {
            values[*p as usize] = Some(*value);
        }
        let between = matches!(purpose, Purpose::Between(_));
        let mut left = match purpose {
            Purpose::Grid => job,
            Purpose::Finer(n) | Purpose::Between(n) => n,
        };
        for axis in self.axes.iter().rev() {
            let value = if axis.factor {
                1.0
            } else if between && axis.solved() > 1 {
                let i = left % (axis.solved() - 1);
                left /= axis.solved() - 1;
                axis.spacing.middle(axis.values[i], axis.values[i + 1])
            } else {
                let i = left % axis.solved();
                left /= axis.solved();
                axis.values[i]
            };
            values[axis.parameter as usize] = Some(value);
        }
        let finer = if matches!(purpose, Purpose::Finer(_)) { FINER } else { 1.0 };
        Some(Point { values, refinement: self.refinement * finer, purpose })
    }

    /// A job in words: the values of its axes.
    #[must_use]
    pub fn label(&self, job: usize) -> String {
        let parameters: Vec<Parameter> = self.axes.iter().filter(|a| !a.factor).map(|a| a.parameter).collect();
        self.point(job).map_or_else(|| "no such point".to_owned(), |p| p.label(&parameters))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use std::collections::BTreeSet;

    use super::*;
    use crate::sweep::{Spacing, SweepAxis, SweepLaw};

    #[test]
    fn checks_visit_different_points() {
        for count in [1, 2, 3, 9, 10, 64, 729] {
            let seen: BTreeSet<usize> = (0..count).map(|j| spread(count, j)).collect();
            assert_eq!(seen.len(), count);
            assert_eq!(spread(count, 0), count - 1);
        }
    }

    #[test]
    fn the_last_axis_varies_fastest_and_a_factor_not_at_all() {
        let mut mu = SweepAxis::listed(Parameter::Mu, &[0.1, 0.2]);
        mu.factor = true;
        let mut spec = SweepSpec::new("order", SweepLaw::Hyperfoam)
            .over(SweepAxis::listed(Parameter::Alpha, &[2.0, 4.0, 8.0]))
            .over(mu)
            .over(SweepAxis::even(Parameter::Nu, 0.1, 0.4, 2, Spacing::Logarithmic));
        spec.checks = 2;
        spec.check().unwrap();
        assert_eq!((spec.grid(), spec.checked(), spec.jobs()), (6, (2, 2), 10));
        let at = |job| spec.point(job).unwrap();
        let alpha_nu = |p: Point| (p.get(Parameter::Alpha).unwrap(), p.get(Parameter::Nu).unwrap());
        assert_eq!(alpha_nu(at(0)), (2.0, 0.1));
        assert_eq!(alpha_nu(at(1)), (2.0, 0.4));
        assert_eq!(alpha_nu(at(4)), (8.0, 0.1));
        assert_eq!(at(3).get(Parameter::Mu), Some(1.0));
        assert_eq!(at(3).get(Parameter::Tau), None);
        assert_eq!((at(6).purpose, at(6).refinement), (Purpose::Finer(5), 1.5));
        // The middle of the second cell of alpha, and of the logarithm of nu.
        assert_eq!(alpha_nu(at(8)), (6.0, (0.1_f64 * 0.4).sqrt()));
        assert_eq!(spec.label(8), "alpha 6, nu 0.2, between the points");
        assert!(spec.point(10).is_none());
    }
}
