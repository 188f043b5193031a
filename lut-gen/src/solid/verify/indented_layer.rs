//! Finite elements of a thin layer under a large ball, at small strain.

use super::thin_layer::ThinLayer;
use crate::solid::contact::{Ball, Interface, Penalty, Surface};
use crate::solid::element::Quadrature;
use crate::solid::law::{Hyperfoam, Law, Term};
use crate::solid::mesh::{BlockMesh, graded};
use crate::solid::model::Record;
use crate::solid::solve::{Course, Motion, Newton, SolveError, Stepping, System};

/// Ball radius over thickness: a contact as wide as the layer is thick is then 1/400 of the ball,
/// and strains are of that order.
const RADIUS: f64 = 400.0;
/// Radius of the layer over its thickness. A nearly incompressible layer that slides spreads as a whole, which makes
/// the force low by 0.4 % at 10 and 0.1 % at 20.
const WIDTH: f64 = 20.0;
/// Penetration at the mean pressure of Hertz over depth, inverted. Its effect, below 2 %, is removed to first order.
const STIFFNESS: f64 = 400.0;
/// Stations, evenly in the contact radius.
const STATIONS: usize = 24;

/// Forces on a layer over depth, computed by finite elements.
#[derive(Debug, Clone, PartialEq)]
pub struct IndentedLayer {
    /// The layer.
    pub layer: ThinLayer,
    /// Radius of the ball (mm).
    pub radius_mm: f64,
    /// Depth (mm) and force (N), freed from the penalty to first order.
    pub stations: Vec<(f64, f64)>,
}

impl IndentedLayer {
    /// Presses a ball of 400 thicknesses into the layer to `chi = sqrt(R d) / h`, in (0, 1.2].
    ///
    /// # Errors
    /// [`SolveError`].
    pub fn of(layer: ThinLayer, chi: f64) -> Result<Self, SolveError> {
        let h = layer.height_mm;
        let ball = Ball { radius_mm: RADIUS * h };
        let depth_mm = chi * chi * h * h / ball.radius_mm;
        let law = Hyperfoam::new(vec![Term { mu_mpa: layer.mu_mpa, alpha: 2.0, nu: layer.nu }])?;
        let r = graded(WIDTH, 1.0, |x| 0.015 + 0.02 * x + 0.3 * (x - 1.5 * chi).max(0.0));
        let down = graded(1.0, 1.0, |x| 0.015 + 0.2 * x);
        let r: Vec<f64> = r.iter().map(|x| x * h).collect();
        let z: Vec<f64> = down.iter().rev().map(|x| h - x * h).collect();
        let mesh = BlockMesh::from_lines(&r, &z);
        // Hertz's mean pressure, 4/(3 pi) E* sqrt(d / R)
        let pressure = 8.0 / 9.42 * law.shear_modulus_mpa() / (1.0 - layer.nu) * (depth_mm / ball.radius_mm).sqrt();
        let penalty = Penalty::linear(STIFFNESS * pressure / depth_mm);
        let surface = Surface::new(ball, Interface::default(), &mesh.nodes, &mesh.top, 1.6 * chi * h, 8, penalty);
        let system = System::new(&mesh, layer.base, surface, Quadrature::Reduced);
        // steps in units of the depth, not of the ball
        let stepping = Stepping { first: 0.002, largest: 1.0, stations: STATIONS, ..Stepping::of_ball(depth_mm) };
        let (material, motion) = (law.into(), Motion::ramp(depth_mm, depth_mm));
        let course = Course {
            system: &system,
            material: &material,
            motion: &motion,
            newton: Newton::default(),
            stepping,
            hertz: 1.0,
            label: &format!("thin layer, nu {}", layer.nu),
        };
        let record = Record::new(course.follow(&mut ())?);
        // the ends have no neighbour on one side
        let inner = 1..record.stations.len().saturating_sub(1).max(1);
        let stations = inner.map(|i| (record.stations[i].depth_mm, record.force_n[i])).collect();
        Ok(Self { layer, radius_mm: ball.radius_mm, stations })
    }

    /// Largest value of `measure(chi, depth_mm, force_n)` over the stations for which it has one; not
    /// a number when there is none.
    pub fn largest(&self, measure: impl Fn(f64, f64, f64) -> Option<f64>) -> f64 {
        let chi = |depth: f64| (self.radius_mm * depth).sqrt() / self.layer.height_mm;
        let values = self.stations.iter().filter_map(|&(d, f)| measure(chi(d), d, f));
        values.reduce(f64::max).unwrap_or(f64::NAN)
    }
}
