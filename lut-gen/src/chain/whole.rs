//! What finite elements of the whole path add to the chain.
//!
//! The chain puts effects together stage by stage: a second term is a second force, relaxation a convolution. Finite elements of the same
//! path at one point of the parameters tell what that misses; near that point the difference hardly changes, so it is added as it is.

use std::sync::Arc;

use rayon::prelude::*;

use super::predict::Chain;
use super::{Model, Passage};
use crate::contact::{Ball, Interface};
use crate::effect::{
    adhesion, friction, lag, numerics, poisson, radius, relaxation, second_term, softening, thickness,
};
use crate::law::{Hyperfoam, Material, PronyTerm, Term};
use crate::model::{Record, Resolution, Simulation, Specimen};
use crate::solve::{Motion, SolveError};

/// Force that the chain misses, run by run, for a model and those near it.
#[derive(Debug, Clone, PartialEq)]
pub struct Whole {
    /// Shear modulus (MPa) that it was found at: it is in proportion to that.
    mu_mpa: f64,
    /// N at the places of every passage.
    missed_n: Vec<Vec<f64>>,
    /// Codes of the effects that the finite elements contain.
    codes: Vec<&'static str>,
}

/// Largest distance (part of the deepest point) between a recorded path and the straight pieces it is solved on.
const STRAIGHT: f64 = 0.002;

impl Whole {
    /// True when the finite elements contain the effect.
    #[must_use]
    pub fn covers(&self, code: &str) -> bool {
        self.codes.contains(&code)
    }

    /// What is missed in a run of `places` places, N, at a shear modulus; nothing for a run that it was not made for.
    pub(super) fn missed_n(&self, run: usize, places: usize, mu_mpa: f64) -> impl Iterator<Item = f64> + '_ {
        let own = self.missed_n.get(run).filter(|missed| missed.len() == places);
        own.into_iter().flatten().map(move |missed| missed * mu_mpa / self.mu_mpa)
    }
}

/// True when a model contains what the chain, on the few places of a run, is measurably wrong about.
#[must_use]
pub fn is_rough(model: &Model) -> bool {
    needs_solve(model) || model.settings.iter().any(|s| s.effect.code == lag::FILTER.code)
}

fn needs_solve(model: &Model) -> bool {
    model.settings.iter().any(|s| [relaxation::ONE.code, second_term::EFFECT.code].contains(&s.effect.code))
}

/// The model without what finite elements of the path do not contain: softening and adhesion are other laws there, a base that slides in
/// part is none, and an error of the numerics is not theirs.
fn solvable(model: &Model) -> Model {
    let mut out = model.clone();
    let foreign = [softening::EFFECT.code, adhesion::EFFECT.code, numerics::EFFECT.code];
    out.settings.retain(|s| !foreign.contains(&s.effect.code) && s.effect != &thickness::SLIDING);
    out.whole = None;
    out
}

impl Chain {
    /// Solves the runs with finite elements at a model. `windows` are what the readings at the places of every run are means of. `kinds` tells which runs follow the same path (equal numbers): one of each is solved.
    ///
    /// # Errors
    /// The first solve that fails.
    pub fn whole(
        &self,
        model: &Model,
        contact_mm: &[f64],
        windows: &[Vec<Window>],
        kinds: &[usize],
    ) -> Result<Arc<Whole>, SolveError> {
        let bare = solvable(model);
        let first: Vec<usize> = (0..kinds.len()).filter(|i| !kinds[..*i].contains(&kinds[*i])).collect();
        let solved: Vec<(usize, Vec<(f64, f64)>)> = first
            .par_iter()
            .map(|&run| {
                let passage = &self.passages[run];
                let places = self.missed(model, &bare, (passage, &windows[run]), contact_mm[run])?;
                Ok((kinds[run], passage.time_s.iter().copied().zip(places).collect()))
            })
            .collect::<Result<_, SolveError>>()?;
        let of = |kind: usize| solved.iter().find(|(k, _)| *k == kind).map_or(&[][..], |(_, curve)| curve);
        let each = self.passages.iter().zip(kinds);
        let missed_n = each.map(|(p, kind)| p.time_s.iter().map(|t| between(of(*kind), *t)).collect()).collect();
        let codes = bare.settings.iter().map(|s| s.effect.code).collect();
        Ok(Arc::new(Whole { mu_mpa: model.mu_mpa, missed_n, codes }))
    }

    /// What the chain misses (N) at the places of a run.
    fn missed(
        &self,
        model: &Model,
        bare: &Model,
        (passage, windows): (&Passage, &[Window]),
        contact_mm: f64,
    ) -> Result<Vec<f64>, SolveError> {
        let fine = passage.refined(windows);
        let depth_mm = self.ball_depth(model, &fine, contact_mm);
        let path: Vec<(f64, f64)> = fine.time_s.iter().copied().zip(depth_mm.iter().copied()).collect();
        let added = if needs_solve(bare) { self.added(bare, passage, &path)? } else { Vec::new() };
        let at_fine = self.on_ball(bare, &Passage { depth_mm, ..fine.clone() });
        let curve: Vec<(f64, f64)> =
            fine.time_s.iter().zip(at_fine).map(|(t, force_n)| (*t, force_n + between(&added, *t))).collect();
        let coarse_mm = self.ball_depth(model, passage, contact_mm);
        let at_places = self.on_ball(bare, &Passage { depth_mm: coarse_mm, ..passage.clone() });
        let each = passage.time_s.iter().zip(windows).zip(at_places);
        Ok(each.map(|((t, window), force_n)| window.mean(&curve, *t) - force_n).collect())
    }

