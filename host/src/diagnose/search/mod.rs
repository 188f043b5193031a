//! Which effects explain a residual: fits of every candidate, and of pairs where one is not enough.

mod before;
mod begin;
mod explanation;
mod form_error;
mod held;
mod left_out;
mod nameless;
mod rounds;
mod signature;
mod solve;
mod state;

use std::sync::OnceLock;

use lut_gen::effect::{CATALOGUE, Owner, relaxation, sensor_creep, thickness};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::check::Check;
use super::coordinate::{Candidate, Coordinate, coordinates};
use super::design::{Branch, Design};
use super::evidence::{self, Adequacy, Panel, Spaces};
use super::fit::{Fit, Problem, freedom};
use super::margin;
use super::noise::{self, SensorNoise};
use super::prepared::Prepared;
use before::Before;
pub(super) use explanation::names;
pub(super) use explanation::score;
pub use explanation::{Explanation, RATIO_100};
use explanation::{plain, sorted};
pub(super) use form_error::form_error;
pub use form_error::{allowed, form_error_range};
pub(super) use held::Found;
pub(super) use left_out::known_before;
use left_out::left_out;
pub(super) use nameless::{is_nameless, rival};
pub(super) use signature::changes;
pub use signature::signature;
use solve::Aim;
pub use state::Search;

/// Factor on the errors of effects ([`form_error`]) where the question is whether an explanation leaves more than noise: a tenth more than a strong effect's own error is no
/// reason to call it unknown.
const TOLERANT: f64 = 1.5;
/// Singles and pairs that are extended when one, or two, effects are not enough.
const EXTENDED: usize = 5;
/// Part of what the best of them explains that another one must explain to be extended: what is far behind is found as the best's partner.
const RIVAL: f64 = 0.25;
/// Partners that each is tried with, by how much of its residual they could explain; more where fewer are extended.
const PARTNERS: usize = 6;
/// Fits of several effects that are looked at closely, the best first.
const JUDGED: usize = 12;

impl<'a> Search<'a> {
    /// Of what is prepared.
    #[must_use]
    pub fn new(prepared: Prepared<'a>, candidates: Vec<Candidate>) -> Self {
        let Prepared { problem, mut base, noise } = prepared;
        let curves = Problem::curves(problem.design, problem.chain, &base.model, &problem.contacts_mm);
        let margins = margin::margins(&problem, &curves);
        let plausible = noise::plausible(problem.design, &curves, &noise);
        let colours = |(weight, sensor): &(f64, SensorNoise)| {
            problem.whitening.colours(problem.design, &curves, sensor).map(|colours| (*weight, colours))
        };
        let plausible: Vec<_> = plausible.par_iter().filter_map(colours).collect();
        let twins = evidence::twins(&problem.whitening, &noise, &plausible, &problem.used, evidence::TWINS);
        base.reach_in(&twins);
        let mut signatures: Vec<DMatrix<f64>> = candidates.par_iter().map(|c| signature(&problem, &base, c)).collect();
        signatures.push(nameless::departure(&problem, &base));
        let spaces = Spaces::new(&signatures, &base.jacobian, &twins);
        let none = DMatrix::zeros(problem.whitening.residuals(), 0);
        let panel = Panel::new(&margins, &twins);
        let adequacy = Adequacy::of(&base, &margins, &panel, &none, &twins);
        let (spectral, elastic) = (OnceLock::new(), OnceLock::new());
        Self {
            problem,
            noise,
            base,
            curves,
            margins,
            panel,
            twins,
            adequacy,
            candidates,
            signatures,
            spaces,
            spectral,
            elastic,
        }
    }

    /// The same with noise and contact points as a fit sees them; none where that finds no noise, or one in which no foam at all is the likeliest base: where spots
    /// differ by a tenth as a gain, each may well have none.
    #[must_use]
    pub fn about(&self, fit: &Fit, stated_n: Option<f64>) -> Option<Self> {
        let own = Prepared { problem: self.problem.clone(), base: self.base.clone(), noise: self.noise.clone() };
        let (softest, _) = Coordinate::LnMu.bounds();
        let told = own.about(&fit.model, stated_n).filter(|told| told.base.x[0] > softest + 1e-2)?;
        Some(Self::new(told, self.candidates.clone()))
    }

