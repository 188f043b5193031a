//! Triangles of three and six nodes: shape functions, their slopes, and the rules to integrate with.

/// Nodes of the largest triangle: its corners, then the middles of the sides 0-1, 1-2 and 2-0.
pub const NODES: usize = 6;

/// Order of the shape functions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Order {
    /// Linear, three nodes.
    First,
    /// Quadratic, six nodes.
    #[default]
    Second,
}

/// A point of a rule: barycentric coordinates, and its weight of a triangle of area 1.
pub type RulePoint = ([f64; 3], f64);

/// Exact for quadratics (Strang and Fix, An Analysis of the Finite Element Method, table 4.1).
const THREE: [RulePoint; 3] = {
    const A: f64 = 1.0 / 6.0;
    const B: f64 = 2.0 / 3.0;
    [([B, A, A], 1.0 / 3.0), ([A, B, A], 1.0 / 3.0), ([A, A, B], 1.0 / 3.0)]
};

/// Exact for quartics (Dunavant, Int. J. Numer. Meth. Eng. 21, 1985, degree 4).
const SIX: [RulePoint; 6] = {
    const A: f64 = 0.445_948_490_915_965;
    const B: f64 = 0.091_576_213_509_771;
    const WA: f64 = 0.223_381_589_678_011;
    const WB: f64 = 0.109_951_743_655_322;
    [
        ([1.0 - 2.0 * A, A, A], WA),
        ([A, 1.0 - 2.0 * A, A], WA),
        ([A, A, 1.0 - 2.0 * A], WA),
        ([1.0 - 2.0 * B, B, B], WB),
        ([B, 1.0 - 2.0 * B, B], WB),
        ([B, B, 1.0 - 2.0 * B], WB),
    ]
};

impl Order {
    /// Nodes of a triangle.
    #[must_use]
    pub const fn nodes(self) -> usize {
        match self {
            Order::First => 3,
            Order::Second => 6,
        }
    }

    /// The rule that integrates products of two slopes, and a smooth factor well.
    #[must_use]
    pub const fn rule(self) -> &'static [RulePoint] {
        match self {
            Order::First => &THREE,
            Order::Second => &SIX,
        }
    }

    /// Shape functions at barycentric coordinates; zero for nodes that the order has not.
    #[must_use]
    pub fn shapes(self, [a, b, c]: [f64; 3]) -> [f64; NODES] {
        match self {
            Order::First => [a, b, c, 0.0, 0.0, 0.0],
            Order::Second => {
                [a * (2.0 * a - 1.0), b * (2.0 * b - 1.0), c * (2.0 * c - 1.0), 4.0 * a * b, 4.0 * b * c, 4.0 * c * a]
            }
        }
    }

    /// Their slopes along the second and the third barycentric coordinate; the first is what is left to 1.
    #[must_use]
    pub fn slopes(self, [a, b, c]: [f64; 3]) -> [[f64; 2]; NODES] {
        match self {
            Order::First => [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0], [0.0; 2], [0.0; 2], [0.0; 2]],
            Order::Second => [
                [1.0 - 4.0 * a, 1.0 - 4.0 * a],
                [4.0 * b - 1.0, 0.0],
                [0.0, 4.0 * c - 1.0],
                [4.0 * (a - b), -4.0 * b],
                [4.0 * c, 4.0 * b],
                [-4.0 * c, 4.0 * (a - c)],
            ],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AT: [f64; 3] = [0.2, 0.5, 0.3];

    #[test]
    fn shapes_sum_to_one_and_their_slopes_are_difference_quotients() {
        for order in [Order::First, Order::Second] {
            assert!((order.shapes(AT).iter().sum::<f64>() - 1.0).abs() < 1e-14);
            let step = 1e-6;
            for (along, moved) in [[-step, step, 0.0], [-step, 0.0, step]].into_iter().enumerate() {
                let at = |sign: f64| order.shapes([0, 1, 2].map(|i| AT[i] + sign * moved[i]));
                for ((plus, minus), slope) in at(1.0).iter().zip(at(-1.0)).zip(order.slopes(AT)) {
                    assert!(((plus - minus) / (2.0 * step) - slope[along]).abs() < 1e-8);
                }
            }
        }
    }

    /// The integral of a^i b^j c^k over a triangle of area 1 is 2 i! j! k! / (i + j + k + 2)!.
    #[test]
    fn rules_integrate_polynomials_of_their_degree() {
        let factorial = |n: i32| (1..=n).map(f64::from).product::<f64>();
        for (order, degree) in [(Order::First, 2), (Order::Second, 4)] {
            for i in 0..=degree {
                for j in 0..=degree - i {
                    let k = degree - i - j;
                    let sum: f64 =
                        order.rule().iter().map(|([a, b, c], w)| w * a.powi(i) * b.powi(j) * c.powi(k)).sum();
                    let exact = 2.0 * factorial(i) * factorial(j) * factorial(k) / factorial(degree + 2);
                    assert!((sum - exact).abs() < 1e-12, "{i} {j} {k}: {sum} for {exact}");
                }
            }
        }
    }
}
