//! What finite elements of the whole path add to the chain.
//!
//! The chain puts effects together stage by stage: a second term is a second force, relaxation a convolution. Finite elements of the same
//! path at one point of the parameters tell what that misses; near that point the difference hardly changes, so it is added as it is.

mod contains;
mod follow;
mod history;
mod job;
mod law;
mod path;
mod run;
mod twin;
mod window;

use std::sync::Arc;

use rayon::prelude::*;

use super::predict::Chain;
use super::{Model, Passage};
use crate::effect::{
    adhesion, friction, lag, numerics, poisson, radius, relaxation, second_term, softening, thickness,
};
use crate::solid::contact::{Ball, Interface};
use crate::solid::law::{Hyperfoam, Material, OgdenRoxburgh, PronyTerm, Term};
use crate::solid::model::{CLOSER, Resolution, Simulation, Specimen};
use crate::solid::solve::{Motion, SolveError};
use contains::has;
use history::History;
use job::Job;
use path::{between, later, smooth, straight_pieces};
pub use run::Detail;
use run::{Block, Curve, Fine};
pub use window::Window;

/// Force that the chain misses, run by run, for a model and those near it.
#[derive(Debug, Clone, PartialEq)]
pub struct Whole {
    /// The model that it was found at: it is in proportion to the modulus of that.
    place: Model,
    /// How finely.
    detail: Detail,
    /// What finite elements add and what a few places miss of the motion, N at the places of every passage.
    missed_n: Vec<Vec<(f64, f64)>>,
    /// How large the effect is that the former is in proportion to; none where there are several.
    size: Option<(&'static str, f64)>,
    /// Codes of the effects that the finite elements contain.
    codes: Vec<&'static str>,
}

impl Whole {
    /// The model that it was found at, without what finite elements add.
    #[must_use]
    pub fn place(&self) -> &Model {
        &self.place
    }

    /// How finely it was solved.
    #[must_use]
    pub fn detail(&self) -> Detail {
        self.detail
    }

    /// True when the finite elements contain the effect.
    #[must_use]
    pub fn covers(&self, code: &str) -> bool {
        self.codes.contains(&code)
    }

    /// True for a model whose exponent is another one by so much that what is missed is not the same.
    #[must_use]
    pub fn is_far_from(&self, model: &Model) -> bool {
        const FAR: f64 = 1.3;
        self.moved(model) > FAR
    }

    /// Ratio, the larger over the smaller, of a model's exponent and that which it was found at.
    #[must_use]
    pub fn moved(&self, model: &Model) -> f64 {
        let ratio = model.alpha / self.place.alpha;
        ratio.max(ratio.recip())
    }

    /// What is missed in a run of `places` places by a model, N; nothing for a run that it was not made for.
    pub(super) fn missed_n(&self, run: usize, places: usize, model: &Model) -> impl Iterator<Item = f64> + '_ {
        let own = self.missed_n.get(run).filter(|missed| missed.len() == places);
        let stiffer = model.mu_mpa / self.place.mu_mpa;
        // without the effect nothing of it is missed
        let larger = self.size.map_or(1.0, |(code, size)| size_of(model, code) / size);
        own.into_iter().flatten().map(move |(solved, places)| stiffer * (larger * solved + places))
    }
}

/// How large an effect is that the chain is rough about: what it misses is about in proportion to that.
fn size_of(model: &Model, code: &str) -> f64 {
    let own = model.settings.iter().filter(|s| s.effect.code == code);
    own.map(|s| match code {
        // all of the force, and again its own law alone
        _ if code == second_term::EFFECT.code => s.values[0] / (1.0 + s.values[0]),
        // amplitudes, each followed by its time or place where it has one
        _ => s.values.iter().step_by(2).sum::<f64>(),
    })
    .sum()
}

/// The only effect of a model that the chain is rough about, with its size; none where there are several, or nothing of it.
fn size(model: &Model) -> Option<(&'static str, f64)> {
    let mut codes: Vec<&'static str> =
        model.settings.iter().map(|s| s.effect.code).filter(|code| ROUGH.contains(code)).collect();
    codes.dedup();
    match codes[..] {
        [code] => Some((code, size_of(model, code))).filter(|(_, size)| size.abs() > LEAST_SIZE),
        _ => None,
    }
}

/// Codes of what finite elements of the path are needed for.
pub const ROUGH: [&str; 4] =
    [relaxation::ONE.code, second_term::EFFECT.code, softening::EFFECT.code, friction::EFFECT.code];
/// Least size of an effect that others are compared with.
const LEAST_SIZE: f64 = 1e-4;

/// True when a model contains what the chain, on the few places of a run, is measurably wrong about.
#[must_use]
pub fn is_rough(model: &Model) -> bool {
    needs_solve(model) || model.settings.iter().any(|s| s.effect.code == lag::FILTER.code)
}

