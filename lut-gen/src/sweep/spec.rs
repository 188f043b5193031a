//! What a sweep covers, and whether that makes sense.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::{Parameter, Spacing, SweepAxis};

/// Law of the specimen, one term.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SweepLaw {
    /// Compressible foam, thesis Eq. 1.
    Hyperfoam,
    /// Nearly incompressible rubber or tissue, thesis Eq. 2.
    Ogden,
}

/// How the specimen rests on its table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SweepBase {
    /// Glued, or too rough to slide.
    Bonded,
    /// Free to slide sideways.
    Sliding,
}

/// How the ball moves: a ramp at each of the rates, then, if asked for, it holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SweepMotion {
    /// Rates of the ramp (mm/s); one curve each.
    pub rates_mm_s: Vec<f64>,
    /// Depths of the ramp at which the force is kept (mm), rising; the last one is held.
    pub depths_mm: Vec<f64>,
    /// Times after the end of the ramp at which the force is kept (s), rising; may be empty.
    pub holds_s: Vec<f64>,
}

impl SweepMotion {
    /// Forces in one curve.
    #[must_use]
    pub fn samples(&self) -> usize {
        self.depths_mm.len() + self.holds_s.len()
    }

    /// The largest depth (mm); 0 without depths.
    #[must_use]
    pub fn depth_mm(&self) -> f64 {
        self.depths_mm.last().copied().unwrap_or(0.0)
    }
}

/// Everything that decides the numbers in a sweep's table, besides the engine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SweepSpec {
    /// A title.
    pub name: String,
    /// Law of the specimen.
    pub law: SweepLaw,
    /// How it rests.
    pub base: SweepBase,
    /// Motion of the ball.
    pub motion: SweepMotion,
    /// Parameters that do not vary.
    pub fixed: BTreeMap<Parameter, f64>,
    /// Parameters that do; the last axis varies fastest.
    pub axes: Vec<SweepAxis>,
    /// Element sizes of the standard mesh are divided by this.
    pub refinement: f64,
    /// So many points are solved again on a finer mesh, and so many between the points, to state the error.
    pub checks: usize,
}

/// What is wrong with a [`SweepSpec`].
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{place}: {what} is {found}; expected {expected}")]
pub struct SpecError {
    /// Part of the specification, such as `axis alpha`.
    pub place: String,
    /// The quantity at fault.
    pub what: String,
    /// Its value.
    pub found: String,
    /// What was expected.
    pub expected: String,
}

/// Most points of a sweep.
pub const MOST_POINTS: usize = 10_000_000;

/// Most numbers of a table: 8 GiB.
const MOST_FORCES: usize = 1 << 30;

impl SweepSpec {
    /// A sweep without axes, at the defaults: frictionless, bonded, radius 25 mm, 200 depths to 4 mm at
    /// 1 mm/s into a block of 12.7 mm by a ball of 4 mm, no check.
    #[must_use]
    pub fn new(name: &str, law: SweepLaw) -> Self {
        let mut fixed = BTreeMap::from([
            (Parameter::Friction, 0.0),
            (Parameter::BallRadius, 4.0),
            (Parameter::Height, 12.7),
            (Parameter::SpecimenRadius, 25.0),
        ]);
        if law == SweepLaw::Hyperfoam {
            fixed.insert(Parameter::Nu, 0.0);
        }
        let depths_mm = (1..=200).map(|i| 0.02 * f64::from(i)).collect();
        Self {
            name: name.to_owned(),
            law,
            base: SweepBase::Bonded,
            motion: SweepMotion { rates_mm_s: vec![1.0], depths_mm, holds_s: Vec::new() },
            fixed,
            axes: Vec::new(),
            refinement: 1.0,
            checks: 0,
        }
    }

    /// The same with one more axis, in place of a fixed value.
    #[must_use]
    pub fn over(mut self, axis: SweepAxis) -> Self {
        self.fixed.remove(&axis.parameter);
        self.axes.push(axis);
        self
    }

    /// The axis of a parameter.
    #[must_use]
    pub fn axis(&self, parameter: Parameter) -> Option<&SweepAxis> {
        self.axes.iter().find(|a| a.parameter == parameter)
    }

    fn has(&self, parameter: Parameter) -> bool {
        self.fixed.contains_key(&parameter) || self.axis(parameter).is_some()
    }

    /// Least value that a parameter takes.
    fn least(&self, parameter: Parameter) -> Option<f64> {
        let fixed = self.fixed.get(&parameter).copied();
        fixed.or_else(|| self.axis(parameter).and_then(|a| a.values.first().copied()))
    }

    /// The specification as JSON, the same text for the same specification.
    #[must_use]
    pub fn text(&self) -> String {
        serde_json::to_string(self).unwrap_or_default()
    }

    /// SHA-256 over specification and engine: journals of one hash belong together.
    #[must_use]
    pub fn identity(&self, engine: &str) -> [u8; 32] {
        let mut hash = Sha256::new();
        for part in [self.text().as_str(), engine] {
            hash.update((part.len() as u64).to_le_bytes());
            hash.update(part);
        }
        hash.finalize().into()
    }

