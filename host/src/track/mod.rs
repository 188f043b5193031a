//! A finger or probe tip followed through recorded frames (thesis section 4.3, Figs. 60 and 63).
//!
//! What is looked for is a region of the first frame, and stays so: a track that took its template from later frames would
//! drift. Each frame is searched coarsely by normalised correlation around the place that is expected, else everywhere; then
//! aligned from the coarsest level of a pyramid down to a fraction of a pixel, with gain, focus and a plane of light free.
//! What does not look like the tip (a hand before it, the ground beside it) loses its weight.
//!
//! ```
//! use palpate::track::{Frame, Roi, Tracker};
//! // A round spot at (20 + shift, 15) on a dark ground.
//! let frame = |shift: f32| {
//!     let spot = |i: usize| {
//!         let (x, y) = ((i % 48) as f32 - 20.0 - shift, (i / 48) as f32 - 15.0);
//!         0.1 + 0.8 * (-(x * x + y * y) / 18.0).exp()
//!     };
//!     Frame { width: 48, height: 32, pixels: (0..48 * 32).map(spot).collect(), step: 1.0 / 65535.0 }
//! };
//! let mut tracker = Tracker::new(&frame(0.0), Roi { x: 10, y: 5, width: 21, height: 21 }, None)?;
//! let tip = tracker.step(&frame(2.4))?.expect("in plain sight");
//! assert!((tip.place_px[0] - 22.4).abs() < 0.02 && (tip.place_px[1] - 15.0).abs() < 0.02);
//! # Ok::<(), palpate::track::TrackError>(())
//! ```

mod align;
mod candidate;
mod clutter;
mod covariance;
mod error;
mod frame;
mod gaussian;
mod known;
mod noise;
mod normal;
mod position;
mod positions;
mod robust;
mod scale;
mod search;
pub mod source;
mod stated;
mod template;
mod tracker;

pub use error::TrackError;
pub use frame::{Frame, Roi};
pub use position::{Measure, Position, stretches};
pub use positions::{PositionError, Positions};
pub use scale::{Marker, MarkerError, Scale};
pub use tracker::{Tip, Tracker};
