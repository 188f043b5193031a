//! Thesis Table 1: identified parameters depend on the ball. Its experiment is pressed again with each candidate cause, and identified as the
//! thesis did: one ball at a time, then both, by Eq. 14 with the contact taken as recorded.

use std::path::Path;

use lut_gen::chain::{Chain, Geometry, Library, Model, Need, Passage, Setting};
use lut_gen::effect::{self, Effect};
use lut_gen::model::Specimen;
use lut_gen::solve::Base;
use palpate::identify::simplex::{Bounds, Stop, descend};
use palpate::report::figure::{Axis, Figure, Series, Stroke};
use rand::SeedableRng;
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64;
use rayon::prelude::*;
use tests::document::table;

use super::{Outcome, picture};

/// Stroke of thesis section 2.6 at 1 mm/s and 50 Hz.
const DEPTH_MM: f64 = 4.0;
const SAMPLES: usize = 200;
const BALLS_MM: [f64; 2] = [4.0, 6.0];
/// Beyond the stroke: a contact found late, and what compliance adds.
const MARGIN_MM: f64 = 0.5;

/// mu (MPa) and alpha.
type Pair = (f64, f64);

/// A foam as Table 1 has it.
struct Foam {
    name: &'static str,
    /// Half an inch and three quarters: thesis section 5.4 tells the thickness of the same products, chapter 2 tells none.
    height_mm: f64,
    each: [Pair; 2],
    both: Pair,
}

const FOAMS: [Foam; 2] = [
    Foam { name: "EVA", height_mm: 12.7, each: [(0.220, 10.526), (0.278, 15.152)], both: (0.245, 12.424) },
    Foam { name: "B1", height_mm: 19.05, each: [(0.193, 12.711), (0.226, 15.173)], both: (0.188, 11.1564) },
];

/// A candidate: an effect of one parameter, the others held, with the range of its amount.
struct Cause {
    name: &'static str,
    code: &'static str,
    form: Option<&'static str>,
    owner: usize,
    /// Values of all parameters; the first is replaced by the amount.
    values: &'static [f64],
    range: (f64, f64),
    unit: &'static str,
}

const fn cause(
    name: &'static str,
    code: &'static str,
    values: &'static [f64],
    range: (f64, f64),
    unit: &'static str,
) -> Cause {
    Cause { name, code, form: None, owner: 0, values, range, unit }
}

/// Codes of causes that are no effect of the catalogue: nothing, and a stiffness that differs between the two balls' sessions.
const NOTHING: &str = "none";
const SESSION: &str = "session";

const CAUSES: [Cause; 17] = [
    cause("contact found late (+) or early (-)", "contact-offset", &[0.0], (-0.4, 0.4), "mm"),
    cause("slab higher (+) or lower (-) than in the model", "thickness", &[0.0], (-4.0, 5.0), "mm"),
    Cause { form: Some("sliding-base"), ..cause("base slides", "thickness", &[0.0], (0.0, 1.0), "of free") },
    cause("compliance of the machine", "compliance", &[0.0], (0.0, 0.2), "mm/N"),
    cause("ball of 4 mm larger (+) or smaller (-)", "radius", &[0.0], (-0.6, 0.6), "mm"),
    Cause { owner: 1, ..cause("ball of 6 mm larger (+) or smaller (-)", "radius", &[0.0], (-0.6, 0.6), "mm") },
    cause("friction", "friction", &[0.0], (0.0, 1.0), "coefficient"),
    cause("second term, alpha 3", "second-term", &[0.0, 3.0], (-0.3, 2.0), "of mu"),
    cause("second term, alpha 22", "second-term", &[0.0, 22.0], (-0.3, 2.0), "of mu"),
    cause("Poisson's ratio", "poisson", &[0.0], (0.0, 0.35), ""),
    cause("relaxation, 0.3 s", "relaxation", &[0.0, 0.3], (0.0, 0.8), "of mu"),
    cause("relaxation, 3 s", "relaxation", &[0.0, 3.0], (0.0, 0.8), "of mu"),
    cause("adhesion", "adhesion", &[0.0], (0.0, 0.05), "N/mm"),
    Cause { form: Some("filter"), ..cause("lag of the force reading", "lag", &[0.0], (0.0, 0.4), "s") },
    cause("sensor nonlinearity", "sensor-nonlinearity", &[0.0], (-0.05, 0.05), "1/N"),
    cause("foam, or gain, stiffer (+) under the ball of 6 mm", SESSION, &[0.0], (-0.3, 0.3), "of the force"),
    cause("none", NOTHING, &[0.0], (0.0, 0.0), ""),
];

impl Cause {
    fn setting(&self, amount: f64) -> Option<Setting> {
        let effect: &'static Effect = effect::find(self.code, self.form)?;
        let mut values = self.values.to_vec();
        values[0] = amount;
        Some(Setting { effect, owner: self.owner, values })
    }
}

/// Force curves of a foam under both balls.
struct Bench {
    chain: Chain,
    depths: Vec<f64>,
    /// Exponents, and the curves of unit modulus at each.
    units: Vec<(f64, [Vec<f64>; 2])>,
}

/// Exponents of the force models, and how many curves an identification chooses from: 0.7 % of the exponent apart.
const LOW: f64 = 1.8;
const HIGH: f64 = 26.0;
const UNITS: usize = 400;
/// First look at every so many of them.
const COARSE: usize = 16;

