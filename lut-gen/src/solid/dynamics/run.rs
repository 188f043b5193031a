//! The loop over the steps of a run.

use super::{Body, CentralDifference, DynamicsError, Forces, Moment, Press, Pressed, Ramp, critical_step_s};
use crate::solid::law::Material;
use crate::solid::solve::{History, Step};

/// A run under way.
pub(super) struct Run<'a> {
    press: &'a Press,
    ramp: Ramp,
    body: &'a Body,
    motion: CentralDifference,
    forces: Forces,
    /// History at the present position, and the one being written.
    history: History,
    next: History,
    now: Moment,
    /// What led to the present position: way of the ball (mm), step (s), dissipation before it (N mm/s).
    way_mm: f64,
    last_step_s: f64,
    dissipation: f64,
    /// Work done on the elements, and work of the contact on the nodes, so far (N mm).
    work: f64,
    pressed: f64,
    /// Step allowed at present (s).
    step_s: f64,
    out: Pressed,
}

impl<'a> Run<'a> {
    pub(super) fn new(press: &'a Press, ramp: Ramp, body: &'a Body) -> Result<Self, DynamicsError> {
        let history = body.untouched(&press.simulation.material, 0.0);
        let mut run = Self {
            press,
            ramp,
            body,
            motion: CentralDifference::at_rest(body, press.explicit.damping_per_s),
            forces: Forces::default(),
            next: history.clone(),
            history,
            now: Moment::default(),
            way_mm: 0.0,
            last_step_s: 0.0,
            dissipation: 0.0,
            work: 0.0,
            pressed: 0.0,
            step_s: 0.0,
            out: Pressed {
                moments: Vec::with_capacity(press.explicit.moments + 1),
                steps: 0,
                smallest_step_s: f64::INFINITY,
                rate_mm_s: ramp.rate_mm_s,
                mass_scaling: press.explicit.mass_scaling,
            },
        };
        run.renew_step()?;
        let needed = ramp.duration_s() / run.step_s;
        if needed > press.explicit.most_steps as f64 {
            let (step_s, allowed, rate_mm_s) = (run.step_s, press.explicit.most_steps, ramp.rate_mm_s);
            return Err(DynamicsError::TooManySteps { needed, step_s, allowed, rate_mm_s });
        }
        Ok(run)
    }

    fn material(&self) -> &'a Material {
        &self.press.simulation.material
    }

    fn inverted(&self, element: usize) -> DynamicsError {
        let (depth_mm, steps, step_s) = (self.now.depth_mm, self.out.steps, self.step_s);
        DynamicsError::Inverted { element, depth_mm, steps, step_s }
    }

    /// The critical step, of the instantaneous response.
    fn renew_step(&mut self) -> Result<(), DynamicsError> {
        let material = self.material();
        let relaxation = material.relaxation(0.0);
        let step = Step { material, relaxation, old: &self.history, depth_mm: self.now.depth_mm };
        let critical = critical_step_s(self.body, &step, &self.motion.position_mm);
        self.step_s = self.press.explicit.safety * critical.map_err(|element| self.inverted(element))?;
        self.out.smallest_step_s = self.out.smallest_step_s.min(self.step_s);
        Ok(())
    }

    pub(super) fn run(mut self) -> Result<Pressed, DynamicsError> {
        let end_s = self.ramp.duration_s();
        let every_mm = self.ramp.depth_mm / self.press.explicit.moments as f64;
        loop {
            self.evaluate()?;
            if self.out.steps > 0 && self.out.steps.is_multiple_of(self.press.explicit.renewal) {
                self.renew_step()?;
            }
            let rest_s = end_s - self.now.time_s;
            let step = if rest_s > 0.0 { self.step_s.min(rest_s) } else { self.step_s };
            // works by trapezoids: half a step with the velocity before, half with the one after
            self.collect_work(self.last_step_s);
            let kinetic = self.motion.advance(self.body, &self.forces, step);
            self.account(kinetic);
            let depth = self.now.depth_mm;
            if self.out.moments.is_empty() || depth >= every_mm * self.out.moments.len() as f64 || rest_s <= 0.0 {
                self.out.moments.push(self.now);
            }
            if rest_s <= 0.0 {
                return Ok(self.out);
            }
            self.collect_work(step);
            self.go_on(step, if step == rest_s { end_s } else { self.now.time_s + step });
        }
    }

    /// Forces at the present position; the history moves on to it.
    fn evaluate(&mut self) -> Result<(), DynamicsError> {
        let material = self.material();
        let relaxation = material.relaxation(self.last_step_s);
        let step = Step { material, relaxation, old: &self.history, depth_mm: self.now.depth_mm };
        let done = self.body.evaluate(&step, &self.motion.position_mm, &mut self.next, &mut self.forces);
        done.map_err(|element| self.inverted(element))?;
        std::mem::swap(&mut self.history, &mut self.next);
        Ok(())
    }

    fn collect_work(&mut self, step_s: f64) {
        self.work += 0.5 * step_s * self.motion.power(&self.forces.internal);
        self.pressed -= 0.5 * step_s * self.motion.power(&self.forces.contact);
    }

    /// Energies at the present position.
    fn account(&mut self, kinetic: f64) {
        let elastic = self.material().is_elastic();
        let now = &mut self.now;
        now.force_n = self.forces.sum.force_n;
        now.base_force_n = self.forces.base_force_n;
        now.kinetic = kinetic;
        now.external += 0.5 * now.force_n * self.way_mm;
        now.strain = if elastic { self.forces.strain_energy } else { self.work };
        let rubbed = self.body.surface.has_friction();
        now.contact = if rubbed { now.external - self.pressed } else { self.forces.sum.energy };
        let dissipation = 2.0 * self.press.explicit.damping_per_s * kinetic;
        now.damping += 0.5 * (self.dissipation + dissipation) * self.last_step_s;
        self.dissipation = dissipation;
    }

    fn go_on(&mut self, step_s: f64, time_s: f64) {
        let depth_mm = self.ramp.at(time_s);
        self.way_mm = depth_mm - self.now.depth_mm;
        self.last_step_s = step_s;
        self.now.external += 0.5 * self.now.force_n * self.way_mm;
        (self.now.time_s, self.now.depth_mm) = (time_s, depth_mm);
        self.out.steps += 1;
    }
}
