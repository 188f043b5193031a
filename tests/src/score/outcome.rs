//! How good an answer is.

use palpate::diagnose::{Finding, Verdict};

use crate::hidden::{Truth, What};

use super::{Answer, strength};

/// How good an answer is, from the kind of truth.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Outcome {
    /// Nothing there, nothing said.
    CleanRight,
    /// Nothing there, something said.
    FalseAlarm,
    /// The right name and no other.
    Exact,
    /// Nothing said of what this design cannot see.
    SilentRight,
    /// One set of names with the right one in it.
    InSet,
    /// Nothing said of what can be seen.
    Missed,
    /// "Unknown", of an effect of the catalogue.
    Unknown,
    /// A name, or a set, that is not the truth's: the worst.
    Wrong,
    /// "Unknown", of what is not in the catalogue: right.
    OutsideUnknown,
    /// Nothing said of what is not in the catalogue.
    OutsideClean,
    /// What is not in the catalogue was given the name of the entry that has its cause in another form.
    OtherForm,
    /// Both of a pair named, or in sets.
    Both,
    /// One of a pair named, or in a set, and nothing wrong.
    One,
    /// None of a pair named.
    Neither,
    /// No diagnosis was made.
    Refused,
}

/// Entries of the catalogue that have the cause of an effect outside of it in another form: a fractional power law is relaxation;
/// a permanent set stands in the catalogue's row of softening (DIAGNOSIS.md: "Mullins, permanent set").
const OTHER_FORMS: [(&str, &str); 2] = [("outside-power-law", "relaxation"), ("outside-plastic-set", "softening")];

impl Outcome {
    /// The outcome for a truth of which each effect moves the data by `strength` standard deviations.
    #[must_use]
    pub fn of(truth: &Truth, strength: Option<&[f64]>, answer: &Answer) -> Self {
        if matches!(answer.verdict, Verdict::Refused | Verdict::TooFewData) {
            return Self::Refused;
        }
        let visible = strength.is_some_and(|s| s.iter().any(|s| *s > strength::SEEN));
        let silent = answer.verdict == Verdict::Clean;
        match &truth.what {
            What::Clean if silent => Self::CleanRight,
            What::Clean => Self::FalseAlarm,
            What::Placebo(_) | What::Deleted(..) | What::Outside(..) if silent => Self::OutsideClean,
            What::Placebo(_) | What::Deleted(..) | What::Outside(..) if answer.verdict == Verdict::Unknown => {
                Self::OutsideUnknown
            }
            What::Outside(code, _) if other_form(code, &answer.findings) => Self::OtherForm,
            What::Placebo(_) | What::Deleted(..) | What::Outside(..) => Self::Wrong,
            What::Catalogue(..) if silent && visible => Self::Missed,
            What::Catalogue(..) if silent => Self::SilentRight,
            What::Catalogue(..) if answer.verdict == Verdict::Unknown => Self::Unknown,
            What::Catalogue(code, _) => named(code, &answer.findings),
            What::Pair(codes, _) => pair(*codes, &answer.findings),
        }
    }

    /// True where nothing better can be said.
    #[must_use]
    pub fn is_right(self) -> bool {
        matches!(
            self,
            Self::CleanRight
                | Self::Exact
                | Self::SilentRight
                | Self::InSet
                | Self::OutsideUnknown
                | Self::OtherForm
                | Self::Both
        )
    }

    /// True where something is said that is not so.
    #[must_use]
    pub fn is_wrong(self) -> bool {
        matches!(self, Self::Wrong | Self::FalseAlarm)
    }

    /// The word in tables.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::CleanRight => "clean",
            Self::FalseAlarm => "false alarm",
            Self::Exact => "exact",
            Self::SilentRight => "silent, rightly",
            Self::InSet => "in set",
            Self::Missed => "missed",
            Self::Unknown => "unknown",
            Self::Wrong => "wrong name",
            Self::OutsideUnknown => "outside, unknown",
            Self::OutsideClean => "outside, clean",
            Self::OtherForm => "right cause, other form",
            Self::Both => "both",
            Self::One => "one of two",
            Self::Neither => "none of two",
            Self::Refused => "refused",
        }
    }
}

fn holds(finding: &Finding, code: &str) -> bool {
    finding.code == code || finding.ambiguous_with.contains(&code)
}

fn other_form(code: &str, findings: &[Finding]) -> bool {
    let form = OTHER_FORMS.iter().find(|(outside, _)| *outside == code);
    form.is_some_and(|(_, known)| !findings.is_empty() && findings.iter().all(|f| holds(f, known)))
}

fn named(code: &str, findings: &[Finding]) -> Outcome {
    match findings {
        [one] if one.code == code && one.ambiguous_with.is_empty() => Outcome::Exact,
        [one] if holds(one, code) => Outcome::InSet,
        // a second name beside the right one is a wrong name as well
        _ => Outcome::Wrong,
    }
}

