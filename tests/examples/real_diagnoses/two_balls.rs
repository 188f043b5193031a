//! Thesis Table 1: identified parameters depend on the ball. Its experiment is pressed again with each candidate cause, and identified as the
//! thesis did: one ball at a time, then both, by Eq. 14 with the contact taken as recorded.

mod bench;
mod cause;

use std::path::Path;

use palpate::identify::simplex::{Bounds, Stop, descend};
use palpate::report::figure::{Axis, Figure, Series, Stroke};
use rand::SeedableRng;
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64;
use rayon::prelude::*;
use tests::document::table;

use super::{Outcome, picture};
use bench::{Bench, DEPTH_MM, apart, distance};
use cause::{CAUSES, Cause, FOAMS, Foam, NOTHING, PLAIN, Pair};

/// What a cause makes of Table 1.
struct Found {
    amount: f64,
    truth: Pair,
    /// Root mean square of the differences in mu and alpha of both balls from Table 1, percent.
    miss: f64,
    /// The same of the joint identification, which was not fitted.
    joint_miss: f64,
    table: [Pair; 3],
    /// Ratio of the exponents, ball of 6 mm over ball of 4 mm, from 2, 3 and 4 mm.
    ratios: [f64; 3],
}

/// Table 1's curves: what its single-ball parameters say of each ball. The recordings themselves were not published.
fn reported(bench: &Bench, foam: &Foam) -> [Vec<f64>; 2] {
    let [of_small, of_large] = foam.each.map(|pair| bench.with(pair, None));
    [of_small[0].clone(), of_large[1].clone()]
}

impl Found {
    /// The amount of a cause, and the material, whose Table 1 comes nearest to the printed one.
    fn nearest(bench: &Bench, foam: &Foam, cause: &Cause) -> Self {
        let (low, high) = cause.range;
        let at = |x: &[f64]| ((x[0].exp(), x[1].exp()), low + (high - low) * x[2]);
        let each =
            |data: &[Vec<f64>; 2]| [[true, false], [false, true]].map(|asked| bench.identify(data, asked, DEPTH_MM));
        let objective = |x: &[f64]| {
            let (truth, amount) = at(x);
            apart(&each(&bench.pressed(truth, cause, amount)), &foam.each)
        };
        let bounds =
            Bounds { low: vec![0.02_f64.ln(), 2.0_f64.ln(), 0.0], high: vec![1.5_f64.ln(), 25.0_f64.ln(), 1.0] };
        let stop = Stop { size: 1e-4, spread: 1e-4, iterations: 150 };
        let starts = [0.05, 0.4, 0.6, 0.95].map(|share| [foam.both.0.ln(), foam.both.1.ln(), share]);
        let ends = starts.iter().map(|start| descend(&objective, &bounds, start, 0.1, stop));
        let best = ends.min_by(|a, b| a.value.total_cmp(&b.value)).map_or_else(|| starts[1].to_vec(), |end| end.point);
        let (truth, amount) = at(&best);
        let data = bench.pressed(truth, cause, amount);
        let table = bench.table_1(&data);
        let ratio = |depth_mm| {
            bench.identify(&data, [false, true], depth_mm).1 / bench.identify(&data, [true, false], depth_mm).1
        };
        Self {
            amount,
            truth,
            miss: apart(&table[..2], &foam.each),
            joint_miss: apart(&table[2..], &[foam.both]),
            table,
            ratios: [2.0, 3.0, DEPTH_MM].map(ratio),
        }
    }
}

/// Table 1 prints what a grid and a simplex with a coarse stop found; parameters within this (percent) count as reproduced.
const REPRODUCED: f64 = 5.0;

fn pair((mu, alpha): Pair) -> String {
    format!("{mu:.3} / {alpha:.1}")
}

fn row(cause: &Cause, found: &Found) -> Vec<String> {
    let amount = if cause.code == NOTHING { "-".to_owned() } else { format!("{:+.3} {}", found.amount, cause.unit) };
    vec![
        cause.name.to_owned(),
        amount,
        format!("{:.0}", found.miss),
        format!("{:.0}", found.joint_miss),
        pair(found.truth),
        pair(found.table[0]),
        pair(found.table[1]),
        pair(found.table[2]),
        found.ratios.map(|r| format!("{r:.2}")).join(", "),
    ]
}

fn plain(bench: &Bench, foam: &Foam) -> Vec<Vec<String>> {
    let one = |(at, amount): &(usize, f64)| {
        let cause = &CAUSES[*at];
        let [small, large, both] = bench.table_1(&bench.pressed(foam.both, cause, *amount));
        let change = |a: f64, b: f64| format!("{:+.0} %", 100.0 * (b / a - 1.0));
        vec![
            cause.name.to_owned(),
            format!("{amount:+} {}", cause.unit),
            pair(small),
            pair(large),
            pair(both),
            change(small.0, large.0),
            change(small.1, large.1),
        ]
    };
    PLAIN.par_iter().map(one).collect()
}

/// Draws of chance, and its seed.
const DRAWS: usize = 500;
const SEED: u64 = 1;