    /// Whether it can be swept.
    ///
    /// # Errors
    /// [`SpecError`] names the part at fault, its value and what was expected: an axis that does not rise, a
    /// parameter out of its range, given twice, missing or foreign to the law, a factor that the force is not
    /// proportional to, a motion deeper than the block, too many points.
    pub fn check(&self) -> Result<(), SpecError> {
        self.check_parameters()?;
        for axis in &self.axes {
            self.check_axis(axis)?;
        }
        self.check_motion()?;
        if !(0.3..=6.0).contains(&self.refinement) {
            return Err(wrong("solve", "refinement", self.refinement, "0.3 to 6"));
        }
        if self.checks > 10_000 {
            return Err(wrong("solve", "checks", self.checks, "at most 10000"));
        }
        let points = self.axes.iter().try_fold(1_usize, |n, a| n.checked_mul(a.solved()));
        let forces = points.and_then(|n| n.checked_mul(self.motion.rates_mm_s.len() * self.motion.samples()));
        match (points, forces) {
            (Some(n), Some(f)) if n <= MOST_POINTS && f <= MOST_FORCES => Ok(()),
            _ => {
                let counts: Vec<String> = self.axes.iter().map(|a| a.solved().to_string()).collect();
                let expected = format!("at most {MOST_POINTS} points and {MOST_FORCES} forces in all");
                Err(wrong("the axes", "the number of points", counts.join(" x "), &expected))
            }
        }
    }

    fn check_parameters(&self) -> Result<(), SpecError> {
        use Parameter as P;
        let foreign: &[P] = match self.law {
            SweepLaw::Hyperfoam => &[P::D, P::DMu],
            SweepLaw::Ogden => &[P::Nu],
        };
        let law = format!("the {} law", if self.law == SweepLaw::Ogden { "ogden" } else { "hyperfoam" });
        if let Some(p) = foreign.iter().find(|p| self.has(**p)) {
            return Err(wrong(&law, p.name(), "given", "only parameters of that law"));
        }
        let mut needed = vec![P::Mu, P::Alpha, P::Friction, P::BallRadius, P::Height, P::SpecimenRadius];
        match self.law {
            SweepLaw::Hyperfoam => needed.push(P::Nu),
            SweepLaw::Ogden if self.has(P::DMu) && self.has(P::D) => {
                return Err(wrong(&law, "D_per_MPa", "given beside D_mu", "one of the two"));
            }
            SweepLaw::Ogden if self.has(P::DMu) => {}
            SweepLaw::Ogden => needed.push(P::D),
        }
        let prony = [P::G, P::K, P::Tau];
        if prony.iter().any(|p| self.has(*p)) {
            needed.extend(prony);
        }
        for p in needed {
            if !self.has(p) {
                return Err(wrong(&law, p.name(), "missing", "a fixed value or an axis"));
            }
        }
        for (p, value) in &self.fixed {
            let (fits, expected) = p.accepts(*value);
            if !fits {
                return Err(wrong("fixed values", p.name(), value, expected));
            }
        }
        Ok(())
    }

    fn check_axis(&self, axis: &SweepAxis) -> Result<(), SpecError> {
        let place = format!("axis {}", axis.parameter.name());
        if axis.values.is_empty() {
            return Err(wrong(&place, "the number of values", 0, "at least 1"));
        }
        for &value in &axis.values {
            let (fits, expected) = axis.parameter.accepts(value);
            if !fits {
                return Err(wrong(&place, "a value", value, expected));
            }
            if axis.spacing == Spacing::Logarithmic && value <= 0.0 {
                return Err(wrong(&place, "a value", value, "above 0 on a logarithmic axis"));
            }
        }
        rising(&place, "values", &axis.values)?;
        if self.fixed.contains_key(&axis.parameter) {
            return Err(wrong(&place, "a fixed value", "given as well", "either of the two"));
        }
        if self.axes.iter().filter(|a| a.parameter == axis.parameter).count() > 1 {
            return Err(wrong(&place, "the axis", "given twice", "one axis a parameter"));
        }
        let proportional =
            axis.parameter == Parameter::Mu && (self.law == SweepLaw::Hyperfoam || self.has(Parameter::DMu));
        if axis.factor && !proportional {
            let expected = "false: only mu_MPa is a factor of the force, with hyperfoam, or with ogden at given D_mu";
            return Err(wrong(&place, "factor", true, expected));
        }
        Ok(())
    }

    fn check_motion(&self) -> Result<(), SpecError> {
        let motion = &self.motion;
        let lists =
            [("rates_mm_s", &motion.rates_mm_s), ("depths_mm", &motion.depths_mm), ("holds_s", &motion.holds_s)];
        for (name, values) in lists {
            if values.is_empty() && name != "holds_s" {
                return Err(wrong("motion", name, "empty", "at least one value"));
            }
            if let Some(bad) = values.iter().find(|v| !(**v > 0.0 && **v <= 1e9)) {
                return Err(wrong("motion", name, format!("a list with {bad}"), "values above 0 and at most 1e9"));
            }
            rising("motion", name, values)?;
        }
        if let Some(height) = self.least(Parameter::Height)
            && motion.depth_mm() >= 0.95 * height
        {
            let expected = format!("below 95 % of the least height, {height} mm");
            return Err(wrong("motion", "the largest depth", format!("{} mm", motion.depth_mm()), &expected));
        }
        Ok(())
    }
}

fn rising(place: &str, what: &str, values: &[f64]) -> Result<(), SpecError> {
    match values.windows(2).find(|w| w[1] <= w[0]) {
        Some(w) => Err(wrong(place, what, format!("{} after {}", w[1], w[0]), "a strictly rising list")),
        None => Ok(()),
    }
}

fn wrong(place: &str, what: &str, found: impl std::fmt::Display, expected: &str) -> SpecError {
    SpecError {
        place: place.to_owned(),
        what: what.to_owned(),
        found: found.to_string(),
        expected: expected.to_owned(),
    }
}
