//! The winding of the display's magnet and its circuit: the one place on the board that says what
//! they are.
//!
//! Source: `host/magnets/ring.toml` by finite elements (`palpate magnet ring --current
//! 0.25:3:0.25`). The test `tests/tests/suite/winding.rs` computes them again and fails where these
//! numbers are apart. Another magnet: its numbers here, from its own file, and resistance and
//! heating measured (`docs/bring-up.md`, step 11).

use crate::number::limit;

/// Flux linkages that are told.
pub const LINKAGES: usize = 13;

/// Distance of their currents, A: they reach from 0 to 3 A, beyond the trip of 2.7 A.
pub const LINKAGE_STEP_A: f32 = 0.25;

/// Temperature coefficient of copper, 1/K (IEC 60028).
const COPPER_PER_K: f32 = 0.003_93;

/// A winding of copper wire on a core that saturates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Winding {
    /// Resistance at 20 degrees Celsius, ohm.
    pub resistance_ohm: f32,
    /// Flux linkage, Wb, at 0, 0.25 .. 3 A. Its slope is the inductance that a change of current
    /// meets: it must rise.
    pub linkage_wb: [f32; LINKAGES],
    /// Heat capacity of the copper alone, J/K: varnish and core come on top, so the model errs to
    /// the hot side.
    pub capacity_j_per_k: f32,
    /// Resistance to the surroundings, K/W.
    pub resistance_k_per_w: f32,
}

impl Winding {
    /// The ring: 770 turns of 28 AWG, 24.0 m. Linkage by finite elements, 40 mH at rest to 4 mH at
    /// 3 A, where the core is saturated; error of the mesh below 1e-5 of it, of what is left out of
    /// the plane 3 %. 17.3 g of copper at 385 J/(kg K). Cooling of 0.05 W/K is assumed (50 cm^2 in
    /// still air at 10 W/(m^2 K)).
    pub const RING: Winding = Winding {
        resistance_ohm: 5.115,
        linkage_wb: [
            0.0, 0.009_991, 0.019_762, 0.027_836, 0.033_919, 0.037_928, 0.040_906, 0.043_134, 0.044_909, 0.046_390,
            0.047_640, 0.048_740, 0.049_716,
        ],
        capacity_j_per_k: 6.66,
        resistance_k_per_w: 20.0,
    };

    /// Resistance at a temperature, ohm.
    pub fn ohm(&self, celsius: f32) -> f32 {
        self.resistance_ohm * (1.0 + COPPER_PER_K * (celsius - 20.0))
    }

    /// Inductance that a change of current meets between two of the told currents, H; the last
    /// stretch goes on.
    pub fn inductance_h(&self, stretch: usize) -> f32 {
        let to = if stretch + 1 < LINKAGES { stretch + 1 } else { LINKAGES - 1 };
        match (self.linkage_wb.get(to - 1), self.linkage_wb.get(to)) {
            (Some(from_wb), Some(to_wb)) => (to_wb - from_wb) / LINKAGE_STEP_A,
            _ => 0.0,
        }
    }

    /// The largest of these, H.
    pub fn inductance_most_h(&self) -> f32 {
        (0..LINKAGES - 1).map(|i| self.inductance_h(i)).fold(0.0, f32::max)
    }
}

/// Which stretch between told currents a current lies in: the first below 0 and for NaN, the last
/// beyond 3 A.
pub fn stretch(current_a: f32) -> usize {
    limit(current_a / LINKAGE_STEP_A, 0.0, (LINKAGES - 2) as f32) as usize
}

/// A quantity told at 0, 0.25 .. 3 A, read at a current; beyond, the last stretches go on.
pub fn at(told: &[f32; LINKAGES], current_a: f32) -> f32 {
    let k = stretch(current_a);
    match (told.get(k), told.get(k + 1)) {
        (Some(from), Some(to)) => from + (current_a / LINKAGE_STEP_A - k as f32) * (to - from),
        _ => 0.0,
    }
}

/// The winding with its supply, and what may be apart from what is told of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoilCircuit {
    /// The winding.
    pub winding: Winding,
    /// Supply of the coil, V (`docs/decisions/0018-winding.md`).
    pub supply_v: f32,
    /// How far the supply may be off, fraction.
    pub supply_tolerance: f32,
    /// How far the built winding's resistance may be off, fraction: bring-up measures it.
    pub resistance_tolerance: f32,
    /// How much more than told the largest inductance may be, fraction: a gap that is narrower,
    /// better steel, the plane.
    pub inductance_tolerance: f32,
    /// Most resistance beside the winding, ohm: shunt 0.05, switch 0.05, leads and contacts 0.2.
    pub beside_ohm: f32,
    /// Temperatures between which a sound winding works, degrees Celsius: a cold room, and the
    /// trip.
    pub range_c: (f32, f32),
    /// Bandwidth of the closed loop, rad/s.
    pub bandwidth_rad_s: f32,
    /// Highest duty; the last 2 % keep the edges that the driver needs.
    pub duty_max: f32,
}

