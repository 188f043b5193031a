//! Frames from outside: a folder of PNG files, or a YUV4MPEG2 stream (`.y4m`) from a file, a pipe or standard input.

mod error;
mod folder;
mod still;
mod y4m;

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

pub use error::SourceError;
pub use y4m::Y4m;

use super::frame::Frame;
use folder::Folder;

/// Between two looks at a file or folder that grows.
const PAUSE: Duration = Duration::from_millis(5);
/// Most pixels of a frame: 64 megapixels.
const MOST_PIXELS: usize = 1 << 26;

/// Whether a recording that has come to its end may go on.
#[derive(Debug, Clone, Copy)]
pub enum Ending<'a> {
    /// It is whole.
    Final,
    /// It grows until this is set.
    Until(&'a AtomicBool),
}

impl Ending<'_> {
    /// Waits a little where there may be more; `false` where there is none.
    fn wait(self) -> bool {
        let Ending::Until(stop) = self else { return false };
        if stop.load(Ordering::Relaxed) {
            return false;
        }
        std::thread::sleep(PAUSE);
        true
    }
}

/// A file that is read as it grows.
struct Growing<'a, R> {
    inner: R,
    ending: Ending<'a>,
}

impl<R: Read> Read for Growing<'_, R> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        loop {
            match self.inner.read(buffer)? {
                0 if !buffer.is_empty() && self.ending.wait() => {}
                read => return Ok(read),
            }
        }
    }
}

/// Frames one after the other.
pub enum Frames<'a> {
    /// Files of a folder, or a single file.
    Stills(Box<Folder<'a>>),
    /// A stream.
    Stream(Box<Y4m<Box<dyn Read + Send + 'a>>>),
}

impl std::fmt::Debug for Frames<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Frames::Stills(_) => "Frames::Stills",
            Frames::Stream(_) => "Frames::Stream",
        })
    }
}

impl<'a> Frames<'a> {
    /// Opens a folder of PNG files (in the order of the numbers in their names), one PNG file, a stream, or with `-` the
    /// stream on standard input.
    ///
    /// # Errors
    /// Nothing is there, or something else than frames.
    pub fn open(place: &Path, ending: Ending<'a>) -> Result<Self, SourceError> {
        if place == Path::new("-") {
            let stream: Box<dyn Read + Send> = Box::new(BufReader::with_capacity(1 << 20, std::io::stdin()));
            return Ok(Frames::Stream(Box::new(Y4m::open("standard input", stream)?)));
        }
        if place.is_dir() {
            return Ok(Frames::Stills(Box::new(Folder::open(place, ending)?)));
        }
        let name = place.display().to_string();
        let failed = |cause| SourceError::Unreadable { name: name.clone(), cause };
        let is_still = place.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png"));
        if is_still {
            return Ok(Frames::Stills(Box::new(Folder::single(place))));
        }
        let file = File::open(place).map_err(failed)?;
        let stream: Box<dyn Read + Send + 'a> =
            Box::new(BufReader::with_capacity(1 << 20, Growing { inner: file, ending }));
        Ok(Frames::Stream(Box::new(Y4m::open(&name, stream)?)))
    }

    /// Frames a second, where the recording tells.
    #[must_use]
    pub fn rate(&self) -> Option<f64> {
        match self {
            Frames::Stills(_) => None,
            Frames::Stream(stream) => stream.rate(),
        }
    }

    /// Name of the frame that was read last.
    #[must_use]
    pub fn name(&self) -> String {
        match self {
            Frames::Stills(folder) => folder.name(),
            Frames::Stream(stream) => stream.name(),
        }
    }
}

impl Iterator for Frames<'_> {
    type Item = Result<Frame, SourceError>;

    /// The next frame; none after the last, or after an error.
    fn next(&mut self) -> Option<Self::Item> {
        match self {
            Frames::Stills(folder) => folder.next(),
            Frames::Stream(stream) => stream.next(),
        }
    }
}

/// Room for a frame, where it is no larger than frames are.
fn pixels(width: usize, height: usize) -> Option<usize> {
    width.checked_mul(height).filter(|count| (1..=MOST_PIXELS).contains(count))
}
