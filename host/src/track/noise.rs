//! How noisy a region is.

use super::frame::{Frame, Roi};

/// Standard deviation of a normal variable over the median of its magnitude.
pub const SD_OF_MEDIAN: f64 = 1.4826;

/// Standard deviation of a pixel's noise, from the median of a mask that edges and planes do not pass (Immerkaer 1996,
/// doi:10.1006/cviu.1996.0060); at least that of rounding to grey levels.
pub fn pixel_noise(frame: &Frame, roi: Roi) -> f64 {
    let mut passed = Vec::with_capacity(roi.width * roi.height);
    for y in roi.y.max(1)..(roi.y + roi.height).min(frame.height.saturating_sub(1)) {
        let [above, own, below] = [-1, 0, 1].map(|d| frame.row(y as i64 + d));
        for x in roi.x.max(1)..(roi.x + roi.width).min(frame.width.saturating_sub(1)) {
            let second = |row: &[f32]| row[x - 1] - 2.0 * row[x] + row[x + 1];
            passed.push((second(above) - 2.0 * second(own) + second(below)).abs());
        }
    }
    let rounding = f64::from(frame.step) / 12.0_f64.sqrt();
    // The mask's weights have a sum of squares of 36.
    (SD_OF_MEDIAN * f64::from(median(&mut passed)) / 6.0).max(rounding)
}

/// The middle value; zero of none.
pub fn median(values: &mut [f32]) -> f32 {
    let middle = values.len() / 2;
    if values.is_empty() {
        return 0.0;
    }
    *values.select_nth_unstable_by(middle, f32::total_cmp).1
}
