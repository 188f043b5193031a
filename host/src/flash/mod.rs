//! Writing firmware and tables into a board's flash through a debug probe.
//!
//! Firmware goes where its ELF says, which must be bank 1; a table goes to slot A in bank 2 after it has passed the
//! same checks as on the board. Every byte is read back, and [`greet`] asks the board that then starts who it is. [`probe_rs::probe::list::Lister`] is a parameter so that the whole
//! path also runs on an emulated probe.

mod brown_out;
mod error;
mod greeting;
mod image;

use probe_rs::flashing::{
    DownloadOptions, ElfLoader, ElfOptions, FlashLoader, FlashProgress, ProgressEvent, ProgressOperation,
};
use probe_rs::probe::DebugProbeInfo;
use probe_rs::probe::list::{Accessibility, Lister};
use probe_rs::{Permissions, Session};

pub use brown_out::{BrownOut, OptionRefusal, set_up};
pub use error::FlashingError;
pub use greeting::{Expected, Greeted, greet};
pub use image::{Firmware, TableImage};

/// The chip of the NUCLEO-F429ZI.
pub const CHIP: &str = "STM32F429ZITx";

/// First byte of flash bank 2: slot A of the tables.
pub const TABLE_ADDRESS: u64 = 0x0810_0000;

/// Length of flash bank 2, bytes.
pub const BANK_2_LEN: u64 = 0x0010_0000;

/// A debug probe that is plugged in.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Found {
    /// What it calls itself.
    pub name: String,
    /// USB vendor and product number.
    pub usb: (u16, u16),
    /// Serial number, by which `--probe` selects it.
    pub serial: Option<String>,
    /// False if this user may not open it.
    pub accessible: bool,
}

/// All debug probes that are plugged in.
pub fn list(lister: &Lister) -> Vec<Found> {
    lister
        .list_all_with_access()
        .into_iter()
        .map(|item| Found {
            name: item.info.identifier.clone(),
            usb: (item.info.vendor_id, item.info.product_id),
            serial: item.info.serial_number.clone(),
            accessible: item.accessibility == Accessibility::Accessible,
        })
        .collect()
}

/// What is to be written, and through which probe.
#[derive(Debug)]
pub struct Job {
    /// Serial number of the probe; `None` takes the only one.
    pub probe: Option<String>,
    /// Name of the chip, e.g. [`CHIP`].
    pub chip: String,
    /// Firmware.
    pub firmware: Option<Firmware>,
    /// Table.
    pub table: Option<TableImage>,
}

/// A step of the writing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step {
    /// Sectors are erased.
    Erase,
    /// Pages are written.
    Write,
    /// Everything is read back.
    Verify,
}

/// How far a step is, in bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StepProgress {
    /// The step.
    pub step: Step,
    /// Bytes done.
    pub done: u64,
    /// Bytes of the step.
    pub total: u64,
}

/// Bytes written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub struct Written {
    /// Of firmware.
    pub firmware_bytes: u64,
    /// Of a table.
    pub table_bytes: u64,
}

/// Writes and verifies a job, then restarts the board.
///
/// # Errors
/// [`FlashingError`]; before anything is erased for everything that can be known before.
pub fn write(lister: &Lister, job: &Job, mut progress: impl FnMut(StepProgress)) -> Result<Written, FlashingError> {
    if job.firmware.is_none() && job.table.is_none() {
        return Err(FlashingError::Nothing);
    }
    let probe = choose(lister, job.probe.as_deref())?;
    let failed = |what, source: Box<dyn std::error::Error + Send + Sync>| FlashingError::Chip {
        chip: job.chip.clone(),
        what,
        source,
    };
    let mut session = lister
        .open(&probe)
        .map_err(|e| failed("open the probe", e.into()))?
        .attach(job.chip.as_str(), Permissions::default())
        .map_err(|e| failed("attach", e.into()))?;
    let (loader, written) = load(&mut session, job)?;
    let mut totals = [0u64; 3];
    let mut done = [0u64; 3];
    let mut options = DownloadOptions::new();
    options.verify = true;
    // Sectors are larger than what is written: what else they hold stays.
    options.keep_unwritten_bytes = job.firmware.is_none();
    options.progress = FlashProgress::new(|event| {
        let (operation, total, size) = match event {
            ProgressEvent::AddProgressBar { operation, total } => (operation, total.unwrap_or(0), 0),
            ProgressEvent::Progress { operation, size, .. } => (operation, 0, size),
            _ => return,
        };
        let (i, step) = match operation {
            ProgressOperation::Erase => (0, Step::Erase),
            ProgressOperation::Program => (1, Step::Write),
            ProgressOperation::Verify => (2, Step::Verify),
            ProgressOperation::Fill => return,
        };
        totals[i] += total;
        done[i] += size;
        progress(StepProgress { step, done: done[i], total: totals[i] });
    });
    loader.commit(&mut session, options).map_err(|e| failed("write flash", e.into()))?;
    session.core(0).and_then(|mut core| core.reset()).map_err(|e| failed("restart", e.into()))?;
    Ok(written)
}

