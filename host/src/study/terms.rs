//! Two terms fitted to a foam of one: the equivalent optima (thesis Table 2).
//!
//! With equal Poisson's ratios a two-term Hyperfoam is one of a single term when one modulus vanishes, whatever its exponent, or when
//! both exponents are equal, however the modulus is divided.

use std::sync::atomic::{AtomicUsize, Ordering};

use lut_gen::model::Resolution;
use rayon::prelude::*;
use serde_json::{Value, json};

use crate::identify::data::Selection;
use crate::identify::fe::{ModelError, Progress};
use crate::identify::identify_from;
use crate::identify::newton::condition::{Condition, Source};
use crate::identify::newton::coordinate::{Kind, Unknown};
use crate::identify::newton::levenberg::minimise;
use crate::identify::newton::problem::Problem;
use crate::identify::newton::setup;
use crate::identify::newton::surrogate::Node;
use crate::identify::spec::{FitSpec, FittedLaw};
use crate::report::figure::{Axis, Figure, Series, Stroke};
use crate::report::number;

use super::findings::{Findings, Picture, Table};
use super::subject::of_balls;
use super::{StudyError, Subject};

/// Exponents and shares of the grid.
const ALPHAS: [f64; 4] = [3.0, 7.0, 13.0, 22.0];
const SHARES: [f64; 3] = [0.15, 0.5, 0.85];
/// A modulus below this share of the whole counts as zero: the largest of Table 2 is 1 % of it.
pub const VANISHED: f64 = 0.02;
/// Exponents within this ratio count as equal.
pub const EQUAL: f64 = 0.05;

/// Which kind of optimum an end is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Optimum {
    /// `mu_2 = 0`: the second exponent means nothing (type 1 of thesis section 2.8).
    SecondVanishes,
    /// `mu_1 = 0`: the first exponent means nothing (type 2).
    FirstVanishes,
    /// `alpha_1 = alpha_2`: only the sum of the moduli means anything (type 3).
    EqualExponents,
    /// Two different terms that together force back as one: exact for no foam, but within the noise of the data.
    Mixture,
}

impl Optimum {
    /// All, in the order of the thesis; the mixture is not among its three.
    pub const ALL: [Optimum; 4] = [Self::SecondVanishes, Self::FirstVanishes, Self::EqualExponents, Self::Mixture];

    /// Classifies a pair of exponents with the share of the second term in the modulus.
    #[must_use]
    pub fn of(alpha: [f64; 2], share_2: f64) -> Self {
        if share_2 < VANISHED {
            Self::SecondVanishes
        } else if share_2 > 1.0 - VANISHED {
            Self::FirstVanishes
        } else if (alpha[0] / alpha[1]).ln().abs() < EQUAL {
            Self::EqualExponents
        } else {
            Self::Mixture
        }
    }

    /// In words.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::SecondVanishes => "mu_2 = 0",
            Self::FirstVanishes => "mu_1 = 0",
            Self::EqualExponents => "alpha_1 = alpha_2",
            Self::Mixture => "mixture",
        }
    }
}

/// Where one start ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct End {
    /// Exponents it started from, and the share of the second term.
    pub start: Start,
    /// Modulus of both terms together, MPa.
    pub mu_mpa: f64,
    /// Exponents.
    pub alpha: [f64; 2],
    /// Share of the second term in the modulus.
    pub share_2: f64,
    /// Loss above that of the best end; below 3.84 one parameter's 95 % interval holds both.
    pub above_best: f64,
    /// Kind of optimum.
    pub optimum: Optimum,
}

/// Exponents, and the share of the second term.
type Start = ([f64; 2], f64);

/// What the study is made with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// Starts.
    pub starts: usize,
    /// Mesh of the fits.
    pub resolution: Resolution,
}

/// Places of the coordinates.
struct Places {
    mu: usize,
    alpha: [usize; 2],
    share: usize,
}

impl Places {
    fn of(unknowns: &[Unknown]) -> Self {
        let place = |kind: Kind| unknowns.iter().position(|u| u.kind == kind).unwrap_or(0);
        Self {
            mu: place(Kind::Modulus),
            alpha: [place(Kind::Alpha(0)), place(Kind::Alpha(1))],
            share: place(Kind::Share),
        }
    }

