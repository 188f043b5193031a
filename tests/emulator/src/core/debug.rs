//! What a debugger does to the core: halt, go on, registers, memory (ARMv7-M ARM, C1).

use unicorn_engine::RegisterARM;

use super::{Activity, Core, CoreError, NOWHERE};

/// Core registers by their debug number: R0 to R12, SP, LR, PC, xPSR, MSP, PSP.
const REGISTERS: [RegisterARM; 19] = [
    RegisterARM::R0,
    RegisterARM::R1,
    RegisterARM::R2,
    RegisterARM::R3,
    RegisterARM::R4,
    RegisterARM::R5,
    RegisterARM::R6,
    RegisterARM::R7,
    RegisterARM::R8,
    RegisterARM::R9,
    RegisterARM::R10,
    RegisterARM::R11,
    RegisterARM::R12,
    RegisterARM::SP,
    RegisterARM::LR,
    RegisterARM::PC,
    RegisterARM::XPSR,
    RegisterARM::MSP,
    RegisterARM::PSP,
];

/// Debug numbers of FPSCR and of the first floating-point register.
const FPSCR: usize = 33;
const S0: usize = 64;

/// The register with a debug number.
fn number(register: usize) -> Option<i32> {
    match register {
        0..=18 => Some(REGISTERS[register] as i32),
        FPSCR => Some(RegisterARM::FPSCR as i32),
        S0..=95 => Some(RegisterARM::S0 as i32 + (register - S0) as i32),
        _ => None,
    }
}

impl Core {
    /// Connects a debugger, which catches breakpoints and, if `catch_reset`, the core after a reset; or disconnects it.
    pub fn set_debugged(&mut self, debugged: bool, catch_reset: bool) {
        self.debugged = debugged;
        self.catch_reset = catch_reset;
    }

    /// True while the debugger holds the core.
    pub fn is_halted(&self) -> bool {
        self.activity == Activity::Halted
    }

    /// True if a breakpoint has halted the core.
    pub fn is_at_breakpoint(&self) -> bool {
        self.is_halted() && self.at_breakpoint
    }

    /// Stops the core where it is.
    pub fn halt(&mut self) {
        self.activity = Activity::Halted;
        self.at_breakpoint = false;
    }

    /// Lets the core go on.
    pub fn go(&mut self) {
        if self.is_halted() {
            self.activity = Activity::Running;
            self.uc.get_data_mut().counted = None;
        }
    }

    /// Executes one instruction of a halted core, with interrupts masked.
    ///
    /// # Errors
    /// [`CoreError`].
    pub fn step(&mut self) -> Result<(), CoreError> {
        let pc = self.register(RegisterARM::PC)?;
        // An instruction that faults (there is none in a blank chip) leaves the core where it is: locked up, and halted.
        let _ = self.uc.emu_start(u64::from(pc | 1), NOWHERE, 0, 1);
        let shared = self.uc.get_data_mut();
        for reached in [&mut shared.breakpoint, &mut shared.returning, &mut shared.sleeping] {
            *reached = false;
        }
        shared.faulted = None;
        self.halt();
        Ok(())
    }

    /// Value of a register by its debug number; 0 for one that is not modelled.
    ///
    /// # Errors
    /// [`CoreError`].
    pub fn debug_register(&self, register: usize) -> Result<u32, CoreError> {
        number(register).map_or(Ok(0), |n| self.uc.reg_read(n).map(|v| v as u32).map_err(|e| self.failed(e)))
    }

    /// Sets a register by its debug number.
    ///
    /// # Errors
    /// [`CoreError`].
    pub fn set_debug_register(&mut self, register: usize, value: u32) -> Result<(), CoreError> {
        let value = if REGISTERS.get(register) == Some(&RegisterARM::PC) { value | 1 } else { value };
        number(register).map_or(Ok(()), |n| self.uc.reg_write(n, value.into()).map_err(|e| self.failed(e)))
    }

    /// Bytes of flash, RAM or factory data.
    ///
    /// # Errors
    /// [`CoreError`] where there is no memory.
    pub fn peek(&self, address: u32, length: usize) -> Result<Vec<u8>, CoreError> {
        self.uc.mem_read_as_vec(address.into(), length).map_err(|e| self.failed(e))
    }

    /// Sets bytes of RAM, perhaps code.
    ///
    /// # Errors
    /// [`CoreError`] where there is no memory.
    pub fn poke(&mut self, address: u32, bytes: &[u8]) -> Result<(), CoreError> {
        let written = self.uc.mem_write(address.into(), bytes);
        written.and_then(|()| self.uc.ctl_flush_tb()).map_err(|e| self.failed(e))
    }
}
