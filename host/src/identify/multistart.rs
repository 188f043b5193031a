//! MultiStart of thesis section 2.7: grid, threshold, candidate starts, simplex from each,
//! comparison of the ends.

use rayon::prelude::*;

use super::objective::{self, ALPHA, LN_MU, Objective};
use super::simplex::{self, Bounds, Descent, Stop};

/// Points of the grid over alpha and over ln mu (the thesis uses 12 x 12 for one term).
pub const GRID: usize = 12;
/// Points over each free height.
const HEIGHTS: usize = 3;
/// Share of the grid's points that lie under the threshold E_th of step (b).
const THRESHOLD_SHARE: f64 = 0.15;
/// Most simplex searches.
const STARTS: usize = 8;
/// First edge of a simplex as a share of the box, and that of restarts from its end.
const EDGE: f64 = 0.08;
const RESTART_EDGE: f64 = 0.02;
const RESTARTS: usize = 6;
/// Relative gain below which no further simplex is started.
const WORTHWHILE: f64 = 1e-4;
const STOP: Stop = Stop { size: 1e-6, spread: 1e-9, iterations: 400 };

/// The objective over (alpha, mu), with free heights at their best grid value.
#[derive(Debug, Clone, PartialEq)]
pub struct Map {
    /// Alpha of the columns.
    pub alpha: Vec<f64>,
    /// mu in MPa of the rows.
    pub mu_mpa: Vec<f64>,
    /// Objective in N, `value[row][column]`.
    pub value: Vec<Vec<f64>>,
    /// E_th of step (b), N.
    pub threshold: f64,
}

/// All that MultiStart found.
#[derive(Debug, Clone)]
pub struct Search {
    /// Objective map.
    pub map: Map,
    /// The box searched.
    pub bounds: Bounds,
    /// Every start with its path, best end first.
    pub descents: Vec<Descent>,
}

/// Runs the five steps; `None` if no alpha of the grid gives a positive mu.
pub fn search(objective: &Objective<'_>) -> Option<Search> {
    let bounds = bounds(objective)?;
    let (map, points) = grid(objective, &bounds);
    let starts = starts(&points, &bounds, map.threshold);
    let mut descents: Vec<Descent> = starts.par_iter().map(|start| descent(objective, &bounds, start)).collect();
    descents.sort_by(|a, b| a.value.total_cmp(&b.value));
    Some(Search { map, bounds, descents })
}

/// Box of the parameters: alpha and heights as the model covers them, mu a factor of three beyond
/// what single alphas ask for.
fn bounds(objective: &Objective<'_>) -> Option<Bounds> {
    let (alpha_low, alpha_high) = objective.model.alpha_bounds();
    let heights = &objective.selection.heights;
    let mut low = vec![alpha_low, 0.0];
    let mut high = vec![alpha_high, 0.0];
    low.extend(heights.iter().map(|height| height.low_mm));
    high.extend(heights.iter().map(|height| height.high_mm));
    let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
    for share in [0.0, 0.25, 0.5, 1.0] {
        for height_share in [0.0, 1.0] {
            let mut point = low.clone();
            point[ALPHA] += share * (alpha_high - alpha_low);
            for axis in objective::FIRST_HEIGHT..point.len() {
                point[axis] += height_share * (high[axis] - low[axis]);
            }
            let curves = objective.unit_curves(&point);
            if let Some(mu) = objective::best_mu(objective.selection, &curves) {
                least = least.min(mu);
                most = most.max(mu);
            }
        }
    }
    if most <= 0.0 {
        return None;
    }
    low[LN_MU] = (least / 3.0).ln();
    high[LN_MU] = (most * 3.0).ln();
    Some(Bounds { low, high })
}

/// A grid point: its cell in (alpha, mu), its parameters and its objective.
struct GridPoint {
    cell: (usize, usize),
    point: Vec<f64>,
    value: f64,
}

