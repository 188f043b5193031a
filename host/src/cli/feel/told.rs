//! What is told of presses on the display.

use std::path::PathBuf;

use serde_json::{Value, json};

use super::plant::Plant;
use crate::cli::answer::columns;
use crate::feel::{Display, Felt, LEAST_N, Pressed};
use crate::report::number;

/// Columns of the table.
pub(super) const HEAD: [&str; 6] = ["display", "material", "press", "measure", "thesis", "measured"];

/// What the numbers are.
const NOTES: [&str; 5] = [
    "Simulated: a hand on the simulated board. All errors are of the loading, from 0.2 N on: below, the thesis' FSR reads nothing.",
    "Position: mean distance of the true shaft from where the material wants it at the true force, over the largest such place.",
    "Force: mean distance of the true force from what the material wants at the true shaft, over the largest force.",
    "Tracking: largest distance between the wanted and the read shaft, over the largest wanted place.",
    "Agreement: mean of the smaller over the larger of both forces at the same travel, where the table marks it reachable.",
];

/// The same of a real board, in place of the first three.
pub(super) const READ: [&str; 3] = [
    "Your own finger on a board. All figures are of its readings in loading, from 0.2 N on: what its sensors get wrong is not in them.",
    "Position: mean distance of the read shaft from where the material wants it at the read force, over the largest such place.",
    "Force: mean distance of the read force from what the material wants at the read shaft, over the largest force.",
];

/// What the numbers are.
pub(super) fn notes(all: &[Felt]) -> [&'static str; 5] {
    let mut notes = NOTES;
    if all.iter().any(|felt| felt.is_read) {
        notes[..READ.len()].copy_from_slice(&READ);
    }
    notes
}

pub(super) fn name(display: Display) -> &'static str {
    match display {
        Display::Actuator => "linear actuator",
        Display::Fluid => "fluid in the magnet",
        Display::FluidAtPlace => "fluid, by place",
    }
}

pub(super) fn word(display: Display) -> &'static str {
    match display {
        Display::Actuator => "actuator",
        Display::Fluid => "fluid",
        Display::FluidAtPlace => "fluid-at-place",
    }
}

pub(super) fn subtitle(plant: &Plant, magnet: &str) -> String {
    format!("Plant {plant}, magnet {magnet}. Simulated.")
}

fn percent(part: f64) -> String {
    format!("{:.1} %", 100.0 * part)
}

/// Name of a measure, the thesis' figure for it, and ours.
fn measures(felt: &Felt, press: &Pressed) -> Vec<(&'static str, &'static str, String)> {
    let nothing = || vec![("nothing scored", "", format!("no reachable force above {LEAST_N} N"))];
    match felt.display {
        Display::Actuator => felt.actuator(press).map_or_else(nothing, |score| {
            let mut rows = vec![
                ("position", "16 % (A2)", percent(score.position)),
                ("force", "8.7 % (A2)", percent(score.force)),
                ("tracking", "16.6 %", percent(score.tracking)),
            ];
            // nothing on a board reads the bone beside the cap
            rows.extend((!felt.is_read).then(|| ("bone's travel", "", percent(score.travel))));
            rows.extend(score.position_below.map(|part| ("position below 0.2 N", "", percent(part))));
            rows
        }),
        Display::Fluid | Display::FluidAtPlace => felt.fluid(press).map_or_else(nothing, |score| {
            vec![
                ("agreement of the force", "84 %", percent(score.agreement)),
                ("reachable part of the curve", "", percent(score.reachable)),
            ]
        }),
    }
}

/// All measures of all presses.
pub(super) fn rows(all: &[Felt]) -> Vec<Vec<String>> {
    let mut rows = Vec::new();
    for felt in all {
        for press in &felt.presses {
            for (measure, thesis, own) in measures(felt, press) {
                let own = [name(felt.display), &felt.curve.material, press.pace.name(), measure, thesis, &own]
                    .map(str::to_owned);
                rows.push(own.to_vec());
            }
        }
    }
    rows
}

/// Columns of what curves that are made anew gain.
pub(super) const GAIN: [&str; 6] = ["display", "material", "press", "agreement before", "made anew", "gain"];