fn needs_solve(model: &Model) -> bool {
    model.settings.iter().any(|s| ROUGH.contains(&s.effect.code))
}

/// The model without what finite elements of the path do not contain: adhesion is another law there, a base that slides in
/// part is none, and an error of the numerics is not theirs.
fn solvable(model: &Model) -> Model {
    let mut out = model.clone();
    let foreign = [adhesion::EFFECT.code, numerics::EFFECT.code];
    out.settings.retain(|s| !foreign.contains(&s.effect.code) && s.effect != &thickness::SLIDING);
    out.whole = None;
    out
}

/// What was solved for the first run of a kind, as another run of it sees it.
struct Added<'a> {
    job: &'a Job,
    /// The path of the first run.
    turns: &'a [(f64, f64)],
    /// That of the other one.
    own: Curve,
}

impl Added<'_> {
    /// What finite elements add at a point (s, mm) of the run's own motion, N.
    fn at(&self, history: History, (time_s, depth_mm): (f64, f64)) -> f64 {
        // the same number of turns is the same motion, a little earlier or later, deeper or less deep
        let same = history == History::Turns && self.own.len() == self.turns.len();
        let place = if same {
            history.place(&self.own, (time_s, depth_mm))
        } else {
            history.place(self.turns, (time_s - later(self.turns, &self.own), depth_mm))
        };
        match history {
            // in time the solver's own steps are as far off, the other way: straight connections are nearer (tests/whole_paths.rs, 0.65 and 0.71 %)
            History::Time => between(&self.job.added, place),
            History::Turns | History::None => smooth(&self.job.added, &self.job.corners, place),
        }
    }
}

impl Chain {
    /// Solves the runs with finite elements at a model. `windows` are what the readings at the places of every run are means of. `kinds` tells
    /// which runs follow the same path on a fresh spot (equal numbers): one of each is solved, in some detail.
    ///
    /// # Errors
    /// The first solve that fails.
    pub fn whole(
        &self,
        model: &Model,
        contact_mm: &[f64],
        windows: &[Vec<Window>],
        kinds: &[usize],
        detail: Detail,
    ) -> Result<Arc<Whole>, SolveError> {
        let bare = solvable(model);
        let remembers = has(&bare, &softening::EFFECT);
        let kind = |run: usize| (kinds[run], remembers && self.passages[run].pressed_before_mm > 0.0);
        let first: Vec<usize> = (0..kinds.len()).filter(|i| (0..*i).all(|j| kind(j) != kind(*i))).collect();
        // what is solved once for a kind is told at each run's own places: runs of a kind begin a few readings apart, and where a ramp turns that matters
        let fine: Vec<Fine> = (0..kinds.len())
            .into_par_iter()
            .map(|run| self.fine(model, (run, &windows[run]), contact_mm[run], remembers))
            .collect();
        let history = History::of(&bare);
        let (mut jobs, of) =
            if needs_solve(&bare) { self.jobs(&fine, &first, history) } else { (Vec::new(), Vec::new()) };
        match history {
            History::None => jobs.par_iter_mut().try_for_each(|job| {
                job.added = self.added_by_law((&bare, detail), job)?;
                Ok::<(), SolveError>(())
            })?,
            _ => self.follow((&bare, detail), &mut jobs, history)?,
        }
        let solved = |one: &Fine| first.iter().position(|run| kind(*run) == kind(one.run)).and_then(|at| of.get(at));
        let missed_n = fine.par_iter().map(|one| {
            let added = solved(one).map(|(job, turns)| Added {
                job: &jobs[*job],
                turns,
                own: history.path(straight_pieces(&one.path)),
            });
            self.missed((model, &bare), one, &windows[one.run], contact_mm[one.run], added.as_ref())
        });
        let missed_n = missed_n.collect();
        let codes = bare.settings.iter().map(|s| s.effect.code).collect();
        let place = Model { whole: None, ..model.clone() };
        Ok(Arc::new(Whole { place, detail, missed_n, size: size(&bare), codes }))
    }

    fn fine(&self, model: &Model, (run, windows): (usize, &[Window]), contact_mm: f64, remembers: bool) -> Fine {
        let recorded = self.passages[run].refined(windows);
        let depth_mm = self.ball_depth(model, &recorded, contact_mm);
        let before_mm =
            if remembers { model.before_mm(recorded.pressed_before_mm, &recorded.depth_mm, &depth_mm) } else { 0.0 };
        let path = recorded.time_s.iter().copied().zip(depth_mm).collect();
        Fine { run, recorded, path, before_mm }
    }

