//! How well a model explains data, all of its parameters and the size of its discrepancy
//! integrated: the logarithm of its marginal likelihood.
//!
//! ```text
//! r = J d + K b + sum_g a_g Z_g c_g + e,     b, c, e ~ N(0, I)
//! ```
//! `K b` is error of known size that may be there or not; `Z_g c_g` are smooth discrepancies whose
//! sizes `a_g` have a prior that allows for none at all. Parameters have flat or heavy-tailed
//! priors. The integral over parameters is Laplace's, at the point that the linearised model puts
//! them at once the discrepancy is allowed for. Sizes are those of the highest posterior on a grid,
//! again for each model.

use nalgebra::{DMatrix, DVector};

use super::covariance::{Factor, standard_errors};
use super::product::{beside, inner};

/// What is known of a parameter before the data.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Prior {
    /// Nothing, and the same in all models that are compared.
    Flat,
    /// A Cauchy distribution about a null value with this scale: mostly small, and once in a while
    /// large.
    Cauchy {
        /// The null value.
        null: f64,
        /// Half of all amounts are smaller.
        scale: f64,
    },
    /// A normal distribution.
    Normal {
        /// Its mean.
        mean: f64,
        /// Its standard deviation.
        deviation: f64,
    },
}

impl Prior {
    /// Wide, between bounds: two standard deviations to either side.
    #[must_use]
    pub fn between((low, high): (f64, f64)) -> Self {
        Self::Normal { mean: 0.5 * (low + high), deviation: 0.25 * (high - low) }
    }

    /// Logarithm of its density; 0 where it is flat.
    #[must_use]
    pub fn log_density(&self, x: f64) -> f64 {
        use std::f64::consts::{PI, TAU};
        match *self {
            Prior::Flat => 0.0,
            Prior::Cauchy { null, scale } => -(PI * scale).ln() - ((x - null) / scale).powi(2).ln_1p(),
            Prior::Normal { mean, deviation } => -0.5 * (TAU.ln() + ((x - mean) / deviation).powi(2)) - deviation.ln(),
        }
    }

    /// The same, wider by a factor.
    #[must_use]
    pub fn wider(self, factor: f64) -> Self {
        match self {
            Prior::Flat => self,
            Prior::Cauchy { null, scale } => Prior::Cauchy { null, scale: factor * scale },
            Prior::Normal { mean, deviation } => Prior::Normal { mean, deviation: factor * deviation },
        }
    }

    /// Centre and weight of the square that touches `-2 ln p` at a point and is nowhere below it.
    fn square(&self, x: f64) -> (f64, f64) {
        match *self {
            Prior::Flat => (x, 0.0),
            Prior::Cauchy { null, scale } => (null, 2.0 / (scale * scale + (x - null).powi(2))),
            Prior::Normal { mean, deviation } => (mean, deviation.powi(-2)),
        }
    }
}

/// A parameter of a model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// Where the model is linearised.
    pub x: f64,
    /// Least and largest value.
    pub bounds: (f64, f64),
    /// What is known of it.
    pub prior: Prior,
}

impl Parameter {
    /// An amount that is not there yet, in units of some size; bounds and scale of its prior are beyond its
    /// null.
    #[must_use]
    pub fn in_units(unit: f64, bounds: (f64, f64), scale: f64) -> Self {
        let (a, b) = (bounds.0 / unit, bounds.1 / unit);
        Self { x: 0.0, bounds: (a.min(b), a.max(b)), prior: Prior::Cauchy { null: 0.0, scale: scale / unit.abs() } }
    }
}

/// A model linearised at a point. Rows are whitened by the noise.
#[derive(Debug, Clone)]
pub struct Linearised<'a> {
    /// Measured less predicted.
    pub residual: &'a DVector<f64>,
    /// Derivative of the prediction, a column for each parameter.
    pub jacobian: &'a DMatrix<f64>,
    /// Parameters.
    pub parameters: Vec<Parameter>,
    /// Columns of errors of known size, of unit deviation.
    pub known: &'a DMatrix<f64>,
}

/// Sizes that a discrepancy may have, with their prior probabilities. The first is none.
#[derive(Debug, Clone, PartialEq)]
pub struct Sizes(Vec<(f64, f64)>);

/// Probability that a discrepancy of a group is none.
const NONE: f64 = 0.5;

impl Sizes {
    /// None with even chances, else about `median` (log-normal) with a factor `e^spread` to either
    /// side; seven sizes, up to three such factors above.
    #[must_use]
    pub fn about(median: f64, spread: f64) -> Self {
        let steps = [-1.5, -0.75, 0.0, 0.75, 1.5, 2.25, 3.0];
        let weights = steps.map(|z: f64| (-0.5 * z * z).exp());
        let sum: f64 = weights.iter().sum();
        let sizes = steps.iter().zip(weights).map(|(z, w)| (median * (spread * z).exp(), (1.0 - NONE) * w / sum));
        Self(std::iter::once((0.0, NONE)).chain(sizes).collect())
    }

