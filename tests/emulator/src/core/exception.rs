//! Exception entry and return, and reset (ARMv7-M ARM, B1.5).

use unicorn_engine::RegisterARM;

use crate::chip::{FLASH_BASE, NMI, Reset};

use super::{Activity, Core, CoreError, RAM_BASE};

/// Registers of the basic frame before return address and status.
const SAVED: [RegisterARM; 6] =
    [RegisterARM::R0, RegisterARM::R1, RegisterARM::R2, RegisterARM::R3, RegisterARM::R12, RegisterARM::LR];

/// First of the sixteen single-precision registers of the extended frame.
const S0: i32 = RegisterARM::S0 as i32;

/// CONTROL.FPCA: floating-point registers hold something to be saved.
const FPCA: u32 = 1 << 2;

/// EXC_RETURN for a return to a handler and to thread mode on the main stack; bit 4 is clear if the frame is extended.
const TO_HANDLER: u32 = 0xffff_fff1;
const TO_THREAD: u32 = 0xffff_fff9;
const BASIC: u32 = 1 << 4;

/// xPSR: Thumb state, the interrupted IT block's bits, alignment flag of a stacked frame.
const THUMB: u32 = 1 << 24;
const IT: u32 = 0x0600_fc00;
const ALIGNED: u32 = 1 << 9;

impl Core {
    /// Serves the most urgent interrupt, if it preempts what runs and is not masked.
    pub(super) fn take_exception(&mut self) -> Result<(), CoreError> {
        let Some(exception) = self.chip().nvic.deliverable() else {
            return Ok(());
        };
        let masked = exception != NMI && self.register(RegisterARM::PRIMASK)? & 1 != 0;
        if masked || self.activity == Activity::LockedUp {
            return Ok(());
        }
        self.enter_exception(exception)
    }

    pub(super) fn enter_exception(&mut self, exception: u32) -> Result<(), CoreError> {
        let hung = self.activity == Activity::Hung;
        let control = self.register(RegisterARM::CONTROL)?;
        let status = self.register(RegisterARM::XPSR)?;
        let mut words = Vec::with_capacity(26);
        for register in SAVED {
            words.push(self.register(register)?);
        }
        words.push(self.register(RegisterARM::PC)? & !1);
        let top = self.register(RegisterARM::SP)?;
        let length = if control & FPCA != 0 { 0x68 } else { 0x20 };
        let sp = top.wrapping_sub(length) & !7;
        words.push((status & !ALIGNED) | if top & 4 != 0 { ALIGNED } else { 0 });
        if control & FPCA != 0 {
            for i in 0..16 {
                words.push(self.uc.reg_read(S0 + i).map_err(|e| self.failed(e))? as u32);
            }
            words.push(self.register(RegisterARM::FPSCR)?);
            words.push(0);
        }
        let to = if status & 0x1ff == 0 { TO_THREAD } else { TO_HANDLER };
        let bytes: Vec<u8> = words.iter().flat_map(|w| w.to_le_bytes()).collect();
        let stacked = self.uc.mem_write(sp.into(), &bytes).is_ok();
        self.set_register(RegisterARM::SP, sp)?;
        let vectors = self.chip().nvic.vector_table();
        self.chip_mut().nvic.enter(exception);
        let returns = if control & FPCA != 0 { to & !BASIC } else { to };
        // A hung program comes back to the place where it hangs, which the handlers' return must find.
        self.hung_below = hung.then_some(self.chip().nvic.depth()).or(self.hung_below);
        if !stacked {
            // A fault while a frame is written escalates to HardFault, whose own frame cannot be written either.
            self.activity = Activity::LockedUp;
            return Ok(());
        }
        self.begin(exception, returns, vectors, status, control)
    }

