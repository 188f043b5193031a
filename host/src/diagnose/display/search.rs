//! Which effects explain a residual: a fit of every effect, and of pairs where one is not enough.

use nalgebra::{DMatrix, DVector};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use rayon::prelude::*;

use super::effect::{CATALOGUE, Effect};
use super::evidence::{Adequacy, Panel, Spaces};
use super::fit::{Fit, Problem};
use super::law::{self, Law, Setting};
use super::margin::placebos;
use super::noise::Noise;
use crate::diagnose::evidence::{basis, rest_of};
use crate::infer::covariance::Factor;
use crate::infer::lowrank::Fold;
use crate::infer::presence::CHARGE;
use crate::infer::product::inner;

/// Relative error of an effect as the catalogue writes it down, along smooth shapes of time in every command by itself: nature's friction,
/// creep and steel are no closer to these laws.
const FORM_ERROR: f64 = 0.05;
/// Starts of an effect that are followed, the most promising first.
const DESCENTS: usize = 3;
/// Singles that are extended when one effect is not enough.
const EXTENDED: usize = 3;
/// Placebo effects that a real one must beat.
const PLACEBOS: usize = 40;
const SEED: u64 = 0x706c_6163;

/// A fit with what was found out about it.
#[derive(Debug, Clone)]
pub struct Explanation {
    /// The fit.
    pub fit: Fit,
    /// Sum of squares less what its effects may be wrong by.
    pub discounted: f64,
    /// What it leaves.
    pub adequacy: Adequacy,
    /// It beats the largest of the catalogue in clean twins.
    pub beats_noise: bool,
    /// It predicts left-out commands better.
    pub predicts: bool,
    /// It beats placebo effects.
    pub beats_placebo: bool,
}

impl Explanation {
    /// Sum of squares with the charge for parameters.
    #[must_use]
    pub fn score(&self) -> f64 {
        self.discounted + CHARGE * self.fit.coordinates.len() as f64
    }

    /// Every demand on a name is met.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.adequacy.passes() && self.beats_noise && self.predicts && self.beats_placebo && !self.fit.at_bound
    }
}

/// Everything a search needs.
#[derive(Debug)]
pub struct Search<'a> {
    /// Data.
    pub problem: &'a Problem<'a>,
    /// Noise.
    pub noise: &'a Noise,
    /// Margins.
    pub panel: &'a Panel,
    /// Effects of this channel.
    pub effects: Vec<&'static Effect>,
    /// Fit of the base.
    pub base: Fit,
    /// Signature of every effect at the base fit.
    pub signatures: Vec<DMatrix<f64>>,
    /// What they hold of clean twins.
    pub spaces: Spaces,
}

/// Effects of a channel.
#[must_use]
pub fn effects(problem: &Problem<'_>) -> Vec<&'static Effect> {
    CATALOGUE.iter().copied().filter(|e| e.channel == problem.design.channel).collect()
}

/// What a plausible amount of an effect changes, whitened: a column for every start of its shape.
#[must_use]
pub fn signature(problem: &Problem<'_>, at: &Fit, effect: &'static Effect) -> DMatrix<f64> {
    let columns: Vec<DVector<f64>> = law::plausible(effect)
        .into_par_iter()
        .map(|setting| &at.residual - problem.residual(&with(&at.law, setting)))
        .collect();
    DMatrix::from_columns(&columns)
}

/// A law with one more effect.
#[must_use]
pub fn with(law: &Law, setting: Setting) -> Law {
    let mut more = law.clone();
    more.settings.push(setting);
    more
}

impl Search<'_> {
    /// The best fit of a law with one more effect, from its most promising starts.
    #[must_use]
    pub fn extended(&self, from: &Law, effect: &'static Effect) -> Option<Fit> {
        let mut starts: Vec<(f64, Law)> = law::starting(effect)
            .into_par_iter()
            .map(|setting| {
                let law = with(from, setting);
                (self.problem.residual(&law).norm_squared(), law)
            })
            .collect();
        starts.sort_by(|a, b| a.0.total_cmp(&b.0));
        let fits = starts.into_par_iter().take(DESCENTS).map(|(_, law)| self.problem.fit(&law));
        let fits: Vec<Fit> = fits.collect();
        fits.into_iter().min_by(|a, b| a.square.total_cmp(&b.square))
    }

    /// What was found out about a fit that extends another by an effect whose space is given.
    #[must_use]
    pub fn judged(&self, fit: Fit, before: &Fit, (spaces, at): (&Spaces, usize)) -> Explanation {
        let errors = Fold::of(form_errors(self.problem, &fit));
        // what the effects before may be wrong by is no evidence for one more
        let allowed = Fold::of(form_errors(self.problem, before));
        let square = |of: &Fit, beside: &Fold| beside.taken_off(&of.residual).norm_squared();
        let gain = square(before, &allowed) - square(&fit, &allowed);
        let added = fit.coordinates.len() - before.coordinates.len();
        Explanation {
            discounted: square(&fit, &errors),
            adequacy: self.panel.read(&fit, &self.problem.whitening, errors.columns()),
            beats_noise: spaces.of_gain(at, gain) > self.spaces.threshold,
            predicts: left_out(self.problem, &fit) < left_out(self.problem, before),
            beats_placebo: before.square - fit.square > self.placebo(before, added),
            fit,
        }
    }

    /// Largest improvement of the sum of squares that any placebo with so many parameters brings.
    fn placebo(&self, before: &Fit, parameters: usize) -> f64 {
        let mut chance = Pcg64::seed_from_u64(SEED);
        let own = parameters.max(1);
        let columns = placebos(self.problem, PLACEBOS * own, || chance.random::<f64>());
        let rest = rest_of(&columns, &basis(&before.jacobian));
        let gains = (0..PLACEBOS).map(|i| {
            let few = rest.columns(i * own, own).into_owned();
            basis(&few).tr_mul(&before.residual).norm_squared()
        });
        gains.fold(0.0, f64::max)
    }

    /// Explanations by one effect, the best first.
    #[must_use]
    pub fn singles(&self) -> Vec<Explanation> {
        let each = self.effects.iter().enumerate().filter_map(|(at, effect)| {
            let fit = self.extended(&self.base.law, effect)?;
            Some(self.judged(fit, &self.base, (&self.spaces, at)))
        });
        sorted(each.collect())
    }

    /// Explanations by one effect more than those given, the best first.
    #[must_use]
    pub fn pairs(&self, than: &[Explanation]) -> Vec<Explanation> {
        let mut seen: Vec<Vec<(&str, &str)>> = Vec::new();
        let mut list = Vec::new();
        for before in than.iter().take(EXTENDED) {
            for effect in &self.effects {
                let own = before.fit.effects();
                let mut key: Vec<_> =
                    own.iter().map(|e| (e.code, e.form)).chain([(effect.code, effect.form)]).collect();
                key.sort_unstable();
                if own.iter().any(|e| e.code == effect.code) || seen.contains(&key) {
                    continue;
                }
                seen.push(key);
                let signature = signature(self.problem, &before.fit, effect);
                let spaces = Spaces::new(&[signature], &before.fit, &self.problem.whitening, self.noise);
                if let Some(fit) = self.extended(&before.fit.law, effect) {
                    list.push(self.judged(fit, &before.fit, (&spaces, 0)));
                }
            }
        }
        sorted(list)
    }
}

