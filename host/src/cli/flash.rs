//! `palpate flash`.

use std::path::{Path, PathBuf};

use clap::Args;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use miette::IntoDiagnostic;
use probe_rs::probe::list::Lister;
use serde_json::json;

use super::answer::{agreed, can_ask};
use crate::flash::{self, BrownOut, CHIP, Expected, Firmware, Greeted, Job, Step, StepProgress, TableImage, Written};
use crate::link::Address;

/// What to write, and through which probe.
#[derive(Debug, Args)]
pub struct Arguments {
    /// List the debug probes that are plugged in, and write nothing
    #[arg(long)]
    list: bool,
    /// Serial number of the probe, where there are several
    #[arg(long, value_name = "SERIAL")]
    probe: Option<String>,
    /// The chip
    #[arg(long, default_value = CHIP)]
    chip: String,
    /// Set the chip up, once for each board: reset below 2.8 V (brown-out level 3); asks first, and
    /// writes nothing else
    #[arg(long, conflicts_with_all = ["list", "elf", "table", "board"])]
    setup: bool,
    /// Firmware, an ELF file
    elf: Option<PathBuf>,
    /// Write the firmware to this file instead, as a raw image for drag and drop or DFU, and touch no board
    #[arg(long, value_name = "FILE", requires = "elf", conflicts_with_all = ["list", "table", "board", "probe"])]
    bin: Option<PathBuf>,
    /// Look-up table, as `palpate lut` writes it
    #[arg(long, value_name = "FILE")]
    table: Option<PathBuf>,
    /// Then greet the board over this link and compare versions: auto, tcp:HOST:PORT or serial:PATH
    #[arg(long, value_name = "LINK", value_parser = real_board)]
    board: Option<Address>,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

/// Lists probes, or writes and verifies.
///
/// # Errors
/// No probe, a file that is not what it should be, or a chip that cannot be written.
pub fn run(arguments: &Arguments) -> miette::Result<()> {
    let lister = Lister::new();
    if arguments.list {
        return list(&lister, arguments.json);
    }
    if arguments.setup {
        return set_up(&lister, arguments);
    }
    if let (Some(bin), Some(elf)) = (&arguments.bin, &arguments.elf) {
        return raw_image(elf, bin, arguments.json);
    }
    let job = Job {
        probe: arguments.probe.clone(),
        chip: arguments.chip.clone(),
        firmware: arguments.elf.as_deref().map(Firmware::read).transpose().into_diagnostic()?,
        table: arguments.table.as_deref().map(TableImage::read).transpose().into_diagnostic()?,
    };
    let written = written(&lister, &job, arguments.json)?;
    let greeted = match &arguments.board {
        Some(address) => {
            let expected = Expected {
                image_crc: job.firmware.as_ref().map(Firmware::crc).transpose().into_diagnostic()?,
                table_hash: job.table.as_ref().map(TableImage::hash),
            };
            Some(flash::greet(|| crate::link::open(address), &expected).into_diagnostic()?)
        }
        None => None,
    };
    match &greeted {
        _ if arguments.json => outln!(
            "{}",
            json!({ "firmware_bytes": written.firmware_bytes, "table_bytes": written.table_bytes, "greeted": greeted })
        ),
        Some(Greeted { firmware_version: [major, minor, patch], protocol_version, .. }) => {
            outln!("started: firmware {major}.{minor}.{patch}, protocol {protocol_version}, as written");
        }
        None => outln!("not greeted: with --board LINK the version of the board that starts is compared"),
    }
    Ok(())
}

/// Writes the raw image, and says how it gets onto a board.
fn raw_image(elf: &Path, bin: &Path, json: bool) -> miette::Result<()> {
    let firmware = Firmware::read(elf).into_diagnostic()?;
    let (image, crc) = (firmware.raw().into_diagnostic()?, firmware.crc().into_diagnostic()?);
    super::file::save(bin, &image)?;
    if json {
        outln!("{}", json!({ "bin": bin, "bytes": image.len(), "image_crc": crc }));
    } else {
        outln!(
            "{}: {} bytes, CRC {crc:08x}. Copy it to the NUCLEO's drive, or with BOOT0 high and the user USB port:\n\
             dfu-util -a 0 -s 0x08000000:leave -D {}\n\
             Then take BOOT0 low again: with it high every reset starts the boot loader, not the firmware.",
            bin.display(),
            image.len(),
            bin.display()
        );
    }
    Ok(())
}

/// Writes a job with a bar, and tells what was written unless it is told as `json`.
pub(super) fn written(lister: &Lister, job: &Job, json: bool) -> miette::Result<Written> {
    let mut bar: Option<(Step, ProgressBar)> = None;
    let written = flash::write(lister, job, |p| show(&mut bar, p)).into_diagnostic()?;
    if let Some((_, bar)) = bar {
        bar.finish();
    }
    if !json {
        outln!(
            "written and verified: {} bytes of firmware, {} bytes of table",
            written.firmware_bytes,
            written.table_bytes
        );
    }
    Ok(written)
}

/// Sets the brown-out level after a yes.
fn set_up(lister: &Lister, arguments: &Arguments) -> miette::Result<()> {
    let outcome = flash::set_up(lister, arguments.probe.as_deref(), &arguments.chip, ask).into_diagnostic()?;
    if arguments.json {
        outln!("{}", json!({ "brown_out": outcome }));
        return Ok(());
    }
    outln!(
        "{}",
        match outcome {
            BrownOut::Already => "brown-out level 3 is set already: nothing was written",
            BrownOut::Written => "brown-out level 3 is set and read back",
            BrownOut::Declined if can_ask() => "nothing was written",
            BrownOut::Declined => "nothing was written: it is asked first, so run this in a terminal",
        }
    );
    Ok(())
}

/// The question of the setup.
fn ask(level: u8) -> bool {
    let now = if level == 0 { "no brown-out reset".into() } else { format!("brown-out level {level}") };
    agreed(&format!(
        "The chip has {now}. Set level 3 (reset below 2.8 V)?\n\
         This writes its option bytes; read protection and write protection stay as they are. Keep it powered."
    ))
}

/// A board that a probe can write.
pub(super) fn real_board(text: &str) -> Result<Address, String> {
    match text.parse() {
        Ok(Address::Simulated) => {
            Err("the simulated board has no flash to write: expected auto, tcp:HOST:PORT or serial:PATH".into())
        }
        Ok(address) => Ok(address),
        Err(error) => Err(error.to_string()),
    }
}

fn list(lister: &Lister, json: bool) -> miette::Result<()> {
    let found = flash::list(lister);
    if json {
        outln!("{}", json!({ "probes": found }));
        return Ok(());
    }
    if found.is_empty() {
        outln!("no debug probe found");
    }
    for probe in found {
        let serial = probe.serial.as_deref().unwrap_or("unknown");
        let access = if probe.accessible { "" } else { "  (no permission to open it)" };
        outln!("{}  serial {serial}  USB {:04x}:{:04x}{access}", probe.name, probe.usb.0, probe.usb.1);
    }
    Ok(())
}

fn show(bar: &mut Option<(Step, ProgressBar)>, progress: StepProgress) {
    if bar.as_ref().is_none_or(|(step, _)| *step != progress.step) {
        let fresh = ProgressBar::with_draw_target(Some(progress.total), ProgressDrawTarget::stderr());
        if let Ok(style) = ProgressStyle::with_template("{msg:8} [{bar:30}] {bytes}/{total_bytes}, {eta} left") {
            fresh.set_style(style.progress_chars("=> "));
        }
        fresh.set_message(match progress.step {
            Step::Erase => "erase",
            Step::Write => "write",
            Step::Verify => "verify",
        });
        if let Some((_, done)) = bar.replace((progress.step, fresh)) {
            done.finish();
        }
    }
    if let Some((_, bar)) = bar {
        bar.set_length(progress.total);
        bar.set_position(progress.done);
    }
}