    /// Goes to the handler.
    fn begin(&mut self, number: u32, returns: u32, vectors: u32, status: u32, control: u32) -> Result<(), CoreError> {
        let vector = self.word(vectors + 4 * number)?;
        self.set_register(RegisterARM::LR, returns)?;
        self.set_register(RegisterARM::XPSR, (status & !(0x1ff | IT)) | number | THUMB)?;
        self.set_register(RegisterARM::CONTROL, control & !FPCA)?;
        self.set_register(RegisterARM::PC, vector | 1)?;
        self.activity = Activity::Running;
        let shared = self.uc.get_data_mut();
        shared.event = true;
        shared.counted = None;
        // Twelve clocks for the basic frame; those of the floating-point registers are saved lazily.
        shared.chip.now += 12 * crate::time::SECOND / shared.chip.core_hz();
        Ok(())
    }

    /// Returns from a handler by the value that was loaded into the program counter.
    pub(super) fn leave_exception(&mut self, returns: u32) -> Result<(), CoreError> {
        let sp = self.register(RegisterARM::SP)?;
        let extended = returns & BASIC == 0;
        let count = if extended { 26 } else { 8 };
        let mut bytes = vec![0; 4 * count];
        if self.uc.mem_read(sp.into(), &mut bytes).is_err() {
            return self.fault();
        }
        let words: Vec<u32> = bytes.as_chunks::<4>().0.iter().map(|b| u32::from_le_bytes(*b)).collect();
        for (register, word) in SAVED.into_iter().zip(&words) {
            self.set_register(register, *word)?;
        }
        if extended {
            for (i, word) in words[8..24].iter().enumerate() {
                self.uc.reg_write(S0 + i as i32, u64::from(*word)).map_err(|e| self.failed(e))?;
            }
            self.set_register(RegisterARM::FPSCR, words[24])?;
        }
        let status = words[7];
        let control = self.register(RegisterARM::CONTROL)? & !FPCA;
        self.set_register(RegisterARM::XPSR, status & !ALIGNED)?;
        self.set_register(RegisterARM::CONTROL, control | if extended { FPCA } else { 0 })?;
        self.set_register(RegisterARM::SP, sp + 4 * count as u32 + if status & ALIGNED != 0 { 4 } else { 0 })?;
        self.set_register(RegisterARM::PC, words[6] | 1)?;
        if self.hung_below == Some(self.chip().nvic.depth()) {
            self.hung_below = None;
            self.activity = Activity::Hung;
        }
        let shared = self.uc.get_data_mut();
        shared.chip.nvic.leave();
        shared.event = true;
        shared.counted = None;
        shared.chip.now += 10 * crate::time::SECOND / shared.chip.core_hz();
        Ok(())
    }

    /// Starts from the vector table. RAM holds noise after a loss of power, and keeps its content otherwise.
    pub(super) fn reset(&mut self, cause: Reset) -> Result<(), CoreError> {
        if matches!(cause, Reset::Power | Reset::BrownOut) {
            self.uc.mem_write(RAM_BASE.into(), &super::memory::noise()).map_err(|e| self.failed(e))?;
        }
        self.replace_chip(cause);
        let now = self.chip().now;
        self.resets.push((now, cause));
        self.activity = if self.catch_reset { Activity::Halted } else { Activity::Running };
        self.hung_below = None;
        let (stack, start) = (self.word(FLASH_BASE)?, self.word(FLASH_BASE + 4)?);
        for (register, value) in [
            (RegisterARM::XPSR, THUMB),
            (RegisterARM::CONTROL, 0),
            (RegisterARM::PRIMASK, 0),
            (RegisterARM::SP, stack),
            (RegisterARM::LR, u32::MAX),
            // The image enables the floating-point unit through CPACR, which the CPU emulator does not see.
            (RegisterARM::C1_C0_2, 0xf << 20),
            (RegisterARM::FPEXC, 1 << 30),
            (RegisterARM::FPSCR, 0),
            (RegisterARM::PC, start | 1),
        ] {
            self.set_register(register, value)?;
        }
        Ok(())
    }

    /// Resets from outside.
    ///
    /// # Errors
    /// [`CoreError`].
    pub fn restart(&mut self, cause: Reset) -> Result<(), CoreError> {
        self.reset(cause)
    }

    fn word(&self, address: u32) -> Result<u32, CoreError> {
        let mut bytes = [0; 4];
        self.uc.mem_read(address.into(), &mut bytes).map_err(|e| self.failed(e))?;
        Ok(u32::from_le_bytes(bytes))
    }
}