    /// The same, all larger by a factor.
    #[must_use]
    fn wider(&self, factor: f64) -> Self {
        Self(self.0.iter().map(|(size, weight)| (factor * size, *weight)).collect())
    }

    /// Of the errors that a model is known for, in their units: none with even chances, for what is
    /// written down may be right, else half of them or all.
    fn of_errors() -> Self {
        Self(vec![(0.0, NONE), (0.5, 0.5 * (1.0 - NONE)), (1.0, 0.5 * (1.0 - NONE))])
    }

    /// Of noise that was estimated from repeats, in units of that: with eight degrees of freedom it is all of it with even
    /// chances, else a quarter or nearly twice as much in all.
    fn of_noise() -> Self {
        Self(vec![(0.0, NONE), (0.75, 0.5 * (1.0 - NONE)), (1.5, 0.5 * (1.0 - NONE))])
    }

    /// Logarithm of the prior probability of one of them.
    fn log(&self, size: f64) -> f64 {
        self.0.iter().find(|(known, _)| *known == size).map_or(f64::NEG_INFINITY, |(_, weight)| weight.ln())
    }
}

/// Discrepancies: whitened columns a group, for a size of one, beside each other.
#[derive(Debug, Clone)]
pub struct Discrepancy {
    columns: DMatrix<f64>,
    /// Products of the columns among themselves, which all models share.
    products: DMatrix<f64>,
    /// Group of every column.
    group: Vec<usize>,
    groups: usize,
    /// Groups, by number, that are noise which was estimated too small: they are no discrepancy.
    noise: Vec<usize>,
    sizes: Sizes,
}

impl Discrepancy {
    /// Of the columns of every group, with the sizes that each may have.
    #[must_use]
    pub fn new<'a>(rows: usize, groups: impl IntoIterator<Item = &'a DMatrix<f64>>, sizes: Sizes) -> Self {
        let groups: Vec<&DMatrix<f64>> = groups.into_iter().collect();
        let columns = beside(rows, groups.iter().copied());
        let of = |(at, z): (usize, &&DMatrix<f64>)| std::iter::repeat_n(at, z.ncols());
        let group = groups.iter().enumerate().flat_map(of).collect();
        Self { products: inner(&columns, &columns), columns, group, groups: groups.len(), noise: Vec::new(), sizes }
    }

    /// The same of which some groups, by number, are noise that was estimated too small.
    #[must_use]
    pub fn with_noise(self, noise: Vec<usize>) -> Self {
        Self { noise, ..self }
    }

    /// True where sizes have no discrepancy in them; errors of the model itself and noise are none.
    #[must_use]
    pub fn is_none_of(&self, sizes: &[f64]) -> bool {
        let own = sizes.iter().take(self.groups).enumerate();
        own.filter(|(group, _)| !self.noise.contains(group)).all(|(_, size)| *size == 0.0)
    }

    /// The same with sizes that are larger by a factor.
    #[must_use]
    pub fn wider(&self, factor: f64) -> Self {
        Self { sizes: self.sizes.wider(factor), ..self.clone() }
    }

    /// Sizes of every group, and of the errors of a model behind them where it has any.
    fn sizes_beside(&self, model: &Linearised<'_>) -> Vec<Sizes> {
        let errors = (model.known.ncols() > 0).then(Sizes::of_errors);
        let own = |group| if self.noise.contains(&group) { Sizes::of_noise() } else { self.sizes.clone() };
        (0..self.groups).map(own).chain(errors).collect()
    }

    /// Columns of the groups that are there at some sizes, and the errors that a model is known for behind
    /// them, each in units of its deviation.
    #[must_use]
    pub fn at(&self, sizes: &[f64], known: &DMatrix<f64>) -> DMatrix<f64> {
        let size = |at: usize| sizes.get(at).copied().unwrap_or(0.0);
        let own = (0..self.group.len()).filter(|at| size(self.group[*at]) > 0.0);
        let columns = own.map(|at| size(self.group[at]) * self.columns.column(at));
        let errors = size(self.groups);
        let known = known.column_iter().filter(|_| errors > 0.0).map(|column| errors * column);
        let all: Vec<DVector<f64>> = columns.chain(known).collect();
        if all.is_empty() { DMatrix::zeros(self.columns.nrows(), 0) } else { DMatrix::from_columns(&all) }
    }

    /// Number of groups.
    #[must_use]
    pub fn groups(&self) -> usize {
        self.groups
    }
}

/// What a model comes to.
#[derive(Debug, Clone, PartialEq)]
pub struct Evidence {
    /// Logarithm of the marginal likelihood, up to what all models of the same rows and base share.
    pub log: f64,
    /// The same without any discrepancy; noise may be larger than was estimated.
    pub alone: f64,
    /// Size of every group of discrepancies.
    pub sizes: Vec<f64>,
    /// Where the parameters are with these allowed for.
    pub x: Vec<f64>,
    /// Their standard deviations there.
    pub deviations: Vec<f64>,
}

