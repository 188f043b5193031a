//! What an extension gains where it matters: on a board that recognises a material and finds its parameters.
//!
//! For every condition (ball, rate, specimen) a table is computed from the base and one from the extended model, both by finite
//! elements, each with a library of the material and of neighbours that differ by 12 % of modulus from one to the next. The material's own
//! entry is fitted to the other conditions: with the effects as the model file has them, but without any sample of this one (where runs
//! are marked `hold_out`, these alone are palpations, and no fit has seen them at all). Each run is then sampled at the board's 50 Hz behind an
//! approach of the sensor's noise, and the firmware's palpation finds contact, searches the table and names a material.

mod answer;
mod error;
mod options;
mod palpation;
mod table;

pub(crate) use table::library_name;

use std::time::Instant;

use lut_gen::chain::Setting;

use crate::diagnose::Models;
use crate::diagnose::design::{Design, Series};
use crate::diagnose::fit::Problem;
use crate::experiment::Experiment;

use super::{ExtendedModel, fitting};
pub use error::GainError;
pub use options::Options;
pub use palpation::Palpated;
use table::{Arm, Tables};

/// One run as palpated with both tables.
#[derive(Debug, Clone, PartialEq)]
pub struct Trial {
    /// Name of its data file.
    pub file: String,
    /// Name of its condition.
    pub condition: String,
    /// With the table of the base.
    pub before: Palpated,
    /// With the table of the extended model.
    pub after: Palpated,
}

/// What a board makes of many palpations.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Tally {
    /// Palpations.
    pub count: usize,
    /// Named rightly.
    pub recognised: usize,
    /// Named as a neighbour.
    pub mistaken: usize,
    /// Given a modulus and an exponent.
    pub identified: usize,
    /// Root mean square of the relative errors of the modulus.
    pub mu_error: f64,
    /// The same of the exponent.
    pub alpha_error: f64,
    /// The same of the force at full depth that modulus and exponent stand for.
    pub force_error: f64,
    /// Standard deviation of the modulus over all palpations, relative to its mean: a right model gives one value.
    pub mu_spread: f64,
    /// The same of the exponent.
    pub alpha_spread: f64,
}

/// The gain.
#[derive(Debug, Clone, PartialEq)]
pub struct Gain {
    /// Name of the material.
    pub material: String,
    /// Names of the library: the material first, then its neighbours.
    pub library: Vec<String>,
    /// Every palpation.
    pub trials: Vec<Trial>,
    /// Which runs were left out of what.
    pub left_out_runs: &'static str,
    /// What errors are relative to.
    pub reference: &'static str,
    /// Effects in the extended tables.
    pub kept: Vec<String>,
    /// Effects that are not, and why.
    pub left_out: Vec<String>,
    /// Effects of the rig that were taken off the recordings before the extended board saw them.
    pub freed: Vec<String>,
    /// Finite-element solves of the tables.
    pub fe_solves: usize,
    /// Wall time, s.
    pub seconds: f64,
}

/// Measures the gain of a model on an experiment's own palpations.
///
/// # Errors
/// [`GainError`].
pub fn gain(
    experiment: &Experiment,
    model: &ExtendedModel,
    options: &Options,
    models: &Models,
    progress: &crate::diagnose::Progress<'_>,
) -> Result<Gain, GainError> {
    let start = Instant::now();
    let material = fitting::material(experiment, model)?;
    fitting::known_lengths(experiment, &material)?;
    // the tables are of declared lengths of this experiment
    let mut model = model.clone();
    model.material.clone_from(&material);
    model.declare(experiment);
    let settings = model.chain_model(experiment)?.settings;
    let design = Design::of(experiment, &material).map_err(|refusal| GainError::Nothing(refusal.to_string()))?;
    let chain = fitting::chain(&design, models, progress)?;
    let (prepared, _) = fitting::prepared(&design, &chain, experiment.sensor.noise_n, &settings)
        .ok_or_else(|| GainError::Covariance(material.clone()))?;
    let bench = Bench {
        experiment,
        model: &model,
        problem: &prepared.problem,
        rig: model.rig(),
        settings,
        noise_n: prepared.noise.sensor.sigma_n,
        marked: design.series.iter().any(|s| s.hold_out),
        truth: options.truth,
    };
    let mut tables = Tables::new(options, &material);
    let mut trials = Vec::new();
    for (group, used) in conditions(&design, bench.marked) {
        progress("palpations", group, design.groups);
        trials.extend(bench.condition(group, used, &mut tables)?);
    }
    if trials.is_empty() {
        return Err(GainError::Nothing("no run is left to be palpated".to_owned()));
    }
    let (rig, marked) = (&bench.rig, bench.marked);
    let freed = model.effects.iter().filter(|a| rig.iter().any(|s| s.effect == a.effect));
    Ok(Gain {
        library: tables.names(),
        trials,
        left_out_runs: if marked {
            "runs marked hold_out, seen by no fit"
        } else {
            "each condition in turn, its runs unseen by the fit of mu and alpha (the effects' own parameters are the file's)"
        },
        reference: if options.truth.is_some() { "the truth" } else { "the fit to the other conditions" },
        freed: freed.map(super::Added::words).collect(),
        fe_solves: tables.solves,
        kept: tables.kept,
        left_out: tables.left_out,
        material,
        seconds: start.elapsed().as_secs_f64(),
    })
}

