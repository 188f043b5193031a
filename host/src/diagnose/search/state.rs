//! What a search among effects works on.

use std::sync::OnceLock;

use nalgebra::DMatrix;

use crate::diagnose::coordinate::Candidate;
use crate::diagnose::evidence::{Adequacy, Panel, Spaces};
use crate::diagnose::fit::{Fit, Problem};
use crate::diagnose::margin::Margin;
use crate::diagnose::noise::{Curve, Noise};

/// Data, noise and base, with all that a search among effects needs of them.
#[derive(Debug, Clone)]
pub struct Search<'a> {
    /// Data and model.
    pub problem: Problem<'a>,
    /// The noise.
    pub noise: Noise,
    /// Fit of the base.
    pub base: Fit,
    /// What the base predicts.
    pub curves: Vec<Curve>,
    /// Margins.
    pub margins: Vec<Margin>,
    /// What they measure in clean twins.
    pub panel: Panel,
    /// Clean twins.
    pub twins: DMatrix<f64>,
    /// What the base leaves.
    pub adequacy: Adequacy,
    /// Candidates that this design could have.
    pub candidates: Vec<Candidate>,
    /// Signature of every candidate at the base fit; behind them that of an elastic departure without a name.
    pub signatures: Vec<DMatrix<f64>>,
    /// What they hold of clean twins.
    pub spaces: Spaces,
    /// Score of the likeliest power law of relaxation, once it is asked for.
    pub(super) spectral: OnceLock<f64>,
    /// The likeliest elastic departure without a name, once it is asked for.
    pub(super) elastic: OnceLock<Fit>,
}
