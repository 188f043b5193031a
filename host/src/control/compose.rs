//! f3(f2(f1)): from the finger's force by yield stress and flux density to the coil's current
//! (thesis Eqs. 39-42, Fig. 61).

use lut_gen::magnet::curve::{FluxCurve, Rising};
use lut_gen::magnet::fluid::Fluid;

use super::curve::{ControlCurve, Row};
use super::study::Study;

/// What a current makes of the fluid.
#[derive(Debug, Clone, PartialEq)]
pub struct Links {
    /// The magnet's name.
    pub magnet: String,
    /// Flux density in the fluid over current.
    pub flux: FluxCurve,
    /// The fluid's name.
    pub fluid: String,
    /// Its yield stress over flux density.
    pub law: Fluid,
    /// Largest current of the driver, A.
    pub most_a: f64,
}

/// Where a wanted yield stress lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Current {
    /// Flux density, T, and current, A.
    Made(f64, f64),
    /// Less flux density than the magnet leaves without current.
    Below,
    /// More than the largest current makes, or than the fluid can bear.
    Above,
}

/// Why no control curve comes of a study.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Uncomposed {
    /// No point has a place on material, plate and magnet at once.
    #[error("no force of the display lies on the material's curve too; expected a travel at which both press")]
    Nowhere,
    /// The travels do not rise with the force.
    #[error("the force of the {0} does not rise with its travel; expected one that does")]
    Falls(&'static str),
}

/// Uniaxial over shear yield stress of von Mises.
pub const UNIAXIAL: f64 = 1.732_050_807_568_877_2;
/// Rows between two travels of the study.
const BETWEEN: usize = 4;

impl Links {
    /// What a shear yield stress (kPa) needs.
    #[must_use]
    pub fn current(&self, yield_kpa: f64) -> Current {
        if yield_kpa <= 0.0 {
            let leaves = self.flux.flux_t(0.0) > self.flux.bound_t();
            return if leaves { Current::Below } else { Current::Made(0.0, 0.0) };
        }
        let Some(flux_t) = self.law.flux_for_yield(yield_kpa) else { return Current::Above };
        if flux_t < self.flux.flux_t(0.0) {
            return Current::Below;
        }
        match self.flux.current_a(flux_t) {
            Some(current_a) if current_a <= self.most_a => Current::Made(flux_t, current_a),
            _ => Current::Above,
        }
    }

    /// Flux density, T, and current, A, for a shear yield stress (kPa): held at the magnet's end where it cannot make it.
    #[must_use]
    pub fn made(&self, yield_kpa: f64) -> (f64, f64) {
        match self.current(yield_kpa) {
            Current::Made(flux_t, current_a) => (flux_t, current_a),
            Current::Below => (self.flux.flux_t(0.0), 0.0),
            Current::Above => (self.flux.flux_t(self.most_a), self.most_a),
        }
    }

    /// Largest shear yield stress that the driver's largest current makes, kPa.
    #[must_use]
    pub fn most_kpa(&self) -> f64 {
        self.law.yield_at_flux(self.flux.flux_t(self.most_a.min(self.flux.most_a())))
    }
}

/// The control curve of a study.
///
/// The bound of the current holds the magnet's discretisation, the straight lines between rows, and
/// what a finer mesh of finger and fluid changes. What is not known of the fluid is in none of them.
///
/// # Errors
/// [`Uncomposed`].
pub fn compose(
    study: &Study,
    links: &Links,
    (material, finger): (&str, &str),
    provenance: &str,
) -> Result<ControlCurve, Uncomposed> {
    let on = |what: &'static str, force_n: &[f64]| over(force_n, &study.wanted.travel_mm, what);
    let (soft, plate) =
        (on("finger on the material", &study.wanted.force_n)?, on("finger on a plate", &study.plate_n)?);
    let area = over(&study.wanted.force_n, &study.wanted.area_mm2, "finger on the material")?;
    let points = study.followed.points();
    let (force, stress): (Vec<f64>, Vec<f64>) = std::iter::once(&(0.0, 0.0)).chain(points).copied().unzip();
    let gains: Vec<f64> = std::iter::once(0.0).chain(study.gains.iter().copied()).collect();
    let most_n = soft.last().0.min(plate.last().0);
    let row = |force_n: f64| {
        let yield_kpa = 1e3 * study.followed.at(force_n) / UNIAXIAL;
        let (flux_t, current_a) = links.made(yield_kpa);
        let loop_gain = gains[force.partition_point(|f| *f < force_n).min(gains.len() - 1)];
        let travel_mm = soft.at(force_n);
        let shaft_mm = (travel_mm - plate.at(force_n)).max(0.0);
        Row { force_n, travel_mm, area_mm2: area.at(force_n), shaft_mm, yield_kpa, flux_t, current_a, loop_gain }
    };
    let mut forces = rows(&force, most_n);
    let reached: Vec<bool> = forces.iter().map(|f| reached(study, links, *f)).collect();
    let from = reached.iter().position(|r| *r).ok_or(Uncomposed::Nowhere)?;
    let last = from + reached[from..].iter().take_while(|r| **r).count() - 1;
    let mut reachable_n = (forces[from], forces[last]);
    // the magnet ends between two rows: a row of its own there
    if let Some(next) = forces.get(last + 1).copied() {
        reachable_n.1 = last_made(forces[last], next, |force_n| self::reached(study, links, force_n));
        if reachable_n.1 > forces[last] {
            forces.insert(last + 1, reachable_n.1);
        }
    }
    if forces.len() < 2 || stress.len() < 2 {
        return Err(Uncomposed::Nowhere);
    }
    let rows: Vec<Row> = forces.iter().map(|f| row(*f)).collect();
    let bound_a = bound(&rows, &row, links, study.mesh_n.unwrap_or(0.0), reachable_n);
    Ok(ControlCurve {
        material: material.to_owned(),
        magnet: links.magnet.clone(),
        finger: finger.to_owned(),
        fluid: links.fluid.clone(),
        bound_a: bound_a.min(links.most_a),
        reachable_n,
        felt_error: Some((study.cubic.error.force, study.cubic.error.area)),
        provenance: provenance.to_owned(),
        rows,
    })
}

