//! What is looked for: the region of the first frame, at one level of a pyramid.

use super::frame::{Frame, Roi};
use super::gaussian::{BORDER_PX, NOISE_LEFT, Order, SIGMA_PX, Sampler};
use super::normal::{Basis, LIGHT, Normal, TEMPLATE};

/// Smallest side of a region, pixels.
pub const LEAST_SIDE_PX: usize = 8;

/// The region at one level. It never changes, so that a track cannot drift.
#[derive(Debug)]
pub struct Template {
    /// Columns and rows.
    pub size: (usize, usize),
    /// Where its first pixel is in the first frame, in pixels of the level.
    pub corner: [f64; 2],
    /// Pixels of the frame in one of the level's.
    pub scale: f64,
    /// Slopes along x and y, brightness without its mean, half its Laplacian, and a plane of light.
    pub basis: Basis,
    /// One inside the first frame, zero at its border.
    pub inside: Vec<f32>,
    /// Noise of the template and of its blur: their product's mean, with its sign turned.
    pub bend_noise: f64,
    /// Normal equations of all pixels.
    pub full: Normal,
}

impl Template {
    /// The region at `level` of the pyramid whose frame of that level is given; `noise` is the standard deviation of a pixel's
    /// noise there.
    pub fn new(frame: &Frame, roi: Roi, level: u32, noise: f64, sampler: &mut Sampler) -> Self {
        let scale = f64::from(1_u32 << level);
        let corner = [roi.x as f64 / scale, roi.y as f64 / scale];
        let length = |whole: usize| ((whole as f64 / scale).floor() as usize).max(1);
        let size = (length(roi.width), length(roi.height));
        let mut basis = Basis::default();
        let orders = [
            [Order::Slope, Order::Value],
            [Order::Value, Order::Slope],
            [Order::Value, Order::Value],
            [Order::Bend, Order::Value],
        ];
        for (picture, orders) in basis.iter_mut().zip(orders) {
            sampler.sample(frame, corner, size, orders, picture);
        }
        let mut bend = Vec::new();
        sampler.sample(frame, corner, size, [Order::Value, Order::Bend], &mut bend);
        for (sum, bend) in basis[LIGHT - 1].iter_mut().zip(&bend) {
            *sum = 0.5 * (*sum + bend);
        }
        let count = size.0 * size.1;
        let mean = basis[TEMPLATE].iter().map(|v| f64::from(*v)).sum::<f64>() / count as f64;
        basis[TEMPLATE].iter_mut().for_each(|v| *v -= mean as f32);
        let along = |i: usize, length: usize| ((2 * i + 1) as f32 / length as f32) - 1.0;
        basis[LIGHT] = vec![1.0; count];
        basis[LIGHT + 1] = (0..count).map(|i| along(i % size.0, size.0)).collect();
        basis[LIGHT + 2] = (0..count).map(|i| along(i / size.0, size.1)).collect();
        let mut inside = vec![1.0; count];
        hide_outside(frame, corner, size, &mut inside);
        let bend_noise = noise * noise * NOISE_LEFT / (2.0 * SIGMA_PX * SIGMA_PX);
        let full = Normal::of_basis(&basis, &inside, bend_noise);
        Self { size, corner, scale, basis, inside, bend_noise, full }
    }

    /// Variance of the template's brightness beyond a plane of light.
    pub fn contrast_variance(&self) -> f64 {
        let light = self.full.products.fixed_view::<3, 3>(LIGHT, LIGHT).into_owned();
        let with = self.full.products.fixed_view::<3, 1>(LIGHT, TEMPLATE).into_owned();
        let explained = light.cholesky().map_or(0.0, |factored| with.dot(&factored.solve(&with)));
        ((self.full.products[(TEMPLATE, TEMPLATE)] - explained) / self.full.weight.max(1.0)).max(0.0)
    }
}

/// Sets weights of pixels to zero that are not in the frame; tells whether all are.
pub fn hide_outside(frame: &Frame, corner: [f64; 2], size: (usize, usize), weights: &mut [f32]) -> bool {
    let range = |from: f64, length: usize, all: usize| {
        let (low, high) = (BORDER_PX - from, all as f64 - 1.0 - BORDER_PX - from);
        let first = low.ceil().clamp(0.0, length as f64) as usize;
        let end = (high.floor() + 1.0).clamp(0.0, length as f64) as usize;
        (first, end.max(first))
    };
    let (columns, rows) = (range(corner[0], size.0, frame.width), range(corner[1], size.1, frame.height));
    if columns == (0, size.0) && rows == (0, size.1) {
        return true;
    }
    for (y, row) in weights.chunks_exact_mut(size.0).enumerate() {
        if y < rows.0 || y >= rows.1 {
            row.fill(0.0);
        } else {
            row[..columns.0].fill(0.0);
            row[columns.1..].fill(0.0);
        }
    }
    false
}