    /// What noise alone leaves of a fit, as a sum of squares: points that count less its parameters.
    fn freedom(&self, fit: &Fit) -> f64 {
        freedom(&self.problem.used, fit)
    }

    /// Largest reading of any candidate, or of an elastic departure without a name, at the base.
    #[must_use]
    pub fn catalogue(&self) -> f64 {
        (0..self.signatures.len()).map(|at| self.spaces.read(at, &self.base.residual)).fold(f64::MIN, f64::max)
    }
}

/// Candidates that a design can have at all: an effect of the clock needs a clock.
#[must_use]
pub fn candidates(design: &Design) -> Vec<Candidate> {
    let mut list = Vec::new();
    let clock = design.series.iter().all(|s| s.start_s.is_some());
    let has = |branch: Branch| design.series.iter().any(|s| s.nodes.iter().any(|n| n.branch == branch));
    let cycles = design.series.iter().any(|s| s.cycle > 1);
    let owners = |of: &dyn Fn(&super::design::Series) -> usize| {
        let mut all: Vec<usize> = design.series.iter().map(of).collect();
        all.sort_unstable();
        all.dedup();
        all
    };
    // a coupon has no base, but a height that may be wrong
    let measured = || {
        let mut all = owners(&|s| s.specimen);
        all.extend(design.checks.iter().filter_map(Check::coupon_of));
        all.sort_unstable();
        all.dedup();
        all
    };
    for effect in CATALOGUE {
        let possible = match effect.code {
            "drift" => clock,
            // every time is recorded on the one clock: no run tells its gain
            "time-gain" => false,
            "softening" => cycles || has(Branch::Unloading),
            // what only ever rises turns nowhere
            _ if *effect == sensor_creep::HYSTERESIS => cycles || has(Branch::Unloading),
            "contact-offset" => design.zero_is_contact,
            _ => true,
        };
        if !possible {
            continue;
        }
        match effect.owner {
            // of one specimen it is that specimen's
            Owner::All if *effect == thickness::EVERY_HEIGHT && measured().len() < 2 => {}
            Owner::All => list.push(Candidate { effect, owner: 0 }),
            Owner::Indenter => {
                let balls = owners(&|s| s.indenter);
                if balls.len() > 1 {
                    list.extend(balls.into_iter().map(|owner| Candidate { effect, owner }));
                }
            }
            Owner::Specimen => {
                let specimens = if *effect == thickness::HEIGHT { measured() } else { owners(&|s| s.specimen) };
                list.extend(specimens.into_iter().map(|owner| Candidate { effect, owner }));
            }
        }
    }
    list
}

