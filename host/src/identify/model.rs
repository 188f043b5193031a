//! What identification asks of a forward model: force curves of a unit shear modulus.

/// Where a force curve comes from: everything but mu, which is linear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shape {
    /// Exponent of the one-term Hyperfoam (thesis Eq. 1).
    pub alpha: f64,
    /// Height of the specimen, mm.
    pub height_mm: f64,
}

/// Force over depth for mu = 1 MPa, on equal steps of depth from contact.
#[derive(Debug, Clone, PartialEq)]
pub struct UnitCurve {
    step_mm: f64,
    force_per_mu_mm2: Vec<f64>,
}

impl UnitCurve {
    /// A curve from its values (N/MPa = mm^2) at depths 0, `step_mm`, 2 `step_mm`...; at least
    /// four values are needed, missing ones are taken as zero.
    pub fn new(step_mm: f64, mut force_per_mu_mm2: Vec<f64>) -> Self {
        if force_per_mu_mm2.len() < 4 {
            force_per_mu_mm2.resize(4, 0.0);
        }
        Self { step_mm, force_per_mu_mm2 }
    }

    /// Samples a function of depth on `count` steps up to `depth_mm`.
    pub fn sampled(depth_mm: f64, count: usize, force: impl Fn(f64) -> f64) -> Self {
        let step_mm = depth_mm / count as f64;
        Self::new(step_mm, (0..=count).map(|i| force(i as f64 * step_mm)).collect())
    }

    /// Force per mu at a depth below the contact point: zero before contact, cubic between the
    /// samples, straight on past the last.
    pub fn at(&self, depth_mm: f64) -> f64 {
        if depth_mm <= 0.0 {
            return 0.0;
        }
        let force = &self.force_per_mu_mm2;
        let last = force.len() - 1;
        let x = depth_mm / self.step_mm;
        if x >= last as f64 {
            return force[last] + (force[last] - force[last - 1]) * (x - last as f64);
        }
        // Four neighbours; the stencil slides inward at both ends.
        let first = (x as usize).saturating_sub(1).min(last - 3);
        let t = x - first as f64;
        let [a, b, c, d] = [force[first], force[first + 1], force[first + 2], force[first + 3]];
        let (t1, t2, t3) = (t - 1.0, t - 2.0, t - 3.0);
        -a * t1 * t2 * t3 / 6.0 + b * t * t2 * t3 / 2.0 - c * t * t1 * t3 / 2.0 + d * t * t1 * t2 / 6.0
    }

    /// Deepest sample, mm.
    pub fn depth_mm(&self) -> f64 {
        self.step_mm * (self.force_per_mu_mm2.len() - 1) as f64
    }
}

/// A model of indentation for every pairing of specimen and ball in an experiment.
pub trait ForwardModel: Sync {
    /// Force curve of a pairing; `shape` lies inside the bounds.
    fn curve(&self, pairing: usize, shape: Shape) -> UnitCurve;
    /// Range of alpha.
    fn alpha_bounds(&self) -> (f64, f64);
    /// Bound of the relative force error (discretisation and interpolation).
    fn relative_error(&self) -> f64;
    /// Finite element solves spent so far.
    fn solves(&self) -> usize;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn between_samples_a_cubic_is_exact_and_hertz_is_near() {
        let cubic = UnitCurve::sampled(2.0, 10, |d| 1.0 + d - 0.5 * d * d + 0.3 * d.powi(3));
        let hertz = UnitCurve::sampled(2.0, 200, |d| d.powf(1.5));
        for i in 1..200 {
            let d = i as f64 * 0.00997;
            let exact = 1.0 + d - 0.5 * d * d + 0.3 * d.powi(3);
            assert!((cubic.at(d) - exact).abs() < 1e-12);
            // The root at contact costs 0.1 of a sample's force h^1.5 = 1e-3.
            assert!((hertz.at(d) - d.powf(1.5)).abs() < 1e-4, "{d}");
        }
        assert_eq!(hertz.at(-0.1), 0.0);
        assert!(hertz.at(2.1) > hertz.at(2.0));
    }
}
