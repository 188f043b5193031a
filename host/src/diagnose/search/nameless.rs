//! Whether an explanation does better than a departure that has no name: an elastic one, or relaxation in more times than the catalogue has.

use lut_gen::effect::{
    Quantity, adhesion, compliance, contact_offset, depth_gain, friction, lag, nameless, numerics, poisson, radius,
    relaxation, second_term, sensor_creep, sensor_gain, sensor_nonlinearity, thickness,
};
use nalgebra::DMatrix;

use super::super::coordinate::Candidate;
use super::super::design::{Branch, Design, Node};
use super::super::evidence::{basis, rest_of};
use super::super::fit::{Fit, Problem};
use super::rounds::BEHIND;
use super::{Explanation, RATIO_100, Search, changes, score};
use crate::infer::lowrank::Fold;
use crate::infer::presence::CHARGE;

/// An elastic departure without a name.
const NAMELESS: Candidate = Candidate { effect: &nameless::EFFECT, owner: 0 };

/// Relaxation in a whole spectrum of times.
const SPECTRUM: Candidate = Candidate { effect: &relaxation::SPECTRUM, owner: 0 };

/// Memory that is carried otherwise than a Prony series carries it.
const MEMORY: Candidate = Candidate { effect: &relaxation::MEMORY, owner: 0 };

/// What a plausible amount of each of its parts changes, whitened, a column a part.
pub(super) fn departure(problem: &Problem<'_>, at: &Fit) -> DMatrix<f64> {
    let quantities = nameless::EFFECT.quantities;
    let alone = |part: usize| {
        let value = |(k, q): (usize, &Quantity)| if k == part { q.plausible } else { q.null };
        quantities.iter().enumerate().map(value).collect()
    };
    changes(problem, at, &NAMELESS, (0..quantities.len()).map(alone).collect())
}

/// True where a departure without a name explains the data about as well, by [`Search::beyond_nameless`].
pub(in crate::diagnose) fn is_nameless(beyond: Option<f64>) -> bool {
    beyond.is_some_and(|by| by <= 0.0)
}

/// Likelihood ratios of 3 and of 10 as differences of sums of squares.
const RATIO_3: f64 = 2.2;
const RATIO_10: f64 = 4.6;

/// Part of the sum of squares that two times of relaxation explain which may be what they leave of a spectrum.
const SPECTRAL: f64 = 0.02;

/// Effects that claim a form of the foam's elastic law.
const LAWS: [&str; 2] = [poisson::EFFECT.code, second_term::EFFECT.code];
/// Other effects that are the same whatever the time, the direction and the history are.
const STATIC: [&str; 10] = [
    thickness::HEIGHT.code,
    radius::EFFECT.code,
    friction::EFFECT.code,
    adhesion::EFFECT.code,
    contact_offset::EFFECT.code,
    depth_gain::EFFECT.code,
    compliance::EFFECT.code,
    sensor_gain::EFFECT.code,
    sensor_nonlinearity::EFFECT.code,
    numerics::EFFECT.code,
];

/// Effects of time that are functions of the depth where all ramps have one rate and nothing stands or goes back.
const TIMED: [&str; 3] = [relaxation::ONE.code, lag::FILTER.code, sensor_creep::CREEP.code];

fn relaxes(explanation: &Explanation) -> bool {
    explanation.fit.codes().any(|code| code == relaxation::ONE.code)
}

/// What an explanation is not clearly better than, where [`Search::beyond_nameless`] says so.
pub fn rival(explanation: &Explanation, design: &Design) -> &'static str {
    if relaxes(explanation) && tells_time(design) {
        "relaxation in a spectrum of times does that it could be named: a power law of time would look like this"
    } else {
        "an elastic departure without a name does that it could be named: another law, a skin or a gradient would look like this"
    }
}

/// The relaxation of two times that an explanation has something else beside, if it is one of those.
fn beside_two_times(explanation: &Explanation) -> Option<&Candidate> {
    let candidates = &explanation.fit.candidates;
    candidates.iter().find(|c| *c.effect == relaxation::TWO).filter(|_| candidates.len() > 1)
}

/// True where runs tell time from depth.
fn tells_time(design: &Design) -> bool {
    let more = |nodes: &[Node]| nodes.iter().any(|node| node.branch != Branch::Loading);
    design.rates_mm_per_s.len() > 1 || design.series.iter().any(|s| s.cycle > 1 || more(&s.nodes))
}

