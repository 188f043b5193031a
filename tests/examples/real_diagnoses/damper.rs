//! Loops of a damper with magneto-rheological fluid: is force a function of velocity, and if not, of what else?

use std::path::Path;

use nalgebra::{DMatrix, DVector};
use palpate::calibration::hysteresis::{Hysteresis, presses};
use palpate::identify::simplex::{Bounds, Stop, descend};
use palpate::report::figure::{Axis, Figure, Series, Stroke};
use rayon::prelude::*;
use tests::document::table;

use super::{Outcome, picture, recorded};

/// Sets of runs, one current each (0.495 A for A; the notes do not tell the others).
const SETS: [(&str, &str); 3] = [("A", "ensaio.A."), ("B", "ensaio.B."), ("vali", "ensaio.vali.")];
const STEP_S: f64 = 0.01;

/// One run: displacement (mm), velocity (mm/s), force (N) every hundredth of a second, without the standstill before the motion.
struct Loops {
    x_mm: Vec<f64>,
    v_mm_s: Vec<f64>,
    force_n: Vec<f64>,
}

impl Loops {
    fn of(file: &Path) -> Outcome<Self> {
        let rows = recorded::rows(file, 3)?;
        let x: Vec<f64> = rows.iter().map(|row| row[1]).collect();
        let (low, high) = x.iter().fold((f64::MAX, f64::MIN), |(a, b), x| (a.min(*x), b.max(*x)));
        let moving = x.iter().position(|e| (e - x[0]).abs() > 0.2 * (high - low)).unwrap_or(0);
        let used = moving.max(3)..x.len() - 3;
        // a parabola over seven samples: its slope
        let slope = |at: usize| (1..=3).map(|k| k as f64 * (x[at + k] - x[at - k])).sum::<f64>() / (28.0 * STEP_S);
        Ok(Self {
            x_mm: used.clone().map(|at| x[at]).collect(),
            v_mm_s: used.clone().map(slope).collect(),
            force_n: used.map(|at| rows[at][2]).collect(),
        })
    }

    fn fastest(&self) -> f64 {
        self.v_mm_s.iter().map(|v| v.abs()).fold(0.0, f64::max)
    }
}

/// What the friction-like part of the force follows.
#[derive(Clone, Copy, PartialEq)]
enum Law {
    /// The sign of velocity, rounded over a width (mm/s).
    Velocity,
    /// The same with a delay (s).
    Late,
    /// The rounded sign of the fluid's own velocity, with a spring in series: it takes a length (mm) to build the yield force up.
    Spring,
}

const LAWS: [(&str, Law, bool); 5] = [
    ("velocity alone", Law::Velocity, false),
    ("velocity + spring beside", Law::Velocity, true),
    ("velocity, late (+ spring beside)", Law::Late, true),
    ("velocity, through a spring in series", Law::Spring, false),
    ("the same + spring beside", Law::Spring, true),
];

fn shape(run: &Loops, law: Law, x: &[f64]) -> Vec<f64> {
    let width = x[0].exp();
    let velocity = |at: f64| {
        let at = at.clamp(0.0, (run.v_mm_s.len() - 1) as f64);
        let k = (at as usize).min(run.v_mm_s.len() - 2);
        run.v_mm_s[k] + (at - k as f64) * (run.v_mm_s[k + 1] - run.v_mm_s[k])
    };
    match law {
        Law::Velocity => run.v_mm_s.iter().map(|v| (v / width).tanh()).collect(),
        Law::Late => (0..run.v_mm_s.len()).map(|k| (velocity(k as f64 - x[1] / STEP_S) / width).tanh()).collect(),
        Law::Spring => {
            let length = x[1].exp();
            let mut z = (run.v_mm_s[0] / width).tanh();
            let mut out = vec![z];
            for pair in run.x_mm.windows(2) {
                z = stretched(z + (pair[1] - pair[0]) / length, width * STEP_S / length);
                out.push(z);
            }
            out
        }
    }
}

/// The state z within -1..1 after an implicit step of `dz = (dx - width atanh(z) dt) / length`: the root of `z + flow atanh(z) = target`.
fn stretched(target: f64, flow: f64) -> f64 {
    let (mut low, mut high) = (-1.0 + 1e-12, 1.0 - 1e-12);
    for _ in 0..50 {
        let z: f64 = 0.5 * (low + high);
        if z + flow * z.atanh() < target {
            low = z;
        } else {
            high = z;
        }
    }
    0.5 * (low + high)
}

