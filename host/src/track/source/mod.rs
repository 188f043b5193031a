//! Frames from outside: a folder of PNG files, or a YUV4MPEG2 stream (`.y4m`) from a file, a pipe or standard input.

mod ending;
mod error;
mod folder;
mod size;
mod still;
mod y4m;

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

pub use ending::Ending;
pub use error::SourceError;
pub use y4m::Y4m;

use super::frame::Frame;
use ending::Growing;
use folder::Folder;

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
