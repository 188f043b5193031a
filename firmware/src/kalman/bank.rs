//! A bank of filters: an unknown that a model bends along takes one value in each, the others are filtered, and the values are weighed by what
//! the measurements say of them (Magill 1965, Optimal adaptive estimation of sampled stochastic processes, IEEE Trans. Autom. Control 10).
//!
//! One filter, linearised at one place, states the errors of a straight valley. Where a valley bends or has two bottoms the bank's mean and
//! deviation hold all of it.

use super::{Filter, Model, Prediction};
use nalgebra::SVector;

/// A filter of the bank: linearised about one reference, as [`super::Estimator::step_about`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Member<const N: usize> {
    /// State and covariance.
    pub filter: Filter<N>,
    /// Where the model is linearised.
    pub reference: SVector<f32, N>,
    /// Logarithm of the probability density of the measurements so far, less what is the same for all members of a bank.
    pub log_evidence: f32,
    /// Measurements so far.
    pub samples: u16,
}

impl<const N: usize> Member<N> {
    /// Before the first measurement; the state is distributed about `mean` with independent `deviations`.
    pub fn new(mean: SVector<f32, N>, deviations: &SVector<f32, N>, reference: SVector<f32, N>) -> Self {
        Member { filter: Filter::new(mean, deviations), reference, log_evidence: 0.0, samples: 0 }
    }

    /// Takes a measurement; its noise variance follows from what the model predicts. Nothing changes where the model has no value, or anything
    /// is no number.
    pub fn take<M: Model<N>>(
        &mut self,
        model: &M,
        input: M::Input,
        measured: f32,
        variance: impl Fn(&Prediction<N>) -> f32,
    ) {
        let Some(predicted) = model.predict(&self.reference, input) else {
            return;
        };
        let mut innovation = measured - predicted.value;
        for i in 0..N {
            innovation -= predicted.gradient[i] * (self.filter.state[i] - self.reference[i]);
        }
        let noise = variance(&predicted);
        let total = self.filter.spread(&predicted.gradient) + noise;
        if !(innovation.is_finite() && noise > 0.0 && total.is_finite()) {
            return;
        }
        // The measurements' density is the product of those of the innovations.
        self.log_evidence -= 0.5 * (innovation * innovation / total + libm::logf(total));
        let gain = self.filter.condense(&predicted.gradient, noise);
        for i in 0..N {
            self.filter.state[i] += gain[i] * innovation;
        }
        self.samples = self.samples.saturating_add(1);
    }
}

/// Weighted moments of the members' quantities, one member at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mixture<const N: usize> {
    /// Moments are taken about this point, so that a narrow mixture loses no digits.
    about: SVector<f32, N>,
    /// Largest logarithm of a weight; weights are fractions of its.
    largest: f32,
    total: f32,
    first: SVector<f32, N>,
    second: SVector<f32, N>,
}

impl<const N: usize> Mixture<N> {
    /// Empty; `about` should be near the mean.
    pub fn new(about: SVector<f32, N>) -> Self {
        let zero = SVector::zeros();
        Mixture { about, largest: f32::NEG_INFINITY, total: 0.0, first: zero, second: zero }
    }

    /// Largest logarithm of a weight so far; minus infinity for none.
    pub const fn largest(&self) -> f32 {
        self.largest
    }

    /// Adds a member: logarithm of its weight, means and variances of its quantities. Adds nothing if the weight is no finite number.
    pub fn add(&mut self, log_weight: f32, mean: &SVector<f32, N>, variance: &SVector<f32, N>) {
        if !log_weight.is_finite() {
            return;
        }
        if log_weight > self.largest {
            // exp(-inf) is 0: the empty sums.
            let shrink = libm::expf(self.largest - log_weight);
            self.total *= shrink;
            self.first = self.first.map(|x| x * shrink);
            self.second = self.second.map(|x| x * shrink);
            self.largest = log_weight;
        }
        let weight = libm::expf(log_weight - self.largest);
        self.total += weight;
        for i in 0..N {
            let off = mean[i] - self.about[i];
            self.first[i] += weight * off;
            self.second[i] += weight * (off * off + variance[i]);
        }
    }