fn columns(run: &Loops, law: (Law, bool), x: &[f64]) -> DMatrix<f64> {
    let z = shape(run, law.0, x);
    let width = 3 + usize::from(law.1);
    DMatrix::from_fn(z.len(), width, |i, k| match k {
        0 => 1.0,
        1 => z[i],
        2 => run.v_mm_s[i],
        _ => run.x_mm[i],
    })
}

/// Offset, yield force and coefficients that all runs of a list share, by least squares.
fn linear(runs: &[&Loops], law: (Law, bool), x: &[f64]) -> Option<DVector<f64>> {
    let width = 3 + usize::from(law.1);
    let (mut normal, mut right) = (DMatrix::zeros(width, width), DVector::zeros(width));
    for run in runs {
        let a = columns(run, law, x);
        normal += a.tr_mul(&a);
        right += a.tr_mul(&DVector::from_column_slice(&run.force_n));
    }
    Some(normal.cholesky()?.solve(&right))
}

fn rms(runs: &[&Loops], law: (Law, bool), x: &[f64], values: &DVector<f64>) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for run in runs {
        let left = DVector::from_column_slice(&run.force_n) - columns(run, law, x) * values;
        sum += left.norm_squared();
        count += left.len() as f64;
    }
    (sum / count).sqrt()
}

/// A law's fit: its shape, its linear values, what it leaves where it was fitted and where it was not (N).
struct Fitted {
    x: Vec<f64>,
    values: DVector<f64>,
    left_n: (f64, f64),
}

fn fit(law: (Law, bool), fitted: &[&Loops], predicted: &[&Loops]) -> Outcome<Fitted> {
    let objective = |x: &[f64]| linear(fitted, law, x).map_or(f64::INFINITY, |values| rms(fitted, law, x, &values));
    let (low, high, start) = match law.0 {
        Law::Velocity => (vec![0.05_f64.ln()], vec![60.0_f64.ln()], vec![3.0_f64.ln()]),
        Law::Late => (vec![0.05_f64.ln(), -0.1], vec![60.0_f64.ln(), 0.15], vec![3.0_f64.ln(), 0.03]),
        Law::Spring => {
            (vec![0.05_f64.ln(), 0.02_f64.ln()], vec![60.0_f64.ln(), 10.0_f64.ln()], vec![6.0_f64.ln(), 0.7_f64.ln()])
        }
    };
    let end =
        descend(&objective, &Bounds { low, high }, &start, 0.2, Stop { size: 1e-4, spread: 1e-6, iterations: 200 });
    let values = linear(fitted, law, &end.point).ok_or("no solution")?;
    let left_n = (rms(fitted, law, &end.point, &values), rms(predicted, law, &end.point, &values));
    Ok(Fitted { x: end.point, values, left_n })
}

