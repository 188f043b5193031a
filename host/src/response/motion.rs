//! Motion of an actuator under a held command, exact between the events that change its law.
//!
//! Between two changes of the command the law is linear as long as the shaft slides in one direction, rests, or is at its rate limit.
//! Each of these pieces has a closed form, and the moments between them are roots of it. So the motion depends smoothly on its
//! parameters, and no step size enters.

use super::law::{Law, Structure};

/// A piece of time is no longer than this share of the fastest time constant, so that no event hides inside it.
const SHARE: f64 = 0.5;
/// Most parts that a piece of time is cut into.
const MOST_PARTS: f64 = 64.0;
/// Most events inside a part of a piece.
const MOST_EVENTS: usize = 40;
/// Durations are one that differ by no more than the stamps of an even recording are rounded by, s.
const ROUNDED_S: f64 = 1e-13;
/// Relative distance of two poles below which the resonant drive is moved off: the closed form divides by it.
const APART: f64 = 1e-5;

/// Positions at the stamps `time_s` (rising) under the command that holds from each stamp to the next; before the first one its own
/// command holds.
#[must_use]
pub fn follow(law: &Law, time_s: &[f64], command_v: &[f64]) -> Vec<f64> {
    let mut out = Vec::with_capacity(time_s.len());
    let (Some(&first_s), Some(&first_v)) = (time_s.first(), command_v.first()) else { return out };
    let mut shaft = Shaft::new(law, first_v);
    let (mut now_s, mut next) = (first_s, 0);
    let mut held_v = first_v;
    for stamp in time_s {
        // Commands that arrive before this stamp.
        while next < time_s.len() && time_s[next] + law.delay_s < *stamp {
            let at_s = time_s[next] + law.delay_s;
            if at_s > now_s {
                shaft.advance(held_v, at_s - now_s);
                now_s = at_s;
            }
            held_v = command_v[next];
            next += 1;
        }
        if *stamp > now_s {
            shaft.advance(held_v, stamp - now_s);
            now_s = *stamp;
        }
        out.push(shaft.reading_mm);
    }
    out
}

/// Linear part while sliding: `v' = -a1 v - a0 x + g w + c`, or without a mass `v = -a0 x + g w + c`; `w` is the drive.
#[derive(Debug, Clone, Copy)]
struct Linear {
    has_mass: bool,
    a1: f64,
    a0: f64,
    g: f64,
    c: f64,
    /// One over the time constant of the drive; infinite where it follows at once.
    rate: f64,
}

impl Linear {
    fn of(law: &Law) -> Self {
        let (k, w) = (law.gain, law.frequency_rad_s);
        let none = f64::INFINITY;
        match law.structure {
            Structure::Spindle => Self { has_mass: false, a1: 1.0, a0: 0.0, g: k, c: -k * law.offset, rate: none },
            Structure::Lag => Self { has_mass: false, a1: 1.0, a0: w, g: k * w, c: w * law.offset, rate: none },
            Structure::SpindleLag => {
                Self { has_mass: true, a1: w, a0: 0.0, g: k * w, c: -k * w * law.offset, rate: none }
            }
            Structure::Mass | Structure::MassLag => {
                let a1 = 2.0 * law.damping * w;
                let rate =
                    if law.structure == Structure::Mass { none } else { off_resonance(1.0 / law.lag_s, a1, w * w) };
                Self { has_mass: true, a1, a0: w * w, g: k * w * w, c: w * w * law.offset, rate }
            }
        }
    }

    /// Longest part of a piece of time, s.
    fn part_s(&self) -> f64 {
        let fastest = if self.has_mass { self.a1.max(self.a0.sqrt()) } else { self.a0 };
        SHARE / fastest.max(1e-9)
    }
}

/// A rate that is no pole of the mechanism.
fn off_resonance(rate: f64, a1: f64, a0: f64) -> f64 {
    let from_poles = |rate: f64| (rate * rate - a1 * rate + a0).abs() / (rate * rate + a0);
    if from_poles(rate) < APART { rate * (1.0 + APART.sqrt()) } else { rate }
}

/// Matrix exponential of the mechanism over a time: `e12` = response of x to v, `e22` of v to v, `sum` = integral of `e12`.
#[derive(Debug, Clone, Copy)]
struct Transition {
    over_s: f64,
    e11: f64,
    e12: f64,
    e22: f64,
    sum: f64,
    /// What is left of the difference between drive and command.
    left: f64,
}

