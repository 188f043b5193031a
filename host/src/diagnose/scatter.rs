//! What readings of one condition scatter by: noise of the sensor, jitter between spots, and what these act on.

use nalgebra::DMatrix;

/// Noise of one sample of the force: a part that is correlated in time and a white one, both with a part that grows with the force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SensorNoise {
    /// Standard deviation of a sample at force 0, N.
    pub sigma_n: f64,
    /// Share of its variance that is white.
    pub white: f64,
    /// Correlation time of the rest, s.
    pub correlation_s: f64,
    /// Added in quadrature: this times the force.
    pub relative: f64,
}

/// Scatter between spots and runs, as standard deviations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jitter {
    /// Contact point of a spot, mm.
    pub contact_mm: f64,
    /// Gain of a spot, relative.
    pub gain: f64,
    /// Zero of a run, N.
    pub zero_n: f64,
}

/// Prediction of one run, with its slope, at its nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// N.
    pub force_n: Vec<f64>,
    /// N/mm.
    pub slope_n_per_mm: Vec<f64>,
}

impl Curve {
    /// What repeats of a run differ by besides sensor noise, a column each: a shifted contact (a millimetre), a gain of some force (N) at the nodes, a zero (a newton). Where the
    /// size of a gain matters, that force is [`Design::smooth_n`].
    pub(in crate::diagnose) fn shapes(&self, gain_n: &[f64]) -> DMatrix<f64> {
        DMatrix::from_fn(self.force_n.len(), 3, |k, j| match j {
            0 => -self.slope_n_per_mm[k],
            1 => gain_n[k],
            _ => 1.0,
        })
    }
}
