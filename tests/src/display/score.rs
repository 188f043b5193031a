//! What a verdict on a hidden case is worth.

use std::fmt::Write;

use nalgebra::DVector;
use palpate::diagnose::Verdict;
use palpate::diagnose::display::channel::Channel;
use palpate::diagnose::display::design::{Design, Explained};
use palpate::diagnose::display::{self, Diagnosis};

use super::{Case, Plan, code};
use crate::score::rate::{share, upper95};

/// What an answer counts as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// Clean, and said so.
    Clean,
    /// Clean, and something was said.
    FalseAlarm,
    /// Its name and no other.
    Exact,
    /// A set with its name in it.
    InSet,
    /// One of two named, nothing wrong.
    Part,
    /// "Unknown".
    Unknown,
    /// Nothing said.
    Silent,
    /// A name or set without it.
    Wrong,
}

impl Outcome {
    /// The word in tables.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Outcome::Clean => "clean",
            Outcome::FalseAlarm => "false alarm",
            Outcome::Exact => "exact",
            Outcome::InSet => "in set",
            Outcome::Part => "one of two",
            Outcome::Unknown => "unknown",
            Outcome::Silent => "silent",
            Outcome::Wrong => "WRONG",
        }
    }
}

/// A case with what was answered.
#[derive(Debug, Clone)]
pub struct Scored {
    /// The case.
    pub case: Case,
    /// What the answer counts as.
    pub outcome: Outcome,
    /// Length of what the effects change, in standard deviations of the sensor's noise, gain and zero of every run free.
    pub strength: f64,
    /// Named codes, each with its rivals.
    pub named: Vec<Vec<&'static str>>,
    /// The word of the verdict.
    pub verdict: &'static str,
    /// Share of the intervals of exactly named effects that hold the truth is not scored: laws of plant and catalogue differ in form.
    pub seconds: f64,
}

/// Strength from which a flaw counts as visible: who knows its shape and looks nowhere else finds it in nine cases of ten at 1 in 250.
pub const VISIBLE: f64 = 4.2;

impl Scored {
    /// Makes, diagnoses and scores a case.
    ///
    /// # Errors
    /// A case without runs of a display, which no plan has.
    pub fn of(case: &Case) -> Result<Self, String> {
        let experiment = case.spec(true).experiment();
        let found = display::diagnose(&experiment, &|_, _, _| {}).ok_or("no run of a display")?;
        Ok(Self::judged(case, &found))
    }

    /// Scores the diagnosis of a case.
    #[must_use]
    pub fn judged(case: &Case, found: &Diagnosis) -> Self {
        let named: Vec<Vec<&'static str>> = found
            .channels
            .iter()
            .flat_map(|c| &c.findings)
            .map(|f| std::iter::once(f.code).chain(f.ambiguous_with.iter().copied()).collect())
            .collect();
        let outcome = outcome(case, found, &named);
        Self {
            case: case.clone(),
            outcome,
            strength: strength(case, found),
            named,
            verdict: found.verdict.word(),
            seconds: found.seconds,
        }
    }

    /// True when what is hidden could be seen.
    #[must_use]
    pub fn visible(&self) -> bool {
        self.strength >= VISIBLE
    }

    /// One line.
    #[must_use]
    pub fn line(&self) -> String {
        format!(
            "{:5} {:6} {:32} level {} strength {:8.1} {:11} {:10} {:?} {:.1} s",
            self.case.plan.name(),
            self.case.seed,
            if self.case.hidden.is_empty() { "clean".to_owned() } else { self.case.hidden.join("+") },
            self.case.level,
            self.strength,
            self.outcome.word(),
            self.verdict,
            self.named,
            self.seconds
        )
    }
}

