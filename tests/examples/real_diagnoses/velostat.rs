//! Two sensors of Velostat: held under a constant press, pressed again and again, and two streams on two clocks.

use std::fmt::Write as _;
use std::path::Path;

use palpate::calibration::hysteresis::{Hysteresis, Mean, Press, presses};
use palpate::calibration::lack_of_fit::LackOfFit;
use palpate::calibration::polynomial::Polynomial;
use palpate::report::figure::{Axis, Figure, Series, Stroke};
use tests::document::table;

use super::{Outcome, asked, picture, recorded};

/// Files and what they say of the time held, s.
const HOLDS: [(&str, f64); 4] =
    [("hold_10.txt", 10.0), ("hold_30.txt", 30.0), ("hold_60.txt", 60.0), ("hold_90.txt", 90.0)];
/// Readings below this are pressed, above this released: the sensor reads about 1000 and 200.
const PRESSED: (f64, f64) = (400.0, 600.0);
/// Left out at both ends of a hold, s: the robot still moves.
const SETTLES_S: f64 = 0.5;
/// Reading that counts as the load, as after a second.
const UNIT_OHM: f64 = 208.0;
/// Time at which a conductance counts as 1, s.
const UNIT_S: f64 = 1.0;

/// Conductance over that after a second, against the time held; and the reading before, just after and long after the press.
struct Hold {
    samples: Vec<(f64, f64)>,
    before: f64,
    after: f64,
    late: f64,
}

