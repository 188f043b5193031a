//! A ball pressed into a block at a finite rate.

use super::run::Run;
use super::{Body, DynamicsError, Pressed, Ramp};
use crate::solid::model::Simulation;
use crate::solid::solve::{SolveError, Target};

/// Settings of an explicit run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Explicit {
    /// Density of the undeformed material (kg/m^3), positive.
    pub density_kg_m3: f64,
    /// Factor on the mass, positive: longer steps, more inertia.
    pub mass_scaling: f64,
    /// Mass-proportional damping `alpha` (1/s), not negative. It drags on every motion, the wanted one too.
    pub damping_per_s: f64,
    /// Step over critical step, in (0, 1].
    pub safety: f64,
    /// Steps after which the critical step is computed anew, at least 1.
    pub renewal: usize,
    /// Moments written, at least 4.
    pub moments: usize,
    /// Steps before the run is refused.
    pub most_steps: usize,
}

impl Explicit {
    /// The true mass, no damping, 90 % of the critical step.
    #[must_use]
    pub fn of_density(density_kg_m3: f64) -> Self {
        Self {
            density_kg_m3,
            mass_scaling: 1.0,
            damping_per_s: 0.0,
            safety: 0.9,
            renewal: 100,
            moments: 200,
            most_steps: 2_000_000,
        }
    }

    fn check(&self) -> Result<(), DynamicsError> {
        let positive = |x: f64| x.is_finite() && x > 0.0;
        let rules = [
            ("density_kg_m3", self.density_kg_m3, positive(self.density_kg_m3), "must be positive"),
            ("mass_scaling", self.mass_scaling, positive(self.mass_scaling), "must be positive"),
            (
                "damping_per_s",
                self.damping_per_s,
                self.damping_per_s == 0.0 || positive(self.damping_per_s),
                "must not be negative",
            ),
            ("safety", self.safety, self.safety > 0.0 && self.safety <= 1.0, "must lie in (0, 1]"),
            ("renewal", self.renewal as f64, self.renewal >= 1, "must be at least 1"),
            ("moments", self.moments as f64, self.moments >= 4, "must be at least 4"),
        ];
        refuse_first(&rules)
    }
}

fn refuse_first(rules: &[(&'static str, f64, bool, &str)]) -> Result<(), DynamicsError> {
    match rules.iter().find(|rule| !rule.2) {
        Some(&(parameter, value, _, expected)) => {
            Err(DynamicsError::Parameter { parameter, value, expected: expected.to_owned() })
        }
        None => Ok(()),
    }
}

/// A ramp of the ball with inertia.
#[derive(Debug, Clone, PartialEq)]
pub struct Press {
    /// Material, block, ball, interface and mesh (the finest of its resolution). Its motion is one ramp from
    /// touch: largest depth and rate.
    pub simulation: Simulation,
    /// Share of the depth over which the ball gathers its rate, in (0, 1]: without a smooth start it hits.
    pub smooth: f64,
    /// Mass, damping, step.
    pub explicit: Explicit,
}

impl Press {
    /// Runs to the largest depth.
    ///
    /// # Errors
    /// [`DynamicsError`]: settings out of range, a motion that is no ramp, too many steps, an element
    /// turned inside out.
    pub fn solve(&self) -> Result<Pressed, DynamicsError> {
        self.explicit.check()?;
        refuse_first(&[("smooth", self.smooth, self.smooth > 0.0 && self.smooth <= 1.0, "must lie in (0, 1]")])?;
        let simulation = &self.simulation;
        let ramp = self.ramp()?;
        let mesh = simulation.mesh(simulation.resolution.finest());
        let surface = simulation.assembly(&mesh, 1.0).system.surface().clone();
        let density = 1e-12 * self.explicit.density_kg_m3 * self.explicit.mass_scaling;
        let body = Body::new(&mesh, simulation.specimen.base, surface, density);
        Run::new(self, ramp, &body)?.run()
    }

    /// The motion of the ball.
    ///
    /// # Errors
    /// When the motion of the simulation is not one ramp of depth from touch.
    pub fn ramp(&self) -> Result<Ramp, DynamicsError> {
        self.simulation.check()?;
        let motion = &self.simulation.motion;
        match motion.segments.as_slice() {
            [one] if motion.start_mm == 0.0 => match one.end {
                Target::DepthMm(depth_mm) if depth_mm > 0.0 => {
                    Ok(Ramp { depth_mm, rate_mm_s: depth_mm / one.duration_s, smooth: self.smooth })
                }
                Target::DepthMm(value) => Err(SolveError::parameter("depth_mm", value, "must be positive").into()),
                Target::ForceN(value) => Err(SolveError::parameter("force_n", value, "is no depth").into()),
            },
            all => {
                let expected = "but an explicit run needs one ramp from touch";
                Err(SolveError::parameter("segments of the motion", all.len() as f64, expected).into())
            }
        }
    }
}
