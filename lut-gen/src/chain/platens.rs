//! What friction on its platens adds to the force of a nearly incompressible cylinder, by finite elements.
//!
//! A foam of Poisson's ratio 0 does not spread, so that its platens rub on nothing. A rubber does, and bulges
//! where its faces are held back. Forces are those of a unit modulus over those of the same cylinder between
//! frictionless platens: a share of the force, whatever relaxes in it.

use rayon::prelude::*;

use crate::solid::homogeneous::{Coupon, Mode, Programme};
use crate::solid::law::{Material, Ogden};
use crate::solid::model::chebyshev::{clenshaw, least_squares};
use crate::solid::model::{Compression, Ends, Record, Resolution};
use crate::solid::solve::{Motion, SolveError};

/// Exponents and coefficients of friction that are solved; between them cubics are drawn, beyond them the last
/// one holds.
const ALPHAS: [f64; 6] = [1.0, 2.0, 4.0, 6.0, 9.0, 14.0];
const FRICTIONS: [f64; 7] = [0.05, 0.1, 0.2, 0.3, 0.45, 0.65, 1.0];
/// Intervals of the way down, and of the way back.
const PLACES: usize = 40;
/// Degree of the way down.
const DEGREE: usize = 7;
/// `D_1 mu`: a Poisson's ratio of 0.4992, at which two cylinders of one shape differ by their modulus only.
const COMPRESSIBILITY: f64 = 0.005;
/// Parts of the way that are tried in turn: a corner that folds too far ends a solve of stiff, deep cylinders.
const FOLLOWED: [f64; 5] = [1.0, 0.9, 0.8, 0.65, 0.5];
/// Its force is within 0.03 % of that of the standard mesh at two thirds of shortening.
const MESH: Resolution = Resolution::Refined(0.6);

/// Added shares of the force at even places, exponent by exponent, friction by friction.
type Branch = Vec<Vec<Vec<f64>>>;
/// The same of one exponent and friction, on the way down and back.
type Case = (Vec<f64>, Vec<f64>);

/// Added forces of one shape of a cylinder that is shortened by up to a share of its height.
#[derive(Debug, Clone, PartialEq)]
pub struct Rubbing {
    /// Largest shortening, as a share of the height.
    turn: f64,
    /// From nothing to `turn`.
    down: Branch,
    /// On the way back; empty where there is none.
    back: Branch,
}

impl Rubbing {
    /// Solves a cylinder of a radius over its height that is shortened by `turn` of its height, in (0, 0.9), and
    /// let go again if `returns`.
    ///
    /// # Errors
    /// As [`Compression::solve`].
    pub fn solved(radius_over_height: f64, turn: f64, returns: bool) -> Result<Self, SolveError> {
        let cases: Vec<(f64, f64)> = ALPHAS.iter().flat_map(|a| FRICTIONS.map(|f| (*a, f))).collect();
        let each =
            cases.par_iter().map(|(alpha, friction)| added(radius_over_height, turn, (*alpha, *friction), returns));
        let all = each.collect::<Result<Vec<_>, _>>()?;
        let branch = |of: fn(&Case) -> &Vec<f64>| -> Branch {
            all.chunks(FRICTIONS.len()).map(|row| row.iter().map(|own| of(own).clone()).collect()).collect()
        };
        let back = if returns { branch(|own| &own.1) } else { Vec::new() };
        Ok(Self { turn, down: branch(|own| &own.0), back })
    }

    /// Force over that of frictionless platens at a shortening (a share of the height), on the way back or not.
    #[must_use]
    pub fn factor(&self, (alpha, friction): (f64, f64), share: f64, is_back: bool) -> f64 {
        let table = if is_back && !self.back.is_empty() { &self.back } else { &self.down };
        let place = (share / self.turn).clamp(0.0, 1.0) * PLACES as f64;
        let at = (place as usize).min(PLACES - 1);
        let beyond = place - at as f64;
        let of = |curve: &Vec<f64>| curve[at] + beyond * (curve[at + 1] - curve[at]);
        let logs = ALPHAS.map(f64::ln);
        let frictions: Vec<f64> = std::iter::once(0.0).chain(FRICTIONS).collect();
        let by_alpha: Vec<f64> = table
            .iter()
            .map(|row| {
                let values: Vec<f64> = std::iter::once(0.0).chain(row.iter().map(of)).collect();
                cubic(&frictions, &values, friction)
            })
            .collect();
        1.0 + cubic(&logs, &by_alpha, alpha.ln())
    }
}

