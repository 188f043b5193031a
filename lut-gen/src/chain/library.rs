//! Continuous force models of every pair of ball and specimen in an experiment.

use std::fmt;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::effect::{friction, poisson, relaxation, thickness};
use crate::solid::contact::{Ball, Interface};
use crate::solid::law::{Hyperfoam, PronyTerm, Term};
use crate::solid::model::{CLOSER, ForceModel, ForceSlice, ModelSpec, Resolution, Simulation, Specimen};
use crate::solid::solve::{Base, Motion, SolveError};

/// A ball on a specimen.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Geometry {
    /// The block as declared.
    pub specimen: Specimen,
    /// Radius of the ball as declared (mm).
    pub ball_mm: f64,
    /// Largest depth that is asked for (mm).
    pub depth_mm: f64,
    /// Poisson's ratio of the base law: 0 for a foam; [`RUBBER_NU`] for what hardly changes its volume, where the Hyperfoam's law is Ogden's.
    pub nu: f64,
}

/// Poisson's ratio at which a nearly incompressible specimen is computed. As it goes to 1/2 the one-term Hyperfoam goes to the one-term Ogden
/// law; at 0.45 balls pressed in to their equator on specimens of two radii found no equilibrium for exponents above 12, at 0.4 they do.
pub const RUBBER_NU: f64 = 0.4;

/// What a library covers besides shear modulus, exponent and depth.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Need {
    /// Other heights, Poisson's ratios, sliding bases and friction.
    pub effects: bool,
}

/// Why there is no library.
pub type LibraryError = SolveError;

/// What finite elements did not find for one geometry: the effect changes nothing there, or is known less well.
#[derive(Debug, Clone, PartialEq)]
pub struct Missing {
    /// The ball on the specimen.
    pub geometry: Geometry,
    /// Code of the effect.
    pub code: &'static str,
    /// Why.
    pub reason: SolveError,
}

impl fmt::Display for Missing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Geometry { specimen, ball_mm, depth_mm, .. } = &self.geometry;
        write!(
            f,
            "finite elements of \"{}\" failed for a ball of {ball_mm} mm, {depth_mm} mm deep in a specimen of {} mm: what it does there is unknown ({})",
            self.code, specimen.height_mm, self.reason
        )
    }
}

/// Forces of one geometry.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Family {
    pub geometry: Geometry,
    /// Over exponent, at the declared height.
    declared: ForceModel,
    /// Over exponent and height.
    height: Option<ForceModel>,
    /// Over exponent and Poisson's ratio, at the declared height.
    poisson: Option<ForceModel>,
    /// What a base that slides changes: over exponent, at the declared height.
    sliding: Option<ForceModel>,
    /// What friction changes.
    friction: Vec<Rubbed>,
    /// How far the deformation carries the memory of a relaxing material along: exponent and `carried` of [`relaxation::relaxed`].
    memory: Vec<(f64, f64)>,
    /// Finite-element solves that were spent on it.
    solves: usize,
    /// What was not found. A family that lacks something is not kept, so that none is read.
    #[serde(skip)]
    missing: Vec<Missing>,
}

/// Force with friction over force without, on the way down and on the way up.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Rubbed {
    coefficient: f64,
    alpha: f64,
    down: [f64; RUBBED],
    up: [f64; RUBBED],
}

/// Stations of a friction curve, evenly over the share of the largest depth.
const RUBBED: usize = 21;
/// Coefficients and exponents at which friction is solved; in between and beyond it is interpolated.
const COEFFICIENTS: [f64; 2] = [0.2, 0.6];
const RUBBED_ALPHA: [f64; 2] = [5.0, 15.0];
const RUBBED_RUBBER_ALPHA: [f64; 2] = [3.0, 9.0];
/// The relaxing material whose press measures how memory is carried: its part, its time as a share of the ramp's, and the hold
/// after it in ramps. The result depends little on them (g 0.3 to 0.6, tau 0.07 to 7 ramps: 12 % of it).
const RELAXING: (f64, f64, f64) = (0.3, 0.33, 1.0);

