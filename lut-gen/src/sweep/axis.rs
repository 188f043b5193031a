//! One axis of a sweep.

use serde::{Deserialize, Serialize};

use super::Parameter;

/// In what the values of an axis are spaced, and interpolated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Spacing {
    /// In the value.
    Linear,
    /// In its logarithm.
    Logarithmic,
}

impl Spacing {
    /// The coordinate in which the axis is straight.
    #[must_use]
    pub fn coordinate(self, value: f64) -> f64 {
        match self {
            Self::Linear => value,
            Self::Logarithmic => value.ln(),
        }
    }

    /// The value in the middle between two.
    #[must_use]
    pub fn middle(self, a: f64, b: f64) -> f64 {
        match self {
            Self::Linear => 0.5 * (a + b),
            Self::Logarithmic => (a * b).sqrt(),
        }
    }
}

/// One axis of a sweep: a parameter and the values it takes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SweepAxis {
    /// What varies.
    pub parameter: Parameter,
    /// Its values, rising, in the parameter's unit.
    pub values: Vec<f64>,
    /// How they are spaced.
    pub spacing: Spacing,
    /// The force is proportional to this parameter: nothing is solved along the axis.
    pub factor: bool,
}

impl SweepAxis {
    /// An axis of listed values, straight in the value.
    #[must_use]
    pub fn listed(parameter: Parameter, values: &[f64]) -> Self {
        Self { parameter, values: values.to_vec(), spacing: Spacing::Linear, factor: false }
    }

    /// `count` values from `low` to `high` at equal steps of the spacing; the ends are exact.
    #[must_use]
    pub fn even(parameter: Parameter, low: f64, high: f64, count: usize, spacing: Spacing) -> Self {
        let value = |i: usize| match (i, spacing) {
            (0, _) => low,
            (i, _) if i + 1 == count => high,
            (i, Spacing::Linear) => low + (high - low) * i as f64 / (count - 1) as f64,
            (i, Spacing::Logarithmic) => low * (high / low).powf(i as f64 / (count - 1) as f64),
        };
        Self { parameter, values: (0..count).map(value).collect(), spacing, factor: false }
    }

    /// Values that are solved: one on a factor axis, all on others.
    #[must_use]
    pub fn solved(&self) -> usize {
        if self.factor { 1 } else { self.values.len() }
    }

    /// Where a value lies: the index below it and the share of the way to the next value.
    /// `None` outside the axis; its ends belong to it.
    #[must_use]
    pub fn locate(&self, value: f64) -> Option<(usize, f64)> {
        let (first, last) = (*self.values.first()?, *self.values.last()?);
        if !(first..=last).contains(&value) {
            return None;
        }
        let below = self.values.partition_point(|v| *v <= value).saturating_sub(1);
        let Some(&next) = self.values.get(below + 1) else {
            return Some((below, 0.0));
        };
        let x = |v: f64| self.spacing.coordinate(v);
        let low = x(self.values[below]);
        Some((below, (x(value) - low) / (x(next) - low)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn even_axes_meet_their_ends_exactly() {
        let log = SweepAxis::even(Parameter::Mu, 0.0005, 0.3, 3, Spacing::Logarithmic);
        assert_eq!((log.values[0], log.values[2]), (0.0005, 0.3));
        assert!((log.values[1] - (0.0005_f64 * 0.3).sqrt()).abs() < 1e-15);
        assert_eq!(SweepAxis::even(Parameter::G, 0.0, 0.8, 3, Spacing::Linear).values, [0.0, 0.4, 0.8]);
        assert_eq!(SweepAxis::even(Parameter::G, 0.5, 0.8, 1, Spacing::Linear).values, [0.5]);
    }

    #[test]
    fn a_value_is_located_in_the_spacing_of_its_axis() {
        let axis = SweepAxis::even(Parameter::Tau, 0.01, 100.0, 3, Spacing::Logarithmic);
        let (below, share) = axis.locate(0.1).unwrap_or_default();
        assert_eq!(below, 0);
        assert!((share - 0.5).abs() < 1e-12);
        assert_eq!(axis.locate(100.0), Some((2, 0.0)));
        assert_eq!(axis.locate(0.01), Some((0, 0.0)));
        assert_eq!(axis.locate(0.0099), None);
        assert_eq!(axis.locate(f64::NAN), None);
    }
}
