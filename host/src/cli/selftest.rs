//! `palpate selftest`.

use std::io::IsTerminal;
use std::path::PathBuf;

use clap::Args;
use miette::{IntoDiagnostic, miette};
use probe_rs::probe::list::Lister;
use serde_json::json;

use super::flash::{real_board, written};
use crate::flash::{CHIP, Firmware, Job};
use crate::link::{Address, Link, Serial, find_uart, ports};
use crate::selftest::{self, Check, CheckResult, Talk};

/// Exit status of a test in which a check failed.
const FAILED: u8 = 1;

/// Where the NUCLEO is.
#[derive(Debug, Args)]
#[command(after_help = "Wires, steps and limits: docs/selftest.md. The program is built by\n\
cargo build --profile board --target thumbv7em-none-eabihf -p firmware --features board\n\
and lies beside the firmware as `selftest`. It stays on the board: palpate flash ELF puts the firmware back.\n\
Exit status: 0 every check passed, 1 one failed, 2 bad input or no answer.")]
pub struct Arguments {
    /// The NUCLEO's UART: auto (the one ST-LINK), serial:PATH or tcp:HOST:PORT
    #[arg(long, default_value = "auto", value_name = "LINK", value_parser = real_board)]
    board: Address,
    /// Its USB port as well, where a second cable is in: auto or serial:PATH
    #[arg(long, value_name = "LINK", value_parser = real_board)]
    usb: Option<Address>,
    /// Write the self-test program first: an ELF file
    #[arg(long, value_name = "ELF")]
    flash: Option<PathBuf>,
    /// Serial number of the probe, where there are several
    #[arg(long, value_name = "SERIAL", requires = "flash")]
    probe: Option<String>,
    /// Nothing but the three wires is connected: do not ask
    #[arg(long)]
    yes: bool,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

/// Tests, and tells the exit status.
///
/// # Errors
/// No yes, no board, or one that runs something else.
pub fn run(arguments: &Arguments) -> miette::Result<u8> {
    if !arguments.yes && !agreed() {
        return Err(miette!(
            "nothing was driven: the self test drives outputs at full duty, so take everything off the NUCLEO but its three wires, and \
             answer y or pass --yes"
        ));
    }
    if let Some(path) = &arguments.flash {
        let job = Job {
            probe: arguments.probe.clone(),
            chip: CHIP.into(),
            firmware: Some(Firmware::read(path).into_diagnostic()?),
            table: None,
        };
        written(&Lister::new(), &job, arguments.json)?;
    }
    let link: Box<dyn Link> = match &arguments.board {
        Address::Auto => {
            let ports = ports().into_diagnostic()?;
            Box::new(Serial::open(&find_uart(&ports).into_diagnostic()?.path).into_diagnostic()?)
        }
        address => crate::link::open(address).into_diagnostic()?,
    };
    let mut usb = match &arguments.usb {
        Some(address) => Some(Talk::new(crate::link::open(address).into_diagnostic()?)),
        None => None,
    };
    let show = |check: &Check| {
        if !arguments.json {
            outln!("{}", check.line());
        }
    };
    let checks = selftest::run(&mut Talk::new(link), usb.as_mut(), show).into_diagnostic()?;
    Ok(conclude(&checks, arguments.json))
}

/// The question; without a terminal nobody can be asked.
fn agreed() -> bool {
    if !(std::io::stdin().is_terminal() && std::io::stderr().is_terminal()) {
        return false;
    }
    errln!(
        "This drives PC6, PE9, PE11, PD14 and PD15 at full duty, and erases a sector of the tables.\n\
         Is nothing connected to the NUCLEO but the three wires of docs/selftest.md? [y/N]"
    );
    let mut answer = String::new();
    std::io::stdin().read_line(&mut answer).is_ok() && matches!(answer.trim(), "y" | "Y" | "yes")
}

/// The summary, and the exit status.
fn conclude(checks: &[Check], json: bool) -> u8 {
    let count = |result| checks.iter().filter(|check| check.result == result).count();
    let (passed, failed, left) =
        (count(CheckResult::Passed), count(CheckResult::Failed), count(CheckResult::NotTested));
    if json {
        outln!("{}", json!({ "passed": passed, "failed": failed, "not_tested": left, "checks": checks }));
    } else {
        outln!("\n{passed} passed, {failed} failed, {left} not tested");
    }
    if failed > 0 { FAILED } else { 0 }
}
