//! What a display does by its base law and the effects that were added: from what was told to what is measured.

use super::channel::{Channel, KNEE_A, Reading};
use super::design::Series;
use super::effect::{
    Effect, Quantity, backlash, coil_heating, delay, gap, rate_limit, remanence, saturation, sensor_creep,
    sensor_hysteresis, sensor_nonlinearity, stiction,
};
use super::winding;

/// Response time of the fluid, s (1 to 6 ms).
pub const RESPONSE_S: f64 = 3e-3;

/// Longest step in which friction and speed are taken as constant, s.
const STEP_S: f64 = 2e-3;

/// An effect with its parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    /// The effect.
    pub effect: &'static Effect,
    /// Its parameters, in the order of its quantities.
    pub values: Vec<f64>,
}

/// The base law of a channel with effects.
#[derive(Debug, Clone, PartialEq)]
pub struct Law {
    /// What is measured.
    pub channel: Channel,
    /// Parameters of the base, in the order of [`Channel::base`].
    pub base: Vec<f64>,
    /// Effects.
    pub settings: Vec<Setting>,
}

impl Law {
    /// The base with its nominal parameters.
    #[must_use]
    pub fn nominal(channel: Channel) -> Self {
        Self { channel, base: channel.base().iter().map(|p| p.nominal).collect(), settings: Vec::new() }
    }

    pub(super) fn of(&self, effect: &Effect) -> Option<&[f64]> {
        let found = self.settings.iter().find(|s| s.effect.code == effect.code && s.effect.form == effect.form);
        found.map(|s| s.values.as_slice())
    }

    pub(super) fn one(&self, effect: &Effect) -> Option<f64> {
        self.of(effect).and_then(|values| values.first().copied())
    }

    pub(super) fn two(&self, effect: &Effect) -> Option<(f64, f64)> {
        match self.of(effect) {
            Some(&[a, b]) => Some((a, b)),
            _ => None,
        }
    }

    /// What is measured in a run.
    #[must_use]
    pub fn predict(&self, series: &Series) -> Vec<f64> {
        self.read(self.happens(series))
    }

    /// What happens as it is read: with gain and zero of the base.
    fn read(&self, mut happened: Vec<f64>) -> Vec<f64> {
        let Reading { gain, zero } = self.channel.reading();
        let (gain, zero) = (gain.map_or(1.0, |at| self.base[at]), self.base[zero]);
        happened.iter_mut().for_each(|y| *y = gain * *y + zero);
        happened
    }

    /// What happens in a run, before it is read with a gain and a zero.
    #[must_use]
    pub fn happens(&self, series: &Series) -> Vec<f64> {
        match self.channel {
            Channel::Position => self.position_mm(series),
            Channel::Force => self.force_n(series),
            Channel::Current => self.current_a(series),
            Channel::Flux => self.flux_t(series),
            Channel::Pulp => self.pulp_n(series),
            Channel::Fluid => self.fluid_n(series),
        }
    }

    fn position_mm(&self, series: &Series) -> Vec<f64> {
        let [spring, damper] = [2, 3].map(|i| self.base[i]);
        let shaft = Shaft {
            spring,
            damper,
            delay_s: self.one(&delay::EFFECT).unwrap_or(0.0),
            limit_mm_s: self.one(&rate_limit::EFFECT).unwrap_or(f64::INFINITY),
            friction_mm: self.one(&stiction::EFFECT).unwrap_or(0.0),
        };
        let mut shaft_mm = shaft.follow(&series.time_s, &series.input);
        if let Some(play_mm) = self.one(&backlash::EFFECT) {
            shaft_mm = backlash::behind(&shaft_mm, play_mm);
        }
        shaft_mm
    }

    fn force_n(&self, series: &Series) -> Vec<f64> {
        let mut felt_n = series.input.clone();
        if let Some(half_width) = self.one(&sensor_hysteresis::EFFECT) {
            felt_n = sensor_hysteresis::felt(&felt_n, half_width);
        }
        if let Some(exponent) = self.one(&sensor_nonlinearity::POWER) {
            felt_n.iter_mut().for_each(|n| *n = sensor_nonlinearity::powered(*n, exponent));
        }
        if let Some(per_n) = self.one(&sensor_nonlinearity::QUADRATIC) {
            felt_n.iter_mut().for_each(|n| *n += per_n * *n * *n);
        }
        if let Some(parts) = self.two(&sensor_creep::MEMORY) {
            felt_n = sensor_creep::remembered(&series.time_s, &felt_n, parts);
        }
        if let Some(per_decade) = self.one(&sensor_creep::LOGARITHMIC) {
            felt_n = sensor_creep::crept(&series.time_s, &felt_n, per_decade);
        }
        felt_n
    }

