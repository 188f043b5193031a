//! A coupon of the foam in a ring, as a run that could be made.
//!
//! In a ring and not between platens: platens rub, which holds the faces and lets the sides bulge, and a coupon that barrels is stiffer than its law by as much as a Poisson's
//! ratio makes it; a ring needs its lubricant too, but a foam that hardly spreads hardly presses on it. Nor do free sides decide what held ones do not: a Poisson's ratio
//! enters both in the same form, as `nu` and as `nu / (1 - 2 nu)`.

use lut_gen::chain::{Model, Shortening, Sides};

use crate::experiment::Experiment;

use super::super::check::{Check, Coupon};
use super::super::design::Design;
use super::motion::{On, Plan, SAMPLE_HZ, significant};

/// Shares of its height that a coupon is shortened by: past the plateau, where terms and Poisson's ratios part, and before the cells of a foam lie on each other; less where a rival has
/// a Poisson's ratio that makes the smallest coupon too strong.
const SHORTENED: [f64; 5] = [0.5, 0.4, 0.3, 0.2, 0.1];
/// Diameters of coupons (mm), that of a die: of the larger the area is known better.
const DIAMETERS_MM: [f64; 6] = [50.0, 40.0, 30.0, 25.0, 20.0, SMALLEST_MM];
const SMALLEST_MM: f64 = 15.0;
/// Largest force on a coupon, as a factor on that of the presses: a palpation uses a tenth of the range of a sensor, and a coupon may use half of it.
const STRONGER: f64 = 5.0;

/// A coupon of a height (mm), as large as leaves the force that any of some models predicts within the range of a sensor that read `largest_n` (N) in the presses: what the base does not know
/// of, a Poisson's ratio of 0.3, makes a coupon a hundred times as strong, and must not break the sensor that shows it.
pub(super) fn in_ring(like: Plan, height_mm: f64, (models, largest_n): (&[&Model], f64)) -> Plan {
    let rate = like.rate_mm_per_s;
    let strongest_n = |diameter_mm: f64, depth_mm: f64| {
        let (time_s, depth_mm) = (vec![0.0, depth_mm / rate], vec![0.0, depth_mm]);
        let end = Shortening { time_s, depth_mm, ..cylinder(diameter_mm, height_mm) };
        models.iter().map(|model| model.shortened(&end, 0.0)[1]).fold(0.0, f64::max)
    };
    let fits = |(diameter_mm, share): &(f64, f64)| strongest_n(*diameter_mm, share * height_mm) <= STRONGER * largest_n;
    let sizes = DIAMETERS_MM.into_iter().map(|diameter_mm| (diameter_mm, SHORTENED[0]));
    let depths = SHORTENED.into_iter().map(|share| (SMALLEST_MM, share));
    let (diameter_mm, share) = sizes.chain(depths).find(fits).unwrap_or((SMALLEST_MM, SHORTENED[SHORTENED.len() - 1]));
    Plan { on: On::Confined(diameter_mm), depth_mm: share * height_mm, ..like }
}

/// A coupon that nothing is wrong about, before its run.
fn cylinder(diameter_mm: f64, height_mm: f64) -> Shortening {
    Shortening {
        sides: Sides::Held,
        height_mm,
        area_mm2: std::f64::consts::PI * (0.5 * diameter_mm).powi(2),
        // none of the experiment's specimens: their wrong heights are not this one's
        specimen: usize::MAX,
        nu: None,
        rubbing: None,
        time_s: Vec::new(),
        depth_mm: Vec::new(),
        start_s: 0.0,
        before_mm: 0.0,
    }
}

/// The plan in words.
pub(super) fn words(plan: &Plan, experiment: &Experiment, diameter_mm: f64) -> String {
    let specimen = &experiment.specimens[plan.specimen];
    let height_mm = specimen.height_mm.known().unwrap_or(plan.depth_mm / SHORTENED[0]);
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

#[cfg(test)]
mod tests {
    use lut_gen::chain::Setting;
    use lut_gen::effect::poisson;

    use super::*;

    const HEIGHT_MM: f64 = 12.7;

    fn planned(models: &[&Model], largest_n: f64) -> (f64, f64) {
        let like = Plan {
            on: On::Specimen,
            specimen: 0,
            height: 1.0,
            indenter: 0,
            radius: 1.0,
            rate_mm_per_s: 1.0,
            depth_mm: 3.0,
            hold_s: 0.0,
            unload: false,
            cycles: 1,
        };
        let plan = in_ring(like, HEIGHT_MM, (models, largest_n));
        let On::Confined(diameter_mm) = plan.on else { return (f64::NAN, f64::NAN) };
        (diameter_mm, plan.depth_mm / HEIGHT_MM)
    }

    /// Without a rival the largest that the base allows; with one whose sides cannot give way a smaller one, then one that is shortened by less, so that neither leaves the range.
    #[test]
    fn no_rival_leaves_the_range_of_the_sensor() {
        let base = Model::base(0.01, 9.0);
        let with = |nu: f64| {
            let setting = Setting { effect: &poisson::EFFECT, owner: 0, values: vec![nu] };
            Model { settings: vec![setting], ..base.clone() }
        };
        let largest_n = 1.0;
        assert_eq!(planned(&[&base], largest_n), (30.0, 0.5));
        let mut before = (30.0, 0.5);
        for nu in [0.1, 0.2, 0.3] {
            let rival = with(nu);
            let (diameter_mm, share) = planned(&[&base, &rival], largest_n);
            assert!(diameter_mm <= before.0 && share <= before.1, "{nu}: {diameter_mm} {share}");
            let depth_mm = share * HEIGHT_MM;
            let end = Shortening {
                time_s: vec![0.0, depth_mm],
                depth_mm: vec![0.0, depth_mm],
                ..cylinder(diameter_mm, HEIGHT_MM)
            };
            let force_n = rival.shortened(&end, 0.0)[1];
            assert!(force_n <= STRONGER * largest_n, "{nu}: {force_n}");
            before = (diameter_mm, share);
        }
        assert!(before.1 < 0.5, "{before:?}");
    }
}
