//! What is said of a magnet: in the terminal, and as JSON.

use std::path::PathBuf;

use lut_gen::magnet::design::Coil;
use lut_gen::magnet::field::Geometry;
use lut_gen::magnet::study::Study;
use lut_gen::magnet::winding::Fit;
use serde_json::{Value, json};

use crate::magnet::Magnet;
use crate::report::{magnet as picture, number};

pub(super) fn print(magnet: &Magnet, study: &Study) {
    let fine = study.field.unknowns();
    outln!("{}: {} equations", magnet.title, fine);
    if !magnet.source.is_empty() {
        outln!("{}", magnet.source);
    }
    for line in depth_line(magnet).into_iter().chain(winding_lines(magnet, study)) {
        outln!("{line}");
    }
    outln!("");
    let names = picture::names(magnet);
    let width = |name: &str| name.chars().count().max(18);
    let mut head = format!("{:>9}", "current A");
    for (name, _) in &names {
        head.push_str(&format!("  {:>1$}", format!("{name} T"), width(name) + 2));
    }
    if !magnet.design.coils.is_empty() {
        head.push_str(&format!("  {:>18}  {:>13}", "linkage mWb", "inductance mH"));
    }
    outln!("{head}");
    for state in &study.states {
        let mut row = format!("{:>9}", number(state.ampere));
        for (name, look) in &names {
            let flux = look(state);
            row.push_str(&format!("  {:>1$}", give_or_take(flux.size_t(), flux.error_t), width(name) + 2));
        }
        if let Some(linked) = state.linkage_wb.first() {
            let inductance = 1e3 * linked.value / state.ampere;
            row.push_str(&format!("  {:>18}", give_or_take(1e3 * linked.value, 1e3 * linked.error)));
            row.push_str(&format!("  {:>13}", if state.ampere == 0.0 { "-".into() } else { number(inductance) }));
        }
        outln!("{row}");
    }
    if let Some(curve) = magnet.flux_curve(&study.states) {
        outln!("");
        outln!(
            "Control curve: {} T at {} A, read between the points to {} T",
            number(curve.flux_t(curve.most_a())),
            number(curve.most_a()),
            number(curve.bound_t())
        );
    }
}