/// Products of all columns: what an evaluation needs of the rows.
struct Products {
    /// Of `[J r]` among themselves.
    own: DMatrix<f64>,
    /// Of `[K Z]` with `[J r]`.
    across: DMatrix<f64>,
    /// Of `[K Z]` among themselves.
    errors: DMatrix<f64>,
    /// Group of every column of `[K Z]`; errors of the model itself are the last.
    group: Vec<usize>,
}

/// Rounds over the groups in which their sizes follow each other.
const SWEEPS: usize = 8;
/// Sizes, by number, at which one that is not there yet is looked for.
const FIRST: [usize; 3] = [1, 3, 5];
/// Steps in which parameters and their priors' squares follow each other.
const STEPS: usize = 8;

impl Products {
    /// Of a model and of further columns of parameters, which stand between its own and the residual.
    fn of(model: &Linearised<'_>, further: &DMatrix<f64>, discrepancy: &Discrepancy) -> Self {
        let rows = model.residual.len();
        let residual = DMatrix::from_column_slice(rows, 1, model.residual.as_slice());
        let told = beside(rows, [model.jacobian, further, &residual]);
        let (known, z) = (model.known, &discrepancy.columns);
        let (k, all) = (known.ncols(), known.ncols() + z.ncols());
        let mut across = DMatrix::zeros(all, told.ncols());
        across.rows_mut(0, k).copy_from(&inner(known, &told));
        across.rows_mut(k, z.ncols()).copy_from(&inner(z, &told));
        let mut errors = DMatrix::zeros(all, all);
        let mixed = inner(known, z);
        errors.view_mut((0, 0), (k, k)).copy_from(&inner(known, known));
        errors.view_mut((0, k), (k, z.ncols())).copy_from(&mixed);
        errors.view_mut((k, 0), (z.ncols(), k)).copy_from(&mixed.transpose());
        errors.view_mut((k, k), (z.ncols(), z.ncols())).copy_from(&discrepancy.products);
        let group = std::iter::repeat_n(discrepancy.groups, k).chain(discrepancy.group.iter().copied()).collect();
        Self { own: inner(&told, &told), across, errors, group }
    }

    /// The errors of some sizes, as they stand in `I + W' W`; `None` where a number is none.
    fn scaled(&self, sizes: &[f64]) -> Option<Scaled> {
        let size = |at: usize| sizes[self.group[at]];
        let there: Vec<(usize, f64)> =
            (0..self.group.len()).map(|at| (at, size(at))).filter(|(_, a)| *a > 0.0).collect();
        let n = there.len();
        let unit = |i: usize, j: usize| f64::from(u8::from(i == j));
        let whole = DMatrix::from_fn(n, n, |i, j| {
            let ((own, a), (other, b)) = (there[i], there[j]);
            unit(i, j) + a * b * self.errors[(own, other)]
        });
        let across = DMatrix::from_fn(n, self.across.ncols(), |i, j| there[i].1 * self.across[(there[i].0, j)]);
        Some(Scaled { factor: Factor::of(&whole)?, there, across })
    }

    /// `[J r]' C^-1 [J r]` and `ln det C` at some sizes; `None` where a number is none.
    fn at(&self, sizes: &[f64]) -> Option<(DMatrix<f64>, f64)> {
        let Scaled { across, factor, .. } = self.scaled(sizes)?;
        Some((&self.own - across.tr_mul(&factor.solve_all(&across)), factor.log_determinant()))
    }
}

/// Errors of some sizes.
struct Scaled {
    /// Columns of `[K Z]` that are there, by number, with their sizes.
    there: Vec<(usize, f64)>,
    /// Of these columns with `[J r]`.
    across: DMatrix<f64>,
    /// Of `I + W' W`.
    factor: Factor,
}

/// A model beside discrepancies, to be weighed at any sizes of these.
struct Scale<'m> {
    products: Products,
    /// Sizes that each group may have, with their prior probabilities.
    grids: Vec<Sizes>,
    parameters: &'m [Parameter],
}

impl<'m> Scale<'m> {
    fn of(model: &'m Linearised<'_>, discrepancy: &Discrepancy) -> Self {
        let products = Products::of(model, &DMatrix::zeros(model.residual.len(), 0), discrepancy);
        Self { products, grids: discrepancy.sizes_beside(model), parameters: &model.parameters }
    }

    fn sizes(&self, group: usize) -> &[(f64, f64)] {
        &self.grids[group].0
    }

    /// Sizes of a choice, one of each group by number, and their prior probabilities.
    fn told_of(&self, chosen: &[usize]) -> (Vec<f64>, Vec<f64>) {
        chosen.iter().enumerate().map(|(group, at)| self.sizes(group)[*at]).unzip()
    }

