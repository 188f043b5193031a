//! Readings that would decide: among what a laboratory can read next, what puts likely sets farthest apart,
//! or shows what these readings are blind to.

use nalgebra::DVector;

use super::Diagnosis;
use super::fit::{Fit, Judged, Law, Problem, Weighed};
use super::forward::Search;
use super::readings::{Reading, Table};
use crate::calibration::distribution::student_critical;
use crate::calibration::polynomial::Polynomial;
use crate::infer::lowrank;
use crate::magnet::uncertain::PARTS;

/// Readings and what they would tell.
#[derive(Debug, Clone, PartialEq)]
pub struct Proposal {
    /// What to do.
    pub what: String,
    /// Codes that it separates or shows.
    pub decides: Vec<&'static str>,
    /// Distance in standard deviations; none where it is noise that is to be found.
    pub distance: Option<f64>,
}

/// Proposals that are told, and the distance below which readings decide nothing.
const MOST: usize = 3;
const LEAST: f64 = 3.0;
/// Probability from which on a set is a rival.
const LIKELY: f64 = 0.05;
/// Level at which a difference counts, and the deviations that find it in nine cases of ten.
const LEVEL: f64 = 0.05;
const POWER: f64 = 1.28;

/// Passes over the same x that show a coefficient of this size in nine cases of ten.
#[must_use]
pub fn passes(of: &Polynomial, power: usize, points: usize) -> usize {
    let (size, error) = of.coefficients[power];
    let shows = |n: &usize| {
        let freedom = (n * points).saturating_sub(of.coefficients.len()).max(1) as f64;
        size.abs() / (error / (*n as f64).sqrt()) >= student_critical(LEVEL, freedom) + POWER
    };
    (1..1000).find(shows).unwrap_or(1000)
}

/// What to do first where nothing is known of the noise.
pub(super) fn without_noise(found: &Diagnosis) -> Vec<Proposal> {
    let table = &found.table;
    let mut what = format!("read all {} x again, up and down, three times in all", table.places.len());
    let told =
        if table.is_simulated { found.line.as_ref().map(|p| (p, 1)) } else { found.parabola.as_ref().map(|p| (p, 2)) };
    if let Some((of, power)) = told {
        let count = passes(of, power, table.readings.len());
        let name = if power == 1 { "difference of the slopes" } else { "curvature" };
        what += &format!(" (a {name} of the size seen here shows in nine cases of ten with {count} passes)");
    }
    vec![Proposal { what, decides: vec!["noise"], distance: None }]
}

