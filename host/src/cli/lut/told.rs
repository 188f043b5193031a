//! What is told of a table: axes, error bound, library.

use firmware::recognition::Intervals;
use protocol::lut::{Material, Table};
use serde_json::{Value, json};

use crate::report::number;

fn hash(table: &Table<'_>) -> String {
    table.hash().iter().map(|byte| format!("{byte:02x}")).collect()
}

pub(super) fn described(table: &Table<'_>, length: usize) -> Value {
    let axes: Vec<Value> = table
        .axes()
        .map(|axis| {
            json!({
                "name": axis.name, "unit": axis.unit, "role": format!("{:?}", axis.role).to_lowercase(),
                "scale": format!("{:?}", axis.scale).to_lowercase(), "values": axis.values().collect::<Vec<f32>>(),
            })
        })
        .collect();
    let error = table.error_bound();
    json!({
        "bytes": length, "hash": hash(table), "version": table.version(), "axes": axes,
        "rows": table.rows(), "columns": table.columns(), "provenance": table.provenance(),
        "error_bound": {"discretisation": error.discretisation, "interpolation": error.interpolation,
                        "quantisation": error.quantisation, "total": error.total()},
        "materials": table.materials().map(|m| material(table, &m)).collect::<Vec<Value>>(),
    })
}

/// A library material, and the parameters that presses it stands for may have.
fn material(table: &Table<'_>, m: &Material<'_>) -> Value {
    let intervals = Intervals::of(table, m);
    json!({
        "name": m.name, "mu_MPa": m.mu_mpa, "alpha": m.alpha, "height_mm": m.height_mm, "rate_mm_s": m.rate_mm_s,
        "acceptance": m.acceptance, "mu_interval_MPa": intervals.map(|i| i.mu_mpa), "alpha_interval": intervals.map(|i| i.alpha),
        "display": {
            "force_max_N": m.display_force_max_n(), "actuator_only": m.coil().is_none(),
            "reachable_N": m.coil().map(|coil| coil.reachable_n), "current_bound_A": m.coil().map(|coil| coil.bound_a),
        },
    })
}

/// What of a material the display can show.
pub(super) fn display(m: &Material<'_>) -> String {
    let force = |n: f32| number(f64::from(n));
    let shaft = format!("shaft from 0 to {} N", force(m.display_force_max_n()));
    match m.coil() {
        None => format!("{shaft}; no control curve: the actuator displays alone"),
        Some(coil) => {
            let (from, to) = coil.reachable_n;
            format!(
                "{shaft}; coil from {} to {} N within {} A, held at its limit beyond (unreachable)",
                force(from),
                force(to),
                force(coil.bound_a)
            )
        }
    }
}

pub(super) fn print(table: &Table<'_>, length: usize) {
    let (rows, columns, version) = (table.rows(), table.columns(), table.version());
    outln!("form        {rows} rows x {columns} stored columns, {length} bytes, layout version {version}");
    outln!("hash        {}", hash(table));
    for axis in table.axes() {
        let values: Vec<f32> = axis.values().collect();
        let ends = match (values.first(), values.last()) {
            (Some(low), Some(high)) => format!("{} to {}", number(f64::from(*low)), number(f64::from(*high))),
            _ => "empty".to_owned(),
        };
        let (role, scale) = (format!("{:?}", axis.role).to_lowercase(), format!("{:?}", axis.scale).to_lowercase());
        outln!("axis        {:8} {ends} {} in {} values, {scale}, {role}", axis.name, axis.unit, values.len());
    }
    let error = table.error_bound();
    outln!(
        "error       {} % of a curve's peak: finite elements {} %, between depths {} %, rounding {} %",
        percent(error.total()),
        percent(error.discretisation),
        percent(error.interpolation),
        percent(error.quantisation)
    );
    for material in table.materials() {
        outln!(
            "material    {:10} mu {} MPa, alpha {}, height {} mm; accepted within {} % of its force{}",
            material.name,
            number(f64::from(material.mu_mpa)),
            number(f64::from(material.alpha)),
            number(f64::from(material.height_mm)),
            percent(material.acceptance),
            Intervals::of(table, &material).map_or(String::new(), |i| format!(
                ": mu {:.4} to {:.4}, or alpha {:.2} to {:.2}",
                i.mu_mpa.0, i.mu_mpa.1, i.alpha.0, i.alpha.1
            ))
        );
    }
    for material in table.materials() {
        outln!("display     {:10} {}", material.name, display(&material));
    }
    outln!("provenance  {}", table.provenance());
}

fn percent(share: f32) -> String {
    number(100.0 * f64::from(share))
}
