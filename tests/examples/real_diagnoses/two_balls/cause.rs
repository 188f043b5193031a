//! The foams of thesis Table 1, and what could make their parameters depend on the ball.

use lut_gen::chain::Setting;
use lut_gen::effect::{self, Effect};

/// mu (MPa) and alpha.
pub type Pair = (f64, f64);

/// A foam as Table 1 has it.
pub struct Foam {
    pub name: &'static str,
    /// Half an inch and three quarters: thesis section 5.4 tells the thickness of the same products, chapter 2 tells none.
    pub height_mm: f64,
    pub each: [Pair; 2],
    pub both: Pair,
}

pub const FOAMS: [Foam; 2] = [
    Foam { name: "EVA", height_mm: 12.7, each: [(0.220, 10.526), (0.278, 15.152)], both: (0.245, 12.424) },
    Foam { name: "B1", height_mm: 19.05, each: [(0.193, 12.711), (0.226, 15.173)], both: (0.188, 11.1564) },
];

/// A candidate: an effect of one parameter, the others held, with the range of its amount.
pub struct Cause {
    pub name: &'static str,
    pub code: &'static str,
    pub form: Option<&'static str>,
    pub owner: usize,
    /// Values of all parameters; the first is replaced by the amount.
    pub values: &'static [f64],
    pub range: (f64, f64),
    pub unit: &'static str,
}

const fn cause(
    name: &'static str,
    code: &'static str,
    values: &'static [f64],
    range: (f64, f64),
    unit: &'static str,
) -> Cause {
    Cause { name, code, form: None, owner: 0, values, range, unit }
}

/// Codes of causes that are no effect of the catalogue: nothing, and a stiffness that differs between the two balls' sessions.
pub const NOTHING: &str = "none";
pub const SESSION: &str = "session";

pub const CAUSES: [Cause; 17] = [
    cause("contact found late (+) or early (-)", "contact-offset", &[0.0], (-0.4, 0.4), "mm"),
    cause("slab higher (+) or lower (-) than in the model", "thickness", &[0.0], (-4.0, 5.0), "mm"),
    Cause { form: Some("sliding-base"), ..cause("base slides", "thickness", &[0.0], (0.0, 1.0), "of free") },
    cause("compliance of the machine", "compliance", &[0.0], (0.0, 0.2), "mm/N"),
    cause("ball of 4 mm larger (+) or smaller (-)", "radius", &[0.0], (-0.6, 0.6), "mm"),
    Cause { owner: 1, ..cause("ball of 6 mm larger (+) or smaller (-)", "radius", &[0.0], (-0.6, 0.6), "mm") },
    cause("friction", "friction", &[0.0], (0.0, 1.0), "coefficient"),
    cause("second term, alpha 3", "second-term", &[0.0, 3.0], (-0.3, 2.0), "of mu"),
    cause("second term, alpha 22", "second-term", &[0.0, 22.0], (-0.3, 2.0), "of mu"),
    cause("Poisson's ratio", "poisson", &[0.0], (0.0, 0.35), ""),
    cause("relaxation, 0.3 s", "relaxation", &[0.0, 0.3], (0.0, 0.8), "of mu"),
    cause("relaxation, 3 s", "relaxation", &[0.0, 3.0], (0.0, 0.8), "of mu"),
    cause("adhesion", "adhesion", &[0.0], (0.0, 0.05), "N/mm"),
    Cause { form: Some("filter"), ..cause("lag of the force reading", "lag", &[0.0], (0.0, 0.4), "s") },
    cause("sensor nonlinearity", "sensor-nonlinearity", &[0.0], (-0.05, 0.05), "1/N"),
    cause("foam, or gain, stiffer (+) under the ball of 6 mm", SESSION, &[0.0], (-0.3, 0.3), "of the force"),
    cause("none", NOTHING, &[0.0], (0.0, 0.0), ""),
];

impl Cause {
    pub fn setting(&self, amount: f64) -> Option<Setting> {
        let effect: &'static Effect = effect::find(self.code, self.form)?;
        let mut values = self.values.to_vec();
        values[0] = amount;
        Some(Setting { effect, owner: self.owner, values })
    }
}

/// What a plain amount of each cause does to a foam of the joint parameters: change of alpha and mu from ball to ball.
pub const PLAIN: [(usize, f64); 17] = [
    (0, 0.05),
    (1, 2.0),
    (1, -2.0),
    (2, 1.0),
    (3, 0.02),
    (4, -0.2),
    (5, 0.2),
    (6, 0.3),
    (7, 0.3),
    (8, 0.1),
    (9, 0.1),
    (10, 0.3),
    (11, 0.3),
    (12, 5e-4),
    (13, 0.03),
    (14, 0.002),
    (15, 0.05),
];
