//! The display's coil: a winding with heating on a core that saturates.

use std::sync::Arc;

use crate::magnet::circuit::Circuit;

/// Longest step, s: the shortest time constant of the ring below 4 A is 0.4 ms.
const STEP_S: f64 = 0.25e-3;

/// A magnet's coil. Its circuit comes from the magnet's file; the board's belief has numbers of its
/// own (`firmware/src/coil/winding.rs`).
#[derive(Debug, Clone)]
pub struct Coil {
    circuit: Arc<Circuit>,
    linkage_wb: f64,
    celsius: f64,
    heat_j_k: f64,
}

impl Default for Coil {
    fn default() -> Self {
        Coil::new(Circuit::ring())
    }
}

impl Coil {
    /// A coil at rest at the room's temperature: copper and varnish warm, the core does not.
    pub fn new(circuit: Arc<Circuit>) -> Self {
        let heat_j_k = circuit.winding.heat_j_k() + circuit.winding.varnish_j_k();
        Coil { linkage_wb: 0.0, celsius: circuit.winding.room_c, heat_j_k, circuit }
    }

    /// The same with another heat capacity, J/K; infinite: it does not warm.
    #[must_use]
    pub fn with_heat(self, heat_j_k: f64) -> Self {
        Coil { heat_j_k, ..self }
    }

    /// Current, A.
    pub fn current_a(&self) -> f64 {
        self.circuit.current_a(self.linkage_wb)
    }

    /// Mean temperature of the winding, C.
    pub fn celsius(&self) -> f64 {
        self.celsius
    }

    /// Lets `dt_s` pass under a mean voltage; a freewheeling diode keeps the current from reversing.
    pub fn step(&mut self, volt: f64, dt_s: f64) {
        let parts = (dt_s / STEP_S).ceil().max(1.0);
        for _ in 0..parts as usize {
            self.part(volt, dt_s / parts);
        }
    }

    fn part(&mut self, volt: f64, dt_s: f64) {
        let winding = &self.circuit.winding;
        let ohm = winding.ohm(self.celsius);
        self.linkage_wb = self.circuit.after_wb(self.linkage_wb, (volt, ohm), dt_s);
        let cooling_w = winding.cooling_w_k * (self.celsius - winding.room_c);
        self.celsius += dt_s * (self.current_a().powi(2) * ohm - cooling_w) / self.heat_j_k;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn current_settles_at_ohms_law_and_the_winding_warms() {
        let mut coil = Coil::default();
        let ohm = coil.circuit.winding.ohm(25.0);
        for _ in 0..60 {
            coil.step(5.0, 1e-3);
        }
        // 60 ms are seven time constants of 8 ms, and 0.3 K: 0.1 % of the resistance each.
        assert!((coil.current_a() - 5.0 / ohm).abs() < 3e-3, "{}", coil.current_a());
        for _ in 0..60_000 {
            coil.step(5.0, 1e-3);
        }
        // 4.8 W at first into 7.5 J/K and 20 K/W.
        assert!((45.0..75.0).contains(&coil.celsius()) && coil.current_a() < 0.95 * 5.0 / ohm, "{}", coil.celsius());
        coil.step(-5.0, 1.0);
        assert_eq!(coil.current_a(), 0.0);
    }

    /// Rise and fall in steps of a millisecond beside steps of a microsecond, and one step that is
    /// far too long.
    #[test]
    fn steps_are_short_enough_and_never_unstable() {
        let (mut coarse, mut fine) = (Coil::default(), Coil::default());
        let mut worst_a = 0.0f64;
        for ms in 0..60 {
            let volt = if ms < 30 { 15.0 } else { 0.0 };
            coarse.step(volt, 1e-3);
            (0..1000).for_each(|_| fine.step(volt, 1e-6));
            worst_a = worst_a.max((coarse.current_a() - fine.current_a()).abs());
        }
        // Second order: a hundredth of the 2.9 A at most where the core saturates.
        assert!(worst_a < 0.03, "{worst_a}");
        let mut coil = Coil::default();
        coil.part(15.0, 1.0);
        assert!(coil.current_a().is_finite() && coil.current_a() > 0.0);
    }
}
