//! The Cortex-M4F: instructions by the unicorn emulator, exceptions, sleep and time by ours.

mod cost;
mod debug;
mod exception;
mod memory;
mod trap;

use unicorn_engine::{Arch, ArmCpuModel, Mode, RegisterARM, Unicorn, uc_error};

use crate::chip::{Change, Chip, FLASH_BASE, FLASH_LEN, HARD_FAULT, Reset, Wiring};
use crate::elf::Image;
use crate::time::{SECOND, Time};

use cost::Cost;
pub use trap::{Deed, Trap};

/// RAM of the linker's map.
pub(crate) const RAM_BASE: u32 = 0x2000_0000;
pub(crate) const RAM_LEN: usize = 192 << 10;

/// Never reached: there is no memory.
const NOWHERE: u64 = 0xf000_0000;

/// Numbers that unicorn gives to what ends a block (QEMU's `EXCP_UDEF`, `EXCP_PREFETCH_ABORT`,
/// `EXCP_BKPT` and `EXCP_EXCEPTION_EXIT`).
const UNDEFINED: u32 = 1;
const PREFETCH_ABORT: u32 = 3;
const BREAKPOINT: u32 = 7;
const EXCEPTION_RETURN: u32 = 8;

/// What the emulator's hooks share with the core.
struct Shared {
    chip: Chip,
    cost: Cost,
    /// Time up to which the core was told to run.
    until: Time,
    /// The block at which emulation stopped, whose time has been counted.
    counted: Option<u64>,
    /// The event register of WFE.
    event: bool,
    /// A sleep instruction was reached.
    sleeping: bool,
    /// An exception return was reached.
    returning: bool,
    /// A breakpoint was reached.
    breakpoint: bool,
    /// A fault was raised: unicorn's number for it.
    faulted: Option<u32>,
    /// Changes of the flash, while somebody wants to know them.
    flash_log: Option<Vec<Change>>,
    /// Injected fault.
    trap: Option<Trap>,
    /// The trap's place was reached.
    trapped: bool,
}

/// How the core spends its time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Activity {
    Running,
    /// In WFE or WFI.
    Sleeping,
    /// At an injected hang: time passes, interrupts are served unless masked.
    Hung,
    /// In the hands of a debugger: no time passes.
    Halted,
    /// A fault in a fault: only a reset helps (ARMv7-M ARM, B1.5.15).
    LockedUp,
}

/// Bits of the configurable fault status register (ARMv7-M ARM, B3.2.15) for a fault that unicorn
/// raised: of a fetch, of an instruction, else of data.
fn fault_status(raised: Option<u32>) -> u32 {
    match raised {
        Some(PREFETCH_ABORT) => 1 << 8,
        Some(UNDEFINED) => 1 << 16,
        _ => 1 << 9,
    }
}

/// Something that stops the emulation for good.
#[derive(Debug, thiserror::Error)]
pub enum CoreError {
    /// The CPU emulator failed.
    #[error("the CPU emulator failed at {pc:#010x}: {source:?}")]
    Emulator {
        /// Where the program was.
        pc: u32,
        /// What it said.
        source: uc_error,
    },
}

/// Core, memory and chip.
pub struct Core {
    uc: Unicorn<'static, Shared>,
    activity: Activity,
    /// When a hang ends by itself.
    held_until: Option<Time>,
    /// Depth of nested exceptions above which a hung program waits.
    hung_below: Option<usize>,
    /// A debugger is connected, and wants the core halted after a reset.
    debugged: bool,
    catch_reset: bool,
    at_breakpoint: bool,
    /// Reset causes since the start, in order.
    resets: Vec<(Time, Reset)>,
}

impl Core {
    /// A core with `image` in its flash, powered on.
    ///
    /// # Errors
    /// [`CoreError`] when the CPU emulator cannot be set up.
    pub fn new(image: &Image, wiring: Box<dyn Wiring>, lsi_hz: u64) -> Result<Self, CoreError> {
        let failed = |source| CoreError::Emulator { pc: 0, source };
        let mut code = Vec::new();
        for (address, bytes) in &image.segments {
            let at = (address - FLASH_BASE) as usize;
            code.resize(code.len().max(at + bytes.len()), 0xff);
            code[at..at + bytes.len()].copy_from_slice(bytes);
        }
        let cost = Cost::new(code.clone());
        let (sleeps, wakes) = ([0xbf20, 0xbf30].map(|op| cost.halfwords(op)).concat(), cost.halfwords(0xbf40));
        let shared = Shared {
            chip: Chip::new(wiring, lsi_hz),
            cost,
            until: 0,
            counted: None,
            event: false,
            sleeping: false,
            returning: false,
            breakpoint: false,
            faulted: None,
            flash_log: None,
            trap: None,
            trapped: false,
        };
        let mut uc = Unicorn::new_with_data(Arch::ARM, Mode::THUMB | Mode::MCLASS, shared).map_err(failed)?;
        uc.ctl_set_cpu_model(ArmCpuModel::CORTEX_M4 as i32).map_err(failed)?;
        memory::map(&mut uc).map_err(failed)?;
        let mut core = Core {
            uc,
            activity: Activity::Running,
            held_until: None,
            hung_below: None,
            debugged: false,
            catch_reset: false,
            at_breakpoint: false,
            resets: Vec::new(),
        };
        core.hook(&sleeps, &wakes).map_err(failed)?;
        core.set_flash(0, &vec![0xff; FLASH_LEN])?;
        core.set_flash(0, &code)?;
        core.reset(Reset::Power)?;
        Ok(core)
    }