    /// The number of a size; that of none where it is no size of the group.
    fn place(&self, group: usize, size: f64) -> usize {
        self.sizes(group).iter().position(|(known, _)| *known == size).unwrap_or(0)
    }

    /// Logarithm of the marginal likelihood at a choice, its prior included.
    fn value(&self, chosen: &[usize]) -> Option<(f64, Integral)> {
        let (sizes, weights) = self.told_of(chosen);
        let prior: f64 = weights.iter().map(|weight| weight.ln()).sum();
        let (told, determinant) = self.products.at(&sizes)?;
        let integral = integrated(self.parameters, &told)?;
        Some((integral.log + prior - 0.5 * determinant, integral))
    }
}

/// Evidence of a model; `None` where a number is none or a parameter with a flat prior is not told
/// of at all. Sizes are searched from those that are given: those of a like model are near, and
/// without any the search begins at none.
#[must_use]
pub fn evidence(model: &Linearised<'_>, discrepancy: &Discrepancy, from: &[f64]) -> Option<Evidence> {
    let (scale, has_noise) = (Scale::of(model, discrepancy), !discrepancy.noise.is_empty());
    let all: Vec<usize> = (0..scale.grids.len()).collect();
    let given = |group: usize| scale.place(group, from.get(group).copied().unwrap_or(0.0));
    let none = scale.searched(vec![0; all.len()], &discrepancy.noise, discrepancy.groups)?;
    let begin = Chosen::at(&scale, all.iter().map(|group| given(*group)).collect())?;
    let begin = if has_noise && none.log > begin.log { none.clone() } else { begin };
    let best = scale.searched(begin.sizes, &all, discrepancy.groups)?;
    let more = |chosen: &Chosen| discrepancy.noise.iter().map(|group| scale.of_all_sizes(chosen, *group)).sum::<f64>();
    let (log, alone) = (best.log + more(&best), none.log + more(&none));
    let (best, log) = if has_noise && alone > log { (none, alone) } else { (best, log) };
    let (sizes, _) = scale.told_of(&best.sizes);
    let Integral { x, hessian, .. } = best.integral;
    Some(Evidence { log, alone, sizes, x, deviations: standard_errors(&hessian) })
}

/// A choice of sizes, by number, with what it comes to.
#[derive(Clone)]
struct Chosen {
    sizes: Vec<usize>,
    log: f64,
    integral: Integral,
}

impl Chosen {
    fn at(scale: &Scale<'_>, sizes: Vec<usize>) -> Option<Self> {
        let (log, integral) = scale.value(&sizes)?;
        Some(Self { sizes, log, integral })
    }
}

impl Scale<'_> {
    /// What all sizes of a group add to the logarithm of the evidence at the likeliest.
    fn of_all_sizes(&self, chosen: &Chosen, group: usize) -> f64 {
        let at = |size: usize| {
            let mut there = chosen.sizes.clone();
            there[group] = size;
            self.value(&there).map_or(0.0, |(log, _)| (log - chosen.log).exp())
        };
        (0..self.sizes(group).len()).map(at).sum::<f64>().max(1.0).ln()
    }

    /// The likeliest sizes of some groups, from a choice; the first so many groups are discrepancies.
    fn searched(&self, from: Vec<usize>, groups: &[usize], discrepancies: usize) -> Option<Chosen> {
        let mut best = Chosen::at(self, from)?;
        for _ in 0..SWEEPS {
            let before = best.sizes.clone();
            for &group in groups {
                // what is not there is looked for at few sizes; what is moves to a neighbour
                let near = match best.sizes[group] {
                    0 if group < discrepancies => FIRST.to_vec(),
                    at => vec![0, at.saturating_sub(1), at + 1],
                };
                for size in near.into_iter().filter(|size| *size < self.sizes(group).len()) {
                    let mut there = best.sizes.clone();
                    there[group] = size;
                    if let Some(found) = Chosen::at(self, there).filter(|found| found.log > best.log) {
                        best = found;
                    }
                }
            }
            if best.sizes == before {
                break;
            }
        }
        Some(best)
    }
}

