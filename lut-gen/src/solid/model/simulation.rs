//! A ball of any motion on a specimen of any material.

use super::specimen::SIZES;
use super::{Record, Resolution, Specimen};
use crate::scalar::{Dual, Real};
use crate::solid::contact::{Ball, Interface, Penalty, Surface};
use crate::solid::element::Quadrature;
use crate::solid::law::{Law, Material, Parameter, Strained};
use crate::solid::mesh::{BlockMesh, Sizes};
use crate::solid::solve::{Base, Course, Motion, Newton, Observer, Path, SolveError, Stepping, System};
use crate::solid::verify::hertz_force_n;

/// Everything that decides the force on the ball.
#[derive(Debug, Clone, PartialEq)]
pub struct Simulation {
    /// Material of the block.
    pub material: Material,
    /// The block.
    pub specimen: Specimen,
    /// The ball.
    pub ball: Ball,
    /// Friction and adhesion between them.
    pub interface: Interface,
    /// What the ball does.
    pub motion: Motion,
    /// Mesh.
    pub resolution: Resolution,
}

/// Ball radii over penetration, of a deep press: at the pressure of first contact, and at the largest expected. Its
/// effect on the force is removed to first order.
const STIFF: f64 = 400.0;
const STIFFEST: f64 = 200.0;

/// Pressure of first contact, in units of `mu`.
const FIRST_PRESSURE: f64 = 1.0;

/// Compression of the ball's neighbourhood beyond that of the whole block, and the least stretch
/// the largest pressure is estimated at.
const NEIGHBOURHOOD: f64 = 0.25;
const LEAST_STRETCH: f64 = 0.25;

/// Factor on the penalty when a solve fails, and how often that is tried. A soft
/// penalty lets a thin or low-exponent surface slide off the ball's flank.
const STIFFER: f64 = 4.0;
const ATTEMPTS: i32 = 3;
/// Residual of an equilibrium that is remembered or compared with its neighbours', as part of the contact force: it
/// costs two or three corrections by the old factor more.
const SMOOTH: f64 = 1e-8;
/// Steps of a material that relaxes are so many times shorter: the stress is a straight line in time over one. What
/// that leaves of the force at the end of a ramp over six relaxation times falls from 0.29 to 0.09 %, at the same cost.
const FINER_IN_TIME: usize = 2;

/// Contact quadrature points per element edge.
const POINTS_PER_EDGE: usize = 8;

/// Surface within this many ball radii of the axis can touch the ball.
const REACH: f64 = 2.5;

/// Depth, in ball radii, from which lengths of mesh, steps and penalty are parts of the ball's radius. Every half of it below that has half the
/// contact's area and is meshed for it, at the same number of elements under the ball; no share of two round lengths is just there, so that two
/// motions of one experiment are hardly ever on two meshes.
const SHALLOW: f64 = 0.27;
/// Halves of [`SHALLOW`] that are told apart: the least depth so is 0.4 % of the ball's radius.
const HALVES: f64 = 6.0;

/// Divisor of the elements from which on an elastic ramp has twice the stations of the standard mesh: a finer mesh is asked for to be exact. Of a second term, as a ratio of two curves of
/// such a mesh, 0.02 to 0.2 % is missed, as on one finer by 1.3 in twice the time.
pub(crate) const CLOSER: f64 = 1.1;

/// A mesh with the equations over it.
pub(crate) struct Assembly<T = f64> {
    pub system: System<T>,
    pub material: Material<T>,
}

impl Simulation {
    /// The path of the finest mesh.
    ///
    /// # Errors
    /// See [`SolveError`]; [`SolveError::NoConvergence`] names the case.
    pub fn solve(&self) -> Result<Record, SolveError> {
        Ok(Record::new(self.path(self.resolution.finest(), &mut ())?.0))
    }

    /// As [`Simulation::solve`]; the observer sees every accepted equilibrium. When a path fails
    /// it is begun again with a stiffer penalty: the observer is then `restarted` first.
    ///
    /// # Errors
    /// As [`Simulation::solve`], and what the observer returns.
    pub fn watch(&self, observer: &mut impl Watcher) -> Result<Record, SolveError> {
        Ok(Record::new(self.path(self.resolution.finest(), observer)?.0))
    }

