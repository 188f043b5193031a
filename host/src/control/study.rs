//! The study of a material: a finger on it, and the yield stress with which a fluid feels alike.

use lut_gen::pad::body::Body;
use lut_gen::pad::body::block::Block;
use lut_gen::pad::body::finger::Finger;
use lut_gen::pad::body::section::Section;
use lut_gen::pad::contact::rigid::{Rigid, Shape};
use lut_gen::pad::control::curve::Curve;
use lut_gen::pad::control::felt::{Averages, Error, Felt};
use lut_gen::pad::control::latch::Followed;
use lut_gen::pad::control::search::{Display, Found};
use lut_gen::pad::error::PadError;
use lut_gen::pad::law::material::Material;
use lut_gen::pad::law::plastic::Plastic;
use lut_gen::pad::press::{Press, Side};
use rayon::prelude::*;

/// What is studied.
#[derive(Debug, Clone, PartialEq)]
pub struct Asked {
    /// Plane or ring.
    pub section: Section,
    /// The finger.
    pub finger: Finger,
    /// What the material is made of.
    pub material: Material,
    /// Height of its specimen, mm.
    pub height_mm: f64,
    /// The fluid's body.
    pub fluid: FluidBody,
    /// How far the finger's bone goes, mm.
    pub most_mm: f64,
    /// Search the best curve of [`PLACES`] knots as well.
    pub best: bool,
    /// Largest loop gain of the display.
    pub most_gain: f64,
    /// What the area counts beside the force's 1, 0 to 10.
    pub area_weight: f64,
}

/// The body of fluid under the finger. What it is below its yield stress is assumed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FluidBody {
    /// Height, mm.
    pub height_mm: f64,
    /// Radius, mm.
    pub radius_mm: f64,
    /// Strain at which it yields: Young's modulus below it is the largest mean stress of the material
    /// over this strain.
    pub yield_strain: f64,
    /// Poisson's ratio below yield.
    pub nu: f64,
}

/// What was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// The finger on the material.
    pub wanted: Felt,
    /// Force of the same finger on a rigid plate, N, at the same travels.
    pub plate_n: Vec<f64>,
    /// Averages of Mises' stress in the material at every travel.
    pub averages: Vec<Averages>,
    /// The cubics through mean, median and geometric mean.
    pub tried: Vec<Tried>,
    /// The cubic that feels nearest.
    pub cubic: Found,
    /// The curve of [`PLACES`] knots that feels nearest.
    pub best: Option<Found>,
    /// The cubic over the display's own force, no steeper than the loop gain allows.
    pub followed: Followed,
    /// Where it had to be made less steep.
    pub cut: Vec<bool>,
    /// Loop gain at every travel, of the limited curve.
    pub gains: Vec<f64>,
    /// The finger down and up on a fluid that follows the force a tick late; `None` where no
    /// equilibrium was found.
    pub cycle: Option<[Felt; 2]>,
    /// Largest difference of the cubic's force on elements of two thirds of the length, N; `None` where
    /// those find no equilibrium.
    pub mesh_n: Option<f64>,
    /// Young's modulus of the fluid below yield, MPa.
    pub young_mpa: f64,
}

/// A curve that was not searched.
#[derive(Debug, Clone, PartialEq)]
pub struct Tried {
    /// The average that it is.
    pub name: &'static str,
    /// The curve.
    pub curve: Curve,
    /// What it feels like, and how far that is from what is wanted; `None` where no equilibrium was
    /// found.
    pub felt: Option<(Felt, Error)>,
}

