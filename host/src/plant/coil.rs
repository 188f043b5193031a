//! The display's coil: R-L with heating.

/// 770 turns of 28 AWG (thesis section 4.2), about 13 Ohm and 3 mH (DESIGN's estimate).
#[derive(Debug, Clone)]
pub struct Coil {
    current_a: f64,
    celsius: f64,
    heat_j_k: f64,
}

/// Resistance at 20 C, Ohm.
const OHM_20C: f64 = 13.0;

/// Inductance, H.
const HENRY: f64 = 3e-3;

/// Temperature coefficient of copper, 1/K.
const COPPER: f64 = 0.003_93;

/// Heat capacity, J/K: 44 g of copper (61 m of 28 AWG) and its insulation.
const HEAT_J_K: f64 = 20.0;

/// Thermal resistance to the room, K/W (assumed, still air and steel core).
const THERMAL_K_W: f64 = 6.0;

/// The room, C.
const ROOM_C: f64 = 25.0;

impl Default for Coil {
    fn default() -> Self {
        Coil::with(HEAT_J_K)
    }
}

impl Coil {
    /// A coil of another heat capacity, J/K; infinite: it does not warm.
    pub fn with(heat_j_k: f64) -> Self {
        Coil { current_a: 0.0, celsius: ROOM_C, heat_j_k }
    }

    /// Current, A.
    pub fn current_a(&self) -> f64 {
        self.current_a
    }

    /// Mean temperature of the winding, C.
    pub fn celsius(&self) -> f64 {
        self.celsius
    }

    /// Lets `dt_s` pass under a mean voltage; a freewheeling diode keeps the current from reversing.
    pub fn step(&mut self, volt: f64, dt_s: f64) {
        let ohm = OHM_20C * (1.0 + COPPER * (self.celsius - 20.0));
        // Exact for constant voltage: L/R = 0.23 ms is shorter than the step.
        let rest = volt / ohm;
        self.current_a = (rest + (self.current_a - rest) * (-ohm / HENRY * dt_s).exp()).max(0.0);
        let watt = self.current_a * self.current_a * ohm;
        self.celsius += dt_s * (watt - (self.celsius - ROOM_C) / THERMAL_K_W) / self.heat_j_k;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn current_settles_at_ohms_law_and_the_winding_warms() {
        let mut coil = Coil::default();
        for _ in 0..10 {
            coil.step(13.0, 1e-3);
        }
        let ohm = 13.0 * (1.0 + 0.003_93 * 5.0);
        assert!((coil.current_a() - 13.0 / ohm).abs() < 1e-3);
        for _ in 0..60_000 {
            coil.step(13.0, 1e-3);
        }
        assert!(coil.celsius() > 45.0 && coil.current_a() < 13.0 / ohm);
        coil.step(-5.0, 1.0);
        assert_eq!(coil.current_a(), 0.0);
    }
}
