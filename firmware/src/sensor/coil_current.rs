//! Shunt amplifier of the coil.

/// Law of the shunt amplifier.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoilShunt {
    /// Reading without current, fraction of the reference.
    pub zero_ratio: f32,
    /// Sensitivity, A for the full reference voltage.
    pub a_per_ratio: f32,
}

impl Default for CoilShunt {
    /// 50 mOhm with a gain of 20 (1 V/A at 3.3 V), lifted by 5 % of the reference so that zero is not at the rail (assumed).
    fn default() -> Self {
        CoilShunt { zero_ratio: 0.05, a_per_ratio: 3.3 }
    }
}

/// Coil current, A.
pub fn coil_a(ratio: f32, shunt: &CoilShunt) -> f32 {
    (ratio - shunt.zero_ratio) * shunt.a_per_ratio
}

/// Reading for a current; the inverse of [`coil_a`].
pub fn coil_ratio(current_a: f32, shunt: &CoilShunt) -> f32 {
    current_a / shunt.a_per_ratio + shunt.zero_ratio
}
