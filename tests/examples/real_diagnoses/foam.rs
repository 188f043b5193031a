//! Shoe foam pressed six times without rest, then slowly, then held: which of relaxation, softening and a loop that no rate changes it takes.
//!
//! Whatever the elastic law is must not matter, so it is left free: stress is a piecewise linear function of strain. An effect changes what that
//! function is asked for; every model is linear in the function's values. Four cycles are fitted, the rest is predicted.

use std::ops::Range;
use std::path::Path;

use nalgebra::{DMatrix, DVector};
use palpate::calibration::hysteresis::{Hysteresis, Mean, presses};
use palpate::identify::simplex::{Bounds, Stop, descend};
use palpate::report::figure::{Axis, Figure, Series, Stroke};
use tests::document::table;

use super::{Outcome, asked, picture, recorded};

/// A recording: file, height (mm), area (mm^2), start of cycle 5, of the slow ramp, of the hold, s.
struct Piece {
    name: &'static str,
    file: &'static str,
    height_mm: f64,
    area_mm2: f64,
}

const PIECES: [Piece; 2] = [
    Piece { name: "free", file: "data/shoe_foam/leap-comp-3.txt", height_mm: 10.65, area_mm2: 46.73 },
    Piece { name: "in a ring", file: "data/shoe_foam/leap-confcomp-2.txt", height_mm: 8.65, area_mm2: 43.47 },
];

/// Every so many samples are kept.
const THINNED: usize = 12;
/// Distance of the knots of the elastic function.
const KNOT: f64 = 0.05;
/// Strain below which a cycle counts as ended, and above which as reached.
const ENDS: (f64, f64) = (0.03, 0.5);
/// Cycles that are fitted.
const FITTED: usize = 4;

struct Recording {
    time_s: Vec<f64>,
    strain: Vec<f64>,
    stress_mpa: Vec<f64>,
    /// Samples at which each cycle starts, then the slow ramp.
    starts: Vec<usize>,
    /// Sample at which the hold begins.
    hold: usize,
}

impl Recording {
    fn of(piece: &Piece, file: &Path) -> Outcome<Self> {
        let rows = recorded::rows(file, 6)?;
        let kept: Vec<&Vec<f64>> = rows.iter().step_by(THINNED).collect();
        let zero_mm = kept[0][5] / 1000.0;
        let strain: Vec<f64> = kept.iter().map(|row| (zero_mm - row[5] / 1000.0) / piece.height_mm).collect();
        let (mut starts, mut low) = (Vec::new(), 0);
        let mut reached = false;
        for (at, e) in strain.iter().enumerate() {
            if *e < ENDS.0 {
                (low, reached) = (at, false);
            } else if *e > ENDS.1 && !reached {
                reached = true;
                starts.push(low);
            }
        }
        let deepest = strain[low..].iter().copied().fold(0.0, f64::max);
        let hold = low + strain[low..].iter().position(|e| *e > 0.999 * deepest).unwrap_or(0);
        Ok(Self {
            time_s: kept.iter().map(|row| row[0]).collect(),
            strain,
            stress_mpa: kept.iter().map(|row| row[4] / piece.area_mm2).collect(),
            starts,
            hold,
        })
    }

    /// Stretches with their names; the first is fitted. A slow ramp and a hold follow the cycles in one of the recordings only.
    fn parts(&self) -> Outcome<Vec<(&'static str, Range<usize>)>> {
        let held = self.strain.last().is_some_and(|e| *e > ENDS.1);
        let cycles = self.starts.len() - usize::from(held);
        let five = *self.starts.get(FITTED).filter(|_| cycles > FITTED).ok_or("fewer cycles than fitted")?;
        let ended = self.strain.iter().rposition(|e| *e > ENDS.0).unwrap_or(0) + 1;
        let slow = if held { self.starts[cycles] } else { ended };
        let mut parts = vec![("cycles 1 to 4", 0..five), ("later cycles", five..slow)];
        if held {
            parts.push(("slow ramp", slow..self.hold));
            parts.push(("hold", self.hold..self.time_s.len()));
        }
        Ok(parts)
    }
}

/// Which effects are on.
#[derive(Clone, Copy, Default)]
struct Effects {
    /// Prony terms.
    relaxing: usize,
    /// A strain that was exceeded before has another stress.
    softening: bool,
    /// The way back has another stress, whatever the rate.
    loops: bool,
}

