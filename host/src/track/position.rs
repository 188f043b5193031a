//! Positions over time: rows of a table, and what they tell together.

use super::scale::Scale;
use super::tracker::Tip;

/// The tip in one frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Position {
    /// From 0.
    pub frame: usize,
    /// Since the first frame, s; none where the frame rate is not known.
    pub time_s: Option<f64>,
    /// None where the tip is lost.
    pub tip: Option<Tip>,
}

/// How positions are told.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Measure {
    /// Length of a pixel, where it is known.
    pub scale: Option<Scale>,
    /// Row of the surface, pixels, where there is one.
    pub surface_px: Option<f64>,
}

impl Measure {
    /// Names of the columns.
    #[must_use]
    pub fn head(&self) -> String {
        let mut head = "frame,time_s,x_px,y_px,sigma_x_px,sigma_y_px,own_sigma_x_px,own_sigma_y_px,lost,\
                        correlation,seen,gain"
            .to_owned();
        if self.scale.is_some() {
            head.push_str(",x_mm,y_mm,sigma_x_mm,sigma_y_mm");
        }
        if self.surface_px.is_some() {
            head.push_str(",below_surface_px");
            if self.scale.is_some() {
                head.push_str(",below_surface_mm");
            }
        }
        head
    }

    /// A row; what is not known is empty.
    #[must_use]
    pub fn row(&self, position: &Position) -> String {
        let time = position.time_s.map_or_else(String::new, |time| format!("{time:.6}"));
        let mut row = format!("{},{time}", position.frame);
        let mut add = |value: Option<f64>, digits: usize| {
            row.push(',');
            if let Some(value) = value.filter(|value| value.is_finite()) {
                row.push_str(&format!("{value:.digits$}"));
            }
        };
        let tip = position.tip;
        for axis in 0..2 {
            add(tip.map(|tip| tip.place_px[axis]), 4);
        }
        for axis in 0..2 {
            add(tip.map(|tip| tip.sigma_px[axis]), 4);
        }
        for axis in 0..2 {
            add(tip.map(|tip| tip.own_sigma_px[axis]), 4);
        }
        add(Some(if tip.is_some() { 0.0 } else { 1.0 }), 0);
        add(tip.map(|tip| tip.correlation), 4);
        add(tip.map(|tip| tip.seen), 3);
        add(tip.map(|tip| tip.gain), 4);
        if let Some(scale) = self.scale {
            for axis in 0..2 {
                add(tip.map(|tip| scale.mm_per_px * tip.place_px[axis]), 5);
            }
            for axis in 0..2 {
                add(tip.map(|tip| scale.mm_per_px * tip.sigma_px[axis]), 5);
            }
        }
        if let Some(surface) = self.surface_px {
            let below = tip.map(|tip| tip.place_px[1] - surface);
            add(below, 4);
            if let Some(scale) = self.scale {
                add(below.map(|below| scale.mm_per_px * below), 5);
            }
        }
        row
    }

    /// Height of the tip over the surface, or over its first place without one: mm where the scale is known, else pixels.
    #[must_use]
    pub fn height(&self, first: &Tip, tip: &Tip) -> f64 {
        let zero = self.surface_px.unwrap_or(first.place_px[1]);
        (zero - tip.place_px[1]) * self.scale.map_or(1.0, |scale| scale.mm_per_px)
    }

    /// Unit of heights.
    #[must_use]
    pub fn unit(&self) -> &'static str {
        if self.scale.is_some() { "mm" } else { "px" }
    }

    /// The tip is below the surface, by more than the surface's row can be told from it: two standard deviations.
    #[must_use]
    pub fn is_below(&self, tip: &Tip) -> bool {
        self.surface_px.is_some_and(|surface| tip.place_px[1] - surface > 2.0 * tip.sigma_px[1])
    }
}

/// First and last frame of each stretch of positions of which something holds.
#[must_use]
pub fn stretches(positions: &[Position], holds: impl Fn(&Position) -> bool) -> Vec<[usize; 2]> {
    let mut found: Vec<[usize; 2]> = Vec::new();
    let mut before = false;
    for position in positions {
        let now = holds(position);
        match found.last_mut() {
            Some(last) if now && before => last[1] = position.frame,
            _ if now => found.push([position.frame; 2]),
            _ => {}
        }
        before = now;
    }
    found
}