impl Search<'_> {
    /// True where effects do what an elastic departure might, as far as these runs can tell.
    fn is_elastic(&self, fit: &Fit) -> bool {
        let timed = !tells_time(self.problem.design);
        let one = |code| LAWS.contains(&code) || STATIC.contains(&code) || timed && TIMED.contains(&code);
        fit.codes().all(one)
    }

    /// True where an explanation has a part that claims a form of the elastic law, and none that is not elastic.
    pub(super) fn claims_a_law(&self, explanation: &Explanation) -> bool {
        self.is_elastic(&explanation.fit) && explanation.fit.codes().any(|code| LAWS.contains(&code))
    }

    /// By how much (sum of squares, parameters charged) an explanation is likelier than it must be against a departure without a name in its place; none where no such
    /// departure is known for it. `held` is what holds beside it, `singles` are the explanations by one effect, `pairs` those by two.
    #[must_use]
    pub fn beyond_nameless(
        &self,
        best: &Explanation,
        held: &[Explanation],
        (singles, pairs): (&[Explanation], &[Explanation]),
    ) -> Option<f64> {
        if self.is_elastic(&best.fit) {
            return Some(self.beyond_elastic(&best.fit, held.iter().any(|e| self.claims_a_law(e))));
        }
        [self.beyond_spectrum(best), self.beyond_more_times(best, singles, pairs)]
            .into_iter()
            .flatten()
            .reduce(f64::min)
    }

    /// Of elastic laws there is no end, so that one of those with a name must be ten times likelier than any, and so must what is told with one in a set; two elastic effects together
    /// imitate many, and must be a hundred times. Likelihoods are marginal ones, over the amounts that each might have had: the parts of a departure without a name cost what these data
    /// could have told of them. A wrong radius, friction, or a machine that gives way, has one form, and is told from it as from any rival: three times likelier, its parts charged as
    /// parameters, or as what these data tell of them where that is more: beside a coupon they tell much. What a form may be wrong by is allowed for or not, whichever is better for it: a
    /// departure without a name has none to be wrong by.
    fn beyond_elastic(&self, fit: &Fit, a_law: bool) -> f64 {
        let nameless = self.elastic();
        let likelier = f64::max(nameless.discounted - fit.discounted, nameless.square - fit.square);
        let together = fit.candidates.len() > 1;
        if together && !tells_time(self.problem.design) {
            // all that is known is one curve a ball: two shapes that both follow it make nearly any
            return f64::NEG_INFINITY;
        }
        let parts = self.signatures.last().map_or(0.0, |parts| self.price(parts));
        let dearer = parts - self.price_of(fit);
        if !a_law && !together {
            let more = nameless.coordinates.len() as f64 - fit.coordinates.len() as f64;
            return likelier + f64::max(CHARGE * more, dearer) - RATIO_3;
        }
        likelier + dearer - if together { RATIO_100 } else { RATIO_10 }
    }

    /// The likeliest elastic departure without a name.
    fn elastic(&self) -> &Fit {
        self.elastic.get_or_init(|| self.extended(&self.base, &NAMELESS))
    }

    /// True of effects together that would not be told from an elastic departure without a name if they left no more than this fit.
    pub(super) fn is_lost_in_nameless(&self, fit: &Fit) -> bool {
        fit.candidates.len() > 1 && self.is_elastic(fit) && self.beyond_elastic(fit, true) <= 0.0
    }

    /// What the freedom of an explanation costs: the amount of each effect, and a charge for every parameter beside it.
    fn price_of(&self, fit: &Fit) -> f64 {
        let of = |candidate: &Candidate| {
            let at = self.candidates.iter().position(|own| own == candidate)?;
            let starts = self.signatures[at].column_iter();
            starts.map(|start| self.price(&DMatrix::from_columns(&[start]))).reduce(f64::max)
        };
        let shapes = fit.coordinates.len() - self.base.coordinates.len() - fit.candidates.len();
        fit.candidates.iter().filter_map(of).sum::<f64>() + CHARGE * shapes as f64
    }

    /// What it costs that plausible amounts, a column each, are free, as a difference of sums of squares (Laplace's): little where these data, with modulus and exponent free, can tell little of
    /// them.
    fn price(&self, plausible: &DMatrix<f64>) -> f64 {
        Fold::of(rest_of(plausible, &basis(&self.base.jacobian))).price()
    }

    /// A relaxation of one or two times must be three times likelier than that of a power law, and what is named beside it a hundred times likelier than that alone. A power law may be the material's,
    /// as finite elements have it, or one that carries its memory in any other way, such as one of the force itself: beside Prony series a second term makes up for that.
    fn beyond_spectrum(&self, best: &Explanation) -> Option<f64> {
        relaxes(best).then_some(())?;
        let needed = if best.fit.candidates.len() > 1 { RATIO_100 } else { RATIO_3 };
        Some(self.spectral() - best.score() - needed)
    }

    /// Score of the likeliest power law.
    fn spectral(&self) -> f64 {
        *self.spectral.get_or_init(|| {
            let spectrum = self.extended(&self.base, &SPECTRUM);
            let carried = self.extended(&spectrum, &MEMORY);
            self.solved(&spectrum).iter().chain([&spectrum, &carried]).map(score).fold(f64::INFINITY, f64::min)
        })
    }

    /// True where a power law is so much likelier than an explanation that none like it will be named.
    pub(super) fn is_rather_spectral(&self, explanation: &Explanation) -> bool {
        self.beyond_spectrum(explanation).is_some_and(|by| by < -BEHIND)
    }

    /// What is named beside a relaxation that needs two times may be all that a third one leaves: it must be a hundred times likelier than that. Two times stand for a spectrum
    /// often enough: what they leave of it is no evidence for something else, however little it is. Where one time and the same beside it leave no more than noise either, it is
    /// not the times that it stands for.
    fn beyond_more_times(&self, best: &Explanation, singles: &[Explanation], pairs: &[Explanation]) -> Option<f64> {
        let two = beside_two_times(best)?;
        let beside = |e: &Explanation| e.fit.candidates.iter().find(|c| c.effect.code != two.effect.code).copied();
        let one = |e: &Explanation| e.fit.candidates.iter().any(|c| *c.effect == relaxation::ONE);
        if pairs.iter().any(|e| one(e) && beside(e) == beside(best) && e.holds()) {
            return None;
        }
        let alone = singles.iter().find(|e| e.fit.candidates == [*two])?;
        let three = self.extended(&alone.fit, &Candidate { effect: &relaxation::ONE, owner: two.owner });
        let three = self.solved(&three).unwrap_or(three);
        let left = alone.score() - best.score() - SPECTRAL * alone.gain;
        Some(left.min(score(&three) - best.score() - RATIO_100))
    }
}