fn outcome(case: &Case, found: &Diagnosis, named: &[Vec<&'static str>]) -> Outcome {
    let mut left: Vec<&'static str> = case.hidden.iter().filter_map(|name| code(name)).collect();
    let (total, mut sets) = (left.len(), false);
    for set in named {
        match left.iter().position(|one| set.contains(one)) {
            Some(at) => {
                left.swap_remove(at);
                sets |= set.len() > 1;
            }
            None => return if case.hidden.is_empty() { Outcome::FalseAlarm } else { Outcome::Wrong },
        }
    }
    let unknown = found.channels.iter().any(|c| c.verdict == Verdict::Unknown);
    match (case.hidden.is_empty(), named.is_empty(), left.is_empty() && total > 0) {
        (true, ..) => {
            if unknown {
                Outcome::FalseAlarm
            } else {
                Outcome::Clean
            }
        }
        (_, _, true) if unknown => Outcome::Unknown,
        (_, _, true) if sets => Outcome::InSet,
        (_, _, true) => Outcome::Exact,
        (_, false, false) if !unknown => Outcome::Part,
        (_, _, false) if unknown => Outcome::Unknown,
        _ => Outcome::Silent,
    }
}

/// Length of the difference that the effects make, whitened by the noise that was found, less what the base parameters take up.
fn strength(case: &Case, found: &Diagnosis) -> f64 {
    if case.hidden.is_empty() {
        return 0.0;
    }
    let (mut with, mut without) = (case.spec(true), case.spec(false));
    for spec in [&mut with, &mut without] {
        spec.noise.position_mm = 0.0;
        spec.noise.force_share = 0.0;
        spec.noise.current_a = 0.0;
        spec.noise.flux_t = 0.0;
        (spec.noise.finger_n, spec.noise.finger_mm) = (0.0, 0.0);
        spec.noise.gain_jitter = 0.0;
    }
    let (with, without) = (with.experiment(), without.experiment());
    let mut square = 0.0;
    for channel in Channel::ALL {
        let its = found.channels.iter().find(|c| c.channel == channel).and_then(|c| c.evidence.as_deref());
        let (Some(evidence), Ok(a), Ok(b)) =
            (its, Design::of(&with, channel, &Explained::new()), Design::of(&without, channel, &Explained::new()))
        else {
            continue;
        };
        if a.samples() != b.samples() || a.samples() != evidence.design.samples() {
            continue;
        }
        // of a flux that follows another current, the difference at the same current
        let law = &evidence.base.fit.law;
        let each = a.series.iter().zip(&b.series).flat_map(|(x, y)| {
            let (px, py) = (law.predict(x), law.predict(y));
            (0..x.output.len())
                .map(|k| if x.compared[k] { (x.output[k] - px[k]) - (y.output[k] - py[k]) } else { 0.0 })
                .collect::<Vec<f64>>()
        });
        let mut change = DVector::from_iterator(a.samples(), each);
        let predicted: Vec<Vec<f64>> = evidence.design.series.iter().map(|s| law.predict(s)).collect();
        display::whiten::Whitening::new(&evidence.design, &predicted, &evidence.noise).apply(&mut change);
        let basis = palpate::diagnose::evidence::basis(&evidence.base.fit.jacobian);
        square += (&change - &basis * basis.tr_mul(&change)).norm_squared();
    }
    square.sqrt()
}

/// Counts over scored cases.
#[derive(Debug)]
pub struct Tally<'a> {
    /// The cases.
    pub list: &'a [Scored],
}