    /// Time (s) along a path of the ball and what finite elements of it add there to the chain, N.
    fn added(&self, bare: &Model, passage: &Passage, path: &[(f64, f64)]) -> Result<Vec<(f64, f64)>, SolveError> {
        let path = straight_pieces(path);
        let Some((motion, begin_s)) = motion(&path) else { return Ok(Vec::new()) };
        let rich = self.simulation(bare, passage, motion)?;
        // the same path without history on the same mesh: the marks that its lines leave in a force cancel
        let elastic = Simulation {
            material: plain(bare, self.nu(bare, passage))?,
            interface: Interface::default(),
            ..rich.clone()
        };
        let (rich, elastic) = (rich.solve()?, elastic.solve()?);
        let stations: Vec<f64> = rich.stations.iter().map(|s| s.time_s + begin_s).collect();
        // the convolution moves straight between its places: they must be close
        let time_s = divided(&stations);
        let depth_mm = time_s.iter().map(|t| between(&path, *t)).collect();
        let along = Passage { depth_mm, time_s, ..passage.clone() };
        let shapes = bare.settings.iter().filter(|s| is_shape(s.effect.code)).cloned().collect();
        let base = Model { settings: shapes, ..bare.clone() };
        let (with, without) = (self.on_ball(bare, &along), self.on_ball(&base, &along));
        let chain: Vec<(f64, f64)> =
            along.time_s.iter().zip(with.iter().zip(&without)).map(|(t, (a, b))| (*t, a - b)).collect();
        let softness = softness(&elastic);
        let each = rich.stations.iter().zip(stations).map(|(s, t)| {
            let hard_n = s.force_n + between(&softness, s.depth_mm) * s.force_n * s.force_n;
            (t, hard_n - elastic.force_at(s.time_s) - between(&chain, t))
        });
        Ok(each.collect())
    }

    fn nu(&self, model: &Model, passage: &Passage) -> f64 {
        self.library.families[passage.geometry].geometry.nu + model.first(&poisson::EFFECT, 0)
    }

    fn simulation(&self, model: &Model, passage: &Passage, motion: Motion) -> Result<Simulation, SolveError> {
        let geometry = &self.library.families[passage.geometry].geometry;
        let nu = self.nu(model, passage);
        let mut terms = vec![Term { mu_mpa: model.mu_mpa, alpha: model.alpha, nu }];
        for second in model.of(&second_term::EFFECT) {
            if let [ratio, alpha] = second.values[..] {
                terms.push(Term { mu_mpa: ratio * model.mu_mpa, alpha, nu });
            }
        }
        let prony = [&relaxation::ONE, &relaxation::TWO].into_iter().flat_map(|effect| model.of(effect));
        let prony: Vec<PronyTerm> = prony
            .flat_map(|s| s.values.chunks_exact(2))
            .filter(|t| t[0] > 0.0)
            .map(|t| PronyTerm { g: t[0], k: t[0], tau_s: t[1] })
            .collect();
        let mut material: Material = Hyperfoam::new(terms)?.into();
        if !prony.is_empty() {
            material = material.relaxing(prony)?;
        }
        let height_mm = geometry.specimen.height_mm + model.first(&thickness::HEIGHT, passage.specimen);
        Ok(Simulation {
            material,
            specimen: Specimen { height_mm, ..geometry.specimen },
            ball: Ball { radius_mm: geometry.ball_mm + model.first(&radius::EFFECT, passage.indenter) },
            interface: Interface { friction: model.first(&friction::EFFECT, 0), ..Interface::default() },
            motion,
            resolution: Resolution::Standard,
        })
    }
}

/// What the softness of the penalty takes from a force, over its square (1/N), by depth (mm), from the way down of an elastic solve. The record
/// of a path differentiates the penalty's energy by depth, which is not its share of the force where the ball turns and a memory relaxes.
fn softness(elastic: &Record) -> Vec<(f64, f64)> {
    let each = elastic.stations.iter().zip(&elastic.force_n).filter(|(s, _)| s.force_n > 0.0);
    let mut deepest = 0.0;
    let down = each.filter(|(s, _)| {
        // a hold stays where it is but for rounding
        let deeper = s.depth_mm > deepest * (1.0 + 1e-6);
        deepest = s.depth_mm.max(deepest);
        deeper
    });
    down.map(|(s, f)| (s.depth_mm, (f - s.force_n) / s.force_n.powi(2))).collect()
}

/// Effects that only change the numbers of the elastic solve, which the chain's force models contain exactly.
fn is_shape(code: &str) -> bool {
    [poisson::EFFECT.code, thickness::HEIGHT.code, radius::EFFECT.code].contains(&code)
}

