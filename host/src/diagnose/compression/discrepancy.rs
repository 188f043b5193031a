//! What a law may be wrong by in compression without a name: smooth functions of what was varied, as a share
//! of the force.
//!
//! | group | over | for |
//! |---|---|---|
//! | shortening | the share of the height | every run alike |
//! | way back, hold | the same on the way back; the logarithm of time in a hold | every run alike |
//! | compression | the share of the height, anew for each that repeats no other | repeats of it |

use lut_gen::chain::Model;
use nalgebra::DMatrix;

use super::super::check::{Check, Coupon};
use super::super::design::{Branch, Node};
use super::super::fit::Problem;
use crate::infer::evidence::Sizes;
use crate::infer::process::Shapes;
use crate::infer::sets::{Group, Groups, Kind};

/// Size of a discrepancy, as a share of the force: as often above as below, and a factor of 2.7 to either
/// side. Laws of two parameters miss foams that are shortened by half by several percent.
const SIZE: (f64, f64) = (0.02, 1.0);
/// Correlation lengths of what all runs share, and of what is anew for each.
const COMMON: f64 = 0.25;
const EACH: f64 = 0.5;

/// Where a window lies: in [0, 1], and from where it begins from nothing.
type Placed<'a> = Box<dyn Fn(usize, &Node) -> Option<(f64, Option<f64>)> + 'a>;

/// All groups of some compressions, at the forces that a base predicts: of those that were read, a modulus of
/// nothing would be explained by itself.
pub(super) fn groups(problem: &Problem<'_>, base: &Model) -> Groups {
    let forces_n: Vec<f64> = problem.design.checks.iter().flat_map(|check| check.predicted(base)).collect();
    let coupons: Vec<&Coupon> = problem.design.checks.iter().filter_map(Check::coupon).collect();
    let nodes = || coupons.iter().flat_map(|c| c.nodes());
    let deepest = nodes().map(|n| n.depth_mm).fold(f64::MIN_POSITIVE, f64::max);
    let first_s = nodes().map(|n| n.held_s).filter(|t| *t > 0.0).fold(f64::INFINITY, f64::min);
    let late = move |held_s: f64| (held_s / first_s).ln_1p();
    let latest = nodes().map(|n| late(n.held_s)).fold(f64::MIN_POSITIVE, f64::max);
    let turns: Vec<f64> =
        coupons.iter().map(|c| c.nodes().iter().map(|n| n.depth_mm / deepest).fold(0.0, f64::max)).collect();
    let mut kinds: Vec<usize> = Vec::new();
    for (at, own) in coupons.iter().enumerate() {
        kinds.push(coupons[..at].iter().position(|before| own.repeats(before)).map_or(at, |first| kinds[first]));
    }
    let mut levels = kinds.clone();
    levels.dedup();
    let share = move |n: &Node| n.depth_mm / deepest;
    let branch = |n: &Node, is: Branch| n.branch == is;
    let mut all: Vec<(&'static str, f64, usize, Placed<'_>)> = vec![
        ("shortening", COMMON, 1, Box::new(move |_, n| Some((share(n), None)))),
        ("way back", COMMON, 1, Box::new(|at, n| branch(n, Branch::Unloading).then(|| (share(n), Some(turns[at]))))),
        (
            "hold",
            COMMON,
            1,
            Box::new(move |_, n| branch(n, Branch::Hold).then(|| (late(n.held_s) / latest, Some(0.0)))),
        ),
    ];
    if levels.len() > 1 {
        all.push(("compression", EACH, coupons.len(), Box::new(move |_, n| Some((share(n), None)))));
    }
    let made = |(over, length, count, place): (&'static str, f64, usize, Placed<'_>)| {
        let shapes = Shapes::new(length);
        let mut readings = DMatrix::zeros(problem.whitening.residuals(), count * shapes.len());
        for (at, coupon) in coupons.iter().enumerate() {
            let first = problem.rows_of_check(at).start;
            for (k, node) in coupon.nodes().iter().enumerate().filter(|(k, _)| problem.used[first + k]) {
                let Some((u, from)) = place(at, node) else { continue };
                let level = if count > 1 { kinds[at] } else { 0 };
                for shape in 0..shapes.len() {
                    let before = from.map_or(0.0, |from| shapes.at(shape, from));
                    readings[(first + k, level * shapes.len() + shape)] =
                        forces_n[first + k].max(0.0) * (shapes.at(shape, u) - before);
                }
            }
        }
        let mut columns = readings.clone();
        problem.whitening.apply_to(&mut columns);
        Group { over, kind: Kind::Misfit, readings, columns }
    };
    let each = all.into_iter().map(made).filter(|group| group.columns.amax() > 0.0).collect();
    Groups::new(problem.whitening.residuals(), each, Sizes::about(SIZE.0, SIZE.1))
}
