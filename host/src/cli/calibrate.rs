//! `palpate board calibrate`: show, tare, load, or fit a linear sensor to known points.

use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use clap::{Args, ValueEnum};
use miette::{Context, IntoDiagnostic, bail};
use protocol::message::{Calibration, Raw};
use serde_json::json;

use super::answer::Answer;
use crate::link::Link;
use crate::session::{Event, Session};

/// What to do with the calibration.
#[derive(Debug, Args)]
pub struct Choice {
    /// The sensor that `--points` calibrates
    #[arg(value_enum, requires = "points")]
    sensor: Option<Sensor>,
    /// Known forces (N) or heights (mm), at least two: the program waits for Enter at each and reads the sensor for a
    /// second; VALUE=RATIO takes a reading that is known already, a fraction of the reference voltage
    #[arg(long, num_args = 2.., value_name = "VALUE", requires = "sensor", allow_negative_numbers = true)]
    points: Vec<Point>,
    /// Take the load cell's present reading as zero
    #[arg(long, conflicts_with_all = ["load", "points"])]
    tare: bool,
    /// Load a calibration from a TOML file, in the form that this command prints
    #[arg(long, value_name = "FILE", conflicts_with = "points")]
    load: Option<PathBuf>,
}

/// A sensor whose law is a straight line through two or more points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Sensor {
    /// Force of the probe, N, positive when pressed
    LoadCell,
    /// Height of the ball's lowest point above the base plate, mm
    Probe,
}

impl Sensor {
    const fn unit(self) -> &'static str {
        match self {
            Sensor::LoadCell => "N",
            Sensor::Probe => "mm",
        }
    }

    fn ratio(self, raw: &Raw) -> f64 {
        let reading = match self {
            Sensor::LoadCell => raw.load_cell,
            Sensor::Probe => raw.probe_position,
        };
        f64::from(reading) / f64::from(u16::MAX)
    }

    fn set(self, calibration: &mut Calibration, line: &Line) {
        let (zero, slope) = (line.zero_ratio as f32, line.per_ratio as f32);
        match self {
            Sensor::LoadCell => {
                (calibration.load_cell.zero_ratio, calibration.load_cell.n_per_ratio) = (zero, slope);
            }
            Sensor::Probe => (calibration.probe.zero_ratio, calibration.probe.mm_per_ratio) = (zero, slope),
        }
    }
}

/// A known value, with the reading at it if that is known too.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Point {
    value: f64,
    ratio: Option<f64>,
}

impl FromStr for Point {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = |text: &str| {
            let number = text.parse::<f64>().ok().filter(|x| x.is_finite());
            number.ok_or_else(|| {
                format!("`{text}` is no number: expected VALUE or VALUE=RATIO, such as 1.96 or 1.96=0.312")
            })
        };
        let Some((value, ratio)) = text.split_once('=') else {
            return Ok(Point { value: number(text)?, ratio: None });
        };
        let ratio = number(ratio)?;
        if !(0.0..=1.0).contains(&ratio) {
            return Err(format!("a reading of {ratio}: expected a fraction of the reference voltage, 0 to 1"));
        }
        Ok(Point { value: number(value)?, ratio: Some(ratio) })
    }
}

/// `value = (ratio - zero_ratio) per_ratio`, by least squares.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Line {
    zero_ratio: f64,
    per_ratio: f64,
    /// Largest distance of a point from the line, in the value's unit.
    worst: f64,
}

/// Readings must span this much of the range: less, and noise of a thousandth moves the slope by 2 %.
const LEAST_SPAN: f64 = 0.05;

fn fit(points: &[(f64, f64)]) -> Result<Line, String> {
    let count = points.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / count;
    let (value, ratio) = (mean(|p| p.0), mean(|p| p.1));
    let (low, high) = points.iter().fold((f64::MAX, f64::MIN), |(l, h), p| (l.min(p.1), h.max(p.1)));
    if points.len() < 2 || high - low < LEAST_SPAN {
        return Err(format!(
            "the readings span {:.4} of the reference voltage, expected at least {LEAST_SPAN}: use values farther apart",
            (high - low).max(0.0)
        ));
    }
    // Regressed on the reading, which is the mean of a second: the values are what is known.
    let covariance: f64 = points.iter().map(|p| (p.0 - value) * (p.1 - ratio)).sum();
    let variance: f64 = points.iter().map(|p| (p.1 - ratio) * (p.1 - ratio)).sum();
    let per_ratio = covariance / variance;
    let zero_ratio = ratio - value / per_ratio;
    let off = |p: &(f64, f64)| ((p.1 - zero_ratio) * per_ratio - p.0).abs();
    Ok(Line { zero_ratio, per_ratio, worst: points.iter().map(off).fold(0.0, f64::max) })
}

