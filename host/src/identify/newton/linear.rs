//! A fit near its minimum, row by row: what an error that no parameter knows of would move.

use nalgebra::{DMatrix, DVector};

use crate::infer::lowrank::LowRank;
use crate::infer::presence;
use crate::infer::unseen::Widening;

use super::coordinate::{Kind, Values};
use super::problem::{Problem, compare, forces};
use crate::identify::zero::Unsure;

/// Samples of a run that are kept, evenly taken; each stands for those around it.
const MOST_SAMPLES: usize = 150;

/// A fitted run near the minimum.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearRun {
    /// Index into [`crate::identify::data::Selection::curves`].
    pub curve: usize,
    /// Samples that are kept.
    pub samples: Vec<usize>,
    /// Fitted contact point, mm.
    pub contact_mm: f64,
    /// Parameters of its forward problem.
    pub values: Values,
    /// Square root of the weight of each sample, 1/N.
    weights: Vec<f64>,
    /// What a shift of the contact point changes, whitened, of unit length; nothing where it changes nothing.
    touch: DVector<f64>,
    /// What the zero of its force may be, whitened, with the variance of the amount.
    unsure: Unsure,
}

/// A fit near its minimum, whitened; what a shift of a run's contact point would absorb is taken out of its rows.
#[derive(Debug, Clone, PartialEq)]
pub struct Linear {
    /// Fitted runs, in the order of their rows.
    pub runs: Vec<LinearRun>,
    /// What each coordinate is.
    pub kinds: Vec<Kind>,
    jacobian: DMatrix<f64>,
    residual: DVector<f64>,
}

impl LinearRun {
    /// Forces (N) at the kept samples, whitened, without what the contact point would absorb.
    fn whitened(&self, force_n: impl Iterator<Item = f64>) -> DVector<f64> {
        let mut own = DVector::from_iterator(self.weights.len(), force_n.zip(&self.weights).map(|(f, w)| f * w));
        self.unsure.whiten(own.as_mut_slice(), 1.0);
        own.axpy(-self.touch.dot(&own), &self.touch, 1.0);
        own
    }
}

impl Linear {
    /// Forces (N) at the kept samples of all runs as rows of the fit.
    ///
    /// # Panics
    /// When a run has fewer forces than samples.
    #[must_use]
    pub fn rows(&self, force_n: &[Vec<f64>]) -> DVector<f64> {
        let each = self
            .runs
            .iter()
            .zip(force_n)
            .flat_map(|(run, own)| run.whitened(own.iter().copied()).data.as_vec().clone());
        DVector::from_vec(each.collect())
    }

    /// What effects that may be there, each columns of [`Linear::rows`], do to the errors of the coordinates; `None` where the rows do
    /// not determine these.
    #[must_use]
    pub fn widening(&self, unseen: &[LowRank]) -> Option<Widening> {
        Widening::of(&self.jacobian, &self.residual, unseen, presence::probability())
    }

    /// Number of rows.
    #[must_use]
    pub fn len(&self) -> usize {
        self.residual.len()
    }

    /// True without a row.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.residual.is_empty()
    }
}

impl Problem<'_> {
    /// The fit near a point; `None` while one of its conditions is not solved.
    #[must_use]
    pub fn linear(&self, point: &[f64]) -> Option<Linear> {
        let tracks = self.tracks(point);
        if tracks.len() < self.conditions.len() {
            return None;
        }
        let moved = self.moved(point, &tracks);
        let mut runs = Vec::new();
        let (mut residuals, mut columns) = (Vec::new(), vec![Vec::new(); moved.len()]);
        for curve in self.fitted() {
            let condition = self.condition_of[curve];
            let data = &self.selection.curves[curve];
            let contact_mm = self.contact(curve, &tracks[condition]);
            let compared = compare(data, &tracks[condition], contact_mm);
            let every = data.force_n.len().div_ceil(MOST_SAMPLES).max(1);
            let samples: Vec<usize> = (0..data.force_n.len()).step_by(every).collect();
            let weight = |at: &usize| self.root_weight(curve, compared.residual_n[*at]) * (every as f64).sqrt();
            let weights: Vec<f64> = samples.iter().map(weight).collect();
            let by_contact = samples.iter().zip(&weights).map(|(at, w)| w * compared.by_contact[*at]);
            let mut touch = DVector::from_iterator(samples.len(), by_contact);
            let unsure = data.unsure.at(samples.iter().copied(), every).scaled(1.0 / self.variance_n2(curve));
            unsure.whiten(touch.as_mut_slice(), 1.0);
            let length = touch.norm();
            let touch = if length > 0.0 { touch / length } else { touch };
            let run =
                LinearRun { curve, samples, contact_mm, values: self.values(condition, point), weights, touch, unsure };
            let of = |all: &[f64]| run.whitened(run.samples.iter().map(|at| all[*at])).data.as_vec().clone();
            residuals.extend(of(&compared.residual_n));
            for ((low, high, width), column) in moved.iter().zip(&mut columns) {
                let low = forces(data, &low[condition], contact_mm);
                let high = forces(data, &high[condition], contact_mm);
                let slope: Vec<f64> = low.iter().zip(&high).map(|(l, h)| (h - l) / width).collect();
                column.extend(of(&slope));
            }
            runs.push(run);
        }
        let columns: Vec<DVector<f64>> = columns.into_iter().map(DVector::from_vec).collect();
        (!columns.is_empty()).then(|| Linear {
            runs,
            kinds: self.unknowns.iter().map(|u| u.kind).collect(),
            jacobian: DMatrix::from_columns(&columns),
            residual: DVector::from_vec(residuals),
        })
    }
}
