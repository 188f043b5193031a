//! What follows something late: shared by effects with a time of their own.

/// Values that follow others, which are straight between samples, as a first-order lag with a time (s); they begin together.
#[must_use]
pub fn followed(time_s: &[f64], values: &[f64], tau_s: f64) -> Vec<f64> {
    if tau_s <= 0.0 {
        return values.to_vec();
    }
    let mut late = values.first().copied().unwrap_or(0.0);
    let mut out = Vec::with_capacity(values.len());
    for (k, now) in values.iter().enumerate() {
        if k > 0 {
            let x = (time_s[k] - time_s[k - 1]) / tau_s;
            // first-order lag of a ramp, exact
            let kept = (-x).exp();
            let mean = if x > 1e-9 { (1.0 - kept) / x } else { 1.0 };
            late = late * kept + now * (1.0 - mean) + values[k - 1] * (mean - kept);
        }
        out.push(late);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_is_followed_by_its_time() {
        let time_s: Vec<f64> = (0..200).map(|k| 0.02 * f64::from(k)).collect();
        let late = followed(&time_s, &time_s, 0.3);
        for (t, late) in time_s.iter().zip(&late) {
            // t - tau (1 - exp(-t / tau)), to rounding
            assert!((late - (t - 0.3 * (1.0 - (-t / 0.3).exp()))).abs() < 1e-12);
        }
    }
}
