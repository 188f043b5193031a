//! Trends of identified parameters with depth: their lines, where these cross, and how noise moves the crossing.

use lut_gen::solid::model::ForceModel;
use nalgebra::{DMatrix, DVector, Matrix2, Vector2};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

use crate::identify::data::LoadingCurve;
use crate::infer::descent::{Quadratic, Region, Rule, Together, minimise};
use crate::infer::eigen;

/// A fitted run.
pub struct Run<'a> {
    /// Its samples.
    pub data: &'a LoadingCurve,
    /// Its force model.
    pub model: &'a ForceModel,
    /// Height of its specimen, mm.
    pub height_mm: f64,
    /// Its fitted contact point, mm.
    pub contact_mm: f64,
    /// Noise of a sample, N, inflated where neighbours say the same.
    pub sigma_n: f64,
}

/// A straight line in the plane: a point and a unit vector.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    origin: Vector2<f64>,
    along: Vector2<f64>,
}

impl Line {
    /// The principal axis of at least two different points.
    #[must_use]
    pub fn through(points: &[[f64; 2]]) -> Option<Self> {
        let count = points.len() as f64;
        let origin = points.iter().map(|p| Vector2::from(*p)).sum::<Vector2<f64>>() / count.max(1.0);
        let scatter: Matrix2<f64> = points
            .iter()
            .map(|p| {
                let from = Vector2::from(*p) - origin;
                from * from.transpose()
            })
            .sum();
        let eigen = eigen::symmetric(DMatrix::from_column_slice(2, 2, scatter.as_slice()))?;
        let longest = usize::from(eigen.eigenvalues[1] > eigen.eigenvalues[0]);
        let along = Vector2::new(eigen.eigenvectors[(0, longest)], eigen.eigenvectors[(1, longest)]);
        (points.len() > 1 && eigen.eigenvalues[longest] > 0.0).then_some(Self { origin, along })
    }

    /// Place of a point's foot along the line.
    #[must_use]
    pub fn place(&self, point: [f64; 2]) -> f64 {
        (Vector2::from(point) - self.origin).dot(&self.along)
    }

    /// The point at a place.
    #[must_use]
    pub fn at(&self, place: f64) -> [f64; 2] {
        (self.origin + place * self.along).into()
    }

    /// Where two lines cross; `None` if they are parallel.
    #[must_use]
    pub fn crossing(&self, other: &Self) -> Option<[f64; 2]> {
        let both = Matrix2::from_columns(&[self.along, -other.along]);
        let places = both.try_inverse()? * (other.origin - self.origin);
        Some(self.at(places[0]))
    }
}

/// Where the trends of two sets of points cross.
#[must_use]
pub fn crossing(first: &[[f64; 2]], second: &[[f64; 2]]) -> Option<[f64; 2]> {
    Line::through(first)?.crossing(&Line::through(second)?)
}

/// How the fits of all cuts of some runs answer to noise, to first order.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensitivity {
    /// Depth past contact of every sample, mm, and its noise, N.
    samples: Vec<(f64, f64)>,
    /// Derivative of every sample's force by ln mu, ln alpha and the runs' contact points.
    jacobian: DMatrix<f64>,
}

impl Sensitivity {
    /// At given parameters.
    #[must_use]
    pub fn of(runs: &[Run<'_>], mu_mpa: f64, alpha: f64) -> Self {
        let columns = 2 + runs.len();
        let mut rows: Vec<Vec<f64>> = Vec::new();
        let mut samples = Vec::new();
        for (at, run) in runs.iter().enumerate() {
            for depth in &run.data.depth_mm {
                let depth_mm = depth - run.contact_mm;
                let force = run.model.gradient_at(mu_mpa, alpha, depth_mm, run.height_mm);
                let mut row = vec![0.0; columns];
                (row[0], row[1], row[2 + at]) = (force.force_n, alpha * force.d_alpha, -force.d_depth);
                rows.push(row);
                samples.push((depth_mm, run.sigma_n));
            }
        }
        let jacobian = DMatrix::from_fn(rows.len(), columns, |i, j| rows[i][j]);
        Self { samples, jacobian }
    }

    /// What noise of the samples down to a depth does to ln mu and ln alpha: two rows over all samples.
    fn answer(&self, depth_mm: f64) -> Option<DMatrix<f64>> {
        let weight = |i: usize| {
            let (depth, sigma_n) = self.samples[i];
            if depth <= depth_mm { 1.0 / (sigma_n * sigma_n).max(f64::MIN_POSITIVE) } else { 0.0 }
        };
        let weighted =
            DMatrix::from_fn(self.jacobian.nrows(), self.jacobian.ncols(), |i, j| self.jacobian[(i, j)] * weight(i));
        let inverse = self.jacobian.tr_mul(&weighted).try_inverse()?;
        Some((inverse * weighted.transpose()).rows(0, 2).into_owned())
    }
}

/// Where trends meet, in the user's units.
#[derive(Debug, Clone, PartialEq)]
pub struct Meeting {
    /// mu in MPa, alpha.
    pub value: [f64; 2],
    /// Their 95 % intervals.
    pub interval: [(f64, f64); 2],
}

/// A ball's points (ln alpha, ln mu), their depths in mm, and how they answer to noise.
pub type Trend<'a> = (Vec<[f64; 2]>, Vec<f64>, &'a Sensitivity);