/// What one friction adds on the way down, and back.
fn added(radius_over_height: f64, turn: f64, (alpha, friction): (f64, f64), returns: bool) -> Result<Case, SolveError> {
    let material = Material::from(Ogden::one_term(1.0, alpha, COMPRESSIBILITY)?);
    let followed = |part: f64| {
        let ramp = Motion::ramp(part * turn, 1.0);
        let cylinder = Compression {
            material: material.clone(),
            height_mm: 1.0,
            radius_mm: radius_over_height,
            ends: Ends::Friction(friction),
            motion: if returns { ramp.to_depth(0.0, 1.0) } else { ramp },
            resolution: MESH,
        };
        cylinder.solve().map(|record| (part * turn, record))
    };
    let (reached, record) = FOLLOWED[1..].iter().fold(followed(FOLLOWED[0]), |found, part| match found {
        Err(SolveError::NoConvergence { .. } | SolveError::TooManyIterations { .. }) => followed(*part),
        found => found,
    })?;
    let area_mm2 = std::f64::consts::PI * radius_over_height * radius_over_height;
    let plain = frictionless(material, area_mm2, turn)?;
    let share = |place: f64, is_back: bool| {
        let at = (place as usize).min(PLACES - 1);
        let plain_n = plain[at] + (place - at as f64) * (plain[at + 1] - plain[at]);
        force_at(&record, turn * place / PLACES as f64, is_back) / plain_n - 1.0
    };
    // at nothing both forces are nothing; beyond what could be followed the last share holds, and a cylinder that had to
    // turn before stands for its like that turns at the end
    let followed = reached / turn;
    let down = (0..=PLACES).map(|k| share((k.max(1) as f64).min(followed * PLACES as f64), false));
    let back = (0..=PLACES).map(|k| share(followed * k.max(1) as f64, true));
    Ok((smooth(&down.collect::<Vec<_>>()), if returns { back.collect() } else { Vec::new() }))
}

/// Values at even places without what elements add that fold onto the platen one by one, some thousandths of the
/// force: the polynomial of [`DEGREE`] that is nearest to them.
fn smooth(values: &[f64]) -> Vec<f64> {
    let place = |k: usize| 2.0 * k as f64 / (values.len() - 1) as f64 - 1.0;
    let points: Vec<(f64, f64, f64)> = values.iter().enumerate().map(|(k, v)| (place(k), *v, 1.0)).collect();
    let coefficients = least_squares(&points, DEGREE + 1);
    (0..values.len()).map(|k| clenshaw(&coefficients, place(k))).collect()
}

/// Forces between frictionless platens at the places.
fn frictionless(material: Material, area_mm2: f64, turn: f64) -> Result<Vec<f64>, SolveError> {
    let coupon = Coupon { material, mode: Mode::Uniaxial, area_mm2 };
    let time_s: Vec<f64> = (0..=PLACES).map(|k| k as f64).collect();
    let stretch = time_s.iter().map(|k| 1.0 - turn * k / PLACES as f64).collect();
    let response = coupon.follow(&Programme { time_s, stretch }, &[])?;
    Ok(response.force_n(&coupon).iter().map(|force| -force).collect())
}

/// Force of a record at a depth, between its equilibria: before its deepest, or after it.
fn force_at(record: &Record, depth_mm: f64, is_back: bool) -> f64 {
    let points: Vec<(f64, f64)> = record.depth_mm.iter().copied().zip(record.force_n.iter().copied()).collect();
    let deepest = (0..points.len()).max_by(|a, b| points[*a].0.total_cmp(&points[*b].0)).unwrap_or(0);
    let branch = if is_back { &points[deepest..] } else { &points[..=deepest] };
    let between = |pair: &&[(f64, f64)]| (pair[0].0.min(pair[1].0)..=pair[0].0.max(pair[1].0)).contains(&depth_mm);
    branch.windows(2).find(between).map_or_else(
        || branch.last().map_or(0.0, |p| p.1),
        |pair| {
            let width = pair[1].0 - pair[0].0;
            let part = if width == 0.0 { 0.0 } else { (depth_mm - pair[0].0) / width };
            pair[0].1 + part * (pair[1].1 - pair[0].1)
        },
    )
}

