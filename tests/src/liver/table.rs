//! The forward problem of all seeds, solved once at points that fill the box of a fit, and denser around the truth.

use std::fmt::Write as _;
use std::path::Path;
use std::sync::Arc;

use lut_gen::solid::model::Resolution;
use palpate::experiment::Experiment;
use palpate::identify::data::Selection;
use palpate::identify::newton::condition::{Condition, Source};
use palpate::identify::newton::coordinate::{Kind, Unknown};
use palpate::identify::newton::fit::MESH_ERROR;
use palpate::identify::newton::problem::Problem;
use palpate::identify::newton::setup;
use palpate::identify::newton::surrogate::Node;
use palpate::identify::newton::table::Table;
use palpate::identify::{data, motions};
use palpate::infer::descent::Region;
use palpate::infer::starts::filling;
use rayon::prelude::*;

use super::{DEPTH_MM, TRUTH};
use crate::tissue::six;

/// Solves over the whole box of a fit, and around the truth.
const WIDE: usize = 64;
const CLOSE: usize = 96;
/// A bulk softer than this is far outside of what the data leave open.
const MOST_D_MU: f64 = 0.1;
/// Of the latter so many are kept out of the table, to tell how exact it is.
const CHECKS: usize = 16;

/// The runs of an experiment that a fit of all six uses.
#[must_use]
pub fn selection(experiment: &Experiment) -> Selection {
    data::select(experiment, &motions(experiment), "specimen", true)
}

/// The problem of a fit whose condition is pressed to the depth that is true.
#[must_use]
pub fn problem<'a>(experiment: &Experiment, selection: &'a Selection) -> Problem<'a> {
    let source = |_: &Condition| Source::Solves(Resolution::Standard);
    let mut problem = setup::problem(experiment, selection, "specimen", &six(), &source);
    let unknowns = problem.unknowns.clone();
    for condition in &mut problem.conditions {
        condition.depth_mm = DEPTH_MM;
        condition.attach(&unknowns);
    }
    problem
}

/// Where it is solved: over the box of a fit, then where the data leave a choice, the bulk open.
fn design(unknowns: &[Unknown]) -> Vec<Vec<f64>> {
    let local = || unknowns.iter().filter(|u| u.kind != Kind::Modulus);
    let wide = Region::of(local().map(Unknown::bounds));
    let near = |u: &Unknown| match u.kind {
        Kind::Alpha(_) => ((0.9 * TRUTH.alpha).ln(), (1.1 * TRUTH.alpha).ln()),
        Kind::G(_) => (TRUTH.g - 0.03, TRUTH.g + 0.03),
        Kind::Tau(_) => ((0.9 * TRUTH.tau_s).ln(), (1.1 * TRUTH.tau_s).ln()),
        Kind::Compressibility => (u.bounds().0, MOST_D_MU.ln()),
        _ => u.bounds(),
    };
    let near = Region::of(local().map(near));
    let mut points = filling(&near, CLOSE);
    points.extend(filling(&wide, WIDE));
    points
}

/// The table, from a file where solves are kept from run to run; and its largest error at points left out, as a part of the peak force.
///
/// # Errors
/// When the file cannot be written.
pub fn table(
    experiment: &Experiment,
    kept: &Path,
    told: &(dyn Fn(usize) + Sync),
) -> std::io::Result<(Arc<Table>, f64)> {
    let selection = selection(experiment);
    let problem = problem(experiment, &selection);
    let condition = problem.conditions.first().ok_or_else(|| std::io::Error::other("the experiment has no run"))?;
    let points = design(&problem.unknowns);
    let mut nodes: Vec<Node> =
        std::fs::read_to_string(kept).map(|text| text.lines().filter_map(read).collect()).unwrap_or_default();
    let missing: Vec<&Vec<f64>> =
        points.iter().filter(|point| !nodes.iter().any(|node| same(&node.x, point))).collect();
    for part in missing.chunks(8) {
        let solve = |local: &&Vec<f64>| {
            let mut point = vec![0.0; problem.unknowns.len()];
            condition.locals.iter().zip(local.iter()).for_each(|(at, x)| point[*at] = *x);
            condition.solve(&problem.base, &problem.unknowns, &point).ok().map(|(node, _)| node)
        };
        nodes.extend(part.par_iter().filter_map(solve).collect::<Vec<_>>());
        std::fs::write(kept, nodes.iter().map(written).collect::<String>())?;
        told(nodes.len());
    }
    let is_check = |node: &Node| points.iter().take(CHECKS).any(|point| same(point, &node.x));
    let (checks, used): (Vec<Node>, Vec<Node>) = nodes.into_iter().partition(is_check);
    let table = Table::of(condition, used, MESH_ERROR);
    let worst = checks.iter().map(|node| {
        let values = table.at(&node.x).unwrap_or_default();
        values.iter().zip(&node.value).map(|(a, b)| (a - b).exp_m1().abs()).fold(0.0, f64::max)
    });
    let worst = worst.fold(0.0, f64::max);
    Ok((Arc::new(table), worst))
}

fn same(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9)
}

/// A solve in one line: number of coordinates, coordinates, values, derivatives.
fn written(node: &Node) -> String {
    let mut line = node.x.len().to_string();
    for value in node.x.iter().chain(&node.value).chain(node.by.iter().flatten()) {
        // writing to a text cannot fail
        let _ = write!(line, " {value:e}");
    }
    line + "\n"
}

fn read(line: &str) -> Option<Node> {
    let (count, rest) = line.split_once(' ')?;
    let count: usize = count.parse().ok()?;
    let numbers: Vec<f64> = rest.split(' ').map(str::parse).collect::<Result<_, _>>().ok()?;
    let values = (numbers.len().checked_sub(count)?) / (count + 1);
    let (x, rest) = numbers.split_at(count);
    let (value, by) = rest.split_at(values);
    Some(Node { x: x.to_vec(), value: value.to_vec(), by: by.chunks(values).map(<[f64]>::to_vec).collect() })
}