    /// Mean and variance of every quantity; `None` for an empty mixture, or if anything in it is no number.
    pub fn moments(&self) -> Option<(SVector<f32, N>, SVector<f32, N>)> {
        if !(self.total > 0.0) {
            return None;
        }
        let off = self.first.map(|x| x / self.total);
        let variance = SVector::from_fn(|i, _| self.second[i] / self.total - off[i] * off[i]);
        let mean = SVector::from_fn(|i, _| self.about[i] + off[i]);
        (0..N).all(|i| mean[i].is_finite() && variance[i] >= 0.0).then_some((mean, variance))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use nalgebra::{Vector1, Vector2};

    /// `y = x0 + x1 t`.
    struct Line;

    impl Model<2> for Line {
        type Input = f32;
        fn predict(&self, state: &Vector2<f32>, t: f32) -> Option<Prediction<2>> {
            t.is_finite().then(|| Prediction { value: state[0] + state[1] * t, gradient: Vector2::new(1.0, t) })
        }
    }

    /// The same line with a known slope.
    struct Sloped(f32);

    impl Model<1> for Sloped {
        type Input = f32;
        fn predict(&self, state: &Vector1<f32>, t: f32) -> Option<Prediction<1>> {
            Some(Prediction { value: state[0] + self.0 * t, gradient: Vector1::new(1.0) })
        }
    }

    const SAMPLES: [(f32, f32); 5] = [(0.0, 1.1), (1.0, 1.4), (2.0, 2.3), (3.0, 2.4), (4.0, 3.2)];

    /// A bank over the slope against one filter of both, which is exact for a straight line.
    #[test]
    fn a_bank_over_a_straight_valley_is_the_filter() {
        let variance = 0.04;
        let mut filter = Member::new(Vector2::new(1.0, 0.0), &Vector2::new(10.0, 3.0), Vector2::zeros());
        for (t, y) in SAMPLES {
            filter.take(&Line, t, y, |_| variance);
        }
        let mut mixture = Mixture::new(Vector2::new(1.0, 0.5));
        for i in 0..=60 {
            // Three standard deviations of the slope's own distribution are far outside what the samples leave.
            let slope = -0.5 + 2.0 * i as f32 / 60.0;
            let mut member = Member::new(Vector1::new(1.0), &Vector1::new(10.0), Vector1::zeros());
            for (t, y) in SAMPLES {
                member.take(&Sloped(slope), t, y, |_| variance);
            }
            let before = -0.5 * slope * slope / 9.0;
            let (mean, error) = (member.filter.state, member.filter.deviations());
            let variances = Vector2::new(error[0] * error[0], 0.0);
            mixture.add(member.log_evidence + before, &Vector2::new(mean[0], slope), &variances);
        }
        let (mean, variance) = mixture.moments().unwrap();
        let (state, errors) = (filter.filter.state, filter.filter.deviations());
        for i in 0..2 {
            // Rounding of f32 in sixty sums, and of the logarithms.
            assert!((mean[i] - state[i]).abs() < 1e-3 * errors[i], "{mean} {state}");
            assert!((variance[i].sqrt() / errors[i] - 1.0).abs() < 1e-3, "{variance} {errors}");
        }
    }

    /// Two measurements of one number: a normal distribution of two dimensions with covariance `p + r` and `p`.
    #[test]
    fn the_evidence_is_the_density_of_the_measurements() {
        let (p, r, y): (f64, f64, [f64; 2]) = (4.0, 0.25, [0.7, 1.9]);
        let density = |p: f64| {
            let (a, b) = (p + r, p);
            let determinant = a * a - b * b;
            -0.5 * ((a * (y[0] * y[0] + y[1] * y[1]) - 2.0 * b * y[0] * y[1]) / determinant + determinant.ln())
        };
        let evidence = |p: f64| {
            let mut member = Member::new(Vector1::zeros(), &Vector1::new(p.sqrt() as f32), Vector1::zeros());
            y.iter().for_each(|y| member.take(&Sloped(0.0), 0.0, *y as f32, |_| r as f32));
            f64::from(member.log_evidence)
        };
        // Rounding of f32.
        assert!((evidence(p) - density(p)).abs() < 1e-5 && (evidence(1.0) - density(1.0)).abs() < 1e-5);
    }

    #[test]
    fn two_bottoms_are_held_by_mean_and_deviation() {
        let mut mixture = Mixture::new(Vector1::new(3.0));
        // The heavier one comes last: weights are made smaller then.
        mixture.add(0.0, &Vector1::new(2.0), &Vector1::new(0.01));
        mixture.add(3f32.ln(), &Vector1::new(4.0), &Vector1::new(0.04));
        let (mean, variance) = mixture.moments().unwrap();
        // One quarter and three quarters: mean 3.5, variance 0.25 0.01 + 0.75 0.04 + 0.25 0.75 2^2; rounding.
        assert!((mean[0] - 3.5).abs() < 1e-5 && (variance[0] - 0.7825).abs() < 1e-5, "{mean} {variance}");
        assert_eq!(mixture.largest(), 3f32.ln());
    }

    #[test]
    fn what_is_no_number_changes_nothing() {
        let mut member = Member::new(Vector2::new(1.0, 0.0), &Vector2::new(1.0, 1.0), Vector2::zeros());
        let before = member;
        for (t, y, variance) in [(f32::NAN, 1.0, 1.0), (1.0, f32::NAN, 1.0), (1.0, 1.0, f32::NAN), (1.0, 1.0, 0.0)] {
            member.take(&Line, t, y, |_| variance);
        }
        assert_eq!(member, before);
        let mut mixture = Mixture::new(Vector1::new(0.0));
        mixture.add(f32::NAN, &Vector1::new(1.0), &Vector1::new(1.0));
        mixture.add(f32::NEG_INFINITY, &Vector1::new(1.0), &Vector1::new(1.0));
        assert_eq!(mixture.moments(), None);
    }
}
