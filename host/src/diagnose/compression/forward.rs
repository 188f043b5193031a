//! Coupons as sets of effects see them: the fits of a specimen without a ball, and misfits of compressions.

use lut_gen::chain::Model;
use lut_gen::effect::Spread;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::super::check::Check;
use super::super::coordinate::{Candidate, Coordinate, coordinates};
use super::super::fit::{Fit, explained, freedom};
use super::super::search::{Search, signature, starts};
use super::super::sets::Weighed;
use super::discrepancy::groups;
use crate::infer::descent::{Region, Residuals, Rule, minimise};
use crate::infer::evidence::Parameter;
use crate::infer::lowrank::Fold;
use crate::infer::sets::{Forward, Groups, Misfits};

/// Root mean square of a misfit, as a part of the largest force, below which it shows in no force.
const SEEN: f64 = 1e-4;
const RULE: Rule = Rule { most_steps: 40, settled: 1e-9, settled_share: 1e-9, rival: None };

/// The model of a point, and the step of a difference quotient of a parameter at a place.
type Searched<'a> = (&'a dyn Fn(&[f64]) -> Model, &'a dyn Fn(usize, f64) -> f64);

/// A search whose rows are compressions only.
pub(super) struct Coupons<'a> {
    pub search: Search<'a>,
    /// What it may be wrong by without a name.
    pub groups: Groups,
}

impl Forward for Coupons<'_> {
    type Fit = Fit;
    type Name = &'static str;

    fn base(&self) -> &Fit {
        &self.search.base
    }

    fn effects(&self) -> &[Candidate] {
        &self.search.candidates
    }

    fn name(&self, candidate: &Candidate) -> &'static str {
        Forward::name(&self.search, candidate)
    }

    fn is_form_of(&self, one: &Candidate, other: &Candidate) -> bool {
        self.search.is_form_of(one, other)
    }

    fn may_join(&self, set: &[Candidate], candidate: &Candidate) -> bool {
        self.search.may_join(set, candidate)
    }

    fn log_odds(&self, candidate: &Candidate) -> f64 {
        self.search.log_odds(candidate)
    }

    /// The likeliest from all starts.
    fn extended(&self, from: &Fit, candidate: &Candidate) -> Option<Fit> {
        let problem = &self.search.problem;
        let candidates: Vec<Candidate> = from.candidates.iter().copied().chain([*candidate]).collect();
        let list = coordinates(problem.design, &candidates);
        let sizes = candidate.sizes(problem.design);
        let starts = starts(candidate, |q| {
            q.starts.iter().map(|v| if q.spread == Spread::Even { q.scaled(*v, &sizes) } else { *v }).collect()
        });
        let known = from.x.len();
        let fits = starts.par_iter().map(|values| {
            let place = |i: usize| if i < known { from.x[i] } else { list[i].of(values[i - known]) };
            self.settled(&self.fitted(&candidates, &DVector::from_fn(list.len(), |i, _| place(i))))
        });
        let log = |fit: &Fit| Weighed::of(self, fit.clone(), &self.groups.discrepancy, &[]).map(|found| found.log);
        let told: Vec<(f64, Fit)> = fits.flatten().filter_map(|fit| Some((log(&fit)?, fit))).collect();
        told.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, fit)| fit)
    }

    fn again(&self, fit: &Fit) -> Fit {
        self.search.again(fit)
    }

    fn form_error(&self, fit: &Fit) -> DMatrix<f64> {
        Forward::form_error(&self.search, fit)
    }

    fn signature(&self, at: &Fit, candidate: &Candidate) -> (DMatrix<f64>, Parameter) {
        Forward::signature(&self.search, at, candidate)
    }
}

