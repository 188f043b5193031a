#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
use super::*;
use core::f64::consts::PI;

const T: f64 = 0.02;

/// Complex number, for the loop's frequency response.
#[derive(Clone, Copy)]
struct C(f64, f64);

impl C {
    fn of_angle(w: f64) -> C {
        C(w.cos(), w.sin())
    }
    fn add(self, o: C) -> C {
        C(self.0 + o.0, self.1 + o.1)
    }
    fn times(self, k: f64) -> C {
        C(self.0 * k, self.1 * k)
    }
    fn mul(self, o: C) -> C {
        C(self.0 * o.0 - self.1 * o.1, self.0 * o.1 + self.1 * o.0)
    }
    fn inverse(self) -> C {
        let n = self.0 * self.0 + self.1 * self.1;
        C(self.0 / n, -self.1 / n)
    }
    fn abs(self) -> f64 {
        self.0.hypot(self.1)
    }
}

/// Plant 86/(s^2 + 23.4 s + 86) as a sum of two first-order parts: pole and residue.
fn modes() -> [(f64, f64); 2] {
    let root = (23.4f64 * 23.4 / 4.0 - 86.0).sqrt();
    let (p, q) = (-11.7 + root, -11.7 - root);
    [(p, 86.0 / (p - q)), (q, 86.0 / (q - p))]
}

/// Loop gain at w rad/s: controller of this module, one tick of delay, plant behind a hold.
fn loop_gain(gains: &Gains, w: f64) -> C {
    let z1 = C::of_angle(-w * T);
    let one = C(1.0, 0.0);
    let difference = one.add(z1.times(-1.0));
    let (kp, ki, kd, n) = (f64::from(gains.kp), f64::from(gains.ki), f64::from(gains.kd), f64::from(gains.n));
    let integral = difference.inverse().times(ki * T);
    let filter = C(1.0 + n * T, 0.0).add(z1.times(-1.0)).inverse();
    let derivative = difference.mul(filter).times(kd * n);
    let controller = C(kp, 0.0).add(integral).add(derivative);
    let plant = modes().into_iter().fold(C(0.0, 0.0), |sum, (pole, residue)| {
        let e = (pole * T).exp();
        let hold = z1.mul(one.add(z1.times(-e)).inverse()).times(residue / pole * (e - 1.0));
        sum.add(hold)
    });
    controller.mul(plant).mul(z1)
}

/// Phase margin (degrees) and peak sensitivity over the frequencies of the sampled loop.
fn margins(gains: &Gains) -> (f64, f64) {
    let (mut phase_margin, mut peak, mut last) = (f64::INFINITY, 0.0f64, f64::INFINITY);
    for i in 0..4000 {
        let w = 0.5 * (PI / T / 0.5 * 0.999).powf(f64::from(i) / 4000.0);
        let l = loop_gain(gains, w);
        peak = peak.max(1.0 / C(1.0 + l.0, l.1).abs());
        if last >= 1.0 && l.abs() < 1.0 {
            phase_margin = phase_margin.min(180.0 + l.1.atan2(l.0).to_degrees());
        }
        last = l.abs();
    }
    (phase_margin, peak)
}

/// Unit step through the controller under test and the sampled plant: overshoot, largest command before saturation is applied.
fn unit_step(gains: &Gains) -> (f64, f64, f64) {
    let pid = Pid::build(gains, T as f32, U_MAX_V);
    let (mut state, mut x, mut delayed) = (PidState::default(), [0.0; 2], 0.0);
    let (mut highest, mut command, mut y) = (0.0f64, 0.0f64, 0.0);
    for _ in 0..300 {
        y = x[0] + x[1];
        highest = highest.max(y);
        let u = f64::from(pid.step(&mut state, (1.0 - y) as f32));
        command = command.max(u.abs());
        for (x, (pole, residue)) in x.iter_mut().zip(modes()) {
            let e = (pole * T).exp();
            *x = e * *x + residue / pole * (e - 1.0) * delayed;
        }
        delayed = u;
    }
    (highest - 1.0, command, y)
}

const THESIS: Gains = Gains { kp: 3.661, ki: 14.1596, kd: 0.1787, n: 7.4936 };

