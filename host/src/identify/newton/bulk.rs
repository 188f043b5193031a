//! Coordinates in which a bulk that relaxes acts smoothly: its compressibility at once and after all relaxation.
//!
//! The force of a nearly incompressible solid hardly changes with how its bulk relaxes, and that of a soft bulk changes steeply where almost all of it relaxes. What
//! decides both is the compressibility that is left in the end, `D (1 - g) / (1 - k)` of the shear modulus that is left. In its logarithm forces are smooth.

/// Places of the coordinates that decide the bulk.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Bulk {
    /// Of `ln(D_1 mu_0)`.
    pub compressibility: usize,
    /// Of the relaxing part of the shear modulus.
    pub g: usize,
    /// Of the relaxing part of the bulk modulus, below 1.
    pub k: usize,
}

impl Bulk {
    /// The point with the logarithm of the last compressibility in place of `k`.
    #[must_use]
    pub fn place(&self, x: &[f64]) -> Vec<f64> {
        let mut place = x.to_vec();
        place[self.k] = x[self.compressibility] + (-x[self.g]).ln_1p() - (-x[self.k]).ln_1p();
        place
    }

    /// Derivatives `by[coordinate][value]` at `x`, turned into those by [`Bulk::place`]'s coordinates.
    pub fn turn(&self, x: &[f64], by: &mut [Vec<f64>]) {
        let last = 1.0 - x[self.k];
        by[self.k].iter_mut().for_each(|v| *v *= last);
        let own = by[self.k].clone();
        by[self.compressibility].iter_mut().zip(&own).for_each(|(v, own)| *v -= own);
        by[self.g].iter_mut().zip(&own).for_each(|(v, own)| *v += own / (1.0 - x[self.g]));
    }

    /// Lengths of the ranges in those coordinates, of those in the fit's own.
    pub fn stretch(&self, widths: &mut [f64]) {
        widths[self.k] = widths[self.compressibility];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Slopes along the new coordinates, turned back by the chain rule as a quotient of differences, are those along the old ones.
    #[test]
    fn slopes_are_turned_as_the_chain_rule_says() {
        let bulk = Bulk { compressibility: 1, g: 2, k: 3 };
        let f = |z: &[f64]| z[0] + 2.0 * z[1] + 3.0 * z[2] + 5.0 * z[3];
        let x = [0.3, (0.2_f64).ln(), 0.7, 0.4];
        let slope = |axis: usize| {
            let moved = |h: f64| {
                let mut x = x;
                x[axis] += h;
                f(&bulk.place(&x))
            };
            vec![(moved(1e-6) - moved(-1e-6)) / 2e-6]
        };
        let mut by: Vec<Vec<f64>> = (0..4).map(slope).collect();
        bulk.turn(&x, &mut by);
        // The quotients are exact to the square of their step over its rounding, 1e-9.
        for (by, exact) in by.iter().zip([1.0, 2.0, 3.0, 5.0]) {
            assert!((by[0] - exact).abs() < 1e-6, "{by:?} {exact}");
        }
        // Parts that are equal leave the compressibility where it was.
        let place = bulk.place(&[0.3, (0.2_f64).ln(), 0.7, 0.7]);
        assert!((place[1] - place[3]).abs() < 1e-12, "{place:?}");
    }
}