    /// What the chain misses (N) at the places of a run: what finite elements add on a path, given with the run's own turns, and what few places miss
    /// of the motion.
    fn missed(
        &self,
        (model, bare): (&Model, &Model),
        fine: &Fine,
        windows: &[Window],
        contact_mm: f64,
        added: Option<&Added<'_>>,
    ) -> Vec<(f64, f64)> {
        let passage = &self.passages[fine.run];
        let depth_mm: Vec<f64> = fine.path.iter().map(|p| p.1).collect();
        let history = History::of(bare);
        let added_n = |point: (f64, f64)| added.map_or(0.0, |added| added.at(history, point));
        let added: Curve = fine.path.iter().map(|point| (point.0, added_n(*point))).collect();
        let at_fine = self.on_ball(bare, &Passage { depth_mm, ..fine.recorded.clone() });
        let chain: Curve = fine.path.iter().zip(at_fine).map(|(point, force_n)| (point.0, force_n)).collect();
        let coarse_mm = self.ball_depth(model, passage, contact_mm);
        let at_places = self.on_ball(bare, &Passage { depth_mm: coarse_mm, ..passage.clone() });
        let each = passage.time_s.iter().zip(windows).zip(at_places);
        each.map(|((t, window), force_n)| (window.mean(&added, *t), window.mean(&chain, *t) - force_n)).collect()
    }

    /// Ball and block of a run.
    fn block(&self, run: usize) -> Block {
        let p = &self.passages[run];
        (p.geometry, p.specimen, p.indenter)
    }

    fn nu(&self, model: &Model, passage: &Passage) -> f64 {
        self.library.families[passage.geometry].geometry.nu + model.first(&poisson::EFFECT, 0)
    }

    fn simulation(
        &self,
        (model, detail): (&Model, Detail),
        passage: &Passage,
        motion: Motion,
    ) -> Result<Simulation, SolveError> {
        let geometry = &self.library.families[passage.geometry].geometry;
        let nu = self.nu(model, passage);
        let mut terms = vec![Term { mu_mpa: model.mu_mpa, alpha: model.alpha, nu }];
        for second in model.of(&second_term::EFFECT) {
            if let [ratio, alpha] = second.values[..] {
                terms.push(Term { mu_mpa: ratio * model.mu_mpa, alpha, nu });
            }
        }
        let prony = model.relaxing().into_iter().filter(|(g, _)| *g > 0.0);
        let prony: Vec<PronyTerm> = prony.map(|(g, tau_s)| PronyTerm { g, k: g, tau_s }).collect();
        let mut material: Material = Hyperfoam::new(terms)?.into();
        if !prony.is_empty() {
            material = material.relaxing(prony)?;
        }
        if let Some(soft) = model.of(&softening::EFFECT).find(|s| s.values[0] > LEAST_LOSS) {
            let (r, m, beta) = softening::of_points(soft.values[0], soft.values[1]);
            material = material.softening(OgdenRoxburgh::new(r, m * model.mu_mpa, beta)?);
        }
        let height_mm = geometry.specimen.height_mm + model.height_error_mm(passage.specimen);
        Ok(Simulation {
            material,
            specimen: Specimen { height_mm, ..geometry.specimen },
            ball: Ball { radius_mm: geometry.ball_mm + model.first(&radius::EFFECT, passage.indenter) },
            interface: Interface { friction: model.first(&friction::EFFECT, 0), ..Interface::default() },
            motion,
            resolution: match detail {
                Detail::Names if History::of(model) == History::None => Resolution::Refined(CLOSER),
                Detail::Names if has(model, &friction::EFFECT) => Resolution::Standard,
                Detail::Names if has(model, &second_term::EFFECT) => Resolution::Refined(FINER),
                _ => Resolution::Refined(COARSE),
            },
        })
    }
}

/// Divisor of the element sizes for histories, which are a difference of two solves on one mesh: what they add is met by 0.2 % less well than on
/// the standard mesh, in a third of the time.
const COARSE: f64 = 0.6;
/// The same for a second term with a history, which is half of the force itself: 0.32 % of what it adds is missed, as against 0.26 % on the standard mesh, in 60 % of the time
/// (tests/whole_paths.rs).
const FINER: f64 = 0.8;
/// Least loss that a material point is given.
const LEAST_LOSS: f64 = 1e-4;

#[cfg(test)]
mod tests {
    use super::*;

    /// Nearness is one of exponents, whatever the modulus, up and down.
    #[test]
    fn a_solve_is_far_from_another_exponent() {
        let place = Model::base(0.1, 8.0);
        let whole = Whole { place, detail: Detail::Names, missed_n: Vec::new(), size: None, codes: Vec::new() };
        assert!(!whole.is_far_from(&Model::base(5.0, 8.0)) && !whole.is_far_from(&Model::base(0.1, 9.5)));
        assert!(whole.is_far_from(&Model::base(0.1, 11.0)) && whole.is_far_from(&Model::base(0.1, 6.0)));
    }
}
