#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
use super::*;
use crate::testbed::Chance;
use nalgebra::{Matrix3, RowVector3, Vector2, Vector3};

/// Eq. 20 in f64, for comparison.
fn updated(p: &Matrix3<f64>, h: &RowVector3<f64>, r: f64) -> Matrix3<f64> {
    let ph = p * h.transpose();
    let s = (h * ph)[(0, 0)] + r;
    p - ph * ph.transpose() / s
}

#[test]
fn gain_and_covariance_are_equations_19_and_20() {
    let mut filter = Filter::new(Vector3::new(1.0, 2.0, 3.0), &Vector3::new(2.0, 0.5, 3.0));
    let mut p = Matrix3::from_diagonal(&nalgebra::Vector3::new(4.0, 0.25, 9.0));
    for h in [[1.0, -2.0, 0.5], [0.3, 0.7, -1.1], [0.0, 1.0, 0.0], [2.0, 0.1, 0.4]] {
        let r = 0.3;
        let gain = filter.condense(&Vector3::from(h.map(|x| x as f32)), r as f32);
        let h = RowVector3::new(h[0], h[1], h[2]);
        p = updated(&p, &h, r);
        let expected = p * h.transpose() / r;
        for i in 0..3 {
            assert!((f64::from(gain[i]) - expected[(i, 0)]).abs() < 1e-5, "{gain} {expected}");
            for j in 0..3 {
                assert!((f64::from(filter.covariance()[(i, j)]) - p[(i, j)]).abs() < 1e-5);
            }
        }
    }
}

/// Thousands of updates with gradients that are nearly parallel, of sizes over six decades, and noise far below the prior.
#[test]
fn the_covariance_stays_symmetric_and_positive() {
    fn run<const N: usize>(chance: &mut Chance) {
        for _ in 0..60 {
            let scale: [f32; N] = core::array::from_fn(|_| 10f64.powf(6.0 * chance.even() - 3.0) as f32);
            let mut filter = Filter::<N>::new(SVector::zeros(), &SVector::from_fn(|i, _| scale[i]));
            let direction: [f64; N] = core::array::from_fn(|_| chance.normal());
            let mut total = filter.covariance().trace();
            for _ in 0..200 {
                let wander = 10f64.powf(-5.0 * chance.even());
                let gradient = SVector::from_fn(|i, _| ((direction[i] + wander * chance.normal()) as f32) / scale[i]);
                filter.condense(&gradient, 10f64.powf(-8.0 * chance.even()) as f32);
                let p = filter.covariance();
                assert_eq!(p, p.transpose());
                assert!(filter.d.iter().all(|d| *d > 0.0 && d.is_finite()));
                assert!((0..N).all(|i| p[(i, i)] > 0.0), "{p}");
                // It never grows, but for rounding.
                assert!(p.trace() <= total * (1.0 + 1e-4), "{} {total}", p.trace());
                total = p.trace();
            }
        }
    }
    let mut chance = Chance(11);
    run::<2>(&mut chance);
    run::<3>(&mut chance);
    run::<6>(&mut chance);
}

#[test]
fn strange_gradients_and_variances_change_nothing() {
    let before = Filter::new(Vector2::new(1.0, 2.0), &Vector2::new(2.0, 0.5));
    for (gradient, variance) in [
        (Vector2::new(f32::NAN, 1.0), 1.0),
        (Vector2::new(f32::INFINITY, 1.0), 1.0),
        (Vector2::new(1.0, 1.0), 0.0),
        (Vector2::new(1.0, 1.0), -1.0),
        (Vector2::new(1.0, 1.0), f32::NAN),
        (Vector2::new(1e30, 1.0), 1.0),
    ] {
        let mut filter = before;
        assert_eq!(filter.condense(&gradient, variance), Vector2::zeros());
        assert_eq!(filter, before);
    }
}

/// y = x0 + x1 t.
struct Line;

impl Model<2> for Line {
    type Input = f32;

    fn predict(&self, state: &Vector2<f32>, t: f32) -> Option<Prediction<2>> {
        Some(Prediction { value: state[0] + state[1] * t, gradient: Vector2::new(1.0, t) })
    }
}

fn line(initial: [f32; 2], bounding: Bounding) -> Estimator<2> {
    let region = Region { low: Vector2::new(0.0, 0.0), high: Vector2::new(1.0, 1.0) };
    Estimator::new(Vector2::from(initial), region, bounding)
}

fn apart(state: Vector2<f32>, expected: [f32; 2]) -> f32 {
    (state[0] - expected[0]).abs().max((state[1] - expected[1]).abs())
}

