//! Polynomials in `s` or `z` with real coefficients, the constant first.

use std::ops::{Add, Mul};

use nalgebra::{Complex, DMatrix, Schur};

/// Coefficients, the constant first; never empty.
#[derive(Debug, Clone, PartialEq)]
pub struct Polynomial(Vec<f64>);

impl Polynomial {
    /// Of coefficients, the constant first; leading zeros fall away.
    pub fn new(mut coefficients: Vec<f64>) -> Self {
        while coefficients.len() > 1 && coefficients.last() == Some(&0.0) {
            coefficients.pop();
        }
        if coefficients.is_empty() {
            coefficients.push(0.0);
        }
        Self(coefficients)
    }

    /// `factor * x^power`.
    pub fn monomial(factor: f64, power: usize) -> Self {
        let mut coefficients = vec![0.0; power + 1];
        coefficients[power] = factor;
        Self::new(coefficients)
    }

    /// Degree; 0 for a constant.
    pub fn degree(&self) -> usize {
        self.0.len() - 1
    }

    /// The coefficient of `x^power`, 0 beyond the degree.
    pub fn at(&self, power: usize) -> f64 {
        self.0.get(power).copied().unwrap_or(0.0)
    }

    /// Coefficients, the constant first.
    pub fn coefficients(&self) -> &[f64] {
        &self.0
    }

    /// The coefficient of the highest power.
    pub fn leading(&self) -> f64 {
        self.at(self.degree())
    }

    /// Every coefficient times a factor.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self::new(self.0.iter().map(|c| factor * c).collect())
    }

    /// The polynomial in `x` that has the value of this one at `factor x`.
    #[must_use]
    pub fn stretched(&self, factor: f64) -> Self {
        let mut power = 1.0;
        let each = self.0.iter().map(|c| {
            let own = c * power;
            power *= factor;
            own
        });
        Self::new(each.collect())
    }

    /// The value at a complex number.
    pub fn value(&self, x: Complex<f64>) -> Complex<f64> {
        self.0.iter().rev().fold(Complex::new(0.0, 0.0), |sum, c| sum * x + c)
    }

    /// This minus its constant, divided by `x`.
    #[must_use]
    pub fn lowered(&self) -> Self {
        Self::new(self.0.iter().skip(1).copied().collect())
    }

    /// All complex roots, as eigenvalues of the companion matrix; none if the iteration fails or a coefficient is no number.
    pub fn roots(&self) -> Option<Vec<Complex<f64>>> {
        let n = self.degree();
        if n == 0 || self.0.iter().any(|c| !c.is_finite()) {
            return (n == 0).then(Vec::new);
        }
        // Roots of about unit size: coefficients over many powers of ten spoil the eigenvalues.
        let size = (self.0[0] / self.leading()).abs().powf(1.0 / n as f64);
        let size = if size.is_finite() && size > 0.0 { size } else { 1.0 };
        let unit = self.stretched(size);
        let companion = DMatrix::from_fn(n, n, |i, j| {
            if i + 1 == n { -unit.at(j) / unit.leading() } else { f64::from(u8::from(j == i + 1)) }
        });
        let schur = Schur::try_new(companion, f64::EPSILON, 1000)?;
        Some(schur.complex_eigenvalues().iter().map(|root| root * size).collect())
    }
}

impl Mul for &Polynomial {
    type Output = Polynomial;

    fn mul(self, other: Self) -> Polynomial {
        let mut product = vec![0.0; self.0.len() + other.0.len() - 1];
        for (i, a) in self.0.iter().enumerate() {
            for (j, b) in other.0.iter().enumerate() {
                product[i + j] += a * b;
            }
        }
        Polynomial::new(product)
    }
}

impl Add for &Polynomial {
    type Output = Polynomial;

    fn add(self, other: Self) -> Polynomial {
        let length = self.0.len().max(other.0.len());
        Polynomial::new((0..length).map(|i| self.at(i) + other.at(i)).collect())
    }
}