fn sorted(mut list: Vec<Explanation>) -> Vec<Explanation> {
    list.sort_by(|a, b| a.score().total_cmp(&b.score()));
    list
}

/// What the effects of a fit add may be wrong by a small share of itself, in each command by itself and smoothly along it.
fn form_errors(problem: &Problem<'_>, fit: &Fit) -> DMatrix<f64> {
    let design = problem.design;
    let mut bare = fit.law.clone();
    bare.settings.clear();
    if fit.law.settings.is_empty() {
        return DMatrix::zeros(design.samples(), 0);
    }
    let added = problem.plain(&bare) - problem.plain(&fit.law);
    let mut columns = Vec::new();
    for condition in 0..design.conditions.len() {
        for shape in 0..3 {
            let mut column = DVector::zeros(added.len());
            for (s, series) in design.series.iter().enumerate().filter(|(_, s)| s.condition == condition) {
                let count = series.time_s.len();
                for k in 0..count {
                    let at = design.first(s) + k;
                    let x = 2.0 * k as f64 / count as f64 - 1.0;
                    column[at] = FORM_ERROR * added[at] * [1.0, x, 1.5 * x * x - 0.5][shape];
                }
            }
            if column.norm() > 0.0 {
                problem.whitening.apply(&mut column);
                columns.push(column);
            }
        }
    }
    if columns.is_empty() { DMatrix::zeros(design.samples(), 0) } else { DMatrix::from_columns(&columns) }
}

/// Sum of squares of every command as the others predict it, to first order about the fit. Where there is one command only, its thirds stand
/// for commands: what a step up shows is then predicted from the step down. Infinite where a number is none.
fn left_out(problem: &Problem<'_>, fit: &Fit) -> f64 {
    let Some(groups) = problem.whitening.groups(problem.design) else { return f64::INFINITY };
    let whole = inner(&fit.jacobian, &fit.jacobian);
    let count = fit.jacobian.ncols();
    let mut all = fit.jacobian.clone().insert_column(count, 0.0);
    all.set_column(count, &fit.residual);
    let weighed = problem.whitening.weighed(&all);
    groups.iter().map(|group| predicted_square(fit, &whole, &group.left(&weighed))).sum()
}

/// Sum of squares of a group as all others predict it, from its derivative and residual (the last column). `whole` is the information of all.
fn predicted_square(fit: &Fit, whole: &DMatrix<f64>, group: &DMatrix<f64>) -> f64 {
    let count = fit.jacobian.ncols();
    let (own, residual) = (group.columns(0, count).into_owned(), group.column(count).into_owned());
    let mut rest = whole - inner(&own, &own);
    for (i, c) in fit.coordinates.iter().enumerate() {
        // a parameter that only these rows show stays where it is
        let span = c.of(c.bounds.1) - c.of(c.bounds.0);
        rest[(i, i)] += 4.0 / span.powi(2) + 1e-9 * whole[(i, i)];
    }
    let moved = Factor::of(&rest).map(|factor| factor.solve(&own.tr_mul(&residual)));
    moved.map_or(f64::INFINITY, |m| (&residual + &own * m).norm_squared())
}

/// Largest reading of a plausible amount, over the threshold: whether a design could see an effect.
#[must_use]
pub fn visibility(search: &Search<'_>, at: usize) -> f64 {
    let signature = &search.signatures[at];
    let seen = signature.column_iter().map(|column| search.spaces.read(at, &column.into_owned()));
    seen.fold(f64::NEG_INFINITY, f64::max) - search.spaces.threshold
}