    fn point(&self, unknowns: &[Unknown], (alpha, share): Start) -> Vec<f64> {
        let mut point: Vec<f64> = unknowns.iter().map(|u| u.coordinate(u.start)).collect();
        for (place, alpha) in self.alpha.iter().zip(alpha) {
            point[*place] = unknowns[*place].coordinate(alpha);
        }
        point[self.share] = share;
        point
    }
}

fn two_terms() -> FitSpec {
    FitSpec { law: Some(FittedLaw::Hyperfoam), terms: Some(2), ..FitSpec::default() }
}

/// The grid without its mirror images: which term is called the first changes nothing.
fn grid() -> Vec<Start> {
    let mut all = Vec::new();
    for (i, &first) in ALPHAS.iter().enumerate() {
        for &second in &ALPHAS[i..] {
            let halves = if first == second { 2 } else { SHARES.len() };
            all.extend(SHARES.iter().take(halves).map(|&share| ([first, second], share)));
        }
    }
    all
}

/// The mirror image of what was solved: terms exchanged.
fn mirrored(node: &Node) -> Node {
    let exchanged = |x: &[f64]| vec![x[1], x[0], 1.0 - x[2]];
    let negative = node.by[2].iter().map(|by| -by).collect();
    Node {
        x: exchanged(&node.x),
        value: node.value.clone(),
        by: vec![node.by[1].clone(), node.by[0].clone(), negative],
    }
}

/// MultiStart: grid, the best grid points as starts, Gauss-Newton from each on finite elements. Also the number of solves.
///
/// # Errors
/// Data that cannot be used, or solves that fail.
pub fn ends(
    subject: &Subject,
    selection: &Selection,
    effort: &Effort,
    progress: &Progress<'_>,
) -> Result<(Vec<End>, usize), StudyError> {
    let failed = |cause| ModelError::Solve { what: subject.material.clone(), cause };
    let source = |_: &Condition| Source::Solves(effort.resolution);
    let mut problem = setup::problem(&subject.experiment, selection, &subject.material, &two_terms(), &source);
    problem.weigh_by_samples(subject.experiment.sensor.noise_n);
    let places = Places::of(&problem.unknowns);
    let half = grid();
    let done = AtomicUsize::new(0);
    let solved: Vec<Vec<_>> = half
        .par_iter()
        .map(|start| {
            let point = places.point(&problem.unknowns, *start);
            let solve = |c: &Condition| c.solve(&problem.base, &problem.unknowns, &point);
            let nodes = problem.conditions.iter().map(solve).collect();
            progress("grid of MultiStart", done.fetch_add(1, Ordering::Relaxed) + 1, half.len());
            nodes
        })
        .collect();
    for (at, condition) in problem.conditions.iter_mut().enumerate() {
        for (node, _) in solved.iter().filter_map(|of_point| of_point[at].as_ref().ok()) {
            condition.surrogate.learn(mirrored(node));
            condition.surrogate.learn(node.clone());
        }
        condition.solves += half.len();
    }
    // A corner that cannot be solved is no start.
    let solvable = half.iter().zip(&solved).filter(|(_, nodes)| nodes.iter().all(Result::is_ok));
    let mut starts: Vec<Start> = solvable.map(|(start, _)| *start).collect();
    starts.extend(starts.clone().iter().map(|([a, b], share)| ([*b, *a], 1.0 - share)));
    starts.dedup();
    let starts = best_of(&problem, &places, starts, effort.starts);
    let mut found = Vec::new();
    for (at, start) in starts.iter().enumerate() {
        progress("starts", at, starts.len());
        let point = places.point(&problem.unknowns, *start);
        let end = problem.search(&[point], usize::MAX, &|_| {}).map_err(failed)?;
        found.push((*start, end.minimum));
    }
    progress("starts", starts.len(), starts.len());
    let best = found.iter().map(|(_, end)| end.at.value).fold(f64::INFINITY, f64::min);
    let unknowns = &problem.unknowns;
    let ends = found.iter().map(|(start, end)| {
        let value = |at: usize| unknowns[at].value(end.x[at]);
        let (alpha, share_2) = (places.alpha.map(value), value(places.share));
        End {
            start: *start,
            mu_mpa: value(places.mu),
            alpha,
            share_2,
            above_best: end.at.value - best,
            optimum: Optimum::of(alpha, share_2),
        }
    });
    Ok((ends.collect(), problem.solves()))
}

