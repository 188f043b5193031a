//! Axes of figures.

/// An axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Quantity and unit, "depth (mm)".
    pub label: String,
    /// Logarithmic.
    pub log: bool,
    /// Range; from the data if none.
    pub range: Option<(f64, f64)>,
}

impl Axis {
    /// A linear axis over the range of the data.
    pub fn new(label: &str) -> Self {
        Self { label: label.to_owned(), log: false, range: None }
    }

    /// The same axis over a stated range.
    #[must_use]
    pub fn over(mut self, low: f64, high: f64) -> Self {
        self.range = Some((low, high));
        self
    }

    /// The same axis, logarithmic.
    #[must_use]
    pub fn logarithmic(mut self) -> Self {
        self.log = true;
        self
    }
}
