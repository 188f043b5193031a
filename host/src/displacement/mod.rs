//! Displacement tables of the linear actuator: where the shaft is under a finger's force (thesis sections 5.2 to 5.4, Figs. 70
//! and 71), from a recorded compression.
//!
//! A compression gives stress over strain. Under a cap of a stated area the force of the finger is that stress, and the shaft
//! gives way by that strain of the displayed thickness. The thesis states neither.

pub mod pulp;
pub mod table;

use lut_gen::pad::hertz::Elastic;

use crate::experiment::{Experiment, Run, Test, motion, signal};
use crate::identify::contact;
use table::Displacement;

/// Nodes of a table.
const NODES: usize = 60;
/// Strains between which the modulus of the thesis' correction is taken: beyond the toe, before the foam's plateau.
const LINEAR: (f64, f64) = (0.02, 0.08);

/// The display that a table is for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cap {
    /// Area over which the finger presses, mm2.
    pub area_mm2: f64,
    /// Thickness of the displayed material, mm; that of the specimen without.
    pub thickness_mm: Option<f64>,
    /// Largest force of the finger, N: the table ends there.
    pub most_n: f64,
    /// The thesis' correction for the finger's pulp (Eqs. 50 to 52).
    pub thesis_pulp: bool,
}

/// Tables of a compressed specimen.
#[derive(Debug, Clone, PartialEq)]
pub struct Tables {
    /// Name of the specimen.
    pub specimen: String,
    /// Going down.
    pub loading: Displacement,
    /// Coming up again, where the recording holds that.
    pub unloading: Option<Displacement>,
    /// Young's modulus of the strains 2 to 8 %, kPa.
    pub modulus_kpa: f64,
    /// Largest strain that was recorded.
    pub strain: f64,
}

/// Why a recording gives no table.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum Refused {
    /// No compression in the experiment.
    #[error(
        "{experiment}: no run with test = \"uniaxial\" on a specimen with a known height and area; expected a compression between platens"
    )]
    NoCompression {
        /// Its name.
        experiment: String,
    },
    /// A recording without a press.
    #[error("{file}: {what}; expected a compression whose force rises above its noise, to a strain of more than 8 %")]
    NoPress {
        /// The recording.
        file: String,
        /// What it is instead.
        what: String,
    },
}

/// Tables of the compressions of an experiment, in the order of its runs: of every specimen its first.
///
/// # Errors
/// [`Refused`].
pub fn tables(experiment: &Experiment, cap: &Cap) -> Result<Vec<Tables>, Refused> {
    let mut seen = Vec::new();
    let mut all = Vec::new();
    for run in experiment.runs.iter().filter(|run| run.test == Test::Uniaxial) {
        let Some(at) = run.specimen.filter(|at| !seen.contains(at)) else { continue };
        let specimen = &experiment.specimens[at];
        let (Some(height_mm), Some(radius_mm)) = (specimen.height_mm.known(), specimen.radius_mm.known()) else {
            continue;
        };
        seen.push(at);
        let area_mm2 = std::f64::consts::PI * radius_mm * radius_mm;
        let own = of(run, &specimen.material, (height_mm, area_mm2), cap)?;
        all.push(Tables { specimen: specimen.name.clone(), ..own });
    }
    if all.is_empty() { Err(Refused::NoCompression { experiment: experiment.name.clone() }) } else { Ok(all) }
}

/// Stress, kPa, over strain.
type Curve = Vec<(f64, f64)>;

