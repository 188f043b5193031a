//! Gains and calibration.

use crate::wire::wire;

wire! {
    /// Position loop: PID with filtered derivative, `u = kp e + ki int(e) + kd n s/(s + n) e`
    /// (thesis section 5.5 and Eq. 56).
    pub struct Gains {
        /// Proportional gain, V/mm.
        pub kp: f32,
        /// Integral gain, V/(mm s).
        pub ki: f32,
        /// Derivative gain, V s/mm.
        pub kd: f32,
        /// Corner of the derivative filter, rad/s.
        pub n: f32,
    }
    /// What the display's actuator can do, as it was identified (`palpate actuator identify`).
    pub struct Actuator {
        /// Farthest target of the shaft, mm.
        pub reach_mm: f32,
        /// Fastest change of the target, mm/s.
        pub rate_mm_s: f32,
        /// Command that holds the shaft against the finger, V/N: 0 where a spindle does.
        pub holds_v_per_n: f32,
    }
    /// Where the next palpation is to find its specimen.
    pub struct Surface {
        /// Height of the surface above the base plate, mm. Without contact a millimetre below it the palpation ends.
        pub height_mm: f32,
    }
    /// Everything that turns converter readings into physical units.
    pub struct Calibration {
        /// Load cell of the palpation probe.
        pub load_cell: LoadCell,
        /// Force sensing resistor of the display: conductance over force, Eq. 43 (ERRATA).
        pub fsr: ResistiveSensor,
        /// Shaft potentiometer: resistance over length, Eq. 46 (ERRATA: linear in resistance).
        pub potentiometer: ResistiveSensor,
        /// Position of the palpation probe.
        pub probe: ProbePosition,
    }
    /// A bridge with amplifier: `force_n = (ratio - zero_ratio) * n_per_ratio`.
    pub struct LoadCell {
        /// Reading without force, fraction of the reference voltage, 0 to 1.
        pub zero_ratio: f32,
        /// Sensitivity, N for the full reference voltage.
        pub n_per_ratio: f32,
    }
    /// A resistive sensor between the supply and a fixed resistor to ground, whose voltage is read (Eq. 44), with a linear law
    /// `y = slope x + offset`; y is conductance in mS for the FSR (x in units of 100 gf) and resistance in
    /// kOhm for the potentiometer (x in mm).
    pub struct ResistiveSensor {
        /// Slope of the law.
        pub slope: f32,
        /// Offset of the law.
        pub offset: f32,
        /// Fixed resistor of the divider, kOhm.
        pub divider_kohm: f32,
    }
    /// A linear transducer: `position_mm = (ratio - zero_ratio) * mm_per_ratio`, height of the ball's lowest
    /// point above the base plate.
    pub struct ProbePosition {
        /// Reading with the ball on the base plate, fraction of the reference voltage.
        pub zero_ratio: f32,
        /// Sensitivity, mm for the full reference voltage.
        pub mm_per_ratio: f32,
    }
}
