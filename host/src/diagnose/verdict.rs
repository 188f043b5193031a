//! From what is believed to a verdict with names, and what a design cannot see.

use lut_gen::effect::{Owner, depth_gain};

use super::Diagnosis;
use super::check::Kind;
use super::design::Design;
use super::evidence::{Gauge, Panel};
use super::gradient::Gradient;
use super::held_out::HeldOut;
use super::noise::{Noise, Source};
use super::ripple::{Over, Ripple, SPOILS};
use super::search::Search;
use super::sets::{Found, Weighed, findings};
use super::twins::Twins;
use crate::experiment::Experiment;
use crate::infer::sets::Outcome;

/// A plausible amount must lie this far beyond the threshold to be seen in nine cases of ten.
const POWER: f64 = 1.28;
/// Twins that blind spots are found with.
const FEW_TWINS: usize = 200;
/// Codes of which a plausible amount would not be seen.
pub(super) fn blind_spots(search: &Search<'_>, twins: &Twins) -> Vec<&'static str> {
    let Search { candidates, signatures, base, .. } = search;
    let few = twins.draws.columns(0, twins.draws.ncols().min(FEW_TWINS)).into_owned();
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

/// What was seen that no smooth change of the force is.
pub(super) struct Seen<'a> {
    /// The force ripples.
    pub ripple: Option<&'a Ripple>,
    /// The gain goes with the place.
    pub gradient: Option<Gradient>,
    /// Spots differ in gain by this, which is too much.
    pub uneven: Option<f64>,
    /// Runs in which the force drops at once, where that is no accident.
    pub slipping: Option<usize>,
}

impl Seen<'_> {
    /// True where nothing shows that no smooth change of the force is.
    pub fn is_regular(&self) -> bool {
        self.ripple.is_none() && self.gradient.is_none() && self.uneven.is_none() && self.slipping.is_none()
    }

    /// True where the noise is another one than was assumed, and names with it: slips, or a ripple that is most
    /// of the scatter and as large as what the names explain (root mean square, N).
    pub fn spoils(&self, explained_n: Option<f64>) -> bool {
        let outweighs = |r: &Ripple| explained_n.is_none_or(|n| r.amplitude_n > n * std::f64::consts::SQRT_2);
        self.ripple.is_some_and(|r| r.share > SPOILS && outweighs(r)) || self.slipping.is_some()
    }
}

/// Fills in verdict and findings. Names are withdrawn where they do not predict what was left out better than the base, or what else was seen spoils the noise.
pub(super) fn conclude(
    diagnosis: &mut Diagnosis,
    experiment: &Experiment,
    seen: &Seen<'_>,
    found: &mut Found<'_>,
    held_out: Option<&HeldOut>,
) {
    tell(diagnosis, experiment, seen);
    let Found { sets, held, judged, .. } = found;
    if !judged.findings.is_empty() {
        let gains = held_out.is_some_and(HeldOut::gains);
        if !gains {
            diagnosis.messages.push(match held_out {
                Some(h) => format!(
                    "what explains it does not predict what was left out better than the base does ({:.2e} N rms with it, {:.2e} N without): its name is withdrawn",
                    h.rmse_after_n, h.rmse_before_n
                ),
                None => "what explains it cannot be tested on what no fit has seen: its name is withdrawn; press with another ball or rate".to_owned(),
            });
        }
        let at_end = held.first().and_then(|best| best.fit.end_of_effect());
        if let Some(quantity) = at_end {
            diagnosis.messages.push(format!(
                "what explains it ends at the bound of {quantity}, beyond which laboratories do not go: its name is withdrawn"
            ));
        }
        if !gains || at_end.is_some() || seen.spoils(judged.explained) || held.is_empty() {
            judged.withdraw();
            held.clear();
        }
    }
    if judged.outcome == Outcome::Clean && !seen.is_regular() {
        judged.outcome = Outcome::Unknown;
    }
    diagnosis.verdict = judged.outcome.into();
    let told = |best: &Weighed| findings(judged, best, |at| owners(experiment, best, at, sets));
    diagnosis.findings = held.first().map(told).unwrap_or_default();
    let named = |code: &&str| diagnosis.findings.iter().any(|f| f.code == *code || f.ambiguous_with.contains(code));
    diagnosis.blind_to = diagnosis.blind_to.iter().filter(|code| !named(code)).copied().collect();
}

/// Tells what was seen besides.
fn tell(diagnosis: &mut Diagnosis, experiment: &Experiment, seen: &Seen<'_>) {
    if let Some(ripple) = seen.ripple {
        let word = match ripple.over {
            Over::Time => "time",
            Over::Depth => "depth",
        };
        if !diagnosis.shows_in.contains(&word) {
            diagnosis.shows_in.insert(0, word);
        }
    }
    let leaning = seen.gradient.as_ref().and_then(|gradient| slope(gradient, experiment));
    let uneven = seen.uneven.filter(|_| leaning.is_none());
    if leaning.is_some() || uneven.is_some() {
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
    if let Some(runs) = seen.slipping {
        diagnosis.shows_in.push("slip");
        diagnosis.messages.push(format!(
            "in {runs} runs the force drops at once while the indenter goes on: something slips or breaks, which no effect of the catalogue does, and what was read before says little; \
             look at the surface and the fixture"
        ));
    }
}

/// Names of the balls or specimens that an effect of the best set belongs to, there or in a rival that is the same but for that.
fn owners(experiment: &Experiment, best: &Weighed, at: usize, sets: &[Weighed]) -> Vec<String> {
    /// Logarithm of a hundred.
    const FAR_LESS_LIKELY: f64 = 4.6;
    let own = best.fit.candidates[at];
    let name = |owner: usize| match own.effect.owner {
        Owner::All => None,
        Owner::Indenter => experiment.indenters.get(owner).map(|ball| ball.name.clone()),
        Owner::Specimen => experiment.specimens.get(owner).map(|its| its.name.clone()),
    };
    let elsewhere = |rival: &Weighed| {
        let (its, all) = (&rival.fit.candidates, &best.fit.candidates);
        let here = its.iter().find(|c| !all.contains(c))?;
        let same = its.iter().filter(|c| all.contains(c)).count();
        let moved = here.effect == own.effect && same + 1 == all.len() && !its.contains(&own);
        (moved && its.len() == all.len()).then_some(here.owner)
    };
    let mut all = vec![own.owner];
    for owner in sets.iter().filter(|set| set.log > best.log - FAR_LESS_LIKELY).filter_map(elsewhere) {
        if !all.contains(&owner) {
            all.push(owner);
        }
    }
    all.into_iter().filter_map(name).collect()
}
