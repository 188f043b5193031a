//! Constants of a simulated display under a simulated hand: a file, or a draw around it.

use std::path::Path;

use super::{ActuatorFlaws, ActuatorLaw, FsrFlaws, HandLaw, Noise, PulpLaw, Source};
use crate::experiment::section::{Document, Section};
use crate::experiment::{ExperimentError, text_of};

/// Constants of the display, the hand and the finger.
#[derive(Debug, Clone, PartialEq)]
pub struct Constants {
    /// The hand.
    pub hand: HandLaw,
    /// The finger's pulp.
    pub pulp: PulpLaw,
    /// How command and force move the actuator's shaft.
    pub law: ActuatorLaw,
    /// What the actuator adds to that.
    pub actuator: ActuatorFlaws,
    /// Conductance of the FSR over 100 gf, mS.
    pub fsr_slope_ms: f64,
    /// What the FSR adds to its line.
    pub fsr: FsrFlaws,
    /// Yield stress of the fluid over that of its law.
    pub yields: f64,
    /// Response time of the fluid, s.
    pub response_s: f64,
    /// Yield stress of the fluid without a field, kPa.
    pub rest_kpa: f64,
    /// Flux density over that of the magnet that curves are made for.
    pub flux: f64,
    /// Flux density without current, T.
    pub remanence_t: f64,
}