impl<'a> Coupons<'a> {
    /// Of a search, its base found anew.
    pub fn new(mut search: Search<'a>) -> Self {
        let groups = groups(&search.problem, &search.base.model);
        let mut coupons = Self { search: search.clone(), groups };
        let starts = ALPHAS.map(|alpha| {
            let mu_mpa = modulus(&coupons, alpha);
            coupons.fitted(&[], &DVector::from_column_slice(&[mu_mpa.ln(), f64::ln(alpha)]))
        });
        let plain = |fit: &Fit| coupons.rms(&(coupons.measured() - coupons.predicted(&fit.model)));
        if let Some(base) = starts.into_iter().min_by(|a, b| plain(a).total_cmp(&plain(b))) {
            search.base = base;
        }
        coupons.groups = self::groups(&search.problem, &search.base.model);
        coupons.search = search;
        if let Some(base) = coupons.settled(&coupons.search.base) {
            coupons.search.base = base;
        }
        let Search { problem, base, candidates, .. } = &coupons.search;
        coupons.search.signatures = candidates.iter().map(|c| signature(problem, base, c)).collect();
        coupons
    }

    /// A fit linearised where the evidence puts its parameters, which beside a discrepancy lies far from where plain
    /// residuals are least: the point of some rounds that its own evidence moves the least.
    fn settled(&self, fit: &Fit) -> Option<Fit> {
        let problem = &self.search.problem;
        let mut now = fit.clone();
        let (mut part, mut before) = (1.0, Vec::new());
        let mut nearest: Option<(f64, Fit)> = None;
        for _ in 0..ROUNDS {
            let found = Weighed::of(self, now.clone(), &self.groups.discrepancy, &[])?;
            // in standard deviations, so that all parameters count alike
            let of = |(to, (from, own)): (&f64, (&f64, &f64))| (to - from) / own.max(f64::MIN_POSITIVE);
            let steps: Vec<f64> =
                found.evidence.x.iter().zip(now.x.iter().zip(&found.evidence.deviations)).map(of).collect();
            let largest = steps.iter().fold(0.0, |most: f64, step| most.max(step.abs()));
            if nearest.as_ref().is_none_or(|(least, _)| largest < *least) {
                nearest = Some((largest, now.clone()));
            }
            if largest < SETTLED {
                break;
            }
            // one that goes to and fro steps shorter
            if steps.iter().zip(&before).map(|(a, b): (&f64, &f64)| a * b).sum::<f64>() < 0.0 {
                part *= 0.5;
            }
            let moved = |i: usize| found.evidence.x[i] - now.x[i];
            let longest = (0..2).map(|i| moved(i).abs()).fold(LONGEST, f64::max);
            let next = DVector::from_fn(now.x.len(), |i, _| now.x[i] + part * moved(i) * LONGEST / longest);
            now = problem.at(&fit.candidates, &next, &Fold::none());
            before = steps;
        }
        nearest.map(|(_, fit)| fit)
    }

    /// A fit from a point, of the forces as they were read: errors in proportion to these would let a modulus
    /// of nothing miss them all at the price of one gain a compression.
    fn fitted(&self, candidates: &[Candidate], start: &DVector<f64>) -> Fit {
        let problem = &self.search.problem;
        let list = coordinates(problem.design, candidates);
        let model = |x: &[f64]| problem.model(&list, candidates, &DVector::from_column_slice(x));
        let step = |j: usize, x: f64| {
            let step = list[j].step();
            if x + step > list[j].bounds().1 { -step } else { step }
        };
        let region = Region::of(list.iter().map(Coordinate::bounds));
        let (plain, _) = self.least(&self.measured(), (&model, &step), &region, start.as_slice());
        problem.at(candidates, &DVector::from_vec(plain), &Fold::none())
    }

    /// Forces that were read, N, compression by compression.
    pub fn measured(&self) -> DVector<f64> {
        DVector::from_vec(self.search.problem.design.checks.iter().flat_map(Check::measured).collect())
    }

    /// Forces that a model has for them, N.
    pub fn predicted(&self, model: &Model) -> DVector<f64> {
        let each = self.search.problem.design.checks.iter().flat_map(|check| check.predicted(model));
        DVector::from_vec(each.collect())
    }

    /// A plain fit of a model's `mu` and `alpha`, its effects as they are, to some forces of those compressions
    /// that count: the model, and what it leaves, N.
    pub fn plainly(&self, with: &Model, to_n: &DVector<f64>) -> (Model, DVector<f64>) {
        let at = |x: &[f64]| Model { mu_mpa: x[0].exp(), alpha: x[1].exp(), ..with.clone() };
        let region = Region::of([Coordinate::LnMu, Coordinate::LnAlphaAlone].map(|c| c.bounds()));
        let (x, left_n) = self.least(to_n, (&at, &|_, _| STEP), &region, &[with.mu_mpa.ln(), with.alpha.ln()]);
        (at(&x), left_n)
    }

