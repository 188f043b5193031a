//! Yield stress of a magnetorheological fluid: f2 of the control curve, with its inverse.

use super::bh::{Law, LawError};

/// Yield stress of a fluid over its flux density.
#[derive(Debug, Clone, PartialEq)]
pub struct Fluid {
    law: Law,
    yields: Yields,
}

/// Yield stress over field strength.
#[derive(Debug, Clone, PartialEq)]
enum Yields {
    /// `most tanh(rate H)`: kPa and mm/A.
    Carlson { most_kpa: f64, rate: f64 },
    /// Points (H in A/mm, kPa) with cubics between them that rise; beyond the last the stress stays.
    Points(super::curve::Rising),
}

/// Oil that carries the iron: Carlson's factor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Oil {
    /// Hydrocarbon, 1.
    #[default]
    Hydrocarbon,
    /// Water, 1.16.
    Water,
    /// Silicone, 0.95.
    Silicone,
}

impl Oil {
    const fn factor(self) -> f64 {
        match self {
            Oil::Hydrocarbon => 1.0,
            Oil::Water => 1.16,
            Oil::Silicone => 0.95,
        }
    }
}

impl Fluid {
    /// A fluid of LORD's kind by the part of its volume that is iron. Carlson, Int. J. Mod. Phys. B 19, 2005, 1463-1470:
    /// `tau = C 271700 Pa phi^1.5239 tanh(6.33e-6 m/A H)`. From the same data the models of Bingham and of Casson differ by
    /// 13 to 24 % (Xie, Liu and Cai, 2020): so much is not known of any yield stress.
    ///
    /// # Errors
    /// [`LawError::Value`] for a fraction out of range.
    pub fn carlson(fraction: f64, oil: Oil) -> Result<Self, LawError> {
        let most_kpa = oil.factor() * 271.7 * fraction.powf(1.5239);
        Ok(Fluid { law: Law::fluid(fraction)?, yields: Yields::Carlson { most_kpa, rate: 6.33e-3 } })
    }

    /// A user's own fluid: its law of flux density, and points of yield stress, (H in A/m, Pa), from (0, 0) on.
    ///
    /// # Errors
    /// [`LawError`] unless both rise.
    pub fn measured(law: Law, points: &[(f64, f64)]) -> Result<Self, LawError> {
        let (h, tau): (Vec<f64>, Vec<f64>) = points.iter().map(|(h, tau)| (h / 1e3, tau / 1e3)).unzip();
        if h.first().is_some_and(|h| *h != 0.0) || tau.first().is_some_and(|tau| *tau != 0.0) {
            let (what, value) = ("the first yield stress or field strength", h[0].abs().max(tau[0].abs()));
            return Err(LawError::Value { what, value, expected: "0 at 0" });
        }
        Ok(Fluid { law, yields: Yields::Points(super::curve::Rising::new(h, tau)?) })
    }

    /// The same yield stress over field strength with another magnetic law.
    #[must_use]
    pub fn with_law(self, law: Law) -> Self {
        Fluid { law, ..self }
    }

    /// Its magnetic law.
    #[must_use]
    pub fn law(&self) -> &Law {
        &self.law
    }

    /// Yield stress at a field strength of `h` A/mm (kA/m), kPa.
    #[must_use]
    pub fn yield_at_strength(&self, h: f64) -> f64 {
        match &self.yields {
            Yields::Carlson { most_kpa, rate } => most_kpa * (rate * h).tanh(),
            Yields::Points(points) => points.at(h),
        }
    }

    /// f2: yield stress at a flux density, T to kPa.
    #[must_use]
    pub fn yield_at_flux(&self, b_t: f64) -> f64 {
        self.yield_at_strength(self.law.at(b_t.max(0.0)).h)
    }