/// One constant of the file: its section and key, its range, what it is, and how far a draw may take it away: the standard
/// deviation of its logarithm.
type Key = (&'static str, &'static str, (f64, f64), &'static str, f64);

/// All but magnet and law, in the order of [`Constants::of`].
const KEYS: [Key; 19] = [
    ("hand", "mass_g", (0.5, 500.0), "the moving mass, 0.5 to 500 g", 0.3),
    ("hand", "stiffness_N_mm", (0.01, 20.0), "the hand's stiffness, 0.01 to 20 N/mm", 0.3),
    ("hand", "damping_N_s_mm", (0.0, 1.0), "the hand's damping, 0 to 1 N s/mm", 0.3),
    ("hand", "tremor_mm", (0.0, 1.0), "the tremor, 0 to 1 mm", 0.3),
    ("pulp", "softness", (0.1, 10.0), "the pulp's softness, 0.1 to 10", 0.2),
    ("pulp", "relaxes", (0.0, 0.9), "the part that relaxes, 0 to 0.9", 0.2),
    ("pulp", "time_s", (0.01, 100.0), "the time in which it relaxes, 0.01 to 100 s", 0.3),
    ("actuator", "friction_V", (0.0, 5.0), "the dry friction, 0 to 5 V", 0.3),
    ("actuator", "rate_limit_mm_s", (0.1, 1e4), "the fastest motion, 0.1 to 10000 mm/s", 0.2),
    ("actuator", "delay_s", (0.0, 0.1), "the delay, 0 to 0.1 s", 0.3),
    ("actuator", "backlash_mm", (0.0, 2.0), "the backlash, 0 to 2 mm", 0.3),
    ("actuator", "gives_mm_per_N", (0.0, 1.0), "how far it gives under a force, 0 to 1 mm/N", 0.3),
    ("fsr", "slope_mS", (1e-3, 10.0), "the conductance over 100 gf, 0.001 to 10 mS", 0.1),
    ("fsr", "hysteresis", (0.0, 0.5), "the half width of the hysteresis, 0 to 0.5", 0.2),
    ("fsr", "creep", (0.0, 0.5), "the creep a decade, 0 to 0.5", 0.2),
    ("fsr", "noise", (0.0, 0.2), "the noise of one reading, 0 to 0.2", 0.2),
    ("fluid", "yield", (0.1, 10.0), "the yield stress over that of the law, 0.1 to 10", 0.1),
    ("fluid", "response_s", (1e-4, 0.1), "the response time, 0.0001 to 0.1 s", 0.3),
    ("fluid", "rest_kPa", (0.0, 5.0), "the yield stress without a field, 0 to 5 kPa", 0.3),
];
/// The magnet's: the flux has a draw, the remanence is added.
const MAGNET: [Key; 2] = [
    ("magnet", "flux", (0.05, 20.0), "the flux density over that of the curves' magnet, 0.05 to 20", 0.05),
    ("magnet", "remanence_T", (0.0, 1.0), "the flux density without current, 0 to 1 T", 0.0),
];
/// The actuator's law. A file that lacks one has the thesis' (section 5.5).
const LAW: [(Key, f64); 4] = [
    (("actuator", "spring_1_s2", (1.0, 1e6), "the stiffness over mass, 1 to 1e6 1/s^2", 0.05), 86.0),
    (("actuator", "damper_1_s", (0.1, 1e4), "the damping over mass, 0.1 to 1e4 1/s", 0.05), 23.4),
    (("actuator", "mm_per_V", (0.01, 100.0), "the shaft at rest over the command, 0.01 to 100 mm/V", 0.05), 1.0),
    (("actuator", "back_mm_per_N", (0.0, 10.0), "how far a force drives it back, 0 to 10 mm/N", 0.05), 0.0),
];

impl Constants {
    /// The file of those that come with the program.
    pub const FROZEN: &str = include_str!("../../plants/frozen.toml");
    /// The file of a display whose actuator is a voice coil (thesis section 6.2).
    pub const VOICE_COIL: &str = include_str!("../../plants/voice-coil.toml");

    /// Those that come with the program, frozen before anything was tuned.
    ///
    /// # Errors
    /// None that a test would not show: the file is part of the program.
    pub fn frozen() -> Result<Self, ExperimentError> {
        Self::parse(Path::new("frozen.toml"), Self::FROZEN)
    }

    /// Reads a file.
    ///
    /// # Errors
    /// The first mistake, with its place.
    pub fn read(file: &Path) -> Result<Self, ExperimentError> {
        Self::parse(file, &text_of(file)?)
    }

    /// Those of a display with a voice coil, which come with the program.
    ///
    /// # Errors
    /// As [`Constants::frozen`].
    pub fn voice_coil() -> Result<Self, ExperimentError> {
        Self::parse(Path::new("voice-coil.toml"), Self::VOICE_COIL)
    }

    /// Every frozen constant times a number of its own.
    ///
    /// # Errors
    /// As [`Constants::frozen`].
    pub fn drawn(seed: u64) -> Result<Self, ExperimentError> {
        Self::drawn_around("frozen.toml", Self::FROZEN, seed)
    }

    /// The same around those of the voice coil.
    ///
    /// # Errors
    /// As [`Constants::frozen`].
    pub fn voice_coil_drawn(seed: u64) -> Result<Self, ExperimentError> {
        Self::drawn_around("voice-coil.toml", Self::VOICE_COIL, seed)
    }

    fn drawn_around(name: &str, text: &str, seed: u64) -> Result<Self, ExperimentError> {
        let mut noise = Noise::new(seed, Source::Constants);
        let values = Self::values(Path::new(name), text)?;
        let draw = |(value, key): (f64, &Key)| (value * (key.4 * noise.normal()).exp()).clamp(key.2.0, key.2.1);
        let drawn: Vec<f64> = values.into_iter().zip(keys()).map(draw).collect();
        Ok(Self::of(&drawn))
    }

    fn parse(file: &Path, text: &str) -> Result<Self, ExperimentError> {
        Ok(Self::of(&Self::values(file, text)?))
    }

    fn values(file: &Path, text: &str) -> Result<Vec<f64>, ExperimentError> {
        let document = Document { file, text };
        let root = document.table()?;
        let root = Section::new(document, "the file".to_owned(), 0..0, root.get_ref());
        let mut names: Vec<&str> = keys().map(|key| key.0).collect();
        names.sort_unstable();
        names.dedup();
        root.only(&names)?;
        let mut sections = Vec::new();
        for name in names {
            let own = root.section(name, format!("[{name}]"))?;
            let own = own.ok_or_else(|| root.missing(name, "a section of constants"))?;
            own.only(&keys().filter(|key| key.0 == name).map(|key| key.1).collect::<Vec<_>>())?;
            sections.push((name, own));
        }
        let value = |key: &Key, otherwise: Option<f64>| {
            let (name, word, (least, most), expected, _) = key;
            let own = sections.iter().find(|(own, _)| own == name).map(|(_, own)| own);
            let own = own.ok_or_else(|| root.missing(name, "a section of constants"))?;
            own.number(word, *least..=*most, expected)?.or(otherwise).ok_or_else(|| own.missing(word, expected))
        };
        let mut values = Vec::new();
        for key in KEYS.iter().chain(&MAGNET) {
            values.push(value(key, None)?);
        }
        for (key, otherwise) in &LAW {
            values.push(value(key, Some(*otherwise))?);
        }
        Ok(values)
    }

    /// From the values of [`keys`].
    fn of(v: &[f64]) -> Self {
        let at = |i: usize| v.get(i).copied().unwrap_or(0.0);
        Constants {
            hand: HandLaw { mass_g: at(0), stiffness_n_mm: at(1), damping_n_s_mm: at(2), tremor_mm: at(3) },
            pulp: PulpLaw::round(at(4), (at(5), at(6))),
            actuator: ActuatorFlaws {
                friction_v: at(7),
                rate_mm_s: at(8),
                delay_s: at(9),
                backlash_mm: at(10),
                gives_mm_per_n: at(11),
            },
            fsr_slope_ms: at(12),
            fsr: FsrFlaws { hysteresis: at(13), creep: at(14), power: 1.0, noise: at(15) },
            yields: at(16),
            response_s: at(17),
            rest_kpa: at(18),
            flux: at(19),
            remanence_t: at(20),
            law: ActuatorLaw { spring_1_s2: at(21), damper_1_s: at(22), mm_per_v: at(23), back_mm_per_n: at(24) },
        }
    }
}

/// All keys, in the order of [`Constants::of`].
fn keys() -> impl Iterator<Item = &'static Key> {
    KEYS.iter().chain(&MAGNET).chain(LAW.iter().map(|(key, _)| key))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn the_frozen_constants_are_read_and_a_draw_differs() {
        let frozen = Constants::frozen().unwrap();
        assert_eq!((frozen.hand.mass_g, frozen.actuator.rate_mm_s, frozen.fsr.creep), (6.0, 25.0, 0.03));
        // 0.36 N at 1 mm, 1.44 N at 2 mm: the finger of two other solvers on a plate
        let force = |u| frozen.pulp.slow.force_n(u);
        assert!((force(1.0) / 0.361 - 1.0).abs() < 0.02 && (force(2.0) / 1.443 - 1.0).abs() < 0.02, "{}", force(2.0));
        let (one, other) = (Constants::drawn(1).unwrap(), Constants::drawn(2).unwrap());
        assert!(one != other && one == Constants::drawn(1).unwrap() && one.hand.mass_g != 6.0);
    }

    #[test]
    fn mistakes_are_told_with_their_place() {
        let told = |from: &str, to: &str| {
            assert!(Constants::FROZEN.contains(from), "{from}");
            Constants::parse(Path::new("p.toml"), &Constants::FROZEN.replacen(from, to, 1)).unwrap_err().to_string()
        };
        let text = told("creep = 0.03", "creep = 3");
        assert!(
            text.contains("p.toml, line ") && text.contains("`creep` is 3; expected the creep a decade, 0 to 0.5"),
            "{text}"
        );
        assert!(told("creep = 0.03", "crep = 0.03").contains("unknown key `crep`"));
        assert!(told("[fluid]", "[liquid]").contains("unknown key `liquid`"));
    }
}