/// The section.
pub fn section(figures: &Path) -> Outcome<Option<String>> {
    let Some(folder) = tests::shared_or_skipped("data/mr_damper_loops/csv") else { return Ok(None) };
    let mut names: Vec<String> =
        std::fs::read_dir(&folder)?.filter_map(|e| e.ok()?.file_name().into_string().ok()).collect();
    names.sort();
    let (mut gaps, mut rows, mut parts) = (Vec::new(), Vec::new(), Vec::new());
    for (set, prefix) in SETS {
        // vali.A.* is another set of files
        let own = |name: &&String| name.starts_with(prefix) && !name.starts_with(&format!("{prefix}A."));
        let runs: Vec<Loops> =
            names.iter().filter(own).map(|name| Loops::of(&folder.join(name))).collect::<Outcome<_>>()?;
        gaps.push(gap(set, &runs)?);
        let fitted: Vec<&Loops> = runs.iter().step_by(2).collect();
        let predicted: Vec<&Loops> = runs.iter().skip(1).step_by(2).collect();
        let found: Vec<Fitted> = LAWS
            .par_iter()
            .map(|(_, law, beside)| fit((*law, *beside), &fitted, &predicted).map_err(|e| e.to_string()))
            .collect::<Result<_, String>>()?;
        for ((name, law, _), one) in LAWS.iter().zip(&found) {
            let shape = match law {
                Law::Velocity => format!("{:.1} mm/s", one.x[0].exp()),
                Law::Late => format!("{:.1} mm/s, {:.0} ms", one.x[0].exp(), 1e3 * one.x[1]),
                Law::Spring => format!("{:.1} mm/s, {:.2} mm", one.x[0].exp(), one.x[1].exp()),
            };
            rows.push(vec![
                set.to_owned(),
                (*name).to_owned(),
                format!("{:.0}", one.values[1]),
                shape,
                format!("{:.0}", one.values[0]),
                format!("{:.0} ({:.1} %)", one.left_n.0, 100.0 * one.left_n.0 / one.values[1].abs()),
                format!("{:.0} ({:.1} %)", one.left_n.1, 100.0 * one.left_n.1 / one.values[1].abs()),
            ]);
        }
        if set == "A" {
            parts = drawing(predicted.first().ok_or("no run")?, &found);
        }
    }
    let mut out = table(
        &[
            "set",
            "runs",
            "force while slowing less force while speeding up, at equal speed (N)",
            "of the half height (%)",
            "p",
        ],
        &gaps,
    );
    out += "\n";
    out += &table(
        &[
            "set",
            "what the yield follows",
            "yield force (N)",
            "over",
            "offset (N)",
            "leaves, fitted runs (N)",
            "leaves, other runs (N)",
        ],
        &rows,
    );
    out += "\n";
    out += &picture(figures, "real-diagnosis-damper.svg", "Force over velocity and over displacement", &parts)?;
    Ok(Some(out))
}

/// Single-valued in velocity? One value a run: the mean over its half cycles.
fn gap(set: &str, runs: &[Loops]) -> Outcome<Vec<String>> {
    let mut all = Vec::new();
    for run in runs {
        let fast = run.fastest();
        let samples: Vec<(f64, f64)> = run.v_mm_s.iter().zip(&run.force_n).map(|(v, f)| (v / fast, *f)).collect();
        all.extend(presses(&samples, 0.05, 0.6));
    }
    let found = Hysteresis::of(&all, &[0.2, 0.3, 0.4, 0.5], 0.06)?;
    let level = found.levels.iter().map(|(a, b)| 0.5 * (a + b)).sum::<f64>() / found.levels.len() as f64;
    Ok(vec![
        set.to_owned(),
        format!("{} ({} half cycles)", runs.len(), found.presses),
        format!("{:+.0} ({:+.0} to {:+.0})", found.gap.value, found.gap.interval95.0, found.gap.interval95.1),
        format!("{:+.0}", 100.0 * found.gap.value / level),
        chance(found.gap.probability),
    ])
}

/// A probability, not told more finely than half cycles of few runs allow.
fn chance(probability: f64) -> String {
    if probability < 1e-3 { "< 0.001".to_owned() } else { format!("{probability:.3}") }
}

/// Samples drawn: three seconds.
const DRAWN: usize = 300;

fn drawing(run: &Loops, found: &[Fitted]) -> Vec<Figure> {
    let over =
        |x: &[f64], y: &[f64]| -> Vec<(f64, f64)> { x.iter().zip(y).take(DRAWN).map(|(x, y)| (*x, *y)).collect() };
    let predicted = |at: usize| -> Vec<f64> {
        let (_, law, beside) = LAWS[at];
        (columns(run, (law, beside), &found[at].x) * &found[at].values).iter().copied().collect()
    };
    let (alone, series) = (predicted(0), predicted(3));
    let one = |title: &str, label: &str, x: &[f64]| {
        Figure::new(title, Axis::new(label), Axis::new("force (N)"))
            .with(Series::new("", over(x, &run.force_n), Stroke::Circles, 0))
            .with(Series::new("velocity alone", over(x, &alone), Stroke::Dashed, 1))
            .with(Series::new("spring in series", over(x, &series), Stroke::Solid, 2))
    };
    vec![
        one("Set A, a run that was not fitted: force over velocity", "velocity (mm/s)", &run.v_mm_s),
        one("The same over displacement", "displacement (mm)", &run.x_mm),
    ]
}
