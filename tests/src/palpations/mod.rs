//! Simulated palpations of the thesis' four foams, judged by the firmware's own library (thesis section 3.4).
//!
//! The foams are finite-element curves on a finer mesh than the tables', one for each rate; each palpation adds what the
//! thesis' bench added: gain, contact and noise that differ from press to press, and a neoprene sponge (B1) that relaxes and softens.
//! Every number of that kind stands in [`Conditions`] and [`B1_RELAXATION`] with its reason; they were fixed before
//! any rate of recognition was known.

mod filtered;
mod foam;
mod judged;
mod press;
mod spread;
mod study;
mod table;

pub use filtered::Filtered;
pub use foam::{B1_RELAXATION, BALL, PressedFoam, pressed_foams};
pub use judged::{Judged, THRESHOLD_SIGMAS, ThesisWay, by_threshold, judge};
pub use press::{Conditions, Press, Softening, session};
pub use spread::Spread;
pub use study::{Count, Palpated, Study, THESIS_COUNTS};
pub use table::{RATES_MM_S, tables};

/// Samples a second, as the board takes them.
pub const SAMPLES_HZ: f64 = 50.0;

/// Depth of a palpation, mm (thesis section 3.3).
pub const DEPTH_MM: f64 = 4.0;
