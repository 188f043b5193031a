//! What a model may be wrong by without a name: smooth functions of what was varied, as a share of
//! the force.
//!
//! | group | over | for |
//! |---|---|---|
//! | depth, size | depth, and the root of depth times radius | every run alike |
//! | way back, hold | depth on the way back; the logarithm of time in a hold | every run alike |
//! | rate, ball, specimen, cycle, spot | depth, anew for each | runs that share it |
//! | session, session zero | the start of a run on the clock | every run, as a gain, and as a share of the largest force |

use nalgebra::DMatrix;
use rayon::prelude::*;

use crate::diagnose::design::{Branch, Design, Node, Series};
use crate::diagnose::fit::Problem;
use crate::diagnose::noise::Curve;
use crate::infer::evidence::Sizes;
use crate::infer::process::Shapes;
use crate::infer::sets::{Group, Groups, Kind};

/// Size of a discrepancy, as a share of the force: as often above as below, and a factor of 2.7 to
/// either side. Simulations of soft solids agree with tests to about a percent.
const SIZE: (f64, f64) = (0.005, 1.0);
/// Correlation length of what all runs share: a quarter of the depth.
const COMMON: f64 = 0.25;
/// Of what is anew for each ball, rate, specimen, cycle or spot: half of the depth.
const EACH: f64 = 0.5;
/// Of a gain over the session.
const SESSION: f64 = 0.3;

/// Name of what is anew for each spot.
const SPOT: &str = "spot";
/// Name of what is no share of the force of the moment but of the largest: the zero that wanders.
const ZERO: &str = "session zero";

/// Where a node lies in a group.
struct Place {
    /// In [0, 1].
    u: f64,
    /// Where the group begins from nothing: forces are continuous, and so is what a model may be
    /// wrong by when the indenter stops or turns.
    from: Option<f64>,
    /// The level that has shapes of its own.
    level: usize,
}

/// The place of a node; none where the group is nothing.
type Placed<'a> = Box<dyn Fn(&Series, &Node) -> Option<Place> + Send + Sync + 'a>;

/// What runs of one level share.
type Level = fn(&Series) -> i64;
/// A group: its name, the length of its shapes, its levels, and where a node lies.
type Varied<'a> = (&'static str, f64, usize, Placed<'a>);

/// Groups that a design has, at forces that a base predicts. They scale with these and not with a
/// curve through the data: `mu` and a size of one against each other would then be what the data
/// differ by from the prediction, and explain themselves.
pub(super) fn groups(problem: &Problem<'_>, curves: &[Curve]) -> Groups {
    let design = problem.design;
    let made = |(over, length, levels, place): Varied<'_>| {
        let shapes = Shapes::new(length);
        let largest_n = problem.largest_n();
        let mut columns = DMatrix::zeros(problem.whitening.residuals(), levels * shapes.len());
        for (s, series) in design.series.iter().enumerate() {
            for (k, node) in series.nodes.iter().enumerate() {
                let row = problem.whitening.first(s) + k;
                let Some(Place { u, from, level }) = place(series, node).filter(|_| problem.used[row]) else {
                    continue;
                };
                for shape in 0..shapes.len() {
                    let before = from.map_or(0.0, |from| shapes.at(shape, from));
                    let own = shapes.at(shape, u) - before;
                    let force_n = if over == ZERO { largest_n } else { curves[s].force_n[k] };
                    columns[(row, level * shapes.len() + shape)] = force_n * own;
                }
            }
        }
        let readings = columns.clone();
        problem.whitening.apply_to(&mut columns);
        let kind = if over == SPOT { Kind::Scatter } else { Kind::Misfit };
        Group { over, kind, readings, columns }
    };
    let each = places(design).into_par_iter().map(made).filter(|group| group.columns.amax() > 0.0).collect();
    Groups::new(problem.whitening.residuals(), each, Sizes::about(SIZE.0, SIZE.1))
}

fn everywhere(u: f64, level: usize) -> Option<Place> {
    Some(Place { u, from: None, level })
}

/// On one branch only, from where it begins.
fn from(node: &Node, branch: Branch, u: f64, from: f64) -> Option<Place> {
    (node.branch == branch).then_some(Place { u, from: Some(from), level: 0 })
}

fn places(design: &Design) -> Vec<Varied<'_>> {
    let nodes = || design.series.iter().flat_map(|s| s.nodes.iter().map(move |n| (s, n)));
    let most = |of: &dyn Fn(&Series, &Node) -> f64| nodes().map(|(s, n)| of(s, n)).fold(f64::MIN_POSITIVE, f64::max);
    let size = |s: &Series, n: &Node| (design.geometries[s.geometry].ball_mm * n.depth_mm.max(0.0)).sqrt();
    let deepest = most(&|_, n| n.depth_mm);
    let largest = most(&size);
    let first_s = nodes().map(|(_, n)| n.held_s).filter(|t| *t > 0.0).fold(f64::INFINITY, f64::min);
    let late = move |held_s: f64| (held_s / first_s).ln_1p();
    let latest = most(&|_, n| late(n.held_s));
    let started = |s: &Series| s.start_s.unwrap_or(0.0);
    let session = most(&|s, _| started(s));
    let depth = move |n: &Node| n.depth_mm / deepest;
    let turn = move |s: &Series| s.nodes.iter().map(depth).fold(0.0, f64::max);
    let mut all: Vec<Varied<'_>> = vec![
        ("depth", COMMON, 1, Box::new(move |_, n| everywhere(depth(n), 0))),
        ("contact size", COMMON, 1, Box::new(move |s, n| everywhere(size(s, n) / largest, 0))),
        ("way back", COMMON, 1, Box::new(move |s, n| from(n, Branch::Unloading, depth(n), turn(s)))),
        ("hold", COMMON, 1, Box::new(move |_, n| from(n, Branch::Hold, late(n.held_s) / latest, 0.0))),
        ("session", SESSION, 1, Box::new(move |s, _| everywhere(started(s) / session, 0))),
    ];
    if design.series.iter().all(|s| s.start_s.is_some()) {
        // the zero is taken before the first run
        let place = move |s: &Series, _: &Node| Some(Place { u: started(s) / session, from: Some(0.0), level: 0 });
        all.push((ZERO, SESSION, 1, Box::new(place)));
    }
    let each: [(&'static str, Level); 5] = [
        ("rate", |s| s.rate as i64),
        ("ball", |s| s.indenter as i64),
        ("specimen", |s| s.specimen as i64),
        ("cycle", |s| s.cycle),
        (SPOT, |s| s.spot as i64),
    ];
    for (over, of) in each {
        let mut levels: Vec<i64> = design.series.iter().map(of).collect();
        levels.sort_unstable();
        levels.dedup();
        if levels.len() > 1 {
            let count = levels.len();
            let level = move |s: &Series| levels.binary_search(&of(s)).unwrap_or(0);
            all.push((over, EACH, count, Box::new(move |s, n| everywhere(depth(n), level(s)))));
        }
    }
    all
}
