//! Field strength over flux density: what a material of a magnet is.
//!
//! Flux densities are in T, field strengths in A/mm.

/// Permeability of the vacuum, T mm/A.
pub const MU_0: f64 = 4e-4 * std::f64::consts::PI;

/// A law that cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LawError {
    /// A table is too short.
    #[error("the table has {found} points, expected at least 2")]
    Short {
        /// How many.
        found: usize,
    },
    /// The first point is not the origin.
    #[error("the table begins at B = {b_t} T, H = {h_a_m} A/m, expected 0, 0 (magnets: H counted from -Hc)")]
    Origin {
        /// Its flux density, T.
        b_t: f64,
        /// Its field strength, A/m.
        h_a_m: f64,
    },
    /// B or H do not rise.
    #[error("point {point} of the table (B = {b_t} T, H = {h_a_m} A/m) does not rise above the one before")]
    Falls {
        /// Number of the point, from 1.
        point: usize,
        /// Its flux density, T.
        b_t: f64,
        /// Its field strength, A/m.
        h_a_m: f64,
    },
    /// A number is out of its range.
    #[error("{what} is {value}, expected {expected}")]
    Value {
        /// Which.
        what: &'static str,
        /// The number.
        value: f64,
        /// What was expected.
        expected: &'static str,
    },
}

/// How a table is read between its points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Between {
    /// Cubics of H over B that rise wherever the points do (Hyman, SIAM J. Sci. Stat. Comput. 4, 1983); beyond the last
    /// point the slope of the vacuum, for the material is taken as saturated there.
    #[default]
    Monotone,
    /// Straight lines of H over B; beyond the last point the last line goes on.
    Straight,
}

/// A table of flux density and field strength.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    b_t: Vec<f64>,
    h: Vec<f64>,
    /// Slope of H over B at each point, A/mm per T; empty where lines are straight.
    slope: Vec<f64>,
    /// Energy density up to each point, T A/mm.
    energy: Vec<f64>,
}

impl Table {
    /// A table of (B in T, H in A/m).
    ///
    /// # Errors
    /// [`LawError`] unless it begins at the origin and both rise.
    pub fn new(points: &[(f64, f64)], between: Between) -> Result<Self, LawError> {
        if points.len() < 2 {
            return Err(LawError::Short { found: points.len() });
        }
        let (b_t, h_a_m) = points[0];
        if b_t != 0.0 || h_a_m != 0.0 {
            return Err(LawError::Origin { b_t, h_a_m });
        }
        for (i, pair) in points.windows(2).enumerate() {
            let (b_t, h_a_m) = pair[1];
            let rises = b_t > pair[0].0 && h_a_m > pair[0].1 && (b_t + h_a_m).is_finite();
            if !rises {
                return Err(LawError::Falls { point: i + 2, b_t, h_a_m });
            }
        }
        let b_t: Vec<f64> = points.iter().map(|p| p.0).collect();
        let h: Vec<f64> = points.iter().map(|p| p.1 / 1000.0).collect();
        let slope = if between == Between::Monotone { monotone(&b_t, &h) } else { Vec::new() };
        let mut table = Table { b_t, h, slope, energy: vec![0.0] };
        for i in 1..table.b_t.len() {
            let up_to = table.within(i, table.b_t[i]).energy;
            table.energy.push(up_to);
        }
        Ok(table)
    }

    /// On the piece that ends at point `i`, from what is known up to its beginning.
    fn within(&self, i: usize, b_t: f64) -> Strength {
        let (b0, h0, energy) = (self.b_t[i - 1], self.h[i - 1], self.energy[i - 1]);
        let (width, rise) = (self.b_t[i] - b0, self.h[i] - h0);
        let more = b_t - b0;
        if self.slope.is_empty() {
            let h = h0 + rise / width * more;
            return Strength { h, slope: rise / width, energy: energy + 0.5 * (h0 + h) * more };
        }
        // Hermite's cubic by its powers.
        let (first, last, mean) = (self.slope[i - 1], self.slope[i], rise / width);
        let c2 = (3.0 * mean - 2.0 * first - last) / width;
        let c3 = (first + last - 2.0 * mean) / (width * width);
        Strength {
            h: h0 + more * (first + more * (c2 + more * c3)),
            slope: first + more * (2.0 * c2 + more * 3.0 * c3),
            energy: energy + more * (h0 + more * (first / 2.0 + more * (c2 / 3.0 + more * c3 / 4.0))),
        }
    }

