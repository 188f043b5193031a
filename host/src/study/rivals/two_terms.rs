//! The problem of four parameters: the moduli and exponents of two Hyperfoam terms, contact points at their best (thesis Fig. 89).

use crate::identify::data::Selection;
use crate::identify::multistart::Search;
use crate::identify::newton::coordinate::Kind;
use crate::identify::newton::problem::{Problem, Weight, compare};
use crate::identify::spec::Loss;

use super::landscape::Ground;

/// Recordings seen through what MultiStart solved, over its box.
pub struct TwoTerms<'a> {
    problem: Problem<'a>,
    low: Vec<f64>,
    side: Vec<f64>,
    fitted: Vec<usize>,
}

impl<'a> TwoTerms<'a> {
    /// From a problem that MultiStart has solved.
    #[must_use]
    pub fn new(mut problem: Problem<'a>, selection: &Selection, search: &Search) -> Self {
        // Differences count relative to the largest force of their run.
        let peak = |at: usize| selection.curves[at].force_n.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        problem.weights = (0..selection.curves.len()).map(|at| Weight { sigma_n: peak(at), correlated: 1.0 }).collect();
        problem.loss = Loss::Squares;
        let side = (0..search.bounds.low.len()).map(|axis| search.bounds.side(axis)).collect();
        let fitted = problem.fitted().collect();
        Self { problem, low: search.bounds.low.clone(), side, fitted }
    }

    fn coordinates(&self, u: &[f64]) -> Vec<f64> {
        u.iter().zip(self.low.iter().zip(&self.side)).map(|(u, (low, side))| low + u.clamp(0.0, 1.0) * side).collect()
    }
}

impl Ground for TwoTerms<'_> {
    fn dimension(&self) -> usize {
        self.low.len()
    }

    fn samples(&self) -> usize {
        self.problem.samples()
    }

    fn conditions(&self) -> usize {
        self.problem.conditions.len()
    }

    fn coordinates_in_words(&self) -> &'static str {
        "ln of the modulus of both terms together, ln of both exponents, the second term's share of the modulus; contact points at their best"
    }

    fn named(&self, u: &[f64]) -> Vec<(String, f64)> {
        let x = self.coordinates(u);
        let unknowns = &self.problem.unknowns;
        let value = |kind: Kind| unknowns.iter().position(|one| one.kind == kind).map(|at| unknowns[at].value(x[at]));
        let (mu, share) = (value(Kind::Modulus).unwrap_or(0.0), value(Kind::Share).unwrap_or(0.0));
        let alpha = |term: usize| value(Kind::Alpha(term)).unwrap_or(0.0);
        [("mu_1_MPa", mu * (1.0 - share)), ("alpha_1", alpha(0)), ("mu_2_MPa", mu * share), ("alpha_2", alpha(1))]
            .map(|(name, value)| (name.to_owned(), value))
            .to_vec()
    }

    fn residuals(&self, u: &[f64]) -> Vec<f64> {
        let tracks = self.problem.tracks(&self.coordinates(u));
        let mut residuals = Vec::with_capacity(self.samples());
        for &at in &self.fitted {
            let track = &tracks[self.problem.condition_of[at]];
            let data = &self.problem.selection.curves[at];
            let contact = self.problem.contact(at, track);
            let scale = 1.0 / self.problem.weights[at].sigma_n;
            residuals.extend(compare(data, track, contact).residual_n.iter().map(|r| r * scale));
        }
        residuals
    }
}
