//! What is said of an experiment: its verdict, and what was found.

use lut_gen::effect::Kind;

/// The stable word of an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// No discrepancy is visible.
    Clean,
    /// One effect, or several, each with one name.
    Named,
    /// At least one effect has several names that this design cannot tell apart.
    Ambiguous,
    /// A discrepancy is visible and no name holds.
    Unknown,
    /// No run can be used.
    TooFewData,
    /// Nothing can be said, and the reason is given.
    Refused,
}

impl Verdict {
    /// The word in answers.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Verdict::Clean => "clean",
            Verdict::Named => "named",
            Verdict::Ambiguous => "ambiguous",
            Verdict::Unknown => "unknown",
            Verdict::TooFewData => "too-few-data",
            Verdict::Refused => "refused",
        }
    }
}

/// One effect, or a set of names that stands for it.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// Code of the likeliest name.
    pub code: &'static str,
    /// Which of its forms.
    pub form: &'static str,
    /// What kind of thing it is.
    pub kind: Kind,
    /// Ball or specimen that it belongs to.
    pub owner: usize,
    /// Names of the balls or specimens that it may belong to, the likeliest first; empty where it belongs to all.
    pub of: Vec<String>,
    /// Parameters: name, value, 95 % interval.
    pub parameters: Vec<(&'static str, f64, (f64, f64))>,
    /// Other names that this design cannot tell from it.
    pub ambiguous_with: Vec<&'static str>,
    /// Probability that it is there, over all sets that were weighed.
    pub probability: f64,
    /// Share of the misfit that goes without it; none where the base takes the misfit up.
    pub explains: Option<f64>,
}
