//! Force over depth and hold time of one condition, from the values of its grid.

use lut_gen::solid::model::{HOLD_NODES, Press, RAMP_NODES, clenshaw_and_slope, clenshaw_and_slope_each};

/// Depths that are computed at once: a recurrence waits for itself, several do not.
const AT_ONCE: usize = 8;

/// Force on a ball or a face that goes down and then may stand.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    depth_max_mm: f64,
    /// Exponent `p` of the force at first touch: 1.5 under a ball, 1 under a face.
    exponent: f64,
    /// Length over which faces come to touch, mm.
    rounding_mm: f64,
    /// Of `ln(F / (mu d^p))` over `s`.
    coefficients: [f64; RAMP_NODES],
    /// ln(mu / MPa).
    ln_mu: f64,
    hold_s: f64,
    /// `ln(F / F_peak)`, with the peak itself first; empty without a hold.
    hold: Vec<f64>,
    /// An error of the force: size in peak forces, and half waves over depth.
    error: (f64, f64),
}

impl Track {
    /// From the values of a [`Press`] for a unit modulus: those of the ramp, then those of the hold. The force begins as
    /// a ball's, see [`Track::beginning_as`].
    #[must_use]
    pub fn new(depth_max_mm: f64, hold_s: f64, values: &[f64], ln_mu: f64) -> Self {
        let (ramp, held) = values.split_at(RAMP_NODES.min(values.len()));
        let mut coefficients = [0.0; RAMP_NODES];
        coefficients.iter_mut().zip(Press::ramp_axis().coefficients(ramp)).for_each(|(to, from)| *to = from);
        let hold =
            if held.is_empty() { Vec::new() } else { std::iter::once(0.0).chain(held.iter().copied()).collect() };
        Self { depth_max_mm, exponent: 1.5, rounding_mm: 0.0, coefficients, ln_mu, hold_s, hold, error: (0.0, 0.0) }
    }

    /// The same for values of `ln(F / d^p)` with another exponent, the touch spread over a length: depths count as
    /// `(d + sqrt(d^2 + w^2)) / 2`.
    ///
    /// A face meets its specimen with a jump of stiffness. As a contact point moves from sample to sample, the jump would put a
    /// kink into the objective at each, at which a search gets caught; spread over their distance there is none.
    #[must_use]
    pub fn beginning_as(mut self, exponent: f64, rounding_mm: f64) -> Self {
        (self.exponent, self.rounding_mm) = (exponent, rounding_mm);
        self
    }

    /// `d^p`; both exponents in use without a power.
    fn power(&self, depth_mm: f64) -> f64 {
        if self.exponent == 1.5 { depth_mm * depth_mm.sqrt() } else { depth_mm.powf(self.exponent) }
    }

    /// The same with an error of the force: `size F_peak x cos(waves pi x)`, `x = d / d_max`. Errors of the simulation are
    /// stated relative to the peak, and vanish at contact, where every curve is Hertz's.
    #[must_use]
    pub fn with_error(mut self, size: f64, waves: f64) -> Self {
        self.error = (size, waves);
        self
    }

    /// Force (N) and its slope (N/mm) at a depth of the ramp; 0 before contact. Past the largest depth the
    /// logarithm goes on straight in `s`.
    #[must_use]
    pub fn ramp(&self, depth_mm: f64) -> (f64, f64) {
        let (sharp_mm, by_depth) = self.rounded(depth_mm);
        let s = self.share(sharp_mm);
        let (force, slope) = self.sharp(sharp_mm, s, clenshaw_and_slope(&self.coefficients, place(s)));
        (force, slope * by_depth)
    }

    /// The same at some depths (mm).
    #[must_use]
    pub fn ramps(&self, depth_mm: &[f64]) -> Vec<(f64, f64)> {
        let mut all = Vec::with_capacity(depth_mm.len());
        for some in depth_mm.chunks(AT_ONCE) {
            let mut rounded = [(0.0, 0.0); AT_ONCE];
            let (mut shares, mut places) = ([0.0; AT_ONCE], [0.0; AT_ONCE]);
            for (i, depth_mm) in some.iter().enumerate() {
                rounded[i] = self.rounded(*depth_mm);
                shares[i] = self.share(rounded[i].0);
                places[i] = place(shares[i]);
            }
            let (values, slopes) = clenshaw_and_slope_each(&self.coefficients, places);
            for (i, (sharp_mm, by_depth)) in rounded.into_iter().take(some.len()).enumerate() {
                let (force, slope) = self.sharp(sharp_mm, shares[i], (values[i], slopes[i]));
                all.push((force, slope * by_depth));
            }
        }
        all
    }

    /// The depth (mm) at which a sharp contact has the force of a rounded one, and its derivative.
    fn rounded(&self, depth_mm: f64) -> (f64, f64) {
        if self.rounding_mm <= 0.0 {
            return (depth_mm, 1.0);
        }
        let round = depth_mm.hypot(self.rounding_mm);
        (0.5 * (depth_mm + round), 0.5 * (1.0 + depth_mm / round))
    }

