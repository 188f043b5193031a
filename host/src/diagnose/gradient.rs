//! How the gain of the force goes with the place on a specimen: what a tilt, a wedge or a material that varies does, and no scatter.
//!
//! Beside the scatter between spots stands a gain that is linear in the place, two slopes a specimen. For every scatter that is tried the slopes have their likeliest values and a chi-square; how
//! likely scatter alone makes as large a one is averaged over what the scatter may be, weighed by how likely it makes what is left (REML). With little known about it that is Student's test.

use nalgebra::{DMatrix, DVector, Matrix2, Vector2};

use crate::infer::eigen;

/// Places vary along a direction when their differences exceed this, mm.
const APART_MM: f64 = 0.1;

/// The gain over the place on one specimen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gradient {
    /// Index of the specimen.
    pub specimen: usize,
    /// Relative change of the force, 1/mm, along the two directions of the places.
    pub per_mm: [f64; 2],
    /// How likely scatter between spots alone makes it as large or larger.
    pub chance: f64,
}

/// What one group of spots says beside a scatter: of the amounts that its repeats differ by, whitened, and of what a unit slope makes of them.
pub(super) struct Seen {
    /// Without slopes.
    pub log_likelihood: f64,
    /// Normal equations of the slopes.
    normal: Matrix2<f64>,
    right: Vector2<f64>,
}

impl Seen {
    /// From whitened amounts, what the slopes add to them (a column each), and the logarithm of the whitening's determinant.
    pub fn of(white: &DVector<f64>, slopes: &DMatrix<f64>, log_determinant: f64) -> Self {
        let right = slopes.tr_mul(white);
        let normal = slopes.tr_mul(slopes);
        Self {
            log_likelihood: log_determinant - 0.5 * white.norm_squared(),
            normal: Matrix2::from_fn(|i, j| normal[(i, j)]),
            right: Vector2::new(right[0], right[1]),
        }
    }
}

/// One specimen's slopes along the directions in which its places vary.
struct Specimen {
    specimen: usize,
    /// Orthonormal, a column each: one or two.
    along: DMatrix<f64>,
}

/// The slopes of all specimens beside every scatter that is tried.
pub(super) struct Slopes {
    /// Specimen of every group.
    of: Vec<usize>,
    specimens: Vec<Specimen>,
    tried: Vec<Tried>,
}

/// The likeliest slopes beside one scatter.
struct Tried {
    /// Logarithm of its weight.
    log: f64,
    each: Vec<Slope>,
}

/// Of one specimen: chi-square, and the slopes themselves, 1/mm.
struct Slope {
    square: f64,
    along: DVector<f64>,
}

impl Slopes {
    /// Of groups of spots: the specimen, and the differences of places (mm, two columns) that belong to its amounts; none where places are unknown.
    pub fn of<'a>(groups: impl Iterator<Item = (usize, &'a DMatrix<f64>)>) -> Self {
        let mut of = Vec::new();
        let mut sums: Vec<(usize, Matrix2<f64>)> = Vec::new();
        for (specimen, places) in groups {
            of.push(specimen);
            let own = places.tr_mul(places);
            let own = Matrix2::from_fn(|i, j| own[(i, j)]);
            match sums.iter_mut().find(|(other, _)| *other == specimen) {
                Some((_, sum)) => *sum += own,
                None => sums.push((specimen, own)),
            }
        }
        let specimens = sums.into_iter().filter_map(|(specimen, sum)| {
            let eigen = eigen::symmetric(DMatrix::from_column_slice(2, 2, sum.as_slice()))?;
            let least = (1e-6 * eigen.eigenvalues.max()).max(APART_MM * APART_MM);
            let far: Vec<DVector<f64>> = (0..2)
                .filter(|i| eigen.eigenvalues[*i] > least)
                .map(|i| DVector::from_column_slice(eigen.eigenvectors.column(i).as_slice()))
                .collect();
            (!far.is_empty()).then(|| Specimen { specimen, along: DMatrix::from_columns(&far) })
        });
        Self { of, specimens: specimens.collect(), tried: Vec::new() }
    }

    /// Takes in what all groups say beside one scatter; `log` is the logarithm of its weight without slopes.
    pub fn weigh(&mut self, log: f64, seen: &[Seen]) {
        let each = self.specimens.iter().map(|one| {
            let own = || self.of.iter().zip(seen).filter(|(specimen, _)| **specimen == one.specimen);
            let normal: Matrix2<f64> = own().map(|(_, seen)| seen.normal).sum();
            let right: Vector2<f64> = own().map(|(_, seen)| seen.right).sum();
            let factor = (one.along.transpose() * normal * &one.along).cholesky()?;
            let right = one.along.transpose() * right;
            let along = factor.solve(&right);
            let square = along.dot(&right);
            let log_determinant: f64 = factor.l_dirty().diagonal().iter().map(|d| d.ln()).sum();
            Some((0.5 * square - log_determinant, Slope { square, along }))
        });
        let Some(each) = each.collect::<Option<Vec<_>>>() else { return };
        let gained: f64 = each.iter().map(|(gained, _)| gained).sum();
        self.tried.push(Tried { log: log + gained, each: each.into_iter().map(|(_, own)| own).collect() });
    }

    /// What the places say of each specimen.
    pub fn gradients(&self) -> Vec<Gradient> {
        let top = self.tried.iter().map(|one| one.log).fold(f64::NEG_INFINITY, f64::max);
        let weights: Vec<f64> = self.tried.iter().map(|one| (one.log - top).exp()).collect();
        let sum: f64 = weights.iter().sum();
        let of = |(at, one): (usize, &Specimen)| {
            let mut chance = 0.0;
            let mut slopes = DVector::zeros(one.along.ncols());
            for (weight, tried) in weights.iter().zip(&self.tried) {
                let own = &tried.each[at];
                chance += weight / sum * beyond(own.square, one.along.ncols());
                slopes += weight / sum * &own.along;
            }
            let per_mm = &one.along * slopes;
            Gradient { specimen: one.specimen, per_mm: [per_mm[0], per_mm[1]], chance }
        };
        self.specimens.iter().enumerate().filter(|_| sum > 0.0).map(of).collect()
    }
}

/// How likely chi-square of one or two degrees of freedom is larger.
fn beyond(square: f64, freedom: usize) -> f64 {
    if freedom == 1 { libm::erfc((0.5 * square).sqrt()) } else { (-0.5 * square).exp() }
}