/// What sizes that are not known add to the variance of every parameter about where its evidence has it:
/// each group in turn may have any of its sizes, the others as they are. A discrepancy that the
/// parameters take up shows in no residual, and is as likely as before the data.
#[must_use]
pub fn of_unknown_sizes(model: &Linearised<'_>, discrepancy: &Discrepancy, evidence: &Evidence) -> Vec<f64> {
    let scale = Scale::of(model, discrepancy);
    let chosen: Vec<usize> = evidence.sizes.iter().enumerate().map(|(group, size)| scale.place(group, *size)).collect();
    let mut added = vec![0.0; evidence.x.len()];
    for group in 0..chosen.len() {
        let there = |size: usize| {
            let mut other = chosen.clone();
            other[group] = size;
            scale.value(&other).map(|(log, integral)| (log, standard_errors(&integral.hessian), integral.x))
        };
        let each: Vec<_> = (0..scale.sizes(group).len()).filter_map(there).collect();
        let most = each.iter().map(|(log, ..)| *log).fold(f64::NEG_INFINITY, f64::max);
        let whole: f64 = each.iter().map(|(log, ..)| (log - most).exp()).sum();
        for (at, added) in added.iter_mut().enumerate() {
            let square = |(log, deviations, x): &(f64, Vec<f64>, Vec<f64>)| {
                (log - most).exp() * (deviations[at].powi(2) + (x[at] - evidence.x[at]).powi(2))
            };
            let more = each.iter().map(square).sum::<f64>() / whole - evidence.deviations[at].powi(2);
            *added += more.max(0.0);
        }
    }
    added
}

/// Amounts of the columns of the discrepancy that are likeliest beside a model whose parameters and
/// sizes are those of its evidence; none where a number is none.
#[must_use]
pub fn amounts(model: &Linearised<'_>, evidence: &Evidence, discrepancy: &Discrepancy) -> Option<DVector<f64>> {
    let products = Products::of(model, &DMatrix::zeros(model.residual.len(), 0), discrepancy);
    let Scaled { there, across, factor } = products.scaled(&evidence.sizes)?;
    // what is left once the parameters are where the evidence has them
    let steps = model.parameters.iter().zip(&evidence.x).map(|(p, x)| p.x - x).chain([1.0]);
    let found = factor.solve(&(&across * DVector::from_iterator(across.ncols(), steps)));
    let known = products.group.len() - discrepancy.group.len();
    let mut amounts = DVector::zeros(discrepancy.group.len());
    for ((at, size), found) in there.iter().zip(found.iter()).filter(|((at, _), _)| *at >= known) {
        amounts[at - known] = size * found;
    }
    Some(amounts)
}

/// What each of some further parameters, a column each, promises to add to the logarithm of the
/// evidence; minus infinity where that is no number. Sizes of the discrepancy stay, or one group of
/// it, or all, is none or little: what had no name may be what a further parameter stands for.
#[must_use]
pub fn promises(
    model: &Linearised<'_>,
    sizes: &[f64],
    discrepancy: &Discrepancy,
    further: (&DMatrix<f64>, &[Parameter]),
) -> Vec<f64> {
    let (columns, parameters) = further;
    let (own, more) = (model.jacobian.ncols(), columns.ncols());
    let products = Products::of(model, columns, discrepancy);
    let grids = discrepancy.sizes_beside(model);
    let log = |sizes: &[f64], told: &DMatrix<f64>, determinant: f64, extra: Option<usize>| {
        let places: Vec<usize> = (0..own).chain(extra.map(|at| own + at)).chain([own + more]).collect();
        let part = DMatrix::from_fn(places.len(), places.len(), |i, j| told[(places[i], places[j])]);
        let all: Vec<Parameter> = model.parameters.iter().copied().chain(extra.map(|at| parameters[at])).collect();
        let prior: f64 = sizes.iter().zip(&grids).map(|(size, grid)| grid.log(*size)).sum();
        integrated(&all, &part).map(|integral| integral.log + prior - 0.5 * determinant)
    };
    let mut best = vec![f64::NEG_INFINITY; more];
    let mut without = None;
    for sizes in lessened(sizes, &grids) {
        let Some((told, determinant)) = products.at(&sizes) else { continue };
        let Some(before) = *without.get_or_insert(log(&sizes, &told, determinant, None)) else { return best };
        for (at, best) in best.iter_mut().enumerate() {
            let with = log(&sizes, &told, determinant, Some(at));
            *best = best.max(with.map_or(f64::NEG_INFINITY, |with| with - before));
        }
    }
    best
}

/// Sizes as they are, each of those that are there as none or as the least, and all as that.
fn lessened(sizes: &[f64], grids: &[Sizes]) -> Vec<Vec<f64>> {
    let there: Vec<usize> = (0..sizes.len()).filter(|at| sizes[*at] > 0.0).collect();
    let mut all = vec![sizes.to_vec()];
    for size in [0, 1] {
        let less = |which: &[usize]| {
            let of = |(at, own): (usize, &f64)| {
                if which.contains(&at) { grids[at].0.get(size).map_or(*own, |(less, _)| less.min(*own)) } else { *own }
            };
            sizes.iter().enumerate().map(of).collect::<Vec<_>>()
        };
        all.extend(there.iter().map(|at| less(&[*at])));
        if there.len() > 1 {
            all.push(less(&there));
        }
    }
    all
}

/// An integral over the parameters.
#[derive(Clone)]
struct Integral {
    log: f64,
    /// Where the parameters are.
    x: Vec<f64>,
    /// Information on them, with that of their priors.
    hessian: DMatrix<f64>,
}