/// Exponents of a library: those of soft foams (thesis Tables 1 and 3 lie between 4 and 15). Five with their slopes are as good as nine without (0.01 % of the force between them).
const ALPHA: (f64, f64, usize) = (1.8, 26.0, 5);
/// Those of nearly incompressible specimens.
const RUBBER_ALPHA: (f64, f64, usize) = (1.8, 12.0, 4);
/// Heights, as factors on the declared one, and exponents there: what another height changes depends little on the exponent. It is met to 2 % of itself (a ball of 6 mm
/// pressed in by 6 mm on 25 mm, heights of 20 to 45 mm, exponents 2 to 26); with three heights and four exponents 11 to 15 % were missed.
const HEIGHTS: (f64, f64, usize) = (0.6, 2.0, 5);
const HEIGHT_ALPHAS: usize = 2;
/// Least of them where the specimen hardly changes its volume: a thinner one locks the ball.
const RUBBER_HEIGHT: f64 = 0.8;
/// Divisor of the element sizes of the force at the declared height, and depth, in ball radii, below which all forces are solved so: a contact of few elements makes the force wave as one after the other comes
/// into it, by 0.08 % of itself (root of the mean square; 0.37 at most) at 0.4 radii on the standard mesh, by 0.03 % on this one, as deep presses do on the standard one.
const FINE_BELOW: f64 = 0.5;
const FINE: f64 = 1.4;
/// The same of the presses, both on one mesh, that tell from their ratio what friction does, and how memory is carried: what is made of them is rougher than that. Friction of 0.2 and 0.8
/// is missed by 22 to 28 and 45 to 57 % of itself, on the standard mesh by 25 to 29 and 39 to 53 (tests/whole_paths.rs).
const ROUGH: f64 = 0.6;
/// Poisson's ratios, with slopes.
const NUS: (f64, f64, usize) = (0.0, 0.38, 3);
/// Exponents at which is solved what they change, and what a sliding base does, both with slopes: what a ratio changes is met to 1.7 parts in a thousand (tests/force_model.rs). With three exponents a
/// ratio of 0.25 in a thin block was missed by 0.23 % of the peak (five ratios without slopes), where 0.05 is left.
const CHANGE_ALPHAS: usize = 4;

/// Force models of all geometries of an experiment.
#[derive(Debug, Clone, Default)]
pub struct Library {
    pub(super) families: Vec<Family>,
}

/// What a geometry's forces are made of.
#[derive(Debug, Clone, Copy)]
enum Part {
    Declared,
    Height,
    Poisson,
    Sliding,
    /// Friction at an exponent.
    Friction(f64),
    /// Memory at an exponent.
    Memory(f64),
}

impl Part {
    /// The effect that a part is for.
    fn code(self) -> &'static str {
        match self {
            // the force itself is no effect
            Self::Declared => "force",
            Self::Height => thickness::HEIGHT.code,
            Self::Poisson => poisson::EFFECT.code,
            Self::Sliding => thickness::SLIDING.code,
            Self::Friction(_) => friction::EFFECT.code,
            Self::Memory(_) => relaxation::ONE.code,
        }
    }
}

enum Made {
    Declared(ForceModel),
    Height(ForceModel),
    Poisson(ForceModel),
    Sliding(ForceModel),
    Friction(Vec<Rubbed>),
    Memory(f64, f64),
}

impl Library {
    /// Solves what a diagnosis of these geometries may need; `progress(done, total)` counts parts.
    ///
    /// A part that is not the force at the declared height may fail (a thin, nearly incompressible, deeply pressed foam): its effect then
    /// changes nothing in that geometry, and [`Library::missing`] tells so.
    ///
    /// # Errors
    /// The first geometry whose forces fail.
    pub fn build(
        geometries: &[Geometry],
        need: Need,
        progress: &(dyn Fn(usize, usize) + Send + Sync),
    ) -> Result<Self, LibraryError> {
        Self::assembled(geometries, need, progress, &|geometry, part| geometry.part(part, need))
    }

