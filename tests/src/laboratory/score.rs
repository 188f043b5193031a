//! How good an answer about a world is.

use palpate::diagnose::{self, Finding, Verdict};

use super::{Kind, Made, Truth, What, World};
use crate::score::coverage::{self, Hit};
use crate::score::share::Yardstick;
use crate::score::{Answer, ScoreError};

/// Most names of a set that still tells something.
const MOST_NAMES: usize = 3;

/// What an answer counts as.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Mark {
    /// What dominates is named, alone or beside a minor effect that is truly there; of two, both;
    /// of nothing, no name.
    Right,
    /// What dominates stands in a set of at most three names; of two, each is named or in such a
    /// set.
    InSet,
    /// One of two, and nothing wrong.
    One,
    /// A discrepancy without a name, or in a set of more names.
    Unknown,
    /// Nothing is said.
    Silent,
    /// A minor effect that is truly there, and not what dominates.
    Minor,
    /// Outside the catalogue, a name of the right kind.
    RightKind,
    /// A name, or a set, that holds nothing that is truly there; of nothing, any name.
    Wrong,
    /// No diagnosis was made.
    Refused,
}

impl Mark {
    /// All, in the order of tables.
    pub const ALL: [Self; 9] = [
        Self::Right,
        Self::InSet,
        Self::One,
        Self::RightKind,
        Self::Minor,
        Self::Unknown,
        Self::Silent,
        Self::Wrong,
        Self::Refused,
    ];

    /// Of an answer.
    #[must_use]
    pub fn of(truth: &Truth, answer: &Answer) -> Self {
        match answer.verdict {
            Verdict::Refused | Verdict::TooFewData => return Self::Refused,
            _ if truth.what == What::Clean && answer.findings.is_empty() => return Self::Right,
            Verdict::Clean => return Self::Silent,
            Verdict::Unknown => return Self::Unknown,
            Verdict::Named | Verdict::Ambiguous => {}
        }
        let names = |f: &Finding| std::iter::once(f.code).chain(f.ambiguous_with.iter().copied()).collect::<Vec<_>>();
        let sets: Vec<Vec<&str>> = answer.findings.iter().map(names).collect();
        let codes = truth.codes();
        // a wide set says as little as none, wherever the truth is in it
        let mut told =
            sets.iter().filter(|set| set.len() <= MOST_NAMES || !set.iter().any(|name| truth.has(name))).peekable();
        if told.peek().is_none() {
            return Self::Unknown;
        }
        let is_true = |set: &&Vec<&str>| set.iter().any(|name| truth.has(name));
        if truth.what == What::Outside {
            let kind =
                |set: &Vec<&str>| set.iter().all(|name| Kind::of_code(name).is_some_and(|k| Some(k) == truth.kind()));
            let false_names: Vec<&Vec<&str>> = told.clone().filter(|set| !is_true(set)).collect();
            return match false_names.as_slice() {
                [] => Self::Minor,
                all if all.iter().all(|set| kind(set)) => Self::RightKind,
                _ => Self::Wrong,
            };
        }
        if !told.clone().all(|set| is_true(&set)) {
            return Self::Wrong;
        }
        let alone = |code: &&str| told.clone().any(|set| set.as_slice() == [*code]);
        let held = |code: &&str| told.clone().any(|set| set.contains(code));
        match codes.len() {
            2 if codes.iter().all(alone) => Self::Right,
            // one set cannot stand for both
            2 if codes.iter().all(held)
                && told.clone().filter(|set| codes.iter().any(|c| set.contains(c))).count() > 1 =>
            {
                Self::InSet
            }
            2 if codes.iter().any(held) => Self::One,
            1 if codes.iter().all(alone) => Self::Right,
            1 if codes.iter().all(held) => Self::InSet,
            _ => Self::Minor,
        }
    }

    /// The words in tables.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Right => "right",
            Self::InSet => "in set",
            Self::One => "one of two",
            Self::Unknown => "unknown",
            Self::Silent => "silent",
            Self::Minor => "minor only",
            Self::RightKind => "right kind",
            Self::Wrong => "wrong name",
            Self::Refused => "refused",
        }
    }
}

/// A world with its answer.
#[derive(Debug, Clone)]
pub struct Scored {
    /// The world.
    pub world: World,
    /// What is true.
    pub truth: Truth,
    /// What was answered.
    pub answer: Answer,
    /// What that counts as.
    pub mark: Mark,
    /// Whether the intervals of `mu` and `alpha` hold the truth, whatever was answered.
    pub hits: Vec<Hit>,
    /// The whole answer, as `palpate diagnose --json` tells it.
    pub told: serde_json::Value,
}

impl Scored {
    /// Has a world diagnosed and judges the answer.
    ///
    /// # Errors
    /// [`ScoreError`]: when a solve fails.
    pub fn of(world: &World, made: &Made, yardstick: &Yardstick<'_>) -> Result<Self, ScoreError> {
        let experiment = made.experiment.experiment();
        let found = diagnose::diagnose(&experiment, yardstick.models, &|_, _, _| {})?;
        let [diagnosis] = found.as_slice() else { return Err(ScoreError::Answers(found.len())) };
        let answer = Answer::of(diagnosis);
        let mark = Mark::of(&made.truth, &answer);
        let hits = coverage::of_foam(&made.truth.foam, diagnosis);
        let told = diagnose::answer::json(diagnosis, None);
        Ok(Self { world: *world, truth: made.truth.clone(), answer, mark, hits, told })
    }