/// A value with its error, both to the error's second digit.
fn give_or_take(value: f64, error: f64) -> String {
    if !(error > 0.0 && error.is_finite()) {
        return number(value);
    }
    let digits = (1.0 - error.log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{value:.digits$} +- {error:.digits$}")
}

/// What a plane drawing says of the third dimension.
pub(super) fn depth_line(magnet: &Magnet) -> Option<String> {
    let design = &magnet.design;
    if design.geometry == Geometry::Axisymmetric {
        return None;
    }
    Some(match &design.out_of_plane {
        Some(out) => format!(
            "{} mm deep: flux that leaves the plane is allowed for, to 3.5 % in the gap (air of permeability {})",
            number(design.depth_mm),
            number(out.air(design.depth_mm))
        ),
        None => format!(
            "Plane: as if it were infinitely deep. A magnet that is {} mm deep leaks before and behind.",
            number(design.depth_mm)
        ),
    })
}

/// The smaller of a coil's two sides, mm^2: what its wire must fit into.
fn smaller_window_mm2(magnet: &Magnet, study: &Study, coil: usize) -> f64 {
    let windows = magnet.design.window_mm2(coil, &study.areas);
    windows.into_iter().filter(|area| *area > 0.0).fold(f64::INFINITY, f64::min)
}

/// The largest current of a coil, A.
fn largest_a(coil: &Coil, study: &Study) -> f64 {
    study.states.iter().map(|s| (coil.share * s.ampere).abs()).fold(0.0, f64::max)
}

pub(super) fn winding_lines(magnet: &Magnet, study: &Study) -> Vec<String> {
    let mut lines = Vec::new();
    for (i, coil) in magnet.design.coils.iter().enumerate() {
        let w = &coil.winding;
        let window = smaller_window_mm2(magnet, study, i);
        let fit = match w.fits(window) {
            Fit::Layered => "fits in layers",
            Fit::Grooved => "fits only with every layer in the grooves of the one below",
            Fit::No => "does NOT fit",
        };
        lines.push(format!(
            "{}: {} turns of {} mm wire, {} m, {} Ohm at 20 C; fills {} % of its smaller window of {} mm2: {fit}",
            coil.name,
            number(w.turns),
            number(w.wire_mm),
            number(w.length_m()),
            number(w.ohm(20.0)),
            number(100.0 * w.filled(window)),
            number(window),
        ));
        let most = largest_a(coil, study);
        let seconds = w.seconds(most);
        let how_long = if seconds.is_finite() { format!("for {} s", number(seconds)) } else { "for ever".to_owned() };
        lines.push(format!(
            "{}: {} A may flow {how_long} ({} W at first, {} to {} C), and {} A for ever",
            coil.name,
            number(most),
            number(most * most * w.ohm(w.room_c)),
            number(w.room_c),
            number(w.limit_c),
            number(w.lasting_a()),
        ));
    }
    lines
}

/// One JSON object: windings, and a row a current.
pub(super) fn summary(magnet: &Magnet, study: &Study, files: &[PathBuf]) -> Value {
    let names = picture::names(magnet);
    let states = study.states.iter().map(|state| {
        let flux: serde_json::Map<String, Value> = names
            .iter()
            .map(|(name, look)| (*name, look(state)))
            .map(|(name, f)| (name.to_owned(), json!({"B_T": f.size_t(), "components_T": f.b_t, "error_T": f.error_t})))
            .collect();
        let lines: serde_json::Map<String, Value> = magnet
            .lines
            .iter()
            .enumerate()
            .map(|(i, line)| {
                let first = magnet.first_of_line(i);
                let values = (0..line.value.points).map(|k| state.points[first + k].size_t());
                (line.name.clone(), json!(values.collect::<Vec<_>>()))
            })
            .collect();
        let coils = magnet.design.coils.iter().zip(&state.linkage_wb).map(|(coil, linked)| {
            json!({"coil": coil.name, "linkage_Wb": linked.value, "error_Wb": linked.error,
                   "inductance_H": (state.ampere != 0.0).then(|| linked.value / (coil.share * state.ampere))})
        });
        json!({"current_A": state.ampere, "flux": flux, "lines_T": lines, "coils": coils.collect::<Vec<_>>(),
               "energy_J": state.energy_j.value, "coenergy_J": state.coenergy_j.value, "newton_steps": state.steps})
    });
    let coils = magnet.design.coils.iter().enumerate().map(|(i, coil)| {
        let w = &coil.winding;
        let window = smaller_window_mm2(magnet, study, i);
        let fits = match w.fits(window) {
            Fit::Layered => "layered",
            Fit::Grooved => "grooved",
            Fit::No => "no",
        };
        let most = largest_a(coil, study);
        let seconds = w.seconds(most);
        json!({"coil": coil.name, "turns": w.turns, "wire_m": w.length_m(), "resistance_20C_Ohm": w.ohm(20.0),
               "window_mm2": window, "filled": w.filled(window), "fits": fits, "lasting_A": w.lasting_a(),
               "largest_current_A": most, "seconds_at_largest": seconds.is_finite().then_some(seconds)})
    });
    let control = magnet
        .flux_curve(&study.states)
        .map(|c| json!({"most_A": c.most_a(), "most_T": c.flux_t(c.most_a()), "bound_T": c.bound_t()}));
    let files = crate::cli::file::names(files);
    json!({"title": magnet.title, "depth": depth_line(magnet), "source": magnet.source, "unknowns": study.field.unknowns(),
           "coils": coils.collect::<Vec<_>>(), "states": states.collect::<Vec<_>>(), "control": control, "files": files})
}
