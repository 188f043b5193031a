//! Materials by name, and magnets by the three numbers of their datasheet.

use super::bh::{Between, Law, LawError, MU_0, Table};

/// Steel 1018: B (T) and H (A/m) as FEMM's library has them, which the thesis used (section 4.2).
const STEEL_1018: [(f64, f64); 13] = [
    (0.0, 0.0),
    (0.2503, 238.732),
    (0.925, 795.775),
    (1.25, 1591.55),
    (1.39, 2387.32),
    (1.525, 3978.88),
    (1.71, 7957.75),
    (1.87, 15_915.5),
    (1.955, 23_873.2),
    (2.02, 39_788.8),
    (2.11, 79_577.5),
    (2.225, 159_155.0),
    (2.43, 318_310.0),
];

/// Materials by name: what they are called, and how their law is found.
pub const NAMES: [&str; 6] = ["air", "copper", "1018 steel", "MRF-122EG", "MRF-132DG", "MRF-140CG"];

/// The law of a material by its name; `None` for a name that is not among [`NAMES`].
///
/// # Errors
/// [`LawError`] of a table, which those here do not have.
pub fn named(name: &str, between: Between) -> Option<Result<Law, LawError>> {
    Some(match name {
        // Copper differs from the vacuum by 1e-5.
        "air" | "copper" => Law::linear(1.0),
        "1018 steel" => Table::new(&STEEL_1018, between).map(Law::Table),
        // Volume fractions of iron: Carlson, Int. J. Mod. Phys. B 19, 2005, 1463-1470, and LORD's datasheets.
        "MRF-122EG" => Law::fluid(0.22),
        "MRF-132DG" => Law::fluid(0.32),
        "MRF-140CG" => Law::fluid(0.40),
        _ => return None,
    })
}

/// A permanent magnet by its datasheet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Magnet {
    /// Flux density at no field, T.
    pub remanence_t: f64,
    /// Field strength against it at which no flux density is left, kA/m.
    pub coercive_ka_m: f64,
    /// Largest product of both on the demagnetisation curve, kJ/m^3.
    pub product_kj_m3: f64,
}

/// Points of a demagnetisation curve that is made from three numbers.
const POINTS: usize = 80;

impl Magnet {
    /// Its law with H counted from minus the coercive field strength: a hyperbola through both ends of the second quadrant
    /// that has the product, the usual curve of Alnico (Parker, Advances in Permanent Magnetism, 1990, chapter 2); beyond
    /// the remanence the slope of the vacuum.
    ///
    /// # Errors
    /// [`LawError::Value`] where a number is not positive or the product does not belong to a curve: it lies between a
    /// quarter (a straight line) and all of remanence times coercive field strength.
    pub fn law(self) -> Result<Law, LawError> {
        let Magnet { remanence_t, coercive_ka_m, product_kj_m3 } = self;
        for (what, value) in [("the remanence", remanence_t), ("the coercive field strength", coercive_ka_m)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(LawError::Value { what, value, expected: "more than 0" });
            }
        }
        // How full the curve is: 1/4 is a straight line.
        let full = product_kj_m3 / (remanence_t * coercive_ka_m);
        if !(0.25..0.95).contains(&full) {
            return Err(LawError::Value {
                what: "the energy product over remanence times coercive field strength",
                value: full,
                expected: "0.25 (a straight line) to 0.95",
            });
        }
        // b(h) = h / (1 - c + c h) on (0, 1): its largest b (1 - h) is full.
        let most = |c: f64| {
            // Where the slope of h (1 - h) / (1 - c + c h) is nothing: c h^2 + 2 (1 - c) h - (1 - c) = 0.
            let h = if c < 1e-9 { 0.5 } else { ((1.0 - c) * (1.0 - c) + c * (1.0 - c)).sqrt() / c - (1.0 - c) / c };
            h * (1.0 - h) / (1.0 - c + c * h)
        };
        let (mut low, mut high) = (0.0, 1.0 - 1e-9);
        for _ in 0..60 {
            let c = 0.5 * (low + high);
            if most(c) < full { low = c } else { high = c }
        }
        let c = 0.5 * (low + high);
        let mut points = vec![(0.0, 0.0)];
        for i in 1..=POINTS {
            let b = i as f64 / POINTS as f64;
            points.push((b * remanence_t, 1e3 * coercive_ka_m * b * (1.0 - c) / (1.0 - c * b)));
        }
        // A magnet's recoil is never flatter than the vacuum: H rises by at most B / mu_0.
        let steepest = 1e3 / MU_0;
        for i in 1..points.len() {
            let before = points[i - 1];
            points[i].1 = points[i].1.min(before.1 + steepest * (points[i].0 - before.0));
        }
        Ok(Law::Table(Table::new(&points, Between::Monotone)?))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn every_name_has_a_law_and_others_have_none() {
        for name in NAMES {
            assert!(named(name, Between::Monotone).unwrap().is_ok(), "{name}");
        }
        assert!(named("cheese", Between::Monotone).is_none());
    }

    #[test]
    fn a_magnet_has_the_three_numbers_of_its_datasheet() {
        // Alnico 5 after the MMPA standard 0100-00, table II-1: 1.28 T, 51 kA/m, 43.8 kJ/m^3.
        let magnet = Magnet { remanence_t: 1.28, coercive_ka_m: 51.0, product_kj_m3: 43.8 };
        let law = magnet.law().unwrap();
        let coercive = magnet.coercive_ka_m;
        assert!((law.at(1.28).h / coercive - 1.0).abs() < 1e-9);
        // H and the product on a fine walk down the curve, kA/m and kJ/m^3.
        let product = (1..2000).map(|i| 1.28 * f64::from(i) / 2000.0).map(|b| b * (coercive - law.at(b).h));
        let most = product.fold(0.0, f64::max);
        assert!((most / 43.8 - 1.0).abs() < 2e-3, "{most}");
        let text = Magnet { product_kj_m3: 10.0, ..magnet }.law().unwrap_err().to_string();
        assert!(text.contains("expected 0.25 (a straight line) to 0.95"), "{text}");
    }
}
