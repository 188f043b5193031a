//! A command in numbers, as a display can be given it.

/// Values that are held and gone over to, one after the other.
#[derive(Debug, Clone, PartialEq)]
pub struct Command {
    /// Values in the channel's input unit.
    pub values: Vec<f64>,
    /// Time at each value, s.
    pub hold_s: f64,
    /// Time from one value to the next, s; 0: a step.
    pub ramp_s: f64,
    /// Yield stress of a fluid at and towards each value, as a part of the largest that was used: the last one
    /// goes on, and none is all of it.
    pub yield_parts: Vec<f64>,
    /// Gap of the magnet, mm; none where it stays as it was.
    pub gap_mm: Option<f64>,
}

impl Command {
    /// Values at a gap and a yield stress that stay as they were.
    #[must_use]
    pub fn new(values: Vec<f64>, hold_s: f64, ramp_s: f64) -> Self {
        Self { values, hold_s, ramp_s, yield_parts: Vec::new(), gap_mm: None }
    }

    /// Length, s.
    #[must_use]
    pub fn length_s(&self) -> f64 {
        self.values.len() as f64 * self.hold_s + self.values.len().saturating_sub(1) as f64 * self.ramp_s
    }

    /// Number of the value that a time (s) belongs to, and the time since it was reached.
    fn place(&self, time_s: f64) -> (usize, f64) {
        let period_s = (self.hold_s + self.ramp_s).max(f64::MIN_POSITIVE);
        let index = ((time_s / period_s).max(0.0) as usize).min(self.values.len().saturating_sub(1));
        (index, time_s - index as f64 * period_s)
    }

    /// The value at a time, s; 0 of no values.
    #[must_use]
    pub fn at(&self, time_s: f64) -> f64 {
        let (index, since_s) = self.place(time_s);
        let Some(own) = self.values.get(index) else { return 0.0 };
        let next = self.values.get(index + 1).filter(|_| since_s > self.hold_s);
        next.map_or(*own, |next| own + (next - own) * ((since_s - self.hold_s) / self.ramp_s).min(1.0))
    }

    /// Yield stress at a time, s, as a part of the largest.
    #[must_use]
    pub fn yield_part(&self, time_s: f64) -> f64 {
        let (index, since_s) = self.place(time_s);
        let towards = if since_s > self.hold_s { index + 1 } else { index };
        self.yield_parts.get(towards).or(self.yield_parts.last()).copied().unwrap_or(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_ramps_and_the_stress_towards_a_value() {
        let steps = Command::new(vec![0.0, 2.0, 0.0], 1.5, 0.0);
        assert_eq!([0.0, 1.4, 1.6, 3.1, 9.0].map(|t| steps.at(t)), [0.0, 0.0, 2.0, 0.0, 0.0]);
        assert_eq!(steps.length_s(), 4.5);
        let ramp = Command { yield_parts: vec![1.0, 0.5, 0.0], ..Command::new(vec![0.0, 2.0, 1.0], 1.0, 2.0) };
        assert_eq!([0.5, 2.0, 3.5, 5.0, 6.5, 9.0].map(|t| ramp.at(t)), [0.0, 1.0, 2.0, 1.5, 1.0, 1.0]);
        assert_eq!([0.5, 2.0, 3.5, 5.0, 9.0].map(|t| ramp.yield_part(t)), [1.0, 0.5, 0.5, 0.0, 0.0]);
        assert_eq!((ramp.length_s(), Command::new(Vec::new(), 1.0, 1.0).at(1.0)), (7.0, 0.0));
        assert_eq!(steps.yield_part(1.0), 1.0);
    }
}