/// Step (a), and the threshold of step (b).
fn grid(objective: &Objective<'_>, bounds: &Bounds) -> (Map, Vec<GridPoint>) {
    let axis =
        |at: usize, i: usize, count: usize| bounds.low[at] + bounds.side(at) * i as f64 / (count - 1).max(1) as f64;
    let free = bounds.low.len() - objective::FIRST_HEIGHT;
    let heights = HEIGHTS.pow(u32::try_from(free).unwrap_or(u32::MAX).min(4));
    let columns: Vec<(usize, usize)> = (0..GRID).flat_map(|a| (0..heights).map(move |h| (a, h))).collect();
    let all: Vec<GridPoint> = columns
        .par_iter()
        .flat_map_iter(|&(a, h)| {
            let mut point = bounds.low.clone();
            point[ALPHA] = axis(ALPHA, a, GRID);
            let mut rest = h;
            for (at, height) in point.iter_mut().enumerate().skip(objective::FIRST_HEIGHT) {
                *height = axis(at, rest % HEIGHTS, HEIGHTS);
                rest /= HEIGHTS;
            }
            let curves = objective.unit_curves(&point);
            let points: Vec<GridPoint> = (0..GRID)
                .map(|m| {
                    let mut point = point.clone();
                    point[LN_MU] = axis(LN_MU, m, GRID);
                    let value = objective.with_curves(&curves, point[LN_MU].exp());
                    GridPoint { cell: (a, m), point, value }
                })
                .collect();
            points
        })
        .collect();
    let mut value = vec![vec![f64::INFINITY; GRID]; GRID];
    let mut best: Vec<GridPoint> = Vec::new();
    for found in all {
        let cell = &mut value[found.cell.1][found.cell.0];
        if found.value < *cell {
            *cell = found.value;
            best.retain(|kept| kept.cell != found.cell);
            best.push(found);
        }
    }
    best.sort_by(|a, b| a.value.total_cmp(&b.value));
    let under = ((best.len() as f64 * THRESHOLD_SHARE) as usize).min(best.len().saturating_sub(1));
    let map = Map {
        alpha: (0..GRID).map(|i| axis(ALPHA, i, GRID)).collect(),
        mu_mpa: (0..GRID).map(|i| axis(LN_MU, i, GRID).exp()).collect(),
        value,
        threshold: best.get(under).map_or(f64::INFINITY, |point| point.value),
    };
    (map, best)
}

/// Step (c): the best points under the threshold, no two in neighbouring cells.
fn starts(points: &[GridPoint], bounds: &Bounds, threshold: f64) -> Vec<Vec<f64>> {
    let mut kept: Vec<&GridPoint> = Vec::new();
    for point in points.iter().take_while(|point| point.value <= threshold) {
        let apart =
            |other: &&GridPoint| point.cell.0.abs_diff(other.cell.0) > 1 || point.cell.1.abs_diff(other.cell.1) > 1;
        if kept.len() < STARTS && kept.iter().all(apart) {
            kept.push(point);
        }
    }
    kept.iter().map(|point| bounds.inside(&point.point)).collect()
}

/// Step (d). Smaller simplices from the end of the one before free one that has collapsed in the
/// narrow valley of the strongly correlated parameters, as long as that gains anything.
fn descent(objective: &Objective<'_>, bounds: &Bounds, start: &[f64]) -> Descent {
    let evaluate = |point: &[f64]| objective.at(point);
    let mut best = simplex::descend(&evaluate, bounds, start, EDGE, STOP);
    for _ in 0..RESTARTS {
        let again = simplex::descend(&evaluate, bounds, &best.point, RESTART_EDGE, STOP);
        let gain = best.value - again.value;
        best.evaluations += again.evaluations;
        if gain > 0.0 {
            best.path.extend(again.path);
            best.point = again.point;
            best.value = again.value;
        }
        if gain <= WORTHWHILE * best.value {
            break;
        }
    }
    best
}