    /// The same from parts that `made` makes.
    fn assembled(
        geometries: &[Geometry],
        need: Need,
        progress: &(dyn Fn(usize, usize) + Send + Sync),
        made: &(dyn Fn(&Geometry, Part) -> Result<Made, SolveError> + Sync),
    ) -> Result<Self, LibraryError> {
        let plan: Vec<(usize, Part)> = geometries
            .iter()
            .enumerate()
            .flat_map(|(at, g)| g.parts(need).into_iter().map(move |part| (at, part)))
            .collect();
        let done = AtomicUsize::new(0);
        let built: Vec<Result<Made, SolveError>> = plan
            .par_iter()
            .map(|&(at, part)| {
                let made = made(&geometries[at], part);
                progress(done.fetch_add(1, Ordering::Relaxed) + 1, plan.len());
                made
            })
            .collect();
        let mut families: Vec<Family> = Vec::new();
        for ((at, part), made) in plan.iter().zip(built) {
            match (made, part, families.last_mut()) {
                (Ok(Made::Declared(model)), ..) => families.push(Family::new(geometries[*at], model)),
                (Ok(made), _, Some(family)) => family.add(made),
                (Err(error), Part::Declared, _) | (Err(error), _, None) => return Err(error),
                (Err(reason), part, Some(family)) => {
                    family.missing.push(Missing { geometry: family.geometry, code: part.code(), reason });
                }
                // a family begins with the force at the declared height
                (Ok(_), _, None) => {}
            }
        }
        Ok(Self { families })
    }

    /// What it covers.
    #[must_use]
    pub fn geometries(&self) -> Vec<Geometry> {
        self.families.iter().map(|family| family.geometry).collect()
    }

    /// A library of some of the geometries of this one.
    #[must_use]
    pub fn of(&self, wanted: &[Geometry]) -> Option<Self> {
        let found = |w: &Geometry| self.families.iter().find(|f| f.geometry == *w).cloned();
        let families = wanted.iter().map(found).collect::<Option<Vec<_>>>()?;
        Some(Self { families })
    }

    /// Puts two libraries together.
    pub fn extend(&mut self, other: Self) {
        self.families.extend(other.families);
    }

    /// What finite elements did not find.
    pub fn missing(&self) -> impl Iterator<Item = &Missing> {
        self.families.iter().flat_map(|family| &family.missing)
    }

    /// Those of its geometries for which nothing is missing.
    #[must_use]
    pub fn complete(&self) -> Self {
        Self { families: self.families.iter().filter(|family| family.is_complete()).cloned().collect() }
    }

    /// Finite-element solves that were spent.
    #[must_use]
    pub fn solves(&self) -> usize {
        self.families.iter().map(|family| family.solves).sum()
    }
}

impl Geometry {
    /// What its forces are made of, that at the declared height first.
    fn parts(&self, need: Need) -> Vec<Part> {
        let mut list = vec![Part::Declared];
        if need.effects {
            list.extend([Part::Height, Part::Sliding]);
            // of a base that hardly changes its volume another Poisson's ratio is no effect
            list.extend((self.nu == 0.0).then_some(Part::Poisson));
            list.extend(self.rubbed_alpha().into_iter().flat_map(|alpha| [Part::Friction(alpha), Part::Memory(alpha)]));
        }
        list
    }

