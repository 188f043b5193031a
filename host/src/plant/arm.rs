//! The palpation arm: carries the probe at a constant rate.

/// A robot arm that follows a commanded rate within its acceleration.
#[derive(Debug, Clone)]
pub struct Arm {
    position_mm: f64,
    rate_mm_s: f64,
}

/// Acceleration, mm/s^2: full rate of 4 mm/s within 20 ms (assumed; an industrial arm does better).
const ACCELERATION_MM_S2: f64 = 200.0;

/// Mechanical end of the travel above the base plate, mm.
const TRAVEL_MM: (f64, f64) = (0.0, 60.0);

impl Arm {
    /// An arm at rest with the ball's lowest point `position_mm` above the base plate.
    pub fn new(position_mm: f64) -> Self {
        Arm { position_mm, rate_mm_s: 0.0 }
    }

    /// Height of the ball's lowest point above the base plate, mm.
    pub fn position_mm(&self) -> f64 {
        self.position_mm
    }

    /// Moves for `dt_s` towards a commanded rate, mm/s, upwards positive.
    pub fn step(&mut self, command_mm_s: f64, dt_s: f64) {
        let change = ACCELERATION_MM_S2 * dt_s;
        self.rate_mm_s += (command_mm_s - self.rate_mm_s).clamp(-change, change);
        let free = self.position_mm + self.rate_mm_s * dt_s;
        self.position_mm = free.clamp(TRAVEL_MM.0, TRAVEL_MM.1);
        if self.position_mm != free {
            self.rate_mm_s = 0.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rate_is_constant_after_the_start_and_the_ends_hold() {
        let mut arm = Arm::new(30.0);
        for _ in 0..100 {
            arm.step(-4.0, 1e-3);
        }
        let before = arm.position_mm();
        for _ in 0..1000 {
            arm.step(-4.0, 1e-3);
        }
        // Rounding of 1000 additions only.
        assert!((before - arm.position_mm() - 4.0).abs() < 1e-9);
        for _ in 0..60_000 {
            arm.step(-4.0, 1e-3);
        }
        assert_eq!(arm.position_mm(), 0.0);
    }
}