fn of(run: &Run, material: &str, (height_mm, area_mm2): (f64, f64), cap: &Cap) -> Result<Tables, Refused> {
    let refused = |what: &str| Refused::NoPress { file: run.file.clone(), what: what.to_owned() };
    let motion = motion::of(&run.recording).ok_or_else(|| refused("the platen never goes down"))?;
    let (depth, force) = (&run.recording.depth_mm, &run.recording.force_n);
    let loading = motion.loading.clone();
    let lowest_n = lowest(&force[loading.clone()]);
    let pushed: Vec<f64> = force[loading.clone()].iter().map(|force| force - lowest_n).collect();
    let contact = contact::guess_of_faces(&depth[loading.clone()], &pushed, height_mm)
        .ok_or_else(|| refused("no force rises above its noise"))?;
    let before = loading.clone().filter(|i| depth[*i] < contact.contact_mm);
    let zero_n = signal::mean(before.map(|i| force[i])).unwrap_or(lowest_n);
    let curve = |samples: std::ops::Range<usize>| -> Curve {
        let each = samples.map(|i| ((depth[i] - contact.contact_mm) / height_mm, 1e3 * (force[i] - zero_n) / area_mm2));
        each.filter(|(strain, _)| *strain > 0.0).collect()
    };
    let most_kpa = 1e3 * cap.most_n / cap.area_mm2;
    let whole = rising(curve(loading.clone()));
    let down = rising(below(curve(loading), most_kpa));
    let strain = whole.last().map_or(0.0, |last| last.0);
    if strain <= LINEAR.1 {
        return Err(refused(&format!("the strain ends at {:.1} %", 100.0 * strain)));
    }
    let modulus_kpa = slope(&whole).filter(|kpa| *kpa > 0.0).ok_or_else(|| refused("the stress does not rise"))?;
    let thickness_mm = cap.thickness_mm.unwrap_or(height_mm);
    let soft = cap.thesis_pulp.then_some(Elastic { young_mpa: 1e-3 * modulus_kpa, nu: 0.0 });
    let table = |branch: &str, curve: &Curve| Displacement {
        material: material.to_owned(),
        branch: branch.to_owned(),
        cap_mm2: cap.area_mm2,
        thickness_mm,
        provenance: format!(
            "palpate {} displacement: {}{}",
            env!("CARGO_PKG_VERSION"),
            run.file,
            if cap.thesis_pulp { ", pulp of Eqs. 50 to 52" } else { "" }
        ),
        rows: rows(curve, cap.area_mm2, thickness_mm, soft),
    };
    let up = motion.unloading.map(|samples| rising(below(curve(samples).into_iter().rev().collect(), most_kpa)));
    Ok(Tables {
        specimen: String::new(),
        loading: table("loading", &down),
        unloading: up.filter(|up| up.len() > 2).map(|up| table("unloading", &up)),
        modulus_kpa,
        strain,
    })
}

/// Mean of the lowest fiftieth of the forces, N, of three at least: the sensor's zero, to begin with.
fn lowest(force_n: &[f64]) -> f64 {
    let mut sorted = force_n.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.truncate((sorted.len() / 50).max(3));
    signal::mean(sorted.into_iter()).unwrap_or(0.0)
}

/// Samples before the first whose stress is more.
fn below(curve: Curve, most_kpa: f64) -> Curve {
    curve.into_iter().take_while(|(_, kpa)| *kpa <= most_kpa).collect()
}

/// Means over even strains, then only what rises above all before: noise makes no way back.
fn rising(curve: Curve) -> Curve {
    let most = curve.iter().map(|(strain, _)| *strain).fold(0.0, f64::max);
    let mut bins = vec![(0.0, 0.0, 0usize); 2 * NODES];
    for (strain, kpa) in curve {
        let at = ((strain / most * bins.len() as f64) as usize).min(bins.len() - 1);
        let bin = &mut bins[at];
        *bin = (bin.0 + strain, bin.1 + kpa, bin.2 + 1);
    }
    let mut all: Curve = Vec::new();
    for (strain, kpa, count) in bins.into_iter().filter(|bin| bin.2 > 0) {
        let (strain, kpa) = (strain / count as f64, kpa / count as f64);
        if kpa > all.last().map_or(0.0, |last| last.1) {
            all.push((strain, kpa));
        }
    }
    all
}

/// Slope over the linear strains, kPa.
fn slope(curve: &Curve) -> Option<f64> {
    let within = curve.iter().filter(|(strain, _)| *strain >= LINEAR.0 && *strain <= LINEAR.1);
    let (strain, kpa): (Vec<f64>, Vec<f64>) = within.copied().unzip();
    signal::slope(&strain, &kpa)
}

/// Force, N, and place of the shaft, mm, at even strains from none on.
fn rows(curve: &Curve, area_mm2: f64, thickness_mm: f64, soft: Option<Elastic>) -> Vec<(f64, f64)> {
    let step = curve.len().div_ceil(NODES).max(1);
    let mut rows = vec![(0.0, 0.0)];
    let last = curve.len().saturating_sub(1);
    for (i, (strain, kpa)) in curve.iter().enumerate() {
        if i % step != 0 && i != last {
            continue;
        }
        let force_n = 1e-3 * kpa * area_mm2;
        let shaft_mm = strain * thickness_mm + soft.map_or(0.0, |soft| pulp::extra_mm(soft, force_n));
        rows.push((force_n, shaft_mm));
    }
    rows
}

#[cfg(test)]
mod tests;
