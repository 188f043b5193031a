//! Plain best fits: least squares on the forces as they were measured, with nothing else free than the base and the contact points.
//!
//! Every sample counts the same, whatever the noise is thought to be. The verdict's fits weigh residuals by a noise that holds gains and zeros of spots, and by
//! one that may have been told about an effect: they decide, but what they leave in newtons is not what a user's own fit would leave. These do.

use lut_gen::chain::{Chain, Model, Setting};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::coordinate::Coordinate;
use super::design::{Design, Node, Series};
use super::fit::predicted;
use crate::infer::descent::{Descent, Evaluated, Region, Residuals, Rule, minimise};
use crate::infer::rows::Mask;

/// Exponents that a search begins with: as many as fill their range evenly in the logarithm.
const ALPHAS: [f64; 5] = [2.4, 4.2, 7.0, 12.0, 20.0];
/// Farthest that a contact point lies from a recorded zero that was meant to be it, mm: as far as force models reach beyond it.
const MEANT_MM: f64 = 0.25;
/// The same where the zero is the mean contact of all runs.
const OTHER_MM: f64 = 1.0;
/// Steps of difference quotients: of the logarithms, and of contact points (mm).
const STEP: f64 = 1e-4;
/// Where `mu`, `alpha` and the first contact point stand in a point.
const MU: usize = 0;
const ALPHA: usize = 1;
const CONTACTS: usize = 2;

/// The rows that are meant.
pub type Meant<'a> = &'a (dyn Fn(&Series, &Node) -> bool + Sync);

/// A plain best fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Plain {
    /// `mu` (MPa) and `alpha` at their best, effects as they were given.
    pub model: Model,
    /// Contact point of every spot, mm below the recorded zero.
    pub contacts_mm: Vec<f64>,
    /// Root mean square of what is left of the samples that were fitted, N.
    pub rmse_n: f64,
}

impl Plain {
    /// Where it lies, as a search has it.
    fn point(&self) -> Vec<f64> {
        let base = [self.model.mu_mpa.ln(), self.model.alpha.ln()];
        base.into_iter().chain(self.contacts_mm.iter().copied()).collect()
    }
}

/// What is fitted: the paths of an experiment, and effects that stay as they are.
#[derive(Debug, Clone, Copy)]
pub struct Plainly<'a> {
    /// The data.
    pub design: &'a Design,
    /// The model.
    pub chain: &'a Chain,
    /// A model whose effects stay as they are, with what finite elements add to it; its `mu` and `alpha` are a start.
    pub with: &'a Model,
}

impl<'a> Plainly<'a> {
    /// Fits every run but those that are held out.
    #[must_use]
    pub fn best(&self) -> Plain {
        self.best_of(&|series, _| !series.hold_out)
    }

    /// The model with `mu` and `alpha` at their best near those that are given, the sum of squares that it leaves,
    /// N2, and the number of samples. Every contact point lies at the recorded zero, or, where that was not
    /// the contact, at one that all share.
    #[must_use]
    pub fn base_near(&self) -> (Model, f64, f64) {
        let rows = Counted::of(self.design, &|series, _| !series.hold_out);
        let mut start = self.start(&rows, self.with.alpha);
        start.truncate(CONTACTS + 1);
        let free = if self.design.zero_is_contact { Free::Base } else { Free::All };
        let end = self.searched(&rows, &start, free).x;
        (self.model(&end), self.residual(&rows, &end).norm_squared(), rows.samples)
    }

    /// Fits the rows that are meant; the others are removed. The least of searches from several exponents.
    #[must_use]
    pub fn best_of(&self, meant: Meant<'_>) -> Plain {
        let rows = Counted::of(self.design, meant);
        let alphas: Vec<f64> = std::iter::once(self.with.alpha).chain(ALPHAS).collect();
        let ends = alphas.par_iter().map(|alpha| self.searched(&rows, &self.start(&rows, *alpha), Free::All));
        let ends: Vec<_> = ends.collect();
        let best = ends.into_iter().min_by(|a, b| a.value.total_cmp(&b.value));
        best.map_or_else(|| self.told(&rows, &self.start(&rows, self.with.alpha)), |end| self.told(&rows, &end.x))
    }

    /// What a fit leaves of rows that it need not have seen, N2 summed over their samples, and the number of these. Their contact points are at their best: they belong to a run, not to
    /// the model.
    #[must_use]
    pub fn left(&self, fit: &Plain, meant: Meant<'_>) -> (f64, f64) {
        let rows = Counted::of(self.design, meant);
        (self.searched(&rows, &fit.point(), Free::Contacts).value, rows.samples)
    }

    /// The same with the contact points that the fit found.
    #[must_use]
    pub fn left_there(&self, fit: &Plain, meant: Meant<'_>) -> (f64, f64) {
        let rows = Counted::of(self.design, meant);
        (self.residual(&rows, &fit.point()).norm_squared(), rows.samples)
    }

    /// Contact points of every run, mm.
    #[must_use]
    pub fn contacts_of_runs(&self, fit: &Plain) -> Vec<f64> {
        self.design.series.iter().map(|s| fit.contacts_mm[s.spot]).collect()
    }

    /// A model with the effects that stay.
    fn model(&self, at: &[f64]) -> Model {
        Model { mu_mpa: at[MU].exp(), alpha: at[ALPHA].exp(), ..self.with.clone() }
    }

