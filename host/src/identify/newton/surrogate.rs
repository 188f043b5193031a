//! What is known of a condition between its solves: values and slopes at the points that were solved, joined smoothly.
//!
//! Every function here has the values of the finite elements at every solved point, and their slopes to within the noise of the mesh. A Gauss-Newton step on it
//! is therefore one on the finite elements, only better informed the more has been solved nearby.

use std::sync::OnceLock;

use super::bulk::Bulk;
use super::kriging::{Kriging, Reach};
use super::reference::Reference;

pub use super::kriging::Node;

/// Solved points of one condition.
#[derive(Debug, Clone, Default)]
pub struct Surrogate {
    /// Length of each coordinate's range: the unit of distances.
    pub widths: Vec<f64>,
    /// What is taken out of the values before they are joined, and added again.
    reference: Option<Reference>,
    /// Coordinates in which they are joined.
    bulk: Option<Bulk>,
    nodes: Vec<Node>,
    joined: OnceLock<Option<Kriging>>,
    /// Correlations, and the number of points they were found from.
    reach: Option<(Reach, usize)>,
}

/// Correlation lengths are sought again when there are this many times more points, up to so many: they hardly change any more, and cost the cube of the number.
const MORE: f64 = 1.3;
const SOUGHT: usize = 40;

/// Two points nearer than this share of the range are one: the solves would differ by less than their own error.
const SAME: f64 = 1e-7;

impl Surrogate {
    /// Nothing solved yet.
    #[must_use]
    pub fn new(widths: Vec<f64>) -> Self {
        Self { widths, ..Self::default() }
    }

    /// The same with what is known of the values beforehand, and of the coordinates in which they are smooth.
    #[must_use]
    pub fn knowing(self, reference: Option<Reference>, bulk: Option<Bulk>) -> Self {
        Self { reference, bulk, ..self }
    }

    /// The same coordinates, with nothing solved.
    #[must_use]
    pub fn forgotten(&self) -> Self {
        Self::new(self.widths.clone()).knowing(self.reference.clone(), self.bulk)
    }

    /// True when there is a solve at this point.
    #[must_use]
    pub fn knows(&self, x: &[f64]) -> bool {
        self.nodes.iter().any(|node| self.distance2(&node.x, x) < SAME * SAME)
    }

    /// Number of solves.
    #[must_use]
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// True before the first solve.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Adds a solve; along a single coordinate the points stay in order.
    pub fn learn(&mut self, node: Node) {
        if !self.knows(&node.x) {
            self.nodes.push(node);
            if let Some(Some(kriging)) = self.joined.take() {
                let from = self.reach.as_ref().map_or(0, |(_, from)| *from);
                self.reach = Some((kriging.reach, from));
            }
            if self.widths.len() == 1 {
                self.nodes.sort_by(|a, b| a.x[0].total_cmp(&b.x[0]));
            }
        }
    }

    fn distance2(&self, a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).zip(&self.widths).map(|((a, b), width)| ((a - b) / width).powi(2)).sum()
    }

    /// To be called when solves were added: correlations are sought again where there are many more than before.
    pub fn settle(&mut self) {
        let count = self.nodes.len();
        let due = match self.reach {
            Some((_, from)) => count as f64 >= MORE * from as f64 && count <= SOUGHT,
            None => true,
        };
        if self.widths.len() > 1 && count > 1 && due {
            let found = self.join(true);
            self.reach = found.as_ref().map(|kriging| (kriging.reach.clone(), count));
            self.joined = OnceLock::from(found);
        }
    }

    /// Values at a point; empty before the first solve.
    #[must_use]
    pub fn at(&self, x: &[f64]) -> Vec<f64> {
        let mut value = match (self.nodes.as_slice(), x) {
            ([], _) => return Vec::new(),
            (nodes, [along]) if nodes.len() > 1 => return hermite(nodes, *along),
            ([one], _) => taylor(&self.known(one), &self.place(x)),
            (nodes, _) => match self.joined.get_or_init(|| self.join(false)) {
                Some(kriging) => kriging.at(&self.place(x)),
                None => return nearest(nodes, |node| self.distance2(&node.x, x)).map_or(Vec::new(), |n| taylor(n, x)),
            },
        };
        if let Some(reference) = &self.reference {
            value.iter_mut().zip(reference.at(x).0).for_each(|(v, r)| *v += r);
        }
        value
    }

    fn join(&self, seek: bool) -> Option<Kriging> {
        let known: Vec<Node> = self.nodes.iter().map(|node| self.known(node)).collect();
        let mut widths = self.widths.clone();
        if let Some(bulk) = &self.bulk {
            bulk.stretch(&mut widths);
        }
        Kriging::through(&known, &widths, self.reach.as_ref().map(|(reach, _)| reach), seek)
    }

    fn place(&self, x: &[f64]) -> Vec<f64> {
        self.bulk.as_ref().map_or_else(|| x.to_vec(), |bulk| bulk.place(x))
    }

    /// A solve without the reference, in the coordinates in which solves are joined.
    fn known(&self, node: &Node) -> Node {
        let (mut value, mut by) = (node.value.clone(), node.by.clone());
        if let Some(reference) = &self.reference {
            let (known, slopes) = reference.at(&node.x);
            let less = |from: &mut Vec<f64>, what: &[f64]| from.iter_mut().zip(what).for_each(|(f, w)| *f -= w);
            less(&mut value, &known);
            for ((g, tau), (by_g, by_tau)) in reference.terms.iter().zip(&slopes) {
                less(&mut by[*g], by_g);
                less(&mut by[*tau], by_tau);
            }
        }
        if let Some(bulk) = &self.bulk {
            bulk.turn(&node.x, &mut by);
        }
        Node { x: self.place(&node.x), value, by }
    }
}

