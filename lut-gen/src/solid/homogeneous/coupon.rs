//! A specimen that deforms homogeneously, and its stress along a programme.

use super::{Mode, Programme};
use crate::scalar::{Dual, Real};
use crate::solid::law::{Material, Parameter, Relaxation};
use crate::solid::solve::SolveError;

/// A specimen in which every point deforms alike.
#[derive(Debug, Clone, PartialEq)]
pub struct Coupon {
    /// Its material.
    pub material: Material,
    /// How it is deformed.
    pub mode: Mode,
    /// Undeformed area the force acts on (mm^2), positive.
    pub area_mm2: f64,
}

/// Stress and free stretch at every sample of a programme.
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    /// Nominal stress (MPa, force over undeformed area), negative in compression.
    pub stress_mpa: Vec<f64>,
    /// Lateral stretch that leaves the free side without stress (in equibiaxial stretch that of the thickness); 1 where
    /// nothing is free.
    pub side: Vec<f64>,
    /// Derivatives, in the order of the parameters asked for.
    pub sensitivities: Vec<StressSensitivity>,
}

/// Derivative of the nominal stress by one parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct StressSensitivity {
    /// The parameter.
    pub parameter: Parameter,
    /// `dP/dp` at every sample (MPa per unit of the parameter).
    pub stress_mpa: Vec<f64>,
}

impl Response {
    /// Force at every sample (N), negative in compression.
    #[must_use]
    pub fn force_n(&self, coupon: &Coupon) -> Vec<f64> {
        self.stress_mpa.iter().map(|p| p * coupon.area_mm2).collect()
    }
}

/// Newton's corrections of a lateral stretch before it is given up.
const CORRECTIONS: usize = 60;
/// Correction of its logarithm below which it is known: about the rounding of a nearly incompressible solid's stress.
const SETTLED: f64 = 1e-13;
/// Halvings of a factor of 16 in stretch: below rounding.
const HALVINGS: usize = 56;
/// Longest correction.
const STRIDE: f64 = 0.2;

/// A material point with the derivative by one parameter.
struct Track {
    material: Material<Dual>,
    history: Vec<Dual>,
    stress_mpa: Vec<f64>,
}

/// A point at the end of a step.
struct Point {
    gradient: [f64; 5],
    side: f64,
    /// `d(P : dF/ds) / ds` (MPa).
    stiffness: f64,
}

