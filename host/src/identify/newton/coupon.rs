//! The solve of a condition without a ball: a specimen that deforms homogeneously, or that platens rub.

use lut_gen::solid::homogeneous::{Coupon, Programme};
use lut_gen::solid::law::Parameter;
use lut_gen::solid::model::{Compression, Ends, Press, RAMP_NODES, Resolution};
use lut_gen::solid::solve::{Motion, SolveError};

use super::condition::Condition;
use super::coordinate::Values;

/// Smallest depth of a programme, as a share of the largest: below it stress is proportional to depth to 1e-4.
const LEAST_SHARE: f64 = 1e-4;

/// Mesh of a cylinder between platens: its force is within 0.03 % of the standard one's at two thirds of shortening (alpha 2.5,
/// friction 0.3), for a fifth of the time.
const BARRELLED: Resolution = Resolution::Refined(0.6);

impl Condition {
    /// True where all of the specimen deforms alike: the force costs no finite elements, and is cheaper to compute than to interpolate.
    #[must_use]
    pub fn is_homogeneous(&self) -> bool {
        self.grip.mode().is_some() && !self.rubs
    }

    /// Force for a unit modulus on the grid of a press (`ln(F / d)` over the square root of depth, then the hold), with its
    /// derivatives by the parameters.
    ///
    /// # Errors
    /// As [`Coupon::follow`].
    pub(super) fn stretched(&self, values: &Values, parameters: &[Parameter]) -> Result<Press, SolveError> {
        let mode = self.grip.mode().ok_or_else(|| SolveError::Parameter {
            parameter: "ball_mm",
            value: self.grip.ball_mm(),
            expected: "but a ball's specimen does not deform alike everywhere".to_owned(),
        })?;
        let area_mm2 = std::f64::consts::PI * self.block.radius_mm.powi(2);
        let coupon = Coupon { material: values.unit_material()?, mode, area_mm2 };
        let axis = Press::ramp_axis();
        // Nodes come from the deepest up; a programme goes the other way, through the peak to the hold.
        let place = |k: usize| self.depth_mm * axis.node(k).powi(2).max(LEAST_SHARE);
        let mut depths: Vec<f64> = (0..RAMP_NODES).rev().map(place).collect();
        depths.push(self.depth_mm);
        let mut time_s: Vec<f64> = depths.iter().map(|d| d / self.rate_mm_s).collect();
        let peak_s = self.depth_mm / self.rate_mm_s;
        if self.hold_s > 0.0 {
            time_s.extend(Press::hold_times(self.hold_s).iter().map(|t| peak_s + t));
            depths.resize(time_s.len(), self.depth_mm);
        }
        let stretch = depths.iter().map(|d| 1.0 + self.grip.sense() * d / values.height_mm).collect();
        time_s.insert(0, 0.0);
        let stretch = std::iter::once(1.0).chain::<Vec<f64>>(stretch).collect();
        let response = coupon.follow(&Programme { time_s, stretch }, parameters)?;
        let push = |p: &f64| (self.grip.sense() * p * area_mm2).max(f64::MIN_POSITIVE);
        let force: Vec<f64> = response.stress_mpa.iter().skip(1).map(push).collect();
        let relative: Vec<Vec<f64>> = response
            .sensitivities
            .iter()
            .map(|s| s.stress_mpa.iter().zip(&response.stress_mpa).skip(1).map(|(by, p)| by / p).collect())
            .collect();
        let peak = RAMP_NODES;
        let ramp = |k: usize| (force[RAMP_NODES - 1 - k] / depths[RAMP_NODES - 1 - k]).ln();
        Ok(Press {
            depth_max_mm: self.depth_mm,
            ramp: (0..RAMP_NODES).map(ramp).collect(),
            ramp_by: relative.iter().map(|by| (0..RAMP_NODES).map(|k| by[RAMP_NODES - 1 - k]).collect()).collect(),
            hold_s: self.hold_s,
            hold: force[peak + 1..].iter().map(|f| (f / force[peak]).ln()).collect(),
            hold_by: relative.iter().map(|by| by[peak + 1..].iter().map(|b| b - by[peak]).collect()).collect(),
            scatter: 0.0,
            unknowns: 1,
        })
    }

    /// The same for a cylinder that rubs on its platens, by finite elements.
    ///
    /// # Errors
    /// As [`Compression::sensitivities`].
    pub(super) fn barrelled(&self, values: &Values, parameters: &[Parameter]) -> Result<Press, SolveError> {
        let ramp = Motion::ramp(self.depth_mm, self.rate_mm_s);
        let compression = Compression {
            material: values.unit_material()?,
            height_mm: values.height_mm,
            radius_mm: self.block.radius_mm,
            ends: Ends::Friction(values.platen_friction),
            motion: if self.hold_s > 0.0 { ramp.hold(self.hold_s) } else { ramp },
            resolution: BARRELLED,
        };
        compression.press(parameters)
    }
}
