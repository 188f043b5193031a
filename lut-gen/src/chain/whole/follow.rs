//! Solves of paths with finite elements, and what they add along them.

use rayon::prelude::*;

use super::contains::{first_term, has};
use super::history::{History, a_second_a_millimetre};
use super::job::{Job, SAME};
use super::law::{self, Beside};
use super::path::{alike, between, deepest_mm, divided, motion, straight_pieces};
use super::run::{Curve, Detail, Fine};
use super::twin::Twin;
use crate::chain::{Chain, Model, Passage};
use crate::effect::softening;
use crate::solid::model::Record;
use crate::solid::solve::SolveError;

/// Below this part of the largest elastic force a mesh is no longer wrong by a part of the force.
const SHALLOW: f64 = 0.01;
/// Rest between two presses on a spot, s: of no matter to a memory of the largest depth, and enough for any other.
const REST_S: f64 = 1e5;
/// Times are sums of durations: what lies this near (s) to another, after a rest and more, is there.
const NEAR_S: f64 = 1e-6;

/// Some paths, one after the other on a spot, as one solve.
struct Sequence {
    /// Places of their jobs, with what is added to the times of each, s.
    jobs: Vec<(usize, f64)>,
    /// The whole of it.
    path: Curve,
}

/// A solved sequence: nothing of it where nothing is touched.
struct Followed {
    sequence: Sequence,
    /// Its record, and the time on the path at which that begins, s.
    record: Option<(Record, f64)>,
}

impl Sequence {
    fn of(jobs: &[Job], places: impl IntoIterator<Item = usize>) -> Self {
        let mut out = Self { jobs: Vec::new(), path: Vec::new() };
        for place in places {
            let job = &jobs[place];
            let Some(start) = job.path.first().copied() else { continue };
            let touch = start.1.min(0.0);
            let later_s = match out.path.last() {
                // one press before, and long enough a rest for all memory but that of the largest depth
                None if job.before_mm > 0.0 => {
                    let at = |s: f64| start.0 - REST_S - s;
                    out.path.extend([(at(2.0), touch), (at(1.0), job.before_mm), (at(0.0), touch)]);
                    0.0
                }
                None => 0.0,
                Some(&(end_s, _)) => {
                    out.path.push((end_s + 1.0, touch));
                    end_s + 1.0 + REST_S - start.0
                }
            };
            out.path.extend(job.path.iter().map(|p| (p.0 + later_s, p.1)));
            out.jobs.push((place, later_s));
        }
        out
    }
}

impl Chain {
    /// Paths to be solved, and for every first run of a kind which of them is its own, with its own turns.
    pub(super) fn jobs(&self, fine: &[Fine], first: &[usize], history: History) -> (Vec<Job>, Vec<(usize, Curve)>) {
        let mut jobs: Vec<Job> = Vec::new();
        let mut of = Vec::new();
        for one in first.iter().filter_map(|run| fine.get(*run)) {
            let pieces = straight_pieces(&one.path);
            let own = history.path(pieces);
            let same = |job: &Job| {
                let near = (job.before_mm - one.before_mm).abs() <= SAME * one.before_mm;
                history != History::Time && self.block(job.run) == self.block(one.run) && near && alike(&job.path, &own)
            };
            let at = jobs.iter().position(same).unwrap_or_else(|| {
                let path = if history == History::Time { own.clone() } else { a_second_a_millimetre(&own) };
                let corners = (0..path.len()).map(|k| k as f64).collect();
                jobs.push(Job { run: one.run, path, before_mm: one.before_mm, corners, added: Vec::new() });
                jobs.len() - 1
            });
            of.push((at, own));
        }
        (jobs, of)
    }

    /// Solves some paths, and puts down what that adds to the chain along each.
    ///
    /// # Errors
    /// The first solve that fails.
    pub(super) fn follow(
        &self,
        (bare, detail): (&Model, Detail),
        jobs: &mut [Job],
        history: History,
    ) -> Result<(), SolveError> {
        let (twins, followed) = rayon::join(
            || self.twins((bare, detail), jobs),
            || {
                let sequences = self.sequences(jobs).into_par_iter();
                sequences.map(|own| self.followed((bare, detail), jobs, own)).collect::<Result<Vec<_>, SolveError>>()
            },
        );
        let twins = twins?;
        for Followed { sequence, record } in followed? {
            let Some((record, begin_s)) = record else { continue };
            for (place, later_s) in sequence.jobs {
                let job = &jobs[place];
                if let Some(twin) = twins.iter().find(|twin| twin.block == self.block(job.run)) {
                    jobs[place].added = self.added(bare, job, (&record, begin_s - later_s), history, twin);
                }
            }
        }
        Ok(())
    }

