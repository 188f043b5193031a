//! A channel as sets of effects see it: fits of its law, and what is known beforehand.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::design::Design;
use super::effect::{CATALOGUE, Effect, Quantity};
use super::fit::{self, Fit, Problem};
use super::law::{self, Law, Setting};
use super::noise::Noise;
use crate::infer::evidence::Parameter;
use crate::infer::presence;
use crate::infer::sets::{Forward, Misfits};

/// A set of effects of a channel, fitted, with its evidence.
pub type Weighed = crate::infer::sets::Weighed<Fit>;

/// What is believed of a channel; effects by their codes.
pub type Judged = crate::infer::sets::Judged<&'static str>;

/// Relative error of an effect as the catalogue writes it down, along smooth shapes of time in every command by itself: nature's friction,
/// creep and steel are no closer to these laws.
const FORM_ERROR: f64 = 0.05;
/// Starts of an effect that are followed, the most promising first.
const DESCENTS: usize = 3;
/// Root mean square of a misfit, as a part of the span, below which it shows in no reading.
const SEEN: f64 = 1e-4;

/// Everything a search needs.
#[derive(Debug)]
pub struct Search<'a> {
    /// Data.
    pub problem: Problem<'a>,
    /// Noise.
    pub noise: Noise,
    /// Effects of this channel.
    pub effects: Vec<&'static Effect>,
    /// Fit of the base.
    pub base: Fit,
}

impl<'a> Search<'a> {
    /// Of a channel's data, noise and base.
    #[must_use]
    pub fn new(problem: Problem<'a>, base: Fit, noise: Noise) -> Self {
        let effects = CATALOGUE.iter().copied().filter(|e| e.channel == problem.design.channel).collect();
        Self { problem, noise, effects, base }
    }

    /// What a plausible amount of an effect changes beside a fit, whitened: a column for every start of its shape.
    #[must_use]
    pub fn changes(&self, at: &Fit, effect: &'static Effect) -> DMatrix<f64> {
        let change = |setting| &at.residual - self.problem.residual(&with(&at.law, setting));
        let columns: Vec<DVector<f64>> = law::plausible(effect).into_par_iter().map(change).collect();
        DMatrix::from_columns(&columns)
    }
}

/// A law with one more effect.
#[must_use]
pub fn with(law: &Law, setting: Setting) -> Law {
    let mut more = law.clone();
    more.settings.push(setting);
    more
}

impl Forward for Search<'_> {
    type Fit = Fit;
    type Name = &'static str;

    fn base(&self) -> &Fit {
        &self.base
    }

    fn effects(&self) -> &[&'static Effect] {
        &self.effects
    }

    fn name(&self, effect: &&'static Effect) -> &'static str {
        effect.code
    }

    fn is_form_of(&self, one: &&'static Effect, other: &&'static Effect) -> bool {
        one.code == other.code
    }

    fn may_join(&self, set: &[&'static Effect], effect: &&'static Effect) -> bool {
        set.iter().all(|own| own.code != effect.code)
    }

    /// Those of the code, which its forms share. Amounts of one sign have twice the density.
    fn log_odds(&self, effect: &&'static Effect) -> f64 {
        let alike = self.effects.iter().filter(|other| other.code == effect.code).count();
        presence::log_odds(alike, effect.quantities.iter().filter(|q| q.is_one_sided()).count())
    }

    /// From its most promising starts.
    fn extended(&self, from: &Fit, effect: &&'static Effect) -> Option<Fit> {
        let mut starts: Vec<(f64, Law)> = law::starting(effect)
            .into_par_iter()
            .map(|setting| {
                let law = with(&from.law, setting);
                (self.problem.residual(&law).norm_squared(), law)
            })
            .collect();
        starts.sort_by(|a, b| a.0.total_cmp(&b.0));
        let fits: Vec<Fit> = starts.into_par_iter().take(DESCENTS).map(|(_, law)| self.problem.fit(&law)).collect();
        fits.into_iter().min_by(|a, b| a.square.total_cmp(&b.square))
    }

    fn again(&self, fit: &Fit) -> Fit {
        self.problem.standing(&fit.law)
    }

    fn form_error(&self, fit: &Fit) -> DMatrix<f64> {
        form_error(&self.problem, fit)
    }

    fn signature(&self, at: &Fit, effect: &&'static Effect) -> (DMatrix<f64>, Parameter) {
        (self.changes(at, effect), Quantity::in_plausible_ones(effect.quantities))
    }
}

impl Misfits for Search<'_> {
    type Model = Law;

    fn readings(&self) -> usize {
        self.problem.design.samples()
    }

    fn model(&self, set: &Weighed, columns: &DMatrix<f64>, amounts: Option<&DVector<f64>>) -> (Law, DVector<f64>) {
        let x = DVector::from_column_slice(&set.evidence.x);
        let beside = amounts.map_or_else(|| DVector::zeros(columns.nrows()), |amounts| columns * amounts);
        (fit::at(&set.fit.law, &set.fit.coordinates, &x), beside)
    }

    fn left(&self, law: &Law, is_kept: &dyn Fn(usize) -> bool, beside: &DVector<f64>) -> f64 {
        let kept = law.settings.iter().enumerate().filter(|(at, _)| is_kept(*at));
        let shown = Law { settings: kept.map(|(_, setting)| setting.clone()).collect(), ..law.clone() };
        let base = Law { settings: Vec::new(), ..law.clone() };
        plainly(&self.problem, &shown, beside, &base)
    }

    /// As a share of the span of the readings, whose zero is none.
    fn left_share(&self, law: &Law, beside: &DVector<f64>) -> f64 {
        plainly(&self.problem, law, beside, law) / self.problem.design.span
    }

    fn seen(&self) -> f64 {
        SEEN * self.problem.design.span
    }

    fn explained(&self, _: &Fit) -> Option<f64> {
        None
    }
}

/// Root mean square of what a plain fit of the base's parameters of a law leaves of readings as another law
/// has them, with something beside these.
fn plainly(problem: &Problem<'_>, shown: &Law, beside: &DVector<f64>, from: &Law) -> f64 {
    let mut design: Design = problem.design.clone();
    let mut at = 0;
    for series in &mut design.series {
        let more = beside.rows(at, series.output.len());
        at += series.output.len();
        series.output = shown.predict(series).iter().zip(more.iter()).map(|(y, more)| y + more).collect();
    }
    let plain = Problem { used: problem.used.clone(), ..Problem::unweighted(&design) };
    let fit = plain.fit_base(from);
    let compared = design.series.iter().zip(&plain.used).filter(|(_, used)| **used);
    let count: usize = compared.map(|(s, _)| s.count()).sum();
    (fit.square / count.max(1) as f64).sqrt()
}

/// What the effects of a fit add may be wrong by a small share of itself, in each command by itself and smoothly along it.
fn form_error(problem: &Problem<'_>, fit: &Fit) -> DMatrix<f64> {
    let design = problem.design;
    if fit.law.settings.is_empty() {
        return DMatrix::zeros(design.samples(), 0);
    }
    let bare = Law { settings: Vec::new(), ..fit.law.clone() };
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
