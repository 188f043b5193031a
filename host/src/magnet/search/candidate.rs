//! One magnet of a search: its size, the current that it may carry, and the flux density that this gives.

use std::collections::BTreeMap;
use std::path::Path;

use lut_gen::magnet::design::{Coil, Design, Region};
use lut_gen::magnet::field::Geometry;
use lut_gen::magnet::shape::Shape;
use lut_gen::magnet::study::{Flux, StudyError, Wanted};
use lut_gen::magnet::winding::{LAYERED, Winding};

use super::super::parse;
use super::evolution::Score;
use crate::experiment::ExperimentError;

/// What a magnet may be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Largest current of the driver, A.
    pub current_a: f64,
    /// Largest voltage across a coil at its highest temperature, V.
    pub volts: f64,
    /// How long the current must be able to flow from the room's temperature, s; infinite: for ever.
    pub seconds: f64,
    /// Largest box around the magnet, cm^3.
    pub volume_cm3: f64,
}

/// A magnet that was looked at.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// Number of its file.
    pub file: usize,
    /// Its parameters that were varied.
    pub set: BTreeMap<String, f64>,
    /// The box around it, cm^3.
    pub volume_cm3: f64,
    /// The largest current that its limits allow, A.
    pub current_a: f64,
    /// Heat of its coils at that current and their highest temperature, W.
    pub watt: f64,
    /// Flux density where the control curve is read, T.
    pub flux: Flux,
}

/// Why a candidate is none.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Unfit {
    /// Its file with these parameters is no magnet.
    #[error("cannot be drawn: {0}")]
    Drawing(String),
    /// Its wire needs more of the window than there is: by this part.
    #[error("has a window too small for its wire, by {:.0} %: fewer turns, a thinner wire (a larger gauge) or more room", 100.0 * .0)]
    Wire(f64),
    /// It is larger than allowed: by this part.
    #[error("is too large, by {:.0} %", 100.0 * .0)]
    Large(f64),
    /// Its field cannot be computed.
    #[error("has no field: {0}")]
    Field(String),
}

impl Unfit {
    /// How far it is from a magnet: what cannot be drawn is farther than what does not fit.
    fn violation(&self) -> f64 {
        match self {
            Unfit::Wire(part) | Unfit::Large(part) => *part,
            Unfit::Drawing(_) | Unfit::Field(_) => 1e6,
        }
    }
}

/// Volume against flux density: less of the one, more of the other.
pub fn score(found: &Result<Candidate, Unfit>) -> Score {
    match found {
        Ok(found) => Score { goals: [found.volume_cm3, -found.flux.size_t()], violation: 0.0 },
        Err(unfit) => Score { goals: [f64::INFINITY; 2], violation: unfit.violation() },
    }
}

/// How exactly a candidate is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Care {
    /// One coarse mesh.
    Rough,
    /// The usual two.
    Usual,
}

/// Multiplies sizes where a candidate is computed roughly: the flux density is then good to about 1 %.
const ROUGH: f64 = 4.0;

/// A magnet of this file with these parameters.
///
/// # Errors
/// [`Unfit`], with the reason.
pub fn candidate(
    (file, text): (usize, &str),
    set: &BTreeMap<String, f64>,
    limits: &Limits,
    care: Care,
) -> Result<Candidate, Unfit> {
    let read = |error: ExperimentError| Unfit::Drawing(error.to_string());
    let magnet = parse(Path::new("magnet.toml"), text, set).map_err(read)?;
    let volume_cm3 = volume_cm3(&magnet.design);
    if volume_cm3 > limits.volume_cm3 {
        return Err(Unfit::Large(volume_cm3 / limits.volume_cm3 - 1.0));
    }
    let study = |currents: &[f64], is_single: bool| {
        let coarser = if care == Care::Rough { ROUGH } else { 1.0 };
        let wanted = Wanted { is_single, coarser, ..magnet.wanted() };
        let failed = |error: StudyError| Unfit::Field(error.to_string());
        magnet.design.study(&wanted, currents, &mut |_| {}).map_err(failed)
    };
    let crowded = crowded(&magnet.design, &study(&[], true)?.areas);
    if crowded > 0.0 {
        return Err(Unfit::Wire(crowded));
    }
    let current_a = most_a(&magnet.design, limits);
    let solved = study(&[current_a], care == Care::Rough)?;
    let flux = solved.states.last().and_then(|state| magnet.controlled(state));
    let flux = flux.ok_or_else(|| Unfit::Field("the file does not say where its flux density is read".to_owned()))?;
    Ok(Candidate { file, set: set.clone(), volume_cm3, current_a, watt: watt(&magnet.design, current_a), flux })
}