    fn part(&self, part: Part, need: Need) -> Result<Made, SolveError> {
        let ball = Ball { radius_mm: self.ball_mm };
        let h = self.specimen.height_mm;
        let alpha = if self.nu > 0.0 { RUBBER_ALPHA } else { ALPHA };
        let fine = Resolution::Refined(FINE);
        let one = ModelSpec {
            alpha: (alpha.0, alpha.1),
            alpha_nodes: alpha.2,
            alpha_slopes: true,
            nu: self.nu,
            checked: false,
            // alone it is not told from other forces
            resolution: if self.is_deep() && !need.effects { Resolution::Standard } else { fine },
            ..ModelSpec::new(self.specimen, ball, self.depth_mm)
        };
        let silent = |_: usize, _: usize| {};
        match part {
            Part::Declared => Ok(Made::Declared(ForceModel::build(&one, &silent)?)),
            Part::Height => {
                // a ball must not come close to the ground
                let least = if self.nu > 0.0 { RUBBER_HEIGHT } else { HEIGHTS.0 };
                let low = (least * h).max(1.3 * self.depth_mm).min(h);
                let heights_mm = Some((low, HEIGHTS.1 * h, HEIGHTS.2));
                let resolution = if self.is_deep() { Resolution::Standard } else { fine };
                let spec = ModelSpec { heights_mm, alpha_nodes: HEIGHT_ALPHAS, resolution, ..one };
                Ok(Made::Height(ForceModel::build(&spec, &silent)?))
            }
            Part::Poisson => {
                let resolution = self.change_resolution();
                let spec = ModelSpec { nus: Some(NUS), nu_slopes: true, alpha_nodes: CHANGE_ALPHAS, resolution, ..one };
                Ok(Made::Poisson(ForceModel::build(&spec, &silent)?))
            }
            Part::Sliding => {
                let specimen = Specimen { base: Base::Sliding, ..self.specimen };
                // as the bonded one that it is compared with
                let like =
                    if self.nu > 0.0 { (one.alpha_nodes, fine) } else { (CHANGE_ALPHAS, self.change_resolution()) };
                let spec = ModelSpec { alpha_nodes: like.0, specimen, resolution: like.1, ..one };
                Ok(Made::Sliding(ForceModel::build(&spec, &silent)?))
            }
            Part::Friction(alpha) => self.rubbed(alpha).map(Made::Friction),
            Part::Memory(alpha) => Ok(Made::Memory(alpha, self.carried(alpha)?)),
        }
    }

    /// False where all forces need the fine mesh.
    fn is_deep(&self) -> bool {
        self.depth_mm >= FINE_BELOW * self.ball_mm
    }

    /// Mesh of what another Poisson's ratio, or a base that slides, changes. The contact has another size then, so that the waves of a mesh do not cancel.
    fn change_resolution(&self) -> Resolution {
        Resolution::Refined(if self.is_deep() { CLOSER } else { FINE })
    }

    /// Exponents at which friction and memory are solved.
    fn rubbed_alpha(&self) -> [f64; 2] {
        if self.nu > 0.0 { RUBBED_RUBBER_ALPHA } else { RUBBED_ALPHA }
    }

    fn pressed(&self, alpha: f64, motion: Motion) -> Result<Simulation, SolveError> {
        Ok(Simulation {
            material: Hyperfoam::new(vec![Term { mu_mpa: 1.0, alpha, nu: self.nu }])?.into(),
            specimen: self.specimen,
            ball: Ball { radius_mm: self.ball_mm },
            interface: Interface::default(),
            motion,
            resolution: if self.is_deep() { Resolution::Refined(ROUGH) } else { Resolution::Standard },
        })
    }

    /// The `carried` with which the convolution meets a relaxing press of finite elements best.
    fn carried(&self, alpha: f64) -> Result<f64, SolveError> {
        let (g, share, hold) = RELAXING;
        let end_s = 1.0;
        let elastic = self.pressed(alpha, Motion::ramp(self.depth_mm, self.depth_mm / end_s))?.curve(&[])?.profile;
        let mut press = self.pressed(alpha, Motion::ramp(self.depth_mm, self.depth_mm / end_s).hold(hold * end_s))?;
        press.material = press.material.relaxing(vec![PronyTerm { g, k: g, tau_s: share * end_s }])?;
        let record = press.solve()?;
        // even nodes of both, so that the convolution moves straight between them
        let nodes: Vec<f64> = (0..=80).map(|k| (1.0 + hold) * end_s * f64::from(k) / 80.0).collect();
        let depth: Vec<f64> = nodes.iter().map(|t| self.depth_mm * (t / end_s).min(1.0)).collect();
        let miss = |carried: f64| -> f64 {
            let shape: Vec<f64> = depth.iter().map(|d| (-carried * d / self.ball_mm).exp()).collect();
            let mut force: Vec<f64> = depth.iter().map(|d| elastic.force_n(*d)).collect();
            relaxation::relaxed(&nodes, &shape, &[(g, share * end_s)], &mut force);
            nodes.iter().zip(&force).map(|(t, f)| (f - record.force_at(*t)).powi(2)).sum()
        };
        Ok(least(miss, (0.0, 4.0)))
    }