/// The grid points with the least loss, each at its best modulus: those below MultiStart's threshold.
fn best_of(problem: &Problem<'_>, places: &Places, starts: Vec<Start>, count: usize) -> Vec<Start> {
    let mut region = problem.region();
    let mut judged: Vec<(Start, f64)> = starts
        .into_iter()
        .map(|start| {
            let point = places.point(&problem.unknowns, start);
            for axis in (0..point.len()).filter(|axis| *axis != places.mu) {
                (region.low[axis], region.high[axis]) = (point[axis], point[axis]);
            }
            (start, minimise(&|x| problem.quadratic(x), &region, &point).at.value)
        })
        .collect();
    judged.sort_by(|a, b| a.1.total_cmp(&b.1));
    judged.truncate(count);
    judged.into_iter().map(|(start, _)| start).collect()
}

/// What identify says of each parameter of two terms from the same data.
fn sentences(subject: &Subject, selection: &Selection, effort: &Effort) -> Result<Vec<String>, StudyError> {
    let mut experiment = subject.experiment.clone();
    for (at, run) in experiment.runs.iter_mut().enumerate() {
        run.hold_out |= !selection.curves.iter().any(|curve| curve.run == at);
    }
    let source = |_: &Condition| Source::Solves(effort.resolution);
    let found = identify_from(&experiment, &subject.material, &two_terms(), &source)?;
    let verdicts = found.fit.iter().flat_map(|fit| &fit.parameters).filter_map(|p| p.verdict.as_ref());
    Ok(verdicts.map(|verdict| verdict.sentence.clone()).collect())
}

/// The study.
///
/// # Errors
/// As [`ends`].
pub fn study(subject: &Subject, effort: &Effort, progress: &Progress<'_>) -> Result<Findings, StudyError> {
    let all = subject.foam_selection("terms")?;
    // The thesis used the smaller ball alone.
    let ball = subject.balls(&all).first().copied().unwrap_or(0);
    let selection = of_balls(&all, &[ball]);
    let (ends, solves) = ends(subject, &selection, effort, progress)?;
    progress("what identify says", 0, 0);
    let said = sentences(subject, &selection, effort)?;
    let count = |kind: Optimum| ends.iter().filter(|end| end.optimum == kind).count();
    let mut answer: Vec<String> = Vec::new();
    let ended = |kind: &Optimum| format!("{} at {}", count(*kind), kind.word());
    let counted: Vec<String> = Optimum::ALL[..3].iter().map(ended).collect();
    answer.push(format!(
        "of {} starts end {}; {} at a mixture of two different terms",
        ends.len(),
        counted.join(", "),
        count(Optimum::Mixture)
    ));
    let farthest = ends.iter().map(|end| end.above_best).fold(0.0, f64::max);
    answer.push(format!(
        "their losses differ by {} at most, where a 95 % interval reaches to 3.84: {}",
        number(farthest),
        if farthest < 3.84 { "they are one optimum to these data" } else { "not all of them are equally good" }
    ));
    answer.extend(said.iter().map(|sentence| format!("identify says: {sentence}")));
    Ok(Findings {
        study: "terms",
        title: "Two terms fitted to a foam of one".to_owned(),
        subject: subject.sentence(),
        method: vec![
            format!("MultiStart: a grid of 4 x 4 exponents and 3 shares of the second term in the modulus, the best {} of it as starts, Gauss-Newton on finite elements from each, {} alone (as thesis Table 2); {solves} solves in all, the mirror images of the grid come free.", ends.len(), subject.ball_name(ball)),
            format!("A modulus below {} % of the whole counts as zero, exponents within {} % as equal.", 100.0 * VANISHED, 100.0 * EQUAL),
            "A mixture has two different exponents and both moduli; the thesis does not list it. Its force differs from one term's by less than the noise.".to_owned(),
        ],
        answer,
        tables: vec![table(&ends)],
        pictures: vec![picture(&ends)],
        json: [
            ("counts".to_owned(), Optimum::ALL.iter().map(|&kind| (kind.word().to_owned(), json!(count(kind)))).collect()),
            ("ends".to_owned(), ends.iter().map(json_of).collect()),
            ("sentences".to_owned(), json!(said)),
            ("largest_loss_above_best".to_owned(), json!(farthest)),
            ("fe_solves".to_owned(), json!(solves)),
        ]
        .into_iter()
        .collect(),
    })
}

