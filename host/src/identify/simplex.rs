//! Nelder-Mead simplex of thesis Appendix A, inside a box.
//!
//! Own code rather than `argmin`'s, because the paths are drawn, the box has to hold in every
//! vertex, and the thesis' coefficients (with the corrections of ERRATA rows Eq. 60 and Eq. 61)
//! are the point of it.

/// Coefficients of Appendix A: reflection, expansion, contraction (printed as rho = -0.5 with the
/// constraint of the wrong sign, ERRATA row Eq. 60) and shrink (ERRATA row Eq. 61).
const REFLECTION: f64 = 1.0;
const EXPANSION: f64 = 2.0;
const CONTRACTION: f64 = 0.5;
const SHRINK: f64 = 0.5;

/// When to stop (scenarios 1 and 3 of Appendix A, step f).
#[derive(Debug, Clone, Copy)]
pub struct Stop {
    /// Edge of the simplex relative to the box at which it counts as a point.
    pub size: f64,
    /// Relative spread of the objective over the vertices that must be reached as well.
    pub spread: f64,
    /// Most iterations.
    pub iterations: usize,
}

/// Where a search ended and how it went there.
#[derive(Debug, Clone)]
pub struct Descent {
    /// Best vertex.
    pub point: Vec<f64>,
    /// Objective there.
    pub value: f64,
    /// Best vertex after every iteration in which it moved, with the start first.
    pub path: Vec<Vec<f64>>,
    /// Evaluations until each of these.
    pub counts: Vec<usize>,
    /// Objective evaluations.
    pub evaluations: usize,
}

/// A box of allowed points.
#[derive(Debug, Clone)]
pub struct Bounds {
    /// Lower corner.
    pub low: Vec<f64>,
    /// Upper corner.
    pub high: Vec<f64>,
}

impl Bounds {
    /// The point of the box next to `point`.
    pub fn inside(&self, point: &[f64]) -> Vec<f64> {
        let sides = self.low.iter().zip(&self.high);
        point.iter().zip(sides).map(|(x, (low, high))| x.clamp(*low, *high)).collect()
    }

    /// Length of the side `axis`.
    pub fn side(&self, axis: usize) -> f64 {
        self.high[axis] - self.low[axis]
    }
}

struct Simplex<'a, F: Fn(&[f64]) -> f64> {
    objective: &'a F,
    bounds: &'a Bounds,
    vertices: Vec<(Vec<f64>, f64)>,
    evaluations: usize,
}

impl<F: Fn(&[f64]) -> f64> Simplex<'_, F> {
    fn vertex(&mut self, point: &[f64]) -> (Vec<f64>, f64) {
        let point = self.bounds.inside(point);
        self.evaluations += 1;
        let value = (self.objective)(&point);
        (point, if value.is_finite() { value } else { f64::INFINITY })
    }

    fn sort(&mut self) {
        self.vertices.sort_by(|a, b| a.1.total_cmp(&b.1));
    }

    /// Eq. 59: centre of all vertices but the worst, which is the last.
    fn centre(&self) -> Vec<f64> {
        let kept = &self.vertices[..self.vertices.len() - 1];
        (0..kept[0].0.len()).map(|axis| kept.iter().map(|v| v.0[axis]).sum::<f64>() / kept.len() as f64).collect()
    }

    fn size(&self) -> f64 {
        let best = &self.vertices[0].0;
        let mut size = 0.0_f64;
        for (point, _) in &self.vertices[1..] {
            for axis in 0..best.len() {
                let side = self.bounds.side(axis).max(f64::MIN_POSITIVE);
                size = size.max((point[axis] - best[axis]).abs() / side);
            }
        }
        size
    }

    /// One transformation, Fig. 91.
    fn step(&mut self) {
        let last = self.vertices.len() - 1;
        let centre = self.centre();
        let worst = self.vertices[last].clone();
        let along =
            |factor: f64| -> Vec<f64> { centre.iter().zip(&worst.0).map(|(c, w)| c + factor * (c - w)).collect() };
        let reflected = self.vertex(&along(REFLECTION));
        if reflected.1 < self.vertices[0].1 {
            let expanded = self.vertex(&along(EXPANSION));
            self.vertices[last] = if expanded.1 < reflected.1 { expanded } else { reflected };
            return;
        }
        if reflected.1 < self.vertices[last - 1].1 {
            self.vertices[last] = reflected;
            return;
        }
        let outside = reflected.1 < worst.1;
        let factor = if outside { CONTRACTION } else { -CONTRACTION };
        let contracted = self.vertex(&along(factor));
        if contracted.1 < if outside { reflected.1 } else { worst.1 } {
            self.vertices[last] = contracted;
            return;
        }
        let best = self.vertices[0].0.clone();
        for at in 1..=last {
            let old = &self.vertices[at].0;
            let new: Vec<f64> = best.iter().zip(old).map(|(b, o)| b + SHRINK * (o - b)).collect();
            self.vertices[at] = self.vertex(&new);
        }
    }
}

