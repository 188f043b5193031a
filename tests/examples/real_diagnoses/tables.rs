//! Two tables of the thesis: flux density over current (Table 6) and conductance over force (Table 7).

use std::path::Path;

use palpate::calibration::lack_of_fit::LackOfFit;
use palpate::calibration::polynomial::Polynomial;
use palpate::diagnose::table::passes;
use palpate::report::figure::{Axis, Figure, Series, Stroke};
use palpate::report::number;
use tests::document::table;

use super::{Outcome, asked, picture, recorded};

/// A value and its interval, to what it deserves.
fn told(value: f64, (low, high): (f64, f64)) -> String {
    let short = |x: f64| number(format!("{x:.2e}").parse().unwrap_or(x));
    format!("{} ({} to {})", short(value), short(low), short(high))
}

/// What the test of lack of fit says, or why it cannot be made.
fn adequacy(points: &[(f64, f64)], fit: &Polynomial) -> String {
    match LackOfFit::of(points, &fit.fitted, fit.coefficients.len()) {
        Ok(test) => format!("F = {:.2} (p = {:.2e})", test.f, test.probability),
        Err(cause) => format!("refused: {cause}"),
    }
}

fn cell(text: &str) -> String {
    text.to_owned()
}

/// What `palpate diagnose` says of one of them.
fn asked(folder: &str) -> Outcome<String> {
    let Some(experiment) = recorded::experiment(folder, "thesis/tables")? else { return Ok(String::new()) };
    let found = palpate::diagnose::table::diagnose(&experiment)?;
    Ok(found.map_or_else(String::new, |found| format!("{}\n", asked::of_table(&found))))
}

/// Table 6.
pub fn flux_density(figures: &Path) -> Outcome<Option<String>> {
    let Some(file) = tests::shared_or_skipped("thesis/tables/table6_B_vs_current.csv") else { return Ok(None) };
    let rows = recorded::rows(&file, 3)?;
    let column = |k: usize| -> Vec<(f64, f64)> { rows.iter().map(|row| (row[0], row[k])).collect() };
    let (measured, simulated) = (column(1), column(2));
    let left: Vec<(f64, f64)> = rows.iter().map(|row| (row[0], row[1] - row[2])).collect();
    let (of_measured, of_simulated) = (Polynomial::fit(&measured, 1)?, Polynomial::fit(&simulated, 1)?);
    let line = Polynomial::fit(&left, 1)?;
    let mean = Polynomial::fit(&left, 0)?;
    let slope = line.coefficients[1];
    let mut out = table(
        &["asked", "answer"],
        &[
            vec![cell("is the simulation wrong, against the scatter of repeats?"), adequacy(&left, &mean)],
            vec![
                cell("slope, measured and simulated (G/A)"),
                format!("{:.0} and {:.0}", of_measured.coefficients[1].0, of_simulated.coefficients[1].0),
            ],
            vec![
                cell("difference of the slopes (G/A)"),
                format!(
                    "{:.1} +/- {:.1}, 95 %: {:.0} to {:.0}",
                    slope.0,
                    slope.1,
                    line.interval95(1).0,
                    line.interval95(1).1
                ),
            ],
            vec![cell("probability of so large a difference by chance"), format!("{:.2}", line.probability(1, 0.0))],
            vec![cell("mean difference (G)"), told(mean.coefficients[0].0, mean.interval95(0))],
            vec![cell("scatter about the difference line (G)"), format!("{:.0}", line.deviation)],
            vec![
                cell("passes over these five currents that show a difference of this size in nine cases of ten"),
                format!("{}", passes(&line, 1, left.len())),
            ],
        ],
    );
    let over = |fit: &Polynomial| -> Vec<(f64, f64)> { [1.4, 2.6].iter().map(|x| (*x, fit.at(*x))).collect() };
    let figure =
        Figure::new("Flux density, measured less simulated", Axis::new("current (A)"), Axis::new("difference (G)"))
            .with(Series::new("zero", vec![(1.4, 0.0), (2.6, 0.0)], Stroke::Faint, 5))
            .with(Series::new("line", over(&line), Stroke::Dashed, 1))
            .with(Series::new("", left, Stroke::Dots, 0));
    out += "\n";
    out += &asked("flux_density")?;
    out += &picture(figures, "real-diagnosis-flux.svg", "Difference over current", &[figure])?;
    Ok(Some(out))
}

/// Table 7.
pub fn force_sensor(figures: &Path) -> Outcome<Option<String>> {
    let Some(file) = tests::shared_or_skipped("thesis/tables/table7_fsr_conductance.csv") else { return Ok(None) };
    // in 100 gf and mS, the units of ERRATA row Eq. 43
    let points: Vec<(f64, f64)> = recorded::rows(&file, 2)?.iter().map(|row| (row[0] / 100.0, row[1])).collect();
    let (line, parabola) = (Polynomial::fit(&points, 1)?, Polynomial::fit(&points, 2)?);
    let (worst, chance) = line.outlier().ok_or("no residual")?;
    let off = line.studentised()[worst];
    let mut out = table(
        &["asked", "answer"],
        &[
            vec![cell("does a line describe it, against the scatter of repeats?"), adequacy(&points, &line)],
            vec![cell("slope (mS per 100 gf)"), told(line.coefficients[1].0, line.interval95(1))],
            vec![cell("offset (mS)"), told(line.coefficients[0].0, line.interval95(0))],
            vec![cell("scatter (mS)"), format!("{:.4}", line.deviation)],
            vec![
                cell("curvature (mS per (100 gf)^2)"),
                format!(
                    "{}, p = {:.2}",
                    told(parabola.coefficients[2].0, parabola.interval95(2)),
                    parabola.probability(2, 0.0)
                ),
            ],
            vec![
                cell("the point farthest off"),
                format!(
                    "{:.0} gf, {:.1} standard deviations of the others (plainly: {:.1} of the fit's own); the farthest of nine lies so far by chance with p = {:.2}",
                    100.0 * points[worst].0,
                    off,
                    line.residuals[worst] / line.deviation,
                    chance
                ),
            ],
        ],
    );
    let ends: Vec<(f64, f64)> = [0.5, 9.5].iter().map(|x| (*x, line.at(*x))).collect();
    let upper =
        Figure::new("Conductance of the force sensor", Axis::new("force (100 gf)"), Axis::new("conductance (mS)"))
            .with(Series::new("line", ends, Stroke::Solid, 1))
            .with(Series::new("", points.clone(), Stroke::Dots, 0));
    let left: Vec<(f64, f64)> = points.iter().zip(&line.residuals).map(|(p, e)| (p.0, *e)).collect();
    let sigma = |sign: f64| vec![(0.5, 2.0 * sign * line.deviation), (9.5, 2.0 * sign * line.deviation)];
    let mut lower = Figure::new("Measured less line", Axis::new("force (100 gf)"), Axis::new("difference (mS)"))
        .with(Series::new("2 sd", sigma(1.0), Stroke::Dotted, 5))
        .with(Series::new("", sigma(-1.0), Stroke::Dotted, 5))
        .with(Series::new("", left, Stroke::Dots, 0));
    lower.size.1 = 240.0;
    out += "\n";
    out += &asked("force_sensor")?;
    out += &picture(
        figures,
        "real-diagnosis-fsr.svg",
        "Conductance over force, and what the line leaves",
        &[upper, lower],
    )?;
    Ok(Some(out))
}