const MODELS: [(&str, Effects); 7] = [
    ("elastic", Effects { relaxing: 0, softening: false, loops: false }),
    ("relaxation, two terms", Effects { relaxing: 2, softening: false, loops: false }),
    ("softening", Effects { relaxing: 0, softening: true, loops: false }),
    ("loop", Effects { relaxing: 0, softening: false, loops: true }),
    ("softening + relaxation", Effects { relaxing: 2, softening: true, loops: false }),
    ("loop + relaxation", Effects { relaxing: 2, softening: false, loops: true }),
    ("softening + loop", Effects { relaxing: 0, softening: true, loops: true }),
];

/// Columns of the elastic functions, one set for each that the effects ask for.
fn columns(recording: &Recording, effects: Effects) -> DMatrix<f64> {
    let deepest = recording.strain.iter().copied().fold(0.0, f64::max);
    let knots = (deepest / KNOT).ceil() as usize;
    let sets = 1 + usize::from(effects.softening) + usize::from(effects.loops);
    let mut out = DMatrix::zeros(recording.strain.len(), knots * sets);
    let (mut exceeded, mut before, mut back) = (0.0_f64, 0.0, false);
    for (at, e) in recording.strain.iter().enumerate() {
        // in a hold the direction stays
        if (e - before).abs() > 1e-4 {
            back = *e < before;
        }
        before = *e;
        let softened = effects.softening && *e < exceeded - 1e-3;
        let set = match (softened, effects.loops && back) {
            (_, true) => sets - 1,
            (true, false) => 1,
            (false, false) => 0,
        };
        exceeded = exceeded.max(*e);
        for k in 0..knots {
            let hat = 1.0 - (e / KNOT - (k + 1) as f64).abs();
            if hat > 0.0 {
                out[(at, set * knots + k)] = hat;
            }
        }
    }
    out
}

/// Columns after a relaxation with parts and times (g, tau): Boltzmann's superposition, exact for what is straight between samples.
fn relaxed(columns: &DMatrix<f64>, time_s: &[f64], terms: &[(f64, f64)]) -> DMatrix<f64> {
    let left = 1.0 - terms.iter().map(|term| term.0).sum::<f64>();
    let mut out = columns * left;
    for (g, tau) in terms {
        let mut memory = DVector::zeros(columns.ncols());
        for at in 1..columns.nrows() {
            let x = (time_s[at] - time_s[at - 1]) / tau;
            let (decay, gain) = ((-x).exp(), -(-x).exp_m1() / x.max(1e-12));
            memory *= decay;
            memory += (columns.row(at) - columns.row(at - 1)).transpose() * gain;
            let mut row = out.row_mut(at);
            row += memory.transpose() * *g;
        }
    }
    out
}

/// Least squares over the fitted samples (a whisper of ridge where a knot has no sample), and the prediction everywhere.
fn predicted(columns: &DMatrix<f64>, stress: &[f64], fitted: &Range<usize>) -> Option<Vec<f64>> {
    let part = columns.rows(fitted.start, fitted.len());
    let y = DVector::from_column_slice(&stress[fitted.clone()]);
    let mut normal = part.tr_mul(&part);
    for k in 0..normal.nrows() {
        normal[(k, k)] += 1e-6;
    }
    let values = normal.cholesky()?.solve(&part.tr_mul(&y));
    Some((columns * values).iter().copied().collect())
}

fn rms(model: &[f64], stress: &[f64], part: &Range<usize>) -> f64 {
    let square: f64 = part.clone().map(|k| (model[k] - stress[k]).powi(2)).sum();
    (square / part.len().max(1) as f64).sqrt()
}

/// Part of the stress that relaxes, and its time, s.
type Term = (f64, f64);

/// A model's prediction and its relaxation.
fn fit(recording: &Recording, effects: Effects, fitted: &Range<usize>) -> Outcome<(Vec<f64>, Vec<Term>)> {
    let columns = columns(recording, effects);
    let terms = |x: &[f64]| -> Vec<(f64, f64)> { x.chunks_exact(2).map(|t| (t[0], t[1].exp())).collect() };
    let of = |x: &[f64]| predicted(&relaxed(&columns, &recording.time_s, &terms(x)), &recording.stress_mpa, fitted);
    if effects.relaxing == 0 {
        return Ok((of(&[]).ok_or("no solution")?, Vec::new()));
    }
    let objective = |x: &[f64]| of(x).map_or(f64::INFINITY, |model| rms(&model, &recording.stress_mpa, fitted));
    let bounds = Bounds {
        low: [0.0, 0.02_f64.ln()].repeat(effects.relaxing),
        high: [0.45, 200.0_f64.ln()].repeat(effects.relaxing),
    };
    let stop = Stop { size: 1e-3, spread: 1e-4, iterations: 150 };
    let starts = [[0.1, 0.3_f64.ln(), 0.1, 10.0_f64.ln()], [0.2, 0.05_f64.ln(), 0.2, 1.0_f64.ln()]];
    let ends = starts.iter().map(|start| descend(&objective, &bounds, start, 0.15, stop));
    let best = ends.min_by(|a, b| a.value.total_cmp(&b.value)).ok_or("no start")?;
    Ok((of(&best.point).ok_or("no solution")?, terms(&best.point)))
}