    /// Plain least squares of a model's parameters on some forces of those compressions that count: where they
    /// end, and what is left, N.
    fn least(
        &self,
        to_n: &DVector<f64>,
        (model, step): Searched<'_>,
        region: &Region,
        start: &[f64],
    ) -> (Vec<f64>, DVector<f64>) {
        let left = |x: &[f64]| {
            let mut left = to_n - self.predicted(&model(x));
            left.iter_mut().zip(&self.search.problem.used).for_each(|(n, used)| *n = if *used { *n } else { 0.0 });
            left
        };
        let slopes = |x: &[f64], here: &DVector<f64>| {
            let column = |j: usize| {
                let (mut moved, step) = (x.to_vec(), step(j, x[j]));
                moved[j] += step;
                (here - left(&moved)) / step
            };
            DMatrix::from_columns(&(0..x.len()).map(column).collect::<Vec<_>>())
        };
        let end = minimise(&Residuals { residual: left, jacobian: slopes }, region, start, &RULE);
        (end.x, end.kept.into_parts().0)
    }

    fn rms(&self, left_n: &DVector<f64>) -> f64 {
        let count = self.search.problem.used.iter().filter(|used| **used).count().max(1);
        (left_n.norm_squared() / count as f64).sqrt()
    }
}

/// Exponents that a base begins with.
const ALPHAS: [f64; 5] = [1.2, 2.5, 5.0, 9.0, 16.0];
/// Most rounds of settling.
const ROUNDS: usize = 30;
/// Part of its standard deviation that no parameter moves by any more.
const SETTLED: f64 = 0.2;
/// Longest step of the logarithms of modulus and exponent in a round.
const LONGEST: f64 = 0.3;
/// Step of a difference quotient of the logarithms.
const STEP: f64 = 1e-5;

/// The modulus (MPa) at which the largest force of an exponent is that which was read.
fn modulus(coupons: &Coupons<'_>, alpha: f64) -> f64 {
    let unit = coupons.predicted(&Model::base(1.0, alpha)).amax();
    coupons.measured().amax() / unit.max(f64::MIN_POSITIVE)
}

impl Misfits for Coupons<'_> {
    /// The base with the effects at the amounts of the evidence, and how many these are.
    type Model = (Model, usize);

    fn readings(&self) -> usize {
        self.search.problem.whitening.residuals()
    }

    fn model(
        &self,
        set: &Weighed,
        columns_n: &DMatrix<f64>,
        amounts: Option<&DVector<f64>>,
    ) -> (Self::Model, DVector<f64>) {
        let fit = &set.fit;
        let x = DVector::from_column_slice(&set.evidence.x);
        let model = self.search.problem.model(&fit.coordinates, &fit.candidates, &x);
        let beside = amounts.map_or_else(|| DVector::zeros(self.readings()), |amounts| columns_n * amounts);
        ((model, fit.candidates.len()), beside)
    }

    fn left(&self, (model, effects): &Self::Model, is_kept: &dyn Fn(usize) -> bool, beside: &DVector<f64>) -> f64 {
        let kept = model.settings.iter().enumerate().filter(|(at, _)| at >= effects || is_kept(*at));
        let shown = Model { settings: kept.map(|(_, setting)| setting.clone()).collect(), ..model.clone() };
        let base = Model { settings: Vec::new(), ..model.clone() };
        self.rms(&self.plainly(&base, &(self.predicted(&shown) + beside)).1)
    }

    fn left_share(&self, (model, _): &Self::Model, beside: &DVector<f64>) -> f64 {
        let forces_n = self.predicted(model);
        let whole = self.rms(&forces_n);
        self.rms(&self.plainly(model, &(forces_n + beside)).1) / whole
    }

    fn seen(&self) -> f64 {
        SEEN * self.measured().amax()
    }

    fn explained(&self, fit: &Fit) -> Option<f64> {
        explained(self.search.base.square, freedom(&self.search.problem.used, &self.search.base), fit.square)
    }
}
