//! Where a template may be: normalised correlation by Fourier transform (Lewis 1995, "Fast normalized cross-correlation").

use std::sync::Arc;

use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlanner};

use super::frame::Frame;
use super::gaussian::{Order, Sampler};
use super::normal::{LIGHT, TEMPLATE};
use super::template::Template;

/// A place and its correlation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// How far from the template's place in the first frame, pixels of the level.
    pub shift: [f64; 2],
    /// Normalised correlation, 1 at best.
    pub correlation: f64,
}

/// Below, a maximum is no place.
const LEAST_CORRELATION: f64 = 0.3;
/// Most places of a search.
const PLACES: usize = 4;

/// Correlates a template with regions of one size.
pub struct Search {
    /// Columns and rows of places.
    places: (usize, usize),
    transform: Plane,
    /// Spectrum of the template without its plane of light, conjugate.
    spectrum: Vec<Complex<f32>>,
    /// Root of its sum of squares.
    norm: f64,
    sampler: Sampler,
    region: Vec<f32>,
    field: Vec<Complex<f32>>,
}

impl std::fmt::Debug for Search {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Search").field("places", &self.places).finish_non_exhaustive()
    }
}

/// A Fourier transform in two dimensions.
struct Plane {
    size: (usize, usize),
    forward: [Arc<dyn Fft<f32>>; 2],
    inverse: [Arc<dyn Fft<f32>>; 2],
    turned: Vec<Complex<f32>>,
    scratch: Vec<Complex<f32>>,
}

/// The next length that is quick to transform.
fn quick(length: usize) -> usize {
    let is_quick = |n: &usize| {
        let mut n = *n;
        for factor in [2, 3, 5] {
            while n.is_multiple_of(factor) {
                n /= factor;
            }
        }
        n == 1
    };
    (length.max(1)..).find(is_quick).unwrap_or(length)
}

impl Plane {
    fn new(width: usize, height: usize) -> Self {
        let size = (quick(width), quick(height));
        let mut planner = FftPlanner::new();
        let forward = [planner.plan_fft_forward(size.0), planner.plan_fft_forward(size.1)];
        let inverse = [planner.plan_fft_inverse(size.0), planner.plan_fft_inverse(size.1)];
        let all = forward.iter().chain(&inverse);
        let scratch = all.map(|fft| fft.get_inplace_scratch_len()).max().unwrap_or(0);
        let zero = Complex::new(0.0, 0.0);
        Self { size, forward, inverse, turned: vec![zero; size.0 * size.1], scratch: vec![zero; scratch] }
    }

    /// Rows first; what comes out lies column by column.
    fn forward(&mut self, field: &mut Vec<Complex<f32>>) {
        self.forward[0].process_with_scratch(field, &mut self.scratch);
        turn(field, self.size.0, self.size.1, &mut self.turned);
        self.forward[1].process_with_scratch(&mut self.turned, &mut self.scratch);
        std::mem::swap(field, &mut self.turned);
    }

    /// The way back, without a factor.
    fn inverse(&mut self, field: &mut Vec<Complex<f32>>) {
        self.inverse[1].process_with_scratch(field, &mut self.scratch);
        turn(field, self.size.1, self.size.0, &mut self.turned);
        self.inverse[0].process_with_scratch(&mut self.turned, &mut self.scratch);
        std::mem::swap(field, &mut self.turned);
    }
}

/// Rows become columns.
fn turn(from: &[Complex<f32>], width: usize, height: usize, to: &mut [Complex<f32>]) {
    for (y, row) in from.chunks_exact(width).enumerate() {
        for (x, value) in row.iter().enumerate() {
            to[x * height + y] = *value;
        }
    }
}

impl Search {
    /// For so many columns and rows of places.
    pub fn new(template: &Template, places: (usize, usize)) -> Self {
        let (width, height) = template.size;
        let mut transform = Plane::new(width + places.0 - 1, height + places.1 - 1);
        let flat = without_light(template);
        let norm = flat.iter().map(|v| v * v).sum::<f64>().sqrt();
        let mut spectrum = vec![Complex::new(0.0, 0.0); transform.size.0 * transform.size.1];
        for (row, line) in flat.chunks_exact(width).zip(spectrum.chunks_exact_mut(transform.size.0)) {
            for (value, out) in row.iter().zip(line) {
                *out = Complex::new(*value as f32, 0.0);
            }
        }
        transform.forward(&mut spectrum);
        spectrum.iter_mut().for_each(|value| *value = value.conj());
        let field = vec![Complex::new(0.0, 0.0); spectrum.len()];
        Self { places, transform, spectrum, norm, sampler: Sampler::default(), region: Vec::new(), field }
    }

    /// Places to either side of the middle one.
    pub fn reach(&self) -> [i64; 2] {
        [self.places.0, self.places.1].map(|places| places as i64 / 2)
    }

