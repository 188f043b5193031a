//! What a share of values exceeds.

/// What a share `level` of some values exceeds; nothing does where there are none.
pub(in crate::diagnose) fn exceeded(mut values: Vec<f64>, level: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let at = ((1.0 - level) * values.len() as f64).floor() as usize;
    values.get(at.min(values.len().saturating_sub(1))).copied().unwrap_or(f64::INFINITY)
}
