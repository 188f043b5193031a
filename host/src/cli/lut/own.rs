//! Own materials of a board's table: `palpate lut --material FILE...`.

use lut_gen::table::{ForceGrid, GridSpec};
use miette::{IntoDiagnostic, miette};
use protocol::lut::MaterialSpec;

use crate::extended::ExtendedModel;
use crate::extended::own::{self, Entry};
use crate::report::number;

use super::{Arguments, check, declared, sorted};

/// How far beyond the stiffest own material the moduli of a table reach: a press is not at the edge of its grid then.
const BEYOND: f64 = 1.5;

/// The materials that were asked for, an entry of the library for each height.
pub(super) struct Own {
    entries: Vec<Entry>,
}

impl Own {
    /// Reads the files; none where no own materials are asked for. Says on standard error what of a file is not in the table.
    ///
    /// # Errors
    /// A file that is no model, two of one name, a material of no known height.
    pub fn read(arguments: &Arguments) -> miette::Result<Option<Self>> {
        if arguments.material.is_empty() {
            return Ok(None);
        }
        let asked = sorted(&arguments.height_mm);
        let asked = (!asked.is_empty()).then_some(asked);
        let (mut entries, mut names) = (Vec::<Entry>::new(), Vec::<String>::new());
        for file in &arguments.material {
            let model = ExtendedModel::read(file)?;
            let of = |height_mm| declared(arguments, height_mm);
            let made = own::entries(&model, asked.as_deref(), &of, usize::from(arguments.cycle)).into_diagnostic()?;
            let Some(first) = made.first() else { continue };
            if names.contains(&first.name) {
                return Err(miette!(
                    "two materials are named \"{}\" on the board, which knows 16 letters; change `material` in {}",
                    first.name,
                    file.display()
                ));
            }
            names.push(first.name.clone());
            for entry in &made {
                check("height_mm", entry.spec.specimen.height_mm)?;
                let height = number(entry.spec.specimen.height_mm);
                entry.kept.iter().for_each(|words| errln!("{}, {height} mm: with {words}", entry.name));
                entry.left_out.iter().for_each(|words| errln!("{}, {height} mm: without {words}", entry.name));
            }
            entries.extend(made);
        }
        Ok(Some(Self { entries }))
    }

    /// Heights of the table, rising.
    pub fn heights_mm(&self) -> Vec<f64> {
        sorted(&self.entries.iter().map(|entry| entry.spec.specimen.height_mm).collect::<Vec<_>>())
    }

    /// Lets the moduli of a grid reach beyond the stiffest material. Exponents stay those that the engine is tested at.
    pub fn cover(&self, spec: &mut GridSpec) {
        let stiffest = BEYOND * self.entries.iter().map(|entry| entry.mu_mpa).fold(0.0, f64::max);
        let (low, high) = (spec.mu_mpa.first().copied(), spec.mu_mpa.last().copied());
        if let (Some(low), Some(high)) = (low, high)
            && stiffest > high
        {
            let last = (spec.mu_mpa.len() - 1) as f64;
            for (at, mu) in spec.mu_mpa.iter_mut().enumerate() {
                *mu = low + (stiffest - low) * at as f64 / last;
            }
        }
    }

    /// The library of a table of these grids: of a relaxing grid an entry a rate.
    pub fn library(&self, grids: &[ForceGrid], rates_mm_s: &[f64]) -> miette::Result<Vec<MaterialSpec>> {
        let relaxing = grids.first().is_some_and(|grid| !grid.spec.relaxation.is_empty());
        let mut all = Vec::new();
        for rate_mm_s in rates_mm_s {
            all.extend(own::library(&self.entries, *rate_mm_s, relaxing).into_diagnostic()?);
        }
        if let Some(outside) = self.entries.iter().find(|entry| !(1.0..=24.0).contains(&entry.alpha)) {
            errln!(
                "{}: alpha {} is outside the table's 1 to 24: it is recognised, and its parameters are not found",
                outside.name,
                number(outside.alpha)
            );
        }
        Ok(all)
    }
}
