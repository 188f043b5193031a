//! The winding: wire, resistance, heat, and whether it fits.

use std::f64::consts::PI;

/// Resistivity of copper at 20 C, Ohm mm (IEC 60028, 1/58 Ohm mm^2/m).
const OHM_MM: f64 = 1.0 / 58e3;
/// How it rises, 1/K (IEC 60028).
const PER_KELVIN: f64 = 3.93e-3;
/// Density of copper, kg/mm^3.
const KG_MM3: f64 = 8.89e-6;
/// Heat capacity of copper, J/(kg K).
const J_KG_K: f64 = 385.0;
/// Heat capacity of a varnish, J/(mm^3 K): 1.4 g/cm^3 with 1.2 J/(g K), polyester-imide (assumed).
const VARNISH_J_MM3_K: f64 = 1.4e-3 * 1.2;

/// Part of a window that wires fill which lie in layers above each other: circles in squares.
pub const LAYERED: f64 = PI / 4.0;

/// Diameter of a bare wire of an American gauge, mm (ASTM B258: gauge 36 is 0.127 mm, gauge 0000 92 times of its ratio).
#[must_use]
pub fn awg_mm(gauge: f64) -> f64 {
    0.127 * 92_f64.powf((36.0 - gauge) / 39.0)
}

/// A winding of round copper wire.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Winding {
    /// Turns.
    pub turns: f64,
    /// Diameter of the bare wire, mm.
    pub wire_mm: f64,
    /// Diameter with its varnish, mm.
    pub insulated_mm: f64,
    /// Mean length of a turn, mm.
    pub turn_mm: f64,
    /// Temperature of the room and before the current is switched on, C.
    pub room_c: f64,
    /// Highest temperature that the varnish stands, C.
    pub limit_c: f64,
    /// What the winding gives to its surroundings, W/K.
    pub cooling_w_k: f64,
}

/// Whether a winding fits its window.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fit {
    /// In layers above each other.
    Layered,
    /// Only if every layer lies in the grooves of the one below: by hand and with luck.
    Grooved,
    /// It does not.
    No,
}

