//! YUV4MPEG2 streams: a line of parameters, then frames of planes, of which the first is the brightness
//! (mjpegtools, `yuv4mpeg(5)`; sample depths above 8 bits as ffmpeg writes them).

use std::io::Read;

use super::super::frame::Frame;
use super::error::SourceError;
use super::size::pixels;

/// Longest line of parameters, bytes.
const LONGEST_LINE: usize = 4096;
const MAGIC: &str = "YUV4MPEG2";
const MARK: &str = "FRAME";

/// A stream of frames.
pub struct Y4m<R> {
    name: String,
    source: R,
    width: usize,
    height: usize,
    rate: Option<f64>,
    /// Bits of a sample: 8, or more in two bytes.
    bits: u32,
    /// Bytes after the brightness.
    colours: u64,
    frame: usize,
    byte: u64,
    ended: bool,
    plane: Vec<u8>,
}

/// What is left of a text for a message.
fn shown(bytes: &[u8]) -> String {
    let text: String = bytes.iter().take(24).map(|b| char::from(*b)).flat_map(char::escape_default).collect();
    format!("\"{text}\"")
}

impl<R: Read> Y4m<R> {
    /// Reads the header.
    ///
    /// # Errors
    /// No stream of this kind, a size or a way of sampling that is not known.
    pub fn open(name: &str, mut source: R) -> Result<Self, SourceError> {
        let header =
            |what, value: String, expected| SourceError::Header { name: name.to_owned(), what, value, expected };
        let unreadable = |cause| SourceError::Unreadable { name: name.to_owned(), cause };
        let line = line(&mut source).map_err(unreadable)?;
        let bytes = line.len() as u64 + 1;
        let is_ours = line.strip_prefix(MAGIC.as_bytes()).filter(|rest| rest.is_empty() || rest[0] == b' ');
        let Some(rest) = is_ours else {
            return Err(header("the beginning", shown(&line), "\"YUV4MPEG2 \" and parameters"));
        };
        let text = String::from_utf8_lossy(rest).into_owned();
        let (mut width, mut height, mut rate, mut sampling) = (None, None, None, "420".to_owned());
        for word in text.split_ascii_whitespace() {
            let mut letters = word.chars();
            let Some(key) = letters.next() else { continue };
            let value = letters.as_str();
            let length = |what| {
                let length = value.parse::<usize>().ok().filter(|length| (1..=1 << 20).contains(length));
                length.map(Some).ok_or_else(|| header(what, shown(value.as_bytes()), "a whole number of at least 1"))
            };
            match key {
                'W' => width = length("the width W")?,
                'H' => height = length("the height H")?,
                'F' => {
                    rate = frame_rate(value).map_err(|()| {
                        header("the frame rate F", shown(value.as_bytes()), "two whole numbers, such as 60:1")
                    })?
                }
                'C' => value.clone_into(&mut sampling),
                _ => {}
            }
        }
        let missing = |what| header(what, "not there".to_owned(), "a whole number of at least 1");
        let width = width.ok_or_else(|| missing("the width W"))?;
        let height = height.ok_or_else(|| missing("the height H"))?;
        pixels(width, height)
            .ok_or_else(|| header("the size", format!("{width} x {height}"), "at most 64 megapixels"))?;
        let known = "420, 422, 444, 411, 410, 440 or mono, with jpeg, mpeg2, paldv, alpha, p9 to p16 after it";
        let (colours, bits) = planes(&sampling, width as u64, height as u64)
            .ok_or_else(|| header("the sampling C", shown(sampling.as_bytes()), known))?;
        let name = name.to_owned();
        let (frame, ended, plane) = (0, false, Vec::new());
        Ok(Self { name, source, width, height, rate, bits, colours, frame, byte: bytes, ended, plane })
    }

    /// Frames a second; none where the header does not tell.
    pub fn rate(&self) -> Option<f64> {
        self.rate
    }

    /// Name of the frame that was read last.
    pub fn name(&self) -> String {
        format!("{}, frame {}", self.name, self.frame.saturating_sub(1))
    }

    fn unreadable(&self) -> impl Fn(std::io::Error) -> SourceError + use<R> {
        let name = self.name.clone();
        move |cause| SourceError::Unreadable { name: name.clone(), cause }
    }

