//! One-dimensional grading: node positions whose spacing follows a size function.

/// Samples of the size function a division is integrated with; the spacing then
/// follows the function to about 1e-4, far below what the mesh needs.
const SAMPLES: usize = 4000;

/// Divides `[0, length]` (mm) into intervals whose widths follow `size(x)` (mm)
/// times one common factor near `1 / refinement`.
///
/// The number of intervals is `integral dx / size(x)` times `refinement`, rounded up,
/// so meshes of different refinement are images of one map of the unit interval:
/// the condition for Richardson extrapolation between them.
/// Returns at least two positions, the first 0, the last `length`.
#[must_use]
pub fn graded(length: f64, refinement: f64, size: impl Fn(f64) -> f64) -> Vec<f64> {
    let dx = length / SAMPLES as f64;
    let mut count = Vec::with_capacity(SAMPLES + 1);
    count.push(0.0);
    let mut sum = 0.0;
    for i in 0..SAMPLES {
        sum += dx / size((i as f64 + 0.5) * dx);
        count.push(sum);
    }
    let n = ((sum * refinement).ceil() as usize).max(1);
    let mut at = 0;
    let mut x = Vec::with_capacity(n + 1);
    x.push(0.0);
    for k in 1..n {
        let target = sum * k as f64 / n as f64;
        while count[at + 1] < target {
            at += 1;
        }
        let part = (target - count[at]) / (count[at + 1] - count[at]);
        x.push((at as f64 + part) * dx);
    }
    x.push(length);
    x
}