/// Something over force, from (0, 0) on.
fn over(force_n: &[f64], value: &[f64], what: &'static str) -> Result<Rising, Uncomposed> {
    let from_zero = |list: &[f64]| std::iter::once(0.0).chain(list.iter().copied()).collect();
    Rising::new(from_zero(force_n), from_zero(value)).map_err(|_| Uncomposed::Falls(what))
}

/// Forces of the rows: those of the study and some between, up to the largest.
fn rows(force: &[f64], most_n: f64) -> Vec<f64> {
    let mut rows: Vec<f64> = force
        .windows(2)
        .flat_map(|w| (0..BETWEEN).map(move |i| w[0] + (w[1] - w[0]) * i as f64 / BETWEEN as f64))
        .chain(force.last().copied())
        .filter(|f| *f < most_n)
        .collect();
    if force.last().is_some_and(|f| *f >= most_n) {
        rows.push(most_n);
    }
    rows
}

fn reached(study: &Study, links: &Links, force_n: f64) -> bool {
    matches!(links.current(1e3 * study.followed.at(force_n) / UNIAXIAL), Current::Made(..))
}

/// The last place that the magnet makes, between one that it does and one that it does not.
pub(super) fn last_made(mut within: f64, mut beyond: f64, made: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..40 {
        let middle = 0.5 * (within + beyond);
        if made(middle) { within = middle } else { beyond = middle }
    }
    within
}