impl Bench {
    fn of(foam: &Foam) -> Outcome<Self> {
        let specimen = Specimen { height_mm: foam.height_mm, radius_mm: 36.0, base: Base::Bonded };
        let one = |ball_mm| Geometry { specimen, ball_mm, depth_mm: DEPTH_MM + MARGIN_MM, nu: 0.0 };
        let library = Library::build(&BALLS_MM.map(one), Need { effects: true }, &|_, _| {})?;
        let depths: Vec<f64> = (0..=SAMPLES).map(|k| DEPTH_MM * k as f64 / SAMPLES as f64).collect();
        let passage = |at: usize| Passage {
            time_s: depths.clone(),
            depth_mm: depths.clone(),
            geometry: at,
            indenter: at,
            ..Passage::default()
        };
        let chain = Chain { library, passages: vec![passage(0), passage(1)] };
        let mut bench = Self { chain, depths, units: Vec::new() };
        let alpha = |k: usize| (LOW.ln() + (HIGH / LOW).ln() * k as f64 / (UNITS - 1) as f64).exp();
        bench.units = (0..UNITS).map(|k| (alpha(k), bench.with((1.0, alpha(k)), None))).collect();
        Ok(bench)
    }

    fn with(&self, (mu_mpa, alpha): Pair, setting: Option<Setting>) -> [Vec<f64>; 2] {
        let mut model = Model::base(mu_mpa, alpha);
        model.settings.extend(setting);
        let mut both = self.chain.predict(&model, &[0.0, 0.0]).into_iter();
        [both.next().unwrap_or_default(), both.next().unwrap_or_default()]
    }

    /// Recordings of a material with an amount of a cause.
    fn pressed(&self, truth: Pair, cause: &Cause, amount: f64) -> [Vec<f64>; 2] {
        let mut curves = self.with(truth, cause.setting(amount));
        if cause.code == SESSION {
            curves[1].iter_mut().for_each(|force| *force *= 1.0 + amount);
        }
        curves
    }

    /// Eq. 14 with the best modulus at one exponent, over the curves that are asked for and up to a depth: for a sum of absolute
    /// differences that is a weighted median of force ratios.
    fn eq14(&self, data: &[Vec<f64>; 2], asked: [bool; 2], unit: usize, depth_mm: f64) -> (f64, f64) {
        let mut ratios: Vec<(f64, f64, f64)> = Vec::new();
        for ball in (0..2).filter(|ball| asked[*ball]) {
            let samples = self.depths.iter().zip(&self.units[unit].1[ball]).zip(&data[ball]);
            ratios
                .extend(samples.filter(|((d, f), _)| **d <= depth_mm && **f > 0.0).map(|((_, f), y)| (y / f, *f, *y)));
        }
        ratios.sort_by(|a, b| a.0.total_cmp(&b.0));
        let half = 0.5 * ratios.iter().map(|r| r.1).sum::<f64>();
        let mut sum = 0.0;
        let middle = ratios.iter().find(|r| {
            sum += r.1;
            sum >= half
        });
        let mu = middle.map_or(f64::NAN, |r| r.0);
        (ratios.iter().map(|(_, f, y)| (mu * f - y).abs()).sum(), mu)
    }

    /// The thesis' identification: the least of Eq. 14.
    fn identify(&self, data: &[Vec<f64>; 2], asked: [bool; 2], depth_mm: f64) -> Pair {
        let value = |unit: usize| self.eq14(data, asked, unit, depth_mm).0;
        let least = |units: &mut dyn Iterator<Item = usize>| {
            units.map(|unit| (unit, value(unit))).min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |best| best.0)
        };
        let near = least(&mut (0..UNITS).step_by(COARSE));
        let best = least(&mut (near.saturating_sub(COARSE)..(near + COARSE + 1).min(UNITS)));
        (self.eq14(data, asked, best, depth_mm).1, self.units[best].0)
    }

    /// From the ball of 4 mm, from that of 6 mm, from both.
    fn table_1(&self, data: &[Vec<f64>; 2]) -> [Pair; 3] {
        [[true, false], [false, true], [true, true]].map(|asked| self.identify(data, asked, DEPTH_MM))
    }
}

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

/// Root mean square of the difference of two sets of curves, percent of each peak.
fn distance(a: &[Vec<f64>; 2], b: &[Vec<f64>; 2]) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for (x, y) in a.iter().zip(b) {
        let peak = y.iter().copied().fold(0.0, f64::max);
        sum += x.iter().zip(y).map(|(x, y)| ((x - y) / peak).powi(2)).sum::<f64>();
        count += x.len() as f64;
    }
    100.0 * (sum / count).sqrt()
}

/// Root mean square of the relative differences of pairs, percent.
fn apart(found: &[Pair], printed: &[Pair]) -> f64 {
    let square = |a: f64, b: f64| (a / b).ln().powi(2);
    let each = found.iter().zip(printed).map(|(f, p)| square(f.0, p.0) + square(f.1, p.1));
    100.0 * (each.sum::<f64>() / (2 * found.len()) as f64).sqrt()
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

/// What a plain amount of each cause does to a foam of the joint parameters: change of alpha and mu from ball to ball.
const PLAIN: [(usize, f64); 17] = [
    (0, 0.05),
    (1, 2.0),
    (1, -2.0),
    (2, 1.0),
    (3, 0.02),
    (4, -0.2),
    (5, 0.2),
    (6, 0.3),
    (7, 0.3),
    (8, 0.1),
    (9, 0.1),
    (10, 0.3),
    (11, 0.3),
    (12, 5e-4),
    (13, 0.03),
    (14, 0.002),
    (15, 0.05),
];

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
            for ball in 0..2 {
                let offset = contact_mm / root * unit.sample(&mut source);
                let factor = 1.0 + gain / root * unit.sample(&mut source);
                let mut curve = bench.pressed(foam.both, late, offset)[ball].clone();
                let peak = curve.last().copied().unwrap_or(0.0);
                curve.iter_mut().for_each(|f| *f = factor * *f + noise / root * peak * unit.sample(&mut source));
                data[ball] = curve;
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
