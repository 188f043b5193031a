//! The display's linear actuator.

use std::collections::VecDeque;

/// A shaft on a spring, driven by a command, with what real ones add: friction, a limit of speed, play, a delay.
#[derive(Debug, Clone)]
pub struct Actuator {
    law: ActuatorLaw,
    spindle_mm: f64,
    rate_mm_s: f64,
    rest_mm: f64,
    /// Where the shaft is behind the spindle's play, mm.
    shaft_mm: f64,
    /// Commands on their way, V, the oldest first, and the time that one takes, s.
    waiting: VecDeque<f64>,
    flaws: ActuatorFlaws,
}

/// How command and force move a shaft: `x'' = spring (mm_per_v u + back F - x) - damper x'`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ActuatorLaw {
    /// Stiffness over mass, 1/s^2.
    pub spring_1_s2: f64,
    /// Damping over mass, 1/s.
    pub damper_1_s: f64,
    /// Shaft at rest over command, mm/V.
    pub mm_per_v: f64,
    /// How far a force drives it back at rest, mm/N: 0 for a spindle, the spring's give for a voice coil.
    pub back_mm_per_n: f64,
}

impl ActuatorLaw {
    /// The thesis' plant 86/(s^2 + 23.4 s + 86) (section 5.5), from command in V to shaft in mm: 1 mm/V at rest, DESIGN's reading
    /// of the thesis' units.
    pub const THESIS: Self = Self { spring_1_s2: 86.0, damper_1_s: 23.4, mm_per_v: 1.0, back_mm_per_n: 0.0 };
}

/// What a real actuator adds to its law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ActuatorFlaws {
    /// Dry friction, as the command that it holds at rest, V.
    pub friction_v: f64,
    /// Largest speed, mm/s.
    pub rate_mm_s: f64,
    /// Time between a command and its effect, s.
    pub delay_s: f64,
    /// Play of the spindle, mm.
    pub backlash_mm: f64,
    /// How far the cap gives way under a finger, mm/N.
    pub gives_mm_per_n: f64,
}

impl ActuatorFlaws {
    /// Neither friction nor a limit of speed: the thesis' plant.
    pub const NONE: Self =
        Self { friction_v: 0.0, rate_mm_s: f64::INFINITY, delay_s: 0.0, backlash_mm: 0.0, gives_mm_per_n: 0.0 };
}

impl Default for ActuatorFlaws {
    /// Those of the bench.
    fn default() -> Self {
        Self { friction_v: FRICTION_V, rate_mm_s: RATE_MM_S, ..Self::NONE }
    }
}

/// Dry friction: a command of 0.03 V does not move a resting shaft (assumed).
const FRICTION_V: f64 = 0.03;

/// Speed limit of the spindle, mm/s (assumed; the thesis names none).
const RATE_MM_S: f64 = 25.0;

/// Stroke, mm (thesis section 5.1.1: about 2 cm).
const STROKE_MM: (f64, f64) = (0.0, 20.0);

impl Actuator {
    /// The thesis' actuator at rest at `rest_mm`, where zero command keeps it.
    pub fn new(rest_mm: f64) -> Self {
        Actuator::with(rest_mm, ActuatorLaw::THESIS, ActuatorFlaws::default())
    }

    /// The same with a stated law and stated flaws.
    pub fn with(rest_mm: f64, law: ActuatorLaw, flaws: ActuatorFlaws) -> Self {
        Actuator {
            law,
            spindle_mm: rest_mm,
            rate_mm_s: 0.0,
            rest_mm,
            shaft_mm: rest_mm,
            waiting: VecDeque::new(),
            flaws,
        }
    }

    /// Shaft position, mm.
    pub fn position_mm(&self) -> f64 {
        self.shaft_mm
    }

    /// How far the cap has given way under a finger's force, mm.
    pub fn cap_mm(&self, force_n: f64) -> f64 {
        self.shaft_mm + self.flaws.gives_mm_per_n * force_n
    }

    /// Shaft speed, mm/s.
    pub fn rate_mm_s(&self) -> f64 {
        self.rate_mm_s
    }

    /// Moves for `dt_s` under a command in V and a finger's force in N, which drives it deeper.
    pub fn step(&mut self, command_v: f64, force_n: f64, dt_s: f64) {
        /// A step in parts of the law's shortest time.
        const PART: f64 = 0.1;
        let command_v = self.delayed(command_v, dt_s);
        let fastest = self.law.damper_1_s.max(self.law.spring_1_s2.sqrt());
        let parts = (dt_s * fastest / PART).ceil().max(1.0);
        (0..parts as usize).for_each(|_| self.part(command_v, force_n, dt_s / parts));
    }

