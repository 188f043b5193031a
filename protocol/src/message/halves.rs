//! The board's two halves, palpation and display, each asked for by itself.
//!
//! Added to version 2 without a change of what was there: [`SetMode`](super::Request::SetMode) still means both
//! halves at once, with one of them at rest.

use super::State;
use crate::wire::wire;

wire! {
    /// What the palpation half is to do, and the lease ([`super::ModeRequest`]).
    pub struct PalpationRequest {
        /// What to do.
        pub palpation: PalpationMode,
        /// Lease, ms: 100 to 1000. While the other half is on, the shorter of both holds.
        pub lease_ms: u16,
    }
    /// What the display half is to do, and the lease.
    pub struct DisplayRequest {
        /// What to do.
        pub display: DisplayMode,
        /// Lease, ms: 100 to 1000. While the other half is on, the shorter of both holds.
        pub lease_ms: u16,
    }
    /// What both halves do. Follows every telemetry record for as long as a half is on that was asked for by
    /// itself.
    pub struct Halves {
        /// Number of the control tick since start.
        pub tick: u32,
        /// Palpation: [`State::Idle`], [`State::Approach`], [`State::Contact`], [`State::Retract`] or
        /// [`State::Fault`].
        pub palpation: State,
        /// Display.
        pub display: DisplayState,
        /// Parts of the display that are asked for.
        pub parts: Parts,
        /// Curve that is displayed, or gone over to.
        pub curve: Curve,
        /// How far the display has gone over to it from what it showed before, 0 to 1.
        pub share: f32,
        /// Number of the palpation that the curve comes from; 0 for a curve that was asked for by itself.
        pub of_palpation: u32,
        /// How far the shaft's travel along this curve may be off that of the identified material, as
        /// fraction of it; 0 for a material of the library that was asked for by its number.
        pub departs: f32,
        /// The material lies not between entries of the library: the curve is that of the nearest place.
        pub outside: bool,
        /// Error bound of the coil current under the present force, A; 0 without control curve.
        pub bound_a: f32,
    }
    /// A curve of the table's library: one entry, or a place between two.
    #[derive(Copy)]
    pub struct Curve {
        /// Index of the first entry; [`Curve::NO_ENTRY`] for none.
        pub low: u8,
        /// Index of the second one.
        pub high: u8,
        /// Share of the second one, 0 to 1.
        pub weight: f32,
    }
}

wire! {
    /// What the palpation half is asked for.
    pub enum PalpationMode {
        /// The arm goes home.
        Idle,
        /// Press the probe into a specimen at constant rate and identify it.
        Press {
            /// Rate of the probe, mm/s; one of the rates the board allows (1 to 4).
            rate_mm_s: f32,
            /// Depth after contact at which the palpation ends, mm.
            depth_mm: f32,
            /// Height of the surface above the base plate, mm, where it is known: without contact a
            /// millimetre below it the press ends.
            surface_mm: Option<f32>,
        },
    }
    /// What the display half is asked for.
    pub enum DisplayMode {
        /// Actuator and coil off.
        Idle,
        /// A library material.
        Material {
            /// With what.
            parts: Parts,
            /// Index into the table's library.
            material: u8,
        },
        /// The place of these parameters between library materials.
        Between {
            /// With what.
            parts: Parts,
            /// Shear modulus, MPa.
            mu_mpa: f32,
            /// Exponent.
            alpha: f32,
            /// Height of the specimen, mm.
            height_mm: f32,
            /// Rate of the press, mm/s.
            rate_mm_s: f32,
        },
        /// What palpation identifies, from its latest verdict on. Without one nothing is displayed yet.
        Follow {
            /// With what.
            parts: Parts,
            /// Which curve a verdict gives.
            by: Rule,
        },
    }
    /// Parts of the display.
    pub enum Parts {
        /// Actuator and coil, or the one of both that is fitted.
        Both,
        /// Coil only.
        Coil,
        /// Actuator only.
        Actuator,
        /// Coil only, its current by the place of the finger instead of its force. The display's potentiometer
        /// rides on the finger and reads 0 mm at the fluid's surface; the actuator stands aside.
        CoilAtPlace,
    }
    /// Which curve a verdict gives.
    pub enum Rule {
        /// That of the material it names, if it names one.
        Nearest,
        /// The place of its mu and alpha between library materials, if it has them.
        Between,
    }
    /// What the display half is doing.
    pub enum DisplayState {
        /// Off.
        Idle,
        /// Off until a palpation says what to display.
        Waiting,
        /// A curve is displayed.
        On,
        /// Off, a fault is latched.
        Fault,
    }
}

impl Curve {
    /// No entry.
    pub const NO_ENTRY: u8 = 0xff;

    /// No curve.
    pub const NONE: Curve = Curve { low: Curve::NO_ENTRY, high: Curve::NO_ENTRY, weight: 0.0 };

    /// The curve of one entry.
    pub const fn of(entry: u8) -> Self {
        Curve { low: entry, high: entry, weight: 0.0 }
    }
}

impl DisplayMode {
    /// Parts that are asked for; `None` for idle.
    pub const fn parts(&self) -> Option<Parts> {
        match self {
            DisplayMode::Idle => None,
            DisplayMode::Material { parts, .. }
            | DisplayMode::Between { parts, .. }
            | DisplayMode::Follow { parts, .. } => Some(*parts),
        }
    }
}

impl Parts {
    /// True if the actuator is asked for.
    pub const fn actuator(self) -> bool {
        matches!(self, Parts::Both | Parts::Actuator)
    }

    /// True if the coil is asked for.
    pub const fn coil(self) -> bool {
        matches!(self, Parts::Both | Parts::Coil | Parts::CoilAtPlace)
    }

    /// True if the potentiometer reads the place of the finger, which decides the current.
    pub const fn at_place(self) -> bool {
        matches!(self, Parts::CoilAtPlace)
    }
}