impl Search<'_> {
    /// What was found out about a fit, compared with the one it extends by a candidate whose space is given.
    #[must_use]
    pub fn judged(&self, fit: Fit, before: &Before, space: (&Spaces, usize)) -> Explanation {
        let wrong = TOLERANT * form_error(&self.problem, &fit);
        let adequacy = Adequacy::of(&fit, &self.margins, &self.panel, &wrong, &self.twins);
        let gain = before.gain_of(&fit);
        let placebo = before.placebo(&self.problem, fit.coordinates.len() - before.fit.coordinates.len());
        let design = self.problem.design;
        // what has no cause has no form to be wrong by: what a form may be wrong by is allowed for or not, whichever is better for it
        let beyond_causeless = before.nameless - score(&fit);
        Explanation {
            beats_noise: space.0.of_gain(space.1, gain) > self.spaces.threshold,
            predicts: left_out(design, &fit, &self.problem) < before.left_out,
            beats_placebo: gain > placebo && beyond_causeless > 0.0,
            beyond_causeless,
            adequacy,
            gain,
            fit,
        }
    }

    /// Explanations found before, once more with this search's noise, each from where it was. `singles` are what pairs extend; without them the base is extended.
    #[must_use]
    pub fn again(&self, list: &[Explanation], singles: Option<&[Explanation]>) -> Vec<Explanation> {
        let first = |e: &Explanation| e.fit.candidates[..e.fit.candidates.len() - 1].to_vec();
        let mut extended: Vec<Vec<Candidate>> = Vec::new();
        for e in list {
            if !extended.contains(&first(e)) {
                extended.push(first(e));
            }
        }
        let known: Vec<(&[Candidate], Before)> = extended
            .par_iter()
            .filter_map(|candidates| {
                let fit = match singles {
                    Some(singles) => &singles.iter().find(|s| s.fit.candidates == *candidates)?.fit,
                    None => &self.base,
                };
                Some((candidates.as_slice(), Before::new(&self.problem, fit.clone())))
            })
            .collect();
        let refit = |e: &Explanation| self.problem.refit(&e.fit, &allowed(&self.problem, &e.fit));
        let refits: Vec<Fit> = list.par_iter().map(refit).collect();
        let best = refits.iter().map(score).fold(f64::INFINITY, f64::min);
        let each = list.par_iter().zip(refits).filter_map(|(e, fit)| {
            let (_, before) = known.iter().find(|(candidates, _)| *candidates == first(e))?;
            Some(self.compared(self.believed(&e.fit, fit, best), before))
        });
        sorted(each.collect())
    }

    /// Explanations by one effect, the best first.
    #[must_use]
    pub fn singles(&self) -> Vec<Explanation> {
        let base = Before::new(&self.problem, self.base.clone());
        let each = self.candidates.par_iter().enumerate().map(|(at, candidate)| {
            let fit = self.extended(&self.base, candidate);
            self.judged(fit, &base, (&self.spaces, at))
        });
        let mut each: Vec<Explanation> = each.collect();
        self.nest(&mut each, &base);
        let mut list = sorted(each);
        let before = vec![&base; list.len()];
        self.solve_best(&mut list, &before, Aim::Explain);
        sorted(list)
    }

    /// Two terms of relaxation are found at least as well as one is: begun from it, with a little of a second term.
    fn nest(&self, singles: &mut [Explanation], base: &Before) {
        const SECOND: (f64, f64) = (0.01, 10.0);
        let of = |e: &Explanation, form: &lut_gen::effect::Effect| e.fit.candidates.iter().any(|c| c.effect == form);
        let Some(one) = singles.iter().find(|e| of(e, &relaxation::ONE)).map(|e| e.fit.clone()) else { return };
        let at = self.candidates.iter().position(|c| *c.effect == relaxation::TWO);
        let two = singles.iter_mut().find(|e| of(e, &relaxation::TWO));
        let (Some(two), Some(at)) = (two, at) else { return };
        let list = coordinates(self.problem.design, &two.fit.candidates);
        let tau_s = list[one.x.len() - 1].value(one.x[one.x.len() - 1]);
        let more = [SECOND.0, SECOND.1 * tau_s];
        let place = |i: usize| {
            let (low, high) = list[i].bounds();
            let value = if i < one.x.len() { one.x[i] } else { list[i].of(more[i - one.x.len()]) };
            value.clamp(low, high)
        };
        let fit = self.problem.fit(&two.fit.candidates, &DVector::from_fn(list.len(), |i, _| place(i)));
        if fit.square < two.fit.square {
            let fit = self.problem.refit(&fit, &allowed(&self.problem, &fit));
            *two = self.judged(fit, base, (&self.spaces, at));
        }
    }

    /// Explanations by one effect more than those given, the best first, and whether they are solved: those far behind the best are not judged, and none is solved to the end where the aim is not
    /// reached whatever that leads to.
    #[must_use]
    pub fn one_more(&self, than: &[Explanation], aim: Aim) -> (Vec<Explanation>, bool) {
        let few = self.twins.columns(0, self.twins.ncols().min(200)).into_owned();
        let least = than.first().map_or(0.0, |best| RIVAL * best.gain);
        let idle = |fit: &Fit| than.iter().any(|other| is_idle_form(fit, &other.fit));
        let worth: Vec<usize> =
            (0..than.len()).filter(|at| than[*at].gain >= least && !idle(&than[*at].fit)).take(EXTENDED).collect();
        let many = EXTENDED * PARTNERS / worth.len().max(1);
        let mut tasks: Vec<(usize, Candidate)> = Vec::new();
        for at in worth.iter().copied() {
            let fit = &than[at].fit;
            // what is beside one form of an effect is mostly beside another
            let is_form =
                worth.iter().take_while(|other| **other < at).any(|other| names(&than[*other].fit) == names(fit));
            let others: Vec<Candidate> = self.candidates.iter().filter(|c| other(c, fit)).copied().collect();
            let partners = match is_form {
                // what is missing has bent the base as far as it goes, and from there its own shape says little
                _ if self.is_pinned(fit) => others.len(),
                true => PARTNERS,
                false => many,
            };
            let signatures: Vec<DMatrix<f64>> = others.par_iter().map(|c| signature(&self.problem, fit, c)).collect();
            let spaces = Spaces::new(&signatures, &fit.jacobian, &few);
            let mut promise: Vec<(f64, Candidate)> =
                others.iter().enumerate().map(|(i, c)| (spaces.read(i, &fit.residual), *c)).collect();
            promise.sort_by(|a, b| b.0.total_cmp(&a.0));
            tasks.extend(promise.into_iter().take(partners).map(|(_, c)| (at, c)));
        }
        let mut fits: Vec<(usize, Fit)> =
            tasks.into_par_iter().map(|(at, c)| (at, self.extended(&than[at].fit, &c))).collect();
        fits.sort_by(|a, b| score(&a.1).total_cmp(&score(&b.1)));
        let mut seen: Vec<Vec<(&str, &str, usize)>> = Vec::new();
        fits.retain(|(_, fit)| {
            let mut key: Vec<_> = fit.candidates.iter().map(|c| (c.effect.code, c.effect.form, c.owner)).collect();
            key.sort_unstable();
            let new = !seen.contains(&key);
            seen.push(key);
            new
        });
        // what a richer form has beyond a simpler one may be nothing
        let idle: Vec<bool> =
            fits.iter().map(|(_, fit)| fits.iter().any(|(_, other)| is_idle_form(fit, other))).collect();
        let mut idle = idle.into_iter();
        fits.retain(|_| !idle.next().unwrap_or(false));
        fits.truncate(JUDGED);
        let extended: Vec<Option<Before>> = (0..than.len())
            .into_par_iter()
            .map(|at| {
                let own = fits.iter().any(|(of, _)| *of == at);
                own.then(|| Before::new(&self.problem, than[at].fit.clone()))
            })
            .collect();
        let fits: Vec<(&Before, Fit)> =
            fits.into_iter().filter_map(|(at, fit)| Some((extended[at].as_ref()?, fit))).collect();
        let before: Vec<&Before> = fits.iter().map(|(before, _)| *before).collect();
        let each = fits.into_par_iter().map(|(before, fit)| self.compared(fit, before));
        let mut list: Vec<Explanation> = each.collect();
        let solved = self.solve_best(&mut list, &before, aim);
        (sorted(list), solved)
    }

    /// True where a parameter of the base lies on a bound.
    fn is_pinned(&self, fit: &Fit) -> bool {
        let mut base = fit.coordinates.iter().zip(&fit.x).take(self.base.x.len());
        base.any(|(coordinate, x)| coordinate.is_at_end(*x))
    }

    /// What was found out about a fit with one candidate more than another.
    fn compared(&self, fit: Fit, before: &Before) -> Explanation {
        let signatures: Vec<DMatrix<f64>> =
            fit.candidates.last().map(|last| signature(&self.problem, &before.fit, last)).into_iter().collect();
        let space = Spaces::new(&signatures, &before.fit.jacobian, &self.twins);
        self.judged(fit, before, (&space, 0))
    }
}

/// True where a simpler form of the same effects is no worse, parameters charged: what the richer one has beyond it is nothing.
fn is_idle_form(fit: &Fit, simpler: &Fit) -> bool {
    simpler.x.len() < fit.x.len() && plain(simpler) <= plain(fit) && names(simpler) == names(fit)
}

/// A candidate that is not yet among a fit's, nor another form of one of them.
fn other(candidate: &Candidate, fit: &Fit) -> bool {
    !fit.candidates.iter().any(|c| c.effect.code == candidate.effect.code)
}