    /// Reads so many bytes into the plane, as they come: a header may promise more than there is.
    fn take(&mut self, count: u64, keep: bool, before: u64, all: u64) -> Result<(), SourceError> {
        let mut part = self.source.by_ref().take(count);
        let got = match keep {
            true => {
                self.plane.clear();
                part.read_to_end(&mut self.plane).map(|read| read as u64)
            }
            false => std::io::copy(&mut part, &mut std::io::sink()),
        };
        let got = got.map_err(self.unreadable())?;
        self.byte += got;
        if got < count {
            let (name, frame) = (self.name.clone(), self.frame);
            return Err(SourceError::Cut { name, frame, got: before + got, expected: all });
        }
        Ok(())
    }

    fn read(&mut self) -> Result<Option<Frame>, SourceError> {
        let line = line(&mut self.source).map_err(self.unreadable())?;
        if line.is_empty() {
            return Ok(None);
        }
        let is_frame = line.strip_prefix(MARK.as_bytes()).is_some_and(|rest| rest.is_empty() || rest[0] == b' ');
        if !is_frame {
            let (name, frame, byte) = (self.name.clone(), self.frame, self.byte);
            return Err(SourceError::Mark { name, frame, byte, found: shown(&line) });
        }
        self.byte += line.len() as u64 + 1;
        let wide = self.bits > 8;
        let own = (self.width * self.height) as u64 * if wide { 2 } else { 1 };
        let all = own + self.colours;
        self.take(own, true, 0, all)?;
        let full = ((1_u32 << self.bits) - 1) as f32;
        let pixels = match wide {
            true => self.plane.chunks_exact(2).map(|b| f32::from(u16::from_le_bytes([b[0], b[1]])) / full).collect(),
            false => self.plane.iter().map(|b| f32::from(*b) / full).collect(),
        };
        self.take(self.colours, false, own, all)?;
        self.frame += 1;
        Ok(Some(Frame { width: self.width, height: self.height, pixels, step: 1.0 / full }))
    }
}

impl<R: Read> Iterator for Y4m<R> {
    type Item = Result<Frame, SourceError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.ended {
            return None;
        }
        let read = self.read().transpose();
        self.ended = !matches!(read, Some(Ok(_)));
        read
    }
}

