//! A thousand identifications on the same data, to be timed (thesis section 3.4): curves of known contact at the 200 depths of the
//! table, for materials drawn evenly from the thesis' ranges.

use firmware::kalman::bounds::Estimator;
use firmware::kalman::identify::identify;
use firmware::kalman::indentation::Indentation;
use firmware::kalman::{Bounding, Region};
use firmware::profile::ProfileSearch;
use firmware::search::{Search, Slice};
use firmware::surface::Surface;
use lut_gen::solid::model::Specimen;
use lut_gen::table::{ForceGrid, Form, GridSpec, LutError, write};
use nalgebra::Vector2;
use palpate::plant::{Noise, Source};
use protocol::lut::{Table, TableError, axis_name};

use crate::palpations::{BALL, Conditions};
use crate::processor::Clock;

/// Number of identifications.
pub const IDENTIFICATIONS: usize = 1000;

/// Height of the specimen, mm (EVA's).
const HEIGHT_MM: f64 = 12.7;

/// Moduli (MPa) and exponents that materials are drawn from: inside the thesis' grid.
const MU_MPA: (f64, f64) = (0.005, 0.28);
const ALPHA: (f64, f64) = (1.5, 23.0);

/// Different exponents among the materials: as many solves' interpolants.
const EXPONENTS: usize = 100;

/// Table and measured curves.
#[derive(Debug, Clone, PartialEq)]
pub struct Thousand {
    /// Bytes of the table: 30 exponents, 30 moduli, one height.
    pub table: Vec<u8>,
    /// Depths of the samples, mm.
    pub depth_mm: Vec<f32>,
    /// Measured forces, N: `[identification][depth]`.
    pub force_n: Vec<Vec<f32>>,
    /// True modulus (MPa) and exponent of each.
    pub truth: Vec<(f64, f64)>,
}

/// What the identifications found and what they took.
#[derive(Debug, Clone, PartialEq)]
pub struct Timed {
    /// Number of the best of the 900 columns, exponent slow and modulus fast.
    pub column: Vec<usize>,
    /// Modulus (MPa) and exponent.
    pub found: Vec<(f64, f64)>,
    /// CPU time of all, s, one thread; the thesis counts CPU time as well.
    pub seconds: f64,
}

impl Thousand {
    /// Solves the table and, over other exponents, the measured curves.
    ///
    /// # Errors
    /// The first solve that fails, or what the writer refuses.
    pub fn new() -> Result<Self, LutError> {
        let failed = |source| LutError::Material { name: "grid".into(), source };
        let spec = GridSpec::thesis(Specimen::of_height(HEIGHT_MM), BALL);
        let grid = ForceGrid::build(&spec, &|_, _| ()).map_err(failed)?;
        let step = (ALPHA.1 - ALPHA.0) / (EXPONENTS - 1) as f64;
        let alpha: Vec<f64> = (0..EXPONENTS).map(|i| ALPHA.0 + step * i as f64).collect();
        let between = ForceGrid::build(&GridSpec { alpha, ..spec.clone() }, &|_, _| ()).map_err(failed)?;
        let mut choice = Noise::new(1, Source::Choice);
        let mut noise = Noise::new(1, Source::Force);
        let noise_n = Conditions::default().noise_n;
        let mut out = Thousand {
            table: write(&[grid], Form::Factored, Vec::new())?,
            depth_mm: spec.depth_mm.iter().map(|d| *d as f32).collect(),
            force_n: Vec::new(),
            truth: Vec::new(),
        };
        for _ in 0..IDENTIFICATIONS {
            let exponent = choice.below(EXPONENTS);
            let mu_mpa = MU_MPA.0 + (MU_MPA.1 - MU_MPA.0) * choice.below(10_000) as f64 / 9_999.0;
            let shape = &between.force_per_mpa[exponent];
            out.force_n.push(shape.iter().map(|f| (mu_mpa * f + noise_n * noise.normal()) as f32).collect());
            out.truth.push((mu_mpa, between.spec.alpha[exponent]));
        }
        Ok(out)
    }

