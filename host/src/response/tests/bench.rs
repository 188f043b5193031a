//! An actuator as nature has it, stepped in tiny steps. It shares no code with what identifies it.

use rand::{Rng, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

/// Step of nature, s.
const TINY_S: f64 = 4e-6;

/// What nature knows.
#[derive(Debug, Clone, Copy)]
pub struct Truth {
    pub gain: f64,
    pub rest_mm: f64,
    pub omega: f64,
    pub zeta: f64,
    pub dead_s: f64,
    pub top_mm_s: f64,
    pub coulomb_v: f64,
    pub gap_mm: f64,
    pub sd_mm: f64,
    pub count_mm: f64,
}

impl Truth {
    pub fn drawn(seed: u64) -> Self {
        let mut r = Pcg64Mcg::seed_from_u64(seed);
        let gain = r.random_range(0.5..3.0);
        Self {
            gain,
            rest_mm: r.random_range(2.0..8.0),
            omega: r.random_range(6.0f64.ln()..30.0f64.ln()).exp(),
            zeta: r.random_range(0.4..1.6),
            dead_s: r.random_range(0.005..0.05),
            top_mm_s: gain * r.random_range(3.0..15.0),
            coulomb_v: r.random_range(0.01..0.1),
            gap_mm: r.random_range(0.02..0.25),
            sd_mm: r.random_range(0.004..0.03),
            count_mm: r.random_range(0.004..0.02),
        }
    }

    /// Stamps, command and reading.
    pub fn record(&self, command: &dyn Fn(f64) -> f64, end_s: f64, hz: f64, seed: u64) -> [Vec<f64>; 3] {
        let mut r = Pcg64Mcg::seed_from_u64(seed ^ 0xabcd);
        let mut normal = || -> f64 { StandardNormal.sample(&mut r) };
        let count = (end_s * hz) as usize;
        let time: Vec<f64> = (0..count).map(|k| k as f64 / hz).collect();
        let asked: Vec<f64> = time.iter().map(|t| command(*t)).collect();
        let per = (1.0 / hz / TINY_S).round() as usize;
        let late = self.dead_s;
        let (mut x, mut v) = (self.rest_mm + self.gain * asked[0], 0.0_f64);
        let mut seen = x;
        let mut out = Vec::new();
        for from_s in &time {
            let y = seen + self.sd_mm * normal();
            out.push((y / self.count_mm).round() * self.count_mm);
            for i in 0..per {
                let t = from_s + (i as f64 + 0.5) * TINY_S - late;
                let at = (t * hz).floor();
                let u = if at < 0.0 { asked[0] } else { asked[at as usize] };
                let w2 = self.omega * self.omega;
                let force = |x: f64, v: f64| w2 * (self.gain * u + self.rest_mm - x) - 2.0 * self.zeta * self.omega * v;
                let dry = w2 * self.gain * self.coulomb_v;
                if v == 0.0 {
                    let f = force(x, 0.0);
                    if f.abs() > dry {
                        v = (f - dry * f.signum()) * TINY_S;
                        x += 0.5 * v * TINY_S;
                    }
                } else {
                    let s = v.signum();
                    let (xm, vm) = (x + 0.5 * TINY_S * v, v + 0.5 * TINY_S * (force(x, v) - dry * s));
                    let mut next = v + TINY_S * (force(xm, vm) - dry * s);
                    if next * s < 0.0 {
                        next = 0.0;
                    }
                    next = next.clamp(-self.top_mm_s, self.top_mm_s);
                    x += 0.5 * TINY_S * (v + next);
                    v = next;
                }
                if x - seen > 0.5 * self.gap_mm {
                    seen = x - 0.5 * self.gap_mm;
                } else if seen - x > 0.5 * self.gap_mm {
                    seen = x + 0.5 * self.gap_mm;
                }
            }
        }
        [time, asked, out]
    }
}

/// Steps of several heights and both directions, a slow triangle and a sweep, V.
pub fn excitation(t: f64) -> f64 {
    const STEPS: [f64; 12] = [0.0, 1.0, 0.0, 4.0, 0.5, 3.0, 2.5, 2.9, 2.4, 0.2, 5.0, 2.5];
    if t < 18.0 {
        return STEPS[(t / 1.5) as usize];
    }
    let t = t - 18.0;
    if t < 10.0 {
        // two triangles of 5 s between 1.5 and 3.5 V
        let phase = (t / 5.0).fract();
        return 2.5
            + if phase < 0.25 {
                4.0 * phase
            } else if phase < 0.75 {
                2.0 - 4.0 * phase
            } else {
                4.0 * phase - 4.0
            };
    }
    let t = t - 10.0;
    // 0.2 to 4 Hz in 12 s
    2.5 + 1.5 * (std::f64::consts::TAU * (0.2 * t + 0.5 * (4.0 - 0.2) / 12.0 * t * t)).sin()
}

pub const EXCITED_S: f64 = 40.0;