/// Bytes up to the end of a line, without it; what is too long for one is cut.
fn line(source: &mut impl Read) -> std::io::Result<Vec<u8>> {
    let mut line = Vec::new();
    let mut byte = [0];
    for _ in 0..LONGEST_LINE {
        match source.read(&mut byte) {
            Ok(0) => break,
            Ok(_) if byte == *b"\n" => break,
            Ok(_) => line.extend(byte),
            Err(error) if error.kind() == std::io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(line)
}

/// `NUMERATOR:DENOMINATOR`; `0:0` is an unknown rate.
fn frame_rate(text: &str) -> Result<Option<f64>, ()> {
    let (over, under) = text.split_once(':').ok_or(())?;
    let (over, under): (u32, u32) = (over.parse().map_err(|_| ())?, under.parse().map_err(|_| ())?);
    match (over, under) {
        (0, _) => Ok(None),
        (_, 0) => Err(()),
        _ => Ok(Some(f64::from(over) / f64::from(under))),
    }
}

/// Bytes of a frame after its brightness, and bits of a sample.
fn planes(sampling: &str, width: u64, height: u64) -> Option<(u64, u32)> {
    let (kind, rest) = match sampling.strip_prefix("mono") {
        Some(rest) => ("mono", rest),
        None => (sampling.get(..3)?, sampling.get(3..)?),
    };
    let half = |length: u64| length.div_ceil(2);
    let quarter = |length: u64| length.div_ceil(4);
    let samples = match kind {
        "mono" => 0,
        "420" => 2 * half(width) * half(height),
        "422" => 2 * half(width) * height,
        "440" => 2 * width * half(height),
        "411" => 2 * quarter(width) * height,
        "410" => 2 * quarter(width) * quarter(height),
        "444" if rest == "alpha" => 3 * width * height,
        "444" => 2 * width * height,
        _ => return None,
    };
    // ffmpeg writes "mono10" and "420p10"; the others name where colours are sampled.
    let bits = match rest {
        "" | "jpeg" | "mpeg2" | "paldv" => 8,
        "alpha" if kind == "444" => 8,
        _ => {
            let bits = if kind == "mono" { rest } else { rest.strip_prefix('p')? };
            bits.parse().ok().filter(|bits| (9..=16).contains(bits))?
        }
    };
    Some((samples * if bits > 8 { 2 } else { 1 }, bits))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn open(bytes: &[u8]) -> Result<Y4m<&[u8]>, String> {
        Y4m::open("a.y4m", bytes).map_err(|error| error.to_string())
    }

    #[test]
    fn planes_of_all_samplings_are_passed_over() {
        // 5 x 3 pixels: colours of 3 x 2, 3 x 3, 5 x 2, 2 x 3 and 2 x 1 samples, twice
        let cases = [
            ("420jpeg", 12),
            ("422", 18),
            ("440", 20),
            ("411", 12),
            ("410", 4),
            ("444", 30),
            ("444alpha", 45),
            ("mono", 0),
        ];
        for (sampling, colours) in cases {
            let mut bytes = format!("YUV4MPEG2 W5 H3 F30000:1001 Ip A0:0 C{sampling} Xany=thing\n").into_bytes();
            for frame in 0..2_u8 {
                bytes.extend(b"FRAME Ip\n");
                bytes.extend((0..15).map(|i| 10 * i + frame));
                bytes.extend(vec![0xEE; colours]);
            }
            let mut stream = open(&bytes).unwrap();
            assert!((stream.rate().unwrap() - 29.97).abs() < 1e-3);
            for frame in 0..2_u8 {
                let read = stream.next().unwrap().unwrap();
                assert_eq!((read.width, read.height), (5, 3), "{sampling}");
                assert_eq!((read.pixels[14] * 255.0).round(), f32::from(140 + frame), "{sampling}");
            }
            assert!(stream.next().is_none(), "{sampling}");
        }
    }

    #[test]
    fn deep_samples_are_little_endian() {
        let mut bytes = b"YUV4MPEG2 W2 H1 C420p10\nFRAME\n".to_vec();
        bytes.extend([0xFF, 0x03, 0x00, 0x02, 1, 0, 1, 0]);
        let frame = open(&bytes).unwrap().next().unwrap().unwrap();
        assert_eq!(frame.pixels, [1.0, 512.0 / 1023.0]);
        assert_eq!(frame.step, 1.0 / 1023.0);
    }

    #[test]
    fn bad_headers_name_the_parameter_and_what_was_expected() {
        let told = |text: &str| open(text.as_bytes()).err().unwrap();
        assert!(told("RIFF....\n").contains("the beginning is \"RIFF....\"; expected \"YUV4MPEG2 \""));
        assert!(told("YUV4MPEG2 W64\n").contains("the height H is not there"));
        assert!(told("YUV4MPEG2 W-3 H4\n").contains("the width W is \"-3\"; expected a whole number"));
        assert!(told("YUV4MPEG2 W1000000 H1000000\n").contains("the size is 1000000 x 1000000"));
        assert!(told("YUV4MPEG2 W4 H4 C421\n").contains("the sampling C is \"421\"; expected 420"));
        assert!(told("YUV4MPEG2 W4 H4 Fx\n").contains("the frame rate F is \"x\""));
        assert!(told("").contains("the beginning is \"\""));
    }

    #[test]
    fn a_cut_or_broken_stream_says_where() {
        let mut stream = open(b"YUV4MPEG2 W4 H2 Cmono\nFRAME\n12345678FRAME\n123").unwrap();
        assert!(stream.next().unwrap().is_ok());
        let error = stream.next().unwrap().err().unwrap().to_string();
        assert_eq!(error, "a.y4m, frame 1: ends after 3 of 8 bytes");
        assert!(stream.next().is_none());
        let mut stream = open(b"YUV4MPEG2 W4 H2 Cmono\nFRAMING\n12345678").unwrap();
        let error = stream.next().unwrap().err().unwrap().to_string();
        assert_eq!(error, "a.y4m, frame 0, byte 22: found \"FRAMING\"; expected \"FRAME\"");
    }
}