#[test]
fn margins_of_the_default_gains_on_the_sampled_loop() {
    let (phase, peak) = margins(&DEFAULT_GAINS);
    let (overshoot, command, end) = unit_step(&DEFAULT_GAINS);
    println!(
        "default gains: phase margin {phase:.1} degrees, peak sensitivity {peak:.3}, overshoot {:.1} %, command {command:.2} V",
        100.0 * overshoot
    );
    assert!(phase >= 55.0 && peak <= 1.6, "{phase} {peak}");
    assert!(overshoot <= 0.05 && command < f64::from(U_MAX_V), "{overshoot} {command}");
    // Settled after 6 s: integral action leaves no error beyond f32.
    assert!((end - 1.0).abs() < 1e-4, "{end}");
}

#[test]
fn continuous_gains_of_the_thesis_lose_their_margin_when_sampled() {
    let (phase, peak) = margins(&THESIS);
    println!("thesis gains: phase margin {phase:.1} degrees, peak sensitivity {peak:.3}");
    // About 34 degrees and 2.6 with the derivative filter discretised otherwise; backward Euler gives 32 and 2.7.
    assert!((phase - 33.0).abs() < 2.0 && (peak - 2.65).abs() < 0.15, "{phase} {peak}");
}

#[test]
fn integral_does_not_wind_up_and_the_loop_leaves_saturation_at_once() {
    let pid = Pid::build(&DEFAULT_GAINS, 0.02, U_MAX_V);
    let mut state = PidState::default();
    for _ in 0..10_000 {
        assert!(pid.step(&mut state, 10.0) <= U_MAX_V);
    }
    assert!(state.integral_v() <= U_MAX_V);
    // With the integral wound up over 10,000 ticks the command would stay at its limit for thousands of them.
    let back = (0..5).map(|_| pid.step(&mut state, -1.0)).position(|u| u < 0.9 * U_MAX_V);
    assert_eq!(back, Some(0));
}

#[test]
fn derivative_is_filtered_and_a_held_error_has_none() {
    let gains = Gains { kp: 0.0, ki: 0.0, kd: 0.1, n: 50.0 };
    let pid = Pid::build(&gains, 0.02, U_MAX_V);
    let mut state = PidState::default();
    // Step of 1 mm: kd n / (1 + n T) = 2.5 V, then falling by 1 / (1 + n T) = 1/2 a tick.
    for expected in [2.5, 1.25, 0.625] {
        assert!((pid.step(&mut state, 1.0) - expected).abs() < 1e-6);
    }
}

#[test]
fn unusable_gains_are_refused() {
    assert!(gains_are_usable(&DEFAULT_GAINS) && gains_are_usable(&THESIS));
    for bad in [
        Gains { kp: f32::NAN, ..DEFAULT_GAINS },
        Gains { ki: -1.0, ..DEFAULT_GAINS },
        Gains { n: 0.0, ..DEFAULT_GAINS },
        Gains { kd: f32::INFINITY, ..DEFAULT_GAINS },
    ] {
        assert!(!gains_are_usable(&bad), "{bad:?}");
    }
    assert!(gains_are_usable(&GAIN_CEILING));
    for bad in [
        Gains { kp: 50.1, ..GAIN_CEILING },
        Gains { ki: 501.0, ..GAIN_CEILING },
        Gains { kd: 5.1, ..GAIN_CEILING },
        Gains { n: 501.0, ..GAIN_CEILING },
    ] {
        assert!(!gains_are_usable(&bad), "{bad:?}");
    }
}

#[test]
fn command_stays_within_its_limit_for_any_error() {
    let pid = Pid::build(&DEFAULT_GAINS, 0.02, U_MAX_V);
    let mut state = PidState::default();
    for error in [0.0, 1e30, -1e30, 3.0, f32::MAX, -f32::MAX, 0.0] {
        let u = pid.step(&mut state, error);
        assert!(u.abs() <= U_MAX_V, "{error}: {u}");
    }
}

/// A blocked shaft is driven at the limit itself, either way: one step short of it would be no stall.
#[test]
fn a_held_error_drives_the_command_to_its_limit() {
    let pid = Pid::build(&DEFAULT_GAINS, 0.02, U_MAX_V);
    for error_mm in [0.4, 0.55, 0.7, 1.3, 1.9] {
        for error_mm in [error_mm, -error_mm] {
            let mut state = PidState::default();
            let u = (0..1000).map(|_| pid.step(&mut state, error_mm)).last().unwrap();
            // f32 rounding of the sum that is the limit.
            assert!((u - U_MAX_V.copysign(error_mm)).abs() < 1e-5, "{error_mm} mm: {u} V");
        }
    }
}
