//! From explanations to a verdict with names.

use lut_gen::effect::{Owner, depth_gain, radius};

use super::Diagnosis;
use super::check::Kind;
use super::design::Design;
use super::evidence::{Gauge, Panel};
use super::finding::{Finding, Verdict};
use super::gradient::Gradient;
use super::held_out::HeldOut;
use super::noise::{Noise, Source};
use super::ripple::{Over, Ripple, SPOILS};
use super::search::{Explanation, RATIO_100, Search};
use crate::experiment::Experiment;

/// A plausible amount must lie this far beyond the threshold to be seen in nine cases of ten.
const POWER: f64 = 1.28;
/// Twins that blind spots are found with.
const FEW_TWINS: usize = 200;
/// Codes of which a plausible amount would not be seen.
pub(super) fn blind_spots(search: &Search<'_>) -> Vec<&'static str> {
    let Search { candidates, signatures, base, twins, .. } = search;
    let few = twins.columns(0, twins.ncols().min(FEW_TWINS)).into_owned();
    let mut blind: Vec<&'static str> = Vec::new();
    for effect in lut_gen::effect::CATALOGUE {
        if blind.contains(&effect.code) {
            continue;
        }
        let own = candidates.iter().zip(signatures).filter(|(c, _)| c.effect.code == effect.code);
        let mut forms = own.map(|(_, signature)| {
            let gauge = Gauge::new(&Panel::of(signature.clone(), &few), &base.jacobian, &few);
            let seen = signature.column_iter().enumerate().map(|(j, column)| gauge.read(&column.into_owned())[j].abs());
            // one direction alone needs 2.8 to pass at the level of one in two hundred
            seen.fold(0.0, f64::max) > 2.8 + POWER
        });
        if !forms.any(|seen| seen) {
            blind.push(effect.code);
        }
    }
    blind
}

/// Effects that hide each other when they are of equal size and opposite sign, whatever is pressed into: only runs without the specimen tell. `blind_to` is
/// what a plausible amount of would not be seen in this design.
pub(super) fn cancelling(design: &Design, blind_to: &[&str]) -> Vec<&'static str> {
    let has = |kind: Kind| design.checks.iter().any(|check| check.kind == kind);
    let mut list = Vec::new();
    if !has(Kind::Block) && !has(Kind::Mass) {
        list.push(
            "relaxation of the specimen and creep of the sensor with equal size and time cancel: without a hold on a stiff block this design cannot exclude it",
        );
    }
    if blind_to.contains(&depth_gain::EFFECT.code) {
        list.push("the gain of the depth gauge is part of mu and alpha: without the gauge on a block of known height this design cannot exclude it");
    }
    if !has(Kind::Mass) {
        list.push("the gain of the sensor is part of mu: without a known mass this design cannot exclude it");
    }
    list
}

/// Gain between spots that a uniform specimen on a level table has at most: foams are uniform to a percent.
const UNIFORM: f64 = 0.02;
/// How likely spots must differ by more for that to be told: in 200 clean experiments it is 0.36 at most, in tilted specimens 0.88 and more.
const SURELY: f64 = 0.8;

/// Scatter of the gain between spots where that is more than a uniform specimen has: none of the catalogue's effects tells one spot from another.
pub(super) fn unevenness(noise: &Noise) -> Option<f64> {
    let measured = noise.source == Source::Replicates;
    (measured && noise.posterior.gain_above(UNIFORM) > SURELY).then_some(noise.jitter.gain)
}

/// How likely scatter between spots may make a gain over the place that is told, on all specimens together.
const BY_CHANCE: f64 = 0.005;

/// The gain over the place that scatter makes least likely, where it is told.
pub(super) fn gradient(noise: &Noise) -> Option<&Gradient> {
    let all = &noise.posterior.gradients;
    let least = all.iter().min_by(|a, b| a.chance.total_cmp(&b.chance))?;
    (least.chance * (all.len() as f64) < BY_CHANCE).then_some(least)
}

/// Part of a direction below which it is none.
const ALONG: f64 = 0.1;

