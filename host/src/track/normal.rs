//! Weighted least squares of a window on seven pictures: two slopes, the template, its blur, and a plane of light.

use nalgebra::{Cholesky, Matrix6, SMatrix, SVector};

/// How many pictures.
pub const PICTURES: usize = 7;
/// Which of them is the template.
pub const TEMPLATE: usize = 2;
/// and its blur.
pub const BLUR: usize = 3;
/// The plane of light begins here.
pub const LIGHT: usize = 4;

/// The pictures, each with a value a pixel.
pub type Basis = [Vec<f32>; PICTURES];
/// Their products.
pub type Matrix = SMatrix<f64, PICTURES, PICTURES>;
/// Their products with another picture.
pub type Vector = SVector<f64, PICTURES>;

/// Normal equations.
#[derive(Debug, Clone)]
pub struct Normal {
    /// Products of the pictures.
    pub products: Matrix,
    /// Products of pictures and window.
    pub with_window: Vector,
    /// The window's product with itself.
    pub window: f64,
    /// Sum of the weights.
    pub weight: f64,
}

const LANES: usize = 8;

/// Sum of products; in lanes, which the compiler makes vectors of.
pub fn dot(a: &[f32], b: &[f32]) -> f64 {
    let mut lanes = [0.0_f32; LANES];
    let (wide_a, wide_b) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let rest: f32 = wide_a.remainder().iter().zip(wide_b.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in wide_a.zip(wide_b) {
        for ((lane, a), b) in lanes.iter_mut().zip(a).zip(b) {
            *lane += a * b;
        }
    }
    f64::from(lanes.iter().sum::<f32>() + rest)
}

/// Pixels whose products are summed in single precision before they are added in double.
const PIECE: usize = 1024;

impl Normal {
    /// Products of the pictures and the weights' sum, without a window.
    ///
    /// Noise of the template comes with its own blur, of opposite sign: fitted as it is, focus would be taken for changed because
    /// a blurred template has less noise. `bend_noise` a pixel takes that out.
    pub fn of_basis(basis: &Basis, weights: &[f32], bend_noise: f64) -> Self {
        let mut products = Matrix::zeros();
        let mut weighted = vec![0.0; PIECE.min(weights.len())];
        for from in (0..weights.len()).step_by(PIECE) {
            let to = (from + PIECE).min(weights.len());
            let weighted = &mut weighted[..to - from];
            for i in 0..PICTURES {
                for ((out, value), weight) in weighted.iter_mut().zip(&basis[i][from..to]).zip(&weights[from..to]) {
                    *out = value * weight;
                }
                for j in i..PICTURES {
                    products[(i, j)] += dot(weighted, &basis[j][from..to]);
                }
            }
        }
        let weight = weights.iter().map(|w| f64::from(*w)).sum();
        products[(TEMPLATE, BLUR)] += bend_noise * weight;
        products.fill_lower_triangle_with_upper_triangle();
        Self { products, with_window: Vector::zeros(), window: 0.0, weight }
    }

    /// Sets the window.
    pub fn set_window(&mut self, basis: &Basis, weights: &[f32], window: &[f32]) {
        (self.with_window, self.window) = (Vector::zeros(), 0.0);
        let mut weighted = vec![0.0; PIECE.min(weights.len())];
        for from in (0..weights.len()).step_by(PIECE) {
            let to = (from + PIECE).min(weights.len());
            let weighted = &mut weighted[..to - from];
            for ((out, value), weight) in weighted.iter_mut().zip(&window[from..to]).zip(&weights[from..to]) {
                *out = value * weight;
            }
            for (i, picture) in basis.iter().enumerate() {
                self.with_window[i] += dot(weighted, &picture[from..to]);
            }
            self.window += dot(weighted, &window[from..to]);
        }
    }

    fn factored(&self) -> Option<Cholesky<f64, nalgebra::Const<PICTURES>>> {
        let mut held = self.products;
        for i in 0..PICTURES {
            held[(i, i)] *= 1.0 + 1e-7;
            held[(i, i)] += 1e-12 * self.weight;
        }
        held.cholesky()
    }

    /// Factors of the pictures; `None` where the weights leave nothing.
    pub fn factors(&self) -> Option<Vector> {
        Some(self.factored()?.solve(&self.with_window))
    }

    /// Inverse of the products.
    pub fn inverse(&self) -> Option<Matrix> {
        Some(self.factored()?.inverse())
    }

    /// Sum of squares that pictures from `first` on leave, the slopes never among them.
    fn left(&self, first: usize) -> Option<f64> {
        let mut products = Matrix6::identity();
        let mut right = nalgebra::Vector6::zeros();
        for i in first..PICTURES {
            for j in first..PICTURES {
                products[(i - 1, j - 1)] = self.products[(i, j)];
            }
            products[(i - 1, i - 1)] *= 1.0 + 1e-9;
            products[(i - 1, i - 1)] += 1e-12 * self.weight;
            right[i - 1] = self.with_window[i];
        }
        let solved = products.cholesky()?.solve(&right);
        Some((self.window - solved.dot(&right)).max(0.0))
    }

    /// Correlation of window and template beyond a plane of light and a change of focus; zero where there is no contrast.
    pub fn correlation(&self) -> f64 {
        let Some((light, all)) = self.left(LIGHT).zip(self.left(TEMPLATE)) else { return 0.0 };
        if light <= 1e-9 * self.weight * f64::from(f32::EPSILON) {
            return 0.0;
        }
        (1.0 - all / light).max(0.0).sqrt()
    }
}