/// An average of Mises' stress, with its name.
type Kind = (&'static str, fn(&Averages) -> f64);

/// Travels of a study, and knots of its best curve.
pub const PLACES: usize = 12;
/// Elements of the fluid and of the material over those of the finger.
const COARSER: f64 = 1.3;
/// How far from the axis they are that short, mm.
const FINE_MM: f64 = 7.0;
/// Yield stress that no curve falls below, MPa: of less there is no equilibrium.
const LEAST_MPA: f64 = 2e-4;
/// Longest step, mm.
const STEP_MM: f64 = 0.25;
/// Radius of the material's specimen, mm: beyond it a finger's press is not felt.
const SPECIMEN_MM: f64 = 25.0;
/// Travel of the next attempt over what the last one reached, and the least, mm.
const SHORTER: f64 = 0.95;
const SHORTEST_MM: f64 = 1.0;
/// Element length of the finer mesh over that of the study.
const FINER: f64 = 2.0 / 3.0;

/// What a study is busy with, what is done and of how many; 0 of what nobody counts.
pub type Told<'a> = &'a (dyn Fn(&str, usize) + Sync);

impl Asked {
    /// The travels of the study, mm.
    #[must_use]
    pub fn travels(&self) -> Vec<f64> {
        (1..=PLACES).map(|i| self.most_mm * i as f64 / PLACES as f64).collect()
    }

    /// The block of fluid under the finger.
    fn display(&self, young_mpa: f64, finer: f64) -> Result<Display, PadError> {
        let finger = Finger { edge_mm: finer * self.finger.edge_mm, ..self.finger.clone() };
        let fluid = Material::Plastic(Plastic::new(young_mpa, self.fluid.nu)?);
        let block = block(&finger, self.fluid.height_mm, self.fluid.radius_mm, fluid)?;
        Ok(Display {
            section: self.section,
            finger: finger.body()?,
            block,
            least_mpa: LEAST_MPA,
            step_mm: STEP_MM,
            area_weight: self.area_weight,
        })
    }

    /// Makes the study, as far down as the fluid can be pressed: a weak one closes round the finger.
    ///
    /// # Errors
    /// [`PadError`]: a measure that makes no body, a press that finds no equilibrium even at 1 mm.
    pub fn study(&self, told: Told<'_>) -> Result<Study, PadError> {
        let mut asked = self.clone();
        loop {
            match asked.attempt(told) {
                Err(PadError::Stuck { reached_mm, .. }) if SHORTER * reached_mm >= SHORTEST_MM => {
                    asked.most_mm = (SHORTER * reached_mm).min(SHORTER * asked.most_mm);
                }
                result => return result,
            }
        }
    }

    fn attempt(&self, told: Told<'_>) -> Result<Study, PadError> {
        let travels = self.travels();
        told("finger on the material", 0);
        let finger = self.finger.body()?;
        let under = block(&self.finger, self.height_mm, SPECIMEN_MM, self.material.clone())?;
        let states = Press::new(self.section, Side::Soft(finger.clone()), Side::Soft(under)).solve(&travels)?;
        let wanted = Felt::of(self.section, &states);
        let averages: Vec<Averages> = states.iter().filter_map(Averages::of).collect();
        let plate = Side::Rigid(Rigid { shape: Shape::Plate, tip_mm: -self.finger.height_mm });
        let states = Press::new(self.section, Side::Soft(finger), plate).solve(&travels)?;
        let plate_n = Felt::of(self.section, &states).force_n;
        let young_mpa = averages.iter().map(|a| a.mean).fold(LEAST_MPA, f64::max) / self.fluid.yield_strain;
        let display = self.display(young_mpa, 1.0)?;
        told("averages of its stress", 0);
        let tried = tried(&display, &wanted, &averages)?;
        let begin = begin(&tried, &travels, self.area_weight)?;
        let mut round = 0;
        let mut cubic = display.search(&begin, &wanted, &mut |_| {
            told("cubic, rounds", round);
            round += 1;
        })?;
        let best = self.best.then(|| best(&display, &cubic, &wanted, told)).transpose()?;
        // the best curve is one more beginning for a cubic
        if let Some(best) = &best {
            let stresses: Vec<f64> = travels.iter().map(|u| best.curve.at(*u)).collect();
            let again = Curve::cubic_through(&travels, &stresses)?;
            told("cubic from the best curve", 0);
            let again = display.search(&again, &wanted, &mut |_| {});
            let asked = |found: &Found| found.error.weighed(self.area_weight);
            cubic = again.ok().filter(|found| asked(found) < asked(&cubic)).unwrap_or(cubic);
        }
        told("loop", 0);
        let per = display.force_per_mpa(&cubic.curve, &travels)?;
        let (limited, cut) = followed(&cubic)?.limited(&per, self.most_gain);
        let cycle = display.cycle(&limited, self.most_mm, PLACES).ok();
        told("finer mesh", 0);
        let fine = self.display(young_mpa, FINER)?.felt(&cubic.curve, &travels).ok();
        let apart =
            |fine: Felt| fine.force_n.iter().zip(&cubic.felt.force_n).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let mesh_n = fine.map(apart);
        let gains = limited.gains(&per);
        let followed = limited;
        Ok(Study { wanted, plate_n, averages, tried, cubic, best, followed, cut, gains, cycle, mesh_n, young_mpa })
    }
}

fn block(finger: &Finger, height_mm: f64, radius_mm: f64, material: Material) -> Result<Body, PadError> {
    let (top_mm, edge_mm) = (-finger.height_mm, COARSER * finger.edge_mm);
    Block { height_mm, radius_mm, top_mm, bonded: false, material, edge_mm, fine_mm: FINE_MM.min(radius_mm) }.body()
}

/// The cubics through the averages, and what they feel like.
fn tried(display: &Display, wanted: &Felt, averages: &[Averages]) -> Result<Vec<Tried>, PadError> {
    let kinds: [Kind; 3] = [("mean", |a| a.mean), ("median", |a| a.median), ("geometric mean", |a| a.geometric)];
    let each = |(name, of): Kind| {
        let stresses: Vec<f64> = averages.iter().map(of).collect();
        let curve = Curve::cubic_through(&wanted.travel_mm, &stresses)?;
        let felt = display.felt(&curve, &wanted.travel_mm).ok().map(|felt| {
            let error = felt.error(wanted);
            (felt, error)
        });
        Ok(Tried { name, curve, felt })
    };
    kinds.into_par_iter().map(each).collect()
}

/// The best of the averages' cubics; a straight line to the largest mean where none was pressed.
fn begin(tried: &[Tried], travels: &[f64], area_weight: f64) -> Result<Curve, PadError> {
    let pressed = tried.iter().filter_map(|own| Some((&own.curve, own.felt.as_ref()?.1.weighed(area_weight))));
    let best = pressed.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(curve, _)| curve.clone());
    let last = travels.last().copied().unwrap_or(1.0);
    let line = || tried.first().map_or(LEAST_MPA, |own| own.curve.at(last)).max(LEAST_MPA) / last;
    Ok(best.unwrap_or_else(|| Curve::Cubic([line(), 0.0, 0.0])))
}

fn best(display: &Display, cubic: &Found, wanted: &Felt, told: Told<'_>) -> Result<Found, PadError> {
    let knots = wanted.travel_mm.iter().map(|u| (*u, cubic.curve.at(*u).max(LEAST_MPA))).collect();
    let mut round = 0;
    display.search(&Curve::Knots(knots), wanted, &mut |_| {
        told("curve of twelve knots, rounds", round);
        round += 1;
    })
}

/// The yield stress over the display's own force, as far as that rises.
fn followed(found: &Found) -> Result<Followed, PadError> {
    let (felt, rising) = (&found.felt, found.felt.rising());
    let mpa: Vec<f64> = felt.travel_mm.iter().take(rising).map(|u| found.curve.at(*u).max(LEAST_MPA)).collect();
    Followed::new(&felt.force_n[..rising], &mpa)
}
