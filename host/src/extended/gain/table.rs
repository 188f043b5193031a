//! Tables of base and extended model for the conditions of an experiment.

use lut_gen::solid::contact::Ball;
use lut_gen::solid::model::Specimen;
use lut_gen::solid::solve::Base as Bottom;
use lut_gen::table::{self, Foam, ForceGrid, Form, GridSpec, LutError};
use protocol::lut::MaterialSpec;

use crate::diagnose::design::{Design, Series};
use crate::experiment::{Base, Experiment};
use crate::extended::{ExtendedError, ExtendedModel};

use super::{GainError, Options};

/// Modulus of one neighbour over that of the next. A board accepts what differs by 3.6 % of the peak on average, which is about a tenth
/// of the modulus: neighbours as near as it can just tell apart.
const STEP: f64 = 1.12;
/// Neighbours on either side.
const NEIGHBOURS: i32 = 2;
/// Rows of a table.
const ROWS: usize = 200;
/// What a table is deeper than the palpations, mm: contact may be believed too high.
const BEYOND_MM: f64 = 0.3;
/// Deepest row as a part of the height: finite elements of a foam end before its ground.
const DEEPEST: f64 = 0.8;

/// One side of the comparison at one condition.
#[derive(Debug, Clone)]
pub(super) struct Arm {
    pub spec: GridSpec,
    /// mu (MPa) and alpha of the material.
    pub entry: (f64, f64),
    pub kept: Vec<String>,
    pub left_out: Vec<String>,
}

impl Arm {
    /// With the model's effects, on a spot that was pressed before or not.
    pub fn extended(
        model: &ExtendedModel,
        declared: &GridSpec,
        entry: (f64, f64),
        used: bool,
    ) -> Result<Self, ExtendedError> {
        let made = model.on_board(declared, if used { 2 } else { 1 })?;
        Ok(Self { spec: made.spec, entry, kept: made.kept, left_out: made.left_out })
    }
}

/// The grid of a condition as it is declared.
pub(super) fn declared(experiment: &Experiment, design: &Design, series: &Series, deepest_mm: f64) -> GridSpec {
    let its = &experiment.specimens[series.specimen];
    let geometry = &design.geometries[series.geometry];
    let specimen =
        Specimen { base: if its.base == Base::Bonded { Bottom::Bonded } else { Bottom::Sliding }, ..geometry.specimen };
    let depth_mm = (((deepest_mm + BEYOND_MM) / 0.25).ceil() * 0.25).min(DEEPEST * specimen.height_mm);
    GridSpec {
        rate_mm_s: design.rates_mm_per_s[series.rate],
        depth_mm: (1..=ROWS).map(|i| depth_mm * i as f64 / ROWS as f64).collect(),
        ..GridSpec::thesis(specimen, Ball { radius_mm: geometry.ball_mm })
    }
}

/// Force at the largest depth a MPa of modulus, over the exponents of a table.
#[derive(Debug, Clone)]
pub(super) struct Peaks(Vec<(f64, f64)>);

impl Peaks {
    fn of(grid: &ForceGrid) -> Self {
        let peak = |column: &Vec<f64>| column.last().copied().unwrap_or(0.0);
        Self(grid.spec.alpha.iter().copied().zip(grid.force_per_mpa.iter().map(peak)).collect())
    }

    /// Force (N), straight between exponents and constant beyond them.
    pub fn force_n(&self, mu_mpa: f64, alpha: f64) -> f64 {
        let next = self.0.partition_point(|(a, _)| *a < alpha).clamp(1, self.0.len().max(2) - 1);
        match (self.0.get(next - 1), self.0.get(next)) {
            (Some((a, f)), Some((b, g))) => mu_mpa * (f + (g - f) * ((alpha - a) / (b - a)).clamp(0.0, 1.0)),
            (Some((_, f)), None) => mu_mpa * f,
            _ => f64::NAN,
        }
    }
}

