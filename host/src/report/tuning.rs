//! Figures of gains: step, command, Bode, Nyquist with its band, roots (thesis Figs. 75-78).

use std::f64::consts::PI;

use nalgebra::Complex;

use super::figure::{Axis, Figure, Series, Stroke};
use crate::tune::frequency::OpenLoop;
use crate::tune::roots::{Spread, Varied};
use crate::tune::study::Study;
use crate::tune::{Gains, Way, continuous, sampled::Exact};

/// Points of a frequency response.
const POINTS: usize = 400;
/// Plants of the box that the Nyquist band is drawn of, beside its corners.
const BAND: usize = 60;
/// Bins of a histogram.
const BINS: usize = 60;
/// Times the dominant time that a step is shown for.
const SHOWN: f64 = 14.0;

/// Every figure with its caption.
pub fn figures(study: &Study) -> Vec<(Figure, String)> {
    let mut all = vec![
        (shaft(study), "Shaft after a unit step, with the limits on it (Fig. 76).".to_owned()),
        (command(study), "Command during the step, with its limit (Fig. 76).".to_owned()),
        (gain(study), "Gain of the closed and of the open loop (Fig. 75); the bandwidth is where the closed one has fallen by 3 dB.".to_owned()),
        (phase(study), "Phase of the closed and of the open loop (Fig. 75).".to_owned()),
        (nyquist(study), nyquist_caption(study)),
    ];
    for spread in &study.spreads {
        all.push((histogram(spread), histogram_caption(spread, study.part)));
    }
    all
}

/// A step over time: shaft and command, and the time that is shown.
type Trace = (Vec<(f64, f64)>, Vec<(f64, f64)>);

/// What is shown of a step, s.
fn length_s(study: &Study) -> f64 {
    let bandwidth = study.judged.margins.bandwidth_hz.unwrap_or(1.0);
    (SHOWN / (2.0 * PI * bandwidth) + 4.0 * study.asked.uncertain.plant.delay_s).clamp(0.02, 100.0)
}

fn trace(study: &Study, gains: &Gains) -> Trace {
    let size = study.asked.limits.step_mm;
    let length = length_s(study);
    match study.asked.way.limited(&study.asked.limits) {
        Way::Continuous => {
            let points = continuous::trace(&study.asked.uncertain.plant, gains, length);
            let shaft = points.iter().map(|p| (p[0], size * p[1])).collect();
            (shaft, points.iter().map(|p| (p[0], size * p[2])).collect())
        }
        Way::Sampled(sampling) => {
            let (mut shaft, mut command) = (Vec::new(), Vec::new());
            let exact = Exact::new(&study.asked.uncertain.plant, sampling, study.asked.flaws);
            exact.scaled(gains, size, &mut |time, y, u| {
                if time > length {
                    return;
                }
                shaft.push((time, y));
                if u.is_finite() {
                    // Held until the next tick.
                    command.extend([(time, u), ((time + sampling.tick_s).min(length), u)]);
                }
            });
            (shaft, command)
        }
    }
}

fn named(study: &Study) -> Vec<(&str, Gains)> {
    let own = std::iter::once(("these gains", study.judged.gains));
    own.chain(study.others.iter().map(|(name, judged)| (*name, judged.gains))).collect()
}

fn level(length: f64, value: f64, label: &str) -> Series {
    Series::new(label, vec![(0.0, value), (length, value)], Stroke::Faint, 5)
}

fn shaft(study: &Study) -> Figure {
    let limits = &study.asked.limits;
    let (length, size) = (length_s(study), limits.step_mm);
    let axis = Axis::new("shaft (mm)").over(0.0, size * (1.3f64).max(1.1 + limits.overshoot));
    let mut figure = Figure::new("Step of the target, simulated", Axis::new("time (s)").over(0.0, length), axis);
    figure = figure.with(level(length, size * (1.0 + limits.overshoot), "limit"));
    figure = figure.with(level(length, size * (1.0 - limits.undershoot), "limit"));
    for (i, (name, gains)) in named(study).into_iter().enumerate().rev() {
        figure = figure.with(Series::new(name, trace(study, &gains).0, Stroke::LINES[i % 4], i));
    }
    figure
}

fn command(study: &Study) -> Figure {
    let (length, most) = (length_s(study), study.asked.limits.command_v);
    let x = Axis::new("time (s)").over(0.0, length);
    let mut figure =
        Figure::new("Command of that step, simulated", x, Axis::new("command (V)").over(-1.2 * most, 1.2 * most));
    figure = figure.with(level(length, most, "limit")).with(level(length, -most, "limit"));
    for (i, (name, gains)) in named(study).into_iter().enumerate().rev() {
        figure = figure.with(Series::new(name, trace(study, &gains).1, Stroke::LINES[i % 4], i));
    }
    figure
}

fn open(study: &Study) -> OpenLoop {
    OpenLoop::new(study.asked.way, &study.asked.uncertain.plant)
}

/// Frequency (Hz) and loop gain.
fn response(study: &Study) -> Vec<(f64, Complex<f64>)> {
    let open = open(study);
    let gains = study.judged.gains;
    open.frequencies(POINTS).into_iter().map(|w| (w / (2.0 * PI), open.at(&gains, w))).collect()
}

fn decibel(gain: Complex<f64>) -> f64 {
    20.0 * gain.norm().log10()
}

fn closed(open: Complex<f64>) -> Complex<f64> {
    open / (open + 1.0)
}