fn json_of(end: &End) -> Value {
    json!({
        "start": {"alpha": end.start.0, "share_2": end.start.1},
        "mu_MPa": [end.mu_mpa * (1.0 - end.share_2), end.mu_mpa * end.share_2],
        "alpha": end.alpha,
        "loss_above_best": end.above_best,
        "kind": end.optimum.word(),
    })
}

fn table(ends: &[End]) -> Table {
    let mut table = Table::new(&["mu_1 (MPa)", "alpha_1", "mu_2 (MPa)", "alpha_2", "loss above best", "kind"]);
    let mut sorted: Vec<&End> = ends.iter().collect();
    sorted.sort_by_key(|end| Optimum::ALL.iter().position(|kind| *kind == end.optimum));
    for end in sorted {
        table.rows.push(vec![
            number(end.mu_mpa * (1.0 - end.share_2)),
            number(end.alpha[0]),
            number(end.mu_mpa * end.share_2),
            number(end.alpha[1]),
            format!("{:.3}", end.above_best),
            end.optimum.word().to_owned(),
        ]);
    }
    table
}

/// The three kinds of optimum are three lines of this plane, in the shape of an H.
fn picture(ends: &[End]) -> Picture {
    let at = |alpha: [f64; 2], share: f64| (share, alpha[1] / alpha[0]);
    let y = Axis::new("alpha_2 / alpha_1").logarithmic().over(0.09, 11.0);
    let mut figure =
        Figure::new("Where the starts end", Axis::new("share of the second term in mu").over(-0.03, 1.03), y);
    figure.size.1 = 400.0;
    for line in [vec![(0.0, 0.09), (0.0, 11.0)], vec![(1.0, 0.09), (1.0, 11.0)], vec![(0.0, 1.0), (1.0, 1.0)]] {
        figure = figure.with(Series::new("", line, Stroke::Dotted, 5));
    }
    for end in ends {
        let way = vec![at(end.start.0, end.start.1), at(end.alpha, end.share_2)];
        figure = figure.with(Series::new("", way, Stroke::Faint, 5));
    }
    for (colour, kind) in Optimum::ALL.into_iter().enumerate() {
        let of_kind: Vec<(f64, f64)> =
            ends.iter().filter(|end| end.optimum == kind).map(|end| at(end.alpha, end.share_2)).collect();
        figure = figure.with(Series::new(kind.word(), of_kind, Stroke::Dots, colour));
    }
    Picture {
        file: "study-terms".to_owned(),
        svg: figure.svg(),
        caption: "Dots: ends, joined to their starts. On the three dotted lines two terms are exactly one: left mu_2 = 0, right mu_1 = 0, across alpha_1 = alpha_2.".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_thesis_own_optima_are_of_its_three_kinds() {
        // Table 2: mu_1, alpha_1, mu_2, alpha_2, and the type that section 2.8 gives it.
        let rows = [
            (0.221, 10.65, 3.75e-4, 3.43, Optimum::SecondVanishes),
            (0.220, 10.52, 1.13e-4, 8.53, Optimum::SecondVanishes),
            (6.45e-4, 8.50, 0.219, 10.52, Optimum::FirstVanishes),
            (0.094, 10.52, 0.126, 10.52, Optimum::EqualExponents),
            (0.085, 10.52, 0.134, 10.52, Optimum::EqualExponents),
            (0.001, 12.69, 0.192, 12.72, Optimum::FirstVanishes),
            (0.191, 12.69, 0.001, 3.31, Optimum::SecondVanishes),
            (0.118, 12.74, 0.075, 12.73, Optimum::EqualExponents),
        ];
        for (mu_1, alpha_1, mu_2, alpha_2, kind) in rows {
            assert_eq!(Optimum::of([alpha_1, alpha_2], mu_2 / (mu_1 + mu_2)), kind, "{mu_1} {mu_2}");
        }
        assert_eq!(Optimum::of([8.0, 16.0], 0.5), Optimum::Mixture);
    }

    #[test]
    fn exchanging_the_terms_twice_changes_nothing() {
        let node = Node { x: vec![1.0, 2.0, 0.25], value: vec![5.0], by: vec![vec![1.0], vec![2.0], vec![3.0]] };
        let twice = mirrored(&mirrored(&node));
        assert_eq!(twice, node);
        assert_eq!(mirrored(&node).x, [2.0, 1.0, 0.75]);
        assert_eq!(mirrored(&node).by[2], [-3.0]);
    }
}
