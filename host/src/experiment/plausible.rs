//! Numbers that are likely of another unit than the contract's: asked before anything is solved.

use std::collections::BTreeMap;

use super::error::Problem;
use super::format::Source;
use super::sensor::Trouble;
use super::signal::range;
use super::unit::{parted, unit};
use super::{Mapping, Recording};

/// A ball that travels less than this share of its radius was recorded in metres.
const LEAST_TRAVEL: f64 = 2e-3;
/// Shear modulus that nothing soft has, MPa: rubber of Shore A 90 has about 7, the softest plastics some hundred.
const STIFFEST_MPA: f64 = 15.0;
/// The ball touches where the force has risen by this share.
const TOUCH: f64 = 0.01;
/// And one below which no specimen keeps its shape, MPa.
const SOFTEST_MPA: f64 = 1e-8;

/// Refuses a way, and asks about a force, that no soft specimen under a ball of this radius gives, unless the scale of the column is stated.
pub(super) fn check(
    recording: &Recording,
    ball_mm: f64,
    columns: &BTreeMap<String, Mapping>,
) -> Result<Option<Trouble>, Problem> {
    let stated = |name: &str| columns.get(name).is_some_and(|mapping| is_stated(mapping, name));
    let (travel_mm, rise_n) = (range(recording.depth_mm.iter().copied()), range(recording.force_n.iter().copied()));
    if travel_mm <= 0.0 || rise_n <= 0.0 {
        return Ok(None);
    }
    if travel_mm < LEAST_TRAVEL * ball_mm && !stated("depth_mm") {
        return Err(Problem::Contradiction(format!(
            "the ball of {ball_mm} mm travels {travel_mm} mm, next to nothing: is `depth_mm` in metres? Then write scale = 1000 \
             for it in [columns]; scale = 1 says that it is in mm"
        )));
    }
    // Hertz for an incompressible specimen, F = 16/3 mu sqrt(R) d^1.5.
    let pressed_mm = pressed_mm(recording, rise_n).unwrap_or(travel_mm);
    let mu_mpa = 3.0 * rise_n / (16.0 * ball_mm.sqrt() * pressed_mm.powf(1.5));
    if stated("force_N") || (SOFTEST_MPA..=STIFFEST_MPA).contains(&mu_mpa) {
        return Ok(None);
    }
    let (than, unit, scale) = if mu_mpa > STIFFEST_MPA { ("stiffer", "mN", 0.001) } else { ("softer", "kN", 1000.0) };
    Ok(Some(Trouble::Unit(format!(
        "a force of {rise_n:.4} N at {pressed_mm:.3} mm under a ball of {ball_mm} mm is a shear modulus of about {mu_mpa:.1e} MPa, {than} \
         than rubber and gels are: is `force_N` in {unit}? Then write scale = {scale} for it in [columns]; scale = 1 says that it is in N"
    ))))
}

/// True where the description states a scale, or the file's own name of the column holds a unit.
fn is_stated(mapping: &Mapping, contract: &str) -> bool {
    let named = match &mapping.source {
        Source::Name { name, .. } if name != contract => parted(name).1,
        _ => None,
    };
    mapping.scale.is_some() || named.is_some_and(|text| unit(&text).is_some())
}

/// Way of the ball from where the force has begun to rise to where it is largest, mm.
fn pressed_mm(recording: &Recording, rise_n: f64) -> Option<f64> {
    let (force, depth) = (&recording.force_n, &recording.depth_mm);
    let peak = (0..force.len()).max_by(|a, b| force[*a].total_cmp(&force[*b]))?;
    let begun = force[..peak].iter().rposition(|f| force[peak] - f > (1.0 - TOUCH) * rise_n)?;
    let way = depth.get(peak)? - depth.get(begun)?;
    (way > 0.0).then_some(way)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used)]
    use super::*;

    /// A ball of 5 mm pressed 3 mm into mu 0.05 MPa, its columns times factors.
    fn told(depth: f64, force: f64, columns: &BTreeMap<String, Mapping>) -> Result<Option<String>, String> {
        let depth_mm: Vec<f64> = (0..100).map(|i| depth * 0.03 * f64::from(i)).collect();
        let force_n = (0..100).map(|i| force * 0.6 * (0.03 * f64::from(i)).powf(1.5)).collect();
        let time_s = (0..100).map(f64::from).collect();
        let found = check(&Recording::from_samples(time_s, depth_mm, force_n), 5.0, columns);
        found.map(|asked| asked.map(|trouble| trouble.to_string())).map_err(|problem| problem.to_string())
    }

    #[test]
    fn wrong_units_are_asked_and_stated_ones_are_not() {
        let none = BTreeMap::new();
        assert_eq!(told(1.0, 1.0, &none), Ok(None));
        let metres = told(1e-3, 1.0, &none).unwrap_err();
        assert!(metres.contains("is `depth_mm` in metres? Then write scale = 1000 for it in [columns]"), "{metres}");
        let milli = told(1.0, 1e4, &none).unwrap().unwrap();
        assert!(milli.contains("stiffer than rubber") && milli.contains("is `force_N` in mN?"), "{milli}");
        let kilo = told(1.0, 1e-8, &none).unwrap().unwrap();
        assert!(kilo.contains("is `force_N` in kN? Then write scale = 1000"), "{kilo}");
        let stated = Mapping { scale: Some(1.0), ..Mapping::named("x") };
        let columns = ["depth_mm", "force_N"].map(|name| (name.to_owned(), stated.clone())).into_iter().collect();
        assert_eq!((told(1e-3, 1.0, &columns), told(1.0, 1e4, &columns)), (Ok(None), Ok(None)));
    }
}