/// Tables that were made, and the grids behind them.
pub(super) struct Tables<'a> {
    options: &'a Options,
    material: &'a str,
    grids: Vec<ForceGrid>,
    pub kept: Vec<String>,
    pub left_out: Vec<String>,
    pub solves: usize,
}

impl<'a> Tables<'a> {
    pub fn new(options: &'a Options, material: &'a str) -> Self {
        Self { options, material, grids: Vec::new(), kept: Vec::new(), left_out: Vec::new(), solves: 0 }
    }

    /// Names of the library.
    pub fn names(&self) -> Vec<String> {
        factors().map(|f| if f == 1.0 { library_name(self.material) } else { format!("{f:.2} x mu") }).collect()
    }

    /// Remembers what an arm says, each sentence once.
    pub fn tell(&mut self, arm: &Arm) {
        for (list, sentences) in [(&mut self.kept, &arm.kept), (&mut self.left_out, &arm.left_out)] {
            for sentence in sentences.iter().filter(|s| !s.is_empty()) {
                if !list.contains(sentence) {
                    list.push(sentence.clone());
                }
            }
        }
    }

    /// The bytes of an arm's table, and its peaks.
    pub fn of(&mut self, arm: &Arm) -> Result<(Vec<u8>, Peaks), GainError> {
        let (mu, alpha) = arm.entry;
        let mut spec =
            GridSpec { alpha: self.options.alpha.clone(), resolution: self.options.resolution, ..arm.spec.clone() };
        if spec.relaxation.is_empty() {
            // decides nothing, and so one grid serves all rates
            spec.rate_mm_s = 1.0;
        }
        // the thesis' grid, or one that reaches as far beyond a stiffer material
        let most = spec.mu_mpa.last().copied().unwrap_or(0.3).max(2.5 * mu);
        spec.mu_mpa = (0..30).map(|i| most * (1.0 / 600.0 + (1.0 - 1.0 / 600.0) * f64::from(i) / 29.0)).collect();
        let same = |grid: &&ForceGrid| GridSpec { mu_mpa: spec.mu_mpa.clone(), ..grid.spec.clone() } == spec;
        let grid = match self.grids.iter().find(same) {
            Some(known) => known.clone(),
            None => {
                let failed = |source| LutError::Material { name: self.material.to_owned(), source };
                let made = ForceGrid::build(&spec, &|_, _| ()).map_err(failed)?;
                self.solves += made.solves;
                self.grids.push(made.clone());
                made
            }
        };
        let grid = ForceGrid { spec: spec.clone(), ..grid };
        self.solves += 1;
        let height_mm = spec.specimen.height_mm;
        let unit = Foam { name: "unit", mu_mpa: 1.0, alpha, height_mm, dummy: true };
        let own = table::library(&[unit], &spec)?;
        let library = self
            .names()
            .into_iter()
            .zip(factors())
            .flat_map(|(name, factor)| own.iter().map(move |unit| scaled(unit, &name, factor * mu)));
        let peaks = Peaks::of(&grid);
        Ok((table::write(&[grid], Form::Factored, library.collect())?, peaks))
    }
}

/// Moduli of the library over that of the material: itself first.
fn factors() -> impl Iterator<Item = f64> {
    let others = (-NEIGHBOURS..=NEIGHBOURS).filter(|k| *k != 0);
    std::iter::once(1.0).chain(others.map(|k| STEP.powi(k)))
}

/// A material as a library writes it: 16 characters of ASCII.
pub(crate) fn library_name(material: &str) -> String {
    let ascii: String = material.chars().filter(|c| c.is_ascii_graphic() || *c == ' ').take(16).collect();
    if ascii.is_empty() { "material".to_owned() } else { ascii }
}

/// The entry of unit modulus at another modulus: forces are proportional to it.
fn scaled(unit: &MaterialSpec, name: &str, mu_mpa: f64) -> MaterialSpec {
    MaterialSpec {
        name: name.to_owned(),
        mu_mpa,
        force_n: unit.force_n.iter().map(|f| mu_mpa * f).collect(),
        ..unit.clone()
    }
}
