//! What these runs say of each parameter: identified, only in combination with others, or nothing.

use nalgebra::DMatrix;

use crate::infer::covariance::covariance;

/// What can be said of a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standing {
    /// Its interval is closed by the data on both sides, and narrow against what it could be.
    Identified,
    /// Known only together with others.
    InCombination,
    /// These runs do not show it.
    NotIdentifiable,
}

impl Standing {
    /// The word in the answer.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Standing::Identified => "identified",
            Standing::InCombination => "in-combination",
            Standing::NotIdentifiable => "not-identifiable",
        }
    }
}

/// A parameter's standing with the sentence that explains it.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    /// What can be said.
    pub standing: Standing,
    /// In words.
    pub sentence: String,
    /// The parameters it is tied to: indices.
    pub tied_to: Vec<usize>,
}

/// What is judged: name, shown value, and the coordinate with its interval and range.
#[derive(Debug, Clone, PartialEq)]
pub struct Judged {
    /// Name in the answer.
    pub name: String,
    /// Length of the range.
    pub range: f64,
    /// Length of the 95 % interval.
    pub interval: f64,
    /// The interval goes on beyond the lower bound of the search.
    pub open_low: bool,
    /// The same above.
    pub open_high: bool,
    /// The estimate itself stands on a bound of its search.
    pub at_bound: bool,
    /// A logarithmic coordinate.
    pub logarithmic: bool,
}

/// An interval longer than this share of the range tells nothing about a parameter counted by differences.
const WIDE_SHARE: f64 = 0.5;
/// And so does one over a factor larger than this, of a parameter counted by ratios.
const WIDE_FACTOR: f64 = 3.0;
/// Tied: alone it would be known this many times better.
const TIED: f64 = 3.0;
/// Part of the direction along which a tied parameter moves that makes another one a partner.
const PARTNER: f64 = 0.5;

/// Judges all parameters from the Hessian of the fit.
#[must_use]
pub fn judge(hessian: &DMatrix<f64>, parameters: &[Judged]) -> Vec<Verdict> {
    let covariance = covariance(hessian);
    (0..parameters.len()).map(|at| one(hessian, covariance.as_ref(), parameters, at)).collect()
}

fn one(hessian: &DMatrix<f64>, covariance: Option<&DMatrix<f64>>, parameters: &[Judged], at: usize) -> Verdict {
    let own = &parameters[at];
    let wide = if own.logarithmic { own.interval > WIDE_FACTOR.ln() } else { own.interval > WIDE_SHARE * own.range };
    let open = own.open_low || own.open_high || own.at_bound;
    // Were all others known, the standard error would be this.
    let alone = 1.0 / hessian[(at, at)].max(f64::MIN_POSITIVE).sqrt();
    let alone_wide =
        if own.logarithmic { 3.92 * alone > WIDE_FACTOR.ln() } else { 3.92 * alone > WIDE_SHARE * own.range };
    let tied_to = partners(hessian, covariance, parameters, at);
    let names: Vec<&str> = tied_to.iter().map(|at| parameters[*at].name.as_str()).collect();
    let (standing, sentence) = if !wide && open {
        (Standing::NotIdentifiable, one_sided(own))
    } else if !wide {
        let together =
            if tied_to.is_empty() { String::new() } else { format!("; its error moves with {}", names.join(" and ")) };
        (Standing::Identified, format!("{} is identified{together}", own.name))
    } else if alone_wide || tied_to.is_empty() {
        let sentence = format!("{} is not identifiable from these runs: their forces hardly change with it", own.name);
        (Standing::NotIdentifiable, sentence)
    } else {
        let sentence = format!(
            "{} is known only in combination with {}: a change of one can be undone by the other",
            own.name,
            names.join(" and ")
        );
        (Standing::InCombination, sentence)
    };
    Verdict { standing, sentence, tied_to }
}

/// What is said of a narrow interval that a bound of the search ends, not the data.
fn one_sided(own: &Judged) -> String {
    let says = match (own.open_low, own.open_high) {
        (true, false) => "these runs only say that it is no larger than its interval",
        (false, true) => "these runs only say that it is no smaller than its interval",
        _ => "a bound of its search decides, not these runs",
    };
    format!("{} is not identified: {says}", own.name)
}

/// The parameters that move with this one when it moves by its own standard error, if it is known much worse than it were alone.
fn partners(hessian: &DMatrix<f64>, covariance: Option<&DMatrix<f64>>, parameters: &[Judged], at: usize) -> Vec<usize> {
    let others = || (0..parameters.len()).filter(move |other| *other != at);
    let Some(covariance) = covariance else {
        // Exactly tied: those whose signatures are parallel.
        let parallel = |other: &usize| {
            let norm = (hessian[(at, at)] * hessian[(*other, *other)]).sqrt();
            norm > 0.0 && (hessian[(at, *other)] / norm).abs() > 0.99
        };
        return others().filter(parallel).collect();
    };
    let (error, alone) = (covariance[(at, at)].max(0.0).sqrt(), 1.0 / hessian[(at, at)].max(f64::MIN_POSITIVE).sqrt());
    if error < TIED * alone {
        return Vec::new();
    }
    let correlation = |other: usize| {
        let norm = error * covariance[(other, other)].max(0.0).sqrt();
        if norm > 0.0 { covariance[(at, other)] / norm } else { 0.0 }
    };
    others().filter(|other| correlation(*other).abs() > PARTNER).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judged(name: &str, interval: f64) -> Judged {
        Judged {
            name: name.to_owned(),
            range: 1.0,
            interval,
            open_low: false,
            open_high: false,
            at_bound: false,
            logarithmic: false,
        }
    }

    #[test]
    fn a_narrow_a_tied_and_a_mute_parameter_are_told_apart() {
        // The first stands alone; second and third are nearly parallel; the fourth shows nothing.
        let h = DMatrix::from_row_slice(
            4,
            4,
            &[1e4, 0.0, 0.0, 0.0, 0.0, 1e4, 9999.0, 0.0, 0.0, 9999.0, 1e4, 0.0, 0.0, 0.0, 0.0, 1e-2],
        );
        let all = [judged("a", 0.04), judged("b", 0.9), judged("c", 0.9), judged("d", 1.0)];
        let verdicts = judge(&h, &all);
        assert_eq!(verdicts[0].sentence, "a is identified");
        assert_eq!(
            verdicts[1].sentence,
            "b is known only in combination with c: a change of one can be undone by the other"
        );
        assert_eq!(verdicts[1].tied_to, [2]);
        assert_eq!(verdicts[2].standing, Standing::InCombination);
        // A bound that ends a narrow interval identifies nothing.
        let on_bound = [Judged { at_bound: true, ..judged("a", 0.04) }, Judged { open_low: true, ..judged("a", 0.04) }];
        for one in on_bound {
            let verdict = judge(&DMatrix::from_element(1, 1, 1e4), &[one]).remove(0);
            assert_eq!(verdict.standing, Standing::NotIdentifiable, "{verdict:?}");
        }
        assert_eq!(verdicts[3].sentence, "d is not identifiable from these runs: their forces hardly change with it");
    }
}