fn gain(study: &Study) -> Figure {
    let points = response(study);
    let of = |f: fn(Complex<f64>) -> Complex<f64>| points.iter().map(|(w, l)| (*w, decibel(f(*l)))).collect::<Vec<_>>();
    let x = Axis::new("frequency (Hz)").logarithmic();
    Figure::new("Gain of the loop, computed", x, Axis::new("gain (dB)").over(-60.0, 40.0))
        .with(Series::new("open", of(|l| l), Stroke::Dashed, 1))
        .with(Series::new("closed", of(closed), Stroke::Solid, 0))
}

fn phase(study: &Study) -> Figure {
    let points = response(study);
    let of = |f: fn(Complex<f64>) -> Complex<f64>| {
        let mut last = 0.0;
        let unwrapped = points.iter().map(|(w, l)| {
            let angle = f(*l).arg().to_degrees();
            last = angle - 360.0 * ((angle - last) / 360.0).round();
            (*w, last)
        });
        unwrapped.collect::<Vec<_>>()
    };
    let x = Axis::new("frequency (Hz)").logarithmic();
    Figure::new("Phase of the loop, computed", x, Axis::new("phase (degrees)").over(-360.0, 30.0))
        .with(Series::new("open", of(|l| l), Stroke::Dashed, 1))
        .with(Series::new("closed", of(closed), Stroke::Solid, 0))
}

/// Values of the plants of the box that are drawn: its corners, and points spread over it.
fn box_values(study: &Study) -> Vec<Vec<f64>> {
    let bounds = &study.asked.uncertain.bounds;
    if bounds.is_empty() || bounds.len() > 10 {
        return Vec::new();
    }
    // Multiples of irrational numbers fill the box evenly.
    let part = |i: usize, k: usize| (0.5 + i as f64 * (2.0 + k as f64).sqrt()).fract();
    let inner = (1..=BAND)
        .map(|i| bounds.iter().enumerate().map(|(k, (_, low, high))| low + part(i, k) * (high - low)).collect());
    study.asked.uncertain.corners().into_iter().chain(inner).collect()
}

fn nyquist(study: &Study) -> Figure {
    let gains = study.judged.gains;
    let mut figure = Figure::new(
        "Nyquist plot of the open loop, computed",
        Axis::new("real part").over(-2.5, 1.5),
        Axis::new("imaginary part").over(-2.5, 1.0),
    );
    figure.size = (640.0, 560.0);
    let points = |open: &OpenLoop| -> Vec<(f64, f64)> {
        let inside = |l: Complex<f64>| if l.norm() < 8.0 { (l.re, l.im) } else { (f64::NAN, f64::NAN) };
        open.frequencies(POINTS).into_iter().map(|w| inside(open.at(&gains, w))).collect()
    };
    for values in box_values(study) {
        let open = OpenLoop::new(study.asked.way, &study.asked.uncertain.at(&values));
        figure = figure.with(Series::new("", points(&open), Stroke::Faint, 1));
    }
    let circle = |radius: f64, centre: f64| {
        (0..=120).map(|i| f64::from(i) * PI / 60.0).map(|a| (centre + radius * a.cos(), radius * a.sin())).collect()
    };
    figure
        .with(Series::new("", circle(1.0, 0.0), Stroke::Dotted, 5))
        .with(Series::new("", circle(1.0 / study.judged.margins.peak_sensitivity, -1.0), Stroke::Dashed, 2))
        .with(Series::new("", points(&open(study)), Stroke::Solid, 0))
        .with(Series::new("", vec![(-1.0, 0.0)], Stroke::Dots, 1))
}

fn nyquist_caption(study: &Study) -> String {
    let drawn = box_values(study).len();
    let band = if drawn == 0 {
        String::new()
    } else {
        format!(" Thin lines: {drawn} plants of the box, its corners among them (Fig. 77).")
    };
    format!(
        "Open loop, thick.{band} Dot: -1. Dashed: the circle of the peak sensitivity, {}, which the thick line touches.",
        super::number(study.judged.margins.peak_sensitivity)
    )
}

fn histogram(spread: &Spread) -> Figure {
    let (low, high) = spread.real.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(*x), h.max(*x)));
    let (low, high) = if low < high { (low, high) } else { (low - 1.0, low + 1.0) };
    let width = (high - low) / BINS as f64;
    let mut bins = [0usize; BINS];
    for x in &spread.real {
        bins[(((x - low) / width) as usize).min(BINS - 1)] += 1;
    }
    let all = spread.real.len().max(1) as f64;
    let mut points = vec![(low, 0.0)];
    for (i, count) in bins.iter().enumerate() {
        let (left, share) = (low + width * i as f64, 100.0 * *count as f64 / all);
        points.extend([(left, share), (left + width, share)]);
    }
    points.push((high, 0.0));
    let what = if spread.varied == Varied::Plant { "the plant varies" } else { "Eq. 56 varies" };
    let title = format!("Real parts of the roots while {what}, {} samples", spread.samples);
    Figure::new(&title, Axis::new("real part (1/s)"), Axis::new("share of the roots (%)")).with(Series::new(
        "",
        points,
        Stroke::Solid,
        0,
    ))
}

/// Ranges of the groups, in words.
pub fn ranges(spread: &Spread) -> String {
    let one = |group: &crate::tune::roots::Group| {
        let (middle, half) = group.middle();
        format!("{middle:.2} +- {half:.2} around {:.2}", group.nominal)
    };
    spread.groups.iter().map(one).collect::<Vec<_>>().join(", ")
}

fn histogram_caption(spread: &Spread, part: f64) -> String {
    let varied = match spread.varied {
        Varied::Plant => "Only the plant's coefficients vary, within the box.".to_owned(),
        Varied::Equation => format!(
            "Every number printed in Eq. 56 varies by +-{:.0} %, the controller's too: of the choices tried this one gives the \
             ranges of Fig. 78.",
            100.0 * part
        ),
    };
    format!("{varied} Corners and samples reach {} 1/s.", ranges(spread))
}
