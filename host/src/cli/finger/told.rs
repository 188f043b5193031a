//! What is said of a finger's press: in the terminal, and as JSON.

use std::path::PathBuf;

use lut_gen::pad::body::section::Section;
use serde_json::{Value, json};

use super::computed::Study;
use crate::finger::opposite::Opposite;
use crate::finger::reading::{BIN_MPA, Reading};
use crate::report::number;

/// A column of the table.
type Column = (&'static str, fn(&Reading) -> f64);

/// Columns of the table, kPa for stresses.
pub(super) fn columns(section: Section, on_block: bool) -> Vec<Column> {
    let ring = section == Section::Ring;
    let mut columns: Vec<Column> = vec![
        ("travel mm", |r| r.travel_mm),
        (if ring { "force N" } else { "force N/mm" }, |r| r.force_n),
        (if ring { "radius mm" } else { "half mm" }, |r| r.radius_mm),
        (if ring { "area mm2" } else { "length mm" }, |r| r.area_mm2),
        ("peak kPa", |r| 1e3 * r.peak_mpa),
        ("mean kPa", |r| 1e3 * r.mean_mpa),
    ];
    if on_block {
        columns.insert(4, ("cap mm", |r| r.cap_mm));
        columns.push(("Mises kPa", |r| r.mises.as_ref().map_or(f64::NAN, |m| 1e3 * m.nodes.mean)));
        columns.push(("median", |r| r.mises.as_ref().map_or(f64::NAN, |m| 1e3 * m.nodes.median)));
        columns.push(("geom.", |r| r.mises.as_ref().map_or(f64::NAN, |m| 1e3 * m.nodes.geometric)));
    }
    columns
}

pub(super) fn print(study: &Study) {
    outln!("{} on {}: about {} equations", study.asked.finger.title, study.asked.on.name(), study.pressed.unknowns());
    outln!("");
    let columns = columns(study.pressed.section, matches!(study.asked.on, Opposite::Block(_)));
    let wide = |name: &str| name.len().max(8);
    outln!("{}", columns.iter().map(|(name, _)| format!("{name:>0$}", wide(name))).collect::<Vec<_>>().join("  "));
    for reading in &study.readings {
        let cell = |(name, of): &Column| format!("{:>1$}", number(of(reading)), wide(name));
        outln!("{}", columns.iter().map(cell).collect::<Vec<_>>().join("  "));
    }
    outln!("");
    for line in remarks(study) {
        outln!("{line}");
    }
}

/// What a reader should know of the numbers, a sentence a line.
pub(super) fn remarks(study: &Study) -> Vec<String> {
    let mut lines = Vec::new();
    if let Opposite::Block(block) = &study.asked.on {
        lines.extend(
            block.left_out.iter().map(|words| format!("The block is without {words}: that is not its material's.")),
        );
        lines.push(
            "Mises stress: mean, median and geometric mean over the block's nodes, as the thesis takes them."
                .to_owned(),
        );
    }
    let last = study.readings.last();
    if let (Some(sphere), Some(reading)) = (&study.sphere_n, last) {
        let of = |i: usize| number(sphere[i] / study.readings[i].force_n);
        let end = sphere.len() - 1;
        let first = &study.readings[0];
        let mut text = format!(
            "Hertz' fingertip (thesis chapter 5: radius 5 mm, 126.2 kPa) bears {} times the finger's force at {} mm",
            of(0),
            number(first.travel_mm)
        );
        if end > 0 {
            text.push_str(&format!(", {} times at {} mm", of(end), number(reading.travel_mm)));
        }
        lines.push(text + ".");
    }
    if let (Some(two), Some(reading)) = (&study.two, last) {
        let end = two.prints.len() - 1;
        let print = &two.prints[end];
        lines.push(format!(
            "Two radii ({} times one another): at {} mm {} and {} mm, {} mm2 of contact; a finger stretched by it{} bears {} times the force.",
            number(two.ratio),
            number(reading.travel_mm),
            number(print.radii_mm[0]),
            number(print.radii_mm[1]),
            number(print.area_mm2),
            if study.pressed.section == Section::Ring { ", all round," } else { "" },
            number(two.stretched[end])
        ));
    }
    if let Some(apart) = &study.apart {
        let most = |k: usize| number(100.0 * apart.iter().map(|part| part[k]).fold(0.0, f64::max));
        let end = apart.last().copied().unwrap_or_default();
        lines.push(format!(
            "Discretisation: elements twice as long change force by at most {} % and area by {} %; at the last travel by {} % and {} %.",
            most(0),
            most(1),
            number(100.0 * end[0]),
            number(100.0 * end[1])
        ));
    }
    lines
}

/// One JSON object: a row a travel.
pub(super) fn summary(study: &Study, files: &[PathBuf]) -> Value {
    let finger = &study.asked.finger;
    let rows = study.readings.iter().enumerate().map(|(i, r)| {
        let mises = r.mises.as_ref().map(|m| {
            json!({"mean_MPa": m.nodes.mean, "median_MPa": m.nodes.median, "geometric_mean_MPa": m.nodes.geometric,
                   "volume_mean_MPa": m.volume_mean_mpa, "bin_MPa": BIN_MPA, "nodes_in_bins": m.bins})
        });
        let two = study.two.as_ref().map(|two| {
            json!({"radii_mm": two.prints[i].radii_mm, "print_mm2": two.prints[i].flat_mm2,
                   "area_mm2": two.prints[i].area_mm2, "force_over_round": two.stretched[i]})
        });
        let error = study.apart.as_ref().map(|apart| json!({"force": apart[i][0], "area": apart[i][1]}));
        let sphere = study.sphere_n.as_ref().map(|sphere| sphere[i]);
        json!({"travel_mm": r.travel_mm, "force_N": r.force_n, "radius_mm": r.radius_mm, "print_mm2": r.print_mm2,
               "area_mm2": r.area_mm2, "cap_mm": r.cap_mm, "depression_mm": r.depression_mm, "peak_MPa": r.peak_mpa,
               "mean_MPa": r.mean_mpa, "mises": mises, "hertz_force_N": sphere,
               "hertz_over_finger": sphere.map(|n| n / r.force_n), "two_radii": two, "error": error})
    });
    let section = if study.pressed.section == Section::Ring { "ring" } else { "plane" };
    let files = crate::cli::file::names(files);
    json!({"title": finger.title, "source": finger.source, "section": section, "on": study.asked.on.name(),
           "friction": study.asked.friction, "speed_mm_s": study.asked.speed_mm_s, "element_mm": finger.finger.edge_mm,
           "travels": rows.collect::<Vec<_>>(), "remarks": remarks(study), "files": files})
}