/// How far chance alone moves the exponents apart: sensor noise, contact points that differ between the balls, gain that does.
fn chance(bench: &Bench, foam: &Foam) -> Outcome<Vec<Vec<String>>> {
    // averages of three presses each
    let cases = [
        ("noise of 1 % of the peak a sample", 0.01, 0.0, 0.0),
        ("contact points scatter by 0.01 mm from press to press", 0.0, 0.01, 0.0),
        ("contact points scatter by 0.05 mm", 0.0, 0.05, 0.0),
        ("stiffness or gain scatters by 3 %", 0.0, 0.0, 0.03),
        ("noise of 1 %, contact 0.02 mm, stiffness 2 %", 0.01, 0.02, 0.02),
    ];
    let printed = (foam.each[1].1 / foam.each[0].1).ln();
    let root = 3.0_f64.sqrt();
    let late = &CAUSES[0];
    let unit = Normal::new(0.0, 1.0)?;
    let mut rows = Vec::new();
    for (what, noise, contact_mm, gain) in cases {
        let draw = |seed: usize| {
            let mut source = Pcg64::seed_from_u64(SEED + seed as u64);
            let mut data: [Vec<f64>; 2] = Default::default();
            for (ball, recorded) in data.iter_mut().enumerate() {
                let offset = contact_mm / root * unit.sample(&mut source);
                let factor = 1.0 + gain / root * unit.sample(&mut source);
                let mut curve = bench.pressed(foam.both, late, offset)[ball].clone();
                let peak = curve.last().copied().unwrap_or(0.0);
                curve.iter_mut().for_each(|f| *f = factor * *f + noise / root * peak * unit.sample(&mut source));
                *recorded = curve;
            }
            let [small, large, both] = bench.table_1(&data);
            let outside = both.1 < small.1.min(large.1);
            ((large.1 / small.1).ln(), outside)
        };
        let drawn: Vec<(f64, bool)> = (0..DRAWS).into_par_iter().map(draw).collect();
        let far = drawn.iter().filter(|(ratio, _)| ratio.abs() >= printed).count();
        let below = drawn.iter().filter(|(_, outside)| *outside).count();
        let spread = (drawn.iter().map(|(ratio, _)| ratio * ratio).sum::<f64>() / DRAWS as f64).sqrt();
        let share = |count: usize| format!("{:.0} %", 100.0 * count as f64 / DRAWS as f64);
        rows.push(vec![what.to_owned(), format!("{:.0} %", 100.0 * spread), share(far), share(below)]);
    }
    Ok(rows)
}

/// The section.
pub fn section(figures: &Path) -> Outcome<Option<String>> {
    let mut out = String::new();
    let mut parts = Vec::new();
    for foam in &FOAMS {
        let bench = Bench::of(foam)?;
        let goal = reported(&bench, foam);
        let joint = bench.identify(&goal, [true, true], DEPTH_MM);
        let one = bench.with(joint, None);
        out += &format!(
            "**{}**, {} mm. Table 1 (mu in MPa / alpha): {} from the ball of 4 mm, {} from that of 6 mm (mu {:+.0} %, alpha {:+.0} %), {} from both. The two curves that these single-ball parameters stand for are met by one material, {}, to {:.2} % of the peak (rms).

",
            foam.name,
            foam.height_mm,
            pair(foam.each[0]),
            pair(foam.each[1]),
            100.0 * (foam.each[1].0 / foam.each[0].0 - 1.0),
            100.0 * (foam.each[1].1 / foam.each[0].1 - 1.0),
            pair(foam.both),
            pair(joint),
            distance(&one, &goal),
        );
        out += "A plain amount of each cause, on a foam of the joint parameters:\n\n";
        out += &table(
            &["cause", "amount", "seen with 4 mm", "with 6 mm", "with both", "mu, 4 to 6 mm", "alpha, 4 to 6 mm"],
            &plain(&bench, foam),
        );
        out += "\nThe amount of each, and the material, that come nearest to Table 1's single-ball rows:\n\n";
        let mut found: Vec<(&Cause, Found)> =
            CAUSES.par_iter().map(|cause| (cause, Found::nearest(&bench, foam, cause))).collect();
        found.sort_by(|a, b| a.1.miss.total_cmp(&b.1.miss));
        let rows: Vec<Vec<String>> = found.iter().map(|(cause, one)| row(cause, one)).collect();
        out += &table(
            &[
                "cause",
                "amount",
                "misses both rows by (%)",
                "misses the joint row by (%)",
                "true mu / alpha",
                "seen with 4 mm",
                "with 6 mm",
                "with both",
                "alpha 6 mm over 4 mm, from 2, 3, 4 mm",
            ],
            &rows,
        );
        let close: Vec<&str> = found.iter().filter(|(_, f)| f.miss < REPRODUCED).map(|(c, _)| c.name).collect();
        out += &format!(
            "\nWithin {REPRODUCED} %: {}.\n\n",
            if close.is_empty() { "none".to_owned() } else { close.join("; ") }
        );
        out += "Chance alone, three presses averaged as in the thesis:\n\n";
        out += &table(
            &[
                "what scatters",
                "alphas of the balls differ by (rms)",
                "at least as much as in Table 1",
                "joint alpha below both",
            ],
            &chance(&bench, foam)?,
        );
        out += "\n";
        parts.push(drawing(foam, &found));
    }
    out += &picture(
        figures,
        "real-diagnosis-two-balls.svg",
        "Identified parameters, ball of 4 mm to ball of 6 mm",
        &parts,
    )?;
    Ok(Some(out))
}

/// Causes drawn: enough to see which lie on Table 1's arrow.
const DRAWN: usize = 4;

fn drawing(foam: &Foam, found: &[(&Cause, Found)]) -> Figure {
    let title = format!("{}: from the ball of 4 mm to that of 6 mm", foam.name);
    let mut figure = Figure::new(&title, Axis::new("mu (MPa)"), Axis::new("alpha"));
    figure.size = (900.0, 300.0);
    for (at, (cause, one)) in found.iter().take(DRAWN).enumerate() {
        let stroke = Stroke::LINES[at % Stroke::LINES.len()];
        figure = figure.with(Series::new(cause.name, one.table[..2].to_vec(), stroke, at + 1));
    }
    figure.with(Series::new("Table 1", foam.each.to_vec(), Stroke::Dots, 0))
}