    fn current_a(&self, series: &Series) -> Vec<f64> {
        winding::followed(&series.time_s, &series.input, &self.kept(series))
    }

    /// What the fluid has answered of a series' current, A.
    #[must_use]
    pub fn answered_a(&self, series: &Series) -> Vec<f64> {
        self.read(winding::answered(&series.time_s, &series.input, &self.kept(series)))
    }

    /// Resistance of the cold winding over what it is at every stamp.
    fn kept(&self, series: &Series) -> Vec<f64> {
        match self.two(&coil_heating::EFFECT) {
            Some(parts) => coil_heating::kept(&series.time_s, &series.input, parts),
            None => vec![1.0; series.input.len()],
        }
    }

    fn flux_t(&self, series: &Series) -> Vec<f64> {
        let (slope, step_t) = (self.base[0], self.base[1]);
        let smallest_mm = series.gap_mm / series.gap_ratio;
        let factor = gap::factor(series.gap_mm, smallest_mm, self.one(&gap::EFFECT).unwrap_or(0.0));
        let left_t = self.two(&remanence::EFFECT).map(|parts| remanence::left(&series.input, parts));
        let line = |a: f64| factor * (slope * a + step_t * (a / KNEE_A).tanh());
        let limit_t = self.one(&saturation::EFFECT);
        let mut before_t = None;
        let each = series.input.iter().enumerate().map(|(k, a)| {
            let core_t = limit_t.map_or(line(*a), |limit| saturation::bent(line(*a), limit));
            let rest_t = core_t + left_t.as_ref().map_or(0.0, |left| left[k]);
            let span_s = if k > 0 { series.time_s[k] - series.time_s[k - 1] } else { 0.0 };
            let now_t = if series.is_answered {
                rest_t
            } else {
                before_t.map_or(rest_t, |before: f64| rest_t + (before - rest_t) * (-span_s / RESPONSE_S).exp())
            };
            before_t = Some(now_t);
            now_t
        });
        each.collect()
    }
}

/// The linear actuator: `x'' = spring (u - x) - damper x'`, with what was added.
#[derive(Debug, Clone, Copy)]
struct Shaft {
    spring: f64,
    damper: f64,
    delay_s: f64,
    limit_mm_s: f64,
    friction_mm: f64,
}

/// Exact step of the free actuator: rows of the matrix that carries distance from rest and speed over a time.
type Carry = [[f64; 2]; 2];

impl Shaft {
    /// Position at every time stamp; the run begins at rest where its first command holds it.
    fn follow(&self, time_s: &[f64], command_mm: &[f64]) -> Vec<f64> {
        let Some((&first_s, &start_mm)) = time_s.first().zip(command_mm.first()) else { return Vec::new() };
        let (mut x, mut v) = (start_mm, 0.0);
        let (mut now_s, mut hint) = (first_s, 0);
        let (mut carry, mut carry_s) = (self.carry(0.0), 0.0_f64);
        let mut out = Vec::with_capacity(time_s.len());
        for stamp_s in time_s {
            let span_s = stamp_s - now_s;
            let steps = (span_s / STEP_S).ceil().clamp(0.0, 1e5);
            let step_s = span_s / steps.max(1.0);
            if (step_s - carry_s).abs() > 1e-9 * STEP_S {
                (carry, carry_s) = (self.carry(step_s), step_s);
            }
            for i in 0..steps as usize {
                let from_s = now_s + i as f64 * step_s - self.delay_s;
                let u = delay::held(time_s, command_mm, (from_s, from_s + step_s), &mut hint);
                (x, v) = self.step((x, v), u, &carry, step_s);
            }
            now_s = *stamp_s;
            out.push(x);
        }
        out
    }

    /// One step of constant command and direction.
    fn step(&self, (x, v): (f64, f64), u: f64, carry: &Carry, step_s: f64) -> (f64, f64) {
        let rests = v == 0.0;
        if rests && stiction::holds(u, x, self.friction_mm) {
            return (x, 0.0);
        }
        let direction = if rests { (u - x).signum() } else { v.signum() };
        let rest_mm = u - self.friction_mm * direction;
        let distance = x - rest_mm;
        let mut to_mm = rest_mm + carry[0][0] * distance + carry[0][1] * v;
        let mut speed = carry[1][0] * distance + carry[1][1] * v;
        if self.friction_mm > 0.0 && speed * direction < 0.0 {
            // friction stops a shaft but does not turn it
            speed = 0.0;
        }
        let limited = rate_limit::limited(speed, self.limit_mm_s);
        if limited != speed {
            speed = limited;
            to_mm = x + rate_limit::limited((to_mm - x) / step_s, self.limit_mm_s) * step_s;
        }
        (to_mm, speed)
    }