/// Does it.
///
/// # Errors
/// A file that cannot be read, points that make no line, or a board that refuses.
pub(super) fn run<L: Link>(session: &mut Session<L>, choice: &Choice) -> miette::Result<Answer> {
    let mut told = String::new();
    let mut worst = None;
    if let Some(path) = &choice.load {
        session.set_calibration(load(path)?).into_diagnostic()?;
    }
    if let Some(sensor) = choice.sensor {
        let points = measured(session, sensor, &choice.points)?;
        let line = fit(&points).map_err(|reason| miette::miette!("{reason}"))?;
        let mut calibration = session.calibration().into_diagnostic()?;
        sensor.set(&mut calibration, &line);
        session.set_calibration(calibration).into_diagnostic().wrap_err_with(|| {
            format!(
                "the line through the points: zero at {:.5}, {:.4} {} a reference voltage",
                line.zero_ratio,
                line.per_ratio,
                sensor.unit()
            )
        })?;
        told = format!("# farthest point from the line: {:.4} {}\n", line.worst, sensor.unit());
        worst = Some(line.worst);
    }
    if choice.tare {
        mean_ratio(session, Sensor::LoadCell, 0.1)?;
        session.tare().into_diagnostic()?;
    }
    let calibration = session.calibration().into_diagnostic()?;
    let text = toml::to_string(&calibration).into_diagnostic()?;
    Ok((json!({ "calibration": calibration, "worst_point": worst }), told + text.trim_end()))
}

fn load(path: &Path) -> miette::Result<Calibration> {
    let text = std::fs::read_to_string(path).into_diagnostic().wrap_err_with(|| path.display().to_string())?;
    toml::from_str(&text).into_diagnostic().wrap_err_with(|| path.display().to_string())
}

/// Each point as (value, reading); asks for those whose reading is not known.
fn measured<L: Link>(session: &mut Session<L>, sensor: Sensor, points: &[Point]) -> miette::Result<Vec<(f64, f64)>> {
    let mut readings = Vec::new();
    for point in points {
        let ratio = match point.ratio {
            Some(ratio) => ratio,
            None => {
                wait_for_enter(&format!("apply {} {}, then press Enter", point.value, sensor.unit()))?;
                mean_ratio(session, sensor, 1.0)?
            }
        };
        readings.push((point.value, ratio));
    }
    Ok(readings)
}

fn wait_for_enter(question: &str) -> miette::Result<()> {
    if !std::io::stdin().is_terminal() {
        bail!("`--points` waits for Enter at each value and this is no terminal: give the readings, as VALUE=RATIO");
    }
    errln!("{question}");
    std::io::stdin().read_line(&mut String::new()).into_diagnostic()?;
    Ok(())
}

/// Mean reading of a sensor from now on.
fn mean_ratio<L: Link>(session: &mut Session<L>, sensor: Sensor, duration_s: f64) -> miette::Result<f64> {
    let until_s = session.link().now_s() + duration_s;
    let (mut sum, mut count) = (0.0, 0);
    while let Some(event) = session.poll(until_s).into_diagnostic()? {
        if let Event::Telemetry(record) = event {
            sum += sensor.ratio(&record.raw);
            count += 1;
        }
    }
    if count == 0 {
        bail!("the board sent no reading within {duration_s} s");
    }
    Ok(sum / f64::from(count))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::link::{InProcess, Pace};
    use crate::plant::Jitter;
    use crate::session::Patience;
    use crate::simulated_board::SimulatedBoard;

    #[test]
    fn a_line_goes_through_its_points_and_says_how_far_the_worst_one_is() {
        let line = fit(&[(0.0, 0.1), (1.0, 0.2), (5.0, 0.6)]).unwrap();
        // f64 rounding of a handful of operations.
        assert!((line.zero_ratio - 0.1).abs() < 1e-12 && (line.per_ratio - 10.0).abs() < 1e-9 && line.worst < 1e-9);
        let bent = fit(&[(0.0, 0.1), (1.0, 0.2), (2.2, 0.3)]).unwrap();
        assert!((bent.worst - 0.2 / 3.0).abs() < 1e-9, "{bent:?}");
        assert!(fit(&[(0.0, 0.1), (1.0, 0.12)]).unwrap_err().contains("use values farther apart"));
    }

    #[test]
    fn points_are_values_with_or_without_a_reading() {
        assert_eq!("1.5".parse(), Ok(Point { value: 1.5, ratio: None }));
        assert_eq!("1.5=0.25".parse(), Ok(Point { value: 1.5, ratio: Some(0.25) }));
        for wrong in ["x", "1=x", "1=1.2", "nan"] {
            assert!(wrong.parse::<Point>().is_err(), "{wrong}");
        }
    }

    /// The readings of a board make back the calibration that its bench was made with.
    #[test]
    fn readings_of_the_board_are_raw() {
        let link = InProcess::new(SimulatedBoard::new(1, Jitter::NONE), Pace::Free);
        let (mut session, _) = Session::open(link, Patience::default()).unwrap();
        let ratio = mean_ratio(&mut session, Sensor::LoadCell, 1.0).unwrap();
        let before = session.calibration().unwrap();
        // The bench's cell is off by some hundredths of a newton, a thousandth of the range each.
        assert!((ratio - f64::from(before.load_cell.zero_ratio)).abs() < 1e-2, "{ratio}");
        let points = vec![Point { value: 0.0, ratio: Some(ratio) }, Point { value: 5.0, ratio: Some(ratio + 0.25) }];
        let choice = Choice { sensor: Some(Sensor::LoadCell), points, tare: false, load: None };
        run(&mut session, &choice).unwrap();
        let after = session.calibration().unwrap();
        assert!((after.load_cell.n_per_ratio - 20.0).abs() < 1e-3, "{after:?}");
        // Ten times the sensitivity is not this cell: the board refuses, and the line is told.
        let points = vec![Point { value: 0.0, ratio: Some(0.1) }, Point { value: 50.0, ratio: Some(0.6) }];
        let error = run(&mut session, &Choice { sensor: Some(Sensor::LoadCell), points, tare: false, load: None });
        assert!(error.unwrap_err().to_string().contains("100.0000 N a reference voltage"));
    }
}
