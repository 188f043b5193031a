//! What a real actuator adds to its transfer function: a limit of speed, dry friction, backlash.

use crate::actuator::flaws::Flaws;
use crate::actuator::plant::Plant;

/// Steps of a tick.
const STEPS: usize = 40;
/// Parts of a tick that are told.
const PARTS: usize = 10;

/// An actuator with flaws. Its numerator is a constant: then the state is the spindle's position and its derivatives, and a limit
/// of speed and dry friction act on the speed.
#[derive(Debug, Clone)]
pub(super) struct Shaft {
    phi: Vec<f64>,
    effect: Vec<f64>,
    /// mm a unit of the first state.
    scale: f64,
    state: Vec<f64>,
    next: Vec<f64>,
    flaws: Flaws,
    /// Change of speed (order 1: of position) by which friction of 1 V brakes in a step.
    brake: f64,
    h: f64,
    /// Steps after which the later command acts.
    change: usize,
    shaft: f64,
}

impl Shaft {
    /// At rest at 0.
    pub fn new(plant: &Plant, flaws: Flaws, tick_s: f64) -> Self {
        let h = tick_s / STEPS as f64;
        let (phi, effect) = plant.held(h);
        let n = plant.order();
        let scale = plant.numerator.at(0);
        // A command of 1 V for a step changes the position of a first-order plant, or the speed of a higher one.
        let brake = if n == 1 { effect[0] } else { effect[1] };
        let rest = plant.delay_s - (plant.delay_s / tick_s + 1e-9).floor() * tick_s;
        Self {
            phi: phi.transpose().as_slice().to_vec(),
            effect: effect.as_slice().to_vec(),
            scale,
            state: vec![0.0; n],
            next: vec![0.0; n],
            flaws,
            brake,
            h,
            change: (rest.max(0.0) / h).round() as usize,
            shaft: 0.0,
        }
    }

    /// One tick: the shaft at its end, mm; calls `see` with every part of it.
    pub fn tick(&mut self, (earlier, later): (f64, f64), see: &mut impl FnMut(usize, f64)) -> f64 {
        for i in 0..STEPS {
            self.step(if i < self.change { earlier } else { later });
            let gap = 0.5 * self.flaws.backlash_mm;
            let spindle = self.scale * self.state[0];
            self.shaft = self.shaft.clamp(spindle - gap, spindle + gap);
            if (i + 1) % (STEPS / PARTS) == 0 {
                see((i + 1) / (STEPS / PARTS), self.shaft);
            }
        }
        self.shaft
    }

    fn step(&mut self, command: f64) {
        let n = self.state.len();
        for i in 0..n {
            let row = &self.phi[i * n..(i + 1) * n];
            self.next[i] = row.iter().zip(&self.state).map(|(a, b)| a * b).sum::<f64>() + self.effect[i] * command;
        }
        let limit = self.flaws.rate_mm_s / self.scale.abs();
        let taken = self.flaws.friction_v * self.brake.abs();
        // Friction takes motion away but never reverses it, which also holds a resting shaft.
        let braked = |free: f64| if free.abs() <= taken { 0.0 } else { free - taken * free.signum() };
        if n == 1 {
            let moved = braked(self.next[0] - self.state[0]);
            self.next[0] = self.state[0] + moved.clamp(-limit * self.h, limit * self.h);
        } else {
            let free = self.next[1];
            let speed = braked(free).clamp(-limit, limit);
            let moved = self.next[0] + 0.5 * self.h * (speed - free) - self.state[0];
            self.next[0] = self.state[0] + moved.clamp(-limit * self.h, limit * self.h);
            self.next[1] = speed;
            // At rest a shaft that is held does not creep by what the step moved it before it was braked.
            if speed == 0.0 && self.state[1] == 0.0 {
                self.next[0] = self.state[0];
            }
        }
        std::mem::swap(&mut self.state, &mut self.next);
    }
}