/// Proposals, the best first.
pub(super) fn proposals(
    search: &Search<'_>,
    sets: &[Weighed],
    judged: &Judged,
    blind: &[&'static str],
) -> Vec<Proposal> {
    let each = sets.iter().zip(&judged.members).zip(&judged.sets);
    let rivals: Vec<(&Weighed, &Vec<&'static str>)> = each.filter(|(_, p)| **p > LIKELY).map(|(set, _)| set).collect();
    let mut list = Vec::new();
    for (what, table) in planned(search.problem.table) {
        let (decides, distance) = match rivals.as_slice() {
            [(best, own), others @ ..] if !others.is_empty() => apart(search, (best, own), others, &table),
            _ => shown(search, blind, &table),
        };
        if distance > LEAST {
            list.push(Proposal { what, decides, distance: Some(distance) });
        }
    }
    list.sort_by(|a, b| b.distance.unwrap_or(0.0).total_cmp(&a.distance.unwrap_or(0.0)));
    list.truncate(MOST);
    list
}

type Named<'a> = (&'a Weighed, &'a Vec<&'static str>);

/// Smallest distance between the likeliest set and others of another name.
fn apart(search: &Search<'_>, (best, own): Named<'_>, others: &[Named<'_>], table: &Table) -> (Vec<&'static str>, f64) {
    let (mut decides, mut least) = (own.clone(), f64::INFINITY);
    for (rival, codes) in others.iter().filter(|(_, codes)| *codes != own) {
        least = least.min(distance(search, &best.fit.law, &rival.fit, table));
        decides.extend(codes.iter().filter(|code| !own.contains(code)));
    }
    decides.sort_unstable();
    decides.dedup();
    (decides, if least.is_finite() { least } else { 0.0 })
}

/// Largest distance that a plausible amount of a blind spot would have from the base.
fn shown(search: &Search<'_>, blind: &[&'static str], table: &Table) -> (Vec<&'static str>, f64) {
    let (mut decides, mut most) = (Vec::new(), 0.0_f64);
    for effect in super::effect::CATALOGUE.into_iter().filter(|e| blind.contains(&e.code) && (e.is_possible)(table)) {
        let values = effect.quantities.iter().map(|q| q.plausible).collect();
        let far = distance(search, &search.base.law.with(effect, values), &search.base, table);
        if far > LEAST && !decides.contains(&effect.code) {
            decides.push(effect.code);
        }
        most = most.max(far);
    }
    (decides, most)
}

/// Standard deviations between what a law and a set have for planned readings, the set's parameters free
/// within what the readings so far left open.
fn distance(search: &Search<'_>, truth: &Law, rival: &Fit, table: &Table) -> f64 {
    let problem = Problem { table, sigma: search.problem.sigma, used: vec![true; table.readings.len()] };
    let there: Vec<f64> = table.readings.iter().map(|r| truth.predict(table, r)).collect();
    let mut told = table.clone();
    told.readings.iter_mut().zip(there).for_each(|(r, y)| r.y = y);
    let problem = Problem { table: &told, ..problem };
    let difference: DVector<f64> = problem.plain(&rival.law) / problem.sigma;
    let jacobian = problem.jacobian_of(rival);
    lowrank::apart(&difference, &jacobian, &rival.jacobian)
}

/// What can be read next, scaled to the table. Levels and spans are those of the table so far.
fn planned(table: &Table) -> Vec<(String, Table)> {
    let ends = (table.places[0], table.places[table.places.len() - 1]);
    let x = |share: f64| ends.0 + share * table.range;
    let level_of = |r: &Reading| r.level;
    // of a simulation the levels between places are on a straight line
    let nearest = |at: f64| {
        let by = |r: &&Reading| (r.x - at).abs();
        table.readings.iter().min_by(|a, b| by(a).total_cmp(&by(b)))
    };
    let made = |shares: &[f64], rest_s: f64| {
        let mut before: Option<f64> = None;
        let count = shares.len().max(2) as f64 - 1.0;
        let rows = shares.iter().enumerate().map(|(k, share)| {
            let way = before.map_or(0.0, |b: f64| (share - b).signum());
            before = Some(*share);
            let at = x(*share);
            let simulated = table.is_simulated.then(|| nearest(at).and_then(|r| r.simulated)).flatten();
            let level = if table.is_simulated { nearest(at).map_or(*share, level_of) } else { *share };
            let built = nearest(at).map_or([0.0; PARTS.len()], |r| r.built);
            Reading { x: at, y: 0.0, simulated, built, level, way, order: k as f64 / count, rest_s, place: 0, file: 0 }
        });
        Table { readings: rows.collect(), has_time: table.has_time || rest_s > 0.0, ..table.clone() }
    };
    let own: Vec<f64> = table.places.iter().map(|place| (place - ends.0) / table.range).collect();
    let back: Vec<f64> = own.iter().rev().copied().collect();
    let loops = [own.clone(), back[1..].to_vec()].concat();
    let three = |once: &[f64]| [once, once, once].concat();
    let small: Vec<f64> = loops.iter().map(|share| 0.4 * share).collect();
    let told = |at: f64| format!("{at:.3}");
    let mut all = vec![
        ("read all x three times more, upwards".to_owned(), made(&three(&own), 0.0)),
        ("read all x three times up and down".to_owned(), made(&three(&loops), 0.0)),
        (
            format!("read up and down to {} only, three times, beside the whole loop", told(x(0.4))),
            made(&three(&[small, loops].concat()), 0.0),
        ),
        ("read all x three times downwards".to_owned(), made(&three(&back), 0.0)),
    ];
    if !table.is_simulated {
        let beyond: Vec<f64> = own.iter().map(|share| 1.5 * share).collect();
        all.push((format!("read on to {}, half as far again, three times", told(x(1.5))), made(&three(&beyond), 0.0)));
    }
    if table.has_time {
        all.push((
            format!("hold {} for a minute before each of three readings", told(ends.1)),
            made(&[0.0, 1.0, 1.0, 1.0], 60.0),
        ));
    }
    all
}