    /// Every path, and behind one on a fresh spot that of a spot that was pressed as deep before: the one is what happened before the other.
    fn sequences(&self, jobs: &[Job]) -> Vec<Sequence> {
        let mut taken = vec![false; jobs.len()];
        let mut out = Vec::new();
        for (at, job) in jobs.iter().enumerate().filter(|(_, job)| job.before_mm <= 0.0) {
            taken[at] = true;
            let follows = |i: &usize| {
                let next = &jobs[*i];
                !taken[*i] && self.block(next.run) == self.block(job.run) && next.is_after(deepest_mm(&job.path))
            };
            let next = (0..jobs.len()).find(follows);
            next.into_iter().for_each(|next| taken[next] = true);
            out.push(Sequence::of(jobs, std::iter::once(at).chain(next)));
        }
        out.extend((0..jobs.len()).filter(|at| !taken[*at]).map(|at| Sequence::of(jobs, [at])));
        out
    }

    fn followed(
        &self,
        (bare, detail): (&Model, Detail),
        jobs: &[Job],
        sequence: Sequence,
    ) -> Result<Followed, SolveError> {
        let record = match (sequence.jobs.first(), motion(&sequence.path)) {
            (Some((first, _)), Some((motion, begin_s))) => {
                let passage = &self.passages[jobs[*first].run];
                Some((self.simulation((bare, detail), passage, motion)?.solve()?, begin_s))
            }
            _ => None,
        };
        Ok(Followed { sequence, record })
    }

    /// What finite elements add to the chain along a path, N: from a record, given with the time on the path at which it begins (s).
    fn added(
        &self,
        bare: &Model,
        job: &Job,
        (rich, begin_s): (&Record, f64),
        history: History,
        elastic: &Twin,
    ) -> Curve {
        let passage = &self.passages[job.run];
        let (Some(start), Some(end)) = (job.path.first().copied(), job.path.last().copied()) else {
            return Vec::new();
        };
        let time_s = |i: usize| rich.stations[i].time_s + begin_s;
        let within = |i: &usize| time_s(*i) >= start.0 - NEAR_S && time_s(*i) <= end.0 + NEAR_S;
        let own: Vec<usize> = (0..rich.stations.len()).filter(within).collect();
        let stations: Vec<f64> = own.iter().map(|i| time_s(*i)).collect();
        // the convolution moves straight between its places: they must be close
        let time_s = divided(&stations);
        let depth_mm = time_s.iter().map(|t| between(&job.path, *t)).collect();
        let pressed_before_mm = job.before_mm;
        let moved = Passage { depth_mm, time_s, pressed_before_mm, ..passage.clone() };
        let base = first_term(bare);
        let curve = |force_n: Vec<f64>| -> Curve { moved.time_s.iter().copied().zip(force_n).collect() };
        let (with, without) = (curve(self.on_ball(bare, &moved)), curve(self.on_ball(&base, &moved)));
        let least_n = SHALLOW * elastic.force_n(elastic.deepest_mm);
        let mut each: Vec<Beside> = own
            .iter()
            .zip(stations)
            .map(|(i, t)| {
                let s = &rich.stations[*i];
                let hard_n = s.force_n + between(&elastic.softness, s.depth_mm) * s.force_n * s.force_n;
                let place = history.place(&job.path, (t.min(end.0), s.depth_mm));
                let (here_n, chain_n) = (elastic.force_n(s.depth_mm), between(&without, t));
                // both forces of a mesh are wrong by the same part of themselves
                let ratio = (here_n > least_n).then(|| hard_n / here_n);
                Beside { place, ratio, hard_n, here_n, chain_n, with_n: between(&with, t) }
            })
            .collect();
        if history == History::Turns && !has(bare, &softening::EFFECT) {
            law::smooth_ratios(&mut each, &job.corners);
        }
        each.iter().map(|b| (b.place, b.true_n() - b.with_n)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn job(path: &[(f64, f64)], before_mm: f64) -> Job {
        Job { run: 0, path: path.to_vec(), before_mm, corners: Vec::new(), added: Vec::new() }
    }

    /// A spot pressed before is what the run on the fresh one leaves, after a rest; pressed to another depth it has a press of its own before it.
    #[test]
    fn a_press_follows_the_one_before_it() {
        let press = [(0.0, 0.0), (3.0, 3.0), (6.0, 0.0)];
        let jobs = [job(&press, 0.0), job(&press, 3.004), job(&press, 2.5)];
        assert!(jobs[1].is_after(deepest_mm(&press)) && !jobs[2].is_after(deepest_mm(&press)));
        assert!(!jobs[0].is_after(0.0));
        let both = Sequence::of(&jobs, [0, 1]);
        let later_s = 7.0 + REST_S;
        assert_eq!(both.jobs, [(0, 0.0), (1, later_s)]);
        let expected = [(0.0, 0.0), (3.0, 3.0), (6.0, 0.0), (7.0, 0.0)];
        let then = press.map(|(t, d)| (t + later_s, d));
        assert_eq!(both.path, [&expected[..], &then].concat());
        let alone = Sequence::of(&jobs, [2]);
        assert_eq!(alone.jobs, [(2, 0.0)]);
        let before = [(-REST_S - 2.0, 0.0), (-REST_S - 1.0, 2.5), (-REST_S, 0.0)];
        assert_eq!(alone.path, [&before[..], &press].concat());
    }
}