    /// World, truth, answer and mark on one line.
    #[must_use]
    pub fn line(&self) -> String {
        let plain = |effect: &palpate::simulate::Effect| {
            effect.to_toml().replace('\n', " ").replace("[[effect]] code = ", "").trim().to_owned()
        };
        let truth = &self.truth;
        let dominating: Vec<String> = truth
            .dominating
            .iter()
            .map(|one| format!("{} (share {:.2}, strength {:.1})", plain(&one.effect), one.share, one.strength))
            .collect();
        let minors: Vec<String> = truth.minors.iter().map(plain).collect();
        let rests: Vec<String> =
            truth.rests.iter().map(|rest| plain(&palpate::simulate::Effect::Rest(*rest))).collect();
        format!(
            "{} {} {} [{}] together {:.2} beside [{}] and rests of {:.2} % [{}], mu {:.4} alpha {:.2} -> {} -> {}",
            self.world.design.name(),
            self.world.seed,
            truth.what.word(),
            dominating.join(" + "),
            truth.share,
            minors.join(" + "),
            100.0 * truth.rests_rms,
            rests.join(" + "),
            truth.foam.mu_mpa,
            truth.foam.alpha,
            self.answer.line(),
            self.mark.word().to_uppercase(),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hidden::Foam;
    use crate::laboratory::Dominating;
    use palpate::simulate::Effect;

    fn truth(what: What, dominating: &[Effect]) -> Truth {
        let one = |effect: &Effect| Dominating { effect: effect.clone(), share: 0.8, strength: 20.0 };
        Truth {
            what,
            dominating: dominating.iter().map(one).collect(),
            share: 0.8,
            minors: vec![Effect::Compliance { mm_per_n: 0.01 }],
            rests: Vec::new(),
            rests_rms: 0.01,
            foam: Foam { mu_mpa: 0.1, alpha: 8.0 },
        }
    }

    fn answer(sets: &[&[&'static str]], verdict: Verdict) -> Answer {
        let finding = |set: &&[&'static str]| Finding {
            code: set[0],
            form: "",
            owner: 0,
            of: Vec::new(),
            parameters: Vec::new(),
            ambiguous_with: set[1..].to_vec(),
            kind: lut_gen::effect::find(set[0], None).map_or(lut_gen::effect::Kind::Machine, |effect| effect.kind),
            probability: 1.0,
            explains: None,
        };
        let findings = sets.iter().map(finding).collect();
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

    type Case<'a> = (&'a [&'a [&'static str]], Mark);

    fn all(truth: &Truth, cases: &[Case<'_>]) {
        for (sets, mark) in cases {
            assert_eq!(Mark::of(truth, &answer(sets, Verdict::Named)), *mark, "{sets:?}");
        }
    }

    #[test]
    fn what_dominates_is_named_in_a_set_or_wrong() {
        let lag = truth(What::Catalogue, &[Effect::Lag { lag_s: 0.05 }]);
        let cases: [Case<'_>; 8] = [
            (&[&["lag"]], Mark::Right),
            (&[&["lag"], &["compliance"]], Mark::Right),
            (&[&["drift", "lag"]], Mark::InSet),
            (&[&["drift", "friction", "poisson", "lag"]], Mark::Unknown),
            (&[&["compliance"]], Mark::Minor),
            (&[&["lag"], &["drift"]], Mark::Wrong),
            (&[&["drift", "friction"]], Mark::Wrong),
            (&[&["drift", "friction", "poisson", "radius"]], Mark::Wrong),
        ];
        all(&lag, &cases);
        for (verdict, mark) in
            [(Verdict::Clean, Mark::Silent), (Verdict::Unknown, Mark::Unknown), (Verdict::Refused, Mark::Refused)]
        {
            assert_eq!(Mark::of(&lag, &answer(&[], verdict)), mark);
        }
    }

    #[test]
    fn nothing_has_no_name_and_what_is_outside_its_kind_at_most() {
        let clean = Truth { minors: Vec::new(), ..truth(What::Clean, &[]) };
        assert_eq!(Mark::of(&clean, &answer(&[], Verdict::Clean)), Mark::Right);
        assert_eq!(Mark::of(&clean, &answer(&[], Verdict::Unknown)), Mark::Right);
        all(&clean, &[(&[&["lag"]], Mark::Wrong)]);
        let law = truth(What::Outside, &[Effect::PowerLaw { amplitude: 0.4, t0_s: 0.1, beta: 0.3 }]);
        assert_eq!(Mark::of(&law, &answer(&[], Verdict::Unknown)), Mark::Unknown);
        let cases: [Case<'_>; 4] = [
            (&[&["relaxation"]], Mark::RightKind),
            (&[&["relaxation"], &["compliance"]], Mark::RightKind),
            (&[&["compliance"]], Mark::Minor),
            (&[&["relaxation", "drift"]], Mark::Wrong),
        ];
        all(&law, &cases);
    }

    #[test]
    fn of_two_both_or_one_are_found() {
        let two = truth(What::Two, &[Effect::Lag { lag_s: 0.05 }, Effect::Poisson { nu: 0.2 }]);
        let cases: [Case<'_>; 6] = [
            (&[&["lag"], &["poisson"]], Mark::Right),
            (&[&["lag", "drift"], &["poisson"]], Mark::InSet),
            (&[&["lag", "poisson"]], Mark::One),
            (&[&["lag"]], Mark::One),
            (&[&["compliance"]], Mark::Minor),
            (&[&["lag"], &["drift"]], Mark::Wrong),
        ];
        all(&two, &cases);
    }
}