/// Median.
fn middle(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

fn hold(file: &Path) -> Outcome<Hold> {
    let rows = recorded::rows(file, 2)?;
    let start = rows.iter().position(|row| row[0] < PRESSED.0).ok_or("never pressed")?;
    let end = start + rows[start..].iter().position(|row| row[0] > PRESSED.1).unwrap_or(rows.len() - start);
    let (from_s, to_s) = (rows[start][1], rows[end - 1][1]);
    let at = |low: f64, high: f64| -> Vec<f64> {
        rows.iter().filter(|row| row[1] > low && row[1] < high).map(|row| row[0]).collect()
    };
    let unit = middle(&mut at(from_s + 0.8 * UNIT_S, from_s + 1.2 * UNIT_S));
    let held = rows[start..end].iter().map(|row| (row[1] - from_s, unit / row[0]));
    let last_s = rows.last().map_or(to_s, |row| row[1]);
    Ok(Hold {
        samples: held.filter(|(t, _)| *t > SETTLES_S && *t < to_s - from_s - SETTLES_S).collect(),
        before: middle(&mut at(from_s - 30.0, from_s - SETTLES_S)),
        after: middle(&mut at(to_s + 1.0, to_s + 3.0)),
        late: middle(&mut at(last_s - 3.0, last_s)),
    })
}

/// Name, column over time and shape, whether it has a shape.
type Law = (&'static str, fn(f64, f64) -> f64, bool);

/// Laws of creep after a step, in the time held: their columns besides a constant.
const LAWS: [Law; 3] = [
    ("logarithm of time", |t, _| (t / UNIT_S).log10(), false),
    ("one exponential", |t, tau| 1.0 - (-(t - UNIT_S) / tau).exp(), true),
    ("power of time", |t, tau| (t / UNIT_S).powf(1.0 / tau), true),
];

/// Fits the part before a time and predicts the rest: slope of the law's column, shape, rms of both parts in percent.
fn law(
    samples: &[(f64, f64)],
    column: fn(f64, f64) -> f64,
    shaped: bool,
    until_s: f64,
) -> Outcome<(f64, f64, f64, f64)> {
    let shapes: Vec<f64> = if shaped { (0..60).map(|k| 0.3 * 1.12_f64.powi(k)).collect() } else { vec![1.0] };
    let early: Vec<(f64, f64)> = samples.iter().filter(|(t, _)| *t < until_s).copied().collect();
    let mut best: Option<(f64, f64, Polynomial)> = None;
    for shape in shapes {
        let points: Vec<(f64, f64)> = early.iter().map(|(t, g)| (column(*t, shape), *g)).collect();
        let line = Polynomial::fit(&points, 1)?;
        if best.as_ref().is_none_or(|b| line.deviation < b.0) {
            best = Some((line.deviation, shape, line));
        }
    }
    let (deviation, shape, line) = best.ok_or("no fit")?;
    let late: Vec<f64> =
        samples.iter().filter(|(t, _)| *t >= until_s).map(|(t, g)| (line.at(column(*t, shape)) - g).powi(2)).collect();
    let missed = (late.iter().sum::<f64>() / late.len().max(1) as f64).sqrt();
    Ok((line.coefficients[1].0, shape, 100.0 * deviation, 100.0 * missed))
}

fn holds(folder: &Path, parts: &mut Vec<Figure>) -> Outcome<String> {
    let mut figure = Figure::new(
        "Conductance under a constant press",
        Axis::new("time held (s)").logarithmic(),
        Axis::new("over that after 1 s"),
    );
    let (mut rows, mut slopes) = (Vec::new(), Vec::new());
    for (at, (name, told_s)) in HOLDS.iter().enumerate() {
        let one = hold(&folder.join(name))?;
        let until_s = told_s / 3.0;
        let mut row = vec![format!("{told_s} s")];
        for (k, (_, column, shaped)) in LAWS.iter().enumerate() {
            let (slope, _, fitted, missed) = law(&one.samples, *column, *shaped, until_s)?;
            if k == 0 {
                slopes.push(law(&one.samples, *column, *shaped, f64::INFINITY)?.0);
                row.push(format!("{:+.1} %", 100.0 * slopes[at]));
            }
            row.push(format!("{fitted:.1} / {missed:.1} ({:+.2})", slope));
        }
        row.push(format!("{:.0}, {:.0}, {:.0}", one.before, one.after, one.late));
        rows.push(row);
        let drawn: Vec<(f64, f64)> = one.samples.chunks(60).map(|c| c[c.len() / 2]).collect();
        figure = figure.with(Series::new(&format!("{told_s} s"), drawn, Stroke::LINES[at], at));
    }
    parts.push(figure);
    let mean = slopes.iter().sum::<f64>() / slopes.len() as f64;
    let spread = (slopes.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / (slopes.len() - 1) as f64).sqrt();
    Ok(format!(
        "{}\nPer decade of time: {:+.1} % (standard deviation over the four holds {:.1} %).\n",
        table(
            &[
                "hold",
                "rises per decade of time",
                "logarithm: fitted third / predicted rest, rms in % (slope)",
                "exponential",
                "power",
                "reading before, 2 s after, at the end",
            ],
            &rows
        ),
        100.0 * mean,
        100.0 * spread
    ))
}

/// Press cycles: cover and file.
const COVERS: [(&str, &str); 3] = [
    ("bare", "10k-nosil-cylindertip.1614926403.33.txt"),
    ("thin silicone", "10k-thinsil-cylindertip.1614926690.65.txt"),
    ("thick silicone", "10k-thicksil-cylindertip.1614927083.14.txt"),
];
/// From load-cell reading to N: two points of the authors' calibration file (160 g), as SOURCE.md has it.
const ZERO: f64 = 1_660_130.0;
const N_PER_COUNT: f64 = 0.160 * 9.81 / (1_667_333.0 - ZERO);
/// Sum of five readings of ten bits, and the divider's resistor (kOhm).
const FULL: f64 = 5.0 * 1023.0;
const RESISTOR_KOHM: f64 = 10.0;
/// Forces at which branches are compared, N: below the converter's end.
const STATIONS: [f64; 5] = [0.5, 0.75, 1.0, 1.25, 1.5];
const HALF: f64 = 0.15;

/// Conductance (mS) at the stations, one point a press and station, on the way up.
fn rising(presses: &[Press]) -> Vec<(f64, f64)> {
    let mut points = Vec::new();
    for press in presses {
        for x in STATIONS {
            let near: Vec<f64> = press.rising.iter().filter(|p| (p.0 - x).abs() <= HALF).map(|p| p.1).collect();
            if !near.is_empty() {
                points.push((x, near.iter().sum::<f64>() / near.len() as f64));
            }
        }
    }
    points
}

fn lack(points: &[(f64, f64)], degree: usize) -> Outcome<String> {
    let fit = Polynomial::fit(points, degree)?;
    let test = LackOfFit::of(points, &fit.fitted, degree + 1)?;
    Ok(format!("F({:.0}, {:.0}) = {:.2}, p = {:.1e}", test.freedom.0, test.freedom.1, test.f, test.probability))
}

fn covers(folder: &Path, parts: &mut Vec<Figure>) -> Outcome<String> {
    let mut rows = Vec::new();
    let mut figure = Figure::new(
        "Conductance over force: way in (lines), way back (dots)",
        Axis::new("force (N)"),
        Axis::new("conductance (mS)"),
    );
    for (at, (cover, file)) in COVERS.iter().enumerate() {
        // divider with the sensor to ground: reading / full = R / (R + resistor)
        let samples: Vec<(f64, f64)> = recorded::rows(&folder.join(file), 2)?
            .iter()
            .map(|row| (N_PER_COUNT * (row[0] - ZERO), (FULL / row[1].max(1.0) - 1.0).max(0.0) / RESISTOR_KOHM))
            .collect();
        let all = presses(&samples, 0.2, 2.5);
        let found = Hysteresis::of(&all, &STATIONS, HALF)?;
        let level = found.levels.iter().map(|l| l.0).sum::<f64>() / found.levels.len() as f64;
        let told = |m: Mean| {
            let percent = |x: f64| format!("{:+.1}", 100.0 * x / level);
            format!(
                "{} ({} to {}), p = {:.0e}",
                percent(m.value),
                percent(m.interval95.0),
                percent(m.interval95.1),
                m.probability
            )
        };
        let points = rising(&all);
        rows.push(vec![
            (*cover).to_owned(),
            format!("{}", found.presses),
            told(found.gap),
            told(found.trend),
            lack(&points, 1)?,
            lack(&points, 2)?,
        ]);
        let up: Vec<(f64, f64)> = STATIONS.iter().zip(&found.levels).map(|(x, l)| (*x, l.0)).collect();
        let back: Vec<(f64, f64)> = STATIONS.iter().zip(&found.levels).map(|(x, l)| (*x, l.1)).collect();
        figure =
            figure.with(Series::new(cover, up, Stroke::LINES[at], at)).with(Series::new("", back, Stroke::Dots, at));
    }
    parts.push(figure);
    Ok(table(
        &[
            "cover",
            "presses",
            "way back less way in, % of the mean (95 %)",
            "change from press to press, %",
            "line over 0.5 to 1.5 N",
            "parabola",
        ],
        &rows,
    ))
}

/// Sensor and load cell of the same presses: how late the sensor's stream is, press by press.
fn clocks(folder: &Path) -> Outcome<String> {
    let sensor = recorded::rows(&folder.join("exp_0.01_0.txt"), 2)?;
    let cell = recorded::rows(&folder.join("exp_futek_0.01_0.txt"), 2)?;
    let zero_s = cell[0][1];
    let onsets = |rows: &[Vec<f64>], on: &dyn Fn(f64) -> bool| -> Vec<f64> {
        let mut found: Vec<f64> = Vec::new();
        for pair in rows.windows(2) {
            let t = pair[1][1] - zero_s;
            if !on(pair[0][0]) && on(pair[1][0]) && found.last().is_none_or(|last| t - last > 2.0) {
                found.push(t);
            }
        }
        found
    };
    let touched = onsets(&cell, &|force| force > 1.0);
    let mut rows = Vec::new();
    for reading in [300.0, 200.0, 100.0] {
        let answered = onsets(&sensor, &|r| r < reading);
        let lags: Vec<(f64, f64)> = touched
            .iter()
            .filter_map(|t| answered.iter().find(|a| (**a - t).abs() < 2.5).map(|a| (*t, a - t)))
            .collect();
        let (mean, line) = (Polynomial::fit(&lags, 0)?, Polynomial::fit(&lags, 1)?);
        rows.push(vec![
            format!("{reading}"),
            format!("{}", lags.len()),
            format!("{:.2} ({:.2} to {:.2})", mean.coefficients[0].0, mean.interval95(0).0, mean.interval95(0).1),
            format!("{:.2}", mean.deviation),
            format!("{:+.1}, p = {:.0e}", 1e3 * line.coefficients[1].0 * 60.0, line.probability(1, 0.0)),
        ]);
    }
    Ok(table(
        &["reading below", "presses", "after the load cell passes 1 N (s)", "scatter (s)", "changes by (ms a minute)"],
        &rows,
    ))
}

/// Load that the robot is taken to press with, N: what it was is not recorded, and only that it stayed counts.
const PRESS_N: f64 = 15.0;
/// Time of every hold that all have, s; samples a row, about 20 a second.
const SHARED_S: f64 = 9.5;
const ROWS: usize = 7;
/// Time from sample to sample, s (143 Hz; the file's own clock pauses).
const STEP_S: f64 = 1.0 / 143.0;

/// The first seconds of all holds as four repeats of one press of a force sensor: conductance in proportion to the load,
/// compared once the robot has stopped.
fn held_alike(folder: &Path) -> Outcome<String> {
    let made = tempfile::tempdir()?;
    let mut description = String::from("name = \"Velostat, held\"\n");
    for (name, _) in HOLDS {
        let rows = recorded::rows(&folder.join(name), 2)?;
        let start = rows.iter().position(|row| row[0] < PRESSED.0).ok_or("never pressed")?;
        let before = (0.5 / STEP_S) as usize;
        let count = ((0.5 + SHARED_S) / STEP_S) as usize / ROWS;
        let mut csv = String::from("time_s,reference_N,force_N\n");
        for k in 0..count {
            let from = start.saturating_sub(before) + k * ROWS;
            let mut readings: Vec<f64> = rows[from..from + ROWS].iter().map(|row| row[0]).collect();
            let time_s = (k * ROWS) as f64 * STEP_S;
            let pressed = if time_s > 0.5 + SETTLES_S { PRESS_N } else { 0.0 };
            let _ = writeln!(csv, "{time_s:.4},{pressed},{:.5}", PRESS_N * UNIT_OHM / middle(&mut readings));
        }
        std::fs::write(made.path().join(name).with_extension("csv"), csv)?;
        let file = name.replace(".txt", ".csv");
        let _ = writeln!(description, "[[run]]\nfile = \"{file}\"\ntest = \"display\"");
    }
    std::fs::write(made.path().join("experiment.toml"), description)?;
    let experiment = palpate::experiment::read(made.path())?;
    let found = palpate::diagnose::display::diagnose(&experiment, &|_, _, _| {}).ok_or("no run of a sensor")?;
    Ok(found.channels.iter().map(asked::of_channel).collect())
}

/// The section.
pub fn section(figures: &Path) -> Outcome<Option<String>> {
    let Some(folder) = tests::shared_or_skipped("data/velostat_hold_creep") else { return Ok(None) };
    let Some(cycles) = tests::shared_or_skipped("data/tams_piezoresistive") else { return Ok(None) };
    let mut parts = Vec::new();
    let mut out = String::from("Held:\n\n");
    out += &holds(&folder, &mut parts)?;
    out += "\nThe first ten seconds of all four as repeats of one press, the load taken as constant:\n\n";
    out += &held_alike(&folder)?;
    out += "\nPressed again and again:\n\n";
    out += &covers(&cycles, &mut parts)?;
    out += "\nTwo streams of the same twenty presses:\n\n";
    out += &clocks(&folder)?;
    out += "\n";
    out += &picture(figures, "real-diagnosis-velostat.svg", "Conductance over time held, and over force", &parts)?;
    Ok(Some(out))
}
