//! A file that grows by whole pieces.

use std::fs::File;
use std::io::{self, Seek, SeekFrom, Write};

/// Collects what is written, and brings it to the file at once when flushed. Of a piece that does not fit (a full disk, a
/// size limit) the torn end is taken back, so that the file ends where something complete ended.
#[derive(Debug)]
pub(super) struct WholeFile {
    file: File,
    /// Bytes of complete pieces in the file.
    good: u64,
    piece: Vec<u8>,
    /// Length of what is complete in the beginning of a piece.
    complete: fn(&[u8]) -> usize,
}

/// Lines are complete by themselves.
pub(super) fn whole_lines(torn: &[u8]) -> usize {
    torn.iter().rposition(|byte| *byte == b'\n').map_or(0, |at| at + 1)
}

/// Nothing of a torn piece is of use.
pub(super) fn all_or_nothing(_: &[u8]) -> usize {
    0
}

impl WholeFile {
    /// Goes on at the beginning of a file that is empty.
    pub(super) fn new(file: File, complete: fn(&[u8]) -> usize) -> Self {
        WholeFile { file, good: 0, piece: Vec::new(), complete }
    }

    /// Bytes collected and not yet written.
    pub(super) fn collected(&self) -> usize {
        self.piece.len()
    }

    /// Waits until what was flushed is on the disk.
    pub(super) fn sync(&self) -> io::Result<()> {
        self.file.sync_data()
    }
}

impl Write for WholeFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.piece.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        if self.piece.is_empty() {
            return Ok(());
        }
        if let Err(cause) = self.file.write_all(&self.piece) {
            // The first error is the one to tell.
            let _ = self.cut();
            return Err(cause);
        }
        self.good += self.piece.len() as u64;
        self.piece.clear();
        Ok(())
    }
}

impl WholeFile {
    /// Takes the torn end of a piece back from the file; what is complete of it stays there.
    fn cut(&mut self) -> io::Result<()> {
        let written = self.file.metadata()?.len().saturating_sub(self.good) as usize;
        let complete = (self.complete)(self.piece.get(..written).unwrap_or(&self.piece));
        self.good += complete as u64;
        self.piece.drain(..complete);
        self.file.set_len(self.good)?;
        self.file.seek(SeekFrom::Start(self.good)).map(|_| ())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_a_torn_piece_lines_stay_and_a_chunk_does_not() {
        assert_eq!(whole_lines(b"one\ntwo\nthr"), 8);
        assert_eq!(whole_lines(b"one"), 0);
        assert_eq!(all_or_nothing(b"one\n"), 0);
    }
}
