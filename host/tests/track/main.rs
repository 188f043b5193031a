//! `palpate::track` on rendered sequences, whose tips are where the renderer put them.
#![allow(clippy::unwrap_used, clippy::panic)]

mod accuracy;
mod fresh;
mod outside;
mod press;
mod render;
mod sight;

use palpate::track::{Roi, Tip, Tracker};
use render::{Scene, random};

/// A square around a place.
fn around(place: [f64; 2], half: usize) -> Roi {
    let [x, y] = place.map(|p| p.round() as usize - half);
    Roi { x, y, width: 2 * half + 1, height: 2 * half + 1 }
}

/// What was found in a frame, and where the tip was.
struct Seen {
    tip: Option<Tip>,
    place: [f64; 2],
}

impl Seen {
    /// Error along both axes, pixels.
    fn error(&self) -> Option<[f64; 2]> {
        self.tip.map(|tip| [tip.place_px[0] - self.place[0], tip.place_px[1] - self.place[1]])
    }
}

/// Follows the tip of a scene through `frames`, of which `make` changes each and says where the tip is.
fn follow(scene: &Scene, frames: usize, seed: u64, make: impl Fn(usize, &mut Scene) -> [f64; 2]) -> Vec<Seen> {
    let mut random = random(seed);
    let mut own = scene.clone();
    let start = make(0, &mut own);
    let first = own.frame(start, &mut random);
    let mut tracker = Tracker::new(&first, around(start, 20), Some(start)).unwrap();
    let mut step = |i: usize| {
        let mut own = scene.clone();
        let place = make(i, &mut own);
        let tip = tracker.step(&own.frame(place, &mut random)).unwrap();
        Seen { tip, place }
    };
    (1..frames).map(&mut step).collect()
}

/// Root of the mean squared error along an axis, of a tip that is never lost.
fn rms(seen: &[Seen], axis: usize) -> f64 {
    let errors = seen.iter().map(|s| s.error().unwrap_or_else(|| panic!("lost at {:?}", s.place))[axis]);
    (errors.map(|e| e * e).sum::<f64>() / seen.len() as f64).sqrt()
}