    /// The mesh of one refinement.
    #[must_use]
    pub fn mesh(&self, refinement: f64) -> BlockMesh {
        let sizes = Sizes { refinement, ..SIZES };
        BlockMesh::new(self.specimen.radius_mm, self.specimen.height_mm, self.width_mm(), &sizes)
    }

    /// Width of the elements under the contact's edge (mm).
    pub(super) fn element_mm(&self, refinement: f64) -> f64 {
        self.width_mm() * SIZES.axis / refinement
    }

    /// What the widths of elements are parts of (mm): the ball's radius, or as much less as the contact is smaller in a shallow press.
    fn width_mm(&self) -> f64 {
        self.ball.radius_mm * self.shallow().sqrt()
    }

    /// What steps and penetration are parts of (mm).
    fn step_mm(&self) -> f64 {
        self.ball.radius_mm * self.shallow()
    }

    /// 1, or a power of a half where the ball goes less deep than [`SHALLOW`].
    fn shallow(&self) -> f64 {
        let halves = (SHALLOW * self.ball.radius_mm / self.depth_mm().max(f64::MIN_POSITIVE)).log2().ceil();
        0.5_f64.powf(halves.clamp(0.0, HALVES))
    }

    /// Largest depth (mm) of the motion; under a prescribed force, the one Hertz gives for it.
    #[must_use]
    pub fn depth_mm(&self) -> f64 {
        self.reached_mm(&self.material, self.ball.radius_mm, self.specimen.height_mm)
    }

    fn reached_mm<T: Real>(&self, material: &Material<T>, radius_mm: T, height_mm: T) -> T {
        let deepest = T::from(self.motion.deepest_mm());
        let force = self.motion.largest_force_n();
        if force <= 0.0 {
            return deepest;
        }
        let law = &material.elastic;
        let hertz = law.shear_modulus_mpa() * (8.0 / 3.0) / (-law.poisson_ratio() + 1.0) * radius_mm.sqrt();
        let by_force = ((T::from(force) / hertz).ln() * (2.0 / 3.0)).exp();
        let half = height_mm * 0.5;
        let by_force = if by_force.value() < half.value() { by_force } else { half };
        if deepest.value() > by_force.value() { deepest } else { by_force }
    }

    /// Hertz's factor `F / d^(3/2)` (N/mm^1.5) of the limit `d -> 0`, see [`hertz_force_n`].
    #[must_use]
    pub fn hertz_factor(&self) -> f64 {
        let law = &self.material.elastic;
        hertz_force_n(law.shear_modulus_mpa(), law.poisson_ratio(), self.ball.radius_mm, 1.0)
    }

    /// One line that names material, specimen, ball and interface.
    #[must_use]
    pub fn label(&self) -> String {
        let base = match self.specimen.base {
            Base::Bonded => "bonded",
            Base::Sliding => "sliding",
        };
        let adhesion = self
            .interface
            .adhesion
            .map_or(String::new(), |a| format!(", adhesion {} N/mm over {} mm", a.work_n_per_mm, a.range_mm));
        format!(
            "{}; height {} mm, {base} base, ball {} mm, friction {}{adhesion}",
            self.material.label(),
            self.specimen.height_mm,
            self.ball.radius_mm,
            self.interface.friction,
        )
    }

    pub(crate) fn check(&self) -> Result<(), SolveError> {
        let positive = [
            ("height_mm", self.specimen.height_mm),
            ("radius_mm of the specimen", self.specimen.radius_mm),
            ("radius_mm of the ball", self.ball.radius_mm),
        ];
        for (name, value) in positive {
            if !(value.is_finite() && value > 0.0) {
                return Err(SolveError::parameter(name, value, "must be positive"));
            }
        }
        self.material.check()?;
        cold(&self.material)?;
        self.motion.check()?;
        self.interface.check()?;
        let deepest = self.motion.deepest_mm();
        if deepest >= 0.95 * self.specimen.height_mm {
            let expected = format!("must stay below 95 % of the height, {} mm", self.specimen.height_mm);
            return Err(SolveError::Parameter { parameter: "depth_mm", value: deepest, expected });
        }
        if self.specimen.radius_mm < 1.5 * self.ball.radius_mm {
            let expected = format!("must be at least 1.5 ball radii, {} mm", 1.5 * self.ball.radius_mm);
            return Err(SolveError::parameter("radius_mm of the specimen", self.specimen.radius_mm, &expected));
        }
        self.resolution.check()
    }

