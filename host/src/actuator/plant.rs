//! The plant: command in V to shaft in mm, as a transfer function with a dead time.

use nalgebra::{Complex, DMatrix, DVector};

use super::polynomial::Polynomial;

/// `numerator / denominator * exp(-delay_s s)`, strictly proper, the denominator monic.
#[derive(Debug, Clone, PartialEq)]
pub struct Plant {
    /// mm/V times powers of 1/s.
    pub numerator: Polynomial,
    /// Monic, order 1 to 6.
    pub denominator: Polynomial,
    /// Dead time, s.
    pub delay_s: f64,
}

impl Plant {
    /// From coefficients with the highest power first, as they are written.
    pub fn of(numerator: &[f64], denominator: &[f64], delay_s: f64) -> Self {
        let read = |list: &[f64]| Polynomial::new(list.iter().rev().copied().collect());
        let (numerator, denominator) = (read(numerator), read(denominator));
        let lead = denominator.leading();
        Self { numerator: numerator.scaled(1.0 / lead), denominator: denominator.scaled(1.0 / lead), delay_s }
    }

    /// The thesis' actuator, 86/(s^2 + 23.4 s + 86) (section 5.5).
    pub fn thesis() -> Self {
        Self::of(&[86.0], &[1.0, 23.4, 86.0], 0.0)
    }

    /// Order of the denominator.
    pub fn order(&self) -> usize {
        self.denominator.degree()
    }

    /// The frequency response at `w_rad_s`, mm/V.
    pub fn response(&self, w_rad_s: f64) -> Complex<f64> {
        let s = Complex::new(0.0, w_rad_s);
        self.numerator.value(s) / self.denominator.value(s) * Complex::from_polar(1.0, -w_rad_s * self.delay_s)
    }

    /// State space without the dead time: `x' = A x + b u`, `y = c x`, controllable companion form.
    pub fn state_space(&self) -> (DMatrix<f64>, DVector<f64>, DVector<f64>) {
        let n = self.order();
        let a =
            DMatrix::from_fn(
                n,
                n,
                |i, j| {
                    if i + 1 == n { -self.denominator.at(j) } else { f64::from(u8::from(j == i + 1)) }
                },
            );
        let b = DVector::from_fn(n, |i, _| f64::from(u8::from(i + 1 == n)));
        let c = DVector::from_fn(n, |i, _| self.numerator.at(i));
        (a, b, c)
    }

    /// `exp(A h)` and the integral of `exp(A s) b` over `h`, exact for a held command.
    pub fn held(&self, h_s: f64) -> (DMatrix<f64>, DVector<f64>) {
        let (a, b, _) = self.state_space();
        let n = self.order();
        let mut whole = DMatrix::zeros(n + 1, n + 1);
        whole.view_mut((0, 0), (n, n)).copy_from(&(a * h_s));
        whole.view_mut((0, n), (n, 1)).copy_from(&(b * h_s));
        let exponential = whole.exp();
        (exponential.view((0, 0), (n, n)).into_owned(), exponential.column(n).rows(0, n).into_owned())
    }
}
