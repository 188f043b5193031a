//! A file that grows by whole pieces.

use std::fs::File;
use std::io::{self, Write};

/// Collects what is written, and brings it to the file at once when flushed. A piece that does not fit (a full disk, a
/// size limit) is taken back whole, so that the file ends where the last complete piece ended.
#[derive(Debug)]
pub(super) struct WholeFile {
    file: File,
    /// Bytes of complete pieces in the file.
    good: u64,
    piece: Vec<u8>,
}

impl WholeFile {
    /// Goes on at the beginning of a file that is empty.
    pub(super) fn new(file: File) -> Self {
        WholeFile { file, good: 0, piece: Vec::new() }
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
        let written = self.file.write_all(&self.piece);
        if let Err(cause) = written {
            // The first error is the one to tell. The position goes back with the end.
            let _ = self.file.set_len(self.good).and_then(|()| io::Seek::seek(&mut self.file, io::SeekFrom::End(0)));
            return Err(cause);
        }
        self.good += self.piece.len() as u64;
        self.piece.clear();
        Ok(())
    }
}