    fn part(&mut self, command_v: f64, force_n: f64, dt_s: f64) {
        let law = self.law;
        let still_mm = self.rest_mm + law.mm_per_v * command_v + law.back_mm_per_n * force_n;
        let drive = law.spring_1_s2 * (still_mm - self.spindle_mm) - law.damper_1_s * self.rate_mm_s;
        let free = self.rate_mm_s + drive * dt_s;
        // Friction takes speed away but never reverses it, which also holds a resting shaft.
        let taken = self.flaws.friction_v * law.mm_per_v * law.spring_1_s2 * dt_s;
        let limit = self.flaws.rate_mm_s;
        self.rate_mm_s = if free.abs() <= taken { 0.0 } else { (free - taken * free.signum()).clamp(-limit, limit) };
        let moved = self.spindle_mm + self.rate_mm_s * dt_s;
        self.spindle_mm = moved.clamp(STROKE_MM.0, STROKE_MM.1);
        if self.spindle_mm != moved {
            self.rate_mm_s = 0.0;
        }
        let play = 0.5 * self.flaws.backlash_mm;
        self.shaft_mm = self.shaft_mm.clamp(self.spindle_mm - play, self.spindle_mm + play);
    }

    /// The command of a while ago; none before the first.
    fn delayed(&mut self, command_v: f64, dt_s: f64) -> f64 {
        let steps = (self.flaws.delay_s / dt_s).round() as usize;
        self.waiting.push_back(command_v);
        if self.waiting.len() > steps { self.waiting.pop_front().unwrap_or(0.0) } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_follows_the_thesis_plant() {
        let mut actuator = Actuator::new(5.0);
        // Overdamped pair of poles: s = -11.7 +/- sqrt(11.7^2 - 86).
        let root = (11.7f64 * 11.7 - 86.0).sqrt();
        let (p, q) = (11.7 - root, 11.7 + root);
        for ms in 1..=1000 {
            actuator.step(2.0, 0.0, 1e-3);
            if ms % 100 == 0 {
                let t = f64::from(ms) * 1e-3;
                let exact = 5.0 + 2.0 * (1.0 - (q * (-p * t).exp() - p * (-q * t).exp()) / (q - p));
                // Friction holds back 0.03 mm, the step of 1 ms errs by less than as much again.
                assert!(
                    (actuator.position_mm() - exact).abs() < 0.06,
                    "{} for {exact} at {t} s",
                    actuator.position_mm()
                );
            }
        }
    }

    #[test]
    fn a_command_waits_and_play_is_crossed_first() {
        let flaws = ActuatorFlaws { delay_s: 0.01, backlash_mm: 0.2, gives_mm_per_n: 0.05, ..ActuatorFlaws::NONE };
        let with = |flaws| Actuator::with(5.0, ActuatorLaw::THESIS, flaws);
        let (mut late, mut prompt) = (with(flaws), with(ActuatorFlaws::NONE));
        (0..10).for_each(|_| late.step(2.0, 0.0, 1e-3));
        assert_eq!(late.position_mm(), 5.0);
        for _ in 0..500 {
            late.step(2.0, 0.0, 1e-3);
            prompt.step(2.0, 0.0, 1e-3);
        }
        assert!((prompt.position_mm() - late.position_mm() - 0.1).abs() < 1e-9, "half of the play behind");
        assert!((late.cap_mm(2.0) - late.position_mm() - 0.1).abs() < 1e-12);
    }

    #[test]
    fn a_small_command_does_not_move_it_and_the_stroke_ends() {
        let mut actuator = Actuator::new(5.0);
        for _ in 0..1000 {
            actuator.step(0.02, 0.0, 1e-3);
        }
        assert_eq!(actuator.position_mm(), 5.0);
        for _ in 0..5000 {
            actuator.step(-50.0, 0.0, 1e-3);
        }
        assert_eq!(actuator.position_mm(), 0.0);
    }

    #[test]
    fn a_voice_coil_is_driven_back_by_a_force_and_its_command_holds_it() {
        let law = ActuatorLaw { spring_1_s2: 2e4, damper_1_s: 200.0, mm_per_v: 4.0, back_mm_per_n: 0.5 };
        let stiff = ActuatorLaw { spring_1_s2: 1e6, damper_1_s: 1e4, ..law };
        let rest_of = |law, command_v: f64, force_n: f64| {
            let mut actuator = Actuator::with(5.0, law, ActuatorFlaws::NONE);
            (0..1000).for_each(|_| actuator.step(command_v, force_n, crate::plant::STEP_S));
            actuator.position_mm()
        };
        assert!((rest_of(stiff, 1.0, 0.0) - 9.0).abs() < 1e-6, "as far as a file may go");
        let rest = |command_v: f64, force_n: f64| rest_of(law, command_v, force_n);
        for (command_v, force_n, exact) in [(1.0, 0.0, 9.0), (0.0, 3.0, 6.5), (-0.375, 3.0, 5.0)] {
            assert!((rest(command_v, force_n) - exact).abs() < 1e-9, "{command_v} V, {force_n} N");
        }
    }
}