impl Transition {
    fn over(linear: &Linear, over_s: f64) -> Self {
        let left = if linear.rate.is_finite() { (-linear.rate * over_s).exp() } else { 0.0 };
        let (a1, a0) = (linear.a1, linear.a0);
        if a0 == 0.0 {
            let e22 = (-a1 * over_s).exp();
            let e12 = -(-a1 * over_s).exp_m1() / a1;
            return Self { over_s, e11: 1.0, e12, e22, sum: (over_s - e12) / a1, left };
        }
        let half = 0.5 * a1;
        let discriminant = half * half - a0;
        let (c, s) = if discriminant.abs() * over_s * over_s < 1e-8 {
            // Both series to second order: the rest is below 1e-17.
            let z = discriminant * over_s * over_s;
            (1.0 + 0.5 * z, over_s * (1.0 + z / 6.0))
        } else if discriminant > 0.0 {
            let root = discriminant.sqrt();
            ((root * over_s).cosh(), (root * over_s).sinh() / root)
        } else {
            let root = (-discriminant).sqrt();
            ((root * over_s).cos(), (root * over_s).sin() / root)
        };
        let fall = (-half * over_s).exp();
        let (e11, e12, e22) = (fall * (c + half * s), fall * s, fall * (c - half * s));
        Self { over_s, e11, e12, e22, sum: (1.0 - e22 - a1 * e12) / a0, left }
    }
}

/// Shaft, its speed, its drive and its reading.
#[derive(Debug, Clone)]
struct Shaft {
    linear: Linear,
    limit: f64,
    friction_v: f64,
    half_play: f64,
    x: f64,
    v: f64,
    /// The drive, V.
    w: f64,
    reading_mm: f64,
    /// Transitions that were used last: recordings are sampled evenly.
    known: [Option<Transition>; 2],
    turn: usize,
}

impl Shaft {
    fn new(law: &Law, command_v: f64) -> Self {
        Self {
            linear: Linear::of(law),
            limit: law.rate_mm_s,
            friction_v: law.friction_v,
            half_play: 0.5 * law.play_mm,
            x: law.start_mm + law.start_share * law.play_mm,
            v: 0.0,
            w: command_v,
            reading_mm: law.start_mm,
            known: [None; 2],
            turn: 0,
        }
    }

    fn advance(&mut self, command_v: f64, over_s: f64) {
        let parts = (over_s / self.linear.part_s()).ceil().clamp(1.0, MOST_PARTS);
        for _ in 0..parts as usize {
            let mut left_s = over_s / parts;
            for _ in 0..MOST_EVENTS {
                left_s -= self.piece(command_v, left_s);
                // Both ends of the play move with the shaft, which goes one way within a piece.
                self.reading_mm = self.reading_mm.max(self.x - self.half_play).min(self.x + self.half_play);
                if left_s <= 0.0 {
                    break;
                }
            }
        }
    }

    fn piece(&mut self, command_v: f64, left_s: f64) -> f64 {
        if !self.linear.rate.is_finite() {
            self.w = command_v;
        }
        if !self.linear.has_mass {
            return self.massless(left_s);
        }
        if self.v != 0.0 {
            return self.slide(self.v.signum(), command_v, left_s);
        }
        let pull = self.pull(self.w);
        let held = self.linear.g * self.friction_v;
        if pull.abs() > held {
            return self.slide(pull.signum(), command_v, left_s);
        }
        self.rest(command_v, held, left_s)
    }

    /// Acceleration of a resting shaft without friction.
    fn pull(&self, w: f64) -> f64 {
        self.linear.g * w + self.linear.c - self.linear.a0 * self.x
    }

    /// Rests until the drive exceeds the friction.
    fn rest(&mut self, command_v: f64, held: f64, left_s: f64) -> f64 {
        if !self.linear.rate.is_finite() {
            return left_s;
        }
        let end = self.pull(command_v);
        let begin = self.pull(self.w);
        // The pull goes from `begin` to `end` exponentially; it leaves the band on the side of `end`.
        let edge = held * end.signum();
        let ratio = (end - edge) / (end - begin);
        let mut over_s = left_s;
        if end.abs() > held && ratio > 0.0 && ratio < 1.0 {
            // A hair later, so that the shaft is out of the band for sure.
            over_s = over_s.min(-ratio.ln() / self.linear.rate + 1e-9);
        }
        self.w = command_v + (self.w - command_v) * (-self.linear.rate * over_s).exp();
        over_s
    }

    fn massless(&mut self, left_s: f64) -> f64 {
        let Linear { a0, g, c, .. } = self.linear;
        let pull = self.pull(self.w);
        let held = g * self.friction_v;
        if pull.abs() <= held {
            return left_s;
        }
        let s = pull.signum();
        let speed = pull.abs() - held;
        if speed > self.limit {
            let until_s = if a0 > 0.0 { (speed - self.limit) / (a0 * self.limit) } else { left_s };
            let over_s = until_s.min(left_s);
            self.x += s * self.limit * over_s;
            return over_s;
        }
        if a0 == 0.0 {
            self.x += s * speed * left_s;
        } else {
            let end = (g * (self.w - self.friction_v * s) + c) / a0;
            self.x = end + (self.x - end) * (-a0 * left_s).exp();
        }
        left_s
    }

