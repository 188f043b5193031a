//! Coordinates in which a bulk that gives way acts smoothly: its Poisson's ratios at once and after all relaxation.
//!
//! The force of a nearly incompressible solid does not change with the logarithm of its compressibility, nor with how its bulk
//! relaxes; it changes evenly with Poisson's ratio. Where bulk and shear relax alike the ratio stays as it is.

/// Places of the coordinates that decide the bulk.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bulk {
    /// Of `ln(D_1 mu_0)`.
    pub compressibility: usize,
    /// Of the relaxing parts of shear and bulk, with one Prony term.
    pub relaxing: Option<(usize, usize)>,
}

/// Poisson's ratio of a solid of compressibility `D mu`, and its derivative by the logarithm of that.
fn ratio(d_mu: f64) -> (f64, f64) {
    ((3.0 - d_mu) / (6.0 + d_mu), -9.0 * d_mu / (6.0 + d_mu).powi(2))
}

impl Bulk {
    /// Compressibility after all relaxation: a softer bulk gives way more, a softer shear less.
    fn after(&self, x: &[f64], (g, k): (usize, usize)) -> f64 {
        x[self.compressibility].exp() * (1.0 - x[g]) / (1.0 - x[k])
    }

    /// The point in those coordinates: Poisson's ratio for the compressibility, the ratio after relaxation for the relaxing part of the bulk.
    #[must_use]
    pub fn place(&self, x: &[f64]) -> Vec<f64> {
        let mut place = x.to_vec();
        place[self.compressibility] = ratio(x[self.compressibility].exp()).0;
        if let Some(parts) = self.relaxing {
            place[parts.1] = ratio(self.after(x, parts)).0;
        }
        place
    }

    /// Derivatives `by[coordinate][value]` at `x`, turned into those by [`Bulk::place`]'s coordinates.
    pub fn turn(&self, x: &[f64], by: &mut [Vec<f64>]) {
        let at_once = ratio(x[self.compressibility].exp()).1;
        if let Some((g, k)) = self.relaxing {
            let later = ratio(self.after(x, (g, k))).1;
            let in_k = (1.0 - x[k]) / later;
            by[k].iter_mut().for_each(|v| *v *= in_k);
            let own = by[k].clone();
            by[self.compressibility].iter_mut().zip(&own).for_each(|(v, own)| *v -= later * own);
            by[g].iter_mut().zip(&own).for_each(|(v, own)| *v += later / (1.0 - x[g]) * own);
        }
        by[self.compressibility].iter_mut().for_each(|v| *v /= at_once);
    }

    /// Lengths of the ranges in those coordinates, of those in the fit's own: Poisson's ratios of isotropic solids lie between -1 and 0.5, mostly above 0.
    pub fn stretch(&self, widths: &mut [f64]) {
        widths[self.compressibility] = 0.5;
        if let Some((_, k)) = self.relaxing {
            widths[k] = 0.5;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Slopes along the new coordinates, turned back by the chain rule as a quotient of differences, are those along the old ones.
    #[test]
    fn slopes_are_turned_as_the_chain_rule_says() {
        let bulk = Bulk { compressibility: 1, relaxing: Some((2, 3)) };
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
        // Parts that are equal leave Poisson's ratio where it was.
        let place = bulk.place(&[0.3, (0.2_f64).ln(), 0.7, 0.7]);
        assert!((place[1] - place[3]).abs() < 1e-12, "{place:?}");
    }
}
