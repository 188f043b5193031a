//! Recordings that grow while they are read.

use std::io::Read;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Between two looks at a file or folder that grows.
const PAUSE: Duration = Duration::from_millis(5);

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
    pub fn wait(self) -> bool {
        let Ending::Until(stop) = self else { return false };
        if stop.load(Ordering::Relaxed) {
            return false;
        }
        std::thread::sleep(PAUSE);
        true
    }
}

/// A file that is read as it grows.
pub struct Growing<'a, R> {
    /// The file.
    pub inner: R,
    /// Until when.
    pub ending: Ending<'a>,
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
