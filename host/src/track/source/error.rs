//! What can be wrong with recorded frames.

use std::io;

/// Why a frame cannot be read.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum SourceError {
    /// The file system refused.
    #[error("cannot read {name}: {cause}")]
    #[diagnostic(help("expected a folder of PNG files, a .y4m file, or - for a .y4m stream on standard input"))]
    Unreadable {
        /// File, folder or stream.
        name: String,
        /// Why.
        cause: io::Error,
    },
    /// A folder without frames.
    #[error("{name} has no PNG file; expected frames such as frame_0001.png")]
    Empty {
        /// The folder.
        name: String,
    },
    /// A PNG file that is none.
    #[error("{name}: {cause}")]
    #[diagnostic(help("expected a PNG file, grey or in colour, of 1 to 16 bits"))]
    Still {
        /// The file.
        name: String,
        /// What the decoder says.
        cause: String,
    },
    /// A head of a stream that says something else than expected.
    #[error("{name}, header: {what} is {value}; expected {expected}")]
    #[diagnostic(help(
        "a .y4m stream begins as \"YUV4MPEG2 W640 H480 F60:1 Cmono\"; ffmpeg writes one with -f yuv4mpegpipe"
    ))]
    Header {
        /// File or stream.
        name: String,
        /// Which parameter.
        what: &'static str,
        /// As it stands there.
        value: String,
        /// What it could be.
        expected: &'static str,
    },
    /// Something else than a frame follows in a stream.
    #[error("{name}, frame {frame}, byte {byte}: found {found}; expected \"FRAME\"")]
    Mark {
        /// File or stream.
        name: String,
        /// From 0.
        frame: usize,
        /// Of the stream, from 0.
        byte: u64,
        /// What is there.
        found: String,
    },
    /// A stream ends inside a frame.
    #[error("{name}, frame {frame}: ends after {got} of {expected} bytes")]
    #[diagnostic(help("the recording was cut; the frames before are whole"))]
    Cut {
        /// File or stream.
        name: String,
        /// From 0.
        frame: usize,
        /// Bytes that are there.
        got: u64,
        /// Bytes of a frame.
        expected: u64,
    },
}
