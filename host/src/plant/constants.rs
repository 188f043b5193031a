//! Constants of a simulated display under a simulated hand: a file, or a draw around it.

use std::path::Path;

use super::{ActuatorFlaws, Curve, FsrFlaws, HandLaw, Noise, PulpLaw, Source};
use crate::experiment::section::{Document, Section};
use crate::experiment::{ExperimentError, text_of};

/// Force of the round finger on a plate, by finite elements.
const PULP: &str = include_str!("../../plants/pulp.csv");

/// Constants of the display, the hand and the finger.
#[derive(Debug, Clone, PartialEq)]
pub struct Constants {
    /// The hand.
    pub hand: HandLaw,
    /// The finger's pulp.
    pub pulp: PulpLaw,
    /// The actuator.
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

/// All of them, in the order of [`Constants::of`].
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

impl Constants {
    /// The file of those that come with the program.
    pub const FROZEN: &str = include_str!("../../plants/frozen.toml");

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

    /// Every constant of these times a number of its own.
    ///
    /// # Errors
    /// As [`Constants::frozen`].
    pub fn drawn(seed: u64) -> Result<Self, ExperimentError> {
        let mut noise = Noise::new(seed, Source::Constants);
        let values = Self::values(Path::new("frozen.toml"), Self::FROZEN)?;
        let draw = |(value, key): (f64, &Key)| (value * (key.4 * noise.normal()).exp()).clamp(key.2.0, key.2.1);
        let drawn: Vec<f64> = values.into_iter().zip(KEYS.iter().chain(&MAGNET)).map(draw).collect();
        Ok(Self::of(&drawn))
    }

    fn parse(file: &Path, text: &str) -> Result<Self, ExperimentError> {
        Ok(Self::of(&Self::values(file, text)?))
    }

    fn values(file: &Path, text: &str) -> Result<Vec<f64>, ExperimentError> {
        let document = Document { file, text };
        let root = document.table()?;
        let root = Section::new(document, "the file".to_owned(), 0..0, root.get_ref());
        let all = || KEYS.iter().chain(&MAGNET);
        let mut sections: Vec<&str> = all().map(|key| key.0).collect();
        sections.dedup();
        root.only(&sections)?;
        let mut values = Vec::new();
        for name in sections {
            let own = root.section(name, format!("[{name}]"))?;
            let own = own.ok_or_else(|| root.missing(name, "a section of constants"))?;
            let keys: Vec<&Key> = all().filter(|key| key.0 == name).collect();
            own.only(&keys.iter().map(|key| key.1).collect::<Vec<_>>())?;
            for (_, key, (least, most), expected, _) in keys {
                let value = own.number(key, *least..=*most, expected)?;
                values.push(value.ok_or_else(|| own.missing(key, expected))?);
            }
        }
        Ok(values)
    }

    /// From the values of [`KEYS`] and [`MAGNET`].
    fn of(v: &[f64]) -> Self {
        let at = |i: usize| v.get(i).copied().unwrap_or(0.0);
        Constants {
            hand: HandLaw { mass_g: at(0), stiffness_n_mm: at(1), damping_n_s_mm: at(2), tremor_mm: at(3) },
            pulp: PulpLaw { slow: slow(at(4)), relaxing: (at(5), at(6)) },
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
        }
    }
}

/// Force over compression of a pulp that gives way `softness` times as far.
fn slow(softness: f64) -> Curve {
    let rows = PULP.lines().filter_map(|line| line.split_once(','));
    let points: Vec<(f64, f64)> = rows.filter_map(|(u, n)| Some((u.parse().ok()?, n.parse().ok()?))).collect();
    let step = points.first().map_or(0.0, |first| first.0);
    let force: Vec<f64> = points.iter().map(|point| point.1).collect();
    // A test reads the table; a spring of 1 N/mm stands for one that is none.
    Curve::new(softness * step, &force)
        .or_else(|| Curve::new(1.0, &[1.0, 2.0]))
        .unwrap_or_else(|| unreachable!("a spring"))
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