/// A gain over the place in words.
pub(super) fn slope(gradient: &Gradient, experiment: &Experiment) -> Option<String> {
    let own = experiment.runs.iter().filter(|run| run.specimen == Some(gradient.specimen));
    let [x, y] = gradient.per_mm;
    let steepness = x.hypot(y);
    let along = own.filter_map(|run| run.place_mm).map(|place| (place[0] * x + place[1] * y) / steepness);
    let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), mm| (low.min(mm), high.max(mm)));
    let specimen = experiment.specimens.get(gradient.specimen).filter(|_| high > low)?;
    let sign = |of: f64| if of < 0.0 { '-' } else { '+' };
    let towards = match [x / steepness, y / steepness] {
        [_, y] if y.abs() < ALONG => format!("{}x", sign(x)),
        [x, _] if x.abs() < ALONG => format!("{}y", sign(y)),
        [x, y] => format!("[{x:.2}, {y:.2}]"),
    };
    let seldom = if gradient.chance > 1e-6 {
        format!("once in {:.0}", 1.0 / gradient.chance)
    } else {
        "less than once in a million".to_owned()
    };
    Some(format!(
        "on {} the force grows by {:.2} % a millimetre towards {towards}, {:.1} % over the {:.0} mm that its spots span there, which scatter between spots does {seldom}: the specimen is tilted \
         or a wedge, or its material varies along it, which no effect of the catalogue says; measure its height at both ends, or turn it round and press again",
        specimen.name,
        100.0 * steepness,
        100.0 * steepness * (high - low),
        high - low,
    ))
}

/// What was seen besides what a name explains.
pub(super) struct Seen<'a> {
    /// A discrepancy shows, in a variable or along what an effect would change.
    pub visible: bool,
    /// The force ripples.
    pub ripple: Option<&'a Ripple>,
    /// The gain goes with the place.
    pub gradient: Option<Gradient>,
    /// Spots differ in gain by this, which is too much.
    pub uneven: Option<f64>,
    /// Runs in which the force drops at once, where that is no accident.
    pub slipping: Option<usize>,
    /// The departure without a name that is too likely beside the best that holds, in words.
    pub nameless: Option<&'static str>,
}

impl Seen<'_> {
    /// True where nothing shows that no smooth change of the force is.
    pub fn is_regular(&self) -> bool {
        self.ripple.is_none() && self.gradient.is_none() && self.uneven.is_none() && self.slipping.is_none()
    }

    /// True where the noise is another one than was assumed, and names with it: a large ripple, or slips.
    pub fn spoils(&self) -> bool {
        self.ripple.is_some_and(|r| r.share > SPOILS) || self.slipping.is_some()
    }
}