    /// The best places, best first, of which the first is `from` (whole pixels of the level).
    pub fn places(&mut self, template: &Template, frame: &Frame, from: [i64; 2]) -> Vec<Place> {
        let (width, height) = (template.size.0 + self.places.0 - 1, template.size.1 + self.places.1 - 1);
        let corner = [template.corner[0] + from[0] as f64, template.corner[1] + from[1] as f64];
        self.sampler.sample(frame, corner, (width, height), [Order::Value; 2], &mut self.region);
        let mean = self.region.iter().map(|v| f64::from(*v)).sum::<f64>() / self.region.len() as f64;
        self.region.iter_mut().for_each(|v| *v -= mean as f32);
        self.field.fill(Complex::new(0.0, 0.0));
        for (row, line) in self.region.chunks_exact(width).zip(self.field.chunks_exact_mut(self.transform.size.0)) {
            for (value, out) in row.iter().zip(line) {
                out.re = *value;
            }
        }
        self.transform.forward(&mut self.field);
        for (value, template) in self.field.iter_mut().zip(&self.spectrum) {
            *value *= template;
        }
        self.transform.inverse(&mut self.field);
        let map = self.normalised(template.size, width);
        let best = maxima(&map, self.places.0);
        let shift = |at: usize| {
            [(from[0] + (at % self.places.0) as i64) as f64, (from[1] + (at / self.places.0) as i64) as f64]
        };
        best.into_iter().map(|at| Place { shift: shift(at), correlation: map[at] }).collect()
    }

    /// Products over the norms of the windows.
    fn normalised(&self, (columns, rows): (usize, usize), width: usize) -> Vec<f64> {
        let sums = Sums::of(&self.region, width);
        let scale = 1.0 / self.spectrum.len() as f64;
        let count = (columns * rows) as f64;
        let mut map = Vec::with_capacity(self.places.0 * self.places.1);
        for y in 0..self.places.1 {
            for x in 0..self.places.0 {
                let [sum, squares] = sums.over(x, y, columns, rows);
                let product = f64::from(self.field[y * self.transform.size.0 + x].re) * scale;
                let spread = squares - sum * sum / count;
                // Below, the window is flat: what is left are rounding errors.
                let is_flat = spread < 1e-9 * count + 1e-6 * squares;
                map.push(if is_flat { 0.0 } else { product / (self.norm * spread.sqrt()) });
            }
        }
        map
    }
}

/// The template without its plane of light.
fn without_light(template: &Template) -> Vec<f64> {
    let products = &template.full.products;
    let light = products.fixed_view::<3, 3>(LIGHT, LIGHT).into_owned();
    let with = products.fixed_view::<3, 1>(LIGHT, TEMPLATE).into_owned();
    let factors = light.cholesky().map_or_else(nalgebra::Vector3::zeros, |factored| factored.solve(&with));
    let value = |i: usize| {
        let plane: f64 = (0..3).map(|k| factors[k] * f64::from(template.basis[LIGHT + k][i])).sum();
        (f64::from(template.basis[TEMPLATE][i]) - plane) * f64::from(template.inside[i])
    };
    (0..template.inside.len()).map(value).collect()
}

/// Sums of a region's values and squares from its first pixel on.
struct Sums {
    width: usize,
    sums: Vec<[f64; 2]>,
}

impl Sums {
    fn of(region: &[f32], width: usize) -> Self {
        let wide = width + 1;
        let mut sums = vec![[0.0; 2]; wide * (region.len() / width + 1)];
        for (y, row) in region.chunks_exact(width).enumerate() {
            let mut line = [0.0; 2];
            for (x, value) in row.iter().enumerate() {
                let value = f64::from(*value);
                line = [line[0] + value, line[1] + value * value];
                let above = sums[y * wide + x + 1];
                sums[(y + 1) * wide + x + 1] = [above[0] + line[0], above[1] + line[1]];
            }
        }
        Self { width: wide, sums }
    }

    fn over(&self, x: usize, y: usize, columns: usize, rows: usize) -> [f64; 2] {
        let at = |x: usize, y: usize| self.sums[y * self.width + x];
        let (a, b, c, d) = (at(x, y), at(x + columns, y), at(x, y + rows), at(x + columns, y + rows));
        [d[0] - b[0] - c[0] + a[0], d[1] - b[1] - c[1] + a[1]]
    }
}

/// Local maxima, best first.
fn maxima(map: &[f64], width: usize) -> Vec<usize> {
    let height = map.len() / width;
    let is_best = |at: &usize| {
        let (x, y) = (at % width, at / width);
        let columns = x.saturating_sub(1)..(x + 2).min(width);
        let near = (y.saturating_sub(1)..(y + 2).min(height)).flat_map(|y| columns.clone().map(move |x| y * width + x));
        map[*at] > LEAST_CORRELATION && near.into_iter().all(|other| map[other] <= map[*at])
    };
    let mut found: Vec<usize> = (0..map.len()).filter(is_best).collect();
    found.sort_by(|a, b| map[*b].total_cmp(&map[*a]));
    found.truncate(PLACES);
    found
}
