//! The search: sets of effects, and the noise that each is judged in.
//!
//! Jitter is estimated from repeats about a model. Where that is wrong by a tenth of the force, jitter
//! passes for many times what it is, and hides whatever else is there. So the noise is told about the
//! likeliest sets, one after the other, and that is kept in which the data as a whole are likeliest.

use super::discrepancy::groups;
use super::solve::solved;
use super::{Judged, Weighed};
use crate::diagnose::coordinate::Candidate;
use crate::diagnose::fit::Fit;
use crate::diagnose::progress::Progress;
use crate::diagnose::search::Search;
use crate::infer::sets::{Groups, Known, Shares, led};

/// How far behind the likeliest (logarithm) a set without a discrepancy may lie for the noise to be
/// told about it, and how often that is done.
const TOLD: f64 = 25.0;
const TELLS: usize = 4;

/// Parameters that all sets have, of which intervals are told: `mu` and `alpha`.
const ELASTIC: usize = 2;

/// What a search came to.
pub struct Found<'a> {
    /// Data and noise as what was found sees them.
    pub search: Search<'a>,
    /// The noise is another one than at first: it was told about a set.
    pub is_told: bool,
    /// Sets that were weighed, the base among them, the likeliest first.
    pub sets: Vec<Weighed>,
    /// The likeliest set of what is named, one for each choice among twins, the likeliest first.
    pub held: Vec<Weighed>,
    /// What is believed.
    pub judged: Judged,
}

impl Found<'_> {
    /// Sets between which another run is to decide.
    pub fn rivals(&self) -> Vec<&Weighed> {
        self.judged.rivals(&self.sets, &self.held)
    }
}

/// A search in one noise.
struct State<'a> {
    search: Search<'a>,
    groups: Groups,
    known: Known<Search<'a>>,
    /// Logarithm of the evidence of the likeliest for the data as they were measured, so that noises
    /// compare.
    log: f64,
}

impl<'a> State<'a> {
    fn of(search: Search<'a>, known: &[Fit], seen: &mut Vec<Vec<Candidate>>) -> Option<Self> {
        let groups = groups(&search.problem, &search.curves);
        let tried: Vec<&Fit> = known.iter().filter(|fit| !fit.candidates.is_empty()).collect();
        let led = led(&search, &groups.discrepancy, &tried, seen);
        let known = Shares::new(&search, &groups, solved(&search, led, &groups.discrepancy)).into_known();
        let log = known.sets.first()?.log - 0.5 * search.problem.whitening.log_determinant();
        Some(Self { search, groups, known, log })
    }

    /// The set that the noise is to be told about next: the likeliest, or the likeliest without a
    /// discrepancy, in which it may be another one.
    fn next(&self, told: &[Vec<Candidate>]) -> Option<&Fit> {
        let is_new = |set: &&Weighed| !told.contains(&set.fit.candidates);
        let sets = &self.known.sets;
        let near = sets.iter().filter(|set| set.log > sets[0].log - TOLD);
        let mut alone = near.filter(|set| set.is_alone(&self.groups.discrepancy)).take(1);
        sets.iter().take(1).find(is_new).or(alone.find(is_new)).map(|set| &set.fit)
    }
}

/// Searches for what explains the data, and judges it; none where nothing can be compared.
pub fn found<'a>(search: Search<'a>, stated_n: Option<f64>, progress: &Progress<'_>) -> Option<Found<'a>> {
    progress("effects", 0, TELLS);
    let mut seen = Vec::new();
    let mut state = State::of(search, &[], &mut seen)?;
    let mut told: Vec<Vec<Candidate>> = vec![Vec::new()];
    let mut is_told = false;
    for tell in 0..TELLS {
        progress("effects", tell, TELLS);
        let Some(next) = state.next(&told).cloned() else { break };
        told.push(next.candidates.clone());
        let known: Vec<Fit> = state.known.sets.iter().map(|set| set.fit.clone()).collect();
        let other = state.search.about(&next, stated_n).and_then(|search| State::of(search, &known, &mut seen));
        if let Some(other) = other.filter(|other| other.log > state.log) {
            (state, is_told) = (other, true);
        }
    }
    let State { search, groups, known, .. } = state;
    let shares = Shares::of_known(&search, &groups, known);
    let judged = Judged::of(&shares, ELASTIC)?;
    let Known { sets, .. } = shares.into_known();
    let held = judged.holding(&sets);
    Some(Found { search, is_told, sets, held, judged })
}
