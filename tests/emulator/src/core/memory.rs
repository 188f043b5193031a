//! Memory map of the core: flash, RAM, registers.

use unicorn_engine::{HookType, Prot, Unicorn, uc_error};

use crate::chip::{Change, FLASH_BASE, FLASH_LEN, NMI};

use super::{Core, CoreError, RAM_BASE, RAM_LEN, Shared};

/// Page of the factory data: unique number, size of the flash, calibration of the reference (RM0090 section 39, data sheet).
const SYSTEM: u64 = 0x1fff_7000;
const UNIQUE_ID: u64 = 0x1fff_7a10;
const FLASH_SIZE: u64 = 0x1fff_7a22;
const REFERENCE_AT_3V3: u64 = 0x1fff_7a2a;

/// Ranges of registers: APB and AHB1, USB, private peripheral bus.
const REGISTERS: [(u64, u64); 3] = [(0x4000_0000, 0x8_0000), (0x5000_0000, 0x4_0000), (0xe000_0000, 0x10_0000)];

/// Maps everything.
pub(super) fn map(uc: &mut Unicorn<'static, Shared>) -> Result<(), uc_error> {
    uc.mem_map(FLASH_BASE.into(), FLASH_LEN as u64, Prot::READ | Prot::EXEC)?;
    uc.mem_map(RAM_BASE.into(), RAM_LEN as u64, Prot::ALL)?;
    uc.mem_map(SYSTEM, 0x1000, Prot::READ)?;
    uc.mem_write(UNIQUE_ID, b"palpate-emu\0")?;
    uc.mem_write(FLASH_SIZE, &((FLASH_LEN / 1024) as u16).to_le_bytes())?;
    // 1.21 V of 3.3 V in codes of 12 bit.
    uc.mem_write(REFERENCE_AT_3V3, &1502_u16.to_le_bytes())?;
    for (base, length) in REGISTERS {
        let read = move |uc: &mut Unicorn<'_, Shared>, offset: u64, size: usize| {
            settle(uc);
            let address = (base + offset) as u32;
            let word = uc.get_data_mut().chip.read(address & !3);
            let shifted = word >> (8 * (address & 3));
            u64::from(if size < 4 { shifted & ((1 << (8 * size)) - 1) } else { shifted })
        };
        let write = move |uc: &mut Unicorn<'_, Shared>, offset: u64, size: usize, value: u64| {
            settle(uc);
            let chip = &mut uc.get_data_mut().chip;
            let address = (base + offset) as u32;
            let (shift, value) = (8 * (address & 3), value as u32);
            let word = if size == 4 {
                value
            } else if address & !0x3ff == 0x4000_4800 {
                // Reading a data register would take its byte.
                value << shift
            } else {
                let mask = ((1 << (8 * size)) - 1) << shift;
                (chip.read(address & !3) & !mask) | (value << shift & mask)
            };
            chip.write(address & !3, word);
            settle(uc);
        };
        uc.mmio_map(base, length, Some(read), Some(write))?;
    }
    let (begin, end) = (u64::from(FLASH_BASE), u64::from(FLASH_BASE) + FLASH_LEN as u64 - 1);
    uc.add_mem_hook(HookType::MEM_WRITE_PROT, begin, end, |uc, _, address, size, value| {
        settle(uc);
        let mut old = [0; 4];
        let read = uc.mem_read(address & !3, &mut old);
        let offset = (address - u64::from(FLASH_BASE)) as usize;
        uc.get_data_mut().chip.write_flash(offset, size, u32::from_le_bytes(old), value as u32);
        read.is_ok()
    })?;
    Ok(())
}

/// Brings peripherals and memory up to date; true if the core must stop and look.
pub(super) fn settle(uc: &mut Unicorn<'_, Shared>) -> bool {
    let shared = uc.get_data_mut();
    if shared.chip.now >= shared.chip.due {
        shared.chip.process();
    }
    let halfwords = std::mem::take(&mut shared.chip.dma_writes);
    let changes = std::mem::take(&mut shared.chip.flash_changes);
    for (address, value) in halfwords {
        // An address outside RAM would be a wrong set-up of the stream, which the program sees by its ring staying empty.
        let _ = uc.mem_write(address.into(), &value.to_le_bytes());
    }
    if let Some(log) = &mut uc.get_data_mut().flash_log {
        log.extend(&changes);
    }
    for change in changes {
        let _ = match change {
            Change::Word(offset, word) => uc.mem_write(place(offset), &word.to_le_bytes()),
            Change::Erase(offset, length) => uc.mem_write(place(offset), &vec![0xff; length]),
        };
    }
    let shared = uc.get_data();
    let chip = &shared.chip;
    let interrupted = chip.nvic.deliverable().is_some_and(|exception| exception == NMI || !masked(uc));
    chip.now >= shared.until || chip.reset.is_some() || interrupted
}

fn masked(uc: &Unicorn<'_, Shared>) -> bool {
    uc.reg_read(unicorn_engine::RegisterARM::PRIMASK).is_ok_and(|mask| mask & 1 != 0)
}

fn place(offset: usize) -> u64 {
    u64::from(FLASH_BASE) + offset as u64
}

/// What RAM holds after power has come.
pub(super) fn noise() -> Vec<u8> {
    (0..RAM_LEN as u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8).collect()
}

impl Core {
    /// Most stack that was used since power came, and all there is, bytes: from the initial stack pointer down to the first byte that no longer holds the
    /// noise of the start. The stack lies at the bottom of RAM.
    ///
    /// # Errors
    /// [`CoreError`].
    pub fn stack(&self) -> Result<(usize, usize), CoreError> {
        let mut top = [0; 4];
        self.uc.mem_read(FLASH_BASE.into(), &mut top).map_err(|e| self.failed(e))?;
        let all = (u32::from_le_bytes(top) - RAM_BASE) as usize;
        let found = self.uc.mem_read_as_vec(RAM_BASE.into(), all).map_err(|e| self.failed(e))?;
        let untouched = found.iter().zip(noise()).take_while(|(byte, noise)| *byte == noise).count();
        Ok((all - untouched, all))
    }

    /// Content of the flash.
    ///
    /// # Errors
    /// [`CoreError`].
    pub fn flash(&self) -> Result<Vec<u8>, CoreError> {
        self.uc.mem_read_as_vec(FLASH_BASE.into(), FLASH_LEN).map_err(|e| self.failed(e))
    }

    /// Begins to note every change that the program makes in the flash, or ends it; returns what was noted so far.
    pub fn log_flash(&mut self, on: bool) -> Vec<Change> {
        std::mem::replace(&mut self.uc.get_data_mut().flash_log, on.then(Vec::new)).unwrap_or_default()
    }

    /// Puts bytes into the flash from `offset` on, as a programmer does.
    ///
    /// # Errors
    /// [`CoreError`].
    pub fn set_flash(&mut self, offset: usize, bytes: &[u8]) -> Result<(), CoreError> {
        self.uc.mem_write(place(offset), bytes).map_err(|e| self.failed(e))
    }
}