/// The agreement of the same presses with the curves of the drawing, and with those of the model.
pub(super) fn gains(before: &[Felt], after: &[Felt]) -> Vec<Vec<String>> {
    let mut rows = Vec::new();
    for (one, other) in before.iter().zip(after) {
        for (old, new) in one.presses.iter().zip(&other.presses) {
            let [was, is] = [one.fluid(old), other.fluid(new)].map(|score| score.map(|score| score.agreement));
            let gain = was.zip(is).map(|(was, is)| format!("{:+.1} points", 100.0 * (is - was)));
            let told = |part: Option<f64>| part.map_or("nothing scored".to_owned(), percent);
            let words = [name(one.display), &one.curve.material, old.pace.name()].map(str::to_owned);
            rows.push(words.into_iter().chain([told(was), told(is), gain.unwrap_or_default()]).collect());
        }
    }
    rows
}

pub(super) fn print_gain(before: &[Felt], after: &[Felt]) {
    if !before.is_empty() {
        outln!("");
        columns(&GAIN, &gains(before, after));
    }
}

pub(super) fn print(all: &[Felt]) {
    columns(&HEAD, &rows(all));
    outln!("");
    notes(all).iter().for_each(|note| outln!("{note}"));
}

/// A row a tick.
pub(super) fn csv(felt: &Felt) -> String {
    if felt.is_read {
        return readings(felt);
    }
    let mut csv = "press,time_s,true_force_N,true_bone_mm,true_shaft_mm,true_yield_kPa,read_force_N,read_shaft_mm,\
                   wanted_shaft_mm,wanted_current_A,unreachable\n"
        .to_owned();
    for press in &felt.presses {
        for s in &press.samples {
            let row =
                [s.time_s, s.force_n, s.bone_mm, s.shaft_mm, s.yield_kpa, s.read_n, s.read_mm, s.target_mm, s.wanted_a];
            let cells = row.map(|value| format!("{value:.6}")).join(",");
            csv.push_str(&format!("{},{cells},{}\n", press.pace.name(), u8::from(s.unreachable)));
        }
    }
    csv
}

/// The same of a real board, where nothing is known but readings.
fn readings(felt: &Felt) -> String {
    let mut csv = "press,time_s,force_N,shaft_mm,wanted_shaft_mm,wanted_current_A,unreachable\n".to_owned();
    for press in &felt.presses {
        for s in &press.samples {
            let cells = [s.time_s, s.read_n, s.read_mm, s.target_mm, s.wanted_a].map(|value| format!("{value:.6}"));
            csv.push_str(&format!("{},{},{}\n", press.pace.name(), cells.join(","), u8::from(s.unreachable)));
        }
    }
    csv
}

pub(super) fn summary(plant: &Plant, magnet: &str, (all, before): (&[Felt], &[Felt]), files: &[PathBuf]) -> Value {
    let press = |felt: &Felt, press: &Pressed| {
        let actuator = felt.actuator(press).filter(|_| felt.display == Display::Actuator).map(|s| {
            json!({"position": s.position, "force": s.force, "tracking": s.tracking,
                   "travel": (!felt.is_read).then_some(s.travel),
                   "position_below": s.position_below, "scored": s.scored})
        });
        let fluid = felt
            .fluid(press)
            .filter(|_| felt.display.is_fluid())
            .map(|s| json!({"agreement": s.agreement, "reachable": s.reachable, "scored": s.scored}));
        json!({"pace": press.pace.name(), "actuator": actuator, "fluid": fluid})
    };
    let felt = |felt: &Felt| {
        json!({"material": felt.curve.material, "display": word(felt.display),
               "presses": felt.presses.iter().map(|p| press(felt, p)).collect::<Vec<_>>()})
    };
    let files = crate::cli::file::names(files);
    let is_read = all.iter().any(|felt| felt.is_read);
    json!({"plant": (!is_read).then(|| plant.to_string()), "magnet": (!is_read).then_some(magnet), "of_readings": is_read, "least_N": number(LEAST_N), "felt": all.iter().map(felt).collect::<Vec<_>>(),
           "before": before.iter().map(felt).collect::<Vec<_>>(),
           "files": files})
}