const ALL: [Bounding; 5] = [
    Bounding::Projection,
    Bounding::Penalty { coefficient: 0.5 },
    Bounding::PrintedPenalty { coefficient: 0.5 },
    Bounding::NearestNeighbour,
    Bounding::Constrained { linearisations: 2 },
];

#[test]
fn inside_the_region_every_bounding_is_least_squares() {
    for bounding in ALL {
        let mut estimator = line([0.5, 0.5], bounding);
        let samples = (0..50).map(|i| (0.02 * i as f32, 0.4 + 0.6 * 0.02 * i as f32));
        assert_eq!(identify::identify(&mut estimator, &Line, samples, 1e-6, 1), 50);
        let state = estimator.filter.state;
        assert!(apart(state, [0.4, 0.6]) < 1e-4, "{bounding:?} {state}");
        // Standard errors of a straight line: (A^T A)^-1 times the noise.
        let (s0, s1, s2) =
            (0..50).map(|i| 0.02 * f64::from(i)).fold((0.0, 0.0, 0.0), |s, t| (s.0 + 1.0, s.1 + t, s.2 + t * t));
        let expected = (1e-6 * s0 / (s0 * s2 - s1 * s1)).sqrt();
        assert!((f64::from(estimator.filter.deviations()[1]) / expected - 1.0).abs() < 1e-2, "{bounding:?}");
    }
}

#[test]
fn the_edge_is_met_as_each_bounding_says() {
    // One sample at t = 0 that asks for x0 = 1.5: gain near 1.
    let after = |bounding| {
        let mut estimator = line([0.2, 0.5], bounding);
        estimator.step(&Line, 0.0, 1.5, 1e-6).unwrap();
        estimator.filter.state[0]
    };
    assert_eq!(after(Bounding::Projection), 1.0);
    assert!((after(Bounding::Penalty { coefficient: 0.5 }) - 0.6).abs() < 1e-6);
    assert!(
        (after(Bounding::PrintedPenalty { coefficient: 0.5 }) - 0.6).abs() < 1e-6,
        "upper edge, positive gain: Eq. 24"
    );
    assert!((after(Bounding::NearestNeighbour) - 1.5).abs() < 1e-5);
    assert_eq!(after(Bounding::Constrained { linearisations: 1 }), 1.0);
    // Lower edge, positive gain: Eq. 25 overshoots, the consistent form draws back.
    let below = |bounding| {
        let mut estimator = line([0.2, 0.5], bounding);
        estimator.step(&Line, 0.0, -0.5, 1e-6).unwrap();
        estimator.filter.state[0]
    };
    assert!((below(Bounding::PrintedPenalty { coefficient: 0.5 }) + 0.1).abs() < 1e-6);
    assert!((below(Bounding::Penalty { coefficient: 0.5 }) - 0.1).abs() < 1e-6);
}

#[test]
fn a_parameter_held_at_the_edge_takes_the_others_along() {
    // x0 + x1 = 1.6 is known well, then x0 alone asks for 1.2: with x0 held at 1, x1 must be 0.6. Projection leaves it at 0.4.
    let after = |bounding| {
        let mut estimator = line([0.8, 0.8], bounding);
        estimator.step(&Line, 1.0, 1.6, 1e-6).unwrap();
        estimator.step(&Line, 0.0, 1.2, 1e-4).unwrap();
        estimator.filter.state
    };
    let constrained = after(Bounding::Constrained { linearisations: 1 });
    assert!(apart(constrained, [1.0, 0.6]) < 1e-3, "{constrained}");
    let projected = after(Bounding::Projection);
    assert!(apart(projected, [1.0, 0.4]) < 1e-2, "{projected}");
}

#[test]
fn no_measurement_moves_a_filter_to_what_is_not_a_number() {
    for bounding in ALL {
        let mut estimator = line([0.5, 0.5], bounding);
        let before = estimator;
        for (t, y) in [(f32::NAN, 1.0), (1.0, f32::NAN), (1.0, f32::INFINITY), (f32::INFINITY, 1.0)] {
            let _ = estimator.step(&Line, t, y, 1e-4);
            assert!(estimator.filter.state.iter().all(|x| x.is_finite()), "{bounding:?} {t} {y}");
            assert_eq!(estimator.filter, before.filter, "{bounding:?} {t} {y}");
        }
    }
    assert_eq!(Matrix3::<f32>::identity(), Filter::<3>::new(Vector3::zeros(), &Vector3::repeat(1.0)).covariance());
}