    /// The table, checked.
    ///
    /// # Errors
    /// None for a table of [`Thousand::new`].
    pub fn table(&self) -> Result<Table<'_>, TableError> {
        Table::parse(&self.table)
    }

    /// The variance search of the board (Eq. 17 over 900 columns) on every curve.
    ///
    /// # Errors
    /// As [`Thousand::table`].
    pub fn variance(&self) -> Result<Timed, TableError> {
        let table = self.table()?;
        let mut timed = Timed { column: Vec::new(), found: Vec::new(), seconds: 0.0 };
        let clock = Clock::of_thread();
        let mut search = Search::new();
        for force_n in &self.force_n {
            let Some(slice) = Slice::nearest(&table, HEIGHT_MM as f32, 0.0) else { break };
            search.reset();
            for (depth_mm, force_n) in self.depth_mm.iter().zip(force_n) {
                search.step(&table, &slice, *depth_mm, *force_n);
            }
            let Some(found) = search.found(&slice) else { break };
            let (mu_mpa, alpha) = slice.parameters(&table, found.index);
            timed.column.push(found.index);
            timed.found.push((f64::from(mu_mpa), f64::from(alpha)));
        }
        timed.seconds = clock.cpu_s();
        Ok(timed)
    }

    /// The board's fast search: one row an exponent, modulus in closed form, on every curve. `column` stays empty.
    ///
    /// # Errors
    /// As [`Thousand::table`].
    pub fn fast(&self) -> Result<Timed, TableError> {
        let table = self.table()?;
        let mut timed = Timed { column: Vec::new(), found: Vec::new(), seconds: 0.0 };
        let clock = Clock::of_thread();
        for force_n in &self.force_n {
            let Some(slice) = Slice::nearest(&table, HEIGHT_MM as f32, 0.0) else { break };
            let mut search = ProfileSearch::new(&table, &slice);
            for (depth_mm, force_n) in self.depth_mm.iter().zip(force_n) {
                search.step(&table, *depth_mm, *force_n);
            }
            let Some(found) = search.found(&table) else { break };
            timed.found.push((f64::from(found.mu_mpa), f64::from(found.alpha)));
        }
        timed.seconds = clock.cpu_s();
        Ok(timed)
    }

    /// The region of the filter: the grid of the table.
    ///
    /// # Errors
    /// As [`Thousand::table`].
    pub fn region(&self) -> Result<Region<2>, TableError> {
        let table = self.table()?;
        let end = |name: &str, last: bool| {
            table.axis(name).map_or(0.0, |axis| axis.value(if last { axis.len() - 1 } else { 0 }))
        };
        let corner = |last| Vector2::new(end(axis_name::MU, last), end(axis_name::ALPHA, last));
        Ok(Region { low: corner(false), high: corner(true) })
    }

    /// The board's Kalman filter (Eqs. 18-21) from the middle of the grid on every curve, `passes` times over each.
    ///
    /// # Errors
    /// As [`Thousand::table`].
    pub fn kalman(&self, bounding: Bounding, passes: u8) -> Result<Timed, TableError> {
        let (table, region) = (self.table()?, self.region()?);
        let variance = (Conditions::default().noise_n * Conditions::default().noise_n) as f32;
        let mut timed = Timed { column: Vec::new(), found: Vec::new(), seconds: 0.0 };
        let clock = Clock::of_thread();
        for force_n in &self.force_n {
            let slice = Slice::nearest(&table, HEIGHT_MM as f32, 0.0);
            let Some(surface) = slice.and_then(|slice| Surface::new(&table, &slice)) else { break };
            let mut estimator = Estimator::new(region.middle(), region, bounding);
            let samples = self.depth_mm.iter().copied().zip(force_n.iter().copied());
            identify(&mut estimator, &Indentation { surface }, samples, variance, passes);
            let state = region.nearest(&estimator.filter.state);
            timed.found.push((f64::from(state[0]), f64::from(state[1])));
        }
        timed.seconds = clock.cpu_s();
        Ok(timed)
    }
}

/// The run of least time out of `times`: other jobs on the machine only ever slow one down.
///
/// # Errors
/// What the runs return.
pub fn fastest<E>(times: usize, run: impl Fn() -> Result<Timed, E>) -> Result<Timed, E> {
    let mut best = run()?;
    for _ in 1..times {
        let next = run()?;
        if next.seconds < best.seconds {
            best = next;
        }
    }
    Ok(best)
}