    /// An exponent with contacts at the recorded zero and the modulus whose largest forces are those that were measured.
    fn start(&self, rows: &Counted, alpha: f64) -> Vec<f64> {
        let mut at = vec![0.0; CONTACTS + self.design.spots];
        (at[MU], at[ALPHA]) = (self.with.mu_mpa.ln(), alpha.ln());
        let force = rows.measured(self.design) - self.residual(rows, &at);
        let share = rows.measured(self.design).dot(&force) / force.norm_squared();
        if share.is_finite() && share > 0.0 {
            at[MU] += share.ln();
        }
        at
    }

    /// Measured less predicted, N, times the square root of the samples of a row.
    fn residual(&self, rows: &Counted, at: &[f64]) -> DVector<f64> {
        let contacts: Vec<f64> = self.design.series.iter().map(|s| at[contact_of(at, s.spot)]).collect();
        let forces = predicted(self.design, self.chain, &self.model(at), &contacts).concat();
        rows.measured(self.design) - rows.weighed(&DVector::from_vec(forces))
    }

    /// Derivative of the weighed prediction. Contacts of different spots move different rows: one step moves them all.
    fn jacobian(&self, rows: &Counted, at: &[f64], here: &DVector<f64>) -> DMatrix<f64> {
        let moved = |j: usize| {
            let mut there = at.to_vec();
            match j {
                CONTACTS => there[CONTACTS..].iter_mut().for_each(|contact| *contact += STEP),
                j => there[j] += STEP,
            }
            (here - self.residual(rows, &there)) / STEP
        };
        let columns: Vec<DVector<f64>> = (0..=CONTACTS).into_par_iter().map(moved).collect();
        DMatrix::from_fn(rows.mask.count(), at.len(), |i, j| match j {
            MU | ALPHA => columns[j][i],
            contact if contact_of(at, rows.spots[i]) == contact => columns[CONTACTS][i],
            _ => 0.0,
        })
    }

    fn searched(&self, rows: &Counted, start: &[f64], free: Free) -> Descent<Evaluated> {
        let objective = Residuals {
            residual: |at: &[f64]| self.residual(rows, at),
            jacobian: |at: &[f64], here: &DVector<f64>| self.jacobian(rows, at, here),
        };
        minimise(&objective, &self.region(rows, start, free), start, &Rule { most_steps: 60, ..Rule::default() })
    }

    fn region(&self, rows: &Counted, start: &[f64], free: Free) -> Region {
        let reach_mm = if self.design.zero_is_contact { MEANT_MM } else { OTHER_MM };
        let ends = (0..start.len()).map(|j| match (j, free) {
            (MU, Free::All | Free::Base) => Coordinate::LnMu.bounds(),
            (ALPHA, Free::All | Free::Base) => Coordinate::LnAlpha.bounds(),
            (MU | ALPHA, Free::Contacts) => (start[j], start[j]),
            (_, Free::Base) => (start[j], start[j]),
            // what no row tells of stays where it is
            _ if !rows.spots.iter().any(|spot| contact_of(start, *spot) == j) => (start[j], start[j]),
            _ => (-reach_mm, reach_mm),
        });
        Region::of(ends)
    }

    fn told(&self, rows: &Counted, at: &[f64]) -> Plain {
        let square = self.residual(rows, at).norm_squared();
        Plain {
            model: self.model(at),
            contacts_mm: at[CONTACTS..].to_vec(),
            rmse_n: (square / rows.samples.max(1.0)).sqrt(),
        }
    }
}

/// Where the contact point of a spot stands in a point that has one for each spot, or one for all.
fn contact_of(at: &[f64], spot: usize) -> usize {
    if at.len() == CONTACTS + 1 { CONTACTS } else { CONTACTS + spot }
}

/// The base alone, to begin with.
#[must_use]
pub fn base_of(design: &Design) -> Model {
    Model::base(0.05 * design.largest_n().max(1e-6), ALPHAS[2])
}

/// An effect or two that stay as they are, without the base.
#[must_use]
pub fn with(design: &Design, settings: &[Setting]) -> Model {
    Model { settings: settings.to_vec(), ..base_of(design) }
}

/// What a search moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Free {
    /// Base and contact points.
    All,
    /// The base.
    Base,
    /// Contact points.
    Contacts,
}

/// Rows that are fitted.
struct Counted {
    mask: Mask,
    /// Square root of the samples that each is the mean of.
    weights: DVector<f64>,
    /// Spot of each.
    spots: Vec<usize>,
    /// Samples of all.
    samples: f64,
}

impl Counted {
    fn of(design: &Design, meant: Meant<'_>) -> Self {
        let nodes = || design.series.iter().flat_map(|s| s.nodes.iter().map(move |n| (s, n)));
        let flags: Vec<bool> = nodes().map(|(s, n)| meant(s, n) && !n.lifted).collect();
        let used = || nodes().zip(&flags).filter(|(_, used)| **used).map(|(row, _)| row);
        let samples = || used().map(|(_, n)| n.samples.max(1) as f64);
        Self {
            weights: DVector::from_vec(samples().map(f64::sqrt).collect()),
            spots: used().map(|(s, _)| s.spot).collect(),
            samples: samples().sum(),
            mask: Mask::of(&flags),
        }
    }

    fn weighed(&self, values: &DVector<f64>) -> DVector<f64> {
        self.mask.pick(values).component_mul(&self.weights)
    }

    fn measured(&self, design: &Design) -> DVector<f64> {
        let forces: Vec<f64> = design.series.iter().flat_map(|s| s.nodes.iter().map(|n| n.force_n)).collect();
        self.weighed(&DVector::from_vec(forces))
    }
}
