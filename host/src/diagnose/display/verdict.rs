//! From explanations to names.

use crate::diagnose::Verdict;
use crate::infer::covariance::Z95;

use super::held_out::HeldOut;
use super::search::{self, Explanation, Search};
use super::{ChannelDiagnosis, Finding};

/// Likelihood ratio of 100 as a difference of sums of squares.
const RATIO_100: f64 = 9.21;

/// A plausible amount must lie this far beyond the threshold to be seen in nine cases of ten.
const POWER: f64 = 1.28;

/// Codes of which a plausible amount would not be seen in any form.
pub(super) fn blind_spots(search: &Search<'_>) -> Vec<&'static str> {
    let mut blind: Vec<&'static str> = Vec::new();
    for effect in &search.effects {
        let mut forms = (0..search.effects.len()).filter(|at| search.effects[*at].code == effect.code);
        if !blind.contains(&effect.code) && !forms.any(|at| search::visibility(search, at) > POWER) {
            blind.push(effect.code);
        }
    }
    blind
}

/// Explanations that hold and none that is a hundred times likelier, with as few effects as will do.
pub(super) fn explanations(search: &Search<'_>, singles: &[Explanation]) -> Vec<Explanation> {
    let held = alike(singles);
    if !held.is_empty() {
        return held;
    }
    let best: Vec<Explanation> = singles.iter().filter(|e| e.beats_noise && !e.fit.at_bound).cloned().collect();
    alike(&search.pairs(&best))
}

/// The best explanation that meets every demand, and all that leave no more than noise and are no hundred times less likely: a
/// rival that predicts worse or loses to a placebo is not named alone, but it is not excluded either.
fn alike(list: &[Explanation]) -> Vec<Explanation> {
    let best = list.iter().filter(|e| e.holds()).min_by(|a, b| a.score().total_cmp(&b.score()));
    let Some(best) = best else { return Vec::new() };
    let same = |e: &Explanation| e.fit.effects() == best.fit.effects();
    let rival =
        |e: &&Explanation| !same(e) && e.adequacy.passes() && !e.fit.at_bound && e.score() <= best.score() + RATIO_100;
    let mut rivals: Vec<Explanation> = list.iter().filter(rival).cloned().collect();
    rivals.sort_by(|a, b| a.score().total_cmp(&b.score()));
    rivals.insert(0, best.clone());
    rivals
}

/// Fills in verdict and findings. `in_margins` tells whether a discrepancy shows in any variable, `visible` whether it shows at all.
pub(super) fn conclude(
    out: &mut ChannelDiagnosis,
    (visible, in_margins): (bool, bool),
    held: &[Explanation],
    held_out: Option<&HeldOut>,
) {
    let gains = held_out.is_none_or(|h| h.square_after < h.square_before);
    let Some(best) = held.first().filter(|_| visible && gains) else {
        // what shows in no variable and has no name is within what one clean channel in 250 shows
        out.verdict = if in_margins { Verdict::Unknown } else { Verdict::Clean };
        return;
    };
    for (at, effect) in best.fit.effects().into_iter().enumerate() {
        out.findings.push(Finding {
            code: effect.code,
            form: effect.form,
            parameters: best.fit.estimates(Some(at), Z95),
            ambiguous_with: others(best, at, held),
        });
    }
    let single = out.findings.iter().all(|f| f.ambiguous_with.is_empty());
    out.verdict = if single { Verdict::Named } else { Verdict::Ambiguous };
}

/// Codes that rivals of the best explanation have in place of one of its effects.
fn others(best: &Explanation, at: usize, held: &[Explanation]) -> Vec<&'static str> {
    let codes = |e: &Explanation| -> Vec<&'static str> { e.fit.effects().iter().map(|e| e.code).collect() };
    let own = codes(best);
    let mut found: Vec<&'static str> = Vec::new();
    for rival in held.iter().skip(1).map(codes).filter(|its| !its.contains(&own[at])) {
        // an effect that both have is not what they differ by
        for code in rival.into_iter().filter(|code| !own.contains(code)) {
            if !found.contains(&code) {
                found.push(code);
            }
        }
    }
    found
}

/// The verdict on several channels: what nobody can name outweighs what has a name, and a channel that could be judged one that could not.
pub(super) fn together(channels: &[ChannelDiagnosis]) -> Verdict {
    let order = [Verdict::Unknown, Verdict::Ambiguous, Verdict::Named, Verdict::Clean, Verdict::Refused];
    let any = |verdict: &Verdict| channels.iter().any(|c| c.verdict == *verdict);
    order.into_iter().find(any).unwrap_or(Verdict::TooFewData)
}
