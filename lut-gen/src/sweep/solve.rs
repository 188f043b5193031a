//! The simulation of one point.

use super::{Forces, Parameter, Point, SweepBase, SweepLaw, SweepSpec};
use crate::contact::Ball;
use crate::law::{Hyperfoam, Term};
use crate::model::{Indentation, Resolution, Specimen};
use crate::solve::{Base, SolveError};

/// Solves one point of a sweep: one curve a rate.
///
/// # Errors
/// See [`SolveError`]; a law or an effect that the engine does not have yet is one of them.
pub fn solve_point(spec: &SweepSpec, point: &Point) -> Result<Forces, SolveError> {
    let get = |p: Parameter| {
        let absent = || SolveError::Parameter {
            parameter: p.name(),
            value: f64::NAN,
            expected: "must be fixed or an axis".to_owned(),
        };
        point.get(p).ok_or_else(absent)
    };
    elastic_only(spec, point)?;
    let law = Hyperfoam::new(vec![Term {
        mu_mpa: get(Parameter::Mu)?,
        alpha: get(Parameter::Alpha)?,
        nu: get(Parameter::Nu)?,
    }])?;
    let base = match spec.base {
        SweepBase::Bonded => Base::Bonded,
        SweepBase::Sliding => Base::Sliding,
    };
    let curve = Indentation {
        law,
        specimen: Specimen { height_mm: get(Parameter::Height)?, radius_mm: get(Parameter::SpecimenRadius)?, base },
        ball: Ball { radius_mm: get(Parameter::BallRadius)? },
        depth_mm: spec.motion.depth_mm(),
        resolution: Resolution::Refined(point.refinement),
    }
    .solve_at(&spec.motion.depths_mm)?;
    // Without relaxation the force depends neither on the rate nor on the time of the hold.
    let held = curve.force_n.last().copied().unwrap_or(0.0);
    let mut forces = curve.force_n;
    forces.resize(spec.motion.samples(), held);
    Ok(vec![forces; spec.motion.rates_mm_s.len()])
}

/// Refuses what the engine cannot simulate yet.
fn elastic_only(spec: &SweepSpec, point: &Point) -> Result<(), SolveError> {
    let refuse = |parameter, value| {
        let expected = "is not simulated yet; sweeps cover frictionless hyperfoam without relaxation".to_owned();
        Err(SolveError::Parameter { parameter, value, expected })
    };
    if spec.law == SweepLaw::Ogden {
        return refuse("ogden with alpha", point.get(Parameter::Alpha).unwrap_or(f64::NAN));
    }
    for p in [Parameter::G, Parameter::K, Parameter::Friction] {
        if let Some(value) = point.get(p).filter(|v| *v != 0.0) {
            return refuse(p.name(), value);
        }
    }
    Ok(())
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