    /// Slides in the direction `s`, up to the end of the time, a stop, or the rate limit.
    fn slide(&mut self, s: f64, command_v: f64, left_s: f64) -> f64 {
        if self.v * s >= self.limit {
            return self.limited(s, command_v, left_s);
        }
        let whole = self.transition(left_s);
        let (x, v) = self.state(s, command_v, &whole);
        let stop = s * v <= 0.0;
        if !stop && s * v <= self.limit {
            (self.x, self.v) = (x, v);
            self.w = command_v + (self.w - command_v) * whole.left;
            return left_s;
        }
        let level = if stop { 0.0 } else { s * self.limit };
        let over_s = self.crossing(s, command_v, level, left_s);
        let part = Transition::over(&self.linear, over_s);
        (self.x, _) = self.state(s, command_v, &part);
        self.v = level;
        self.w = command_v + (self.w - command_v) * part.left;
        over_s
    }

    fn limited(&mut self, s: f64, command_v: f64, left_s: f64) -> f64 {
        let Linear { a1, a0, g, c, rate, .. } = self.linear;
        self.v = s * self.limit;
        // Acceleration along the motion if nothing limited it.
        let (x0, w0, limit) = (self.x, self.w, self.limit);
        let surplus = |t: f64| {
            let w = if rate.is_finite() { command_v + (w0 - command_v) * (-rate * t).exp() } else { command_v };
            s * (g * (w - self.friction_v * s) + c - a0 * (x0 + s * limit * t)) - a1 * limit
        };
        let mut over_s = left_s;
        if surplus(0.0) <= 0.0 {
            over_s = 0.0;
        } else if surplus(left_s) < 0.0 {
            let (mut low, mut high) = (0.0, left_s);
            if rate.is_finite() {
                for _ in 0..60 {
                    let middle = 0.5 * (low + high);
                    if surplus(middle) > 0.0 { low = middle } else { high = middle }
                }
                over_s = low;
            } else {
                over_s = surplus(0.0) / (a0 * limit);
            }
        }
        self.x += s * limit * over_s;
        if rate.is_finite() {
            self.w = command_v + (self.w - command_v) * (-rate * over_s).exp();
        }
        if over_s < left_s {
            // Below the limit from here on.
            self.v = s * limit * (1.0 - 1e-12);
        }
        over_s
    }

    /// Place and speed after a transition while sliding.
    fn state(&self, s: f64, command_v: f64, t: &Transition) -> (f64, f64) {
        let Linear { a1, a0, g, c, rate, .. } = self.linear;
        let steady = g * (command_v - self.friction_v * s) + c;
        let (mut x0, mut v0, mut xp, mut vp) = (self.x, self.v, 0.0, 0.0);
        if rate.is_finite() {
            let part = g * (self.w - command_v) / (rate * rate - a1 * rate + a0);
            x0 -= part;
            v0 += rate * part;
            xp = part * t.left;
            vp = -rate * xp;
        }
        let x = t.e11 * x0 + t.e12 * v0 + steady * t.sum + xp;
        let v = -a0 * t.e12 * x0 + t.e22 * v0 + steady * t.e12 + vp;
        (x, v)
    }

    /// When the speed passes a level on its way to the end of the time: Newton's method inside a bracket.
    fn crossing(&self, s: f64, command_v: f64, level: f64, left_s: f64) -> f64 {
        let Linear { a1, a0, g, c, .. } = self.linear;
        // Before the crossing the speed is on this side of the level.
        let before = if level == 0.0 { s } else { -s };
        let (mut low, mut high) = (0.0, left_s);
        let mut at = 0.5 * left_s;
        for _ in 0..80 {
            let part = Transition::over(&self.linear, at);
            let (x, v) = self.state(s, command_v, &part);
            let off = v - level;
            if off * before > 0.0 {
                low = at
            } else {
                high = at
            }
            let w = command_v + (self.w - command_v) * part.left;
            let acceleration = g * (w - self.friction_v * s) + c - a0 * x - a1 * v;
            let newton = at - off / acceleration;
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            if (next - at).abs() <= 1e-14 * left_s || high - low <= 1e-15 * left_s {
                return next;
            }
            at = next;
        }
        at
    }

    fn transition(&mut self, over_s: f64) -> Transition {
        let same = |t: &&Transition| (t.over_s - over_s).abs() <= ROUNDED_S;
        if let Some(known) = self.known.iter().flatten().find(same) {
            return *known;
        }
        let new = Transition::over(&self.linear, over_s);
        self.known[self.turn] = Some(new);
        self.turn = 1 - self.turn;
        new
    }
}
