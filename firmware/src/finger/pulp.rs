//! Compression of a finger's pulp on a rigid plate: what of its travel is its own.

use crate::number::limit;

/// Step of the compressions of [`FORCES_N`], mm.
const STEP_MM: f32 = 0.2;

/// Forces, N, at compressions of even steps: the round finger on a rigid plate by finite elements, the same finger
/// as that of the control curves (`host/plants/pulp.csv`). Straight lines between them are within 0.01 mm.
const FORCES_N: [f32; 17] = [
    0.0, 0.029_71, 0.079_82, 0.150_87, 0.243_87, 0.362_23, 0.507_24, 0.684_22, 0.896_46, 1.149_22, 1.448_1, 1.800_69,
    2.216_28, 2.706_19, 3.284_05, 3.966_01, 4.770_25,
];

/// Compression under a force, mm: 0 for none and for NaN, that of the last force beyond it.
pub fn compression_mm(force_n: f32) -> f32 {
    let last = FORCES_N.len() - 1;
    let force_n = limit(force_n, 0.0, FORCES_N[last]);
    let mut below = 0;
    while below + 1 < last && FORCES_N[below + 1] < force_n {
        below += 1;
    }
    let (low, high) = (FORCES_N[below], FORCES_N[below + 1]);
    STEP_MM * (below as f32 + (force_n - low) / (high - low))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn compressions_are_those_of_the_table_and_total() {
        for (at, force_n) in FORCES_N.iter().enumerate() {
            assert!((compression_mm(*force_n) - STEP_MM * at as f32).abs() < 1e-5);
        }
        assert!(FORCES_N.windows(2).all(|pair| pair[0] < pair[1]));
        assert_eq!((compression_mm(f32::NAN), compression_mm(-1.0)), (0.0, 0.0));
        assert_eq!(compression_mm(50.0), compression_mm(4.770_25));
        // a force of the finer table
        assert!((compression_mm(0.052_22) - 0.3).abs() < 0.011);
    }
}
