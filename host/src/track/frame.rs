//! A frame, and a rectangle in it.

use std::fmt;
use std::str::FromStr;

/// A grey picture. Pixel `(x, y)` has its centre at those coordinates, x to the right and y down.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Brightness from 0 (black) to 1 (full scale), row by row: `width * height` values.
    pub pixels: Vec<f32>,
    /// Distance of two grey levels, as a part of the full scale.
    pub step: f32,
}

impl Frame {
    /// Brightness where the nearest pixel of the frame is.
    pub(super) fn row(&self, y: i64) -> &[f32] {
        let y = usize::try_from(y).unwrap_or(0).min(self.height.saturating_sub(1));
        &self.pixels[y * self.width..(y + 1) * self.width]
    }

    /// Half as many pixels each way, each the mean of four; an odd last row or column is left out.
    pub(super) fn halved(&self) -> Self {
        let (width, height) = ((self.width / 2).max(1), (self.height / 2).max(1));
        let mut pixels = Vec::with_capacity(width * height);
        for y in 0..height {
            let (upper, lower) = (self.row(2 * y as i64), self.row(2 * y as i64 + 1));
            if self.width < 2 {
                pixels.push(0.5 * (upper[0] + lower[0]));
                continue;
            }
            let pairs = upper.chunks_exact(2).zip(lower.chunks_exact(2));
            pixels.extend(pairs.map(|(a, b)| 0.25 * (a[0] + a[1] + b[0] + b[1])));
        }
        Self { width, height, pixels, step: self.step }
    }
}

/// A rectangle of whole pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Roi {
    /// First column.
    pub x: usize,
    /// First row.
    pub y: usize,
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
}

impl Roi {
    /// Its middle, in pixels.
    #[must_use]
    pub fn middle(&self) -> [f64; 2] {
        let middle = |from: usize, length: usize| from as f64 + 0.5 * (length as f64 - 1.0);
        [middle(self.x, self.width), middle(self.y, self.height)]
    }

    /// It lies in a frame of this size.
    #[must_use]
    pub fn is_inside(&self, width: usize, height: usize) -> bool {
        let ends = |from: usize, length: usize, all: usize| from.checked_add(length).is_some_and(|end| end <= all);
        ends(self.x, self.width, width) && ends(self.y, self.height, height)
    }
}

impl fmt::Display for Roi {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{},{},{},{}", self.x, self.y, self.width, self.height)
    }
}

impl FromStr for Roi {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts: Vec<Option<usize>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
        match parts.as_slice() {
            [Some(x), Some(y), Some(width), Some(height)] if *width > 0 && *height > 0 => {
                Ok(Self { x: *x, y: *y, width: *width, height: *height })
            }
            _ => Err(format!(
                "\"{text}\" is no rectangle; expected X,Y,WIDTH,HEIGHT in whole pixels, such as 120,80,60,60"
            )),
        }
    }
}