impl Tally<'_> {
    fn of(&self, keep: &dyn Fn(&Scored) -> bool) -> Vec<&Scored> {
        self.list.iter().filter(|s| keep(s)).collect()
    }

    /// The tables.
    #[must_use]
    pub fn markdown(&self) -> String {
        let mut out = String::from(
            "| plan | cases | false alarm on clean | wrong name (all cases) | exact of visible | exact or in set of visible | outside, visible: unknown | pairs, visible: both | pairs: one of two |\n|---|---|---|---|---|---|---|---|---|\n",
        );
        for plan in [Plan::Short, Plan::Full, Plan::Finger] {
            let own = self.of(&|s| s.case.plan == plan);
            if own.is_empty() {
                continue;
            }
            let count = |keep: &dyn Fn(&Scored) -> bool| own.iter().filter(|s| keep(s)).count();
            let is = |s: &Scored, outcome: Outcome| s.outcome == outcome;
            let clean = count(&|s| s.case.hidden.is_empty());
            let alarms = count(&|s| is(s, Outcome::FalseAlarm));
            let single = |s: &Scored| s.visible() && s.case.hidden.len() == 1 && code(s.case.hidden[0]).is_some();
            let outside = |s: &Scored| s.visible() && s.case.hidden.len() == 1 && code(s.case.hidden[0]).is_none();
            let pair = |s: &Scored| s.visible() && s.case.hidden.len() == 2;
            let named = |s: &Scored| matches!(s.outcome, Outcome::Exact | Outcome::InSet);
            let (singles, pairs) = (count(&single), count(&pair));
            let _ = writeln!(
                out,
                "| {} | {} | {} (at most {:.0} %) | {} | {} | {} | {} | {} | {} |",
                plan.name(),
                own.len(),
                share(alarms, clean),
                100.0 * upper95(alarms, clean),
                share(count(&|s| is(s, Outcome::Wrong)), own.len()),
                share(count(&|s| single(s) && is(s, Outcome::Exact)), singles),
                share(count(&|s| single(s) && named(s)), singles),
                share(count(&|s| outside(s) && is(s, Outcome::Unknown)), count(&outside)),
                share(count(&|s| pair(s) && named(s)), pairs),
                share(count(&|s| pair(s) && is(s, Outcome::Part)), pairs),
            );
        }
        out.push_str(&self.confusion());
        let slowest = self.list.iter().map(|s| s.seconds).fold(0.0, f64::max);
        let mean = self.list.iter().map(|s| s.seconds).sum::<f64>() / self.list.len().max(1) as f64;
        let _ = writeln!(out, "\nA diagnosis of all channels takes {mean:.1} s, the slowest {slowest:.1} s.");
        out
    }

    /// Outcomes by what is hidden.
    fn confusion(&self) -> String {
        const COLUMNS: [Outcome; 8] = [
            Outcome::Clean,
            Outcome::FalseAlarm,
            Outcome::Exact,
            Outcome::InSet,
            Outcome::Part,
            Outcome::Unknown,
            Outcome::Silent,
            Outcome::Wrong,
        ];
        let mut names: Vec<String> = Vec::new();
        for one in self.list {
            let name = hidden(one);
            if !names.contains(&name) {
                names.push(name);
            }
        }
        names.sort();
        let mut out = String::from("\n| hidden | visible |");
        COLUMNS.iter().for_each(|c| out.push_str(&format!(" {} |", c.word().to_lowercase())));
        out.push_str(&format!(" silent, though visible |\n|{}\n", "---|".repeat(3 + COLUMNS.len())));
        for name in names {
            let own = self.of(&|s| hidden(s) == name);
            let count = |keep: &dyn Fn(&&&Scored) -> bool| own.iter().filter(|s| keep(s)).count();
            let _ = write!(out, "| {name} | {} of {} |", count(&|s| s.visible()), own.len());
            for column in COLUMNS {
                let cases = count(&|s| s.outcome == column);
                let _ = write!(out, " {} |", if cases > 0 { cases.to_string() } else { String::new() });
            }
            let missed = count(&|s| s.outcome == Outcome::Silent && s.visible());
            let _ = writeln!(out, " {} |", if missed > 0 { missed.to_string() } else { String::new() });
        }
        out
    }
}

fn hidden(one: &Scored) -> String {
    if one.case.hidden.is_empty() { "nothing".to_owned() } else { one.case.hidden.join(" + ") }
}
