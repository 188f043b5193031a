//! A relaxing column under a programme of stretch.

use crate::solid::law::PronyTerm;

/// Points of the quadrature over the ramp.
const POINTS: usize = 4000;

/// Axial first Piola-Kirchhoff stress (MPa) of a column whose stretch goes from 1 to `stretch` at a
/// constant rate within `ramp_s` (s) and is held, at the time `time_s > 0`; `elastic` is the
/// instantaneous stress (MPa) over the stretch. Shear and bulk relax alike (`g` is taken) and the
/// sides stay free of stress or motion, so that the second Piola-Kirchhoff stress `S = P / l` obeys
/// `S(t) = S0(t) - sum_i g_i int_0^t (1 - exp(-(t - s) / tau_i)) dS0/ds ds`
/// (Simo 1987, doi:10.1016/0045-7825(87)90107-1). The integral is a Stieltjes sum by the midpoint rule:
/// its error is of second order in the ramp over its 4000 points.
#[must_use]
pub fn relaxing_column_mpa(
    elastic: impl Fn(f64) -> f64,
    series: &[PronyTerm],
    stretch: f64,
    ramp_s: f64,
    time_s: f64,
) -> f64 {
    let at = |t: f64| 1.0 + (stretch - 1.0) * (t / ramp_s).min(1.0);
    let second = |t: f64| elastic(at(t)) / at(t);
    let end = time_s.min(ramp_s);
    let dt = end / POINTS as f64;
    let mut lost = 0.0;
    for i in 0..POINTS {
        let start = dt * i as f64;
        let rise = second(start + dt) - second(start);
        let age = time_s - start - 0.5 * dt;
        lost -= series.iter().map(|e| e.g * (-age / e.tau_s).exp_m1()).sum::<f64>() * rise;
    }
    (second(end) - lost) * at(time_s)
}
