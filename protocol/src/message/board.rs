//! Identity, mode and status of a board.

use crate::fault::FaultSet;
use crate::wire::wire;

wire! {
    /// The host's side of the greeting.
    pub struct HelloRequest {
        /// [`crate::PROTOCOL_VERSION`] of the host.
        pub protocol_version: u16,
        /// [`super::SCHEMA_HASH`] of the host.
        pub schema_hash: u64,
    }
    /// Who the board is.
    pub struct Hello {
        /// [`crate::PROTOCOL_VERSION`] of the board.
        pub protocol_version: u16,
        /// [`super::SCHEMA_HASH`] of the board.
        pub schema_hash: u64,
        /// Firmware version: major, minor, patch.
        pub firmware_version: [u8; 3],
        /// Which build of it.
        pub build: Build,
        /// Unique number of the microcontroller (96 bit on STM32; chosen for simulated boards).
        pub unique_id: [u8; 12],
        /// True if surroundings and sensors are simulated.
        pub simulated: bool,
        /// Bytes of one table slot.
        pub slot_len: u32,
        /// Why the board last started.
        pub reset_cause: ResetCause,
    }
    /// A build of the firmware. All zero where there is no image, or its source had no history.
    pub struct Build {
        /// First eight digits of the commit it was built from, ASCII.
        pub commit: [u8; 8],
        /// The source had changes that were not committed.
        pub modified: bool,
        /// CRC-32 over the image in flash, as the board finds it at its start.
        pub image_crc: u32,
    }
    /// A mode, and its lease: how long it may go on without a request from the link that asked for it.
    pub struct ModeRequest {
        /// The mode.
        pub mode: Mode,
        /// Lease, ms: 100 to 1000. Every request over the same link renews it; when it ends, the board
        /// switches off.
        pub lease_ms: u16,
    }
    /// A snapshot.
    pub struct Status {
        /// Time since start, ms.
        pub uptime_ms: u32,
        /// Commanded mode: a press if there is one, else the display, by the first library entry that it
        /// shows (0xff as long as it waits for a verdict).
        pub mode: Mode,
        /// What the board is doing: palpation while it does anything, else display.
        pub state: State,
        /// Latched faults.
        pub faults: FaultSet,
        /// Frames received that failed CRC or decoding.
        pub frames_rejected: u32,
        /// Telemetry frames not sent because the link was full.
        pub frames_dropped: u32,
        /// Control ticks that missed their deadline.
        pub deadlines_missed: u32,
        /// Longest control tick since start, us.
        pub tick_max_us: u16,
        /// Control ticks that began late, measured from start to start.
        pub ticks_late: u32,
        /// Longest time between the starts of two control ticks since start, us.
        pub period_max_us: u32,
        /// Who holds the motion.
        pub holder: Holder,
        /// Hash of the active table, zero without one.
        pub table_hash: [u8; 16],
        /// Where the calibration in use comes from.
        pub calibration: CalibrationState,
        /// What is wired to the board.
        pub fitted: Fitted,
    }
    /// Parts wired to a board. One that is not fitted is neither checked nor driven, and reads 0.
    pub struct Fitted {
        /// Arm with load cell and position transducer.
        pub palpator: bool,
        /// Actuator of the display with its potentiometer.
        pub actuator: bool,
        /// Coil of the display with its current amplifier. The FSR belongs to whichever of both is there.
        pub coil: bool,
    }
}

impl Build {
    /// No image, or one that nobody knows.
    pub const UNKNOWN: Build = Build { commit: [0; 8], modified: false, image_crc: 0 };
}

wire! {
    /// What the host asks the board to do.
    pub enum Mode {
        /// Outputs off.
        Idle,
        /// Press the probe into a specimen at constant rate and identify it.
        Palpate {
            /// Rate of the probe, mm/s; one of the rates the board allows (1 to 4).
            rate_mm_s: f32,
            /// Depth after contact at which the palpation ends, mm.
            depth_mm: f32,
        },
        /// Display the softness of a library material to a finger.
        Display {
            /// Index into the table's library.
            material: u8,
        },
    }
    /// What the board is doing.
    pub enum State {
        /// Outputs off, waiting.
        Idle,
        /// Probe moves, no contact yet.
        Approach,
        /// Probe in contact, search runs.
        Contact,
        /// Probe returns.
        Retract,
        /// Softness is displayed.
        Display,
        /// Outputs off, a fault is latched.
        Fault,
    }
    /// Which link holds the motion, seen from the one that asks.
    pub enum Holder {
        /// None: the board rests.
        Nobody,
        /// The one that asks.
        You,
        /// The board's other link.
        Another,
    }
    /// Where a calibration comes from.
    pub enum CalibrationState {
        /// Stored on this board.
        Stored,
        /// The firmware's own: none has been stored yet.
        Default,
        /// The firmware's own, because the stored one does not read back; a fault.
        Unreadable,
    }
    /// Why the board started.
    pub enum ResetCause {
        /// Power on, or brown-out.
        PowerOn,
        /// Reset pin or debugger.
        Pin,
        /// Software asked for it.
        Software,
        /// The independent watchdog.
        Watchdog,
        /// Not known.
        Other,
    }
}
