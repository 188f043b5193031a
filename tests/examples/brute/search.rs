//! The independent search: random points, the best of them followed by a simplex, on an objective computed here from forces that are solved at every point.

use palpate::identify::newton::coordinate::Kind;
use palpate::identify::newton::problem::{Problem, compare};
use palpate::identify::newton::track::Track;
use palpate::identify::spec::{HUBER, Loss};
use rand::Rng;
use rand_pcg::Pcg64;

/// Places of a contact point that are looked at, and sections between the neighbours of the best.
const PLACES: usize = 40;
const SECTIONS: usize = 24;
/// The simplex ends when its values agree within this share.
const AGREES: f64 = 1e-7;

/// How much is tried.
#[derive(Debug, Clone, Copy)]
pub struct Effort {
    /// Random points.
    pub points: usize,
    /// The best of them that are followed.
    pub followed: usize,
    /// Evaluations of each simplex.
    pub evaluations: usize,
}

/// Loss of a difference in standard deviations.
fn loss(problem: &Problem<'_>, u: f64) -> f64 {
    let size = u.abs();
    match problem.loss {
        Loss::Squares => u * u,
        Loss::Huber if size <= HUBER => u * u,
        Loss::Huber => HUBER * (2.0 * size - HUBER),
        // Eq. 14 itself, without the rounding that slopes need.
        Loss::Absolute => 2.0 * size,
    }
}

/// Loss of a run at its best contact point, and the sum of squares (N^2) there.
fn best_contact(problem: &Problem<'_>, at: usize, track: &Track) -> (f64, f64) {
    let data = &problem.selection.curves[at];
    let weight = problem.weights[at];
    let (low, high) = (data.contact.low_mm, data.contact.high_mm);
    let of = |contact: f64| -> f64 {
        let residual = compare(data, track, contact).residual_n;
        residual.iter().map(|r| loss(problem, r / weight.sigma_n)).sum::<f64>() / weight.correlated
    };
    let place = |i: usize| low + (high - low) * i as f64 / PLACES as f64;
    let seen: Vec<f64> = (0..=PLACES).map(|i| of(place(i))).collect();
    let best = (0..=PLACES).min_by(|a, b| seen[*a].total_cmp(&seen[*b])).unwrap_or(0);
    let (mut a, mut b) = (place(best.saturating_sub(1)), place((best + 1).min(PLACES)));
    let ratio = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut left, mut right) = (b - ratio * (b - a), a + ratio * (b - a));
    let (mut at_left, mut at_right) = (of(left), of(right));
    for _ in 0..SECTIONS {
        if at_left < at_right {
            (b, right, at_right) = (right, left, at_left);
            left = b - ratio * (b - a);
            at_left = of(left);
        } else {
            (a, left, at_left) = (left, right, at_right);
            right = a + ratio * (b - a);
            at_right = of(right);
        }
    }
    let (middle, on_grid) = (0.5 * (a + b), place(best));
    let contact = if of(middle) <= seen[best] { middle } else { on_grid };
    let squares = compare(data, track, contact).residual_n.iter().map(|r| r * r).sum();
    (of(contact), squares)
}

/// The objective at a point that is solved there, and the rms difference in N; infinite where it cannot be.
pub fn objective(problem: &Problem<'_>, point: &[f64]) -> (f64, f64) {
    let mut there = problem.clone_unsolved();
    let sums = there.relaxing(point);
    if sums.iter().any(|sum| *sum > palpate::identify::newton::problem::MOST_RELAXING + 1e-6) {
        return (f64::INFINITY, f64::INFINITY);
    }
    if there.solve_at(&[point.to_vec()]).is_err() {
        return (f64::INFINITY, f64::INFINITY);
    }
    let tracks = there.tracks(point);
    if tracks.len() < there.conditions.len() {
        return (f64::INFINITY, f64::INFINITY);
    }
    let runs = there.fitted().map(|at| best_contact(&there, at, &tracks[there.condition_of[at]]));
    let (value, squares) = runs.fold((0.0, 0.0), |(v, s), (value, squares)| (v + value, s + squares));
    (value, (squares / there.samples() as f64).sqrt())
}

