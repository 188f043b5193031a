//! Whether 95 % intervals hold the truth, where a parameter of an answer means what a parameter of the truth means.

use palpate::diagnose::{Diagnosis, Finding, Verdict};
use palpate::experiment::Experiment;
use palpate::simulate::Effect;

use crate::hidden::{Foam, Truth};

use super::outcome::Outcome;

/// One parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Hit {
    /// Its name; "mu_MPa" and "alpha" are those of the base.
    pub name: &'static str,
    /// True when the interval holds the truth.
    pub held: bool,
    /// The answer was right: nothing there and nothing said, or exactly the truth.
    pub right: bool,
    /// Estimate less truth, in standard errors; 1.96 of them lie on either side of an interval's middle.
    pub deviation: f64,
}

/// Half the width of a 95 % interval in standard errors.
const Z95: f64 = 1.96;

/// `mu` and `alpha` of every answer, those of the extended model where one is named, and the parameters of effects that are named exactly. A
/// wrong answer and a silent one have intervals too, and a user reads them.
#[must_use]
pub fn hits(truth: &Truth, outcome: &Outcome, diagnosis: &Diagnosis, experiment: &Experiment) -> Vec<Hit> {
    let exact = matches!(outcome, Outcome::Exact | Outcome::Both) && diagnosis.verdict == Verdict::Named;
    let mut list = of_foam(&truth.foam, diagnosis);
    for effect in truth.effects.iter().filter(|_| exact) {
        let own = diagnosis.findings.iter().filter(|f| f.code == effect.code() && same_owner(effect, f, experiment));
        for finding in own {
            for (name, value) in known(effect, finding.form) {
                let found = finding.parameters.iter().find(|(n, _, _)| *n == name);
                list.extend(found.and_then(|(_, estimate, interval)| hit(name, value, *estimate, *interval)));
            }
        }
    }
    let right = exact || *outcome == Outcome::CleanRight;
    list.iter_mut().for_each(|hit: &mut Hit| hit.right = right);
    list
}

/// `mu` and `alpha` of an answer: those of the extended model where one is named, of the base else.
#[must_use]
pub fn of_foam(foam: &Foam, diagnosis: &Diagnosis) -> Vec<Hit> {
    let Some(evidence) = diagnosis.evidence.as_deref() else { return Vec::new() };
    let named = matches!(diagnosis.verdict, Verdict::Named | Verdict::Ambiguous);
    let told = if named { evidence.extended() } else { Some(evidence.before.parameters) };
    let Some([mu, alpha]) = told else { return Vec::new() };
    let each = [("mu_MPa", foam.mu_mpa, mu), ("alpha", foam.alpha, alpha)];
    each.into_iter()
        .filter_map(|(name, truth, it)| hit(name, truth.ln(), it.0.ln(), (it.1.0.ln(), it.1.1.ln())))
        .collect()
}

fn hit(name: &'static str, truth: f64, estimate: f64, (low, high): (f64, f64)) -> Option<Hit> {
    let width = high - low;
    let deviation = (estimate - truth) / (width / (2.0 * Z95));
    (width > 0.0 && deviation.is_finite()).then(|| Hit {
        name,
        held: (low..=high).contains(&truth),
        right: false,
        deviation,
    })
}

fn same_owner(effect: &Effect, finding: &Finding, experiment: &Experiment) -> bool {
    match effect {
        Effect::Radius { indenter, .. } => experiment.indenters.get(finding.owner).is_some_and(|i| i.name == *indenter),
        _ => true,
    }
}

/// Parameters of a true effect under the names that the catalogue's form of it uses; empty where they mean something else.
fn known(effect: &Effect, form: &str) -> Vec<(&'static str, f64)> {
    match (effect, form) {
        (Effect::Relaxation(terms), "one-term") => match terms.as_slice() {
            // the catalogue's form relaxes shear and bulk alike
            [term] if term.g == term.k => vec![("g1", term.g), ("tau1_s", term.tau_s)],
            _ => Vec::new(),
        },
        (Effect::Poisson { nu }, _) => vec![("nu", *nu)],
        (Effect::SecondTerm { mu2_ratio, alpha2 }, _) => vec![("mu2_ratio", *mu2_ratio), ("alpha2", *alpha2)],
        (Effect::Softening { r, .. }, _) => vec![("loss", 1.0 / r)],
        (Effect::Thickness { height_error_mm }, "height") => vec![("height_error_mm", *height_error_mm)],
        (Effect::Friction { coefficient }, _) => vec![("coefficient", *coefficient)],
        (Effect::Adhesion { work_n_per_mm, .. }, _) => vec![("work_N_per_mm", *work_n_per_mm)],
        (Effect::ContactOffset { offset_mm }, _) => vec![("offset_mm", *offset_mm)],
        (Effect::Compliance { mm_per_n }, _) => vec![("mm_per_N", *mm_per_n)],
        (Effect::Radius { error_mm, .. }, _) => vec![("error_mm", *error_mm)],
        (Effect::Lag { lag_s }, "filter") => vec![("lag_s", *lag_s)],
        (Effect::RateLimit { rate_mm_s }, "rate-limit") => vec![("limit_s_per_mm", 1.0 / rate_mm_s)],
        (Effect::SensorGain { gain }, _) => vec![("gain", *gain)],
        (Effect::SensorNonlinearity { quadratic_per_n }, _) => vec![("quadratic_per_N", *quadratic_per_n)],
        (Effect::SensorCreep { amplitude, tau_s }, "creep") => vec![("amplitude", *amplitude), ("tau_s", *tau_s)],
        (Effect::SensorHysteresis { width }, "hysteresis") => vec![("width", *width)],
        (Effect::Drift { n_per_h, .. }, "linear") => vec![("N_per_h", *n_per_h)],
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use crate::hidden::{CATALOGUE, Case, Design, What};

    /// Every name stands in the catalogue's entry of that code and form, or nothing would ever be compared.
    #[test]
    fn names_are_those_of_the_catalogue() {
        let mut compared = Vec::new();
        for code in CATALOGUE {
            for seed in 0..12 {
                let effect = Case::new(Design::D36, seed).hiding(What::Catalogue(code, 4)).truth().effects.remove(0);
                for entry in lut_gen::effect::CATALOGUE.iter().filter(|e| e.code == code) {
                    for (name, _) in known(&effect, entry.form) {
                        assert!(entry.quantities.iter().any(|q| q.name == name), "{code} {}: {name}", entry.form);
                        compared.push(code);
                    }
                }
            }
        }
        compared.dedup();
        // an error of the simulation has no parameter in common with the mesh that makes it
        let never: Vec<&str> = CATALOGUE.iter().filter(|code| !compared.contains(code)).copied().collect();
        assert_eq!(never, ["numerics"]);
    }

    #[test]
    fn an_interval_holds_its_truth_or_not() {
        let inside = hit("nu", 0.1, 0.12, (0.08, 0.16)).unwrap();
        assert!(inside.held && (inside.deviation - 0.02 / (0.08 / 3.92)).abs() < 1e-12);
        assert!(!hit("nu", 0.2, 0.12, (0.08, 0.16)).unwrap().held);
        assert_eq!(hit("nu", 0.2, 0.2, (0.2, 0.2)), None);
        assert_eq!(hit("nu", 0.2, 0.2, (f64::NAN, 0.3)), None);
    }
}