/// Laplace's integral over the parameters, `told` being `[J r]' C^-1 [J r]`.
fn integrated(parameters: &[Parameter], told: &DMatrix<f64>) -> Option<Integral> {
    let n = parameters.len();
    let information = told.view((0, 0), (n, n)).into_owned();
    let said = told.view((0, n), (n, 1)).column(0).into_owned();
    let mut step = DVector::zeros(n);
    let mut hessian = information.clone();
    for _ in 0..STEPS {
        let squares: Vec<(f64, f64)> =
            parameters.iter().zip(step.iter()).map(|(p, d)| p.prior.square(p.x + d)).collect();
        hessian = information.clone();
        let mut right = said.clone();
        for (i, (parameter, (centre, weight))) in parameters.iter().zip(&squares).enumerate() {
            hessian[(i, i)] += weight;
            right[i] += weight * (centre - parameter.x);
        }
        let next = bounded(parameters, &hessian, &right)?;
        let moved = (&next - &step).amax();
        step = next;
        if moved < 1e-9 {
            break;
        }
    }
    let left = told[(n, n)] - 2.0 * said.dot(&step) + step.dot(&(&information * &step));
    let x: Vec<f64> = parameters.iter().zip(step.iter()).map(|(p, d)| p.x + d).collect();
    let prior: f64 = parameters.iter().zip(&x).map(|(p, x)| p.prior.log_density(*x)).sum();
    let volume = n as f64 * std::f64::consts::TAU.ln() - Factor::of(&hessian)?.log_determinant();
    let log = -0.5 * left + prior + 0.5 * volume;
    log.is_finite().then_some(Integral { log, x, hessian })
}

