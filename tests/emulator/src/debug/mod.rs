//! The emulated chip behind a debug probe: its debug registers, in a thread of its own.

mod probe;

use std::collections::BTreeMap;
use std::sync::mpsc::{Sender, channel};
use std::thread;

use crate::board::{EmulatedBoard, EmulatorError};
use crate::core::CoreError;
use crate::time::MILLISECOND;

pub use probe::lister;

const DFSR: u32 = 0xe000_ed30;
const DHCSR: u32 = 0xe000_edf0;
const DCRSR: u32 = 0xe000_edf4;
const DCRDR: u32 = 0xe000_edf8;
const DEMCR: u32 = 0xe000_edfc;

/// DHCSR: key of a write, control bits, status bits.
const KEY: u32 = 0xa05f;
const C_DEBUGEN: u32 = 1;
const C_HALT: u32 = 1 << 1;
const C_STEP: u32 = 1 << 2;
const S_REGRDY: u32 = 1 << 16;
const S_HALT: u32 = 1 << 17;
const S_RESET_ST: u32 = 1 << 25;

/// DEMCR: halt after a reset.
const VC_CORERESET: u32 = 1;

/// Registers that never change: CPUID of a Cortex-M4 r0p1, breakpoint unit with six comparators.
const CPUID: (u32, u32) = (0xe000_ed00, 0x410f_c241);
const FP_CTRL: (u32, u32) = (0xe000_2000, 0x60);

/// The board as the debugger's access port sees it.
pub struct Target {
    board: EmulatedBoard,
    control: u32,
    demcr: u32,
    data: u32,
    /// Resets that the debugger has been told of.
    resets: usize,
    /// Breakpoint unit, kept as written: it does nothing here.
    words: BTreeMap<u32, u32>,
}

impl Target {
    fn new(board: EmulatedBoard) -> Self {
        let resets = board.resets().len();
        Target { board, control: 0, demcr: 0, data: 0, resets, words: BTreeMap::from([FP_CTRL]) }
    }

    /// The board.
    pub fn board(&mut self) -> &mut EmulatedBoard {
        &mut self.board
    }

    /// A core that is not halted runs while the debugger asks: 1 ms a question.
    fn turn(&mut self) -> Result<(), CoreError> {
        if !self.board.core().is_halted() {
            let until = self.board.core().chip().now + MILLISECOND;
            self.board.core().run(until)?;
        }
        Ok(())
    }

    fn read(&mut self, address: u32, length: usize) -> Result<Vec<u8>, CoreError> {
        if address < 0x4000_0000 {
            return self.board.core().peek(address, length);
        }
        // Behind the private peripheral bus is nothing; the program counter of a blank chip points there.
        if address >= 0xe010_0000 {
            return Ok(vec![0; length]);
        }
        let mut bytes = Vec::with_capacity(length + 4);
        for word in (address & !3..address + length as u32).step_by(4) {
            bytes.extend(self.word(word)?.to_le_bytes());
        }
        let skip = address as usize & 3;
        Ok(bytes[skip..skip + length].to_vec())
    }

    fn word(&mut self, address: u32) -> Result<u32, CoreError> {
        Ok(match address {
            at if at == CPUID.0 => CPUID.1,
            DHCSR => {
                self.turn()?;
                let resets = self.board.resets().len();
                let reset = std::mem::replace(&mut self.resets, resets) != resets;
                let halted = self.board.core().is_halted();
                self.control | S_REGRDY | if halted { S_HALT } else { 0 } | if reset { S_RESET_ST } else { 0 }
            }
            // At a breakpoint, or halted by the debugger.
            DFSR => {
                if self.board.core().is_at_breakpoint() {
                    0b10
                } else {
                    0b01
                }
            }
            DCRDR => self.data,
            DEMCR => self.demcr,
            0xe000_2000..0xe000_3000 => self.words.get(&address).copied().unwrap_or(0),
            _ => self.board.core().chip_mut().read(address),
        })
    }

    fn write(&mut self, address: u32, bytes: &[u8]) -> Result<(), CoreError> {
        if address < 0x4000_0000 {
            return self.board.core().poke(address, bytes);
        }
        for (i, word) in bytes.as_chunks::<4>().0.iter().enumerate() {
            self.set_word(address + 4 * i as u32, u32::from_le_bytes(*word))?;
        }
        Ok(())
    }

    fn set_word(&mut self, address: u32, value: u32) -> Result<(), CoreError> {
        let core = self.board.core();
        match address {
            DHCSR if value >> 16 == KEY => {
                self.control = value & 0xf;
                if value & C_DEBUGEN == 0 {
                    core.go();
                } else if value & C_HALT != 0 {
                    core.halt();
                } else if value & C_STEP != 0 {
                    core.step()?;
                } else {
                    core.go();
                }
            }
            DCRSR => {
                let register = (value & 0x7f) as usize;
                if value >> 16 & 1 != 0 {
                    core.set_debug_register(register, self.data)?;
                } else {
                    self.data = core.debug_register(register)?;
                }
            }
            DCRDR => self.data = value,
            DEMCR => self.demcr = value,
            DHCSR | DFSR => {}
            0xe000_2000..0xe000_3000 => {
                self.words.insert(address, value);
            }
            _ => core.chip_mut().write(address, value),
        }
        let debugged = self.control & C_DEBUGEN != 0;
        let core = self.board.core();
        core.set_debugged(debugged, debugged && self.demcr & VC_CORERESET != 0);
        if core.chip().reset.is_some() {
            // The reset is carried out at once, halted or not.
            core.go();
            let until = core.chip().now + 1;
            core.run(until)?;
        }
        Ok(())
    }
}

type Deed = Box<dyn FnOnce(&mut Target) + Send>;

/// A board in a thread of its own, as the CPU emulator cannot leave the thread it was made in. It ends with its last handle.
#[derive(Debug, Clone)]
pub struct Handle {
    deeds: Sender<Deed>,
}

impl Handle {
    /// Makes a board in a new thread.
    ///
    /// # Errors
    /// Those of `make`.
    pub fn start(
        make: impl FnOnce() -> Result<EmulatedBoard, EmulatorError> + Send + 'static,
    ) -> Result<Self, EmulatorError> {
        let (deeds, todo) = channel::<Deed>();
        let (made, outcome) = channel();
        thread::spawn(move || match make() {
            Ok(board) => {
                let mut target = Target::new(board);
                let _ = made.send(Ok(()));
                todo.into_iter().for_each(|deed| deed(&mut target));
            }
            Err(error) => {
                let _ = made.send(Err(error));
            }
        });
        match outcome.recv() {
            Ok(Err(error)) => Err(error),
            _ => Ok(Handle { deeds }),
        }
    }

    /// Does something with the board in its thread; `None` if the thread has ended.
    pub fn with<R: Send + 'static>(&self, deed: impl FnOnce(&mut Target) -> R + Send + 'static) -> Option<R> {
        let (done, result) = channel();
        self.deeds
            .send(Box::new(move |target| {
                let _ = done.send(deed(target));
            }))
            .ok()?;
        result.recv().ok()
    }
}
