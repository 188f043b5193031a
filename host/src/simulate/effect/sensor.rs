//! The sensor stage: from the force on the ball to the reading, before noise; and the session clock.

use super::Effect;

/// The sensor that effects make, with what it remembers from run to run.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Sensor {
    gain: f64,
    quadratic_per_n: f64,
    /// Amplitude, time constant (s) and low-passed force (N) of each creep.
    creep: Vec<(f64, f64, f64)>,
    width: f64,
    /// N/h, N, s.
    drift: Vec<(f64, f64, f64)>,
    clock_s: f64,
}

impl Sensor {
    /// At rest, at session time 0.
    pub fn of(effects: &[Effect]) -> Self {
        let mut sensor =
            Self { gain: 1.0, quadratic_per_n: 0.0, creep: Vec::new(), width: 0.0, drift: Vec::new(), clock_s: 0.0 };
        for effect in effects {
            match effect {
                Effect::SensorGain { gain } => sensor.gain *= gain,
                Effect::SensorNonlinearity { quadratic_per_n } => sensor.quadratic_per_n += quadratic_per_n,
                Effect::SensorCreep { amplitude, tau_s } => sensor.creep.push((*amplitude, *tau_s, 0.0)),
                Effect::SensorHysteresis { width } => sensor.width += width,
                Effect::Drift { n_per_h, thermal_n, thermal_s } => {
                    sensor.drift.push((*n_per_h, *thermal_n, *thermal_s));
                }
                _ => {}
            }
        }
        sensor
    }

    /// Zero of the reading at a session time (s), in N.
    pub fn zero_n(&self, clock_s: f64) -> f64 {
        let one = |(n_per_h, thermal_n, thermal_s): &(f64, f64, f64)| {
            n_per_h * clock_s / 3600.0 - thermal_n * (-clock_s / thermal_s).exp_m1()
        };
        self.drift.iter().map(one).sum()
    }

    /// Readings (N) of the forces at `start_s + k dt_s` on the session clock; runs must be read in the order of the session.
    /// Between runs the sensor is unloaded and its creep recovers.
    pub fn read(&mut self, force_n: &[f64], start_s: f64, dt_s: f64) -> Vec<f64> {
        let idle = (start_s - self.clock_s).max(0.0);
        for (_, tau_s, low) in &mut self.creep {
            *low *= (-idle / *tau_s).exp();
        }
        let largest = force_n.iter().fold(0.0, |m: f64, f| m.max(f.abs()));
        let half = 0.5 * self.width * largest;
        let mut play = 0.0_f64;
        let mut before = force_n.first().copied().unwrap_or(0.0);
        let mut out = Vec::with_capacity(force_n.len());
        for (k, &force) in force_n.iter().enumerate() {
            let scaled = self.gain * force;
            let mut reading = scaled + self.quadratic_per_n * scaled * scaled;
            if half > 0.0 {
                // a play of half width: it is pushed by whichever side touches
                play = play.clamp(force - half, force + half);
                reading += play - force;
            }
            for (amplitude, tau_s, low) in &mut self.creep {
                if k > 0 {
                    // exact for a force that is straight within the step
                    let x = dt_s / *tau_s;
                    let share = -(-x).exp_m1();
                    *low += share * (before - *low) + (1.0 - share / x) * (force - before);
                }
                reading += *amplitude * *low;
            }
            before = force;
            out.push(reading + self.zero_n(start_s + dt_s * k as f64));
        }
        self.clock_s = start_s + dt_s * force_n.len() as f64;
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A low-pass of a constant rises by 1 - exp(-t / tau); the first sample is already loaded.
    #[test]
    fn creep_rises_in_a_hold_and_recovers_between_runs() {
        let mut sensor = Sensor::of(&[Effect::SensorCreep { amplitude: 0.1, tau_s: 2.0 }]);
        let reading = sensor.read(&[1.0; 1001], 0.0, 0.01);
        for k in [0, 100, 1000] {
            let expected = 1.0 + 0.1 * (1.0 - (-0.01 * k as f64 / 2.0_f64).exp());
            assert!((reading[k] - expected).abs() < 1e-9, "{k}: {} {expected}", reading[k]);
        }
        let soon = sensor.clone().read(&[0.0], 11.0, 0.01)[0];
        let late = sensor.read(&[0.0], 100.0, 0.01)[0];
        assert!(soon > 0.05 && late < 1e-6, "{soon} {late}");
    }

    #[test]
    fn a_play_reads_less_on_the_way_down_and_more_on_the_way_back() {
        let up: Vec<f64> = (0..=100).map(|k| 0.01 * f64::from(k)).collect();
        let all: Vec<f64> = up.iter().chain(up.iter().rev()).copied().collect();
        let reading = Sensor::of(&[Effect::SensorHysteresis { width: 0.1 }]).read(&all, 0.0, 0.01);
        assert!((reading[50] - (all[50] - 0.05)).abs() < 1e-12);
        assert!((reading[150] - (all[150] + 0.05)).abs() < 1e-12);
    }

    #[test]
    fn gain_square_and_drift() {
        let effects = [
            Effect::SensorGain { gain: 2.0 },
            Effect::SensorNonlinearity { quadratic_per_n: 0.1 },
            Effect::Drift { n_per_h: 3.6, thermal_n: 0.5, thermal_s: 100.0 },
        ];
        let reading = Sensor::of(&effects).read(&[1.0, 1.0], 1000.0, 1.0);
        let zero = |t: f64| 0.001 * t + 0.5 * (1.0 - (-t / 100.0).exp());
        assert!((reading[1] - (2.0 + 0.4 + zero(1001.0))).abs() < 1e-12);
    }
}