/// Where two balls' trends cross, with an interval from `draws` draws of the noise.
#[must_use]
pub fn meeting(pair: &[Trend<'_>; 2], draws: usize, seed: u64) -> Option<Meeting> {
    let [alpha, mu] = crossing(&pair[0].0, &pair[1].0)?;
    let mut chance = Pcg64::seed_from_u64(seed);
    let mut answers = Vec::new();
    for (_, depths, sensitivity) in pair {
        answers.push(depths.iter().map(|depth| sensitivity.answer(*depth)).collect::<Option<Vec<_>>>()?);
    }
    let mut all: [Vec<f64>; 2] = [Vec::new(), Vec::new()];
    for _ in 0..draws {
        let moved: Vec<Vec<[f64; 2]>> = pair
            .iter()
            .zip(&answers)
            .map(|((points, _, sensitivity), answers)| {
                let draw = |&(_, sigma_n): &(f64, f64)| {
                    let normal: f64 = StandardNormal.sample(&mut chance);
                    sigma_n * normal
                };
                let noise = DVector::from_iterator(sensitivity.samples.len(), sensitivity.samples.iter().map(draw));
                let shifted = |(point, answer): (&[f64; 2], &DMatrix<f64>)| {
                    let by = answer * &noise;
                    [point[0] + by[1], point[1] + by[0]]
                };
                points.iter().zip(answers).map(shifted).collect()
            })
            .collect();
        if let Some([alpha, mu]) = crossing(&moved[0], &moved[1]) {
            all[0].push(mu.exp());
            all[1].push(alpha.exp());
        }
    }
    Some(Meeting { value: [mu.exp(), alpha.exp()], interval: all.map(|mut values| middle95(&mut values)) })
}

fn middle95(values: &mut [f64]) -> (f64, f64) {
    values.sort_by(f64::total_cmp);
    let at = |share: f64| values.get((share * values.len() as f64) as usize).copied().unwrap_or(f64::NAN);
    (at(0.025), at(0.975))
}

/// ln mu and ln alpha by least squares with the runs' contact points held `by_mm` from their fitted values.
#[must_use]
pub fn with_contacts_held(runs: &[Run<'_>], start: [f64; 2], by_mm: f64) -> [f64; 2] {
    let model = |x: &[f64]| {
        let mut sum = Quadratic { value: 0.0, gradient: DVector::zeros(2), hessian: DMatrix::zeros(2, 2) };
        for run in runs {
            let weight = 1.0 / (run.sigma_n * run.sigma_n).max(f64::MIN_POSITIVE);
            for (depth, force) in run.data.depth_mm.iter().zip(&run.data.force_n) {
                let depth_mm = depth - run.contact_mm - by_mm;
                let modelled = run.model.gradient_at(x[0].exp(), x[1].exp(), depth_mm, run.height_mm);
                let residual = force - modelled.force_n;
                let slope = DVector::from_vec(vec![modelled.force_n, x[1].exp() * modelled.d_alpha]);
                sum.value += weight * residual * residual;
                sum.gradient -= weight * residual * &slope;
                sum.hessian += weight * &slope * slope.transpose();
            }
        }
        sum
    };
    // A factor of ten either way is more than a contact point can do.
    let wide = std::f64::consts::LN_10;
    let alpha = runs.first().map_or((1.0, 24.0), |run| run.model.spec().alpha);
    let region =
        Region { low: vec![start[0] - wide, alpha.0.ln()], high: vec![start[0] + wide, alpha.1.ln()], held: None };
    let end = minimise(&Together(model), &region, &start, &Rule::default()).x;
    [end[0], end[1]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_cross_where_they_should() {
        let first = [[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]];
        let second = [[0.0, 2.0], [0.5, 1.5], [2.0, 0.0]];
        let at = crossing(&first, &second).unwrap_or([f64::NAN; 2]);
        assert!((at[0] - 1.0).abs() < 1e-12 && (at[1] - 1.0).abs() < 1e-12, "{at:?}");
        assert_eq!(crossing(&first, &[[1.0, 1.0], [1.0, 1.0]]), None);
    }

    #[test]
    fn noise_moves_a_fit_as_least_squares_says() {
        // Force = theta_0 d + theta_1 d^2 with unit noise: the covariance of the answer is the inverse normal matrix.
        let depths: Vec<f64> = (1..=50).map(|i| 0.02 * f64::from(i)).collect();
        let sensitivity = Sensitivity {
            samples: depths.iter().map(|d| (*d, 1.0)).collect(),
            jacobian: DMatrix::from_fn(50, 2, |i, j| depths[i].powi(1 + j as i32)),
        };
        let answer = sensitivity.answer(0.5).unwrap_or_else(|| DMatrix::zeros(2, 50));
        let half = sensitivity.jacobian.rows(0, 25);
        let covariance = &answer * answer.transpose();
        let exact = half.tr_mul(&half).try_inverse().unwrap_or_else(|| DMatrix::zeros(2, 2));
        assert!((&covariance - &exact).norm() < 1e-9 * exact.norm());
        assert!(answer.columns(25, 25).norm() == 0.0, "samples below the cut say nothing");
    }
}