    /// Down and up again without friction and with each coefficient, on the same mesh.
    fn rubbed(&self, alpha: f64) -> Result<Vec<Rubbed>, SolveError> {
        let free = self.pressed(alpha, Motion::ramp(self.depth_mm, 1.0).to_depth(0.0, 1.0))?;
        let without = free.solve()?;
        let of = |coefficient: f64| -> Result<Rubbed, SolveError> {
            let rough = Simulation { interface: Interface { friction: coefficient, ..free.interface }, ..free.clone() };
            let with = rough.solve()?;
            let ratio = |time_s: f64| with.force_at(time_s) / without.force_at(time_s).max(f64::MIN_POSITIVE);
            let share = |k: usize| k as f64 / (RUBBED - 1) as f64;
            // the first and last steps touch with a few points only: the next station stands for them
            let seen = |k: usize| share(k.max(2)) * self.depth_mm;
            let down = std::array::from_fn(|k| ratio(seen(k)));
            let up = std::array::from_fn(|k| ratio(2.0 * self.depth_mm - seen(k)));
            Ok(Rubbed { coefficient, alpha, down, up })
        };
        COEFFICIENTS.into_iter().map(of).collect()
    }
}

impl Family {
    fn new(geometry: Geometry, declared: ForceModel) -> Self {
        Self {
            geometry,
            solves: declared.solves(),
            declared,
            height: None,
            poisson: None,
            sliding: None,
            friction: Vec::new(),
            memory: Vec::new(),
            missing: Vec::new(),
        }
    }

    /// True where every solve was found.
    pub fn is_complete(&self) -> bool {
        self.missing.is_empty()
    }

    fn add(&mut self, made: Made) {
        let (place, model) = match made {
            Made::Friction(rubbed) => {
                self.solves += 1 + rubbed.len();
                return self.friction.extend(rubbed);
            }
            Made::Memory(alpha, carried) => {
                self.solves += 2;
                return self.memory.push((alpha, carried));
            }
            Made::Declared(model) => (&mut None, model),
            Made::Height(model) => (&mut self.height, model),
            Made::Poisson(model) => (&mut self.poisson, model),
            Made::Sliding(model) => (&mut self.sliding, model),
        };
        self.solves += model.solves();
        *place = Some(model);
    }

    /// Force of a unit modulus over depth.
    pub fn slice(&self, alpha: f64, nu: f64, height_mm: f64, sliding: f64) -> ForceSlice {
        let declared = self.geometry.specimen.height_mm;
        let mut slice = self.declared.slice(alpha, 0.0, declared);
        if let (Some(height), true) = (&self.height, height_mm != declared) {
            // what another height changes is the difference of one mesh
            slice = slice.moved(&height.slice(alpha, 0.0, declared), &height.slice(alpha, 0.0, height_mm));
        }
        if let (Some(poisson), true) = (&self.poisson, nu != 0.0) {
            slice = slice.moved(&poisson.slice(alpha, 0.0, declared), &poisson.slice(alpha, nu, declared));
        }
        if let (Some(model), true) = (&self.sliding, sliding != 0.0) {
            // the difference of one mesh and the same exponents: where the mesh of the forces waves, no base slides
            let same = self.poisson.as_ref().unwrap_or(&self.declared);
            let (bonded, free) = (same.slice(alpha, 0.0, declared), model.slice(alpha, 0.0, declared));
            for (own, (a, b)) in slice.coefficients.iter_mut().zip(bonded.coefficients.iter().zip(&free.coefficients)) {
                *own += sliding * (b - a);
            }
        }
        slice
    }

    /// How far memory is carried along at an exponent, straight between the solved ones.
    pub fn carried(&self, alpha: f64) -> f64 {
        match self.memory[..] {
            [(a, at_a), (b, at_b)] => at_a + (at_b - at_a) * ((alpha - a) / (b - a)).clamp(-0.3, 1.9),
            _ => 0.0,
        }
    }

