//! Serendipity shape functions of the eight-node quadrilateral and its edge.

/// Natural coordinates of the corners.
const CORNER: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

/// Shape functions and their derivatives by `x` and `y` at `(x, y)` in `[-1, 1]^2`.
///
/// Corners: `(1 + x xi)(1 + y yi)(x xi + y yi - 1) / 4`; middles:
/// `(1 - x^2)(1 + y yi) / 2` and `(1 + x xi)(1 - y^2) / 2`.
#[must_use]
pub fn quad8(x: f64, y: f64) -> ([f64; 8], [[f64; 2]; 8]) {
    let mut n = [0.0; 8];
    let mut d = [[0.0; 2]; 8];
    for (i, [cx, cy]) in CORNER.into_iter().enumerate() {
        let (a, b) = (1.0 + x * cx, 1.0 + y * cy);
        n[i] = 0.25 * a * b * (x * cx + y * cy - 1.0);
        d[i] = [0.25 * cx * b * (2.0 * x * cx + y * cy), 0.25 * cy * a * (2.0 * y * cy + x * cx)];
    }
    for (i, cy) in [(4, -1.0), (6, 1.0)] {
        n[i] = 0.5 * (1.0 - x * x) * (1.0 + y * cy);
        d[i] = [-x * (1.0 + y * cy), 0.5 * cy * (1.0 - x * x)];
    }
    for (i, cx) in [(5, 1.0), (7, -1.0)] {
        n[i] = 0.5 * (1.0 + x * cx) * (1.0 - y * y);
        d[i] = [0.5 * cx * (1.0 - y * y), -y * (1.0 + x * cx)];
    }
    (n, d)
}

/// Shape functions of the three-node edge (start, middle, end) and their derivatives.
#[must_use]
pub fn line3(x: f64) -> ([f64; 3], [f64; 3]) {
    ([0.5 * x * (x - 1.0), 1.0 - x * x, 0.5 * x * (x + 1.0)], [x - 0.5, -2.0 * x, x + 0.5])
}
