//! The elastic press that a path is compared with, on the mesh of the path.

use rayon::prelude::*;

use super::job::Job;
use super::path::deepest_mm;
use super::run::{Block, Curve, Detail};
use crate::chain::{Chain, Model};
use crate::solid::contact::Interface;
use crate::solid::law::{Hyperfoam, Material, Term};
use crate::solid::model::{Record, Simulation};
use crate::solid::solve::{Motion, SolveError};

/// Pieces of an elastic ramp: straight between their ends, its force is met to 0.12/40^2, less than one in ten thousand.
const RAMP: usize = 40;

/// The first term alone, without history, pressed once on the mesh of the paths: its force depends on the depth only, and the marks that the lines
/// of the mesh leave in a force cancel where it is taken off.
pub(super) struct Twin {
    pub block: Block,
    pub deepest_mm: f64,
    record: Record,
    /// What the softness of the penalty takes from a force, over its square (1/N), by depth (mm).
    pub softness: Curve,
}

impl Twin {
    /// Force (N) at a depth (mm).
    pub fn force_n(&self, depth_mm: f64) -> f64 {
        // a piece of the ramp a second
        self.record.force_at(RAMP as f64 * (depth_mm / self.deepest_mm).clamp(0.0, 1.0))
    }
}

impl Chain {
    /// The elastic ramps of the balls and blocks of some paths, each as deep as any of them.
    pub(super) fn twins(&self, (bare, detail): (&Model, Detail), jobs: &[Job]) -> Result<Vec<Twin>, SolveError> {
        let mut deepest: Vec<(Block, usize, f64)> = Vec::new();
        for job in jobs {
            let own = deepest_mm(&job.path).max(job.before_mm);
            match deepest.iter_mut().find(|(block, ..)| *block == self.block(job.run)) {
                Some((.., depth_mm)) => *depth_mm = depth_mm.max(own),
                None => deepest.push((self.block(job.run), job.run, own)),
            }
        }
        let pressed = deepest.into_par_iter().filter(|(.., depth_mm)| *depth_mm > 0.0);
        let solve = |(block, run, deepest_mm): (Block, usize, f64)| {
            let passage = &self.passages[run];
            let place = |k: usize| deepest_mm * (k + 1) as f64 / RAMP as f64;
            let motion = (0..RAMP).fold(Motion::from_touch(), |m, k| m.to_depth_within(place(k), 1.0));
            let rich = self.simulation((bare, detail), passage, motion)?;
            let material = plain(bare, self.nu(bare, passage))?;
            let record = Simulation { material, interface: Interface::default(), ..rich }.solve()?;
            let softness = softness(&record);
            Ok(Twin { block, deepest_mm, record, softness })
        };
        pressed.map(solve).collect()
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

/// The first term of a model's law alone, without memory.
pub(super) fn plain(model: &Model, nu: f64) -> Result<Material, SolveError> {
    Ok(Hyperfoam::new(vec![Term { mu_mpa: model.mu_mpa, alpha: model.alpha, nu }])?.into())
}