    /// Solves on the mesh of one refinement, with a stiffer penalty if need be; also returns the
    /// number of unknowns.
    pub(super) fn path(&self, refinement: f64, observer: &mut impl Watcher) -> Result<(Path, usize), SolveError> {
        let remembers = !self.material.is_elastic() || self.interface.friction > 0.0;
        self.solved(refinement, remembers, observer)
    }

    /// The same so that forces move smoothly with every parameter.
    pub(super) fn smooth_path(
        &self,
        refinement: f64,
        observer: &mut impl Watcher,
    ) -> Result<(Path, usize), SolveError> {
        self.solved(refinement, true, observer)
    }

    fn solved(&self, refinement: f64, smooth: bool, observer: &mut impl Watcher) -> Result<(Path, usize), SolveError> {
        self.check()?;
        let mesh = self.mesh(refinement);
        let stepping = Stepping { planned: smooth, ..self.stepping(refinement) };
        // What an equilibrium leaves out of balance is carried on where something remembers, and seen between neighbours.
        let plain = Newton::default();
        let newton = if smooth { Newton { tolerance: SMOOTH, ..plain } } else { plain };
        let mut outcome = self.follow(&mesh, 1.0, newton, stepping, observer);
        for attempt in 1..ATTEMPTS {
            if outcome.is_ok() {
                break;
            }
            observer.restarted();
            outcome = self.follow(&mesh, STIFFER.powi(attempt), newton, stepping, observer);
        }
        outcome
    }

    /// Steps of a path. A force waves as the contact's edge crosses one mesh line after the other, and stations that are no closer than the lines tell a slow wave that is none: those of an elastic
    /// ramp, through which smooth curves are laid, are twice as close from [`CLOSER`] on (the force of a foam of exponent 12.9 under a ball of 4 mm, elements divided by 1.4: 0.016 % of the peak
    /// with as many as on the standard mesh, 0.006 % with these; 0.035 % on the standard mesh).
    fn stepping(&self, refinement: f64) -> Stepping {
        let mut stepping = Stepping::of_ball(self.step_mm());
        if !self.material.is_elastic() {
            stepping.stations *= FINER_IN_TIME;
            stepping.largest /= FINER_IN_TIME as f64;
        }
        let elastic = self.material.is_elastic() && self.interface == Interface::default();
        if elastic && self.motion.segments.len() == 1 && refinement >= CLOSER {
            stepping.stations *= 2;
        }
        stepping
    }

    /// Follows the motion on a given mesh of the specimen with the default penalty times `stiffer`:
    /// for those who study the method itself.
    ///
    /// # Errors
    /// As [`Simulation::solve`]; nothing is tried a second time.
    pub fn follow(
        &self,
        mesh: &BlockMesh,
        stiffer: f64,
        newton: Newton,
        stepping: Stepping,
        observer: &mut impl Watcher,
    ) -> Result<(Path, usize), SolveError> {
        let Assembly { system, material } = self.assembly(mesh, stiffer);
        observer.begins(self, mesh, stiffer, &system)?;
        let label = self.label();
        let course = Course {
            system: &system,
            material: &material,
            motion: &self.motion,
            newton,
            stepping,
            hertz: self.hertz_factor(),
            label: &label,
        };
        Ok((course.follow(observer)?, system.unknowns()))
    }

    /// The equations with plain numbers.
    pub(crate) fn assembly(&self, mesh: &BlockMesh, stiffer: f64) -> Assembly {
        self.equations(mesh, &mesh.nodes, mesh.height_mm, self.ball, self.interface, self.material.clone(), stiffer)
    }

