//! What an oracle that is told the effect would gain.

use lut_gen::chain::Chain;
use nalgebra::DVector;
use palpate::diagnose::coordinate::Candidate;
use palpate::diagnose::fit::{Fit, Problem, predicted};
use palpate::diagnose::sets::Weighed;
use palpate::diagnose::{Diagnosis, Evidence, Models, Prepared, Verdict};
use palpate::experiment::Experiment;
use rayon::prelude::*;

use crate::hidden::Truth;

/// Root mean square errors on left-out conditions, N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gain {
    /// With the base.
    pub before_n: f64,
    /// With what was found; the base where nothing was.
    pub found_n: f64,
    /// With the effects that are true, fitted.
    pub oracle_n: f64,
}

impl Gain {
    /// Share of the oracle's fall of the error; `None` where the oracle gains less than a twentieth.
    #[must_use]
    pub fn share(&self) -> Option<f64> {
        let whole = self.before_n - self.oracle_n;
        (whole > 0.05 * self.before_n).then(|| (self.before_n - self.found_n) / whole)
    }
}

/// Held-out errors of the base, of what was found, and of an oracle that is told which effects are true (in the form that fits best) and fits
/// their parameters; `None` where nothing shows, or where an effect is not in the catalogue.
#[must_use]
pub fn gain(truth: &Truth, diagnosis: &Diagnosis, experiment: &Experiment, models: &Models) -> Option<Gain> {
    let evidence = diagnosis.evidence.as_deref()?;
    let codes = truth.codes();
    let told: Vec<&Weighed> = codes.iter().map(|code| alone(evidence, code)).collect::<Option<_>>()?;
    if told.is_empty() || diagnosis.verdict == Verdict::Clean {
        return None;
    }
    let known = evidence.held_out.as_ref();
    if let ([only], Some(held_out), [alone]) = (told.as_slice(), known, evidence.held.as_slice())
        && alone.fit.candidates == only.fit.candidates
    {
        // the oracle would fit the same
        let after = held_out.rmse_after_n;
        return Some(Gain { before_n: held_out.rmse_before_n, found_n: after, oracle_n: after });
    }
    let library = models.of(&evidence.design.geometries, &|_, _| {}).ok()?;
    let chain = Chain { library, passages: evidence.design.passages() };
    let prepared = Prepared::new(&evidence.design, &chain, experiment.sensor.noise_n)?;
    let (before_n, oracle_n) = left_out(&prepared, &start(&told)?)?;
    let named = matches!(diagnosis.verdict, Verdict::Named | Verdict::Ambiguous);
    let found_n = known.filter(|_| named).map_or(before_n, |h| h.rmse_after_n);
    Some(Gain { before_n, found_n, oracle_n })
}

/// The likeliest set of one effect alone.
fn alone<'a>(evidence: &'a Evidence, code: &str) -> Option<&'a Weighed> {
    evidence.sets.iter().find(|set| matches!(&set.fit.candidates[..], [only] if only.effect.code == code))
}

/// The effects together, at the parameters that each has alone.
fn start(told: &[&Weighed]) -> Option<(Vec<Candidate>, DVector<f64>)> {
    let first: &Fit = &told.first()?.fit;
    let mut candidates = first.candidates.clone();
    let mut x: Vec<f64> = first.x.iter().copied().collect();
    for other in &told[1..] {
        let own: usize = other.fit.candidates.iter().map(|c| c.effect.quantities.len()).sum();
        candidates.extend_from_slice(&other.fit.candidates);
        x.extend(other.fit.x.iter().skip(other.fit.x.len() - own));
    }
    Some((candidates, DVector::from_vec(x)))
}

/// Root mean square errors, N, of base and told effects over groups of conditions, each left out in turn.
fn left_out(prepared: &Prepared<'_>, told: &(Vec<Candidate>, DVector<f64>)) -> Option<(f64, f64)> {
    let whole = &prepared.problem;
    let design = whole.design;
    if design.groups < 2 {
        return None;
    }
    let each: Vec<[f64; 3]> = (0..design.groups)
        .into_par_iter()
        .map(|group| {
            let used = design.series.iter().flat_map(|s| vec![s.group != group; s.nodes.len()]).collect();
            let problem = Problem { used, ..whole.clone() };
            let fits = [problem.fit(&[], &prepared.base.x), problem.fit(&told.0, &told.1)];
            let [before, after] = fits.map(|fit| miss(whole, &fit, group));
            [before.0, after.0, before.1]
        })
        .collect();
    let sum = |at: usize| each.iter().map(|e| e[at]).sum::<f64>();
    Some(((sum(0) / sum(2)).sqrt(), (sum(1) / sum(2)).sqrt()))
}

/// Sum of squares, N^2, over a group, and its number of windows.
fn miss(problem: &Problem<'_>, fit: &Fit, group: usize) -> (f64, f64) {
    let curves = predicted(problem.design, problem.chain, &fit.model, &problem.contacts_mm);
    let own = problem.design.series.iter().zip(&curves).filter(|(s, _)| s.group == group);
    let pairs = own.flat_map(|(s, curve)| s.nodes.iter().zip(curve));
    pairs.fold((0.0, 0.0), |(sum, count), (node, force_n)| (sum + (node.force_n - force_n).powi(2), count + 1.0))
}
