//! Position transducer of the palpation probe.

use protocol::message::ProbePosition;

/// Height of the ball's lowest point above the base plate, mm: `(ratio - zero_ratio) mm_per_ratio`.
pub fn probe_mm(ratio: f32, law: &ProbePosition) -> f32 {
    (ratio - law.zero_ratio) * law.mm_per_ratio
}

/// Reading for a height; the inverse of [`probe_mm`].
pub fn probe_ratio(probe_mm: f32, law: &ProbePosition) -> f32 {
    probe_mm / law.mm_per_ratio + law.zero_ratio
}
