//! Clean twins of an experiment: what noise alone makes of its margins, and of the errors of a fit.

use nalgebra::DMatrix;
use rayon::prelude::*;

use super::evidence::{self, Adequacy, Panel};
use super::fit::Fit;
use super::margin::{self, Margin};
use super::noise::{self, SensorNoise};
use super::search::Search;

/// Residuals that noise alone would leave, and what margins measure in them.
#[derive(Debug)]
pub struct Twins {
    /// Whitened residuals, one a column.
    pub draws: DMatrix<f64>,
    /// Margins.
    pub margins: Vec<Margin>,
    /// What they measure in the draws.
    panel: Panel,
}

impl Twins {
    /// Of the data of a search, in its noise.
    #[must_use]
    pub fn of(search: &Search<'_>) -> Self {
        let Search { problem, noise, curves, .. } = search;
        let margins = margin::margins(problem, curves);
        let plausible = noise::plausible(problem.design, curves, noise);
        let colours = |(weight, sensor): &(f64, SensorNoise)| {
            problem.whitening.colours(problem.design, curves, sensor).map(|colours| (*weight, colours))
        };
        let plausible: Vec<_> = plausible.par_iter().filter_map(colours).collect();
        let draws = evidence::twins(&problem.whitening, noise, &plausible, &problem.used, evidence::TWINS);
        let panel = Panel::new(&margins, &draws);
        Self { draws, margins, panel }
    }

    /// Whether a fit leaves more than noise, where its effects may be `wrong` by some columns.
    #[must_use]
    pub fn adequacy(&self, fit: &Fit, wrong: &DMatrix<f64>) -> Adequacy {
        Adequacy::of(fit, &self.margins, &self.panel, wrong, &self.draws)
    }
}