fn pair(codes: [&str; 2], findings: &[Finding]) -> Outcome {
    let [a, b] = codes;
    match findings {
        [] => Outcome::Neither,
        [one] if holds(one, a) || holds(one, b) => Outcome::One,
        [x, y] if (holds(x, a) && holds(y, b)) || (holds(x, b) && holds(y, a)) => Outcome::Both,
        _ => Outcome::Wrong,
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use crate::hidden::{Case, Design};

    fn finding(set: &[&'static str]) -> Finding {
        let parameters = Vec::new();
        Finding {
            code: set[0],
            form: "",
            kind: lut_gen::effect::Kind::Machine,
            owner: 0,
            of: Vec::new(),
            parameters,
            ambiguous_with: set[1..].to_vec(),
            probability: 1.0,
            explains: None,
        }
    }

    fn answer(sets: &[&[&'static str]]) -> Answer {
        let findings: Vec<Finding> = sets.iter().map(|set| finding(set)).collect();
        let verdict =
            if findings.iter().any(|f| !f.ambiguous_with.is_empty()) { Verdict::Ambiguous } else { Verdict::Named };
        Answer {
            verdict,
            findings,
            shows_in: Vec::new(),
            blind_to: Vec::new(),
            reason: None,
            rests_on_priors: false,
            seconds: 0.0,
        }
    }

    fn said(verdict: Verdict) -> Answer {
        Answer { verdict, ..answer(&[]) }
    }

    fn truth(what: What) -> Truth {
        Case::new(Design::D36, 1).hiding(what).truth()
    }

    fn score(what: What, strength: &[f64], answer: &Answer) -> Outcome {
        Outcome::of(&truth(what), Some(strength), answer)
    }

    #[test]
    fn one_effect_is_exact_in_a_set_or_wrong() {
        let lag = What::Catalogue("lag", 3);
        let cases: [(&[&[&'static str]], Outcome); 5] = [
            (&[&["lag"]], Outcome::Exact),
            (&[&["drift", "lag"]], Outcome::InSet),
            (&[&["drift"]], Outcome::Wrong),
            (&[&["drift", "friction"]], Outcome::Wrong),
            (&[&["lag"], &["drift"]], Outcome::Wrong),
        ];
        for (sets, outcome) in cases {
            // whether it can be seen or not
            assert_eq!(score(lag.clone(), &[9.0], &answer(sets)), outcome, "{sets:?}");
            assert_eq!(score(lag.clone(), &[0.5], &answer(sets)), outcome, "{sets:?}");
        }
        assert_eq!(score(lag.clone(), &[9.0], &said(Verdict::Clean)), Outcome::Missed);
        assert_eq!(score(lag.clone(), &[0.5], &said(Verdict::Clean)), Outcome::SilentRight);
        assert_eq!(score(lag.clone(), &[0.5], &said(Verdict::Unknown)), Outcome::Unknown);
        assert_eq!(score(lag, &[9.0], &said(Verdict::Refused)), Outcome::Refused);
    }

    #[test]
    fn anything_said_of_nothing_is_an_alarm() {
        assert_eq!(score(What::Clean, &[], &said(Verdict::Clean)), Outcome::CleanRight);
        assert_eq!(score(What::Clean, &[], &said(Verdict::Unknown)), Outcome::FalseAlarm);
        assert_eq!(score(What::Clean, &[], &answer(&[&["lag"]])), Outcome::FalseAlarm);
    }

    #[test]
    fn what_is_outside_has_no_name_but_that_of_its_cause() {
        let law = What::Outside("outside-power-law", 4);
        assert_eq!(score(law.clone(), &[50.0], &said(Verdict::Unknown)), Outcome::OutsideUnknown);
        assert_eq!(score(law.clone(), &[50.0], &said(Verdict::Clean)), Outcome::OutsideClean);
        assert_eq!(score(law.clone(), &[50.0], &answer(&[&["relaxation"]])), Outcome::OtherForm);
        assert_eq!(score(law.clone(), &[50.0], &answer(&[&["relaxation"], &["lag"]])), Outcome::Wrong);
        assert_eq!(score(law, &[50.0], &answer(&[&["friction"]])), Outcome::Wrong);
        assert_eq!(score(What::Outside("outside-tilt", 4), &[50.0], &answer(&[&["thickness"]])), Outcome::Wrong);
        let placebo = What::Placebo(palpate::simulate::Variable::Depth);
        assert_eq!(score(placebo.clone(), &[50.0], &answer(&[&["relaxation"]])), Outcome::Wrong);
        assert_eq!(score(placebo, &[50.0], &said(Verdict::Unknown)), Outcome::OutsideUnknown);
    }

    #[test]
    fn of_two_effects_both_one_or_none_are_found() {
        let two = What::Pair(["relaxation", "drift"], 4);
        let cases: [(&[&[&'static str]], Outcome); 6] = [
            (&[&["drift"], &["relaxation"]], Outcome::Both),
            (&[&["softening", "drift"], &["relaxation", "sensor-creep"]], Outcome::Both),
            (&[&["relaxation"]], Outcome::One),
            (&[&["friction"]], Outcome::Wrong),
            // one set cannot stand for both
            (&[&["relaxation", "drift"], &["lag"]], Outcome::Wrong),
            (&[&["relaxation"], &["drift"], &["lag"]], Outcome::Wrong),
        ];
        for (sets, outcome) in cases {
            assert_eq!(score(two.clone(), &[9.0, 9.0], &answer(sets)), outcome, "{sets:?}");
        }
        assert_eq!(score(two, &[9.0, 9.0], &said(Verdict::Unknown)), Outcome::Neither);
    }
}
