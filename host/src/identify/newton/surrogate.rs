//! What is known of a condition between its solves: values and slopes at the points that were solved, joined smoothly.
//!
//! Every function here has the values and slopes of the finite elements at every solved point. A Gauss-Newton step on it
//! is therefore one on the finite elements, only better informed the more has been solved nearby.

/// A solved point: coordinates, values, and the values' derivatives by each coordinate.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// Where.
    pub x: Vec<f64>,
    /// Values.
    pub value: Vec<f64>,
    /// Derivatives, `by[coordinate][value]`.
    pub by: Vec<Vec<f64>>,
}

/// Solved points of one condition.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Surrogate {
    /// Length of each coordinate's range: the unit of distances.
    pub widths: Vec<f64>,
    nodes: Vec<Node>,
}

/// Two points nearer than this share of the range are one: the solves would differ by less than their own error.
const SAME: f64 = 1e-7;

impl Surrogate {
    /// Nothing solved yet.
    #[must_use]
    pub fn new(widths: Vec<f64>) -> Self {
        Self { widths, nodes: Vec::new() }
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
            if self.widths.len() == 1 {
                self.nodes.sort_by(|a, b| a.x[0].total_cmp(&b.x[0]));
            }
        }
    }

    fn distance2(&self, a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).zip(&self.widths).map(|((a, b), width)| ((a - b) / width).powi(2)).sum()
    }

    /// Values at a point; empty before the first solve.
    #[must_use]
    pub fn at(&self, x: &[f64]) -> Vec<f64> {
        match (self.nodes.as_slice(), x) {
            ([], _) => Vec::new(),
            ([one], _) => taylor(one, x),
            (nodes, [along]) => hermite(nodes, *along),
            (nodes, _) => self.blended(nodes, x),
        }
    }

    /// Taylor expansions of all points, weighted by distance to the power of -4: with even powers the weights' own slopes vanish at
    /// every point (Shepard 1968, doi:10.1145/800186.810616).
    fn blended(&self, nodes: &[Node], x: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; nodes[0].value.len()];
        let mut weights = 0.0;
        for node in nodes {
            let distance2 = self.distance2(&node.x, x);
            if distance2 < SAME * SAME {
                return taylor(node, x);
            }
            let weight = distance2.powi(-2);
            weights += weight;
            sum.iter_mut().zip(taylor(node, x)).for_each(|(s, t)| *s += weight * t);
        }
        sum.iter_mut().for_each(|s| *s /= weights);
        sum
    }
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
                        assert!((surrogate.at(x)[i] - exact.value[i]).abs() < 1e-12);
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
