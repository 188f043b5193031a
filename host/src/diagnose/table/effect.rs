//! The catalogue of a table: what a calibration or a simulated table may get wrong.
//!
//! Each says which assumption it breaks, what it adds to a reading, in spans of the table, and what
//! separates it from the others.

use super::readings::{Reading, Table};
use crate::infer::quantity::Quantity;

/// One departure from the base.
#[derive(Debug)]
pub struct Effect {
    /// Stable code.
    pub code: &'static str,
    /// Which of several laws with that code.
    pub form: &'static str,
    /// Assumption that it breaks.
    pub assumption: &'static str,
    /// What separates it from others.
    pub separated_by: &'static str,
    /// Its parameters.
    pub quantities: &'static [Quantity],
    /// What it adds to a reading, in spans of the table.
    pub adds: fn(&Reading, &[f64]) -> f64,
    /// True for a table that could show it.
    pub is_possible: fn(&Table) -> bool,
}

impl PartialEq for Effect {
    fn eq(&self, other: &Self) -> bool {
        (self.code, self.form) == (other.code, other.form)
    }
}

/// Data sheets and hand-made magnets: a few percent as a gain.
static GAIN: Effect = Effect {
    code: "sensor-gain",
    form: "gain",
    assumption: "the simulated gain is that of sensor, gap, leakage and turns",
    separated_by: "the same table at a second gap, and a reference sensor: a gap, a leak and a sensor are all a gain",
    quantities: &[Quantity::amount("gain_share", (-0.95, 5.0), 0.05, &[0.05, -0.05])],
    adds: |r, p| p[0] * r.level,
    is_possible: |table| table.is_simulated,
};

/// Load cells and converters: below a percent; force sensing resistors: several (Interlink 400 data sheet).
static QUADRATIC: Effect = Effect {
    code: "sensor-nonlinearity",
    form: "quadratic",
    assumption: "reading and line differ by a gain and a zero",
    separated_by: "readings at the middle and at both ends, several times each",
    quantities: &[Quantity::amount("bow_share", (-1.0, 1.0), 0.02, &[0.02])],
    adds: |r, p| p[0] * 4.0 * r.level * (1.0 - r.level),
    is_possible: |table| table.places.len() > 2,
};

/// Conductance of a contact grows with a power of the force.
static POWER: Effect = Effect {
    code: "sensor-nonlinearity",
    form: "power",
    assumption: QUADRATIC_ASSUMPTION,
    separated_by: "readings near nothing, where a power is steepest or flattest",
    quantities: &[Quantity {
        name: "exponent",
        null: Some(1.0),
        bounds: (0.3, 3.0),
        plausible: 1.1,
        starts: &[0.8, 1.25],
        logarithmic: true,
    }],
    adds: |r, p| r.level.max(0.0).powf(p[0]) - r.level,
    is_possible: |table| table.places.len() > 2,
};
const QUADRATIC_ASSUMPTION: &str = "reading and line differ by a gain and a zero";

/// Any smooth curve over x: three half waves and their overtones.
static CURVE: Effect = Effect {
    code: "sensor-nonlinearity",
    form: "curve",
    assumption: QUADRATIC_ASSUMPTION,
    separated_by: "readings at the middle and at both ends, several times each",
    quantities: &[
        Quantity::amount("wave_1_share", (-1.0, 1.0), 0.02, &[0.01]),
        Quantity::amount("wave_2_share", (-1.0, 1.0), 0.01, &[0.0]),
        Quantity::amount("wave_3_share", (-1.0, 1.0), 0.01, &[0.0]),
    ],
    adds: |r, p| {
        let wave = |k: usize| (std::f64::consts::PI * (k + 1) as f64 * r.level).sin();
        p.iter().enumerate().map(|(k, amount)| amount * wave(k)).sum()
    },
    is_possible: |table| !table.is_simulated && table.places.len() > 5,
};

/// What carries no more: steel, an amplifier, a converter at its end.
static SATURATION: Effect = Effect {
    code: "saturation",
    form: "bend",
    assumption: "what is set reaches the reading at any size",
    separated_by: "readings well beyond the bend",
    quantities: &[Quantity {
        name: "limit_spans",
        null: None,
        bounds: (0.3, 10.0),
        plausible: 2.0,
        starts: &[0.6, 1.2, 2.5],
        logarithmic: true,
    }],
    adds: |r, p| r.level / (1.0 + (r.level / p[0]).powi(2)).sqrt() - r.level,
    is_possible: |table| table.places.len() > 2,
};

/// Half of what a reading on the way back is more, in proportion to it.
static HYSTERESIS: Effect = Effect {
    code: "sensor-creep",
    form: "hysteresis",
    assumption: "the reading does not depend on where x came from",
    separated_by: "loops to several peaks: a sensor's loop grows with the reading, a magnet's does not",
    quantities: &[Quantity::amount("half_width_share", (0.0, 0.5), 0.02, &[0.02])],
    adds: |r, p| -p[0] * r.way * r.level,
    is_possible: Table::has_both_ways,
};

