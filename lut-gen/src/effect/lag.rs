//! A ball that lags behind what is recorded.

use super::{Effect, FormError, Kind, Owner, Quantity, Share, Stage};

/// The ball follows the recorded depth through a first-order filter.
pub const FILTER: Effect = Effect {
    code: "lag",
    form: "filter",
    stage: Stage::Machine,
    kind: Kind::Machine,
    assumption: "depth and force are recorded at the same instant",
    signature: "jumps where the motion starts and stops",
    twins: &["contact-offset", "relaxation"],
    separated_by: "a reversal; another rate",
    prior: "two channels that are read one after the other at 50 to 100 Hz are apart by up to a sample, 0.01 s",
    quantities: &[Quantity::amplitude("lag_s", 0.0, (0.0, 1.0), 0.03, &[0.01]).about(0.01)],
    owner: Owner::All,
    form_error: FormError::of(Share::Outside, Share::Elastic),
};

/// The ball cannot move faster than a limit; the parameter is its reciprocal.
pub const RATE_LIMIT: Effect = Effect {
    code: "lag",
    form: "rate-limit",
    stage: Stage::Machine,
    kind: Kind::Machine,
    assumption: "the ball is where it was told to be",
    signature: "jumps where the motion starts and stops",
    twins: &["contact-offset", "relaxation"],
    separated_by: "a reversal; another rate",
    prior: "drives keep a commanded rate to about 2 % (laboratory judgement)",
    quantities: &[Quantity::amplitude("limit_s_per_mm", 0.0, (0.0, 40.0), 1.6, &[1.2, 4.8])
        .beyond(1.0)
        .about(0.02)
        .per_rate()],
    owner: Owner::All,
    form_error: FormError::of(Share::Outside, Share::Elastic),
};

/// Depth of the ball behind a filter, exact where the recorded depth moves straight.
#[must_use]
pub fn filtered(time_s: &[f64], recorded_mm: &[f64], lag_s: f64) -> Vec<f64> {
    let mut out = recorded_mm.to_vec();
    if lag_s <= 0.0 {
        return out;
    }
    let mut behind = 0.0;
    for i in 1..out.len() {
        let dt = time_s[i] - time_s[i - 1];
        if dt <= 0.0 {
            out[i] = recorded_mm[i] - behind;
            continue;
        }
        let kept = (-dt / lag_s).exp();
        let rate = (recorded_mm[i] - recorded_mm[i - 1]) / dt;
        behind = behind * kept + rate * lag_s * (1.0 - kept);
        out[i] = recorded_mm[i] - behind;
    }
    out
}

/// Depth of a ball that cannot move faster than `1 / limit_s_per_mm`.
#[must_use]
pub fn limited(time_s: &[f64], recorded_mm: &[f64], limit_s_per_mm: f64) -> Vec<f64> {
    let mut out = recorded_mm.to_vec();
    if limit_s_per_mm <= 0.0 {
        return out;
    }
    for i in 1..out.len() {
        let reach = (time_s[i] - time_s[i - 1]).max(0.0) / limit_s_per_mm;
        // a depth that is no number gives way to the nearest that is in reach
        out[i] = recorded_mm[i].max(out[i - 1] - reach).min(out[i - 1] + reach);
    }
    out
}