/// Fills in verdict and findings.
pub(super) fn conclude(
    diagnosis: &mut Diagnosis,
    experiment: &Experiment,
    seen: Seen<'_>,
    held: &[Explanation],
    held_out: Option<&HeldOut>,
) {
    let spoilt = seen.spoils();
    let Seen { visible, ripple, gradient, uneven, slipping, nameless } = seen;
    // a name that nothing could test is none
    let gains = held_out.is_some_and(|h| h.deviance_after < h.deviance_before);
    if held_out.is_none() && !held.is_empty() {
        diagnosis.messages.push(
            "what explains it cannot be tested on what no fit has seen, so nothing is named; press with another ball or rate"
                .to_owned(),
        );
    }
    if let Some(ripple) = ripple {
        let word = match ripple.over {
            Over::Time => "time",
            Over::Depth => "depth",
        };
        if !diagnosis.shows_in.contains(&word) {
            diagnosis.shows_in.insert(0, word);
        }
    }
    let leaning = gradient.and_then(|gradient| slope(&gradient, experiment));
    let uneven = uneven.filter(|_| leaning.is_none());
    let differ = leaning.is_some() || uneven.is_some();
    if differ {
        diagnosis.shows_in.push("spot");
    }
    diagnosis.messages.extend(leaning);
    if let Some(gain) = uneven {
        diagnosis.messages.push(format!(
            "from spot to spot the force differs by {:.1} % as a gain, where a uniform specimen on a level table has about one: height, tilt or the material itself varies over the \
             specimen, which no effect of the catalogue says; measure its height at every spot, or press one spot again after a rest",
            100.0 * gain
        ));
    }
    if let Some(runs) = slipping {
        diagnosis.shows_in.push("slip");
        diagnosis.messages.push(format!(
            "in {runs} runs the force drops at once while the indenter goes on: something slips or breaks, which no effect of the catalogue does, and what was read before says little; \
             look at the surface and the fixture"
        ));
    }
    if let Some((best, other)) = held.first().zip(nameless) {
        let codes: Vec<&str> = best.fit.codes().collect();
        diagnosis.messages.push(format!(
            "{} explains it best of the catalogue, but not so much better than {other}",
            codes.join(" with ")
        ));
    }
    let best = held.first().filter(|_| visible && gains && !spoilt && nameless.is_none());
    let Some(best) = best else {
        if visible && diagnosis.shows_in.is_empty() {
            diagnosis.messages.push(
                "no variable shows it by itself: the residual lies along what an effect of the catalogue, or a smooth elastic departure, would change, farther than noise goes".to_owned(),
            );
        }
        diagnosis.verdict =
            if visible || ripple.is_some() || differ || slipping.is_some() { Verdict::Unknown } else { Verdict::Clean };
        return;
    };
    for (at, candidate) in best.fit.candidates.iter().enumerate() {
        let parameters = best.fit.quantities(at).into_iter().map(|(q, value, i)| (q.name, value, i)).collect();
        diagnosis.findings.push(Finding {
            code: candidate.effect.code,
            form: candidate.effect.form,
            owner: candidate.owner,
            of: owners(experiment, best, at, held),
            parameters,
            ambiguous_with: others(best, at, held),
        });
    }
    let last = best.fit.candidates.last().map(|c| c.effect.code);
    if last == Some(radius::EFFECT.code) && best.beyond_causeless < RATIO_100 {
        diagnosis.messages.push(
            "a gain of the force under one ball alone, whatever its cause, explains this about as well as that ball's radius does, which is the only cause of the catalogue for it: gauge the ball"
                .to_owned(),
        );
    }
    let named = |code: &&str| diagnosis.findings.iter().any(|f| f.code == *code || f.ambiguous_with.contains(code));
    diagnosis.blind_to = diagnosis.blind_to.iter().filter(|code| !named(code)).copied().collect();
    let single = diagnosis.findings.iter().all(|f| f.ambiguous_with.is_empty());
    diagnosis.verdict = if single { Verdict::Named } else { Verdict::Ambiguous };
}

/// Names of the balls or specimens that an effect of the best explanation belongs to, there or in a rival that is the same but for that.
fn owners(experiment: &Experiment, best: &Explanation, at: usize, held: &[Explanation]) -> Vec<String> {
    let own = best.fit.candidates[at];
    let name = |owner: usize| match own.effect.owner {
        Owner::All => None,
        Owner::Indenter => experiment.indenters.get(owner).map(|ball| ball.name.clone()),
        Owner::Specimen => experiment.specimens.get(owner).map(|its| its.name.clone()),
    };
    let elsewhere = |rival: &Explanation| {
        let here = rival.fit.candidates.iter().find(|c| !best.fit.candidates.contains(c))?;
        let same = rival.fit.candidates.iter().filter(|c| best.fit.candidates.contains(c)).count();
        let moved = here.effect == own.effect && same + 1 == best.fit.candidates.len();
        (moved && rival.fit.candidates.len() == best.fit.candidates.len()).then_some(here.owner)
    };
    let mut all = vec![own.owner];
    for owner in held.iter().skip(1).filter_map(elsewhere) {
        if !all.contains(&owner) {
            all.push(owner);
        }
    }
    all.into_iter().filter_map(name).collect()
}

/// Codes that rivals of the best explanation have in place of one of its effects.
fn others(best: &Explanation, at: usize, held: &[Explanation]) -> Vec<&'static str> {
    let codes = |e: &Explanation| -> Vec<&'static str> { e.fit.codes().collect() };
    let own = codes(best);
    let mut found: Vec<&'static str> = Vec::new();
    for rival in held.iter().skip(1) {
        let its = codes(rival);
        if its.contains(&own[at]) {
            continue;
        }
        // an effect that both have is not what they differ by
        for code in its.into_iter().filter(|code| !own.contains(code)) {
            if !found.contains(&code) {
                found.push(code);
            }
        }
    }
    found
}