/// What steel keeps.
static REMANENCE: Effect = Effect {
    code: "remanence",
    form: "loop",
    assumption: "flux depends on the current of the moment",
    separated_by: "loops to several peaks, and readings at zero current after each",
    quantities: &[Quantity::amount("half_width_share", (0.0, 0.5), 0.01, &[0.01])],
    adds: |r, p| -p[0] * r.way,
    is_possible: Table::has_both_ways,
};

/// What changes with the order of the readings: temperature, a zero that wanders.
static DRIFT: Effect = Effect {
    code: "drift",
    form: "zero",
    assumption: "nothing changes between the first reading and the last",
    separated_by: "the same points in another order",
    quantities: &[Quantity::amount("over_all_share", (-1.0, 1.0), 0.02, &[0.02])],
    adds: |r, p| p[0] * r.order,
    is_possible: |table| table.readings.len() > table.places.len(),
};

/// The same where it settles: fast at first, and ever less.
static SETTLING: Effect = Effect {
    code: "drift",
    form: "settling",
    assumption: "nothing changes between the first reading and the last",
    separated_by: "the same points in another order",
    quantities: &[
        Quantity::amount("over_all_share", (-1.0, 1.0), 0.02, &[0.02]),
        Quantity {
            name: "settles_in_share",
            null: None,
            bounds: (0.02, 0.5),
            plausible: 0.2,
            starts: &[0.05, 0.2],
            logarithmic: true,
        },
    ],
    adds: |r, p| p[0] * (1.0 - (-r.order / p[1]).exp()),
    is_possible: |table| table.readings.len() > table.places.len(),
};

/// A reading that grows while it is held (Interlink 400 data sheet: below 5 % a decade).
static CREEP: Effect = Effect {
    code: "sensor-creep",
    form: "logarithmic",
    assumption: "the reading depends on x of the moment",
    separated_by: "a long rest at one x, and short ones at many",
    quantities: &[Quantity::amount("per_decade_share", (-0.5, 0.5), 0.03, &[0.03])],
    adds: |r, p| p[0] * r.level * (r.rest_s / 0.1).ln_1p() / std::f64::consts::LN_10,
    is_possible: |table| table.has_time && table.readings.iter().any(|r| r.rest_s > 0.0),
};

/// A part of a magnet that differs from its drawing by so many times of what the magnet's file calls plausible. How the flux
/// density changes is found by finite elements, to first order.
const fn differs(
    code: &'static str,
    assumption: &'static str,
    separated_by: &'static str,
    adds: fn(&Reading, &[f64]) -> f64,
    is_possible: fn(&Table) -> bool,
) -> Effect {
    const TIMES: &[Quantity] = &[Quantity::amount("times_plausible", (-6.0, 6.0), 1.0, &[0.5, -0.5])];
    Effect { code, form: "magnet", assumption, separated_by, quantities: TIMES, adds, is_possible }
}

/// The gap between the poles.
static GAP: Effect = differs(
    "gap",
    "the gap is that of the drawing",
    "a feeler gauge, and readings at large currents: a gap hides the steel's saturation, a leak does not",
    |r, p| p[0] * r.built[0],
    |table| table.parts[0],
);

/// What leaves the plane.
static LEAKAGE: Effect = differs(
    "leakage",
    "no flux leaves the plane of the drawing",
    "readings beside the core, before and behind it: what leaks is there",
    |r, p| p[0] * r.built[1],
    |table| table.parts[1],
);

/// The number of turns.
static TURNS: Effect = differs(
    "turns",
    "the coil has the turns of the drawing",
    "the coil's inductance and resistance, and a second coil of ten turns",
    |r, p| p[0] * r.built[2],
    |table| table.parts[2],
);

/// Where the sensor is.
static PROBE: Effect = differs(
    "probe-position",
    "the probe is where the drawing has it",
    "the same currents with the probe moved by a millimetre to either side",
    |r, p| p[0] * r.built[3],
    |table| table.parts[3],
);

/// Where the core's steel saturates.
static STEEL: Effect = differs(
    "saturation",
    "the steel has the table of B over H that the drawing names",
    "readings at currents beyond the bend, and a ring of the same steel without a gap",
    |r, p| p[0] * r.built[4],
    |table| table.parts[4],
);

/// How much iron the fluid has where the probe is.
static FLUID: Effect = differs(
    "fluid",
    "the fluid's iron is evenly spread and as much as its datasheet says",
    "the same currents stirred and after an hour of rest, and without fluid",
    |r, p| p[0] * r.built[5],
    |table| table.parts[5],
);

/// All effects.
pub static CATALOGUE: [&Effect; 16] = [
    &GAIN,
    &QUADRATIC,
    &POWER,
    &CURVE,
    &SATURATION,
    &HYSTERESIS,
    &REMANENCE,
    &DRIFT,
    &SETTLING,
    &CREEP,
    &GAP,
    &LEAKAGE,
    &TURNS,
    &PROBE,
    &STEEL,
    &FLUID,
];

/// An effect by its code and form.
#[must_use]
pub fn find(code: &str, form: &str) -> Option<&'static Effect> {
    CATALOGUE.into_iter().find(|effect| effect.code == code && effect.form == form)
}
