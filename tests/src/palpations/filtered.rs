//! The board's Kalman estimate, and what it recognises (thesis Table 4).

use firmware::search::Slice;
use firmware::surface::Surface;
use palpate::tour::recognised;
use protocol::lut::Table;
use protocol::message::Estimate;

/// What the filter finds.
#[derive(Debug, Clone, PartialEq)]
pub struct Filtered {
    /// The board's estimate with its standard errors.
    pub estimate: Estimate,
    /// Place of the recognised material in the library; none if nothing is near enough.
    pub named: Option<usize>,
}

/// Offsets of contact at which the estimate's curve is held against the library, as the board does with measured ones.
const OFFSETS: i16 = 12;

impl Filtered {
    /// Recognises by the estimate alone: the library's curve that is nearest to the curve of the estimated parameters (mean absolute
    /// difference, each at its best offset), if it is within the material's acceptance. Parameters themselves are not compared, because
    /// mu and alpha make up for each other. None for an estimate that the table has no curve for.
    pub fn of(table: &Table<'_>, estimate: Estimate, rate_mm_s: f64) -> Option<Self> {
        let slice = Slice::nearest(table, estimate.height_mm, rate_mm_s as f32)?;
        let surface = Surface::new(table, &slice)?;
        surface.at(estimate.mu_mpa, estimate.alpha, 0.5 * table.depth_max_mm())?;
        let named = recognised(table, &surface, (estimate.mu_mpa, estimate.alpha), OFFSETS);
        Some(Filtered { estimate, named })
    }
}