    fn at(&self, b_t: f64) -> Strength {
        let end = self.b_t.len() - 1;
        let i = self.b_t.partition_point(|own| *own <= b_t);
        if i <= end || self.slope.is_empty() {
            return self.within(i.clamp(1, end), b_t);
        }
        let (slope, more) = (1.0 / MU_0, b_t - self.b_t[end]);
        let h = self.h[end] + slope * more;
        Strength { h, slope, energy: self.energy[end] + 0.5 * (self.h[end] + h) * more }
    }
}

/// Slopes at the points with which the cubics between them rise.
pub(super) fn monotone(x: &[f64], y: &[f64]) -> Vec<f64> {
    let last = x.len() - 1;
    let width: Vec<f64> = x.windows(2).map(|w| w[1] - w[0]).collect();
    let mean: Vec<f64> = y.windows(2).zip(&width).map(|(w, width)| (w[1] - w[0]) / width).collect();
    // At an end the parabola through three points, held between three of the mean slopes and a twentieth: where H does
    // not rise, the permeability would have no bound.
    let end = |near: usize, next: usize| {
        let slope =
            ((2.0 * width[near] + width[next]) * mean[near] - width[near] * mean[next]) / (width[near] + width[next]);
        slope.clamp(0.05 * mean[near], 3.0 * mean[near])
    };
    (0..=last)
        .map(|i| match i {
            _ if last == 1 => mean[0],
            0 => end(0, 1),
            i if i == last => end(last - 1, last - 2),
            // Inside the parabola's slope, which is good to second order, within three of the smaller mean.
            i => {
                let parabola = (width[i] * mean[i - 1] + width[i - 1] * mean[i]) / (width[i - 1] + width[i]);
                parabola.min(3.0 * mean[i - 1].min(mean[i]))
            }
        })
        .collect()
}

/// Field strength at a flux density, its slope, and the energy density up to there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Strength {
    /// A/mm.
    pub h: f64,
    /// A/mm per T.
    pub slope: f64,
    /// T A/mm, which is 1000 J/m^3.
    pub energy: f64,
}

/// An isotropic law without hysteresis.
#[derive(Debug, Clone, PartialEq)]
pub enum Law {
    /// A constant permeability, as a multiple of the vacuum's.
    Linear(f64),
    /// A table.
    Table(Table),
    /// A fluid of iron particles in oil with this part of its volume iron: Eq. 39 of the thesis, after Carlson (2005),
    /// B = 1.91 phi^1.133 (1 - exp(-10.97 mu_0 H)) + mu_0 H.
    Fluid(f64),
}

impl Law {
    /// A constant permeability.
    ///
    /// # Errors
    /// [`LawError::Value`] unless it is above nothing.
    pub fn linear(permeability: f64) -> Result<Self, LawError> {
        if permeability > 0.0 && permeability.is_finite() {
            return Ok(Law::Linear(permeability));
        }
        Err(LawError::Value { what: "the relative permeability", value: permeability, expected: "more than 0" })
    }

    /// A fluid by its volume fraction of iron.
    ///
    /// # Errors
    /// [`LawError::Value`] unless it is between 0 and 0.5, as LORD's fluids are.
    pub fn fluid(fraction: f64) -> Result<Self, LawError> {
        if fraction > 0.0 && fraction <= 0.5 {
            return Ok(Law::Fluid(fraction));
        }
        Err(LawError::Value {
            what: "the volume fraction of iron",
            value: fraction,
            expected: "more than 0, at most 0.5",
        })
    }

