//! Hertz's contact of a relaxing material under a ramp.

/// Dawson's integral `exp(-x^2) int_0^x exp(t^2) dt` for `x >= 0` by Rybicki's sum
/// (1989, Computers in Physics 3, 85) with spacing 0.2: its error `exp(-(pi/0.4)^2)` is below rounding.
fn dawson(x: f64) -> f64 {
    const H: f64 = 0.2;
    if x < 0.2 {
        // 2^n x^(2n+1) (-1)^n / (2n+1)!!, the neglected term below 1e-17
        let square = x * x;
        let (mut term, mut sum) = (x, x);
        for n in 1..12 {
            term *= -2.0 * square / (2 * n + 1) as f64;
            sum += term;
        }
        return sum;
    }
    let even = 2.0 * (0.5 * x / H).round();
    let rest = x - even * H;
    let mut sum = 0.0;
    for i in -16..16 {
        let odd = f64::from(2 * i + 1);
        sum += (-(rest - odd * H).powi(2)).exp() / (odd + even);
    }
    sum / std::f64::consts::PI.sqrt()
}

/// Part of a Hertz force `F ~ t^(3/2)` that an element whose relaxation time is `t / x` has not
/// lost at time `t`: `D(x) = 3/2 int_0^1 exp(-x (1 - y)) sqrt(y) dy = 3/(2x) (1 - dawson(sqrt x) / sqrt x)`,
/// and its derivative.
fn kept(x: f64) -> (f64, f64) {
    if x < 0.5 {
        // sum (-2 x)^n / (5 7 .. (2n+3)): the closed form loses digits here; 20 terms are exact
        let (mut term, mut value, mut slope) = (1.0, 1.0, -0.4);
        for n in 1..20 {
            term *= -2.0 * x / (2 * n + 3) as f64;
            value += term;
            if n > 1 {
                slope += n as f64 * term / x;
            }
        }
        return (value, slope);
    }
    let value = 1.5 / x * (1.0 - dawson(x.sqrt()) / x.sqrt());
    // from D' = int -(1-y) ...: x D' = 3/2 - (x + 3/2) D
    (value, (1.5 - (x + 1.5) * value) / x)
}

/// Relaxation of a ramp: what is left of the elastic Hertz force.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RampRelaxation {
    /// Of each element: relaxing part `g` and the depth `V tau` (mm) the ball goes in its relaxation time.
    pub elements: Vec<(f64, f64)>,
}

impl RampRelaxation {
    /// Factor on the elastic Hertz force at a depth (mm) of the ramp, and its slope (1/mm).
    #[must_use]
    pub fn factor(&self, depth_mm: f64) -> (f64, f64) {
        self.elements.iter().fold((1.0, 0.0), |(value, slope), &(g, length)| {
            let (d, dd) = kept(depth_mm / length);
            (value - g * (1.0 - d), slope + g * dd / length)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the integral by the midpoint rule, its error 1e-7 for this many points.
    #[test]
    fn the_closed_form_is_the_integral() {
        for x in [1e-4, 0.03, 0.499, 0.501, 3.0, 40.0, 900.0] {
            let n = 400_000;
            let integral = (0..n)
                .map(|i| {
                    let w = (f64::from(i) + 0.5) / f64::from(n);
                    3.0 * w * w * (-x * (1.0 - w * w)).exp() / f64::from(n)
                })
                .sum::<f64>();
            assert!((kept(x).0 / integral - 1.0).abs() < 1e-6, "x = {x}: {} {integral}", kept(x).0);
            let h = 1e-4 * x;
            let slope = (kept(x + h).0 - kept(x - h).0) / (2.0 * h);
            assert!((kept(x).1 - slope).abs() < 1e-6 + 1e-6 * slope.abs(), "x = {x}: {} {slope}", kept(x).1);
        }
    }
}
