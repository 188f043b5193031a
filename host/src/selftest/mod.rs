//! The self test of a bare NUCLEO: asks the self-test program to set and measure, and judges what it says.
//!
//! Steps, wires and the source of every limit: `docs/selftest.md`. What the program measures is judged here, so that a
//! limit is one number in one place and a page can say what was expected.

mod check;
mod chip;
mod ends;
mod error;
mod memory;
mod talk;
mod wires;

pub use check::{Check, Result as CheckResult, Step};
pub use error::SelftestError;
pub use talk::Talk;

use crate::link::Link;

/// Runs every step, and hands out each check as it is made. A step that needs a second link is not tested without.
///
/// # Errors
/// [`SelftestError`] when the program cannot be talked to; a check that fails is none.
pub fn run<L: Link, U: Link>(
    talk: &mut Talk<L>,
    usb: Option<&mut Talk<U>>,
    mut tell: impl FnMut(&Check),
) -> Result<Vec<Check>, SelftestError> {
    let mut checks = Vec::new();
    let mut keep = |made: Vec<Check>| {
        made.iter().for_each(&mut tell);
        checks.extend(made);
    };
    let identity = talk.identify()?;
    keep(chip::chip(&identity));
    keep(chip::clock(talk)?);
    keep(chip::converter(talk)?);
    keep(wires::wires(talk)?);
    keep(wires::pins(talk)?);
    keep(memory::computed(talk)?);
    keep(memory::flash(talk, &identity)?);
    keep(chip::echo(talk, "UART")?);
    keep(match usb {
        Some(usb) => chip::echo(usb, "USB")?,
        None => vec![Check::not_tested(Step::Links, "USB", "name its port with --usb")],
    });
    keep(ends::interlock(talk)?);
    for way in ends::WAYS {
        keep(ends::end(talk, way)?);
    }
    Ok(checks)
}