    /// The same law with a factor on its magnetisation: a batch of steel that saturates earlier or later. Of a table the flux
    /// densities are multiplied; a fluid gets another fraction of iron.
    ///
    /// # Errors
    /// [`LawError`] for a factor that is not positive, or that leaves the range of a fluid.
    pub fn with_flux(&self, factor: f64) -> Result<Self, LawError> {
        if !(factor > 0.0 && factor.is_finite()) {
            return Err(LawError::Value { what: "the factor of the flux", value: factor, expected: "more than 0" });
        }
        Ok(match self {
            Law::Linear(permeability) => Law::linear(permeability * factor)?,
            Law::Fluid(fraction) => Law::fluid(fraction * factor.powf(1.0 / CARLSON.1))?,
            Law::Table(table) => {
                let points = table.b_t.iter().zip(&table.h).map(|(b, h)| (factor * b, 1000.0 * h));
                let between = if table.slope.is_empty() { Between::Straight } else { Between::Monotone };
                Law::Table(Table::new(&points.collect::<Vec<_>>(), between)?)
            }
        })
    }

    /// Field strength at a flux density that is not negative.
    #[must_use]
    pub fn at(&self, b_t: f64) -> Strength {
        match self {
            Law::Linear(permeability) => {
                let slope = 1.0 / (permeability * MU_0);
                Strength { h: slope * b_t, slope, energy: 0.5 * slope * b_t * b_t }
            }
            Law::Table(table) => table.at(b_t),
            Law::Fluid(fraction) => Carlson::of(*fraction).at(b_t),
        }
    }
}

/// Coefficients of Carlson's law: saturation (T, at a fraction of 1), its exponent, and the rate (1/T).
const CARLSON: (f64, f64, f64) = (1.91, 1.133, 10.97);

/// Flux density below which the fluid's law is solved by Newton's method: the closed form loses digits to cancellation.
const WEAK_T: f64 = 2e-3;

/// Carlson's law of one fluid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Carlson {
    /// What the iron adds at saturation m, T.
    most: f64,
    /// `ln(c m) + c m`, c the rate.
    start: f64,
}

impl Carlson {
    /// The law of a volume fraction of iron.
    pub fn of(fraction: f64) -> Self {
        let most = CARLSON.0 * fraction.powf(CARLSON.1);
        Self { most, start: (CARLSON.2 * most).ln() + CARLSON.2 * most }
    }

    /// The law solved for `x = mu_0 H`: `w = c (x - B + m)` has `w + ln w = ln(c m) + c (m - B)`, and
    /// `exp(-c x) = w / (c m)`.
    pub fn at(&self, b_t: f64) -> Strength {
        let (most, rate) = (self.most, CARLSON.2);
        let (x, left) = if b_t < WEAK_T {
            let x = weak(most, b_t);
            (x, (-rate * x).exp())
        } else {
            let w = wright_omega(self.start - rate * b_t);
            (b_t - most + w / rate, w / (rate * most))
        };
        let rise = most * rate * left + 1.0;
        // Energy is B H less the integral of B over H.
        let coenergy = most * (x + (left - 1.0) / rate) + 0.5 * x * x;
        Strength { h: x / MU_0, slope: 1.0 / (rise * MU_0), energy: (b_t * x - coenergy) / MU_0 }
    }
}

/// `mu_0 H` by Newton's method. B over H is concave, so from the left the steps never pass the root.
fn weak(most: f64, b_t: f64) -> f64 {
    let mut x = b_t / (most * CARLSON.2 + 1.0);
    for _ in 0..50 {
        let gone = -(-CARLSON.2 * x).exp_m1();
        let step = (b_t - most * gone - x) / (most * CARLSON.2 * (1.0 - gone) + 1.0);
        x += step;
        if step.abs() <= 1e-14 * x {
            break;
        }
    }
    x
}