    fn carry(&self, t: f64) -> Carry {
        // e^(-s t) (C(t), S(t)) of the damped oscillator, S the limit of sin(w t)/w for any sign of w^2
        let s = 0.5 * self.damper;
        let square = self.spring - s * s;
        let w = square.abs().sqrt();
        let (c, sine) = if w * t < 1e-6 {
            (1.0, t)
        } else if square > 0.0 {
            ((w * t).cos(), (w * t).sin() / w)
        } else {
            ((w * t).cosh(), (w * t).sinh() / w)
        };
        let decay = (-s * t).exp();
        [[decay * (c + s * sine), decay * sine], [-decay * self.spring * sine, decay * (c - s * sine)]]
    }
}

/// What a plausible amount of an effect is, once for every start of its shape parameters.
#[must_use]
pub fn plausible(effect: &'static Effect) -> Vec<Setting> {
    starts(effect, Quantity::plausible_values)
}

/// Every combination of an effect's starts.
#[must_use]
pub fn starting(effect: &'static Effect) -> Vec<Setting> {
    starts(effect, |q| q.starts.to_vec())
}

fn starts(effect: &'static Effect, of: impl Fn(&Quantity) -> Vec<f64>) -> Vec<Setting> {
    let list = Quantity::combined(effect.quantities, of);
    list.into_iter().map(|values| Setting { effect, values }).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn step(height_mm: f64) -> Series {
        let time_s: Vec<f64> = (0..200).map(|k| 0.02 * f64::from(k)).collect();
        let input = time_s.iter().map(|t| if *t < 0.1 { 0.0 } else { height_mm }).collect();
        let compared = vec![true; time_s.len()];
        let file = "step.csv".to_owned();
        Series {
            file,
            channel: Channel::Position,
            output: Vec::new(),
            time_s,
            input,
            yield_kpa: Vec::new(),
            compared,
            is_answered: false,
            left: [Vec::new(), Vec::new()],
            gap_ratio: 1.0,
            gap_mm: 0.0,
            condition: 0,
            hold_out: false,
        }
    }

    fn with(effect: &'static Effect, value: f64) -> Law {
        let mut law = Law::nominal(Channel::Position);
        law.settings.push(Setting { effect, values: vec![value] });
        law
    }

    /// Step response of 86/(s^2 + 23.4 s + 86): two real poles.
    #[test]
    fn the_base_is_the_thesis_plant() {
        let root = (11.7f64 * 11.7 - 86.0).sqrt();
        let (p, q) = (11.7 - root, 11.7 + root);
        let series = step(3.0);
        let found = Law::nominal(Channel::Position).predict(&series);
        for (t, mm) in series.time_s.iter().zip(&found).filter(|(t, _)| **t > 0.1) {
            let since = t - 0.1;
            let exact = 3.0 * (1.0 - (q * (-p * since).exp() - p * (-q * since).exp()) / (q - p));
            // the transition is exact and the command changes between two steps: rounding only
            assert!((mm - exact).abs() < 1e-9, "{mm} for {exact} at {t} s");
        }
    }

    #[test]
    fn a_delay_shifts_a_limit_straightens_and_friction_stops_short() {
        let series = step(4.0);
        let base = Law::nominal(Channel::Position).predict(&series);
        let late = with(&delay::EFFECT, 0.06).predict(&series);
        for k in 3..200 {
            // three ticks of 20 ms
            assert!((late[k] - base[k - 3]).abs() < 1e-9);
        }
        let limited = with(&rate_limit::EFFECT, 5.0).predict(&series);
        let fastest = limited.windows(2).map(|w| (w[1] - w[0]) / 0.02).fold(0.0, f64::max);
        assert!((4.99..5.000_001).contains(&fastest), "{fastest}");
        let end = with(&stiction::EFFECT, 0.3).predict(&series)[199];
        // after 3.9 s the slow pole (4.6 1/s) has died out
        assert!((end - 3.7).abs() < 1e-3, "{end}");
        assert!(with(&stiction::EFFECT, 0.3).predict(&step(0.25)).iter().all(|mm| *mm == 0.0));
    }
}
