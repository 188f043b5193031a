//! True physics at the end of one control tick.

/// What no sensor says: the state of the simulated surroundings.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Truth {
    /// Number of the board's control tick this belongs to.
    pub tick: u32,
    /// Board time, s.
    pub time_s: f64,
    /// Foam under the probe, empty without one.
    pub specimen: String,
    /// Height of the ball's lowest point above the base plate, mm.
    pub probe_mm: f64,
    /// Depth below the surface, mm; 0 above it.
    pub depth_mm: f64,
    /// Force of the foam on the ball, N.
    pub force_n: f64,
    /// Force of the finger on the cap, N.
    pub finger_n: f64,
    /// Position of the display's shaft, mm.
    pub shaft_mm: f64,
    /// Coil current, A.
    pub coil_a: f64,
    /// Mean temperature of the winding, C.
    pub coil_c: f64,
    /// Flux density in the fluid, T.
    pub flux_t: f64,
    /// Yield stress of the fluid, kPa.
    pub yield_kpa: f64,
}
