//! A ball that goes down at a constant rate and then may stand: the force and its derivatives on
//! fixed grids, as identification wants them.

use super::chebyshev::{clenshaw, least_squares};
use super::force::DEPTH;
use super::{Axis, Compression, Record, Sensitivity, Simulation, Tracker};
use crate::solid::law::Parameter;
use crate::solid::solve::{Motion, SolveError, Target};

/// Chebyshev nodes of a ramp, over `s = sqrt(d / d_max)`: as many as the terms of the continuous force model.
pub const RAMP_NODES: usize = DEPTH.nodes;

/// Times of a hold, see [`Press::hold_times`].
pub const HOLD_NODES: usize = 24;

/// The first decade of a hold's grid that is resolved, as a share of its duration.
const FIRST_SHARE: f64 = 1e-3;

/// Terms of the polynomial in `s` through a derivative's stations: less than the force's, since it
/// has no limit to hold on to and scatters more.
const SLOPE_TERMS: usize = 7;
/// Terms through the force between platens, which has no limit to hold on to either but scatters less.
const FORCE_TERMS: usize = 9;

/// Force of a press on fixed grids, with its derivatives.
///
/// Two presses of one motion, whatever the material, have values at the same places, so that they can
/// be interpolated between. The logarithm is stored: forces of different materials span decades,
/// and a shear modulus that scales the force adds a constant.
#[derive(Debug, Clone, PartialEq)]
pub struct Press {
    /// Largest depth (mm).
    pub depth_max_mm: f64,
    /// `ln(F / d^1.5)` (F in N, d in mm) at the nodes of [`Press::ramp_axis`].
    pub ramp: Vec<f64>,
    /// Its derivative by each parameter that was asked for.
    pub ramp_by: Vec<Vec<f64>>,
    /// Duration of the hold (s), 0 without one.
    pub hold_s: f64,
    /// `ln(F / F_peak)` at [`Press::hold_times`], empty without a hold.
    pub hold: Vec<f64>,
    /// Its derivative by each parameter.
    pub hold_by: Vec<Vec<f64>>,
    /// Relative scatter of the computed stations about the smooth ramp.
    pub scatter: f64,
    /// Unknowns of the mesh.
    pub unknowns: usize,
}

impl Press {
    /// The axis of a ramp's nodes: `s = sqrt(d / d_max)` from 0 to 1.
    #[must_use]
    pub fn ramp_axis() -> Axis {
        DEPTH
    }

    /// Times (s) since the peak at which a hold is given: evenly in `ln(1 + t / (0.001 T))`, the last one is its end.
    #[must_use]
    pub fn hold_times(hold_s: f64) -> Vec<f64> {
        let places = (1..=HOLD_NODES).map(|k| k as f64 / HOLD_NODES as f64);
        places.map(|u| FIRST_SHARE * hold_s * (u * (1.0 / FIRST_SHARE).ln_1p()).exp_m1()).collect()
    }

    /// Place of a time (s) since the peak on the even axis of [`Press::hold_times`]: 0 at the peak, [`HOLD_NODES`] at the end.
    #[must_use]
    pub fn hold_place(hold_s: f64, time_s: f64) -> f64 {
        HOLD_NODES as f64 * (time_s.max(0.0) / (FIRST_SHARE * hold_s)).ln_1p() / (1.0 / FIRST_SHARE).ln_1p()
    }
}

impl Simulation {
    /// The press with derivatives by the given parameters. The motion is a ramp from touch to a depth, and
    /// perhaps a hold of that depth.
    ///
    /// # Errors
    /// As [`Simulation::curve`] and [`Simulation::sensitivities`].
    pub fn press(&self, parameters: &[Parameter]) -> Result<Press, SolveError> {
        let (ramp_alone, depth_max_mm, hold_s) = self.ramp_and_hold()?;
        let mut tracker = Tracker::new(parameters);
        let refinement = self.resolution.finest();
        let (path, unknowns) = self.smooth_path(refinement, &mut tracker)?;
        let record = Record::new(path);
        let slopes = tracker.finish();
        let (profile, scatter) = ramp_alone.ramp_profile(&record, depth_max_mm, refinement);
        self.trust_record(&record, scatter)?;
        let axis = Press::ramp_axis();
        let ramp: Vec<f64> = (0..RAMP_NODES)
            .map(|k| {
                let s = axis.node(k);
                let d = depth_max_mm * s * s;
                (profile.force_n(d).max(f64::MIN_POSITIVE) / d.powf(1.5)).ln()
            })
            .collect();
        let end_s = self.motion.segments[0].duration_s;
        let ramp_by = slopes.iter().map(|one| along_ramp(&record, one, end_s, depth_max_mm)).collect();
        let (hold, hold_by) = along_hold(&record, &slopes, end_s, hold_s);
        Ok(Press { depth_max_mm, ramp, ramp_by, hold_s, hold, hold_by, scatter, unknowns })
    }

    /// The ramp alone, its depth (mm), and the duration (s) of the hold after it, 0 without one.
    fn ramp_and_hold(&self) -> Result<(Self, f64, f64), SolveError> {
        let held = match self.motion.segments.as_slice() {
            [_] => 0.0,
            _ => ramp_and_hold(&self.motion)?.1,
        };
        let mut ramp = self.clone();
        ramp.motion.segments.truncate(1);
        self.check()?;
        let depth_max_mm = ramp.ramp()?;
        Ok((ramp, depth_max_mm, held))
    }
}

