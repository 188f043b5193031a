//! A yield stress over travel.

use faer::Mat;
use faer::linalg::solvers::SolveLstsq;

use crate::pad::error::{PadError, demand};

/// A yield stress (MPa) over travel (mm).
#[derive(Debug, Clone, PartialEq)]
pub enum Curve {
    /// `a u + b u^2 + c u^3` (MPa, travel u in mm): the thesis' three coefficients.
    Cubic([f64; 3]),
    /// Straight lines between knots (mm, MPa), from (0, 0) on.
    Knots(Vec<(f64, f64)>),
}

impl Curve {
    /// Yield stress at a travel (MPa).
    #[must_use]
    pub fn at(&self, u: f64) -> f64 {
        match self {
            Curve::Cubic([a, b, c]) => u * (a + u * (b + u * c)),
            Curve::Knots(knots) => along(knots, u),
        }
    }

    /// Its coefficients.
    pub(super) fn coefficients(&self) -> Vec<f64> {
        match self {
            Curve::Cubic(list) => list.to_vec(),
            Curve::Knots(knots) => knots.iter().map(|knot| knot.1).collect(),
        }
    }

    /// The same with other coefficients.
    pub(super) fn with(&self, coefficients: &[f64]) -> Self {
        match self {
            Curve::Cubic(_) => Curve::Cubic(std::array::from_fn(|i| coefficients[i])),
            Curve::Knots(knots) => Curve::Knots(knots.iter().zip(coefficients).map(|(k, c)| (k.0, *c)).collect()),
        }
    }

    /// What a coefficient of it counts in MPa at the end of the travel.
    pub(super) fn sizes(&self, most_mm: f64) -> Vec<f64> {
        match self {
            Curve::Cubic(_) => (1..=3).map(|power| most_mm.powi(power)).collect(),
            Curve::Knots(knots) => vec![1.0; knots.len()],
        }
    }

    /// The cubic nearest to stresses (MPa) at travels (mm), by least squares.
    ///
    /// # Errors
    /// [`PadError::Value`] for fewer than three.
    pub fn cubic_through(travel_mm: &[f64], stress_mpa: &[f64]) -> Result<Self, PadError> {
        let count = travel_mm.len().min(stress_mpa.len());
        demand(count >= 3, "the number of travels of a cubic", count as f64, "3 or more")?;
        let powers: Vec<Vec<f64>> =
            (1..=3).map(|power| travel_mm[..count].iter().map(|u| u.powi(power)).collect()).collect();
        let solved = least_squares(&powers, &stress_mpa[..count], 0.0);
        Ok(Curve::Cubic(std::array::from_fn(|k| solved[k])))
    }
}

/// Straight lines between knots, from (0, 0) on; beyond the last knot the last line goes on.
pub(super) fn along(knots: &[(f64, f64)], at: f64) -> f64 {
    let (mut from, mut last) = ((0.0, 0.0), (0.0, 0.0));
    for &to in knots {
        if at <= to.0 {
            let part = if to.0 > from.0 { (at - from.0) / (to.0 - from.0) } else { 1.0 };
            return from.1 + part * (to.1 - from.1);
        }
        (last, from) = (from, to);
    }
    let slope = if from.0 > last.0 { (from.1 - last.1) / (from.0 - last.0) } else { 0.0 };
    from.1 + slope * (at - from.0)
}

/// Least squares over columns, damped by a part of the longest of them.
pub(super) fn least_squares(columns: &[Vec<f64>], of: &[f64], damping: f64) -> Vec<f64> {
    let length = |column: &Vec<f64>| column.iter().map(|v| v * v).sum::<f64>().sqrt();
    let damping = damping * columns.iter().map(length).fold(0.0, f64::max);
    let (rows, count) = (of.len(), columns.len());
    let matrix = Mat::from_fn(rows + count, count, |i, k| match i.checked_sub(rows) {
        None => columns[k][i],
        Some(j) if j == k => damping,
        Some(_) => 0.0,
    });
    let side = Mat::from_fn(rows + count, 1, |i, _| of.get(i).copied().unwrap_or(0.0));
    let solved = matrix.col_piv_qr().solve_lstsq(&side);
    (0..count).map(|k| solved[(k, 0)]).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_cubic_goes_through_its_own_values() {
        let travels = [0.5, 1.0, 2.0, 3.0];
        let cubic = Curve::Cubic([1e-3, -2e-4, 3e-4]);
        let stresses: Vec<f64> = travels.iter().map(|u| cubic.at(*u)).collect();
        let Curve::Cubic(found) = Curve::cubic_through(&travels, &stresses).unwrap() else { return };
        for (a, b) in found.iter().zip([1e-3, -2e-4, 3e-4]) {
            assert!((a - b).abs() < 1e-12, "{found:?}");
        }
        assert!(Curve::cubic_through(&travels[..2], &stresses).unwrap_err().to_string().contains("3 or more"));
    }

    #[test]
    fn knots_are_joined_by_lines_and_the_last_goes_on() {
        let knots = Curve::Knots(vec![(1.0, 2.0), (3.0, 3.0)]);
        for (u, mpa) in [(0.0, 0.0), (0.5, 1.0), (1.0, 2.0), (2.0, 2.5), (5.0, 4.0)] {
            assert!((knots.at(u) - mpa).abs() < 1e-12, "{u}");
        }
    }
}
