//! Something that follows with play.

/// Play of a half width that may change: the follower stays until it is pushed.
#[must_use]
pub fn play(values: &[f64], half_width: impl Fn(f64) -> f64) -> Vec<f64> {
    let mut follower = values.first().copied().unwrap_or(0.0);
    values
        .iter()
        .map(|value| {
            let half = half_width(*value).max(0.0);
            // bounds that are no number hold nothing back
            follower = follower.max(value - half).min(value + half);
            follower
        })
        .collect()
}
