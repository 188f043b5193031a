//! Pictures of tips whose places are known: areas of analytic shapes over pixels, by supersampling. Nothing of the tracker is used.

use rand::RngCore;
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64Mcg;

use palpate::track::Frame;

/// What moves. Lengths in pixels; the origin is the tip's reference point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// A round flat disc.
    Disc(f64),
    /// A finger from above, its round pad down.
    Finger(f64),
    /// A shaded ball on a stem.
    Ball(f64),
    /// A finger with ridges and blotches.
    Skin(f64),
    /// A flat square with a cross in it, turned by 20 degrees.
    Marker(f64),
    /// A plain probe that tapers to a point, with a bright band.
    Probe(f64),
}

fn smooth_noise(x: f64, y: f64, seed: u64) -> f64 {
    let hash = |i: i64, j: i64| {
        let mut h =
            (i as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ (j as u64).wrapping_mul(0xC2B2_AE3D_27D4_EB4F) ^ seed;
        h ^= h >> 29;
        h = h.wrapping_mul(0xBF58_476D_1CE4_E5B9);
        h ^= h >> 32;
        (h >> 11) as f64 / (1_u64 << 53) as f64
    };
    let (i, j) = (x.floor(), y.floor());
    let ease = |t: f64| t * t * (3.0 - 2.0 * t);
    let (u, v) = (ease(x - i), ease(y - j));
    let (i, j) = (i as i64, j as i64);
    let top = hash(i, j) * (1.0 - u) + hash(i + 1, j) * u;
    let low = hash(i, j + 1) * (1.0 - u) + hash(i + 1, j + 1) * u;
    top * (1.0 - v) + low * v
}

impl Shape {
    /// One of each, about 30 pixels wide.
    pub const ALL: [Self; 5] =
        [Self::Disc(14.0), Self::Finger(14.0), Self::Ball(16.0), Self::Skin(15.0), Self::Marker(12.0)];

    /// Brightness at a point of the shape; none beside it.
    fn at(self, x: f64, y: f64) -> Option<f64> {
        match self {
            Shape::Disc(r) => (x.hypot(y) < r).then_some(1.0),
            Shape::Finger(r) => (x.hypot(y) < r || (y < 0.0 && x.abs() < r)).then_some(1.0),
            Shape::Ball(r) => {
                let rr = (x * x + y * y) / (r * r);
                if rr < 1.0 {
                    let light = 0.3 * x / r - 0.5 * y / r + 0.8 * (1.0 - rr).sqrt();
                    return Some(0.25 + 0.75 * light.max(0.0));
                }
                (y < 0.0 && x.abs() < 0.35 * r).then_some(0.5)
            }
            Shape::Skin(r) => (x.hypot(y) < r || (y < 0.0 && x.abs() < r)).then(|| {
                let ridges = 0.15 * (std::f64::consts::TAU * (x.hypot(y + 0.5 * r)) / 6.0).sin();
                0.6 + ridges + 0.3 * (smooth_noise(x / 4.0, y / 4.0, 7) - 0.5)
            }),
            Shape::Marker(a) => {
                let (s, c) = 20.0_f64.to_radians().sin_cos();
                let (x, y) = (c * x + s * y, c * y - s * x);
                let inside = x.abs() < a && y.abs() < a;
                inside.then(|| if x.abs() < 0.25 * a || y.abs() < 0.25 * a { 0.1 } else { 1.0 })
            }
            Shape::Probe(a) => {
                let half = (0.8 * (a - y)).min(0.7 * a);
                (x.abs() < half).then_some(if (-0.5 * a..0.0).contains(&y) { 1.0 } else { 0.6 })
            }
        }
    }
}

/// A picture's making.
#[derive(Debug, Clone)]
pub struct Scene {
    /// Columns and rows.
    pub size: (usize, usize),
    /// What moves.
    pub shape: Shape,
    /// Brightness of the ground.
    pub ground: f64,
    /// Brightness of what is 1 on the shape.
    pub bright: f64,
    /// Amplitude of a texture of the ground, which does not move.
    pub texture: f64,
    /// Change of brightness across the frame, as a part.
    pub gradient: [f64; 2],
    /// Standard deviation of a Gaussian blur, pixels.
    pub blur: f64,
    /// Standard deviation, as a part of full scale.
    pub noise: f64,
    /// Of a grey value.
    pub bits: u32,
    /// Rectangle that hides what is behind it: x, y, width, height, brightness.
    pub hidden: Option<[f64; 5]>,
    /// Amplitude of a texture of that rectangle, which moves with it.
    pub hand: f64,
    /// Of textures.
    pub seed: u64,
    /// Factor of all brightness.
    pub light: f64,
    /// Points a pixel at edges, each way.
    pub subsamples: usize,
}

impl Scene {
    pub fn new(shape: Shape) -> Self {
        Self {
            size: (150, 130),
            shape,
            ground: 0.2,
            bright: 0.7,
            texture: 0.0,
            gradient: [0.0; 2],
            blur: 0.0,
            noise: 0.0,
            bits: 8,
            hidden: None,
            hand: 0.0,
            seed: 3,
            light: 1.0,
            subsamples: 8,
        }
    }

    fn brightness(&self, x: f64, y: f64, tip: [f64; 2]) -> f64 {
        if let Some([left, top, width, height, value]) = self.hidden
            && (left..left + width).contains(&x)
            && (top..top + height).contains(&y)
        {
            let (u, v) = ((x - left) / 4.0, (y - top) / 4.0);
            return value + self.hand * (smooth_noise(u, v, self.seed + 1) - 0.5);
        }
        let (w, h) = (self.size.0 as f64, self.size.1 as f64);
        let lit = self.light * (1.0 + self.gradient[0] * (x / w - 0.5) + self.gradient[1] * (y / h - 0.5));
        let ground = self.ground + self.texture * (smooth_noise(x / 5.0, y / 5.0, self.seed) - 0.5);
        let own = self.shape.at(x - tip[0], y - tip[1]).map(|v| self.ground + (self.bright - self.ground) * v);
        lit * own.unwrap_or(ground)
    }

    /// The border of what hides the tip runs through the pixel, or nearly.
    fn is_at_sheet(&self, x: f64, y: f64) -> bool {
        let Some([left, top, width, height, _]) = self.hidden else { return false };
        let near = |at: f64, edge: f64| (at - edge).abs() < 1.5;
        near(x, left) || near(x, left + width) || near(y, top) || near(y, top + height)
    }

    /// The frame with the tip there.
    pub fn frame(&self, tip: [f64; 2], random: &mut Pcg64Mcg) -> Frame {
        let (width, height) = self.size;
        let mut pixels = Vec::with_capacity(width * height);
        for y in 0..height {
            for x in 0..width {
                let (x0, y0) = (x as f64 - tip[0], y as f64 - tip[1]);
                let corners = [(-0.5, -0.5), (0.5, -0.5), (-0.5, 0.5), (0.5, 0.5)];
                let value = |(a, b): (f64, f64)| self.shape.at(x0 + a, y0 + b).unwrap_or(-1.0);
                let seen = corners.map(value);
                let low = seen.iter().copied().fold(f64::INFINITY, f64::min);
                let high = seen.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                let is_ground = seen.iter().all(|value| *value < 0.0);
                // Ridges may have equal brightness at all corners of a pixel.
                let is_plain = high - low < 0.02 && !matches!(self.shape, Shape::Skin(_));
                let is_smooth = (is_ground || is_plain) && !self.is_at_sheet(x as f64, y as f64);
                let n = if is_smooth { 1 } else { self.subsamples };
                let part = |i: usize| (i as f64 + 0.5) / n as f64 - 0.5;
                let mut sum = 0.0;
                for j in 0..n {
                    for i in 0..n {
                        // sheared, so that no straight edge meets many points at once
                        let (u, v) = (part(i) + (part(j) / n as f64), part(j) + (part(i) / n as f64));
                        sum += self.brightness(x as f64 + u, y as f64 + v, tip);
                    }
                }
                pixels.push(sum / (n * n) as f64);
            }
        }
        if self.blur > 0.0 {
            pixels = blurred(&pixels, width, height, self.blur);
        }
        let levels = f64::from((1_u32 << self.bits) - 1);
        let normal = Normal::new(0.0, self.noise.max(1e-12)).unwrap();
        let levelled = |value: f64, random: &mut Pcg64Mcg| {
            let noisy = value + if self.noise > 0.0 { normal.sample(random) } else { 0.0 };
            ((noisy * levels).round().clamp(0.0, levels) / levels) as f32
        };
        let pixels = pixels.into_iter().map(|value| levelled(value, random)).collect();
        Frame { width, height, pixels, step: (1.0 / levels) as f32 }
    }
}

fn blurred(pixels: &[f64], width: usize, height: usize, sigma: f64) -> Vec<f64> {
    let radius = (4.0 * sigma).ceil() as i64;
    let weights: Vec<f64> = (-radius..=radius).map(|d| (-0.5 * (d as f64 / sigma).powi(2)).exp()).collect();
    let sum: f64 = weights.iter().sum();
    let pass = |from: &[f64], along: bool| {
        let mut out = vec![0.0; from.len()];
        let (columns, rows) = (width as i64, height as i64);
        for (d, weight) in (-radius..=radius).zip(weights.iter().map(|weight| weight / sum)) {
            for y in 0..rows {
                let row = if along { y } else { (y + d).clamp(0, rows - 1) } as usize * width;
                for (x, out) in out[y as usize * width..][..width].iter_mut().enumerate() {
                    let at = if along { (x as i64 + d).clamp(0, columns - 1) as usize } else { x };
                    *out += weight * from[row + at];
                }
            }
        }
        out
    };
    pass(&pass(pixels, true), false)
}

/// A path that presses down and sways, pixels, at 60 frames a second.
pub fn path(i: usize) -> [f64; 2] {
    let t = i as f64 / 60.0;
    [70.3 + 7.3 * (1.7 * t).sin() + 0.37 * t, 50.6 + 14.0 * (1.0 - (2.9 * t).cos())]
}

/// A seeded source of random numbers.
pub fn random(seed: u64) -> Pcg64Mcg {
    let mut random = Pcg64Mcg::new(2 * u128::from(seed) + 1);
    for _ in 0..8 {
        random.next_u64();
    }
    random
}
