//! Millimetres of a pixel, from a marker of known size.

use super::frame::{Frame, Roi};
use super::noise::{median, pixel_noise};

/// What a marker is; it is filled, and its ground plain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Marker {
    /// A disc of a known diameter.
    Disc,
    /// A square of a known side.
    Square,
}

/// Length of a pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// Millimetres.
    pub mm_per_px: f64,
    /// Its standard deviation, as a part; zero where it was told.
    pub relative_sd: f64,
    /// Longer over shorter axis of the marker; 1 where the camera looks straight at it, or where there is none.
    pub tilt: f64,
}

/// Why a marker tells nothing.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("the marker's rectangle {roi}: {what}")]
pub struct MarkerError {
    /// As asked for.
    pub roi: Roi,
    /// What is wrong, and what was expected.
    pub what: String,
}

/// Pixels of ground around a marker that are looked at.
const RING_PX: usize = 2;
/// Contrast over noise that is wanted.
const LEAST_CONTRAST: f64 = 8.0;
/// Second moments may be off a filled disc's or square's by this part.
const FILLED: f64 = 0.12;

impl Marker {
    /// Side or diameter of a given area, and the sum of second moments over the area squared.
    fn length_and_moments(self, area: f64) -> (f64, f64) {
        match self {
            Marker::Disc => (2.0 * (area / std::f64::consts::PI).sqrt(), 0.5 / std::f64::consts::PI),
            Marker::Square => (area.sqrt(), 1.0 / 6.0),
        }
    }
}

impl Scale {
    /// As it was told.
    #[must_use]
    pub fn told(mm_per_px: f64) -> Self {
        Self { mm_per_px, relative_sd: 0.0, tilt: 1.0 }
    }

    /// From the area of a marker of `length_mm` alone in a rectangle. A marker that is seen obliquely is shorter one way: its
    /// longer axis is then the length.
    ///
    /// # Errors
    /// A rectangle that leaves the frame, a marker that touches its border, has no contrast, or is not filled.
    pub fn of_marker(frame: &Frame, roi: Roi, marker: Marker, length_mm: f64) -> Result<Self, MarkerError> {
        let wrong = |what: String| MarkerError { roi, what };
        if !roi.is_inside(frame.width, frame.height) {
            return Err(wrong(format!("it is not inside the frames of {} x {} pixels", frame.width, frame.height)));
        }
        if roi.width.min(roi.height) < 4 * RING_PX {
            return Err(wrong(format!("it is too small; expected at least {0} x {0} pixels", 4 * RING_PX)));
        }
        let at = |x: usize, y: usize| frame.row((roi.y + y) as i64)[roi.x + x];
        let is_ring = |x: usize, y: usize| x.min(y) < RING_PX || x + RING_PX >= roi.width || y + RING_PX >= roi.height;
        let all = || (0..roi.height).flat_map(|y| (0..roi.width).map(move |x| (x, y)));
        let mut ring: Vec<f32> = all().filter(|(x, y)| is_ring(*x, *y)).map(|(x, y)| at(x, y)).collect();
        let ground = median(&mut ring);
        let farthest =
            all().map(|(x, y)| at(x, y) - ground).fold(0.0, |a: f32, d| if d.abs() > a.abs() { d } else { a });
        let mut full: Vec<f32> =
            all().map(|(x, y)| (at(x, y) - ground) / farthest).filter(|part| *part > 0.6).collect();
        let contrast = f64::from(farthest * median(&mut full));
        let noise = pixel_noise(frame, roi);
        if contrast.is_nan() || contrast.abs() < LEAST_CONTRAST * noise {
            let told = (100.0 * contrast.abs(), 100.0 * noise);
            return Err(wrong(format!(
                "contrast {:.2} % of full scale, noise {:.2} %: no marker is seen",
                told.0, told.1
            )));
        }
        let crossing = ring.iter().filter(|v| f64::from((**v - ground).abs()) > 0.5 * contrast.abs()).count();
        if crossing * 50 > ring.len() {
            return Err(wrong("the marker touches its border; expected plain ground all around it".to_owned()));
        }
        let mut sums = [0.0; 6];
        for (x, y) in all() {
            let part = f64::from(at(x, y) - ground) / contrast;
            // Noise of the ground would count for much in the moments, being far out.
            let part = if part.abs() < 3.0 * noise / contrast.abs() { 0.0 } else { part };
            let (x, y) = (x as f64, y as f64);
            for (sum, factor) in sums.iter_mut().zip([1.0, x, y, x * x, x * y, y * y]) {
                *sum += part * factor;
            }
        }
        let area = sums[0];
        let [mx, my] = [sums[1] / area, sums[2] / area];
        let (xx, xy, yy) = (sums[3] / area - mx * mx, sums[4] / area - mx * my, sums[5] / area - my * my);
        let (length, filled) = marker.length_and_moments(area);
        let root = (0.25 * (xx - yy).powi(2) + xy * xy).sqrt();
        let (long, short) = (0.5 * (xx + yy) + root, 0.5 * (xx + yy) - root);
        let off = (long * short).max(0.0).sqrt() / (0.5 * filled * area);
        if !(area > 0.0 && (off - 1.0).abs() < FILLED) {
            let told = format!("its moments are {off:.2} of those of a filled {marker:?}").to_lowercase();
            return Err(wrong(format!("{told}; expected one marker alone, filled, on plain ground")));
        }
        let tilt = (long / short).sqrt();
        let edge = 4.0 * length;
        // Noise of the pixels that are counted, and a tenth of a level of blurred edge that the threshold leaves out.
        let relative_sd = 0.5 * noise / contrast.abs() * ((area + edge).sqrt() / area + 2.0 / area.sqrt());
        Ok(Self { mm_per_px: length_mm / (length * tilt.sqrt()), relative_sd, tilt })
    }
}
