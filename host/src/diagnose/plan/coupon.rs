//! A coupon of the foam in a ring, as a run that could be made.
//!
//! In a ring and not between platens: platens rub, which holds the faces and lets the sides bulge, and a coupon that barrels is stiffer than its law by as much as a Poisson's
//! ratio makes it; a ring needs its lubricant too, but a foam that hardly spreads hardly presses on it. Nor do free sides decide what held ones do not: a Poisson's ratio
//! enters both in the same form, as `nu` and as `nu / (1 - 2 nu)`.

use lut_gen::chain::{Model, Shortening, Sides};

use crate::experiment::Experiment;

use super::super::check::{Check, Coupon};
use super::super::design::Design;
use super::{On, Plan, SAMPLE_HZ, significant};

/// Share of its height that a coupon is shortened by: past the plateau, where terms and Poisson's ratios part, and before the cells of a foam lie on each other.
const SHORTENED: f64 = 0.5;
/// Diameters of coupons (mm), that of a die: of the larger the area is known better.
const DIAMETERS_MM: [f64; 6] = [50.0, 40.0, 30.0, 25.0, 20.0, SMALLEST_MM];
const SMALLEST_MM: f64 = 15.0;
/// Largest force on a coupon, as a factor on that of the presses: a palpation uses a tenth of the range of a sensor, and a coupon may use half of it.
const STRONGER: f64 = 5.0;

/// A coupon of a height (mm), as large as leaves the force that the base predicts within the range of a sensor that read `largest_n` (N) in the presses.
pub(super) fn in_ring(like: Plan, height_mm: f64, (base, largest_n): (&Model, f64)) -> Plan {
    let depth_mm = SHORTENED * height_mm;
    let fits = |diameter_mm: &f64| {
        let (time_s, depth_mm) = (vec![0.0, depth_mm / like.rate_mm_per_s], vec![0.0, depth_mm]);
        let end = Shortening { time_s, depth_mm, ..cylinder(*diameter_mm, height_mm) };
        base.shortened(&end, 0.0)[1] <= STRONGER * largest_n
    };
    let diameter_mm = DIAMETERS_MM.into_iter().find(fits).unwrap_or(SMALLEST_MM);
    Plan { on: On::Confined(diameter_mm), depth_mm, ..like }
}

/// A coupon that nothing is wrong about, before its run.
fn cylinder(diameter_mm: f64, height_mm: f64) -> Shortening {
    Shortening {
        sides: Sides::Held,
        height_mm,
        area_mm2: std::f64::consts::PI * (0.5 * diameter_mm).powi(2),
        // none of the experiment's specimens: their wrong heights are not this one's
        specimen: usize::MAX,
        time_s: Vec::new(),
        depth_mm: Vec::new(),
        start_s: 0.0,
        before_mm: 0.0,
    }
}

/// The plan in words.
pub(super) fn words(plan: &Plan, experiment: &Experiment, diameter_mm: f64) -> String {
    let specimen = &experiment.specimens[plan.specimen];
    let height_mm = specimen.height_mm.known().unwrap_or(plan.depth_mm / SHORTENED);
    format!(
        "compress a coupon of the foam of {}, {diameter_mm} mm in diameter and {height_mm} mm high, in a ring that fits it, lubricated, by {:.0} % of its height at {} mm/s, on two coupons",
        specimen.name,
        100.0 * plan.depth_mm / height_mm,
        significant(plan.rate_mm_per_s)
    )
}

/// One coupon of the plan, read as the base says. None where that shows no contact.
pub(super) fn check(
    plan: &Plan,
    diameter_mm: f64,
    like: &Design,
    (base, beside): (&Model, (Option<f64>, f64)),
) -> Option<Check> {
    let geometry = like.series.iter().find(|s| s.specimen == plan.specimen)?.geometry;
    let height_mm = like.geometries[geometry].specimen.height_mm;
    let coupon = Shortening { start_s: beside.0.unwrap_or(0.0), ..cylinder(diameter_mm, height_mm) };
    let own = Coupon::planned(base, &coupon, (plan.depth_mm, plan.rate_mm_per_s), SAMPLE_HZ)?;
    Some(Check::of_coupon(own, beside))
}