/// Minimises `objective` from `start` with a first simplex of `edge` (share of the box a side).
///
/// A vertex outside the box is moved onto its wall. The box must have at least one dimension.
pub fn descend<F: Fn(&[f64]) -> f64>(objective: &F, bounds: &Bounds, start: &[f64], edge: f64, stop: Stop) -> Descent {
    let mut simplex = Simplex { objective, bounds, vertices: Vec::new(), evaluations: 0 };
    let first = simplex.vertex(start);
    simplex.vertices.push(first);
    for axis in 0..start.len() {
        // Eq. 57, stepping inward where the start lies at the upper wall.
        let mut point = simplex.vertices[0].0.clone();
        let step = edge * bounds.side(axis);
        point[axis] += if point[axis] + step <= bounds.high[axis] { step } else { -step };
        let vertex = simplex.vertex(&point);
        simplex.vertices.push(vertex);
    }
    let mut path = vec![simplex.vertices[0].0.clone()];
    let mut counts = vec![1];
    for _ in 0..stop.iterations {
        simplex.sort();
        let (best, worst) = (simplex.vertices[0].1, simplex.vertices[start.len()].1);
        if path.last() != Some(&simplex.vertices[0].0) {
            path.push(simplex.vertices[0].0.clone());
            counts.push(simplex.evaluations);
        }
        if simplex.size() < stop.size && worst - best <= stop.spread * best.abs() {
            break;
        }
        simplex.step();
    }
    simplex.sort();
    let (point, value) = simplex.vertices[0].clone();
    path.push(point.clone());
    counts.push(simplex.evaluations);
    Descent { point, value, path, counts, evaluations: simplex.evaluations }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STOP: Stop = Stop { size: 1e-7, spread: 1e-10, iterations: 500 };

    #[test]
    fn finds_the_bottom_of_rosenbrocks_valley() {
        let bounds = Bounds { low: vec![-3.0, -3.0], high: vec![3.0, 3.0] };
        let valley = |p: &[f64]| 1.0 + (1.0 - p[0]).powi(2) + 100.0 * (p[1] - p[0] * p[0]).powi(2);
        let end = descend(&valley, &bounds, &[-1.2, 1.0], 0.1, STOP);
        // The spread asks for 1e-10 of the value; the valley is flat to the square root of it.
        assert!((end.point[0] - 1.0).abs() < 1e-4 && (end.point[1] - 1.0).abs() < 1e-4);
        assert!(end.path.len() > 10 && end.counts.len() == end.path.len());
        assert!(end.counts.is_sorted() && end.counts.last() == Some(&end.evaluations));
    }

    #[test]
    fn stays_inside_and_finds_a_minimum_on_the_wall() {
        let bounds = Bounds { low: vec![0.0, 0.0], high: vec![1.0, 1.0] };
        let slope = |p: &[f64]| {
            assert!((0.0..=1.0).contains(&p[0]) && (0.0..=1.0).contains(&p[1]));
            (p[0] - 2.0).powi(2) + (p[1] - 0.25).abs()
        };
        let end = descend(&slope, &bounds, &[0.3, 0.9], 0.1, STOP);
        assert!((end.point[0] - 1.0).abs() < 1e-6 && (end.point[1] - 0.25).abs() < 1e-5);
    }
}