impl Compression {
    /// The press of a cylinder between platens, with derivatives by the given parameters: as that of a ball, but with
    /// `ln(F / d)` on the ramp, `d` the shortening (a whole face is met at once). The motion is a ramp to a
    /// shortening, and perhaps a hold of it.
    ///
    /// # Errors
    /// As [`Compression::sensitivities`]; [`SolveError::Parameter`] for another motion.
    pub fn press(&self, parameters: &[Parameter]) -> Result<Press, SolveError> {
        let (depth_max_mm, hold_s) = ramp_and_hold(&self.motion)?;
        let (record, slopes) = self.sensitivities(parameters)?;
        let end_s = self.motion.segments[0].duration_s;
        let forces: Vec<f64> = record.force_n.iter().zip(&record.depth_mm).map(|(f, d)| (f / d).ln()).collect();
        let (ramp, scatter) = smoothed(&record, &forces, end_s, depth_max_mm, FORCE_TERMS);
        let ramp_by = slopes.iter().map(|one| along_ramp(&record, one, end_s, depth_max_mm)).collect();
        let (hold, hold_by) = along_hold(&record, &slopes, end_s, hold_s);
        let unknowns = 2 * self.mesh().nodes.len();
        Ok(Press { depth_max_mm, ramp, ramp_by, hold_s, hold, hold_by, scatter, unknowns })
    }
}

/// Depth (mm) of a ramp from touch, and the duration (s) of the hold after it, 0 without one.
fn ramp_and_hold(motion: &Motion) -> Result<(f64, f64), SolveError> {
    match motion.segments.as_slice() {
        [one] => match one.end {
            Target::DepthMm(depth_mm) => Ok((depth_mm, 0.0)),
            Target::ForceN(_) => Err(no_press(motion)),
        },
        [first, second] => match (first.end, second.end) {
            (Target::DepthMm(a), Target::DepthMm(b)) if a == b => Ok((a, second.duration_s)),
            _ => Err(no_press(motion)),
        },
        _ => Err(no_press(motion)),
    }
}

fn no_press(motion: &Motion) -> SolveError {
    let count = motion.segments.len() as f64;
    SolveError::parameter("segments of the motion", count, "but a press is a ramp from touch and at most one hold")
}

/// Logarithmic derivative of the force at the ramp's nodes, from a polynomial in `s` through the stations.
fn along_ramp(record: &Record, slope: &Sensitivity, end_s: f64, depth_max_mm: f64) -> Vec<f64> {
    let relative: Vec<f64> = slope.force.iter().zip(&record.force_n).map(|(by, force)| by / force).collect();
    smoothed(record, &relative, end_s, depth_max_mm, SLOPE_TERMS).0
}

/// A value of every station as a polynomial in `s` through those of the ramp: at its nodes, and the rms of what it leaves.
fn smoothed(record: &Record, values: &[f64], end_s: f64, depth_max_mm: f64, terms: usize) -> (Vec<f64>, f64) {
    let stations: Vec<(f64, f64)> = record
        .stations
        .iter()
        .zip(record.force_n.iter().zip(values))
        .take_while(|(station, _)| station.time_s <= end_s * (1.0 + 1e-12))
        .filter(|(_, (force, _))| **force > 0.0)
        .map(|(station, (_, value))| ((station.depth_mm / depth_max_mm).sqrt(), *value))
        .collect();
    // The scatter of the contact's edge falls with the contact's size.
    let points: Vec<(f64, f64, f64)> = stations.iter().map(|(s, by)| (2.0 * s - 1.0, *by, *s)).collect();
    let coefficients = least_squares(&points, terms);
    let at = |s: f64| clenshaw(&coefficients, 2.0 * s - 1.0);
    let axis = Press::ramp_axis();
    let nodes = (0..RAMP_NODES).map(|k| at(axis.node(k))).collect();
    let square = stations.iter().map(|(s, by)| (s * (at(*s) - by)).powi(2)).sum::<f64>();
    (nodes, (square / stations.len().max(1) as f64).sqrt())
}

/// `ln(F / F_peak)` and its derivatives at the times of the hold.
fn along_hold(record: &Record, slopes: &[Sensitivity], end_s: f64, hold_s: f64) -> (Vec<f64>, Vec<Vec<f64>>) {
    if hold_s <= 0.0 {
        return (Vec::new(), slopes.iter().map(|_| Vec::new()).collect());
    }
    // the peak is the last station of the ramp
    let peak = record.stations.partition_point(|s| s.time_s <= end_s * (1.0 + 1e-12)).saturating_sub(1);
    let places: Vec<f64> =
        record.stations[peak..].iter().map(|s| Press::hold_place(hold_s, s.time_s - end_s)).collect();
    let on_grid = |values: Vec<f64>| -> Vec<f64> {
        (1..=HOLD_NODES).map(|k| through_four(&places, &values, k as f64) - values[0]).collect()
    };
    let force = &record.force_n;
    let value = on_grid(force[peak..].iter().map(|f| f.max(f64::MIN_POSITIVE).ln()).collect());
    let by = slopes
        .iter()
        .map(|one| on_grid(one.force[peak..].iter().zip(&force[peak..]).map(|(by, f)| by / f).collect()))
        .collect();
    (value, by)
}

/// The cubic through the four points around `x`; fewer points give a polynomial of lower order.
fn through_four(xs: &[f64], ys: &[f64], x: f64) -> f64 {
    let next = xs.partition_point(|p| *p < x);
    let first = next.saturating_sub(2).min(xs.len().saturating_sub(4));
    let points = first..(first + 4).min(xs.len());
    points
        .clone()
        .map(|i| ys[i] * points.clone().filter(|j| *j != i).map(|j| (x - xs[j]) / (xs[i] - xs[j])).product::<f64>())
        .sum()
}