    /// The largest yield stress that it has, kPa.
    #[must_use]
    pub fn saturation_kpa(&self) -> f64 {
        match &self.yields {
            Yields::Carlson { most_kpa, .. } => *most_kpa,
            Yields::Points(points) => points.last().1,
        }
    }

    /// The inverse of f2: flux density for a yield stress, kPa to T. `None` beyond the fluid's saturation, or where tanh
    /// leaves no digits (999999 millionths of it).
    #[must_use]
    pub fn flux_for_yield(&self, kpa: f64) -> Option<f64> {
        if !(kpa >= 0.0 && kpa <= 0.999_999 * self.saturation_kpa()) {
            return None;
        }
        let h = match &self.yields {
            Yields::Carlson { most_kpa, rate } => (kpa / most_kpa).atanh() / rate,
            Yields::Points(points) => points.inverse(kpa)?,
        };
        Some(self.flux_at_strength(h))
    }

    /// Flux density at a field strength of `h` A/mm (kA/m), 0 or more, T: the law is H(B), which rises, inverted by halving.
    #[must_use]
    pub fn flux_at_strength(&self, h: f64) -> f64 {
        let (mut low, mut high) = (0.0, 1.0);
        while self.law.at(high).h < h {
            high *= 2.0;
        }
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if self.law.at(middle).h < h {
                low = middle
            } else {
                high = middle
            }
            if high - low <= 1e-15 * high {
                break;
            }
        }
        0.5 * (low + high)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// Figures computed from Carlson's formulas: 50 to 200 kA/m in MRF-122EG, printed to two or three digits.
    #[test]
    fn yield_stress_and_flux_are_those_of_the_published_fits() {
        let fluid = Fluid::carlson(0.22, Oil::Hydrocarbon).unwrap();
        for (h, kpa, b_t) in [(50.0, 8.3, 0.234), (100.0, 15.1, 0.383), (150.0, 20.0, 0.489), (200.0, 23.1, 0.573)] {
            assert!((fluid.flux_at_strength(h) - b_t).abs() < 6e-4, "{h}: {}", fluid.flux_at_strength(h));
            assert!((fluid.yield_at_strength(h) - kpa).abs() < 0.06, "{h}: {}", fluid.yield_at_strength(h));
            // Half a mT is 0.03 kPa at most.
            assert!((fluid.yield_at_flux(b_t) - kpa).abs() < 0.09, "{b_t}: {}", fluid.yield_at_flux(b_t));
        }
        assert!((fluid.saturation_kpa() - 27.0).abs() < 0.1);
    }

    #[test]
    fn the_inverse_is_the_inverse_up_to_saturation() {
        let law = Law::fluid(0.3).unwrap();
        let own = Fluid::measured(law, &[(0.0, 0.0), (2e4, 4e3), (1e5, 2e4), (3e5, 3e4)]).unwrap();
        for fluid in [Fluid::carlson(0.22, Oil::Silicone).unwrap(), own] {
            for part in [0.0, 0.01, 0.3, 0.8, 0.99] {
                let kpa = part * fluid.saturation_kpa();
                let b_t = fluid.flux_for_yield(kpa).unwrap();
                assert!((fluid.yield_at_flux(b_t) - kpa).abs() < 1e-9 * fluid.saturation_kpa(), "{part}");
            }
            assert_eq!(fluid.flux_for_yield(1.01 * fluid.saturation_kpa()), None);
            assert_eq!(fluid.flux_for_yield(-1.0), None);
        }
    }

    #[test]
    fn points_that_do_not_rise_are_told() {
        let law = Law::fluid(0.3).unwrap();
        let text = Fluid::measured(law.clone(), &[(0.0, 0.0), (1e4, 2e3), (2e4, 1e3)]).unwrap_err().to_string();
        assert!(text.contains("point 3"), "{text}");
        let text = Fluid::measured(law, &[(10.0, 0.0), (1e4, 2e3)]).unwrap_err().to_string();
        assert!(text.contains("expected 0 at 0"), "{text}");
    }
}
