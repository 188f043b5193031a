//! The four designs of DIAGNOSIS.md.

use palpate::simulate::{RunTemplate, Spec};

/// Heights of specimens, mm.
const THIN_MM: f64 = 12.7;
const THICK_MM: f64 = 25.4;
/// Rates, mm/s.
const RATES_MM_S: [f64; 3] = [0.5, 2.0, 8.0];
/// Largest recorded depth, mm.
pub(super) const PEAK_MM: f64 = 3.0;
const HOLD_S: f64 = 5.0;
const REST_S: f64 = 30.0;

/// Which runs an experiment has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Design {
    /// The thesis' own: balls of 4 and 6 mm, three spots each, 2 mm/s, loading only, 12.7 mm.
    D6,
    /// The same at 0.5, 2 and 8 mm/s.
    D18,
    /// Balls of 4 and 6 mm, three rates, two spots, three cycles; a hold of 5 s and unloading in every run.
    D36,
    /// D36, and at 2 mm/s, two spots and three cycles each: both balls at 25.4 mm, a ball of 9 mm at either height.
    D60,
}

impl Design {
    /// All, smallest first.
    pub const ALL: [Self; 4] = [Self::D6, Self::D18, Self::D36, Self::D60];

    /// Number of runs.
    #[must_use]
    pub fn runs(self) -> usize {
        match self {
            Self::D6 => 6,
            Self::D18 => 18,
            Self::D36 => 36,
            Self::D60 => 60,
        }
    }

    /// Its name, such as "D36".
    #[must_use]
    pub fn name(self) -> String {
        format!("D{}", self.runs())
    }

    /// Radii of the balls, mm.
    #[must_use]
    pub fn radii_mm(self) -> &'static [f64] {
        if self == Self::D60 { &[4.0, 6.0, 9.0] } else { &[4.0, 6.0] }
    }

    /// True when the runs come back and are repeated on a spot.
    #[must_use]
    pub fn has_cycles(self) -> bool {
        matches!(self, Self::D36 | Self::D60)
    }

    /// Adds specimens, balls and runs to a specification.
    pub(super) fn fill(self, mut spec: Spec, mu_mpa: f64, alpha: f64) -> Spec {
        spec = spec.foam("thin", mu_mpa, alpha, THIN_MM);
        if self == Self::D60 {
            spec = spec.foam("thick", mu_mpa, alpha, THICK_MM);
        }
        for radius in self.radii_mm() {
            spec = spec.ball(&ball(*radius), *radius);
        }
        let (rates, replicates): (&[f64], usize) = match self {
            Self::D6 => (&[2.0], 3),
            Self::D18 => (&RATES_MM_S, 3),
            Self::D36 | Self::D60 => (&RATES_MM_S, 2),
        };
        for radius in [4.0, 6.0] {
            for rate in rates {
                spec.runs.push(self.run("thin", radius, *rate, replicates));
            }
        }
        if self == Self::D60 {
            for (specimen, radius) in [("thick", 4.0), ("thick", 6.0), ("thin", 9.0), ("thick", 9.0)] {
                spec.runs.push(self.run(specimen, radius, 2.0, 2));
            }
        }
        spec
    }

    fn run(self, specimen: &str, radius_mm: f64, rate_mm_s: f64, replicates: usize) -> RunTemplate {
        let ramp = RunTemplate::ramp(specimen, &ball(radius_mm), PEAK_MM, rate_mm_s);
        let cycles = self.has_cycles();
        RunTemplate {
            replicates,
            hold_s: if cycles { HOLD_S } else { 0.0 },
            unload: cycles,
            cycles: if cycles { 3 } else { 1 },
            rest_s: REST_S,
            ..ramp
        }
    }
}

/// Name of a ball.
pub(super) fn ball(radius_mm: f64) -> String {
    format!("r{radius_mm}")
}
