//! The conversation with the self-test program, which runs on a bare NUCLEO in place of the display board.
//!
//! Frames are those of [`crate::frame`]; the numbers of these messages are none of the board's, so neither program
//! takes the other's requests for its own. An answer carries its request's sequence number in its frame. The program
//! answers [`crate::rescue`] as the board does. It sets and measures; what it finds is judged by the host.

use crate::message::{Build, DecodeError, Empty, LastRun, ResetCause};
use crate::wire::{FNV_BASIS, Wire, fold, fold_number, messages, wire};

/// Pins that are driven, in the order of every list here: PC6 (coil), PE9 and PE11 (actuator), PD15 (arm's rate),
/// PD14 (arm's run).
pub const PINS: usize = 5;

/// Analog inputs, in the order of every list here: PA3, PC0, PC3, PC2, PB1.
pub const INPUTS: usize = 5;

/// Longest content of an [`Echo`], bytes.
pub const ECHO_LEN: usize = 200;

/// Flash sector that is erased and written: the last one of bank 2, 128 KiB.
pub const SECTOR: u8 = 11;

wire! {
    /// Who runs, on which chip, and how its last run ended.
    pub struct Identity {
        /// Fingerprint of these messages.
        pub schema_hash: u64,
        /// Firmware version: major, minor, patch.
        pub firmware_version: [u8; 3],
        /// Which build of it.
        pub build: Build,
        /// Unique number of the microcontroller.
        pub unique_id: [u8; 12],
        /// Device code (RM0090 section 38.6.1): 0x419 is an F42x or F43x.
        pub device: u16,
        /// Revision code: 0x2001 is revision 3.
        pub revision: u16,
        /// Size of the flash that the factory states, KiB.
        pub flash_kib: u16,
        /// Option control register of the flash: brown-out level in bits 2 and 3.
        pub options: u32,
        /// The 8 MHz clock has come.
        pub external_clock: bool,
        /// Access control register of the flash: prefetch, instruction and data cache in bits 8 to 10.
        pub flash_access: u32,
        /// Reading of the internal reference at the start, and the factory's at 3.3 V; codes of 12 bit.
        pub reference: u16,
        /// See `reference`.
        pub reference_at_3v3: u16,
        /// Why this run began.
        pub reset_cause: ResetCause,
        /// How the one before ended.
        pub last_run: LastRun,
        /// What the run before noted after [`Request::End`], if it was one that hangs.
        pub hang: Hang,
        /// Since the start, us.
        pub uptime_us: u64,
    }
    /// Times that a hanging program noted, us after the end of its last control tick; 0 for never.
    pub struct Hang {
        /// The actuator's reverse pin was low. No wire is there that could hold it up.
        pub pin_low_us: u32,
        /// It still ran.
        pub alive_us: u32,
    }
    /// Outputs that are on for so long, and then off again.
    pub struct Drive {
        /// Which outputs have power.
        pub power: Power,
        /// Duty of the coil's pin, 0 to 1.
        pub coil: f32,
        /// Duty of the actuator's pins, -1 to 1: below zero the reverse one.
        pub actuator: f32,
        /// Duty of the arm's rate, 0 to 1.
        pub arm: f32,
        /// Waited before the mean, ms, at most 2000.
        pub settle_ms: u16,
        /// Length of the mean, ms, at most 5000.
        pub average_ms: u16,
    }
    /// What was measured.
    pub struct Measured {
        /// Means of the analog inputs, fractions of the reference.
        pub mean: [f32; INPUTS],
        /// Standard deviations of the millisecond means.
        pub spread: [f32; INPUTS],
        /// Milliseconds in which each pin was seen high; it is looked at once in each.
        pub high: [u16; PINS],
        /// Milliseconds of readings.
        pub count: u16,
        /// Readings that were lost to an overrun or did not come.
        pub lost: u16,
        /// How long that took by the board's clock, us.
        pub took_us: u32,
        /// Board's clock at its end, us.
        pub uptime_us: u64,
    }
    /// The interlock's permit was not renewed.
    pub struct Released {
        /// From the last permit until the actuator's reverse pin was seen low, us; 0 if it stayed high for 200 ms.
        pub pin_low_us: u32,
        /// The same of the coil's pin, which its wire's capacitor holds up for a while.
        pub coil_low_us: u32,
        /// The interlock tells that it has switched off.
        pub told: bool,
    }
    /// Hashes of the identification over the series of [`crate::lut`]'s test table, and its time.
    pub struct Computed {
        /// Variance search.
        pub search: u64,
        /// Fast search.
        pub profile: u64,
        /// Kalman filter.
        pub filter: u64,
        /// Kalman filter with an offset.
        pub offset_filter: u64,
        /// All of it, us.
        pub took_us: u32,
    }
    /// Flash bank 2 was erased and written while everything else ran.
    pub struct Written {
        /// Erase of a sector, ms; 0 if it failed.
        pub erase_ms: u32,
        /// Slowest word, us.
        pub word_us: u32,
        /// Words that read back as written, and as erased before.
        pub words_right: u16,
        /// Words that were written.
        pub words: u16,
        /// CRC-32 over the program in bank 1, read again and again meanwhile: how often, and how often it was another.
        pub reads: u16,
        /// See `reads`.
        pub reads_wrong: u16,
        /// Milliseconds of readings meanwhile, and lost ones.
        pub count: u16,
        /// See `count`.
        pub lost: u16,
    }
    /// Bytes there and back.
    pub struct Echo {
        /// Whatever they are.
        pub bytes: heapless::Vec<u8, ECHO_LEN>,
    }
    /// The run ends now, with coil and actuator on; what came of it is in the next [`Identity`].
    pub struct Ending {
        /// The way.
        pub way: Way,
    }
}