    /// The equations with the derivative by one parameter. The nodes move with the height in
    /// proportion, and stay where they are when the ball's radius changes.
    pub(super) fn lifted(&self, mesh: &BlockMesh, stiffer: f64, by: Parameter) -> Assembly<Dual> {
        let seed = |p: Parameter, value: f64| Dual::new(value, f64::from(u8::from(p == by)));
        let height = seed(Parameter::Height, mesh.height_mm);
        let scale = height / mesh.height_mm;
        let nodes: Vec<[Dual; 2]> = mesh.nodes.iter().map(|x| [Dual::from(x[0]), scale * x[1]]).collect();
        let ball = Ball { radius_mm: seed(Parameter::BallRadius, self.ball.radius_mm) };
        let interface = Interface {
            friction: seed(Parameter::Friction, self.interface.friction),
            adhesion: self.interface.adhesion.map(|a| crate::solid::contact::Adhesion {
                work_n_per_mm: seed(Parameter::AdhesionWork, a.work_n_per_mm),
                range_mm: a.range_mm,
            }),
        };
        self.equations(mesh, &nodes, height, ball, interface, self.material.lift(by), stiffer)
    }

    #[expect(clippy::too_many_arguments, reason = "all of it is the case, in one kind of number")]
    fn equations<T: Strained>(
        &self,
        mesh: &BlockMesh,
        nodes: &[[T; 2]],
        height_mm: T,
        ball: Ball<T>,
        interface: Interface<T>,
        material: Material<T>,
        stiffer: f64,
    ) -> Assembly<T> {
        let first = material.shear_modulus_mpa() * FIRST_PRESSURE;
        let largest = pressure_mpa(&material, self.reached_mm(&material, ball.radius_mm, height_mm), height_mm);
        let gap = |part: f64| ball.radius_mm * (self.shallow() / (part * stiffer));
        let penalty = Penalty::through((first, gap(STIFF)), (largest, gap(STIFFEST)));
        let reach = REACH * self.ball.radius_mm;
        let surface = Surface::new(ball, interface, nodes, &mesh.top, reach, POINTS_PER_EDGE, penalty);
        let system = System::over(mesh, nodes, height_mm, self.specimen.base, surface, |_| Quadrature::Reduced);
        Assembly { system, material }
    }
}

/// A press begins with an undeformed mesh at rest, which a warmed block is not.
///
/// # Errors
/// [`SolveError::Parameter`] for a material with a thermal strain.
pub(super) fn cold(material: &Material) -> Result<(), SolveError> {
    let expected =
        "cannot be pressed from the cold reference; take the grown block, lengths by 1 + e and moduli by (1 + e)^-3";
    material.thermal.map_or(Ok(()), |strain| Err(SolveError::parameter("thermal strain", strain, expected)))
}

/// Largest pressure expected (MPa): stress of a column that is free to bulge as its Poisson's
/// ratio says, at the compression of the ball's neighbourhood plus that of the block.
fn pressure_mpa<T: Real>(material: &Material<T>, depth_mm: T, height_mm: T) -> T {
    let l = -(depth_mm / height_mm) + (1.0 - NEIGHBOURHOOD);
    let l = if l.value() < LEAST_STRETCH { T::from(LEAST_STRETCH) } else { l };
    let side = (-(material.elastic.poisson_ratio() * l.ln())).exp();
    -material.elastic.stress([l, side, side]).1[0]
}

/// An observer of one or more attempts at a path.
pub trait Watcher: Observer {
    /// A path begins on a mesh, with the default penalty times `stiffer`.
    ///
    /// # Errors
    /// Ends the simulation.
    fn begins(
        &mut self,
        simulation: &Simulation,
        mesh: &BlockMesh,
        stiffer: f64,
        system: &System,
    ) -> Result<(), SolveError>;

    /// The attempt failed; what was collected is void.
    fn restarted(&mut self);
}

impl Watcher for () {
    fn begins(&mut self, _: &Simulation, _: &BlockMesh, _: f64, _: &System) -> Result<(), SolveError> {
        Ok(())
    }
    fn restarted(&mut self) {}
}
