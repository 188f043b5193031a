//! The folder of a magnet: page, pictures, readings, maps.

use std::path::{Path, PathBuf};

use lut_gen::magnet::study::Study;
use miette::{IntoDiagnostic, miette};

use super::DEFAULT_FOLDER;
use super::told::{depth_line, winding_lines};
use crate::magnet::Magnet;
use crate::ownership::OwnFolder;
use crate::report::{Page, magnet as picture, number};

/// Writes the page first, then its pictures, the readings and the map of the last current, or of all.
pub(super) fn write(folder: &Path, all_maps: bool, magnet: &Magnet, study: &Study) -> miette::Result<Vec<PathBuf>> {
    let mut folder = OwnFolder::open(folder, "--out", Some(DEFAULT_FOLDER)).into_diagnostic()?;
    let mut files = Vec::new();
    let mut save = |name: &str, text: &str| -> miette::Result<()> {
        files.push(folder.write(name, text.as_bytes()).into_diagnostic()?);
        Ok(())
    };
    let (Some(state), Some(solution)) = (study.states.last(), study.solutions.last()) else {
        return Err(miette!("no current was asked for; expected at least one"));
    };
    let map = study.field.map(solution);
    let title = format!("Flux density at {} A, computed", number(state.ampere));
    let drawn = picture::map(&title, &magnet.design, &map);
    let along = (!magnet.lines.is_empty()).then(|| picture::along(magnet, state).svg());
    let over = (study.states.len() > 1).then(|| picture::over_current(magnet, &study.states).svg());
    let mut page = Page::new(&magnet.title, &magnet.source);
    page.figure(&drawn, "Bands of |B|, and lines of flux: between two of them flows the same flux.");
    for line in depth_line(magnet).into_iter().chain(winding_lines(magnet, study)) {
        page.paragraph(&line);
    }
    if let Some(svg) = &along {
        page.figure(svg, "Recovered flux density, by finite elements of the file's magnet.");
    }
    if let Some(svg) = &over {
        page.figure(svg, "Errors of discretisation, from two meshes, are smaller than the lines are wide.");
    }
    save("magnet.html", &page.html())?;
    save("map.svg", &drawn)?;
    if let Some(svg) = along {
        save("lines.svg", &svg)?;
    }
    if let Some(svg) = over {
        save("current.svg", &svg)?;
    }
    save("readings.csv", &readings(magnet, study))?;
    let last = study.states.len() - 1;
    let before = if all_maps { last } else { 0 };
    for (i, (state, solution)) in study.states.iter().zip(&study.solutions).take(before).enumerate() {
        save(&format!("map_{i:03}.vtu"), &study.field.map(solution).vtu(state.ampere))?;
    }
    save(&format!("map_{last:03}.vtu"), &map.vtu(state.ampere))?;
    Ok(files)
}

/// Points and probes, linkage and energy over current.
fn readings(magnet: &Magnet, study: &Study) -> String {
    let names = picture::names(magnet);
    let mut csv = "current_A".to_owned();
    for (name, _) in &names {
        let name = name.replace([',', '"', '\n'], " ");
        csv.push_str(&format!(",{name} B_T,{name} error_T"));
    }
    for coil in &magnet.design.coils {
        csv.push_str(&format!(",{0} linkage_Wb,{0} error_Wb", coil.name.replace(',', " ")));
    }
    csv.push_str(",energy_J,coenergy_J\n");
    for state in &study.states {
        csv.push_str(&state.ampere.to_string());
        for (_, look) in &names {
            let flux = look(state);
            csv.push_str(&format!(",{},{}", flux.size_t(), flux.error_t));
        }
        for linked in &state.linkage_wb {
            csv.push_str(&format!(",{},{}", linked.value, linked.error));
        }
        csv.push_str(&format!(",{},{}\n", state.energy_j.value, state.coenergy_j.value));
    }
    csv
}