    /// Factor of friction at a share of the largest depth, on the way down or up: a parabola through none and the
    /// solved coefficients, straight in the exponent.
    pub fn rubbed(&self, alpha: f64, coefficient: f64, share: f64, up: bool) -> f64 {
        let place = share.clamp(0.0, 1.0) * (RUBBED - 1) as f64;
        let k = (place as usize).min(RUBBED - 2);
        let x = place - k as f64;
        let at = |r: &Rubbed| {
            let list = if up { &r.up } else { &r.down };
            list[k] + x * (list[k + 1] - list[k]) - 1.0
        };
        let [a, b] = self.geometry.rubbed_alpha();
        let weight = ((alpha - a) / (b - a)).clamp(-0.3, 1.9);
        let solved = |c: f64| -> f64 {
            let of = |alpha: f64| self.friction.iter().find(|r| r.coefficient == c && r.alpha == alpha).map_or(0.0, at);
            (1.0 - weight) * of(a) + weight * of(b)
        };
        let [c, d] = COEFFICIENTS;
        let (fc, fd) = (solved(c), solved(d));
        // f(0) = 0
        let bend = (fd / d - fc / c) / (d - c);
        1.0 + coefficient * (fc / c + bend * (coefficient - c))
    }
}

/// Where a function with one minimum has it, by golden section to a thousandth of the bracket.
fn least(f: impl Fn(f64) -> f64, bracket: (f64, f64)) -> f64 {
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut a, mut b) = bracket;
    let (mut x, mut y) = (b - golden * (b - a), a + golden * (b - a));
    let (mut fx, mut fy) = (f(x), f(y));
    while b - a > 1e-3 * (bracket.1 - bracket.0) {
        if fx < fy {
            (b, y, fy) = (y, x, fx);
            x = b - golden * (b - a);
            fx = f(x);
        } else {
            (a, x, fx) = (x, y, fy);
            y = a + golden * (b - a);
            fy = f(y);
        }
    }
    0.5 * (a + b)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// A solve that fails is told with its reason, is not written down, and leaves the others as they are.
    #[test]
    fn a_failed_solve_is_missing_and_told_and_not_kept() {
        let geometry = Geometry { specimen: Specimen::of_height(12.7), ball_mm: 4.0, depth_mm: 1.0, nu: 0.0 };
        let need = Need { effects: true };
        let failed = || SolveError::parameter("injected", 1.0, "must fail");
        let silent = |_: usize, _: usize| {};
        let small = small(&geometry);
        let with = |fails: &'static str| {
            Library::assembled(&[geometry], need, &silent, &|_, part| match part {
                part if part.code() == fails => Err(failed()),
                // cheap stand-ins: what they hold plays no part here
                Part::Memory(alpha) => Ok(Made::Memory(alpha, 0.3)),
                Part::Friction(_) => Ok(Made::Friction(Vec::new())),
                Part::Height => Ok(Made::Height(small.clone())),
                Part::Poisson => Ok(Made::Poisson(small.clone())),
                Part::Sliding => Ok(Made::Sliding(small.clone())),
                Part::Declared => Ok(Made::Declared(small.clone())),
            })
        };
        let whole = with("none").unwrap();
        assert!(whole.missing().next().is_none() && whole.to_bytes(&geometry).is_some());
        for code in ["poisson", "friction", "relaxation"] {
            let library = with(code).unwrap();
            let missing: Vec<&Missing> = library.missing().collect();
            assert!(
                !missing.is_empty() && missing.iter().all(|m| m.code == code && m.reason == failed()),
                "{missing:?}"
            );
            assert!(missing[0].to_string().contains(code) && missing[0].to_string().contains("injected"));
            assert!(library.to_bytes(&geometry).is_none() && library.complete().geometries().is_empty());
        }
        // without the force itself there is nothing
        assert!(with("force").is_err());
    }

    /// The coarsest force model there is.
    fn small(geometry: &Geometry) -> ForceModel {
        let ball = Ball { radius_mm: geometry.ball_mm };
        let spec = ModelSpec {
            alpha: (4.0, 8.0),
            alpha_nodes: 2,
            checked: false,
            ..ModelSpec::new(geometry.specimen, ball, 0.2)
        };
        ForceModel::build(&spec, &|_, _| {}).unwrap()
    }
}