/// The `w` with `w + ln w = z`: starts and iteration (fourth order) of Lawrence, Corless and Jeffrey, ACM Trans. Math. Softw. 38
/// (2012) 20, doi:10.1145/2168773.2168779. Relative error below 1e-14.
fn wright_omega(z: f64) -> f64 {
    let mut w = if z < -2.0 {
        let t = z.exp();
        t * (1.0 - t * (1.0 - 1.5 * t))
    } else if z < 4.0 {
        let t = z - 1.0;
        const BY_POWERS: [f64; 7] =
            [-47.0 / 1_474_560.0, 13.0 / 61_440.0, -1.0 / 3072.0, -1.0 / 192.0, 1.0 / 16.0, 0.5, 1.0];
        BY_POWERS.iter().fold(0.0, |sum, c| sum * t + c)
    } else {
        let t = z.ln();
        z - t + t / z
    };
    for _ in 0..3 {
        let rest = z - w - w.ln();
        if rest.abs() < 1e-15 * (1.0 + z.abs()) {
            break;
        }
        let two = 2.0 * (1.0 + w) * (1.0 + w + 2.0 / 3.0 * rest);
        w *= 1.0 + rest / (1.0 + w) * (two - rest) / (two - 2.0 * rest);
        // what is left after one step is its fourth power
        if rest.abs() < 1e-4 {
            break;
        }
    }
    w
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn laws() -> [Law; 4] {
        let points = [(0.0, 0.0), (0.5, 300.0), (1.2, 1500.0), (1.9, 20_000.0)];
        let table = |between| Law::Table(Table::new(&points, between).unwrap());
        let [straight, smooth] = [Between::Straight, Between::Monotone].map(table);
        [Law::linear(500.0).unwrap(), straight, smooth, Law::fluid(0.22).unwrap()]
    }

    #[test]
    fn strength_is_the_slope_of_the_energy_and_its_slope_that_of_the_strength() {
        for law in laws() {
            for b_t in [0.01, 0.2, 0.4, 0.9, 1.6, 2.5] {
                let step = 1e-6;
                let [minus, at, plus] = [b_t - step, b_t, b_t + step].map(|b| law.at(b));
                let quotient = |of: fn(&Strength) -> f64| (of(&plus) - of(&minus)) / (2.0 * step);
                assert!((quotient(|s| s.energy) / at.h - 1.0).abs() < 1e-5, "{law:?} at {b_t} T");
                assert!((quotient(|s| s.h) / at.slope - 1.0).abs() < 1e-5, "{law:?} at {b_t} T");
            }
            assert_eq!(law.at(0.0).h, 0.0);
        }
    }

    #[test]
    fn a_factor_of_the_flux_multiplies_b_at_the_same_h() {
        let law = &laws()[1];
        let more = law.with_flux(1.1).unwrap();
        for b_t in [0.2, 0.9, 1.7] {
            assert!((more.at(1.1 * b_t).h / law.at(b_t).h - 1.0).abs() < 1e-12);
        }
        assert!(law.with_flux(0.0).is_err() && Law::Fluid(0.45).with_flux(1.5).is_err());
    }

    #[test]
    fn the_fluid_is_carlsons_law() {
        let law = Law::fluid(0.22).unwrap();
        for h_a_m in [1e3, 5e4, 2e5, 1e6_f64] {
            let x = 4e-7 * std::f64::consts::PI * h_a_m;
            let b_t = 1.91 * 0.22_f64.powf(1.133) * (1.0 - (-10.97 * x).exp()) + x;
            assert!((law.at(b_t).h * 1000.0 / h_a_m - 1.0).abs() < 1e-11, "{h_a_m}");
        }
    }

    #[test]
    fn the_fluid_is_solved_to_rounding_at_every_flux() {
        for fraction in [0.01, 0.22, 0.5] {
            let most = CARLSON.0 * f64::powf(fraction, CARLSON.1);
            for i in 0..4000 {
                let b_t = 1e-5 * 1.0035_f64.powi(i);
                let x = Carlson::of(fraction).at(b_t).h * MU_0;
                let back = most * -(-CARLSON.2 * x).exp_m1() + x;
                // the closed form is a difference of numbers of the saturation's size
                assert!((back / b_t - 1.0).abs() < 1e-14 + 5e-15 / b_t.max(WEAK_T), "{fraction} {b_t}: {back}");
            }
        }
    }

    #[test]
    fn what_is_no_law_is_told_with_its_place() {
        let text = |points: &[(f64, f64)]| Table::new(points, Between::Monotone).unwrap_err().to_string();
        assert_eq!(text(&[(0.0, 0.0)]), "the table has 1 points, expected at least 2");
        assert!(text(&[(0.1, 0.0), (1.0, 5.0)]).contains("begins at B = 0.1 T"));
        assert_eq!(
            text(&[(0.0, 0.0), (1.0, 5.0), (0.9, 6.0)]),
            "point 3 of the table (B = 0.9 T, H = 6 A/m) does not rise above the one before"
        );
        assert_eq!(
            Law::fluid(0.7).unwrap_err().to_string(),
            "the volume fraction of iron is 0.7, expected more than 0, at most 0.5"
        );
    }
}
