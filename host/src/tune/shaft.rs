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
    /// Half of the backlash, mm.
    gap_mm: f64,
    /// Largest speed, in units of the first state.
    limit: f64,
    /// Change of speed (order 1: of position) that friction takes away in a step.
    taken: f64,
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
            gap_mm: 0.5 * flaws.backlash_mm,
            limit: flaws.rate_mm_s / scale.abs(),
            taken: flaws.friction_v * brake.abs(),
            h,
            change: (rest.max(0.0) / h).round() as usize,
            shaft: 0.0,
        }
    }

    /// One tick: the shaft at its end, mm; calls `see` with every part of it.
    pub fn tick(&mut self, commands: (f64, f64), see: &mut impl FnMut(usize, f64)) -> f64 {
        match self.state.len() {
            1 => self.tick_of::<1>(commands, see),
            2 => self.tick_of::<2>(commands, see),
            3 => self.tick_of::<3>(commands, see),
            4 => self.tick_of::<4>(commands, see),
            5 => self.tick_of::<5>(commands, see),
            _ => self.tick_of::<6>(commands, see),
        }
        self.shaft
    }

    /// The same of an order that is known when this is compiled, which is several times as fast.
    fn tick_of<const N: usize>(&mut self, (earlier, later): (f64, f64), see: &mut impl FnMut(usize, f64)) {
        let at = |list: &[f64], i: usize| list.get(i).copied().unwrap_or(0.0);
        let phi: [[f64; N]; N] = std::array::from_fn(|i| std::array::from_fn(|j| at(&self.phi, i * N + j)));
        let effect: [f64; N] = std::array::from_fn(|i| at(&self.effect, i));
        let mut state: [f64; N] = std::array::from_fn(|i| at(&self.state, i));
        for i in 0..STEPS {
            let command = if i < self.change { earlier } else { later };
            let mut free = [0.0; N];
            for k in 0..N {
                let mut sum = 0.0;
                for j in 0..N {
                    sum += phi[k][j] * state[j];
                }
                free[k] = sum + effect[k] * command;
            }
            state = self.limited(state, free);
            let spindle = self.scale * state[0];
            self.shaft = self.shaft.clamp(spindle - self.gap_mm, spindle + self.gap_mm);
            if (i + 1) % (STEPS / PARTS) == 0 {
                see((i + 1) / (STEPS / PARTS), self.shaft);
            }
        }
        self.state.iter_mut().zip(state).for_each(|(own, new)| *own = new);
    }

    /// Where a step from a state ends that would end at `next` without flaws.
    #[inline]
    fn limited<const N: usize>(&self, state: [f64; N], mut next: [f64; N]) -> [f64; N] {
        let Self { limit, taken, h, .. } = *self;
        // Friction takes motion away but never reverses it, which also holds a resting shaft.
        let braked = |free: f64| if free.abs() <= taken { 0.0 } else { free - taken * free.signum() };
        if N == 1 {
            next[0] = state[0] + braked(next[0] - state[0]).clamp(-limit * h, limit * h);
            return next;
        }
        let free = next[1];
        let speed = braked(free).clamp(-limit, limit);
        let moved = next[0] + 0.5 * h * (speed - free) - state[0];
        next[0] = state[0] + moved.clamp(-limit * h, limit * h);
        next[1] = speed;
        // At rest a shaft that is held does not creep by what the step moved it before it was braked.
        if speed == 0.0 && state[1] == 0.0 {
            next[0] = state[0];
        }
        next
    }
}