fn mean(of: Mean) -> String {
    format!("{:+.4} ({:+.4} to {:+.4}), p = {:.1e}", of.value, of.interval95.0, of.interval95.1, of.probability)
}

/// The section.
pub fn section(figures: &Path) -> Outcome<Option<String>> {
    let mut out = String::new();
    let mut parts = Vec::new();
    for piece in &PIECES {
        let Some(file) = tests::shared_or_skipped(piece.file) else { return Ok(None) };
        let recording = Recording::of(piece, &file)?;
        let stages = recording.parts()?;
        let samples: Vec<(f64, f64)> =
            recording.strain.iter().copied().zip(recording.stress_mpa.iter().copied()).collect();
        let cycles = presses(&samples[..(stages[1].1.end + 1).min(samples.len())], ENDS.0, ENDS.1);
        let compared = Hysteresis::of(&cycles, &[0.1, 0.2, 0.3, 0.4, 0.5], 0.015)?;
        let first = recording.stress_mpa[..recording.starts[1]].iter().copied().fold(0.0, f64::max);
        out += &format!(
            "**{}**: {} cycles compared. Way back less way in: {} MPa; change from cycle to cycle: {} MPa; first peak {first:.3} MPa.\n\n",
            piece.name,
            compared.presses,
            mean(compared.gap),
            mean(compared.trend)
        );
        let mut rows = Vec::new();
        let mut curves = Vec::new();
        for (name, effects) in MODELS {
            let (model, terms) = fit(&recording, effects, &stages[0].1)?;
            let mut row = vec![name.to_owned()];
            row.extend(
                stages
                    .iter()
                    .map(|(_, part)| format!("{:.1}", 100.0 * rms(&model, &recording.stress_mpa, part) / first)),
            );
            let told: Vec<String> = terms.iter().map(|(g, tau)| format!("{g:.2} in {tau:.2} s")).collect();
            row.push(told.join(", "));
            rows.push(row);
            curves.push((name, model));
        }
        let mut head = vec!["model, its elastic law free"];
        head.extend(stages.iter().map(|(name, _)| *name));
        head.push("relaxes");
        out += &table(&head, &rows);
        out += "\n";
        let title = format!("Shoe foam, {}: measured (circles) and predicted from four cycles", piece.name);
        let mut figure = Figure::new(&title, Axis::new("time (s)"), Axis::new("stress (MPa)"));
        figure.size.0 = 900.0;
        let from = stages[1].1.start;
        let points = |values: &[f64]| -> Vec<(f64, f64)> {
            (from..values.len()).map(|k| (recording.time_s[k], values[k])).collect()
        };
        figure = figure.with(Series::new("", points(&recording.stress_mpa), Stroke::Circles, 0));
        for (at, name) in ["relaxation, two terms", "softening + relaxation"].iter().enumerate() {
            if let Some((_, model)) = curves.iter().find(|(n, _)| n == name) {
                figure = figure.with(Series::new(name, points(model), Stroke::LINES[at], at + 1));
            }
        }
        parts.push(figure);
    }
    if let Some(experiment) = recorded::experiment("shoe_foam_cycles", "data/shoe_foam")? {
        for found in palpate::diagnose::compression::diagnose(&experiment) {
            out += "**free**, six cycles and the hold as seven compressions of one piece (`tests/experiments/shoe_foam_cycles`):\n\n";
            out += &asked::of_compression(&found);
            out += "\n";
        }
    }
    out += "First column: fitted; the others: predicted; rms in percent of the first peak.\n\n";
    out += &picture(figures, "real-diagnosis-foam.svg", "Shoe foam, what four cycles predict", &parts)?;
    Ok(Some(out))
}
