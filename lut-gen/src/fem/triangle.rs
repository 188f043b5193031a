//! Triangles of three, six and ten nodes: shape functions, their slopes, and the rules to integrate with.

/// Nodes of the largest triangle. Of second order: its corners, then the middles of the sides 0-1, 1-2 and 2-0. Of third
/// order: its corners, on each of these sides two nodes in thirds, the side's first corner first, and the centre.
pub const NODES: usize = 10;

/// Order of the shape functions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Order {
    /// Linear, three nodes.
    First,
    /// Quadratic, six nodes.
    #[default]
    Second,
    /// Cubic, ten nodes.
    Third,
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

/// Exact for polynomials of degree 6 (Dunavant, as above).
const TWELVE: [RulePoint; 12] = {
    const A: f64 = 0.249_286_745_170_910;
    const B: f64 = 0.063_089_014_491_502;
    const C: [f64; 3] = [0.053_145_049_844_817, 0.310_352_451_033_784, 0.636_502_499_121_399];
    const WA: f64 = 0.116_786_275_726_379;
    const WB: f64 = 0.050_844_906_370_207;
    const WC: f64 = 0.082_851_075_618_374;
    [
        ([1.0 - 2.0 * A, A, A], WA),
        ([A, 1.0 - 2.0 * A, A], WA),
        ([A, A, 1.0 - 2.0 * A], WA),
        ([1.0 - 2.0 * B, B, B], WB),
        ([B, 1.0 - 2.0 * B, B], WB),
        ([B, B, 1.0 - 2.0 * B], WB),
        ([C[0], C[1], C[2]], WC),
        ([C[1], C[2], C[0]], WC),
        ([C[2], C[0], C[1]], WC),
        ([C[0], C[2], C[1]], WC),
        ([C[2], C[1], C[0]], WC),
        ([C[1], C[0], C[2]], WC),
    ]
};

/// Corners of the three sides.
pub const SIDES: [(usize, usize); 3] = [(0, 1), (1, 2), (2, 0)];

impl Order {
    /// Nodes of a triangle.
    #[must_use]
    pub const fn nodes(self) -> usize {
        match self {
            Order::First => 3,
            Order::Second => 6,
            Order::Third => 10,
        }
    }

    /// Nodes on a side between its corners.
    #[must_use]
    pub const fn on_side(self) -> usize {
        match self {
            Order::First => 0,
            Order::Second => 1,
            Order::Third => 2,
        }
    }

    /// The rule that integrates products of two slopes, and a smooth factor well.
    #[must_use]
    pub const fn rule(self) -> &'static [RulePoint] {
        match self {
            Order::First => &THREE,
            Order::Second => &SIX,
            Order::Third => &TWELVE,
        }
    }

    /// Barycentric coordinates of a node.
    #[must_use]
    pub fn coordinates(self, node: usize) -> [f64; 3] {
        let mut l = [0.0; 3];
        match (self, node) {
            (_, 0..3) => l[node] = 1.0,
            (Order::Third, 3..9) => {
                let (from, to) = SIDES[(node - 3) / 2];
                let near = if node % 2 == 1 { from } else { to };
                l[from] = 1.0 / 3.0;
                l[to] = 1.0 / 3.0;
                l[near] = 2.0 / 3.0;
            }
            (Order::Second, 3..6) => {
                let (from, to) = SIDES[node - 3];
                (l[from], l[to]) = (0.5, 0.5);
            }
            _ => l = [1.0 / 3.0; 3],
        }
        l
    }

    /// Shape functions at barycentric coordinates; zero for nodes that the order has not.
    #[must_use]
    pub fn shapes(self, l: [f64; 3]) -> [f64; NODES] {
        let mut shapes = [0.0; NODES];
        match self {
            Order::First => shapes[..3].copy_from_slice(&l),
            Order::Second => {
                for (i, (from, to)) in SIDES.into_iter().enumerate() {
                    shapes[i] = l[i] * (2.0 * l[i] - 1.0);
                    shapes[3 + i] = 4.0 * l[from] * l[to];
                }
            }
            Order::Third => {
                for (i, (from, to)) in SIDES.into_iter().enumerate() {
                    shapes[i] = 0.5 * l[i] * (3.0 * l[i] - 1.0) * (3.0 * l[i] - 2.0);
                    shapes[3 + 2 * i] = 4.5 * l[from] * l[to] * (3.0 * l[from] - 1.0);
                    shapes[4 + 2 * i] = 4.5 * l[from] * l[to] * (3.0 * l[to] - 1.0);
                }
                shapes[9] = 27.0 * l[0] * l[1] * l[2];
            }
        }
        shapes
    }

    /// Their slopes along the second and the third barycentric coordinate; the first is what is left to 1.
    #[must_use]
    pub fn slopes(self, l: [f64; 3]) -> [[f64; 2]; NODES] {
        // By all three coordinates as if they were free.
        let mut by = [[0.0; 3]; NODES];
        match self {
            Order::First => (0..3).for_each(|i| by[i][i] = 1.0),
            Order::Second => {
                for (i, (from, to)) in SIDES.into_iter().enumerate() {
                    by[i][i] = 4.0 * l[i] - 1.0;
                    (by[3 + i][from], by[3 + i][to]) = (4.0 * l[to], 4.0 * l[from]);
                }
            }
            Order::Third => {
                for (i, (from, to)) in SIDES.into_iter().enumerate() {
                    let (a, b) = (l[from], l[to]);
                    by[i][i] = 0.5 * (27.0 * l[i] * l[i] - 18.0 * l[i] + 2.0);
                    (by[3 + 2 * i][from], by[3 + 2 * i][to]) = (4.5 * b * (6.0 * a - 1.0), 4.5 * a * (3.0 * a - 1.0));
                    (by[4 + 2 * i][from], by[4 + 2 * i][to]) = (4.5 * b * (3.0 * b - 1.0), 4.5 * a * (6.0 * b - 1.0));
                }
                by[9] = [27.0 * l[1] * l[2], 27.0 * l[2] * l[0], 27.0 * l[0] * l[1]];
            }
        }
        by.map(|[a, b, c]| [b - a, c - a])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AT: [f64; 3] = [0.2, 0.5, 0.3];

    #[test]
    fn shapes_sum_to_one_and_their_slopes_are_difference_quotients() {
        for order in [Order::First, Order::Second, Order::Third] {
            for n in 0..order.nodes() {
                let there = order.shapes(order.coordinates(n));
                assert!((0..order.nodes()).all(|m| (there[m] - f64::from(u8::from(m == n))).abs() < 1e-14));
            }
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
        for (order, degree) in [(Order::First, 2), (Order::Second, 4), (Order::Third, 6)] {
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