/// Largest error of a current between these forces, A.
fn bound(rows: &[Row], row: &dyn Fn(f64) -> Row, links: &Links, mesh_n: f64, (from, to): (f64, f64)) -> f64 {
    let mut bound: f64 = 0.0;
    for w in rows.windows(2).filter(|w| w[0].force_n >= from && w[1].force_n <= to) {
        let width = w[1].force_n - w[0].force_n;
        let between = [0.25, 0.5, 0.75].map(|part| {
            let line = w[0].current_a + part * (w[1].current_a - w[0].current_a);
            (row(w[0].force_n + part * width).current_a - line).abs()
        });
        let rise = w[1].current_a - w[0].current_a;
        let flux = (w[1].flux_t - w[0].flux_t).max(f64::MIN_POSITIVE);
        let magnet = if rise > 0.0 { links.flux.bound_t() * rise / flux } else { 0.0 };
        bound = bound.max(between.into_iter().fold(0.0, f64::max) + magnet + mesh_n * (rise / width).max(0.0));
    }
    bound
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use lut_gen::magnet::curve::Built;
    use lut_gen::magnet::fluid::Oil;
    use lut_gen::pad::control::curve::Curve;
    use lut_gen::pad::control::felt::{Error, Felt};
    use lut_gen::pad::control::latch::Followed;
    use lut_gen::pad::control::search::Found;

    use super::*;

    /// A magnet that saturates, of some strength, with some remanence.
    fn links(tesla: f64, remanence_t: f64) -> Links {
        let points: Vec<(f64, f64)> =
            (0..=20).map(|i| 0.125 * f64::from(i)).map(|a| (a, tesla * (a / 1.5).tanh())).collect();
        let built = Built { remanence_t, ..Built::default() };
        Links {
            magnet: "bent".to_owned(),
            flux: FluxCurve::new(&points, 1e-5, built).unwrap(),
            fluid: "MRF-122EG".to_owned(),
            law: Fluid::carlson(0.22, Oil::Hydrocarbon).unwrap(),
            most_a: 2.5,
        }
    }

    /// A foam whose force rises with the square of the travel, shown by up to 9 kPa of yield stress.
    fn study() -> Study {
        let travel_mm: Vec<f64> = (1..=12).map(|i| f64::from(i) / 3.0).collect();
        let force_n: Vec<f64> = travel_mm.iter().map(|u| 0.1 * u * u).collect();
        let felt = Felt { area_mm2: travel_mm.iter().map(|u| 25.0 * u).collect(), force_n, travel_mm };
        let curve = Curve::Cubic([1e-3, 0.0, 1e-4]);
        let stress: Vec<f64> = felt.travel_mm.iter().map(|u| curve.at(*u)).collect();
        let error = Error { force: 0.1, area: 0.2 };
        let found = Found { curve, felt: felt.clone(), error, rounds: 1, settled: true };
        Study {
            plate_n: felt.force_n.iter().map(|f| 3.0 * f).collect(),
            averages: Vec::new(),
            tried: Vec::new(),
            best: None,
            followed: Followed::new(&felt.force_n, &stress).unwrap(),
            cut: vec![false; 12],
            gains: vec![0.3; 12],
            cycle: None,
            mesh_n: Some(1e-3),
            young_mpa: 1.0,
            wanted: felt,
            cubic: found,
        }
    }

    fn composed(links: &Links) -> ControlCurve {
        compose(&study(), links, ("foam", "round"), "a test").unwrap()
    }

    #[test]
    fn a_current_makes_the_yield_stress_that_is_wanted_within_the_bound() {
        let (links, study) = (links(0.5, 0.0), study());
        let curve = composed(&links);
        assert_eq!(curve.reachable_n, (0.0, 1.6));
        for row in &curve.rows {
            let made = links.law.yield_at_flux(links.flux.flux_t(row.current_a));
            assert!((made - row.yield_kpa).abs() < 1e-6 * row.yield_kpa.max(1.0), "{row:?} {made}");
        }
        // straight lines, as the board has them
        for w in curve.rows.windows(2) {
            for part in [0.1, 0.5, 0.9] {
                let force_n = w[0].force_n + part * (w[1].force_n - w[0].force_n);
                let line = w[0].current_a + part * (w[1].current_a - w[0].current_a);
                let Current::Made(_, exact) = links.current(1e3 * study.followed.at(force_n) / UNIAXIAL) else {
                    unreachable!("{force_n} N is reached")
                };
                assert!((line - exact).abs() < curve.bound_a, "{force_n} N: {line} {exact} {}", curve.bound_a);
            }
        }
        assert!(curve.bound_a < 0.05, "{}", curve.bound_a);
        // the shaft gives way by what the finger does not: of three times the force at the same travel
        let last = curve.rows.last().unwrap();
        assert!(
            (last.travel_mm - 4.0).abs() < 1e-9 && (last.shaft_mm - 4.0 * (1.0 - (1.0_f64 / 3.0).sqrt())).abs() < 0.02
        );
        assert!(ControlCurve::parse(std::path::Path::new("c.csv"), &curve.to_csv().unwrap()).is_ok());
    }

    #[test]
    fn what_a_weak_magnet_cannot_make_is_marked_and_held_at_its_limit() {
        let links = links(0.1, 0.0);
        let curve = composed(&links);
        let (from, to) = curve.reachable_n;
        assert!(from == 0.0 && to > 0.1 && to < 1.5, "{to}");
        for row in &curve.rows {
            assert_eq!(row.current_a >= 2.5 - 1e-6, row.force_n >= to, "{row:?}");
        }
        // at its end the magnet makes what it can
        let end = curve.rows.iter().find(|row| row.force_n == to).unwrap();
        assert!((end.yield_kpa / links.most_kpa() - 1.0).abs() < 1e-6);
    }

    #[test]
    fn less_than_the_remanence_cannot_be_made_either() {
        let curve = composed(&links(0.5, 0.02));
        assert!(curve.reachable_n.0 > 0.0 && curve.reachable_n.1 == 1.6, "{:?}", curve.reachable_n);
        assert!(curve.rows.iter().filter(|row| row.force_n < curve.reachable_n.0).all(|row| row.current_a == 0.0));
    }

    #[test]
    fn a_study_whose_force_falls_is_no_curve() {
        let mut study = study();
        study.wanted.force_n[5] = 0.0;
        let text = compose(&study, &links(0.5, 0.0), ("foam", "round"), "a test").unwrap_err().to_string();
        assert_eq!(
            text,
            "the force of the finger on the material does not rise with its travel; expected one that does"
        );
    }
}
