//! The board's Kalman estimate, and what it recognises (thesis Table 4).

use firmware::search::Slice;
use firmware::surface::Surface;
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
const OFFSETS: i32 = 12;
const OFFSET_MM: f32 = 0.02;

/// Depths at which curves are compared.
const DEPTHS: usize = 100;

impl Filtered {
    /// Recognises by the estimate alone: the library's curve that is nearest to the curve of the estimated parameters (mean absolute
    /// difference, each at its best offset), if it is within the material's acceptance. Parameters themselves are not compared, because
    /// mu and alpha make up for each other. None for an estimate that the table has no curve for.
    pub fn of(table: &Table<'_>, estimate: Estimate, rate_mm_s: f64) -> Option<Self> {
        let slice = Slice::nearest(table, estimate.height_mm, rate_mm_s as f32)?;
        let surface = Surface::new(table, &slice)?;
        let reach_mm = OFFSETS as f32 * OFFSET_MM;
        let step_mm = (table.depth_max_mm() - 2.0 * reach_mm) / DEPTHS as f32;
        let depths: Vec<f32> = (1..=DEPTHS).map(|i| reach_mm + step_mm * i as f32).collect();
        let force = |d: &f32| surface.at(estimate.mu_mpa, estimate.alpha, *d).map(|f| f.force_n);
        let found: Vec<f32> = depths.iter().map(force).collect::<Option<_>>()?;
        let error_n = |material: &protocol::lut::Material<'_>, offset_mm: f32| {
            let at = |d: f32| table.locate(d + offset_mm).map_or(0.0, |p| material.force_n(p));
            depths.iter().zip(&found).map(|(d, f)| (at(*d) - f).abs()).sum::<f32>() / DEPTHS as f32
        };
        let least = |material: &protocol::lut::Material<'_>| {
            (-OFFSETS..=OFFSETS).map(|i| error_n(material, OFFSET_MM * i as f32)).fold(f32::INFINITY, f32::min)
        };
        let errors = table.materials().map(|m| (least(&m), m.acceptance * m.peak_force_n()));
        let nearest = errors.enumerate().min_by(|a, b| a.1.0.total_cmp(&b.1.0))?;
        let (index, (error_n, accepted_n)) = nearest;
        Some(Filtered { estimate, named: (error_n <= accepted_n).then_some(index) })
    }
}