/// Cubic through two neighbours with the slopes of the parabolas through three; constant beyond the ends.
fn cubic(nodes: &[f64], values: &[f64], x: f64) -> f64 {
    let last = nodes.len() - 1;
    let x = x.clamp(nodes[0], nodes[last]);
    let at = nodes.windows(2).position(|pair| x <= pair[1]).unwrap_or(last - 1);
    let secant = |k: usize| (values[k + 1] - values[k]) / (nodes[k + 1] - nodes[k]);
    let slope = |k: usize| {
        if k == 0 || k == last {
            return secant(k.min(last - 1));
        }
        let (before, after) = (nodes[k] - nodes[k - 1], nodes[k + 1] - nodes[k]);
        (after * secant(k - 1) + before * secant(k)) / (before + after)
    };
    let width = nodes[at + 1] - nodes[at];
    let t = (x - nodes[at]) / width;
    let (t2, t3) = (t * t, t * t * t);
    values[at] * (2.0 * t3 - 3.0 * t2 + 1.0)
        + values[at + 1] * (3.0 * t2 - 2.0 * t3)
        + width * (slope(at) * (t3 - 2.0 * t2 + t) + slope(at + 1) * (t3 - t2))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use std::sync::LazyLock;

    use super::*;

    const SHAPE: f64 = 25.0 / 30.0;
    const TURN: f64 = 0.5;
    static TABLE: LazyLock<Rubbing> = LazyLock::new(|| Rubbing::solved(SHAPE, TURN, true).unwrap());

    /// Between nodes the table is as near to a solve of its own as the form of friction in a chain is said to be: 2 % of
    /// the force on the way down, 6 % on the way back, where the face turns round.
    #[test]
    fn between_its_nodes_the_table_is_a_solve() {
        let table = &*TABLE;
        for case in [(2.8, 0.15), (5.7, 0.25), (1.5, 0.55)] {
            let (down, back) = added(SHAPE, TURN, case, true).unwrap();
            for k in 4..=PLACES {
                let share = TURN * k as f64 / PLACES as f64;
                let miss = table.factor(case, share, false) / (1.0 + down[k]) - 1.0;
                assert!(miss.abs() < 0.02, "{case:?} at {share}: {miss}");
                let miss = table.factor(case, share, true) / (1.0 + back[k]) - 1.0;
                assert!(miss.abs() < 0.06, "{case:?} back at {share}: {miss}");
            }
        }
    }

    /// To first order a slipping face adds `2 f R / 3 h` of the force, of the sizes that it has then: the shear `f p`
    /// over the face brings `p` up towards the axis (Siebel 1923).
    #[test]
    fn a_little_friction_adds_what_a_slab_in_balance_says() {
        let (down, _) = added(2.0, 0.1, (2.0, 0.1), false).unwrap();
        let added = down[PLACES];
        let siebel = 2.0 * 0.1 * 2.0 / 3.0 / 0.9_f64.powf(1.5);
        assert!((added / siebel - 1.0).abs() < 0.15, "{added} beside {siebel}");
        assert!((TABLE.factor((2.0, 0.0), 0.05, false) - 1.0).abs() < 1e-12);
    }

    /// Friction adds to the force on the way down, and takes from it on the way back once the face slips inwards.
    #[test]
    fn on_the_way_back_friction_pulls_the_other_way() {
        let table = &*TABLE;
        let at = |is_back| table.factor((3.0, 0.2), 0.3 * TURN, is_back);
        assert!(at(false) > 1.1 && at(true) < 0.9, "{} {}", at(false), at(true));
    }

    /// A parabola comes back within the nodes, and ends are kept.
    #[test]
    fn a_cubic_keeps_parabolas() {
        let nodes = [0.0, 1.0, 3.0, 4.0];
        let values = nodes.map(|x: f64| x * x);
        assert!((cubic(&nodes, &values, 2.0) - 4.0).abs() < 1e-12);
        assert!((cubic(&nodes, &values, 9.0) - 16.0).abs() < 1e-12);
    }
}
