//! Ecoflex cylinders between platens: a homogeneous strain, or friction on the platens? Repeats of a piece say what noise is.

use std::path::Path;

use palpate::calibration::lack_of_fit::LackOfFit;
use palpate::experiment::Experiment;
use palpate::identify::spec::{Extra, FitSpec};
use palpate::identify::{Identification, identify};
use palpate::report::figure::{Axis, Figure, Series, Stroke};
use palpate::report::number;
use tests::document::table;

use super::{Outcome, asked, picture, recorded};

/// Repeats that are fitted; all five say what noise is.
const FITTED: usize = 2;
/// Most solves of the barrelling cylinder.
const SOLVES: usize = 60;
/// Stations at which fit and repeats are compared (mm of compression), and half the width of each.
const STATIONS: [f64; 9] = [2.0, 4.0, 6.0, 8.0, 10.0, 12.0, 14.0, 16.0, 18.0];
const HALF_MM: f64 = 0.1;
/// Free parameters of each fit: mu, alpha, D mu; contact points; friction.
const PARAMETERS: usize = 4;

/// Mean force of one repeat at each station, N.
fn stations(depth_mm: &[f64], force_n: &[f64], zero_mm: f64) -> Vec<f64> {
    let near = |x: f64| {
        let inside = depth_mm.iter().zip(force_n).filter(|(d, _)| (*d - zero_mm - x).abs() <= HALF_MM);
        let (sum, count) = inside.fold((0.0, 0.0), |(sum, count), (_, f)| (sum + f, count + 1.0));
        sum / count
    };
    STATIONS.iter().map(|x| near(*x)).collect()
}

/// What a fit of one piece leaves at the stations, against what repeats of the piece differ by.
struct Compared {
    parameters: String,
    rmse: f64,
    left: Vec<f64>,
    test: LackOfFit,
}

fn compared(experiment: &Experiment, specimen: usize, found: &Identification, extra: usize) -> Outcome<Compared> {
    let fit = found.fit.as_ref().ok_or("nothing was fitted")?;
    let run = &fit.runs[0];
    let data = &found.selection.curves[run.curve];
    let model = stations(&data.depth_mm, &run.model_n, run.contact_mm);
    let repeats: Vec<Vec<f64>> = experiment
        .runs
        .iter()
        .filter(|run| run.specimen == Some(specimen))
        .map(|one| stations(&one.recording.depth_mm, &one.recording.force_n, run.contact_mm))
        .collect();
    // forces span two decades: relative to the mean of the repeats
    let (mut points, mut fitted, mut left) = (Vec::new(), Vec::new(), Vec::new());
    for (k, x) in STATIONS.iter().enumerate() {
        let mean = repeats.iter().map(|r| r[k]).sum::<f64>() / repeats.len() as f64;
        points.extend(repeats.iter().map(|r| (*x, r[k] / mean)));
        fitted.extend(repeats.iter().map(|_| model[k] / mean));
        left.push(100.0 * (1.0 - model[k] / mean));
    }
    let test = LackOfFit::of(&points, &fitted, PARAMETERS + extra)?;
    let peak = data.force_n.iter().copied().fold(0.0, f64::max);
    let short = |x: f64| number(format!("{x:.2e}").parse().unwrap_or(x));
    let parameters = fit.parameters.iter().map(|p| format!("{} {}", p.name, short(p.value)));
    Ok(Compared {
        parameters: parameters.filter(|p| !p.starts_with("contact")).collect::<Vec<_>>().join(", "),
        rmse: 100.0 * run.rmse_n / peak,
        left,
        test,
    })
}

/// The section.
pub fn section(figures: &Path) -> Outcome<Option<String>> {
    let Some(mut experiment) = recorded::experiment("ecoflex", "data/ecoflex")? else { return Ok(None) };
    for specimen in &mut experiment.specimens {
        specimen.material.clone_from(&specimen.name);
    }
    let mut few = experiment.clone();
    let mut taken = vec![0; few.specimens.len()];
    few.runs.retain(|run| {
        let Some(count) = run.specimen.and_then(|at| taken.get_mut(at)) else { return false };
        *count += 1;
        *count <= FITTED
    });
    let told = |material: &str, solves: usize, _: usize| eprintln!("{material}: {solves} solves");
    let smooth = identify(&few, &FitSpec::default(), &told)?;
    let rubbing = FitSpec { free: vec![Extra::PlatenFriction], most_solves: SOLVES, ..FitSpec::default() };
    let rubbing = identify(&few, &rubbing, &told)?;
    let (mut rows, mut parts) = (Vec::new(), Vec::new());
    for (specimen, (one, other)) in smooth.iter().zip(&rubbing).enumerate() {
        let mut figure = Figure::new(
            &format!("{}: mean of five repeats less fit", one.material),
            Axis::new("compression (mm)"),
            Axis::new("of the force (%)"),
        );
        figure.size.1 = 240.0;
        for (at, (name, found)) in [("homogeneous", one), ("friction", other)].iter().enumerate() {
            let one = compared(&experiment, specimen, found, at)?;
            rows.push(vec![
                found.material.clone(),
                (*name).to_owned(),
                one.parameters,
                format!("{:.1}", one.rmse),
                format!("{:.2}", 100.0 * one.test.repeats),
                format!(
                    "F({:.0}, {:.0}) = {:.1}, p = {:.0e}",
                    one.test.freedom.0, one.test.freedom.1, one.test.f, one.test.probability
                ),
            ]);
            let points = STATIONS.iter().copied().zip(one.left).collect();
            figure = figure.with(Series::new(name, points, Stroke::LINES[at], at + 1));
        }
        parts.push(figure);
    }
    let mut out = table(
        &[
            "piece",
            "strain",
            "found",
            "leaves (rms, % of peak)",
            "repeats differ by (%)",
            "misses more than repeats differ?",
        ],
        &rows,
    );
    out += "\n";
    if let Some(whole) = recorded::experiment("ecoflex", "data/ecoflex")? {
        for found in palpate::diagnose::compression::diagnose(&whole) {
            out += &format!("**{}**, all pieces and presses (`tests/experiments/ecoflex`):\n\n", found.material);
            out += &asked::of_compression(&found);
            out += "\n";
        }
    }
    out += &picture(figures, "real-diagnosis-ecoflex.svg", "Ecoflex, what both fits leave", &parts)?;
    Ok(Some(out))
}
