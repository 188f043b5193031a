//! Numbers that may carry a derivative: one code gives the force and its sensitivities.
//!
//! Everything that depends on a parameter (laws, relaxation, contact, geometry) is written
//! over [`Real`]. With `f64` it is the plain solver; with [`Dual`] the same lines carry the
//! derivative by one parameter (forward differentiation; Griewank and Walther, Evaluating
//! Derivatives, 2008, ch. 3).

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// A real number, plain or with its derivative.
pub trait Real:
    Copy
    + std::fmt::Debug
    + PartialEq
    + Send
    + Sync
    + From<f64>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
    + AddAssign
{
    /// The number without its derivative.
    fn value(self) -> f64;
    /// Its derivative; 0 for a plain number.
    fn derivative(self) -> f64;
    /// `f(x)` from the value `y = f(x)` and the slope `f'(x)` at the value.
    fn chain(self, y: f64, slope: f64) -> Self;

    /// Natural logarithm.
    fn ln(self) -> Self {
        self.chain(self.value().ln(), 1.0 / self.value())
    }
    /// Exponential.
    fn exp(self) -> Self {
        let y = self.value().exp();
        self.chain(y, y)
    }
    /// `exp(x) - 1` without cancellation.
    fn exp_m1(self) -> Self {
        let y = self.value().exp_m1();
        self.chain(y, y + 1.0)
    }
    /// Square root; the argument must not be 0 when a derivative is carried.
    fn sqrt(self) -> Self {
        let y = self.value().sqrt();
        self.chain(y, 0.5 / y)
    }
    /// Error function.
    fn erf(self) -> Self {
        let x = self.value();
        self.chain(libm::erf(x), std::f64::consts::FRAC_2_SQRT_PI * (-x * x).exp())
    }
    /// Angle of the point `(x, self)`, as [`f64::atan2`].
    fn atan2(self, x: Self) -> Self {
        let (b, a) = (self.value(), x.value());
        let square = a * a + b * b;
        let slope = (self * a - x * b) / square;
        // value of the angle, derivative of the quotient
        slope.chain(b.atan2(a), 1.0)
    }
}

impl Real for f64 {
    fn value(self) -> f64 {
        self
    }
    fn derivative(self) -> f64 {
        0.0
    }
    fn chain(self, y: f64, _: f64) -> Self {
        y
    }
    fn ln(self) -> Self {
        f64::ln(self)
    }
    fn exp(self) -> Self {
        f64::exp(self)
    }
    fn exp_m1(self) -> Self {
        f64::exp_m1(self)
    }
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
    fn atan2(self, x: Self) -> Self {
        f64::atan2(self, x)
    }
}

/// A number with its derivative by one parameter.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Dual {
    /// The number.
    pub value: f64,
    /// Its derivative.
    pub derivative: f64,
}

impl Dual {
    /// A number and its derivative.
    #[must_use]
    pub fn new(value: f64, derivative: f64) -> Self {
        Self { value, derivative }
    }
}

impl Real for Dual {
    fn value(self) -> f64 {
        self.value
    }
    fn derivative(self) -> f64 {
        self.derivative
    }
    fn chain(self, y: f64, slope: f64) -> Self {
        Self::new(y, slope * self.derivative)
    }
}

impl From<f64> for Dual {
    fn from(value: f64) -> Self {
        Self::new(value, 0.0)
    }
}

impl Add for Dual {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self::new(self.value + o.value, self.derivative + o.derivative)
    }
}

impl Sub for Dual {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        Self::new(self.value - o.value, self.derivative - o.derivative)
    }
}

impl Mul for Dual {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        Self::new(self.value * o.value, self.derivative * o.value + self.value * o.derivative)
    }
}

impl Div for Dual {
    type Output = Self;
    fn div(self, o: Self) -> Self {
        let y = self.value / o.value;
        Self::new(y, (self.derivative - y * o.derivative) / o.value)
    }
}

impl Neg for Dual {
    type Output = Self;
    fn neg(self) -> Self {
        Self::new(-self.value, -self.derivative)
    }
}

impl Add<f64> for Dual {
    type Output = Self;
    fn add(self, o: f64) -> Self {
        Self::new(self.value + o, self.derivative)
    }
}

impl Sub<f64> for Dual {
    type Output = Self;
    fn sub(self, o: f64) -> Self {
        Self::new(self.value - o, self.derivative)
    }
}

impl Mul<f64> for Dual {
    type Output = Self;
    fn mul(self, o: f64) -> Self {
        Self::new(self.value * o, self.derivative * o)
    }
}

impl Div<f64> for Dual {
    type Output = Self;
    fn div(self, o: f64) -> Self {
        Self::new(self.value / o, self.derivative / o)
    }
}

impl AddAssign for Dual {
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every function against its central difference: truncation 1e-10, rounding 1e-11.
    #[test]
    fn derivatives_are_those_of_the_functions() {
        type Function = fn(Dual) -> Dual;
        let functions: [(&str, Function); 9] = [
            ("ln", |x| x.ln()),
            ("exp", |x| x.exp()),
            ("exp_m1", |x| x.exp_m1()),
            ("sqrt", |x| x.sqrt()),
            ("erf", |x| x.erf()),
            ("atan2", |x| (x * x).atan2(x - 2.0)),
            ("quotient", |x| (x * 3.0 - 1.0) / (x * x + 0.5)),
            ("difference", |x| -(Dual::from(2.0) - x) / 3.0 + x),
            ("product", |x| x * x * x),
        ];
        for (name, f) in functions {
            for x in [0.3, 1.0, 1.7] {
                let h = 1e-5;
                let difference = (f(Dual::from(x + h)).value - f(Dual::from(x - h)).value) / (2.0 * h);
                let exact = f(Dual::new(x, 1.0)).derivative;
                assert!((difference - exact).abs() < 1e-9 * (1.0 + exact.abs()), "{name} at {x}: {difference} {exact}");
            }
        }
    }

    #[test]
    fn plain_numbers_have_no_derivative() {
        assert_eq!(3.0.derivative(), 0.0);
        assert_eq!(Real::value(3.0), 3.0);
    }
}
