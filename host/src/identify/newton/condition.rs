//! One condition: a specimen under a ball or between faces at a rate, with a hold or without, shared by the runs that
//! repeat it.

use std::sync::Arc;

use lut_gen::solid::contact::Ball;
use lut_gen::solid::law::Parameter;
use lut_gen::solid::model::{ForceModel, Press, RAMP_NODES, Resolution, Simulation, Specimen};
use lut_gen::solid::solve::{Motion, SolveError};

use crate::identify::grip::Grip;

use super::bulk::Bulk;
use super::coordinate::{Kind, Scope, Unknown, Values};
use super::reference::Reference;
use super::surrogate::{Node, Surrogate};
use super::table::Table;
use super::track::Track;

/// Where the forces of a condition come from.
#[derive(Debug, Clone)]
pub enum Source {
    /// A finite-element solve a point.
    Solves(Resolution),
    /// A continuous force model made before; for a one-term Hyperfoam at one height.
    Model(Box<ForceModel>),
    /// Solves of this very condition made before, joined.
    Table(Arc<Table>),
}

/// A forward problem.
#[derive(Debug, Clone)]
pub struct Condition {
    /// Index into the experiment's specimens.
    pub specimen: usize,
    /// The ball, or what else deforms it.
    pub grip: Grip,
    /// The faces rub on their platens, so that the specimen barrels.
    pub rubs: bool,
    /// Length over which its faces come to touch, mm; 0 under a ball, which touches without a jump of stiffness.
    pub rounding_mm: f64,
    /// The block, with the height that is known or assumed.
    pub block: Specimen,
    /// Depth of the ramp, mm.
    pub depth_mm: f64,
    /// Rate of the ramp, mm/s; it decides nothing without relaxation.
    pub rate_mm_s: f64,
    /// Duration of the hold, s; 0 without one.
    pub hold_s: f64,
    /// Where forces come from.
    pub source: Source,
    /// Unknowns that this condition depends on, without the modulus: indices into the fit's.
    pub locals: Vec<usize>,
    /// The modulus it depends on.
    pub modulus: usize,
    /// What has been solved.
    pub surrogate: Surrogate,
    /// Largest relative scatter of a solve's stations.
    pub scatter: f64,
    /// Solves so far.
    pub solves: usize,
}

impl Condition {
    /// True when an unknown acts on this condition.
    pub fn feels(&self, unknown: &Unknown) -> bool {
        let touched = match unknown.kind {
            Kind::Friction | Kind::Height | Kind::BallRadius => self.grip.indenter().is_some(),
            Kind::PlatenFriction => self.rubs,
            _ => true,
        };
        touched
            && match unknown.scope {
                Scope::All => true,
                Scope::Specimen(at) => at == self.specimen,
                Scope::Indenter(at) => Some(at) == self.grip.indenter(),
            }
    }

    /// Takes the unknowns that act on it.
    pub fn attach(&mut self, unknowns: &[Unknown]) {
        let mine = |(_, u): &(usize, &Unknown)| self.feels(u);
        let (moduli, locals): (Vec<_>, Vec<_>) =
            unknowns.iter().enumerate().filter(mine).partition(|(_, u)| u.kind == Kind::Modulus);
        self.modulus = moduli.first().map_or(0, |(at, _)| *at);
        self.locals = locals.iter().map(|(at, _)| *at).collect();
        let width = |(_, u): &(usize, &Unknown)| {
            let (low, high) = u.bounds();
            (high - low).max(f64::MIN_POSITIVE)
        };
        let surrogate = Surrogate::new(locals.iter().map(width).collect());
        let kinds: Vec<Kind> = locals.iter().map(|(_, u)| u.kind).collect();
        self.surrogate = surrogate.knowing(self.reference(&kinds), bulk(&kinds));
    }

    /// What is known of relaxation under a ball beforehand.
    fn reference(&self, kinds: &[Kind]) -> Option<Reference> {
        let place = |kind: Kind| kinds.iter().position(|own| *own == kind);
        let terms: Vec<_> = (0..).map_while(|i| Some((place(Kind::G(i))?, place(Kind::Tau(i))?))).collect();
        let known = self.grip.indenter().is_some() && !terms.is_empty();
        let Self { depth_mm, rate_mm_s, hold_s, .. } = *self;
        known.then_some(Reference { terms, depth_mm, rate_mm_s, hold_s })
    }

    /// Forgets what was solved.
    pub(super) fn forget(&mut self) {
        self.surrogate = self.surrogate.forgotten();
    }

    /// True when its force changes with this coordinate.
    pub(super) fn rests_on(&self, axis: usize) -> bool {
        self.modulus == axis || self.locals.contains(&axis)
    }

    /// Its own coordinates out of all.
    pub fn local(&self, point: &[f64]) -> Vec<f64> {
        self.locals.iter().map(|at| point[*at]).collect()
    }

    /// True where nothing has to be solved at a point: it is, or the force costs nothing.
    pub fn knows(&self, point: &[f64]) -> bool {
        self.is_homogeneous() || self.surrogate.knows(&self.local(point))
    }

    /// The force between what is solved; `None` before the first solve.
    pub fn track(&self, point: &[f64]) -> Option<Track> {
        let values = self.surrogate.at(&self.local(point));
        (!values.is_empty()).then(|| self.track_of(&values, point[self.modulus]))
    }

    /// The force from the values of a press and the logarithm of the modulus (MPa).
    fn track_of(&self, values: &[f64], ln_mu: f64) -> Track {
        let track = Track::new(self.depth_mm, self.hold_s, values, ln_mu);
        track.beginning_as(self.grip.exponent(), self.rounding_mm)
    }

