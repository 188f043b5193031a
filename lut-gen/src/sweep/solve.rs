//! The simulation of one point.

use super::{Forces, Parameter, Point, SweepBase, SweepLaw, SweepSpec};
use crate::solid::contact::{Ball, Interface};
use crate::solid::law::{Hyperfoam, Material, Ogden, PronyTerm, Term};
use crate::solid::model::{Resolution, Simulation, Specimen};
use crate::solid::solve::{Base, Motion, SolveError};

/// Solves one point of a sweep: one curve a rate.
///
/// # Errors
/// See [`SolveError`].
pub fn solve_point(spec: &SweepSpec, point: &Point) -> Result<Forces, SolveError> {
    let rates = &spec.motion.rates_mm_s;
    let first = simulation(spec, point, rates.first().copied().unwrap_or(1.0))?;
    if first.material.is_elastic() {
        // Then the force depends neither on the rate nor on the time of the hold.
        return Ok(vec![curve(spec, point, first)?; rates.len()]);
    }
    rates.iter().map(|rate| curve(spec, point, simulation(spec, point, *rate)?)).collect()
}

/// The ramp at one rate, and the hold after it.
fn curve(spec: &SweepSpec, point: &Point, ramp: Simulation) -> Result<Vec<f64>, SolveError> {
    let depths = &spec.motion.depths_mm;
    let holds = if ramp.material.is_elastic() { &[][..] } else { &spec.motion.holds_s };
    let mut whole = ramp.clone();
    let mut before_s = 0.0;
    for hold_s in holds {
        // A segment ends at each time wanted, so that an equilibrium lies there.
        whole.motion = whole.motion.hold(hold_s - before_s);
        before_s = *hold_s;
    }
    let record = whole.solve()?;
    let depth_mm = spec.motion.depth_mm();
    let (profile, _) = ramp.ramp_profile(&record, depth_mm, point.refinement);
    let mut forces: Vec<f64> = depths.iter().map(|d| profile.force_n(*d)).collect();
    // What the smooth ramp ends with relaxes as the record does.
    let end_s = ramp.motion.duration_s();
    let end_n = forces.last().copied().unwrap_or(0.0);
    forces.extend(holds.iter().map(|t| end_n * record.force_at(end_s + t) / record.force_at(end_s)));
    forces.resize(spec.motion.samples(), end_n);
    Ok(forces)
}

fn simulation(spec: &SweepSpec, point: &Point, rate_mm_s: f64) -> Result<Simulation, SolveError> {
    let get = |p: Parameter| {
        let absent = || SolveError::parameter(p.name(), f64::NAN, "must be fixed or an axis");
        point.get(p).ok_or_else(absent)
    };
    let (mu_mpa, alpha) = (get(Parameter::Mu)?, get(Parameter::Alpha)?);
    let mut material: Material = match spec.law {
        SweepLaw::Hyperfoam => Hyperfoam::new(vec![Term { mu_mpa, alpha, nu: get(Parameter::Nu)? }])?.into(),
        SweepLaw::Ogden => {
            let d_per_mpa = match point.get(Parameter::DMu) {
                Some(product) => product / mu_mpa,
                None => get(Parameter::D)?,
            };
            Ogden::one_term(mu_mpa, alpha, d_per_mpa)?.into()
        }
    };
    if let (Some(g), Some(k)) = (point.get(Parameter::G), point.get(Parameter::K))
        && (g > 0.0 || k > 0.0)
    {
        material = material.relaxing(vec![PronyTerm { g, k, tau_s: get(Parameter::Tau)? }])?;
    }
    let base = match spec.base {
        SweepBase::Bonded => Base::Bonded,
        SweepBase::Sliding => Base::Sliding,
    };
    Ok(Simulation {
        material,
        specimen: Specimen { height_mm: get(Parameter::Height)?, radius_mm: get(Parameter::SpecimenRadius)?, base },
        ball: Ball { radius_mm: get(Parameter::BallRadius)? },
        interface: Interface { friction: get(Parameter::Friction)?, adhesion: None },
        motion: Motion::ramp(spec.motion.depth_mm(), rate_mm_s),
        resolution: Resolution::Refined(point.refinement),
    })
}

/// Mesh of the probe in [`engine`].
const PROBE_REFINEMENT: f64 = 0.4;

/// Name of the engine that computes a sweep: its version, and what it answers to the sweep's first point on a
/// coarse mesh, to five digits. Journals of two engines are not merged: a change of the solver shows here even
/// where nobody raised the version.
#[must_use]
pub fn engine(spec: &SweepSpec) -> String {
    let version = concat!("lut-gen ", env!("CARGO_PKG_VERSION"));
    let probe = spec.point(0).map(|p| solve_point(spec, &p.on_mesh(PROBE_REFINEMENT)));
    let answer = match probe {
        Some(Ok(forces)) => {
            let last = forces.iter().filter_map(|c| c.last()).map(|f| format!("{f:.4e}"));
            format!("{} N", last.collect::<Vec<_>>().join(", "))
        }
        Some(Err(error)) => error.to_string(),
        None => "nothing".to_owned(),
    };
    format!("{version}; answers {answer} to a coarse probe")
}