impl Default for CoilCircuit {
    /// 15 V: 2.5 A in the cold ring take 12.8 V, and a switch that is stuck on makes 2.9 A of it,
    /// not 7 A as 36 V would. 200 rad/s is a fifth of what sampling at 1 kHz bears, and as fast as
    /// the fluid answers.
    fn default() -> Self {
        CoilCircuit {
            winding: Winding::RING,
            supply_v: 15.0,
            supply_tolerance: 0.1,
            resistance_tolerance: 0.05,
            inductance_tolerance: 0.25,
            beside_ohm: 0.3,
            range_c: (0.0, 105.0),
            bandwidth_rad_s: 200.0,
            duty_max: 0.98,
        }
    }
}

impl CoilCircuit {
    /// Resistance of the hottest sound circuit at the lowest supply, over that of the winding at 20
    /// degrees at the supply as told: 1.62 for the ring.
    pub fn highest(&self) -> f32 {
        let ohm = self.winding.ohm(self.range_c.1) * (1.0 + self.resistance_tolerance) + self.beside_ohm;
        ohm / self.winding.resistance_ohm / (1.0 - self.supply_tolerance)
    }

    /// The same of the coldest circuit at the highest supply: 0.80.
    pub fn lowest(&self) -> f32 {
        let ohm = self.winding.ohm(self.range_c.0) * (1.0 - self.resistance_tolerance);
        ohm / self.winding.resistance_ohm / (1.0 + self.supply_tolerance)
    }

    /// Resistance that the regulator is made for, ohm: the winding in the middle of its range.
    pub fn working_ohm(&self) -> f32 {
        self.winding.ohm(0.5 * (self.range_c.0 + self.range_c.1))
    }

    /// Least and most current that a duty comes to in a sound circuit, A.
    pub fn settled_a(&self, duty: f32) -> (f32, f32) {
        let a = duty * self.supply_v / self.winding.resistance_ohm;
        (a / self.highest(), a / self.lowest())
    }

    /// The longest time constant of a sound circuit, s: 11 ms for the ring.
    pub fn slowest_s(&self) -> f32 {
        let henry = self.winding.inductance_most_h() * (1.0 + self.inductance_tolerance);
        henry / (self.winding.ohm(self.range_c.0) * (1.0 - self.resistance_tolerance))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_derived_is_what_the_comments_say() {
        let c = CoilCircuit::default();
        // Copper at 105 degrees 1.334 times 1.05, 0.3 of 5.115 ohm beside it, supply 0.9; at 0
        // degrees 0.921 times 0.95 over 1.1.
        assert!((c.highest() - (1.334 * 1.05 + 0.3 / 5.115) / 0.9).abs() < 1e-3, "{}", c.highest());
        assert!((c.lowest() - 0.921_4 * 0.95 / 1.1).abs() < 1e-3, "{}", c.lowest());
        // 39.7 mH times 1.25 over 4.48 ohm.
        assert!((c.slowest_s() - 0.011_1).abs() < 1e-4, "{}", c.slowest_s());
        assert!(c.winding.linkage_wb.windows(2).all(|w| w[1] > w[0]));
    }

    #[test]
    fn linkage_is_read_between_its_points_and_goes_on_beyond_them() {
        let w = Winding::RING;
        // f32 of numbers below 0.1.
        let near = |a: f32, wb: f32| (at(&w.linkage_wb, a) - wb).abs() < 1e-7;
        assert!(near(0.0, 0.0) && near(1.0, 0.033_919) && near(2.875, 0.5 * (0.048_740 + 0.049_716)));
        assert!(near(-0.25, -0.009_991) && near(3.25, 0.049_716 + 0.000_976));
        assert!(at(&w.linkage_wb, f32::NAN).is_nan() && stretch(f32::NAN) == 0);
        assert_eq!(w.inductance_h(99), w.inductance_h(LINKAGES - 2));
    }

    /// 15 V give the display's highest current up to 45 degrees; in a warmer winding the supply
    /// bounds it before the thermal model does.
    #[test]
    fn the_supply_gives_the_highest_current_cold_and_bounds_what_a_stuck_switch_makes() {
        let c = CoilCircuit::default();
        let needed_v = |celsius: f32| 2.5 * (c.winding.ohm(celsius) + 0.15) / c.duty_max;
        assert!(needed_v(45.0) < c.supply_v && needed_v(25.0) < 0.92 * c.supply_v);
        assert!(c.supply_v / c.winding.ohm(20.0) < 2.95);
    }
}
