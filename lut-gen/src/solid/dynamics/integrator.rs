//! Central differences with mass-proportional damping.

use super::{Body, Forces};

/// Positions and velocities of the nodes on their way through time.
///
/// Eqs. 63-64 for a lumped mass and `C = alpha M`, written with the velocity between the steps,
/// `v = (u_next - u) / h`, so that the step may change:
/// `v_next = [ (1 - alpha h/2) v + h f/m ] / (1 + alpha h/2)`, `u_next = u + h v_next`. For a constant
/// step the two forms are the same (tested).
#[derive(Debug, Clone, PartialEq)]
pub struct CentralDifference {
    /// Current position `[r, z]` of each node (mm).
    pub position_mm: Vec<[f64; 2]>,
    /// Velocity of each node half a step ago (mm/s).
    pub velocity_mm_s: Vec<[f64; 2]>,
    /// Mass-proportional damping `alpha` (1/s).
    pub damping_per_s: f64,
    last_step_s: Option<f64>,
}

impl CentralDifference {
    /// A body at rest in its reference position.
    #[must_use]
    pub fn at_rest(body: &Body, damping_per_s: f64) -> Self {
        let position_mm = body.reference_mm().to_vec();
        let velocity_mm_s = vec![[0.0; 2]; position_mm.len()];
        Self { position_mm, velocity_mm_s, damping_per_s, last_step_s: None }
    }

    /// Moves on by `step_s` under the forces at the present position. Returns the kinetic energy (N mm)
    /// at the present position: of the mean of the velocities before and after.
    pub fn advance(&mut self, body: &Body, forces: &Forces, step_s: f64) -> f64 {
        let mean_step = 0.5 * (self.last_step_s.unwrap_or(step_s) + step_s);
        // from rest, the first velocity is that after half a step
        let kick = if self.last_step_s.is_some() { mean_step } else { 0.5 * step_s };
        let drag = 0.5 * self.damping_per_s * kick;
        let mut kinetic = 0.0;
        for (node, &mass) in body.mass().iter().enumerate() {
            for k in 0..2 {
                if body.held_directions()[node][k] {
                    continue;
                }
                let before = self.velocity_mm_s[node][k];
                let force = -(forces.internal[node][k] + forces.contact[node][k]);
                let after = ((1.0 - drag) * before + kick * force / mass) / (1.0 + drag);
                let now = if self.last_step_s.is_some() { 0.5 * (before + after) } else { before };
                kinetic += 0.5 * mass * now * now;
                self.velocity_mm_s[node][k] = after;
                self.position_mm[node][k] += step_s * after;
            }
        }
        self.last_step_s = Some(step_s);
        kinetic
    }

    /// Power (N mm/s) of nodal forces at the velocity between the steps.
    #[must_use]
    pub fn power(&self, forces: &[[f64; 2]]) -> f64 {
        forces.iter().zip(&self.velocity_mm_s).map(|(f, v)| f[0] * v[0] + f[1] * v[1]).sum()
    }
}
