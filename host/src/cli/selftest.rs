//! `palpate selftest`.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::Args;
use miette::{IntoDiagnostic, miette};
use probe_rs::probe::list::Lister;
use serde_json::json;

use super::answer::agreed;
use super::flash::{real_board, written};
use crate::flash::{CHIP, Firmware, Job};
use crate::link::{Address, FindError, Link, Serial, find_own, find_uart, ports};
use crate::selftest::{self, Check, Outcome, Talk, Usb};

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
    if !arguments.yes && !agreed(QUESTION) {
        return Err(miette!(
            "nothing was driven: the self test drives outputs at full duty, so take everything off the NUCLEO but its three wires, and \
             answer y or pass --yes"
        ));
    }
    // Before anything is written: which board is it?
    let uart = uart(arguments)?;
    let mut image_crc = None;
    if let Some(path) = &arguments.flash {
        let firmware = Firmware::read(path).into_diagnostic()?;
        image_crc = Some(firmware.crc().into_diagnostic()?);
        let job = Job { probe: arguments.probe.clone(), chip: CHIP.into(), firmware: Some(firmware), table: None };
        written(&Lister::new(), &job, arguments.json)?;
    }
    let link = crate::link::open(&uart).into_diagnostic()?;
    let usb = usb(arguments.usb.as_ref())?;
    let show = |check: &Check| {
        if !arguments.json {
            outln!("{}", check.line());
        }
    };
    let checks = selftest::run(&mut Talk::new(link), usb, image_crc, show).into_diagnostic()?;
    Ok(conclude(&checks, arguments.json))
}

/// Where the UART is: for `auto` the port of the probe, not the board's own.
fn uart(arguments: &Arguments) -> miette::Result<Address> {
    if arguments.board != Address::Auto {
        return Ok(arguments.board.clone());
    }
    let ports = ports().into_diagnostic()?;
    Ok(Address::Serial(find_uart(&ports, arguments.probe.as_deref()).into_diagnostic()?.path.clone()))
}

/// How long USB may take to enumerate a program that was just written.
const ENUMERATED: Duration = Duration::from_secs(5);

/// The second link, where it is asked for.
fn usb(address: Option<&Address>) -> miette::Result<Usb<Box<dyn Link>>> {
    let Some(address) = address else { return Ok(Usb::NotAsked) };
    if *address != Address::Auto {
        return Ok(Usb::At(crate::link::open(address).into_diagnostic()?));
    }
    let until = Instant::now() + ENUMERATED;
    loop {
        match find_own(&ports().into_diagnostic()?) {
            Ok(port) => {
                return Ok(Usb::At(Box::new(Serial::open(&port.path).into_diagnostic()?)));
            }
            Err(_) if Instant::now() < until => std::thread::sleep(Duration::from_millis(100)),
            Err(FindError::Several(found)) => return Ok(Usb::Missing(format!("{} ports with 1209:0001", found.len()))),
            Err(_) => return Ok(Usb::Missing("no port with 1209:0001".into())),
        }
    }
}

/// What must be so before anything is driven.
const QUESTION: &str = "This drives PC6, PE9, PE11, PD14 and PD15 at full duty, and erases a sector of the tables.\n\
                        Is nothing connected to the NUCLEO but the three wires of docs/selftest.md?";

/// The summary, and the exit status.
fn conclude(checks: &[Check], json: bool) -> u8 {
    let count = |outcome| checks.iter().filter(|check| check.outcome == outcome).count();
    let (passed, failed, left) = (count(Outcome::Passed), count(Outcome::Failed), count(Outcome::NotTested));
    if json {
        outln!("{}", json!({ "passed": passed, "failed": failed, "not_tested": left, "checks": checks }));
    } else {
        outln!("\n{passed} passed, {failed} failed, {left} not tested");
    }
    if failed > 0 { FAILED } else { 0 }
}
