//! What the run before this one left behind.

use super::State;
use crate::wire::wire;

/// Changes of state that are kept.
pub const CHANGES: usize = 16;

/// Bytes of a panic's file name that are kept, from its end.
pub const FILE_LEN: usize = 48;

wire! {
    /// What the last run left in RAM; nothing after power has come.
    pub struct LastRun {
        /// A record was there and whole.
        pub known: bool,
        /// Why the run ended.
        pub end: RunEnd,
        /// File name of a panic, UTF-8; empty otherwise.
        pub file: heapless::Vec<u8, FILE_LEN>,
        /// The latest changes of state, oldest first.
        pub changes: heapless::Vec<StateChange, CHANGES>,
    }
    /// A change of state.
    pub struct StateChange {
        /// Since that run's start, ms.
        pub time_ms: u32,
        /// The new state.
        pub state: State,
    }
}

wire! {
    /// Why a run ended.
    pub enum RunEnd {
        /// Not known: a hang, the reset pin, a debugger.
        Unknown,
        /// A panic; its file is beside this.
        Panic {
            /// Line.
            line: u32,
        },
        /// A HardFault.
        HardFault {
            /// Program counter.
            pc: u32,
            /// Link register.
            lr: u32,
            /// Configurable fault status register (ARMv7-M ARM, B3.2.15).
            cfsr: u32,
        },
        /// The 8 MHz clock stopped.
        ClockLost,
        /// The 3.3 V supply sagged.
        SupplyLow,
        /// An interrupt or exception without a handler.
        Interrupt {
            /// Its number, as two's complement; exceptions of the core are negative.
            number: u32,
        },
    }
}

impl LastRun {
    /// Nothing is known.
    pub const NONE: LastRun =
        LastRun { known: false, end: RunEnd::Unknown, file: heapless::Vec::new(), changes: heapless::Vec::new() };
}
