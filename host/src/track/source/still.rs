//! A PNG file as a frame.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use png::{ColorType, Decoder, Limits, Transformations};

use super::super::frame::Frame;
use super::error::SourceError;
use super::size::{MOST_PIXELS, pixels};

/// Parts of red, green and blue in the brightness (ITU-R BT.601).
const BRIGHTNESS: [f32; 3] = [0.299, 0.587, 0.114];

/// Reads a file; colours become brightness, what is transparent is taken as if it were not.
pub fn read(path: &Path) -> Result<Frame, SourceError> {
    let name = || path.display().to_string();
    let wrong = |cause: String| SourceError::Still { name: name(), cause };
    let file = File::open(path).map_err(|cause| SourceError::Unreadable { name: name(), cause })?;
    let mut decoder = Decoder::new_with_limits(BufReader::new(file), Limits { bytes: 8 * MOST_PIXELS });
    decoder.set_transformations(Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(|cause| wrong(cause.to_string()))?;
    let told = |width: u32, height: u32| pixels(width as usize, height as usize);
    let (width, height) = (reader.info().width, reader.info().height);
    let too_large = || wrong(format!("{width} x {height} pixels; expected at most {MOST_PIXELS} in all"));
    let count = told(width, height).ok_or_else(too_large)?;
    let size = reader.output_buffer_size().filter(|size| *size <= 8 * count).ok_or_else(too_large)?;
    let mut bytes = vec![0; size];
    let info = reader.next_frame(&mut bytes).map_err(|cause| wrong(cause.to_string()))?;
    let samples = info.color_type.samples();
    let is_grey = matches!(info.color_type, ColorType::Grayscale | ColorType::GrayscaleAlpha);
    let is_wide = info.bit_depth == png::BitDepth::Sixteen;
    let full = if is_wide { 65535.0 } else { 255.0 };
    let brightness = |sample: &dyn Fn(usize) -> f32| {
        let value = match is_grey {
            true => sample(0),
            false => (0..3).map(|i| BRIGHTNESS[i] * sample(i)).sum(),
        };
        value / full
    };
    let pixels: Vec<f32> = match is_wide {
        true => bytes
            .chunks_exact(2 * samples)
            .map(|p| brightness(&|i| f32::from(u16::from_be_bytes([p[2 * i], p[2 * i + 1]]))))
            .collect(),
        false => bytes.chunks_exact(samples).map(|p| brightness(&|i| f32::from(p[i]))).collect(),
    };
    let (width, height) = (info.width as usize, info.height as usize);
    if pixels.len() != width * height {
        return Err(wrong(format!("{} pixels; expected {width} x {height}", pixels.len())));
    }
    Ok(Frame { width, height, pixels, step: 1.0 / full })
}