/// The least of `d' H d - 2 b' d` in the bounds: what passes one stays on it, the others follow.
fn bounded(parameters: &[Parameter], hessian: &DMatrix<f64>, right: &DVector<f64>) -> Option<DVector<f64>> {
    let n = parameters.len();
    let mut held: Vec<Option<f64>> = vec![None; n];
    loop {
        let free: Vec<usize> = (0..n).filter(|i| held[*i].is_none()).collect();
        let mut step = DVector::from_fn(n, |i, _| held[i].unwrap_or(0.0));
        if !free.is_empty() {
            let part = DMatrix::from_fn(free.len(), free.len(), |i, j| hessian[(free[i], free[j])]);
            let pulled = hessian * &step;
            let own = DVector::from_fn(free.len(), |i, _| right[free[i]] - pulled[free[i]]);
            let solved = Factor::of(&part)?.solve(&own);
            free.iter().zip(solved.iter()).for_each(|(at, value)| step[*at] = *value);
        }
        let beyond = |i: &usize| {
            let Parameter { x, bounds: (low, high), .. } = parameters[*i];
            let there = x + step[*i];
            if there < low {
                Some((low - there, low - x))
            } else if there > high {
                Some((there - high, high - x))
            } else {
                None
            }
        };
        let scale = |i: usize| hessian[(i, i)].sqrt();
        let worst = free.iter().filter_map(|i| beyond(i).map(|(by, to)| (by * scale(*i), *i, to)));
        match worst.max_by(|a, b| a.0.total_cmp(&b.0)) {
            Some((_, i, to)) => held[i] = Some(to),
            None => return Some(step),
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    const ROWS: usize = 12;

    fn column(wave: f64) -> DVector<f64> {
        DVector::from_fn(ROWS, |i, _| (wave * i as f64 / (ROWS - 1) as f64).cos())
    }

    /// ln of the normal density of `r` in `I + a^2 Z Z'`, without the constant.
    fn density(residual: &DVector<f64>, z: &DMatrix<f64>, size: f64) -> f64 {
        let factor = (DMatrix::identity(ROWS, ROWS) + size * size * z * z.transpose()).cholesky().unwrap();
        let determinant: f64 = factor.l().diagonal().iter().map(|v| 2.0 * v.ln()).sum();
        -0.5 * (residual.dot(&factor.solve(residual)) + determinant)
    }

    /// Against the integral over a grid of both parameters, for amounts well seen, hardly seen and
    /// none.
    #[test]
    fn the_integral_is_that_of_nested_quadrature() {
        let (base, shape) = (column(1.0), 3.0 * column(4.0));
        let z = DMatrix::from_columns(&[column(2.5), column(6.0)]);
        let jacobian = DMatrix::from_columns(&[20.0 * &base, shape.clone()]);
        for amount in [0.0, 0.4, 3.0] {
            let residual = amount * &shape + DVector::from_fn(ROWS, |i, _| (7.3 * i as f64).sin());
            let prior = Prior::Cauchy { null: 0.0, scale: 0.3 };
            let flat = Parameter { x: 0.0, bounds: (-1e9, 1e9), prior: Prior::Flat };
            let own = Parameter { x: 0.0, bounds: (-1e9, 1e9), prior };
            let none = DMatrix::zeros(ROWS, 0);
            let model =
                Linearised { residual: &residual, jacobian: &jacobian, parameters: vec![flat, own], known: &none };
            let sizes = Sizes(vec![(0.7, 1.0)]);
            let groups = [z.clone()];
            let found = evidence(&model, &Discrepancy::new(ROWS, &groups, sizes), &[]).unwrap();
            let (wide, fine) = ((0.8, 0.002), (6.0, 0.02));
            let mut sum = 0.0;
            let grid = |(reach, step): (f64, f64), around: f64| {
                let count = (2.0 * reach / step) as usize;
                (0..=count).map(move |i| around - reach + step * i as f64)
            };
            for a in grid(wide, found.x[0]) {
                for b in grid(fine, found.x[1]) {
                    let left = &residual - &jacobian * DVector::from_vec(vec![a, b]);
                    sum += (density(&left, &z, 0.7) + prior.log_density(b)).exp() * wide.1 * fine.1;
                }
            }
            // Laplace's error of a Cauchy prior that is as wide as the likelihood: a third of the
            // evidence at most.
            assert!((found.log - sum.ln()).abs() < 0.3, "{amount}: {} {}", found.log, sum.ln());
        }
    }

    /// A discrepancy along the effect's own shape takes the evidence for it away; along another it
    /// does not.
    #[test]
    fn what_a_discrepancy_may_be_is_no_evidence() {
        let shape = 10.0 * column(4.0);
        let residual = &shape + DVector::from_fn(ROWS, |i, _| 0.5 * (7.3 * i as f64).sin());
        let base = DMatrix::from_columns(&[20.0 * column(1.0)]);
        let both = DMatrix::from_columns(&[20.0 * column(1.0), shape.clone()]);
        let none = DMatrix::zeros(ROWS, 0);
        let flat = Parameter { x: 0.0, bounds: (-1e9, 1e9), prior: Prior::Flat };
        let own = Parameter { prior: Prior::Cauchy { null: 0.0, scale: 0.3 }, ..flat };
        let sizes = Sizes::about(1.0, 1.0);
        let gain = |z: DMatrix<f64>| {
            let groups = [z];
            let discrepancy = Discrepancy::new(ROWS, &groups, sizes.clone());
            let of = |jacobian, parameters| {
                evidence(&Linearised { residual: &residual, jacobian, parameters, known: &none }, &discrepancy, &[])
                    .unwrap()
            };
            of(&both, vec![flat, own]).log - of(&base, vec![flat]).log
        };
        assert!(gain(DMatrix::from_columns(std::slice::from_ref(&shape))) < 3.0);
        assert!(gain(DMatrix::from_columns(&[10.0 * column(9.0)])) > 50.0);
    }

    /// A discrepancy that is there is found, less what its prior and the base take of it.
    #[test]
    fn amounts_are_those_that_are_there() {
        let base = DMatrix::from_columns(&[20.0 * column(1.0)]);
        let residual = DVector::from_fn(ROWS, |i, _| 0.1 * (7.3 * i as f64).sin()) + 5.0 * column(4.0);
        let none = DMatrix::zeros(ROWS, 0);
        let flat = Parameter { x: 0.0, bounds: (-1e9, 1e9), prior: Prior::Flat };
        let model = Linearised { residual: &residual, jacobian: &base, parameters: vec![flat], known: &none };
        let groups = [DMatrix::from_columns(&[column(4.0)]), DMatrix::from_columns(&[column(9.0)])];
        let discrepancy = Discrepancy::new(ROWS, &groups, Sizes::about(1.0, 1.0));
        let found = evidence(&model, &discrepancy, &[]).unwrap();
        let there = amounts(&model, &found, &discrepancy).unwrap();
        assert_eq!(found.sizes[1], 0.0);
        assert!((there[0] - 5.0).abs() < 0.3 && there[1] == 0.0, "{there}");
    }

    /// A discrepancy that a parameter takes up shows in no residual: the parameter is as uncertain as the prior of
    /// its size has it. One across the parameter leaves it as it is.
    #[test]
    fn what_a_parameter_takes_up_keeps_the_prior_of_its_size() {
        let (along, across) = (column(1.0), column(4.0));
        let residual = DVector::zeros(ROWS);
        let base = DMatrix::from_columns(&[20.0 * &along]);
        let known = DMatrix::zeros(ROWS, 0);
        let flat = Parameter { x: 0.0, bounds: (-1e9, 1e9), prior: Prior::Flat };
        let model = Linearised { residual: &residual, jacobian: &base, parameters: vec![flat], known: &known };
        let sizes = Sizes::about(3.0, 0.5);
        let expected: f64 = sizes.0.iter().map(|(size, weight)| weight * (size / 20.0).powi(2)).sum();
        let added = |group: &DVector<f64>| {
            let groups = [DMatrix::from_columns(std::slice::from_ref(group))];
            let discrepancy = Discrepancy::new(ROWS, &groups, sizes.clone());
            let found = evidence(&model, &discrepancy, &[]).unwrap();
            of_unknown_sizes(&model, &discrepancy, &found)[0]
        };
        assert!((added(&along) / expected - 1.0).abs() < 1e-6, "{} {expected}", added(&along));
        assert!(added(&across) < 0.02 * expected, "{}", added(&across));
    }

    /// What a further parameter promises is what the evidence with it has more, the sizes being the same.
    #[test]
    fn a_promise_is_kept_by_the_model_with_the_parameter() {
        let shape = 3.0 * column(4.0);
        let residual = 2.0 * &shape + DVector::from_fn(ROWS, |i, _| 0.5 * (7.3 * i as f64).sin());
        let base = DMatrix::from_columns(&[20.0 * column(1.0)]);
        let known = DMatrix::zeros(ROWS, 0);
        let flat = Parameter { x: 0.0, bounds: (-1e9, 1e9), prior: Prior::Flat };
        let own = Parameter { prior: Prior::Cauchy { null: 0.0, scale: 0.3 }, ..flat };
        let z = [DMatrix::from_columns(&[column(2.5)])];
        let discrepancy = Discrepancy::new(ROWS, &z, Sizes(vec![(0.7, 1.0)]));
        // The sizes of a search begin at the first.
        let at_once = |jacobian: &DMatrix<f64>, parameters| {
            let model = Linearised { residual: &residual, jacobian, parameters, known: &known };
            evidence(&model, &discrepancy, &[]).unwrap().log
        };
        let model = Linearised { residual: &residual, jacobian: &base, parameters: vec![flat], known: &known };
        let further = DMatrix::from_columns(&[shape.clone(), column(9.0)]);
        let promised = promises(&model, &[0.7], &discrepancy, (&further, &[own, own]));
        for (at, promise) in promised.iter().enumerate() {
            let both = beside(ROWS, [&base, &further.columns(at, 1).into_owned()]);
            let kept = at_once(&both, vec![flat, own]) - at_once(&base, vec![flat]);
            assert!((promise - kept).abs() < 1e-9, "{at}: {promise} {kept}");
        }
        assert!(promised[0] > 10.0 && promised[1] < 0.0, "{promised:?}");
    }

    /// What had no name may be what a further parameter stands for: it is promised in its place.
    #[test]
    fn a_promise_may_take_the_place_of_a_discrepancy() {
        let shape = column(4.0);
        let residual = 9.0 * &shape + DVector::from_fn(ROWS, |i, _| 0.5 * (7.3 * i as f64).sin());
        let base = DMatrix::from_columns(&[20.0 * column(1.0)]);
        let known = DMatrix::zeros(ROWS, 0);
        let flat = Parameter { x: 0.0, bounds: (-1e9, 1e9), prior: Prior::Flat };
        let own = Parameter { prior: Prior::Cauchy { null: 0.0, scale: 9.0 }, ..flat };
        let z = [DMatrix::from_columns(&[shape.clone(), column(7.0), column(10.0)])];
        let discrepancy = Discrepancy::new(ROWS, &z, Sizes::about(2.0, 1.0));
        let model = Linearised { residual: &residual, jacobian: &base, parameters: vec![flat], known: &known };
        let sizes = evidence(&model, &discrepancy, &[]).unwrap().sizes;
        assert!(sizes[0] > 0.0);
        let further = DMatrix::from_columns(&[shape]);
        let promised = promises(&model, &sizes, &discrepancy, (&further, &[own]))[0];
        assert!(promised > 1.0, "{promised}");
    }

    #[test]
    fn a_parameter_stays_in_its_bounds_and_the_others_follow() {
        let hessian = DMatrix::from_row_slice(2, 2, &[2.0, 1.0, 1.0, 2.0]);
        let own = |low: f64| Parameter { x: 0.0, bounds: (low, 10.0), prior: Prior::Flat };
        let right = DVector::from_vec(vec![-2.0, 0.0]);
        let step = bounded(&[own(0.0), own(-10.0)], &hessian, &right).unwrap();
        assert_eq!(step.as_slice(), [0.0, 0.0]);
        let step = bounded(&[own(-0.5), own(-10.0)], &hessian, &right).unwrap();
        assert!((step - DVector::from_vec(vec![-0.5, 0.25])).amax() < 1e-15);
    }

    #[test]
    fn sizes_are_a_distribution_with_none_in_it() {
        let sizes = Sizes::about(0.01, 1.0);
        assert_eq!(sizes.0[0].0, 0.0);
        assert!((sizes.0.iter().map(|(_, w)| w).sum::<f64>() - 1.0).abs() < 1e-12);
    }
}
