//! Which part of a misfit is whose, without a diagnosis: what a plain fit of the base leaves of
//! exact forces, with and without some of what is in them.

use lut_gen::chain::{Chain, Model};
use nalgebra::DVector;
use palpate::diagnose::Models;
use palpate::diagnose::design::Design;
use palpate::diagnose::fit::{Problem, predicted};
use palpate::diagnose::noise::Curve;
use palpate::diagnose::whiten::Whitening;
use palpate::simulate::{Noise, SimulatedExperiment, Solver, Spec, simulate};

use super::ScoreError;
use super::strength::{compared, foam, of_effects, shift, true_noise, with_forces};

/// Name of the material of every hidden experiment.
const MATERIAL: &str = "specimen";
/// White noise that a plain fit stands in, of the largest force: so large that nothing else which a
/// diagnosis allows for counts beside it, and so small that a misfit of a thousandth is still
/// fitted to its end.
const WHITE: f64 = 0.03;
/// Jitter of the same, next to none.
const NO_JITTER: f64 = 1e-7;
/// Exponents that the base is fitted from, beside the truth.
const ALPHAS: [f64; 3] = [3.0, 7.0, 15.0];

/// What experiments are made and measured with.
#[derive(Debug, Clone, Copy)]
pub struct Yardstick<'a> {
    /// Finite elements of the generator.
    pub solver: &'a Solver,
    /// Force models of the base.
    pub models: &'a Models,
}

impl Yardstick<'_> {
    /// An experiment.
    ///
    /// # Errors
    /// A solve that fails.
    pub fn made(&self, spec: &Spec) -> Result<SimulatedExperiment, ScoreError> {
        Ok(simulate(spec, self.solver, &|_, _, _| {})?)
    }

    /// How misfits of experiments of a specification are measured, which has neither effects nor
    /// noise; `None` where no run of it could be used.
    ///
    /// # Errors
    /// A force model that cannot be made.
    pub fn misfits(&self, bare: &SimulatedExperiment) -> Result<Option<Misfits>, ScoreError> {
        let Ok(design) = Design::of(&bare.experiment(), MATERIAL) else { return Ok(None) };
        let library = self.models.of(&design.geometries, &|_, _| {})?;
        let chain = Chain { library, passages: design.passages() };
        let foam = foam(&bare.truth);
        let contacts_mm = vec![0.0; design.series.len()];
        let model = Model::base(foam.0, foam.1);
        let clean = predicted(&design, &chain, &model, &contacts_mm);
        let curves: Vec<Curve> = Problem::curves(&design, &chain, &model, &contacts_mm);
        let mut plain = bare.truth.clone();
        plain.noise = Noise {
            sensor_n: WHITE * design.largest_n(),
            contact_jitter_mm: NO_JITTER,
            gain_jitter: NO_JITTER,
            ..Noise::default()
        };
        let whitening = Whitening::new(&design, &curves, &true_noise(&plain, 0.0));
        let bare = bare.clone();
        Ok(whitening.map(|whitening| Misfits { bare, design, chain, clean, foam, whitening }))
    }

    /// How many standard deviations of the true noise, jitter included, the effects at these places
    /// of an experiment move its forces beyond the base; zeros where no run can be used.
    ///
    /// # Errors
    /// A solve without one of them that fails.
    pub fn strengths(&self, made: &SimulatedExperiment, wanted: &[usize]) -> Result<Vec<f64>, ScoreError> {
        let Ok(design) = Design::of(&made.experiment(), MATERIAL) else { return Ok(vec![0.0; wanted.len()]) };
        let each = of_effects(made, &design, (wanted, None), (self.models, self.solver))?;
        Ok(each.into_iter().map(|one| one.known).collect())
    }
}

/// Plain fits of the base to what is added to the forces of a clean specimen.
#[derive(Debug)]
pub struct Misfits {
    bare: SimulatedExperiment,
    design: Design,
    chain: Chain,
    clean: Vec<Vec<f64>>,
    foam: (f64, f64),
    whitening: Whitening,
}

impl Misfits {
    /// What an experiment has more than the bare one, N.
    #[must_use]
    pub fn shift(&self, made: &SimulatedExperiment) -> DVector<f64> {
        shift(&self.design, made, &self.bare)
    }

    /// Squared misfit (of no unit) of a clean specimen with a shift of its forces: what the base
    /// leaves with `mu` and `alpha` at their best and contacts where they are.
    #[must_use]
    pub fn left(&self, shift: &DVector<f64>) -> f64 {
        let data = with_forces(&self.design, &self.clean, shift);
        let problem = Problem {
            design: &data,
            chain: &self.chain,
            contacts_mm: vec![0.0; data.series.len()],
            back_n: DVector::zeros(shift.len()),
            whitening: self.whitening.clone(),
            used: compared(&self.design),
            whole: None,
        };
        let from = |alpha: f64| DVector::from_vec(vec![self.foam.0.ln(), alpha.ln()]);
        let starts: Vec<DVector<f64>> = std::iter::once(self.foam.1).chain(ALPHAS).map(from).collect();
        problem.best_of(&[], &starts).map_or(0.0, |fit| fit.square)
    }
}
