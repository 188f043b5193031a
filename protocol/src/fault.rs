//! Faults: codes that board and host both know. The board latches them; only an explicit
//! [`Request::ClearFaults`](crate::message::Request::ClearFaults) with the cause gone clears them.

use crate::wire::{FNV_BASIS, Wire, fold, fold_number};

macro_rules! faults {
    ($($(#[$doc:meta])* $name:ident = $bit:literal, $what:literal, $action:literal;)*) => {
        /// A latched departure from safe operation. The number is the bit in a [`FaultSet`]
        /// and never changes its meaning.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        #[repr(u8)]
        pub enum Fault { $($(#[$doc])* $name = $bit,)* }

        impl Fault {
            /// Every fault, in the order of its bit.
            pub const ALL: &'static [Fault] = &[$(Fault::$name,)*];

            /// What was detected, for people.
            pub const fn describe(self) -> &'static str {
                match self { $(Fault::$name => $what,)* }
            }

            /// What a person at the bench should do about it.
            pub const fn advice(self) -> &'static str {
                match self { $(Fault::$name => $action,)* }
            }
        }
    };
}

faults! {
    /// Load cell above its force limit.
    ForceLimit = 0, "force above the limit of the load cell", "raise the probe, then clear the fault";
    /// Actuator shaft outside its stroke.
    StrokeLimit = 1, "shaft outside its stroke", "move the shaft back by hand, check the potentiometer's calibration";
    /// Coil current above its limit.
    CurrentLimit = 2, "coil current above the limit", "check the coil and the current sensor";
    /// Coil hotter than its winding allows (estimated by the thermal model).
    CoilHot = 3, "coil too hot", "wait for the coil to cool";
    /// Load cell reading at a rail: open or shorted.
    LoadCellOpen = 4, "load cell open or shorted", "check the load cell's wiring";
    /// FSR reading at a rail that force cannot explain.
    FsrShort = 5, "force sensing resistor shorted", "check the FSR's wiring";
    /// Potentiometer open or shorted.
    PotentiometerOpen = 6, "potentiometer open or shorted", "check the potentiometer's wiring";
    /// No fresh samples from the converter.
    SensorStale = 7, "no fresh sensor samples", "reset the board; if it comes back, report it";
    /// The host has been silent for longer than the link timeout while outputs were on.
    LinkLost = 8, "link to the host lost", "reconnect, then clear the fault";
    /// A control tick took longer than its period.
    DeadlineMissed = 9, "control tick missed its deadline", "report it: this must not happen";
    /// The table in flash does not pass its checks.
    TableInvalid = 10, "no valid table", "upload a table";
    /// A number inside the control loop was not finite.
    NotFinite = 11, "a value in the control loop was not a number", "reset the board and report it";
    /// The converter's DMA ring overran.
    AdcOverrun = 12, "analog converter overrun", "reset the board; if it comes back, report it";
    /// Probe position transducer open or shorted.
    ProbePositionOpen = 13, "probe position sensor open or shorted", "check the transducer's wiring";
    /// The independent watchdog had reset the board.
    WatchdogReset = 14, "the watchdog had reset the board", "read the log, report it";
    /// Actuator driven at its limit for longer than it may be.
    ActuatorStall = 15, "actuator stalled", "free the shaft, then clear the fault";
    /// The interlock had switched the outputs off: its permit had ended.
    Interlock = 16, "the interlock had switched the outputs off", "read the log, report it";
    /// USB was not started: the chip is older than revision 3, or the 8 MHz clock did not come.
    UsbOff = 17, "USB is off: a chip before revision 3, or no 8 MHz clock", "use the ST-LINK's serial port; the log says which";
    /// The load cell reads what a probe on its way down cannot feel.
    ForceImplausible = 18, "force contradicts the press", "check the load cell's wiring and tare it; a specimen that slipped or tore reads alike";
    /// The probe does not move as the arm is told to.
    ArmDeviates = 19, "probe does not move as commanded", "check the arm, its rate, and the transducer's wiring";
    /// More current in the coil than its duty gives: the switch does not open.
    CoilUncommanded = 20, "coil current without a command", "cut the coil's supply: its power switch is shorted";
    /// Less current in the coil than its duty gives.
    CoilOpen = 21, "coil driven without current", "check coil, supply and current amplifier";
    /// The stored calibration does not read back.
    CalibrationLost = 22, "stored calibration cannot be read", "load a calibration: palpate board calibrate --load FILE";
}

impl Fault {
    /// Fault of a given bit, if there is one.
    pub fn from_bit(bit: u8) -> Option<Fault> {
        Fault::ALL.get(usize::from(bit)).copied()
    }

    /// Stable name for logs and `--json`, kebab-case.
    pub const fn code(self) -> &'static str {
        match self {
            Fault::ForceLimit => "force-limit",
            Fault::StrokeLimit => "stroke-limit",
            Fault::CurrentLimit => "current-limit",
            Fault::CoilHot => "coil-hot",
            Fault::LoadCellOpen => "load-cell-open",
            Fault::FsrShort => "fsr-short",
            Fault::PotentiometerOpen => "potentiometer-open",
            Fault::SensorStale => "sensor-stale",
            Fault::LinkLost => "link-lost",
            Fault::DeadlineMissed => "deadline-missed",
            Fault::TableInvalid => "table-invalid",
            Fault::NotFinite => "not-finite",
            Fault::AdcOverrun => "adc-overrun",
            Fault::ProbePositionOpen => "probe-position-open",
            Fault::WatchdogReset => "watchdog-reset",
            Fault::ActuatorStall => "actuator-stall",
            Fault::Interlock => "interlock",
            Fault::UsbOff => "usb-off",
            Fault::ForceImplausible => "force-implausible",
            Fault::ArmDeviates => "arm-deviates",
            Fault::CoilUncommanded => "coil-uncommanded",
            Fault::CoilOpen => "coil-open",
            Fault::CalibrationLost => "calibration-lost",
        }
    }
}

/// The number whose bits are faults.
type Bits = u32;

/// A set of faults, one bit each, as it travels in status and telemetry.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[serde(transparent)]
pub struct FaultSet(
    /// Bit n is the fault whose number is n.
    pub Bits,
);

impl Wire for FaultSet {
    const SHAPE: u64 = {
        let mut hash = fold_number(FNV_BASIS, Bits::SHAPE);
        let mut i = 0;
        while i < Fault::ALL.len() {
            hash = fold(hash, Fault::ALL[i].code());
            i += 1;
        }
        hash
    };
}

impl FaultSet {
    /// No fault.
    pub const NONE: FaultSet = FaultSet(0);

    /// Adds a fault.
    pub fn insert(&mut self, fault: Fault) {
        self.0 |= 1 << fault as u8;
    }

    /// True if `fault` is in the set.
    pub const fn contains(self, fault: Fault) -> bool {
        self.0 & (1 << fault as u8) != 0
    }

    /// True if no fault is in the set.
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The faults in the set that this version knows, lowest bit first.
    pub fn iter(self) -> impl Iterator<Item = Fault> {
        Fault::ALL.iter().copied().filter(move |f| self.contains(*f))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fault_is_its_bit_and_codes_are_distinct() {
        for (bit, fault) in Fault::ALL.iter().enumerate() {
            assert_eq!(*fault as usize, bit);
            assert_eq!(Fault::from_bit(bit as u8), Some(*fault));
            let mut set = FaultSet::NONE;
            set.insert(*fault);
            assert_eq!(set.iter().collect::<Vec<_>>(), [*fault]);
            assert_eq!(Fault::ALL.iter().filter(|f| f.code() == fault.code()).count(), 1);
        }
        assert_eq!(Fault::from_bit(Fault::ALL.len() as u8), None);
    }
}
