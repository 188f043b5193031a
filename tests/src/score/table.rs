//! Scores added up: one row a design, and the goals.

use std::fmt::Write;

use crate::hidden::{Design, NoiseKind, What};

use super::Scored;
use super::outcome::Outcome;
use super::rate::{middle_and_worst, percent, share, upper95};

/// What a surrogate study of the algorithm reached, percent (DIAGNOSIS.md): false alarm, exact, in a set, wrong name, outside unknown.
fn surrogate(design: Design) -> Option<[u32; 5]> {
    Some(match design {
        Design::D6 => [10, 24, 21, 5, 81],
        Design::D18 => [2, 42, 21, 1, 80],
        Design::D36 => [0, 58, 21, 1, 100],
        Design::D60 => [0, 65, 20, 1, 100],
        Design::Own => return None,
    })
}

/// Scores to be added up.
#[derive(Debug, Clone, Copy)]
pub struct Score<'a> {
    /// The scores, in any order.
    pub list: &'a [Scored],
}

impl Score<'_> {
    fn count(&self, within: impl Fn(&Scored) -> bool) -> usize {
        self.list.iter().filter(|s| within(s)).count()
    }

    fn designs(&self) -> Vec<Design> {
        Design::ALL.into_iter().chain([Design::Own]).filter(|d| self.list.iter().any(|s| s.design == *d)).collect()
    }

    /// Everything, as Markdown.
    #[must_use]
    pub fn markdown(&self) -> String {
        let parts = [
            self.by_design(),
            self.goals(),
            self.confusion(),
            self.by_level(),
            self.by_strength(),
            self.pairs(),
            self.coverage(),
            self.mistakes(),
        ];
        parts.join("\n")
    }

    /// One row a design.
    #[must_use]
    pub fn by_design(&self) -> String {
        let mut text = "Percent of the cases; what the surrogate study reached in brackets.\n\n\
            | design | cases | false alarm (upper 95 %) | exact | in set | wrong name | outside, visible: unknown | s a diagnosis: median, worst |\n\
            |---|---|---|---|---|---|---|---|\n"
            .to_owned();
        for design in self.designs() {
            let of = |within: &dyn Fn(&Scored) -> bool| self.count(|s| s.design == design && within(s));
            let clean = of(&|s| s.truth.what == What::Clean);
            let alarms = of(&|s| s.outcome == Outcome::FalseAlarm);
            let catalogue = of(&is_catalogue);
            let exact = of(&|s| matches!(s.outcome, Outcome::Exact | Outcome::SilentRight));
            let in_set = of(&|s| s.outcome == Outcome::InSet);
            let wrong = of(&|s| is_catalogue(s) && s.outcome == Outcome::Wrong);
            let outside = of(&|s| is_outside(s) && s.any_visible());
            let unknown = of(&|s| is_outside(s) && s.any_visible() && s.outcome == Outcome::OutsideUnknown);
            let known = surrogate(design).map(|all| all.map(|one| format!(" [{one}]")));
            let [a, b, c, d, e] = known.unwrap_or_default();
            let own = self.list.iter().filter(|s| s.design == design);
            let (middle, worst) = middle_and_worst(own.map(|s| s.answer.seconds)).unwrap_or_default();
            let _ = writeln!(
                text,
                "| {} | {} | {} of {clean}: {:.0} (<= {:.1}){a} | {:.0}{b} | {:.0}{c} | {:.1}{d} | {}{e} | {middle:.1}, {worst:.1} |",
                design.name(),
                of(&|_| true),
                alarms,
                percent(alarms, clean),
                100.0 * upper95(alarms, clean),
                percent(exact, catalogue),
                percent(in_set, catalogue),
                percent(wrong, catalogue),
                share(unknown, outside),
            );
        }
        text
    }

    /// The goals of the whole suite, each met or not.
    #[must_use]
    pub fn goals(&self) -> String {
        let mut text = "| goal | measured | |\n|---|---|---|\n".to_owned();
        let mut row = |goal: &str, measured: String, met: Option<bool>| {
            let word = met.map_or("no cases", |met| if met { "met" } else { "MISSED" });
            let _ = writeln!(text, "| {goal} | {measured} | {word} |");
        };
        let judged = |cases: usize, met: bool| (cases > 0).then_some(met);
        for (kind, noise) in
            [("matched", Some(NoiseKind::Matched)), ("mismatched", Some(NoiseKind::Mismatched)), ("all", None)]
        {
            let own = |s: &Scored| s.truth.what == What::Clean && noise.is_none_or(|n| s.truth.noise == n);
            let (cases, alarms) = (self.count(own), self.count(|s| own(s) && s.outcome == Outcome::FalseAlarm));
            let refused = self.count(|s| own(s) && s.outcome == Outcome::Refused);
            let bound = 100.0 * upper95(alarms, cases);
            let measured = format!("{}, upper 95 % bound {bound:.1} %; {refused} refused", share(alarms, cases));
            row(&format!("false alarm <= 5 %, {kind} noise"), measured, judged(cases, percent(alarms, cases) <= 5.0));
        }
        let named = |s: &Scored| is_catalogue(s) || is_pair(s);
        let (cases, wrong) = (self.count(named), self.count(|s| named(s) && s.outcome == Outcome::Wrong));
        row(
            "wrong name <= 2 %, effects of the catalogue, alone or two",
            share(wrong, cases),
            judged(cases, percent(wrong, cases) <= 2.0),
        );
        let mut unknown = |goal: &str, of: fn(&Scored) -> bool, more: &str| {
            let (cases, unknown) = (self.count(of), self.count(|s| of(s) && s.outcome == Outcome::OutsideUnknown));
            row(goal, share(unknown, cases) + more, judged(cases, percent(unknown, cases) >= 90.0));
        };
        let outside = |s: &Scored| is_outside(s) && s.any_visible();
        let other = self.count(|s| outside(s) && s.outcome == Outcome::OtherForm);
        let more = format!("; {other} more have the right cause in another form");
        unknown("outside the catalogue and visible: unknown >= 90 %", outside, &more);
        let goal = "the same, visible with a noise that must be told from repeats: unknown >= 90 %";
        unknown(goal, |s| is_outside(s) && s.any_told(), "");
        let deleted = |s: &Scored| matches!(s.truth.what, What::Deleted(..)) && s.any_visible();
        unknown("deleted from the catalogue and visible: unknown >= 90 %", deleted, "");
        let placebo = |s: &Scored| matches!(s.truth.what, What::Placebo(_));
        let (cases, placebos) = (self.count(placebo), self.count(|s| placebo(s) && s.outcome == Outcome::Wrong));
        row("placebos named <= 1 %", share(placebos, cases), judged(cases, percent(placebos, cases) <= 1.0));
        let pairs = |s: &Scored| is_pair(s) && s.all_visible();
        let (cases, both) = (self.count(pairs), self.count(|s| pairs(s) && s.outcome == Outcome::Both));
        row(
            "two effects, both visible: both named or in sets >= 85 %",
            share(both, cases),
            judged(cases, percent(both, cases) >= 85.0),
        );
        let (cases, resolved) = (
            self.count(|s| s.outcome != Outcome::Wrong && s.followed.is_some()),
            self.count(|s| s.outcome != Outcome::Wrong && s.followed.as_ref().is_some_and(|f| f.resolved)),
        );
        row(
            "ambiguous, the truth in the set: the right single names after at most two planned runs >= 80 %",
            share(resolved, cases),
            judged(cases, percent(resolved, cases) >= 80.0),
        );
        let (cases, gained) = self.gained();
        row(
            "fall of the held-out error >= 80 % of an oracle's, visible effects",
            if cases == 0 { "none".to_owned() } else { format!("{gained:.0} % (mean of {cases})") },
            judged(cases, gained >= 80.0),
        );
        for (what, right) in [("all answers", false), ("right answers", true)] {
            let hits = self.list.iter().flat_map(|s| &s.hits).filter(|h| h.right || !right);
            let hits: Vec<bool> = hits.map(|h| h.held).collect();
            let held = hits.iter().filter(|h| **h).count();
            let fine = (92.0..=97.0).contains(&percent(held, hits.len()));
            let name = format!("coverage of 95 % intervals of {what} 92 to 97 %");
            row(&name, share(held, hits.len()), judged(hits.len(), fine));
        }
        text
    }

    /// Mean share of an oracle's gain over cases with a visible effect, percent, missed ones as nothing.
    fn gained(&self) -> (usize, f64) {
        let own = |s: &&Scored| (is_catalogue(s) || is_pair(s)) && s.any_visible();
        let shares: Vec<f64> = self
            .list
            .iter()
            .filter(own)
            .filter_map(|s| match (&s.gain, s.outcome) {
                (Some(gain), _) => gain.share().map(|share| share.clamp(0.0, 1.0)),
                (None, Outcome::Missed) => Some(0.0),
                _ => None,
            })
            .collect();
        (shares.len(), 100.0 * shares.iter().sum::<f64>() / shares.len().max(1) as f64)
    }
}

pub(super) fn is_catalogue(s: &Scored) -> bool {
    matches!(s.truth.what, What::Catalogue(..))
}

pub(super) fn is_outside(s: &Scored) -> bool {
    matches!(s.truth.what, What::Outside(..))
}

fn is_pair(s: &Scored) -> bool {
    matches!(s.truth.what, What::Pair(..))
}
