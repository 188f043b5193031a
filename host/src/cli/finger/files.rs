//! The folder of a finger's press: page, pictures, readings, states.

use std::path::{Path, PathBuf};

use miette::{IntoDiagnostic, miette};

use super::computed::{DEFAULT_FOLDER, Study};
use super::told::remarks;
use crate::finger::opposite::Opposite;
use crate::finger::vtu::vtu;
use crate::ownership::OwnFolder;
use crate::report::{Page, finger as picture, number};

/// Writes the page first, then its pictures, the readings and the last state, or all.
pub(super) fn write(folder: &Path, all: bool, study: &Study) -> miette::Result<Vec<PathBuf>> {
    let mut folder = OwnFolder::open(folder, "--out", Some(DEFAULT_FOLDER)).into_diagnostic()?;
    let mut files = Vec::new();
    let mut save = |name: &str, text: &str| -> miette::Result<()> {
        files.push(folder.write(name, text.as_bytes()).into_diagnostic()?);
        Ok(())
    };
    let pictures = pictures(study)?;
    let finger = &study.asked.finger;
    let mut page = Page::new(&format!("{} on {}", finger.title, study.asked.on.name()), &finger.source);
    page.paragraph("Simulated by finite elements; nothing here was measured.");
    for line in remarks(study) {
        page.paragraph(&line);
    }
    for (_, svg, caption) in &pictures {
        page.figure(svg, caption);
    }
    save("finger.html", &page.html())?;
    for (name, svg, _) in &pictures {
        save(name, svg)?;
    }
    save("readings.csv", &readings(study))?;
    let states = &study.pressed.states;
    let first = if all { 0 } else { states.len() - 1 };
    for (i, state) in states.iter().enumerate().skip(first) {
        save(&format!("state_{i:03}.vtu"), &vtu(&study.pressed, state))?;
    }
    Ok(files)
}

/// Name of its file, `<svg>` and caption of every picture.
fn pictures(study: &Study) -> miette::Result<Vec<(&'static str, String, String)>> {
    let (pressed, readings) = (&study.pressed, &study.readings);
    let state = pressed.states.last().ok_or_else(|| miette!("no travel was asked for; expected at least one"))?;
    let on_block = matches!(study.asked.on, Opposite::Block(_));
    let prints = study.two.as_ref().map(|two| two.prints.as_slice());
    let title = format!("Mises stress at {} mm of travel, simulated", number(state.travel_mm));
    let [pressure, force_along] = picture::along(pressed);
    let of = |name, svg: String, caption: &str| (name, svg, caption.to_owned());
    let mut all = vec![
        of("map.svg", picture::map(&title, pressed, state), &picture::caption(state, on_block)),
        of(
            "force.svg",
            picture::force(pressed.section, readings, study.sphere_n.as_deref()).svg(),
            "The sphere is that of the thesis' chapter 5, on the same body (Eqs. 50 to 52).",
        ),
        of("area.svg", picture::area(pressed.section, readings, prints).svg(), "Print: the contact seen from above."),
        of(
            "area_force.svg",
            picture::area_over_force(pressed.section, readings, prints).svg(),
            "As Figs. 38 and 48 of the thesis, without its measurements, which are not printed as numbers.",
        ),
        of("pressure.svg", pressure.svg(), "At some of the travels, averaged over two elements (Fig. 46)."),
        of(
            "force_along.svg",
            force_along.svg(),
            "Figs. 46 and 47 show the force of nodes, which grows with their distance; here it is that of a millimetre.",
        ),
    ];
    if on_block {
        all.push(of(
            "depth.svg",
            picture::depth(readings).svg(),
            "The cap ends where the contact does (Figs. 41 and 42).",
        ));
        all.push(of("sphere.svg", picture::sphere(readings).svg(), "Area over 2 pi times the cap's height (Fig. 44)."));
        let caption = "Nodes are dense below the finger: another mesh has another histogram (Fig. 56).";
        all.push(of("histogram.svg", picture::histogram(readings).svg(), caption));
        let caption =
            "Of nodes as in the thesis, which depend on the mesh, and over the volume, which does not (Fig. 57).";
        all.push(of("mises.svg", picture::averages(readings).svg(), caption));
    }
    Ok(all)
}

/// A row a travel; stresses in MPa.
fn readings(study: &Study) -> String {
    let mut csv = "travel_mm,force_N,radius_mm,print_mm2,area_mm2,cap_mm,depression_mm,peak_MPa,mean_MPa".to_owned();
    let on_block = matches!(study.asked.on, Opposite::Block(_));
    if on_block {
        csv.push_str(",mises_mean_MPa,mises_median_MPa,mises_geometric_MPa,mises_volume_mean_MPa");
    }
    if study.two.is_some() {
        csv.push_str(",two_radii_print_mm2,two_radii_area_mm2,stretched_force_N");
    }
    if study.apart.is_some() {
        csv.push_str(",force_error,area_error");
    }
    csv.push('\n');
    for (i, r) in study.readings.iter().enumerate() {
        let mut row = vec![
            r.travel_mm,
            r.force_n,
            r.radius_mm,
            r.print_mm2,
            r.area_mm2,
            r.cap_mm,
            r.depression_mm,
            r.peak_mpa,
            r.mean_mpa,
        ];
        if let Some(m) = &r.mises {
            row.extend([m.nodes.mean, m.nodes.median, m.nodes.geometric, m.volume_mean_mpa]);
        }
        if let Some(two) = &study.two {
            row.extend([two.prints[i].flat_mm2, two.prints[i].area_mm2, two.stretched[i] * r.force_n]);
        }
        if let Some(apart) = &study.apart {
            row.extend(apart[i]);
        }
        csv.push_str(&row.iter().map(f64::to_string).collect::<Vec<_>>().join(","));
        csv.push('\n');
    }
    csv
}
