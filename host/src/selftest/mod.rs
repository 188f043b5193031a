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

pub use check::{Check, Outcome, Step};
pub use error::SelftestError;
pub use talk::Talk;

use protocol::selftest::Identity;

use crate::link::Link;

/// The program's second link.
#[derive(Debug)]
pub enum Usb<U> {
    /// Nobody asked for it.
    NotAsked,
    /// It was asked for and is not there: what was found instead.
    Missing(String),
    /// An open link.
    At(U),
}

/// A step over the first link.
type Run<L> = fn(&mut Talk<L>, &Identity) -> Result<Vec<Check>, SelftestError>;

/// Runs every step, and hands out each check as it is made. `image_crc` is that of the program that was written. A step
/// that gets no answer has failed; the test goes on if the program answers again, and ends if it does not.
///
/// # Errors
/// [`SelftestError`] when the program cannot be talked to at the beginning; a check that fails is none.
pub fn run<L: Link, U: Link>(
    talk: &mut Talk<L>,
    usb: Usb<U>,
    image_crc: Option<u32>,
    mut tell: impl FnMut(&Check),
) -> Result<Vec<Check>, SelftestError> {
    let identity = talk.identify()?;
    let began_s = talk.now_s();
    let mut checks = Vec::new();
    let mut keep = |made: Vec<Check>| {
        made.iter().for_each(&mut tell);
        checks.extend(made);
    };
    keep(vec![chip::program(&identity, image_crc)]);
    keep(chip::chip(&identity));
    let steps: [(Step, Run<L>); 7] = [
        (Step::Chip, |talk, _| chip::clock(talk)),
        (Step::Converter, |talk, _| chip::converter(talk)),
        (Step::Wires, |talk, _| wires::wires(talk)),
        (Step::Pins, |talk, _| wires::pins(talk)),
        (Step::Arithmetic, |talk, _| memory::computed(talk)),
        (Step::Flash, memory::flash),
        (Step::Links, |talk, _| chip::echo(talk, "UART")),
    ];
    let mut alive = true;
    for (step, run) in steps {
        if alive {
            let result = run(talk, &identity);
            alive = made(talk, step, result, &mut keep);
        }
    }
    keep(match usb {
        Usb::NotAsked => vec![Check::not_tested(Step::Links, "USB", "name its port with --usb")],
        Usb::Missing(found) => vec![Check::new(Step::Links, "USB", found, "its port within 5 s", false)],
        Usb::At(link) => {
            chip::echo(&mut Talk::new(link), "USB").unwrap_or_else(|error| vec![no_answer(Step::Links, &error)])
        }
    });
    if alive {
        let result = chip::no_reset(talk, &identity, began_s);
        alive = made(talk, Step::Chip, result, &mut keep);
    }
    if alive {
        let result = ends::interlock(talk);
        alive = made(talk, Step::Interlock, result, &mut keep);
    }
    for way in ends::WAYS {
        if alive {
            let result = ends::end(talk, way);
            alive = made(talk, Step::Ends, result, &mut keep);
        }
    }
    Ok(checks)
}

/// Keeps what a step has found; false if the program answers no more.
fn made<L: Link>(
    talk: &mut Talk<L>,
    step: Step,
    result: Result<Vec<Check>, SelftestError>,
    keep: &mut impl FnMut(Vec<Check>),
) -> bool {
    let error = match result {
        Ok(checks) => {
            keep(checks);
            return true;
        }
        Err(error) => error,
    };
    keep(vec![no_answer(step, &error)]);
    match talk.identify() {
        Ok(next) => {
            let found = format!("start by {:?}, the run before ended by {:?}", next.reset_cause, next.last_run.end);
            keep(vec![Check::new(step, "after it", found, "no new start", false)]);
            true
        }
        Err(_) => false,
    }
}

fn no_answer(step: Step, error: &SelftestError) -> Check {
    let found = match error {
        SelftestError::NoAnswer { request, waited_s, .. } => format!("none to {request} within {waited_s:.1} s"),
        other => other.to_string(),
    };
    Check::new(step, "answer", found, "an answer", false)
}
