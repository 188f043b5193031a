//! Flux density to coil current: the straight line through the measured column of Table 6.
//!
//! Current, A: 1.5, 1.75, 2.0, 2.25, 2.5; measured flux density, gauss: 593, 629, 744, 794, 831 (thesis Table 6, Gauss
//! meter). Least squares: 205.4 G + 256.4 G/A (ERRATA row Table 6: 256 G/A). Below 1.5 A the line is extrapolated
//! to the origin's side and currents below zero are taken as zero.

/// Slope of the line, T/A.
pub const SLOPE_T_PER_A: f32 = 0.025_64;
/// Flux density of the line at zero current, T.
pub const OFFSET_T: f32 = 0.020_54;

/// Current for a flux density, A, at least 0; no upper limit here.
pub fn for_flux_density_a(flux_density_t: f32) -> f32 {
    let a = (flux_density_t - OFFSET_T) / SLOPE_T_PER_A;
    if a > 0.0 { a } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABLE_6: [(f64, f64); 5] = [(1.5, 593.0), (1.75, 629.0), (2.0, 744.0), (2.25, 794.0), (2.5, 831.0)];

    #[test]
    fn constants_are_the_least_squares_line() {
        let n = TABLE_6.len() as f64;
        let mean = |f: &dyn Fn(&(f64, f64)) -> f64| TABLE_6.iter().map(f).sum::<f64>() / n;
        let (mi, mb) = (mean(&|p| p.0), mean(&|p| p.1));
        let slope = mean(&|p| (p.0 - mi) * (p.1 - mb)) / mean(&|p| (p.0 - mi).powi(2));
        // Constants carry four digits.
        assert!((slope * 1e-4 / f64::from(SLOPE_T_PER_A) - 1.0).abs() < 5e-4);
        assert!(((mb - slope * mi) * 1e-4 / f64::from(OFFSET_T) - 1.0).abs() < 5e-4);
    }

    #[test]
    fn line_goes_through_the_middle_of_the_table_and_never_below_zero() {
        // Mean flux density 718.2 G at the mean current 2 A; four digits of the constants.
        assert!((for_flux_density_a(0.071_82) - 2.0).abs() < 2e-3);
        assert_eq!(for_flux_density_a(0.0), 0.0);
        assert_eq!(for_flux_density_a(f32::NAN), 0.0);
    }
}
