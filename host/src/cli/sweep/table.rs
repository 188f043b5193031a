//! What a sweep's table holds, in words and as JSON.

use std::path::Path;

use lut_gen::sweep::{Parameter, SweepSpec, SweepTable, TABLE_MAGIC};
use miette::{WrapErr, miette};
use serde_json::{Value, json};

use crate::report::number;

/// Whether a file is the table of a sweep.
pub(crate) fn is_table(bytes: &[u8]) -> bool {
    bytes.starts_with(TABLE_MAGIC)
}

/// Prints what a sweep's table holds.
///
/// # Errors
/// A damaged table.
pub(crate) fn explain(file: &Path, bytes: &[u8], as_json: bool) -> miette::Result<()> {
    let table = SweepTable::parse(bytes)
        .map_err(|cause| miette!("{cause}"))
        .wrap_err_with(|| format!("{} is not a usable table", file.display()))?;
    if as_json {
        outln!("{}", described(&table, bytes));
    } else {
        print(&table, bytes);
    }
    Ok(())
}

pub(super) fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The SHA-256 that ends a table.
fn hash(bytes: &[u8]) -> String {
    hex(&bytes[bytes.len().saturating_sub(32)..])
}

pub(super) fn extent(spec: &SweepSpec) -> String {
    let (finer, between) = spec.checked();
    let counts: Vec<String> = spec.axes.iter().map(|axis| axis.values.len().to_string()).collect();
    format!(
        "{} = {} points solved at {} rates, {finer} checked on a finer mesh, {between} between the points",
        counts.join(" x "),
        spec.grid(),
        spec.motion.rates_mm_s.len(),
    )
}

pub(super) fn failures<'a>(spec: &SweepSpec, failed: impl Iterator<Item = (usize, &'a String)>) -> Vec<Value> {
    failed.map(|(job, text)| json!({"point": job, "at": spec.label(job), "error": text})).collect()
}

pub(super) fn described(table: &SweepTable, bytes: &[u8]) -> Value {
    let spec = &table.spec;
    let axes: Vec<Value> = spec
        .axes
        .iter()
        .map(|axis| {
            json!({
                "name": axis.parameter.name(), "values": axis.values, "spacing": axis.spacing,
                "role": if axis.factor { "factor" } else { "column" },
            })
        })
        .collect();
    json!({
        "bytes": bytes.len(), "hash": hash(bytes), "identity": hex(&spec.identity(&table.engine)), "name": spec.name,
        "law": spec.law, "base": spec.base, "axes": axes, "fixed": spec.fixed, "motion": spec.motion,
        "points": spec.grid(), "failed": failures(spec, table.failed.iter().map(|(job, text)| (*job, text))),
        "error_bound": table.error, "provenance": table.engine,
    })
}

pub(super) fn print(table: &SweepTable, bytes: &[u8]) {
    let spec = &table.spec;
    outln!("sweep       {}: {}", spec.name, extent(spec));
    outln!(
        "form        {} curves of {} forces, {} bytes",
        spec.grid() * spec.motion.rates_mm_s.len(),
        spec.motion.samples(),
        bytes.len()
    );
    outln!("hash        {}", hash(bytes));
    for axis in &spec.axes {
        let values: Vec<String> = axis.values.iter().map(|v| number(*v)).collect();
        let shown = if values.len() > 6 {
            format!("{} to {} in {} values", values[0], values[values.len() - 1], values.len())
        } else {
            values.join(", ")
        };
        let spacing = format!("{:?}", axis.spacing).to_lowercase();
        let role = if axis.factor { ", factor" } else { "" };
        outln!("axis        {:12} {shown}; {spacing}{role}", axis.parameter.name());
    }
    let fixed: Vec<String> =
        spec.fixed.iter().map(|(p, v)| format!("{} {}", Parameter::name(*p), number(*v))).collect();
    outln!("fixed       {}", fixed.join(", "));
    let rates: Vec<String> = spec.motion.rates_mm_s.iter().map(|v| number(*v)).collect();
    outln!(
        "motion      {} mm at {} mm/s, {} depths, {} times of hold",
        number(spec.motion.depth_mm()),
        rates.join(", "),
        spec.motion.depths_mm.len(),
        spec.motion.holds_s.len()
    );
    let error = &table.error;
    let part = |bound: Option<f64>, checks: usize| match bound {
        Some(bound) => format!("{} % ({checks} checks)", number(100.0 * bound)),
        None => "not checked".to_owned(),
    };
    outln!(
        "error       of a curve's peak: finite elements {}, between points {}, rounding none",
        part(error.discretisation, error.finer),
        part(error.interpolation, error.between)
    );
    for (job, text) in &table.failed {
        outln!("failed      point {job} ({}): {text}", spec.label(*job));
    }
    outln!("provenance  {}", table.engine);
}