wire! {
    /// Which outputs have power.
    pub enum Power {
        /// None.
        Off,
        /// Coil and actuator.
        Display,
        /// The arm.
        Arm,
    }
    /// How a run is ended.
    pub enum Way {
        /// The control task hangs.
        Hang,
        /// The same with interrupts masked.
        HangMasked,
        /// A panic.
        Panic,
        /// An undefined instruction.
        HardFault,
    }
}

messages! {
    SCHEMA_HASH;
    /// From host to program.
    pub enum Request {
        /// Answered by [`Report::Identity`].
        0x40 Identify(Empty),
        /// Answered by [`Report::Measured`] when it is done.
        0x41 Measure(Drive),
        /// Lets a permit end. Answered by [`Report::Released`].
        0x42 Release(Empty),
        /// Answered by [`Report::Computed`].
        0x43 Compute(Empty),
        /// Erases and writes [`SECTOR`]: a table there is lost. Answered by [`Report::Written`].
        0x44 WriteFlash(Empty),
        /// Answered by [`Report::Echo`].
        0x45 Repeat(Echo),
        /// Answered by [`Report::Ending`], before it happens.
        0x46 End(Ending),
    }
    /// From program to host.
    pub enum Report {
        /// See [`Request::Identify`].
        0xc0 Identity(Identity),
        /// See [`Request::Measure`].
        0xc1 Measured(Measured),
        /// See [`Request::Release`].
        0xc2 Released(Released),
        /// See [`Request::Compute`].
        0xc3 Computed(Computed),
        /// See [`Request::WriteFlash`].
        0xc4 Written(Written),
        /// See [`Request::Repeat`].
        0xc5 Echo(Echo),
        /// See [`Request::End`].
        0xc6 Ending(Ending),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::message;

    /// A board must not carry out what was meant for the self test, nor the other way round.
    #[test]
    fn no_number_is_also_one_of_the_boards() {
        for (number, name) in Request::TABLE.iter().chain(Report::TABLE) {
            let boards = message::Request::TABLE.iter().chain(message::Report::TABLE);
            assert!(boards.clone().all(|(other, _)| other != number), "{name}");
        }
    }
}
