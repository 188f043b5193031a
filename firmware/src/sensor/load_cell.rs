//! Load cell of the palpation probe: a bridge with amplifier.

use protocol::message::LoadCell;

/// Force, N: `(ratio - zero_ratio) n_per_ratio`.
pub fn load_cell_n(ratio: f32, law: &LoadCell) -> f32 {
    (ratio - law.zero_ratio) * law.n_per_ratio
}

/// Reading for a force; the inverse of [`load_cell_n`].
pub fn load_cell_ratio(force_n: f32, law: &LoadCell) -> f32 {
    force_n / law.n_per_ratio + law.zero_ratio
}

/// The law with `ratio` as its new zero.
pub fn tared(law: &LoadCell, ratio: f32) -> LoadCell {
    LoadCell { zero_ratio: ratio, n_per_ratio: law.n_per_ratio }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tare_makes_the_present_reading_zero_and_keeps_the_sensitivity() {
        let law = LoadCell { zero_ratio: 0.1, n_per_ratio: 10.0 };
        let law = tared(&law, 0.13);
        assert_eq!(load_cell_n(0.13, &law), 0.0);
        // 0.2 of the reference at 10 N a reference; f32 rounding of the ratios.
        assert!((load_cell_n(0.33, &law) - 2.0).abs() < 1e-6);
    }
}
