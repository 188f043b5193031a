//! A control curve between its rows: straight lines.

use super::{ControlCurve, Row};

impl ControlCurve {
    /// What of a row at a force, on the straight line between two; the last beyond the last.
    fn along(&self, from: fn(&Row) -> f64, at: f64, to: fn(&Row) -> f64) -> Option<f64> {
        let next = self.rows.iter().position(|row| from(row) >= at)?;
        let Some(before) = next.checked_sub(1).map(|i| &self.rows[i]) else { return Some(to(&self.rows[next])) };
        let after = &self.rows[next];
        let width = from(after) - from(before);
        let part = if width > 0.0 { (at - from(before)) / width } else { 1.0 };
        Some(to(before) + part * (to(after) - to(before)))
    }

    fn last(&self, of: fn(&Row) -> f64) -> f64 {
        self.rows.last().map_or(0.0, of)
    }

    /// Current at a force, A.
    pub(super) fn current_at(&self, force_n: f64) -> f64 {
        self.along(|row| row.force_n, force_n, |row| row.current_a).unwrap_or_else(|| self.last(|row| row.current_a))
    }

    /// Travel of the finger on the material under a force, mm.
    #[must_use]
    pub fn travel_at(&self, force_n: f64) -> f64 {
        self.along(|row| row.force_n, force_n, |row| row.travel_mm).unwrap_or_else(|| self.last(|row| row.travel_mm))
    }

    /// What the shaft must give way under a force, mm.
    #[must_use]
    pub fn shaft_at(&self, force_n: f64) -> f64 {
        self.along(|row| row.force_n, force_n, |row| row.shaft_mm).unwrap_or_else(|| self.last(|row| row.shaft_mm))
    }

    /// Force at which the shaft should stand here, N; `None` beyond the curve.
    #[must_use]
    pub fn force_at_shaft(&self, shaft_mm: f64) -> Option<f64> {
        self.along(|row| row.shaft_mm, shaft_mm, |row| row.force_n)
    }

    /// Force of the material at a travel of the finger, N; `None` beyond the curve.
    #[must_use]
    pub fn force_at_travel(&self, travel_mm: f64) -> Option<f64> {
        self.along(|row| row.travel_mm, travel_mm, |row| row.force_n)
    }
}