impl Coupon {
    /// Stretch at which the axis of the test is free of stress: 1, but for a warmed material ([`Material::warmed`]) that its sides hold or do not hold.
    ///
    /// # Errors
    /// As [`Coupon::follow`], for the material; [`SolveError::NoFreeSide`] when there is none within a factor of four.
    pub fn rest_stretch(&self) -> Result<f64, SolveError> {
        self.material.check()?;
        let grown = match self.material.thermal {
            None => return Ok(1.0),
            Some(_) if self.mode == Mode::SimpleShear => return Ok(1.0),
            Some(strain) => 1.0 + strain,
        };
        let relaxation = self.material.relaxation(0.0);
        let history = vec![0.0; self.material.history()];
        let pulls = |stretch: f64| {
            let point = self.balance(&relaxation, stretch, grown, &history)?;
            let (_, stress) = self.material.stress(&relaxation, &point.gradient, &history, None)?;
            Some(self.mode.measured(&stress) > 0.0)
        };
        let (mut low, mut high) = ((0.25 * grown).ln(), (4.0 * grown).ln());
        let lost = |x: f64| SolveError::NoFreeSide {
            mode: self.mode.to_string(),
            stretch: x.exp(),
            time_s: 0.0,
            case: self.material.label(),
        };
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if pulls(middle.exp()).ok_or_else(|| lost(middle))? { high = middle } else { low = middle }
        }
        Ok((0.5 * (low + high)).exp())
    }

    /// Stress along a programme, with its derivatives by the given parameters of the material.
    ///
    /// # Errors
    /// [`SolveError::Parameter`] for an area or a programme that makes no sense, [`SolveError::Law`] for a material
    /// out of range, [`SolveError::Unknown`] for a parameter the material does not have, and
    /// [`SolveError::NoFreeSide`] when no lateral stretch leaves the side without stress.
    pub fn follow(&self, programme: &Programme, parameters: &[Parameter]) -> Result<Response, SolveError> {
        self.material.check()?;
        if !(self.area_mm2.is_finite() && self.area_mm2 > 0.0) {
            return Err(SolveError::parameter("area_mm2", self.area_mm2, "must be positive"));
        }
        programme.check(self.mode)?;
        let mut tracks = parameters.iter().map(|&p| self.track(p)).collect::<Result<Vec<_>, _>>()?;
        let mut response = Response { stress_mpa: Vec::new(), side: Vec::new(), sensitivities: Vec::new() };
        let mut history = vec![0.0; self.material.history()];
        let (mut side, mut time_s) = (1.0, programme.time_s[0]);
        for step in programme.steps(self.mode, &self.material) {
            time_s += step.dt_s;
            let lost = || SolveError::NoFreeSide {
                mode: self.mode.to_string(),
                stretch: step.stretch,
                time_s,
                case: self.material.label(),
            };
            let relaxation = self.material.relaxation(step.dt_s);
            let point = self.balance(&relaxation, step.stretch, side, &history).ok_or_else(lost)?;
            let mut new = history.clone();
            let (_, stress) =
                self.material.stress(&relaxation, &point.gradient, &history, Some(&mut new)).ok_or_else(lost)?;
            for track in &mut tracks {
                let rate = track.advance(self.mode, step.dt_s, step.stretch, &point).ok_or_else(lost)?;
                if step.sample {
                    track.stress_mpa.push(rate);
                }
            }
            (history, side) = (new, point.side);
            if step.sample {
                response.stress_mpa.push(self.mode.measured(&stress));
                response.side.push(side);
            }
        }
        let named = parameters.iter().zip(tracks);
        response.sensitivities =
            named.map(|(&parameter, t)| StressSensitivity { parameter, stress_mpa: t.stress_mpa }).collect();
        Ok(response)
    }

    fn track(&self, parameter: Parameter) -> Result<Track, SolveError> {
        if !self.material.parameters().iter().any(|(p, _)| *p == parameter) {
            let expected = format!("is no parameter of {}", self.material.label());
            return Err(SolveError::Unknown { parameter: parameter.to_string(), expected });
        }
        let history = vec![Dual::from(0.0); self.material.history()];
        Ok(Track { material: self.material.lift(parameter), history, stress_mpa: Vec::new() })
    }

    /// The lateral stretch at which `q = P : dF/ds` is zero, by Newton's method in its logarithm `x`:
    /// `d(s q)/dx = s q + s^2 dF/ds : dP/dF : dF/ds`.
    fn balance(&self, relaxation: &Relaxation, stretch: f64, start: f64, history: &[f64]) -> Option<Point> {
        let direction = self.mode.direction();
        if !self.mode.has_free_side() {
            return Some(Point { gradient: self.mode.gradient(stretch, 1.0), side: 1.0, stiffness: 1.0 });
        }
        let mut x = start.ln();
        for _ in 0..CORRECTIONS {
            let side = x.exp();
            let gradient = self.mode.gradient(stretch, side);
            let r = self.material.respond(relaxation, &gradient, history)?;
            let along = |v: &[f64; 5]| v.iter().zip(&direction).map(|(a, b)| a * b).sum::<f64>();
            let q = along(&r.stress);
            let stiffness = along(&r.tangent.map(|row| along(&row)));
            let slope = side * q + side * side * stiffness;
            let change = if slope > 0.0 { (-side * q / slope).clamp(-STRIDE, STRIDE) } else { -q.signum() * STRIDE };
            if !change.is_finite() {
                return None;
            }
            if change.abs() < SETTLED && slope > 0.0 {
                return Some(Point { gradient, side, stiffness });
            }
            x += change;
        }
        None
    }
}

impl Track {
    /// Carries the history through a step; returns the derivative of the measured stress.
    fn advance(&mut self, mode: Mode, dt_s: f64, stretch: f64, at: &Point) -> Option<f64> {
        let relaxation = self.material.relaxation(dt_s);
        let mut side = Dual::from(at.side);
        if mode.has_free_side() {
            let still = at.gradient.map(Dual::from);
            let (_, stress) = self.material.stress(&relaxation, &still, &self.history, None)?;
            let rest = stress.iter().zip(mode.direction()).map(|(p, d)| p.derivative * d).sum::<f64>();
            side.derivative = -rest / at.stiffness;
        }
        let mut new = self.history.clone();
        let gradient = mode.gradient(stretch, side);
        let (_, stress) = self.material.stress(&relaxation, &gradient, &self.history, Some(&mut new))?;
        self.history = new;
        Some(mode.measured(&stress).derivative())
    }
}