/// The box around everything that is drawn, cm^3: in the plane as deep as the core and a winding's ends before and behind it;
/// about an axis a cylinder.
fn volume_cm3(design: &Design) -> f64 {
    let bounds = |shapes: &mut dyn Iterator<Item = &Shape>| {
        shapes.map(Shape::bounds).fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], |[low, high], [a, b]| {
            [[low[0].min(a[0]), low[1].min(a[1])], [high[0].max(b[0]), high[1].max(b[1])]]
        })
    };
    let [low, high] = bounds(&mut design.regions.iter().flat_map(|region| &region.shapes));
    let mm3 = match design.geometry {
        Geometry::Plane => {
            let wound = design.regions.iter().filter(|region| region.coil.is_some());
            let end_mm = wound.map(Region::extent_mm).fold(0.0, f64::max);
            (high[0] - low[0]) * (high[1] - low[1]) * (design.depth_mm + 2.0 * end_mm)
        }
        Geometry::Axisymmetric => std::f64::consts::PI * high[0] * high[0] * (high[1] - low[1]),
    };
    1e-3 * mm3
}

/// By what part the wires of the fullest window are more than lie in layers; 0 or less where all fit.
fn crowded(design: &Design, areas: &[f64]) -> f64 {
    let coils = design.coils.iter().enumerate().flat_map(|(i, coil)| {
        let windows = design.window_mm2(i, areas).into_iter().filter(|window| *window > 0.0);
        windows.map(|window| coil.winding.filled(window) / LAYERED - 1.0)
    });
    coils.fold(0.0, f64::max)
}

/// The largest current that every coil may carry, A.
fn most_a(design: &Design, limits: &Limits) -> f64 {
    let of = |coil: &Coil| {
        let winding = &coil.winding;
        let most = limits.current_a.min(limits.volts / winding.ohm(winding.limit_c));
        lasting_a(winding, most, limits.seconds) / coil.share.abs()
    };
    let coils = design.coils.iter().filter(|coil| coil.share != 0.0);
    coils.map(of).fold(f64::INFINITY, f64::min)
}

/// The largest current up to `most_a` that may flow for so long, A. The time falls with the current: halving.
fn lasting_a(winding: &Winding, most_a: f64, seconds: f64) -> f64 {
    if winding.seconds(most_a) >= seconds {
        return most_a;
    }
    let (mut low, mut high) = (0.0, most_a);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if winding.seconds(middle) >= seconds { low = middle } else { high = middle }
    }
    low
}

fn watt(design: &Design, current_a: f64) -> f64 {
    let of = |coil: &Coil| (coil.share * current_a).powi(2) * coil.winding.ohm(coil.winding.limit_c);
    design.coils.iter().map(of).sum()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    const RING: &str = include_str!("../../../magnets/ring.toml");

    const LIMITS: Limits = Limits { current_a: 2.5, volts: 36.0, seconds: 10.0, volume_cm3: 100.0 };

    fn with(set: &[(&str, f64)], limits: &Limits) -> Result<Candidate, Unfit> {
        let set = set.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
        candidate((0, RING), &set, limits, Care::Rough)
    }

    #[test]
    fn limits_bound_the_current() {
        let free = with(&[], &LIMITS).unwrap();
        assert_eq!(free.current_a, 2.5);
        // 770 turns of 28 AWG: 5.115 Ohm at 20 C, 7.33 Ohm at 130 C
        let weak = with(&[], &Limits { volts: 7.326, ..LIMITS }).unwrap();
        assert!((weak.current_a - 1.0).abs() < 2e-3, "{}", weak.current_a);
        let for_ever = with(&[], &Limits { seconds: f64::INFINITY, ..LIMITS }).unwrap();
        assert!((for_ever.current_a - 0.8465).abs() < 2e-4, "{}", for_ever.current_a);
        assert!(for_ever.flux.size_t() < free.flux.size_t() && for_ever.watt < free.watt);
    }

    #[test]
    fn a_magnet_that_cannot_be_built_says_why() {
        assert!(matches!(with(&[("turns", 1500.0)], &LIMITS), Err(Unfit::Wire(part)) if part > 0.3));
        assert!(matches!(with(&[], &Limits { volume_cm3: 10.0, ..LIMITS }), Err(Unfit::Large(part)) if part > 0.5));
        assert!(matches!(with(&[("gap", -1.0)], &LIMITS), Err(Unfit::Drawing(text)) if text.contains("width")));
        assert!(score(&with(&[("turns", 1500.0)], &LIMITS)).violation > 0.3);
    }

    #[test]
    fn a_rough_look_is_near_a_careful_one() {
        let careful = candidate((0, RING), &BTreeMap::new(), &LIMITS, Care::Usual).unwrap();
        let rough = with(&[], &LIMITS).unwrap();
        assert!((rough.flux.size_t() / careful.flux.size_t() - 1.0).abs() < 0.01);
        assert!(careful.flux.error_t < 1e-3 * careful.flux.size_t());
    }

    #[test]
    fn a_smaller_gap_has_more_flux_in_a_box_as_large() {
        let (wide, narrow) = (with(&[], &LIMITS).unwrap(), with(&[("gap", 5.0)], &LIMITS).unwrap());
        assert!(narrow.flux.size_t() > 1.3 * wide.flux.size_t());
        assert_eq!(narrow.volume_cm3, wide.volume_cm3);
        assert!(score(&Ok(narrow)).dominates(&score(&Ok(wide))));
    }
}