/// What all palpations of an experiment share.
struct Bench<'a> {
    experiment: &'a Experiment,
    model: &'a ExtendedModel,
    problem: &'a Problem<'a>,
    /// Effects of the model.
    settings: Vec<Setting>,
    /// Those of them that belong to the rig.
    rig: Vec<Setting>,
    noise_n: f64,
    /// Runs are marked as held out.
    marked: bool,
    truth: Option<(f64, f64)>,
}

impl Bench<'_> {
    /// Palpates the runs of a group of conditions, on fresh or used spots, with a table of the base and one of the extended model.
    fn condition(&self, group: usize, used: bool, tables: &mut Tables<'_>) -> Result<Vec<Trial>, GainError> {
        let design = self.problem.design;
        let of = |s: &&Series| s.group == group && (s.pressed_before_mm > 0.0) == used && (!self.marked || s.hold_out);
        let runs: Vec<&Series> = design.series.iter().filter(of).collect();
        let Some(first) = runs.first() else { return Ok(Vec::new()) };
        let deepest = runs.iter().flat_map(|s| &s.nodes).map(|n| n.depth_mm).fold(0.0, f64::max);
        let declared = table::declared(self.experiment, design, first, deepest);
        let Some(problem) = self.problem.for_rows(seen(design, (!self.marked).then_some(group))) else {
            return Ok(Vec::new());
        };
        let entries = [&[][..], &self.settings[..]].map(|effects: &[Setting]| entry(&problem, effects));
        let arms = [
            Arm { spec: declared.clone(), entry: entries[0], kept: Vec::new(), left_out: Vec::new() },
            Arm::extended(self.model, &declared, entries[1], used)?,
        ];
        let made = [tables.of(&arms[0])?, tables.of(&arms[1])?];
        tables.tell(&arms[1]);
        let palpated = |arm: usize, series: &Series| -> Result<Palpated, GainError> {
            let freed = if arm == 0 { &[][..] } else { &self.rig[..] };
            let height_mm = arms[arm].spec.specimen.height_mm;
            let press = palpation::press(self.experiment, design, series, freed, height_mm, self.noise_n);
            let (bytes, peaks) = &made[arm];
            let mut palpated = palpation::judge(bytes, &press)?;
            palpated.refer(self.truth.unwrap_or(entries[arm]), peaks);
            Ok(palpated)
        };
        let trial = |series: &&Series| -> Result<Trial, GainError> {
            Ok(Trial {
                file: self.experiment.runs[series.run].file.clone(),
                condition: design.group_name(self.experiment, group),
                before: palpated(0, series)?,
                after: palpated(1, series)?,
            })
        };
        runs.iter().map(trial).collect()
    }
}

/// Groups of conditions that are palpated, fresh spots and used ones apart.
fn conditions(design: &Design, marked: bool) -> Vec<(usize, bool)> {
    let mut list: Vec<(usize, bool)> =
        design.series.iter().filter(|s| !marked || s.hold_out).map(|s| (s.group, s.pressed_before_mm > 0.0)).collect();
    list.sort_unstable();
    list.dedup();
    list
}

/// Nodes that a fit sees when a group is left out.
fn seen(design: &Design, left_out: Option<usize>) -> Vec<bool> {
    let of = |s: &Series| !s.hold_out && (design.groups < 2 || Some(s.group) != left_out);
    let mut seen: Vec<bool> =
        design.series.iter().flat_map(|s| s.nodes.iter().map(move |n| !n.lifted && of(s))).collect();
    // a table is of what a ball on the specimen shows
    seen.extend(design.checks.iter().flat_map(|check| (0..check.rows()).map(|_| false)));
    seen
}

/// mu (MPa) and alpha of the library's entry.
fn entry(problem: &Problem<'_>, settings: &[Setting]) -> (f64, f64) {
    fitting::search(problem, settings).first().map_or((f64::NAN, f64::NAN), |best| (best.x[0].exp(), best.x[1].exp()))
}

impl Gain {
    /// What the board with the table of the base made of all palpations, and that with the extended one.
    #[must_use]
    pub fn tallies(&self) -> [Tally; 2] {
        [tally(self.trials.iter().map(|t| &t.before)), tally(self.trials.iter().map(|t| &t.after))]
    }
}

/// Sums palpations up.
fn tally<'a>(all: impl Iterator<Item = &'a Palpated>) -> Tally {
    let all: Vec<&Palpated> = all.collect();
    let found: Vec<(f64, f64)> = all.iter().filter_map(|p| p.found).collect();
    let errors: Vec<[f64; 3]> = all.iter().filter_map(|p| p.error).collect();
    let rms = |which: usize| (errors.iter().map(|e| e[which].powi(2)).sum::<f64>() / errors.len() as f64).sqrt();
    let spread = |of: fn(&(f64, f64)) -> f64| {
        let n = found.len() as f64;
        let mean = found.iter().map(of).sum::<f64>() / n;
        (found.iter().map(|f| (of(f) - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt() / mean
    };
    Tally {
        count: all.len(),
        recognised: all.iter().filter(|p| p.named == Some(0)).count(),
        mistaken: all.iter().filter(|p| p.named.is_some_and(|at| at > 0)).count(),
        identified: found.len(),
        mu_error: rms(0),
        alpha_error: rms(1),
        force_error: rms(2),
        mu_spread: spread(|f| f.0),
        alpha_spread: spread(|f| f.1),
    }
}