impl Winding {
    /// Length of the wire, m.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        1e-3 * self.turns * self.turn_mm
    }

    /// Resistance at a temperature, Ohm.
    #[must_use]
    pub fn ohm(&self, celsius: f64) -> f64 {
        let area = 0.25 * PI * self.wire_mm * self.wire_mm;
        OHM_MM * self.turns * self.turn_mm / area * (1.0 + PER_KELVIN * (celsius - 20.0))
    }

    /// Mass of the copper, kg.
    #[must_use]
    pub fn mass_kg(&self) -> f64 {
        KG_MM3 * self.turns * self.turn_mm * 0.25 * PI * self.wire_mm * self.wire_mm
    }

    /// Heat capacity of the copper, J/K. That of core and varnish comes on top.
    #[must_use]
    pub fn heat_j_k(&self) -> f64 {
        J_KG_K * self.mass_kg()
    }

    /// Heat capacity of the varnish, J/K.
    #[must_use]
    pub fn varnish_j_k(&self) -> f64 {
        let area = 0.25 * PI * (self.insulated_mm * self.insulated_mm - self.wire_mm * self.wire_mm);
        VARNISH_J_MM3_K * self.turns * self.turn_mm * area
    }

    /// Part of a window that the wires fill with their varnish, each in a circle.
    #[must_use]
    pub fn filled(&self, window_mm2: f64) -> f64 {
        self.turns * 0.25 * PI * self.insulated_mm * self.insulated_mm / window_mm2
    }

    /// Whether it fits a window: layers above each other fill pi/4 of it, layers in grooves pi/(2 sqrt 3) at most.
    #[must_use]
    pub fn fits(&self, window_mm2: f64) -> Fit {
        let filled = self.filled(window_mm2);
        if filled <= LAYERED {
            Fit::Layered
        } else if filled <= PI / (2.0 * 3_f64.sqrt()) {
            Fit::Grooved
        } else {
            Fit::No
        }
    }

    /// The current that may flow for ever, A: its heat at the limit is what the surroundings take.
    #[must_use]
    pub fn lasting_a(&self) -> f64 {
        (self.cooling_w_k * (self.limit_c - self.room_c) / self.ohm(self.limit_c)).sqrt()
    }

    /// Temperature after a current has flowed for a time from the room's temperature, C: the winding is one body.
    #[must_use]
    pub fn after_c(&self, ampere: f64, seconds: f64) -> f64 {
        let (watt, rate) = self.heating(ampere);
        // dT/dt = watt / C + rate (T - room).
        let rise = if rate.abs() * seconds < 1e-9 { seconds } else { (rate * seconds).exp_m1() / rate };
        self.room_c + watt / self.heat_j_k() * rise
    }

    /// How long a current may flow from the room's temperature, s; infinite where it may for ever.
    #[must_use]
    pub fn seconds(&self, ampere: f64) -> f64 {
        let (watt, rate) = self.heating(ampere);
        let rise = self.heat_j_k() * (self.limit_c - self.room_c) / watt;
        if rate.abs() * rise < 1e-9 {
            return rise;
        }
        let grown = 1.0 + rate * rise;
        if grown <= 0.0 { f64::INFINITY } else { grown.ln() / rate }
    }

    /// Heat at the room's temperature, W, and how fast a difference to it grows by itself, 1/s.
    fn heating(&self, ampere: f64) -> (f64, f64) {
        let square = ampere * ampere;
        let per_kelvin = square * self.ohm(20.0) * PER_KELVIN;
        (square * self.ohm(self.room_c), (per_kelvin - self.cooling_w_k) / self.heat_j_k())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 770 turns of 28 AWG on 24 m of wire.
    fn winding() -> Winding {
        Winding {
            turns: 770.0,
            wire_mm: awg_mm(28.0),
            insulated_mm: 0.36,
            turn_mm: 24_000.0 / 770.0,
            room_c: 25.0,
            limit_c: 130.0,
            cooling_w_k: 0.05,
        }
    }

    #[test]
    fn gauges_and_resistance_are_those_of_the_standard() {
        // ASTM B258: 28 AWG is 0.3211 mm and 212.9 Ohm/km at 20 C, 10 AWG 2.588 mm.
        assert!((awg_mm(28.0) - 0.3211).abs() < 1e-4 && (awg_mm(10.0) - 2.588).abs() < 1e-3);
        assert!((winding().ohm(20.0) / (24.0 * 0.2129) - 1.0).abs() < 2e-3, "{}", winding().ohm(20.0));
    }

    #[test]
    fn copper_and_varnish_take_heat_by_their_volumes() {
        // 24 m of 0.0810 mm^2 are 1943 mm^3: 17.3 g and 6.65 J/K; the varnish has 0.0208 mm^2, an
        // eighth of that heat.
        assert!((winding().heat_j_k() - 6.65).abs() < 0.01, "{}", winding().heat_j_k());
        assert!((winding().varnish_j_k() / winding().heat_j_k() - 0.126).abs() < 0.002, "{}", winding().varnish_j_k());
    }

    #[test]
    fn heat_is_what_the_equation_says() {
        let winding = winding();
        for ampere in [0.5, 1.5, 2.5] {
            let seconds = winding.seconds(ampere);
            if seconds.is_finite() {
                assert!((winding.after_c(ampere, seconds) - winding.limit_c).abs() < 1e-6);
            } else {
                assert!(winding.after_c(ampere, 1e7) < winding.limit_c);
            }
        }
        // Small steps instead of the closed form.
        let (mut celsius, step) = (winding.room_c, 1e-3);
        for _ in 0..5000 {
            let watt = 2.5 * 2.5 * winding.ohm(celsius) - winding.cooling_w_k * (celsius - winding.room_c);
            celsius += step * watt / winding.heat_j_k();
        }
        assert!((winding.after_c(2.5, 5.0) - celsius).abs() < 0.02, "{celsius}");
    }

    #[test]
    fn the_lasting_current_divides_times_that_end_from_those_that_do_not() {
        let winding = winding();
        let lasting = winding.lasting_a();
        assert!(winding.seconds(1.001 * lasting).is_finite() && winding.seconds(0.999 * lasting).is_infinite());
    }

    #[test]
    fn wires_fit_by_their_layers() {
        let winding = winding();
        let square = winding.turns * winding.insulated_mm * winding.insulated_mm;
        assert_eq!(winding.fits(1.001 * square), Fit::Layered);
        assert_eq!(winding.fits(0.99 * square), Fit::Grooved);
        assert_eq!(winding.fits(0.86 * square), Fit::No);
    }
}