    /// `s` at a depth, 0 before contact.
    fn share(&self, depth_mm: f64) -> f64 {
        (depth_mm.max(0.0) / self.depth_max_mm).sqrt()
    }

    /// From `s`, and the sum at its place and its slope there.
    fn sharp(&self, depth_mm: f64, s: f64, (mut q, half): (f64, f64)) -> (f64, f64) {
        if depth_mm <= 0.0 {
            return (0.0, 0.0);
        }
        let slope = 2.0 * half;
        q += slope * (s - s.min(1.0));
        let force = (self.ln_mu + q).exp() * self.power(depth_mm);
        (force + self.wrong(s * s), force * (self.exponent + 0.5 * slope * s) / depth_mm)
    }

    fn wrong(&self, x: f64) -> f64 {
        let (size, waves) = self.error;
        if size == 0.0 {
            return 0.0;
        }
        let (q, _) = clenshaw_and_slope(&self.coefficients, 1.0);
        let peak = (self.ln_mu + q).exp() * self.power(self.depth_max_mm);
        size * peak * x * (waves * std::f64::consts::PI * x).cos()
    }

    /// Force (N) at a time (s) since the peak at `peak_mm`, and its slope (N/mm) by that depth. What is left of the
    /// peak's force depends on the time; how it depends on small changes of depth is neglected.
    #[must_use]
    pub fn hold(&self, peak_mm: f64, time_s: f64) -> (f64, f64) {
        let (force, slope) = self.ramp(peak_mm);
        let left = self.left(time_s);
        (force * left, slope * left)
    }

    /// What is left of the peak's force at a time (s) since it, by the cubic through four neighbours on the even grid.
    #[must_use]
    pub fn left(&self, time_s: f64) -> f64 {
        if self.hold.len() < 4 {
            return 1.0;
        }
        let x = Press::hold_place(self.hold_s, time_s).clamp(0.0, HOLD_NODES as f64);
        let first = (x as usize).saturating_sub(1).min(self.hold.len() - 4);
        let t = x - first as f64;
        let p = &self.hold[first..first + 4];
        let (t1, t2, t3) = (t - 1.0, t - 2.0, t - 3.0);
        let ln =
            -p[0] * t1 * t2 * t3 / 6.0 + p[1] * t * t2 * t3 / 2.0 - p[2] * t * t1 * t3 / 2.0 + p[3] * t * t1 * t2 / 6.0;
        ln.exp()
    }
}

/// Where a sum is taken for `s`, within what was solved.
fn place(s: f64) -> f64 {
    2.0 * s.min(1.0) - 1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_press_comes_back_with_its_slopes() {
        let axis = Press::ramp_axis();
        let ramp = |d: f64| 3.0 * d.powf(1.5) / (1.0 + 0.3 * d);
        let mut values: Vec<f64> = (0..RAMP_NODES)
            .map(|k| {
                let d = 4.0 * axis.node(k).powi(2);
                (ramp(d) / d.powf(1.5)).ln()
            })
            .collect();
        values.extend(Press::hold_times(10.0).iter().map(|t| (0.4 + 0.6 * (-t / 2.0).exp()).ln()));
        let track = Track::new(4.0, 10.0, &values, 0.5_f64.ln());
        for d in [0.01, 0.5, 2.2, 3.99] {
            let (force, slope) = track.ramp(d);
            // Twelve Chebyshev terms of this curve leave 1e-6 of it; the quotient has h^2 = 1e-10.
            assert!((force / (0.5 * ramp(d)) - 1.0).abs() < 1e-6, "{d} {force}");
            let quotient = (track.ramp(d + 1e-5).0 - track.ramp(d - 1e-5).0) / 2e-5;
            assert!((slope / quotient - 1.0).abs() < 1e-6, "{d} {slope} {quotient}");
        }
        for t in [0.0, 0.05, 1.0, 3.0, 9.9] {
            let exact = 0.5 * ramp(4.0) * (0.4 + 0.6 * (-t / 2.0_f64).exp());
            // Four points an e-fold of time: the cubic between them is within 1e-3 where the decay is steepest.
            assert!((track.hold(4.0, t).0 / exact - 1.0).abs() < 1e-3, "{t}");
        }
        assert_eq!(track.ramp(-0.1), (0.0, 0.0));
        // More than are computed at once, and some left over.
        let depths: Vec<f64> = (-1..18).map(|k| 0.25 * f64::from(k)).collect();
        for (d, both) in depths.iter().zip(track.ramps(&depths)) {
            assert_eq!(both, track.ramp(*d), "{d}");
        }
        let round = track.beginning_as(1.5, 0.05);
        for d in [-0.1, 0.0, 0.03, 1.0] {
            let quotient = (round.ramp(d + 1e-5).0 - round.ramp(d - 1e-5).0) / 2e-5;
            assert!((round.ramp(d).1 / quotient - 1.0).abs() < 1e-5, "{d}");
        }
        // Deep inside the depth is 0.05^2 / (4 d) more.
        assert!((round.ramp(2.0).0 / (0.5 * ramp(2.0)) - 1.0).abs() < 1e-3);
    }
}
