//! What commands print: results to standard output, messages to standard error.
//!
//! A reader that has left (`palpate diagnose FOLDER | head`, a window that was closed) ends nothing: reports are still written and outputs still switched off. A standard output
//! that refuses for another reason, a full disk say, is an error of the command at its end. The standard library's `println!` would panic in both.

use std::fmt::Arguments;
use std::io::{self, ErrorKind, Write};
use std::sync::Mutex;

/// The first error of standard output that is not a reader who has left.
static REFUSED: Mutex<Option<io::Error>> = Mutex::new(None);

/// Writes to standard output; prefer [`outln!`].
pub(crate) fn out(text: Arguments<'_>) {
    keep(&REFUSED, io::stdout().write_fmt(text));
}

/// Writes to standard error, where nothing is left to tell an error to; prefer [`errln!`].
pub(crate) fn err(text: Arguments<'_>) {
    let _ = io::stderr().write_fmt(text);
}

/// What standard output did not take.
///
/// # Errors
/// The first thing that it refused for another reason than that nobody reads it.
pub(crate) fn finish() -> io::Result<()> {
    keep(&REFUSED, io::stdout().flush());
    REFUSED.lock().map_or(Ok(()), |mut refused| refused.take().map_or(Ok(()), Err))
}

fn keep(refused: &Mutex<Option<io::Error>>, written: io::Result<()>) {
    let Err(error) = written else { return };
    if error.kind() != ErrorKind::BrokenPipe
        && let Ok(mut refused) = refused.lock()
    {
        refused.get_or_insert(error);
    }
}

/// Writes a line to standard output.
macro_rules! outln {
    ($($text:tt)*) => { $crate::print::out(format_args!("{}\n", format_args!($($text)*))) };
}

/// Writes a line to standard error.
macro_rules! errln {
    ($($text:tt)*) => { $crate::print::err(format_args!("{}\n", format_args!($($text)*))) };
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn the_first_refusal_is_kept_and_a_reader_who_has_left_is_none() {
        let refused = Mutex::new(None);
        keep(&refused, Ok(()));
        keep(&refused, Err(ErrorKind::BrokenPipe.into()));
        assert!(refused.lock().unwrap().is_none());
        keep(&refused, Err(ErrorKind::StorageFull.into()));
        keep(&refused, Err(ErrorKind::Other.into()));
        assert_eq!(refused.lock().unwrap().as_ref().map(io::Error::kind), Some(ErrorKind::StorageFull));
    }
}