/// The first term of a model's law alone, without memory.
fn plain(model: &Model, nu: f64) -> Result<Material, SolveError> {
    Ok(Hyperfoam::new(vec![Term { mu_mpa: model.mu_mpa, alpha: model.alpha, nu }])?.into())
}

/// The motion along a path of times and depths, and the path's time at which it begins; none where nothing is touched.
fn motion(path: &[(f64, f64)]) -> Option<(Motion, f64)> {
    let (first, second) = (path.first()?, path.get(1)?);
    let deepest = path.iter().map(|p| p.1).fold(0.0, f64::max);
    if deepest <= 0.0 {
        return None;
    }
    let mut motion = Motion::from_touch();
    let mut begin_s = first.0;
    if first.1 > 0.0 {
        // what was not recorded is passed at the rate of the first piece
        let rate = ((second.1 - first.1) / (second.0 - first.0)).max(deepest / 1e3);
        begin_s -= first.1 / rate;
        motion = motion.to_depth_within(first.1, first.1 / rate);
    } else {
        motion.start_mm = first.1;
    }
    let mut at_mm = first.1;
    for pair in path.windows(2) {
        // a hold is one, whatever the last digit of a mean says: forces are differentiated by depth
        if (pair[1].1 - at_mm).abs() > 1e-6 * deepest {
            at_mm = pair[1].1;
        }
        motion = motion.to_depth_within(at_mm, pair[1].0 - pair[0].0);
    }
    Some((motion, begin_s))
}

/// Samples that a reading is the mean of, evenly over a length of time.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Window {
    /// Samples times their distance (s).
    pub length_s: f64,
    /// Samples; up to 1 for an instant.
    pub samples: usize,
}

/// Readings that stand for a window of more samples.
const READINGS: usize = 8;

impl Window {
    /// Times (s) of its readings: those of the samples themselves where they are few, because next to a turn of the ball half a sample counts.
    fn times_s(self, middle_s: f64) -> impl Iterator<Item = f64> {
        let count = self.samples.clamp(1, READINGS);
        (0..count).map(move |k| middle_s + self.length_s * ((k as f64 + 0.5) / count as f64 - 0.5))
    }

    fn mean(self, curve: &[(f64, f64)], middle_s: f64) -> f64 {
        let count = self.samples.clamp(1, READINGS) as f64;
        self.times_s(middle_s).map(|t| between(curve, t)).sum::<f64>() / count
    }
}

impl Passage {
    /// The same motion with places for the readings of every window.
    fn refined(&self, windows: &[Window]) -> Self {
        let path: Vec<(f64, f64)> = self.time_s.iter().copied().zip(self.depth_mm.iter().copied()).collect();
        let (first, last) = (self.time_s.first().copied().unwrap_or(0.0), self.time_s.last().copied().unwrap_or(0.0));
        let mut time_s = self.time_s.clone();
        for (t, window) in self.time_s.iter().zip(windows) {
            time_s.extend(window.times_s(*t).filter(|t| *t > first && *t < last));
        }
        time_s.sort_by(f64::total_cmp);
        time_s.dedup_by(|b, a| *b - *a < 1e-5);
        let depth_mm = time_s.iter().map(|t| between(&path, *t)).collect();
        Self { time_s, depth_mm, ..self.clone() }
    }
}

/// Times with three more between each two.
fn divided(times: &[f64]) -> Vec<f64> {
    let mut out: Vec<f64> =
        times.windows(2).flat_map(|two| (0..4).map(|k| two[0] + 0.25 * f64::from(k) * (two[1] - two[0]))).collect();
    out.extend(times.last());
    out
}

/// Fewest of the points whose straight connections come close to all of them (Ramer, Douglas and Peucker).
fn straight_pieces(path: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let reach = STRAIGHT * path.iter().map(|p| p.1).fold(0.0, f64::max);
    let mut kept = vec![0];
    let mut ends = vec![path.len().saturating_sub(1)];
    while let (Some(&from), Some(&to)) = (kept.last(), ends.last()) {
        let miss = |i: &usize| (path[*i].1 - between(&[path[from], path[to]], path[*i].0)).abs();
        let worst = (from + 1..to).max_by(|a, b| miss(a).total_cmp(&miss(b)));
        match worst.filter(|i| miss(i) > reach) {
            Some(i) => ends.push(i),
            None => {
                ends.pop();
                kept.push(to);
            }
        }
    }
    kept.dedup();
    let mut out: Vec<(f64, f64)> = kept.into_iter().filter_map(|i| path.get(i).copied()).collect();
    out.dedup_by(|b, a| b.0 <= a.0);
    out
}

/// Value at a time on straight connections; the ends beyond them.
fn between(curve: &[(f64, f64)], time_s: f64) -> f64 {
    let next = curve.partition_point(|p| p.0 < time_s);
    match (next.checked_sub(1).and_then(|i| curve.get(i)), curve.get(next)) {
        (Some(a), Some(b)) => a.1 + (b.1 - a.1) * (time_s - a.0) / (b.0 - a.0),
        (Some(end), None) | (None, Some(end)) => end.1,
        (None, None) => 0.0,
    }
}