    fn hook(&mut self, sleeps: &[u32], wakes: &[u32]) -> Result<(), uc_error> {
        let uc = &mut self.uc;
        uc.add_block_hook(1, 0, |uc, address, size| {
            let shared = uc.get_data_mut();
            if shared.counted.take() != Some(address) {
                let clocks = shared.cost.half_clocks(address as u32, size, shared.chip.flash_is_slow());
                shared.chip.now += clocks * (SECOND / 2) / shared.chip.core_hz();
            }
            if memory::settle(uc) {
                uc.get_data_mut().counted = Some(address);
                let _ = uc.emu_stop();
            }
        })?;
        for &address in sleeps {
            uc.add_code_hook(address.into(), address.into(), |uc, _, _| {
                uc.get_data_mut().sleeping = true;
                let _ = uc.emu_stop();
            })?;
        }
        for &address in wakes {
            uc.add_code_hook(address.into(), address.into(), |uc, _, _| uc.get_data_mut().event = true)?;
        }
        uc.add_intr_hook(|uc, number| {
            // Everything else (undefined, SVC) is none of the image's.
            let shared = uc.get_data_mut();
            match number {
                EXCEPTION_RETURN => shared.returning = true,
                BREAKPOINT => shared.breakpoint = true,
                _ => shared.faulted = Some(number),
            }
            let _ = uc.emu_stop();
        })?;
        Ok(())
    }

    /// The chip.
    pub fn chip(&self) -> &Chip {
        &self.uc.get_data().chip
    }

    /// The chip, to change what surrounds it.
    pub fn chip_mut(&mut self) -> &mut Chip {
        &mut self.uc.get_data_mut().chip
    }

    /// Resets since the start and when they were; the first is the power coming.
    pub fn resets(&self) -> &[(Time, Reset)] {
        &self.resets
    }

    /// Instructions executed since the start.
    pub fn instructions(&self) -> u64 {
        self.uc.get_data().cost.instructions
    }

    /// Lets every instruction take so many half clocks, whatever the flash's accelerator does;
    /// `None` ends it.
    pub fn assume_half_clocks(&mut self, half_clocks: Option<u64>) {
        self.uc.get_data_mut().cost.assumed = half_clocks;
    }

    /// Runs until `until`.
    ///
    /// # Errors
    /// [`CoreError`].
    pub fn run(&mut self, until: Time) -> Result<(), CoreError> {
        self.uc.get_data_mut().until = until;
        while self.chip().now < until {
            if let Some(cause) = self.chip_mut().reset.take() {
                self.reset(cause)?;
            }
            if self.activity == Activity::Halted {
                break;
            }
            self.take_exception()?;
            let now = self.chip().now;
            if self.activity == Activity::Hung && self.held_until.take_if(|at| *at <= now).is_some() {
                self.activity = Activity::Running;
            }
            match self.activity {
                Activity::Running => self.execute()?,
                _ => self.wait(until),
            }
        }
        Ok(())
    }

    /// Lets time pass without instructions, until the next event.
    fn wait(&mut self, until: Time) {
        if self.activity == Activity::Sleeping && std::mem::take(&mut self.uc.get_data_mut().event) {
            self.activity = Activity::Running;
            return;
        }
        let held_until = self.held_until.filter(|_| self.activity == Activity::Hung).unwrap_or(Time::MAX);
        let chip = self.chip_mut();
        chip.now = chip.due.min(until).min(held_until).max(chip.now);
        memory::settle(&mut self.uc);
    }

    fn execute(&mut self) -> Result<(), CoreError> {
        let pc = self.register(RegisterARM::PC)?;
        let result = self.uc.emu_start(u64::from(pc | 1), NOWHERE, 0, 0);
        let at = self.register(RegisterARM::PC)?;
        let shared = self.uc.get_data_mut();
        let returning = std::mem::take(&mut shared.returning) || at >= 0xffff_ff00;
        let breakpoint = std::mem::take(&mut shared.breakpoint);
        let faulted = std::mem::take(&mut shared.faulted);
        let trapped = std::mem::take(&mut shared.trapped);
        let sleeping = std::mem::take(&mut shared.sleeping);
        if returning {
            return self.leave_exception(at);
        }
        if breakpoint && self.debugged {
            self.activity = Activity::Halted;
            self.at_breakpoint = true;
            return Ok(());
        }
        if faulted.is_some() || breakpoint || result.is_err() {
            let undefined = (result == Err(uc_error::INSN_INVALID)).then_some(UNDEFINED);
            self.chip_mut().nvic.set_fault_status(fault_status(undefined.or(faulted)));
            return self.fault();
        }
        if trapped {
            return self.spring();
        }
        if sleeping {
            // Past the instruction, which is two bytes long.
            self.set_register(RegisterARM::PC, (at + 2) | 1)?;
            self.activity = Activity::Sleeping;
        }
        Ok(())
    }

    fn register(&self, register: RegisterARM) -> Result<u32, CoreError> {
        self.uc.reg_read(register).map(|v| v as u32).map_err(|source| CoreError::Emulator { pc: 0, source })
    }

    fn set_register(&mut self, register: RegisterARM, value: u32) -> Result<(), CoreError> {
        self.uc.reg_write(register, value.into()).map_err(|e| self.failed(e))
    }

    fn failed(&self, source: uc_error) -> CoreError {
        CoreError::Emulator { pc: self.uc.pc_read().unwrap_or(0) as u32, source }
    }

    /// Resets the chip, which is moved out of the shared state for that.
    fn replace_chip(&mut self, cause: Reset) {
        let shared = self.uc.get_data_mut();
        shared.event = false;
        shared.counted = None;
        shared.chip.reset_to(cause);
        self.held_until = None;
    }

    fn fault(&mut self) -> Result<(), CoreError> {
        if self.chip().nvic.running() < 0 {
            self.activity = Activity::LockedUp;
            return Ok(());
        }
        self.enter_exception(HARD_FAULT)
    }
}
