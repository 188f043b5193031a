//! Injected faults of the program: what happens at a place of unmodified code.

use unicorn_engine::RegisterARM;

use super::{Activity, Core, CoreError, RAM_BASE};
use crate::time::Time;

/// What an injected fault does to the program when it reaches a place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Deed {
    /// It never gets on from there; interrupts are served.
    Hang,
    /// The same with interrupts masked.
    HangMasked,
    /// It gets on from there after so much time; interrupts are served meanwhile.
    Hold(Time),
    /// The function returns at once, having done nothing.
    Skip,
    /// It goes on with so many bytes of stack left.
    StackLeft(u32),
    /// It goes on at another address, with these arguments (R0 to R2).
    Jump(u32, [u32; 3]),
}

/// A place and what happens there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Trap {
    /// Address of the function.
    pub address: u32,
    /// What happens.
    pub deed: Deed,
}

impl Core {
    /// Lets `trap` happen when the program next comes to its place; `None` calls it off.
    ///
    /// # Errors
    /// [`CoreError`].
    pub fn set_trap(&mut self, trap: Option<Trap>) -> Result<(), CoreError> {
        if let Some(trap) = trap {
            let place = u64::from(trap.address);
            let set = self.uc.add_code_hook(place, place, |uc, address, _| {
                let shared = uc.get_data_mut();
                if shared.trap.is_some_and(|t| u64::from(t.address) == address) {
                    shared.trapped = true;
                    let _ = uc.emu_stop();
                }
            });
            // Blocks translated before do not know the hook.
            set.and_then(|_| self.uc.ctl_flush_tb()).map_err(|e| self.failed(e))?;
        }
        self.uc.get_data_mut().trap = trap;
        Ok(())
    }

    /// Carries out the injected fault.
    pub(super) fn spring(&mut self) -> Result<(), CoreError> {
        let Some(trap) = self.uc.get_data_mut().trap.take() else {
            return Ok(());
        };
        match trap.deed {
            Deed::Hang => self.activity = Activity::Hung,
            Deed::HangMasked => {
                self.set_register(RegisterARM::PRIMASK, 1)?;
                self.activity = Activity::Hung;
            }
            Deed::Hold(time) => {
                self.activity = Activity::Hung;
                self.held_until = Some(self.chip().now + time);
            }
            Deed::Skip => {
                let back = self.register(RegisterARM::LR)?;
                self.set_register(RegisterARM::PC, back | 1)?;
                // Until it is called off.
                self.uc.get_data_mut().trap = Some(trap);
            }
            Deed::Jump(address, arguments) => {
                for (register, value) in [RegisterARM::R0, RegisterARM::R1, RegisterARM::R2].into_iter().zip(arguments)
                {
                    self.set_register(register, value)?;
                }
                self.set_register(RegisterARM::PC, address | 1)?;
            }
            Deed::StackLeft(bytes) => self.set_register(RegisterARM::SP, RAM_BASE + (bytes & !7))?,
        }
        Ok(())
    }
}