    /// The force near a solve by its slopes, where only the coordinate `axis` has moved, to `point`.
    pub(super) fn track_beside(&self, solve: &Node, axis: usize, point: &[f64]) -> Track {
        let mut values = solve.value.clone();
        if let Some(local) = self.locals.iter().position(|at| *at == axis) {
            let step = point[axis] - solve.x[local];
            values.iter_mut().zip(&solve.by[local]).for_each(|(v, by)| *v += by * step);
        }
        self.track_of(&values, point[self.modulus])
    }

    /// The force at a point where all of the specimen [deforms alike](Condition::is_homogeneous); `None` where the material does not exist.
    #[must_use]
    pub fn exact_track(&self, base: &Values, unknowns: &[Unknown], point: &[f64]) -> Option<Track> {
        let press = self.stretched(&self.values(base, unknowns, point), &[]).ok()?;
        Some(self.track_of(&[press.ramp, press.hold].concat(), point[self.modulus]))
    }

    /// Parameters for a unit modulus at a point.
    fn values(&self, base: &Values, unknowns: &[Unknown], point: &[f64]) -> Values {
        let mut values =
            Values { height_mm: self.block.height_mm, ball_mm: self.grip.ball_mm(), mu_mpa: 1.0, ..base.clone() };
        for &at in &self.locals {
            values.set(unknowns[at].kind, unknowns[at].value(point[at]));
        }
        values
    }

    /// Solves at a point: the force for a unit modulus and its derivatives by the local coordinates.
    ///
    /// # Errors
    /// What the solver says; it names the case.
    pub fn solve(&self, base: &Values, unknowns: &[Unknown], point: &[f64]) -> Result<(Node, f64), SolveError> {
        let x = self.local(point);
        let values = self.values(base, unknowns, point);
        match &self.source {
            Source::Model(model) => Ok((self.modelled(model, &values, x), 0.0)),
            Source::Table(table) => Ok((table.node(&x)?, 0.0)),
            Source::Solves(resolution) => {
                let chains: Vec<Vec<(Parameter, f64)>> =
                    self.locals.iter().map(|&at| values.chain(&unknowns[at], unknowns[at].value(point[at]))).collect();
                let mut wanted: Vec<Parameter> = Vec::new();
                for (parameter, _) in chains.iter().flatten() {
                    if !wanted.contains(parameter) {
                        wanted.push(*parameter);
                    }
                }
                let press = if self.is_homogeneous() {
                    self.stretched(&values, &wanted)?
                } else if self.rubs {
                    self.barrelled(&values, &wanted)?
                } else {
                    self.simulation(&values, *resolution)?.press(&wanted)?
                };
                Ok((node(&press, &wanted, &chains, x), press.scatter))
            }
        }
    }

    /// The simulation behind this condition for given parameters.
    ///
    /// # Errors
    /// When a parameter lies outside the law's range.
    pub fn simulation(&self, values: &Values, resolution: Resolution) -> Result<Simulation, SolveError> {
        let ramp = Motion::ramp(self.depth_mm, self.rate_mm_s);
        Ok(Simulation {
            material: values.unit_material()?,
            specimen: Specimen { height_mm: values.height_mm, ..self.block },
            ball: Ball { radius_mm: values.ball_mm },
            interface: values.interface(),
            motion: if self.hold_s > 0.0 { ramp.hold(self.hold_s) } else { ramp },
            resolution,
        })
    }

    fn modelled(&self, model: &ForceModel, values: &Values, x: Vec<f64>) -> Node {
        let axis = Press::ramp_axis();
        let gradients: Vec<_> = (0..RAMP_NODES)
            .map(|k| {
                let depth_mm = self.depth_mm * axis.node(k).powi(2);
                (depth_mm, model.gradient_at(1.0, values.alpha[0], depth_mm, values.height_mm))
            })
            .collect();
        let value = gradients.iter().map(|(d, g)| (g.force_n / d.powf(1.5)).ln()).collect();
        // The only local coordinate a force model serves is ln alpha.
        let by = x.iter().map(|_| gradients.iter().map(|(_, g)| values.alpha[0] * g.d_alpha / g.force_n).collect());
        Node { by: by.collect(), value, x }
    }
}

/// The places of what decides a bulk that relaxes, if all of it is free.
fn bulk(kinds: &[Kind]) -> Option<Bulk> {
    let place = |kind: Kind| kinds.iter().position(|own| *own == kind);
    let one = place(Kind::G(1)).is_none();
    let (g, k) = place(Kind::G(0)).zip(place(Kind::K(0))).filter(|_| one)?;
    Some(Bulk { compressibility: place(Kind::Compressibility)?, g, k })
}

fn node(press: &Press, wanted: &[Parameter], chains: &[Vec<(Parameter, f64)>], x: Vec<f64>) -> Node {
    let by = chains.iter().map(|chain| {
        let mut sum = vec![0.0; press.ramp.len() + press.hold.len()];
        for (parameter, factor) in chain {
            let Some(at) = wanted.iter().position(|p| p == parameter) else { continue };
            let slopes = press.ramp_by[at].iter().chain(&press.hold_by[at]);
            sum.iter_mut().zip(slopes).for_each(|(sum, slope)| *sum += factor * slope);
        }
        sum
    });
    let by = by.collect();
    Node { value: press.ramp.iter().chain(&press.hold).copied().collect(), by, x }
}