/// The probe that was asked for, or the only one.
fn choose(lister: &Lister, serial: Option<&str>) -> Result<DebugProbeInfo, FlashingError> {
    let mut probes = lister.list_all_with_access();
    if let Some(serial) = serial {
        let found = probes.iter().map(|p| named(&p.info)).collect();
        probes.retain(|p| p.info.serial_number.as_deref() == Some(serial));
        if probes.is_empty() {
            return Err(FlashingError::NoSuchProbe { serial: serial.into(), found });
        }
    }
    if probes.len() > 1 {
        return Err(FlashingError::ManyProbes { found: probes.iter().map(|p| named(&p.info)).collect() });
    }
    match probes.pop() {
        None => Err(FlashingError::NoProbe),
        Some(probe) if probe.accessibility == Accessibility::PermissionDenied => {
            Err(FlashingError::NoPermission { probe: named(&probe.info) })
        }
        Some(probe) => Ok(probe.info),
    }
}

fn named(info: &DebugProbeInfo) -> String {
    format!("{} (serial {})", info.identifier, info.serial_number.as_deref().unwrap_or("unknown"))
}

/// Stages firmware and table.
fn load(session: &mut Session, job: &Job) -> Result<(FlashLoader, Written), FlashingError> {
    let mut loader = session.target().flash_loader();
    let mut written = Written { firmware_bytes: 0, table_bytes: 0 };
    if let Some(firmware) = &job.firmware {
        let refused = |source: Box<dyn std::error::Error + Send + Sync>| FlashingError::Firmware {
            path: firmware.path().into(),
            reason: source.to_string(),
        };
        let mut bytes = std::io::Cursor::new(firmware.bytes());
        loader
            .load_image(session, &mut bytes, ElfLoader(ElfOptions::default()), None)
            .map_err(|e| refused(e.into()))?;
        for (address, data) in loader.data() {
            let end = address + data.len() as u64;
            written.firmware_bytes += data.len() as u64;
            if end > TABLE_ADDRESS && address < TABLE_ADDRESS + BANK_2_LEN {
                return Err(refused(
                    format!(
                        "it wants {address:#010x} to {end:#010x}, but bank 2 from {TABLE_ADDRESS:#010x} belongs to the tables"
                    )
                    .into(),
                ));
            }
        }
    }
    if let Some(table) = &job.table {
        written.table_bytes = table.bytes().len() as u64;
        loader.add_data(TABLE_ADDRESS, table.bytes()).map_err(|e| FlashingError::Chip {
            chip: job.chip.clone(),
            what: "place the table",
            source: e.into(),
        })?;
    }
    Ok((loader, written))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use probe_rs::probe::list::{ProbeListItem, ProbeLister};
    use probe_rs::probe::{DebugProbeError, DebugProbeSelector, Probe};

    #[derive(Debug)]
    struct NoProbes;

    impl ProbeLister for NoProbes {
        fn open(&self, _: &DebugProbeSelector) -> Result<Probe, DebugProbeError> {
            Err(DebugProbeError::NotImplemented { function_name: "open" })
        }
        fn list_with_access(&self, _: Option<&DebugProbeSelector>) -> Vec<ProbeListItem> {
            Vec::new()
        }
    }

    fn job() -> Job {
        Job { probe: None, chip: CHIP.into(), firmware: None, table: None }
    }

    #[test]
    fn without_a_probe_it_says_so_and_what_to_do() {
        let lister = Lister::with_lister(Box::new(NoProbes));
        assert!(list(&lister).is_empty());
        let with_firmware =
            Job { firmware: Some(Firmware::from_bytes("board.elf".as_ref(), b"\x7fELF".to_vec()).unwrap()), ..job() };
        let error = write(&lister, &with_firmware, |_| {}).unwrap_err();
        assert_eq!(
            error.to_string(),
            "no debug probe found: connect a USB cable to the board's ST-LINK connector (CN1) and try again"
        );
        let named = Job { probe: Some("066F".into()), ..with_firmware };
        assert_eq!(
            write(&lister, &named, |_| {}).unwrap_err().to_string(),
            "no debug probe with serial number 066F; found: none"
        );
    }

    #[test]
    fn an_empty_job_is_refused() {
        let lister = Lister::with_lister(Box::new(NoProbes));
        assert_eq!(
            write(&lister, &job(), |_| {}).unwrap_err().to_string(),
            "nothing to write: name an ELF file, or a table with --table"
        );
    }

    #[test]
    fn the_chip_of_the_board_is_known_with_a_second_flash_bank() {
        let registry = probe_rs::config::Registry::from_builtin_families();
        let target = registry.get_target_by_name(CHIP).unwrap();
        let mut loader = target.flash_loader();
        loader.add_data(TABLE_ADDRESS, &[0; 16]).unwrap();
        loader.add_data(TABLE_ADDRESS + BANK_2_LEN - 16, &[0; 16]).unwrap();
        assert!(loader.add_data(TABLE_ADDRESS + BANK_2_LEN, &[0]).is_err());
    }
}
