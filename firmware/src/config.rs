//! Every number the board owns.

use crate::coil::thermal::ThermalConfig;
use crate::coil::winding::CoilCircuit;
use crate::display::DisplayConfig;
use crate::mode::ModeConfig;
use crate::palpation::PalpationConfig;
use crate::pid::{DEFAULT_GAINS, U_MAX_V};
use crate::plausible::PlausibleConfig;
use crate::safety::SafetyConfig;
use crate::sensor::{CoilShunt, DEFAULT_CALIBRATION};
use protocol::message::{Calibration, Gains};

/// Configuration of a board. `Default` is the board of `docs/board.md`.
#[derive(Debug, Clone, PartialEq)]
pub struct BoardConfig {
    /// Limits and faults.
    pub safety: SafetyConfig,
    /// Readings that contradict a press.
    pub plausible: PlausibleConfig,
    /// Motion.
    pub mode: ModeConfig,
    /// Identification.
    pub palpation: PalpationConfig,
    /// Display.
    pub display: DisplayConfig,
    /// Winding and supply.
    pub circuit: CoilCircuit,
    /// Limits of its heating.
    pub thermal: ThermalConfig,
    /// Shunt amplifier.
    pub shunt: CoilShunt,
    /// Gains until the host sets others.
    pub gains: Gains,
    /// Calibration until one is stored.
    pub calibration: Calibration,
    /// Largest actuator command, V.
    pub u_max_v: f32,
    /// True for a simulated board, for the greeting.
    pub simulated: bool,
}

impl Default for BoardConfig {
    fn default() -> Self {
        BoardConfig {
            safety: SafetyConfig::default(),
            plausible: PlausibleConfig::default(),
            mode: ModeConfig::default(),
            palpation: PalpationConfig::default(),
            display: DisplayConfig::default(),
            circuit: CoilCircuit::default(),
            thermal: ThermalConfig::default(),
            shunt: CoilShunt::default(),
            gains: DEFAULT_GAINS,
            calibration: DEFAULT_CALIBRATION,
            u_max_v: U_MAX_V,
            simulated: false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What one limit counts on another says in its own words.
    #[test]
    fn limits_of_the_coil_agree() {
        let c = BoardConfig::default();
        assert_eq!(c.circuit.range_c.1, c.thermal.trip_c);
        assert_eq!(c.safety.coil_c, c.thermal.trip_c);
        assert!(c.display.coil_max_a * 1.08 <= c.safety.coil_a);
        // Bounded by the supply: more than the display's highest current, by less than a fifth.
        let most_a = c.circuit.supply_v / c.circuit.winding.resistance_ohm;
        assert!(most_a > c.display.coil_max_a && most_a < 1.2 * c.display.coil_max_a);
    }
}
