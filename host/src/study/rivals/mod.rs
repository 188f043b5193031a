//! Rival optimisers on one problem (thesis Fig. 89, where all are tools of one commercial package): evaluations, time, and how many of
//! the random starts reach the best known optimum.

pub mod evolution;
pub mod landscape;
pub mod method;
mod page;
pub mod two_terms;

use std::time::Instant;

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;

use crate::identify::fe::Progress;

use landscape::{Counted, Ground};
use method::Method;

pub use page::{Parameters, study};

/// A search succeeds when the sum of squares is so near to the best known one that the parameters lie within this many standard
/// errors of it, jointly: a fifth adds 2 % to the scatter that the noise makes.
pub const NEAR: f64 = 0.2;
/// A looser success, told beside: good enough for a first look.
pub const LOOSE: f64 = 2.0;
/// Differences below this share of a run's largest force count as none: data without noise have no standard errors.
const FLOOR: f64 = 1e-4;

/// One search.
#[derive(Debug, Clone, PartialEq)]
pub struct Search {
    /// Evaluations until it ended by itself or was spent.
    pub evaluations: usize,
    /// Evaluations until it first was near the best known optimum, if it ever was.
    pub to_success: Option<usize>,
    /// Mean square at its best point.
    pub value: f64,
    /// Every improvement: evaluations so far, and the mean square.
    pub improvements: Vec<(usize, f64)>,
    /// Wall time, s.
    pub seconds: f64,
}

/// All searches of one method.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// The method.
    pub method: Method,
    /// One search a start.
    pub searches: Vec<Search>,
}

/// A race and its problem.
#[derive(Debug, Clone, PartialEq)]
pub struct Race {
    /// One record a method, in the order of [`Method::ALL`].
    pub records: Vec<Record>,
    /// Best known mean square, and the parameters there.
    pub best: (f64, Vec<(String, f64)>),
    /// Mean square that counts as success.
    pub success_below: f64,
    /// Mean square that lies within [`LOOSE`] standard errors.
    pub loose_below: f64,
}

/// Lets all methods search from the same random starts, one after the other on one thread so that times mean something.
#[must_use]
pub fn race(landscape: &dyn Ground, starts: usize, seed: u64, progress: &Progress<'_>) -> Race {
    let mut chance = Pcg64::seed_from_u64(seed);
    let points: Vec<Vec<f64>> =
        (0..starts).map(|_| (0..landscape.dimension()).map(|_| chance.random::<f64>()).collect()).collect();
    let mut traces = Vec::new();
    let mut best = (f64::INFINITY, Vec::new());
    for method in Method::ALL {
        let mut of_method = Vec::new();
        for (at, start) in points.iter().enumerate() {
            progress(method.word(), at, starts);
            let problem = Counted::new(landscape);
            let clock = Instant::now();
            method.search(&problem, start, seed.wrapping_add(1 + at as u64));
            let seconds = clock.elapsed().as_secs_f64();
            let trace = problem.into_trace();
            if let Some((_, value)) = trace.improvements.last().filter(|(_, value)| *value < best.0) {
                best = (*value, trace.best.clone());
            }
            of_method.push((trace, seconds));
        }
        progress(method.word(), starts, starts);
        traces.push((method, of_method));
    }
    let free = landscape.samples().saturating_sub(landscape.dimension()).max(1) as f64;
    let below = |errors: f64| best.0 + errors * errors / free * best.0.max(FLOOR * FLOOR);
    let (success_below, loose_below) = (below(NEAR), below(LOOSE));
    let search = |(trace, seconds): &(landscape::Trace, f64)| Search {
        evaluations: trace.evaluations,
        to_success: trace.improvements.iter().find(|(_, value)| *value <= success_below).map(|(at, _)| *at),
        value: trace.improvements.last().map_or(f64::INFINITY, |(_, value)| *value),
        improvements: trace.improvements.clone(),
        seconds: *seconds,
    };
    let records = traces
        .iter()
        .map(|(method, all)| Record { method: *method, searches: all.iter().map(search).collect() })
        .collect();
    let named = if best.1.is_empty() { Vec::new() } else { landscape.named(&best.1) };
    Race { records, best: (best.0, named), success_below, loose_below }
}

impl Record {
    /// Share of the searches that succeeded.
    #[must_use]
    pub fn success(&self) -> f64 {
        let successes = self.searches.iter().filter(|search| search.to_success.is_some()).count();
        successes as f64 / self.searches.len().max(1) as f64
    }

    /// Share of the searches whose best mean square lies below a value.
    #[must_use]
    pub fn below(&self, value: f64) -> f64 {
        let count = self.searches.iter().filter(|search| search.value <= value).count();
        count as f64 / self.searches.len().max(1) as f64
    }

    /// Median of the evaluations until success, over those that succeeded.
    #[must_use]
    pub fn to_success(&self) -> Option<usize> {
        median(self.searches.iter().filter_map(|search| search.to_success).collect())
    }

    /// Evaluations spent on one success, failures and what comes after the success included: the price of the method with restarts.
    #[must_use]
    pub fn price(&self) -> Option<f64> {
        let successes = self.searches.iter().filter(|search| search.to_success.is_some()).count();
        let spent: usize = self.searches.iter().map(|search| search.evaluations).sum();
        (successes > 0).then(|| spent as f64 / successes as f64)
    }

    /// Median over all searches of the best mean square after so many evaluations; searches that have ended stay where they are.
    #[must_use]
    pub fn after(&self, evaluations: usize) -> f64 {
        let so_far = |search: &Search| {
            let reached = search.improvements.iter().take_while(|(at, _)| *at <= evaluations).last();
            reached.map_or(f64::INFINITY, |(_, value)| *value)
        };
        let mut values: Vec<f64> = self.searches.iter().map(so_far).collect();
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or(f64::INFINITY)
    }

    fn used(&self) -> usize {
        median(self.searches.iter().map(|search| search.evaluations).collect()).unwrap_or(0)
    }

    fn milliseconds(&self) -> f64 {
        1e3 * self.searches.iter().map(|search| search.seconds).sum::<f64>() / self.searches.len().max(1) as f64
    }
}

fn median(mut values: Vec<usize>) -> Option<usize> {
    values.sort_unstable();
    values.get(values.len() / 2).copied()
}