fn nearest(nodes: &[Node], distance2: impl Fn(&Node) -> f64) -> Option<&Node> {
    nodes.iter().min_by(|a, b| distance2(a).total_cmp(&distance2(b)))
}

fn taylor(node: &Node, x: &[f64]) -> Vec<f64> {
    let mut value = node.value.clone();
    for ((x, x0), by) in x.iter().zip(&node.x).zip(&node.by) {
        value.iter_mut().zip(by).for_each(|(v, by)| *v += by * (x - x0));
    }
    value
}

/// The cubic between the two neighbours; beyond the ends the tangent.
fn hermite(nodes: &[Node], x: f64) -> Vec<f64> {
    let next = nodes.partition_point(|node| node.x[0] < x);
    if next == 0 || next == nodes.len() {
        return taylor(&nodes[next.min(nodes.len() - 1)], &[x]);
    }
    let (a, b) = (&nodes[next - 1], &nodes[next]);
    let width = b.x[0] - a.x[0];
    let t = (x - a.x[0]) / width;
    let u = 1.0 - t;
    let from_a = (u * u * (1.0 + 2.0 * t), u * u * t * width);
    let from_b = (t * t * (1.0 + 2.0 * u), -t * t * u * width);
    (0..a.value.len())
        .map(|i| from_a.0 * a.value[i] + from_a.1 * a.by[0][i] + from_b.0 * b.value[i] + from_b.1 * b.by[0][i])
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(x: &[f64]) -> Node {
        let phase = x.iter().enumerate().map(|(i, x)| (i as f64 + 1.0) * x).sum::<f64>();
        let by = (0..x.len()).map(|i| vec![(i as f64 + 1.0) * phase.cos(), 2.0]).collect();
        Node { x: x.to_vec(), value: vec![phase.sin(), 2.0 * x.iter().sum::<f64>() + 1.0], by }
    }

    #[test]
    fn values_and_slopes_at_solved_points_are_those_of_the_solves() {
        for points in [vec![vec![0.1], vec![0.9], vec![0.4]], vec![vec![0.1, 0.2], vec![0.6, 0.1], vec![0.3, 0.9]]] {
            let mut surrogate = Surrogate::new(vec![1.0; points[0].len()]);
            points.iter().for_each(|x| surrogate.learn(wave(x)));
            surrogate.learn(wave(&points[0]));
            assert_eq!(surrogate.len(), 3);
            for x in &points {
                let exact = wave(x);
                for (axis, by) in exact.by.iter().enumerate() {
                    // Slopes are continuous, curvatures are not: the quotient is off by h times their jump.
                    let h = 1e-6;
                    let moved = |h: f64| {
                        let mut x = x.clone();
                        x[axis] += h;
                        surrogate.at(&x)
                    };
                    let (low, high) = (moved(-h), moved(h));
                    for i in 0..2 {
                        // The nugget is 1e-8 of the scatter.
                        assert!((surrogate.at(x)[i] - exact.value[i]).abs() < 1e-7);
                        assert!(((high[i] - low[i]) / (2.0 * h) - by[i]).abs() < 1e-5, "{x:?} {axis} {i}");
                    }
                }
            }
            // A linear function is reproduced everywhere.
            let x = vec![0.5; points[0].len()];
            assert!((surrogate.at(&x)[1] - wave(&x).value[1]).abs() < 1e-12);
        }
    }
}