/// Random points of the box, moduli from the largest forces.
fn random_point(problem: &Problem<'_>, random: &mut Pcg64) -> Vec<f64> {
    let region = problem.region();
    let mut point: Vec<f64> = (0..region.low.len())
        .map(|i| region.low[i] + (region.high[i] - region.low[i]) * random.random::<f64>())
        .collect();
    let sums = problem.relaxing(&point).map(|sum| if sum > 0.95 { 0.95 / sum } else { 1.0 });
    for (unknown, x) in problem.unknowns.iter().zip(&mut point) {
        match unknown.kind {
            Kind::G(_) => *x *= sums[0],
            Kind::K(_) => *x *= sums[1],
            _ => {}
        }
    }
    let mut there = problem.clone_unsolved();
    if there.solve_at(&[point.clone()]).is_err() {
        return point;
    }
    let tracks = there.tracks(&point);
    for axis in (0..point.len()).filter(|&i| problem.unknowns[i].kind == Kind::Modulus) {
        let mut ratios: Vec<f64> = there
            .fitted()
            .filter(|&at| there.conditions[there.condition_of[at]].modulus == axis)
            .filter_map(|at| {
                let data = &there.selection.curves[at];
                let track = tracks.get(there.condition_of[at])?;
                let deepest = data.depth_mm.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                let peak = data.force_n.iter().copied().fold(0.0, f64::max);
                Some((peak / track.ramp(deepest - data.contact.contact_mm).0).ln())
            })
            .filter(|ratio| ratio.is_finite())
            .collect();
        ratios.sort_by(f64::total_cmp);
        if let Some(ratio) = ratios.get(ratios.len() / 2) {
            point[axis] += ratio;
        }
    }
    region.inside(&point)
}

/// The best objective that random starts and simplexes find, with its rms and its point.
pub fn best(problem: &Problem<'_>, effort: Effort, random: &mut Pcg64) -> (f64, f64, Vec<f64>) {
    let mut seen: Vec<(f64, Vec<f64>)> = (0..effort.points)
        .map(|_| {
            let point = random_point(problem, random);
            (objective(problem, &point).0, point)
        })
        .collect();
    seen.sort_by(|a, b| a.0.total_cmp(&b.0));
    let ends = seen.into_iter().take(effort.followed).map(|(_, start)| {
        let first = simplex(problem, &start, 0.1, effort.evaluations / 2);
        // Anew from where it ended: a simplex that has become flat starts round again.
        simplex(problem, &first, 0.02, effort.evaluations / 2)
    });
    let ends = ends.map(|point| {
        let (value, rms) = objective(problem, &point);
        (value, rms, point)
    });
    ends.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f64::INFINITY, f64::INFINITY, Vec::new()))
}

/// Nelder and Mead 1965 (doi:10.1093/comjnl/7.4.308) in the box; `edge` is a share of the ranges.
pub fn simplex(problem: &Problem<'_>, start: &[f64], edge: f64, evaluations: usize) -> Vec<f64> {
    let region = problem.region();
    let n = start.len();
    let of = |x: &[f64]| objective(problem, &region.inside(x)).0;
    let mut corners: Vec<(f64, Vec<f64>)> = vec![(of(start), start.to_vec())];
    for i in 0..n {
        let side = edge * (region.high[i] - region.low[i]);
        let mut x = start.to_vec();
        x[i] += if x[i] + side <= region.high[i] { side } else { -side };
        corners.push((of(&x), x));
    }
    let mut spent = n + 1;
    while spent < evaluations {
        corners.sort_by(|a, b| a.0.total_cmp(&b.0));
        if corners[n].0 - corners[0].0 <= AGREES * corners[0].0.abs() {
            break;
        }
        let centre: Vec<f64> = (0..n).map(|i| corners[..n].iter().map(|c| c.1[i]).sum::<f64>() / n as f64).collect();
        let along = |t: f64| -> Vec<f64> { (0..n).map(|i| centre[i] + t * (corners[n].1[i] - centre[i])).collect() };
        let reflected = along(-1.0);
        let at_reflected = of(&reflected);
        spent += 1;
        let new = if at_reflected < corners[0].0 {
            let far = along(-2.0);
            spent += 1;
            let at_far = of(&far);
            if at_far < at_reflected { Some((at_far, far)) } else { Some((at_reflected, reflected)) }
        } else if at_reflected < corners[n - 1].0 {
            Some((at_reflected, reflected))
        } else {
            let near = along(if at_reflected < corners[n].0 { -0.5 } else { 0.5 });
            spent += 1;
            let at_near = of(&near);
            (at_near < corners[n].0.min(at_reflected)).then_some((at_near, near))
        };
        match new {
            Some(new) => corners[n] = new,
            None => {
                let best = corners[0].1.clone();
                for corner in &mut corners[1..] {
                    corner.1.iter_mut().zip(&best).for_each(|(x, b)| *x = 0.5 * (*x + b));
                    corner.0 = of(&corner.1);
                    spent += 1;
                }
            }
        }
    }
    corners.sort_by(|a, b| a.0.total_cmp(&b.0));
    region.inside(&corners[0].1)
}
