//! The bodies with their equations, and where they are.

use super::body::Body;
use super::body::section::{Quad, Rule, Section, Slope};
use super::contact::energy::{DOFS, Own, Penalty, Push};
use super::contact::friction::{Ends, Friction, Grip};
use super::contact::opposite::{Edge, faces};
use super::contact::rigid::Rigid;
use super::contact::segment::Across;
use super::error::PadError;
use super::law::material::{Material, Matter};
use super::potential::Matrix;
use crate::fem::domain::Domain;
use crate::fem::element::Element;
use crate::fem::equations::Equations;
use crate::fem::operator::PointLaw;
use crate::fem::sparse::HELD;

/// What lies across from the own edges.
#[derive(Debug, Clone)]
pub enum Counter {
    /// A rigid body.
    Rigid(Rigid),
    /// Edges of the other body, from the axis outward.
    Edges(Vec<[usize; 3]>),
}

/// Bodies, contact, and the factor of their equations.
pub struct Model {
    /// Positions of all nodes before anything moves (mm).
    pub nodes: Vec<[f64; 2]>,
    /// Which nodes belong to the body that moves down.
    pub moving: Vec<bool>,
    /// Elements with their equations.
    pub domain: Domain<f64, Slope, 8, 2>,
    /// Material of every element.
    pub of: Vec<usize>,
    /// The materials.
    pub materials: Vec<Material>,
    /// Edges that penetrations are measured on, from the axis outward.
    pub own: Vec<[usize; 3]>,
    /// What lies across.
    pub counter: Counter,
    /// How penetration is resisted.
    pub penalty: Penalty,
    /// How slip is.
    pub friction: Option<Friction>,
    /// Pattern, places in it and factor, of the elements and the edges that may meet.
    pub(super) matrix: Option<Matrix>,
}

/// One moment of a press.
#[derive(Debug, Clone, Copy)]
pub struct Moment<'a> {
    /// How far the upper body has come down (mm).
    pub travel_mm: f64,
    /// Yield stress of plastic bodies (MPa).
    pub yield_mpa: f64,
    /// Time since the moment before (s).
    pub step_s: f64,
    /// What the points remember of the moment before.
    pub old: &'a [f64],
}

impl Model {
    /// Of bodies, each with whether it moves; their own and counter edges are told by the caller.
    ///
    /// # Errors
    /// [`PadError::Value`] when an element turns over.
    pub fn new(
        bodies: &[(&Body, bool)],
        rule: Rule,
        penalty: Penalty,
        edges: impl FnOnce(&[usize]) -> (Vec<[usize; 3]>, Counter),
    ) -> Result<Self, PadError> {
        let section = penalty.section;
        let (mut nodes, mut moving, mut held) = (Vec::new(), Vec::new(), Vec::new());
        let (mut elements, mut of, mut materials, mut first): (Vec<Quad>, _, _, _) =
            (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for (body, moves) in bodies {
            let start = nodes.len();
            first.push(start);
            nodes.extend_from_slice(&body.nodes);
            held.extend_from_slice(&body.held);
            moving.resize(nodes.len(), *moves);
            of.extend(body.of.iter().map(|m| m + materials.len()));
            materials.extend(body.materials.iter().cloned());
            for e in &body.elements {
                let places = e.map(|n| body.nodes[n]);
                let turned = || PadError::Value {
                    parameter: "the area of an element (mm2)",
                    value: 0.0,
                    expected: "more than 0 at every point: change the element length or the measures",
                };
                elements.push(section.element(rule, e.map(|n| n + start), &places).ok_or_else(turned)?);
            }
        }
        let (own, counter) = edges(&first);
        let equations = Equations::number(held.into_iter());
        let domain = Domain { elements, equations };
        Ok(Self { nodes, moving, domain, of, materials, own, counter, penalty, friction: None, matrix: None })
    }

    /// Plane or ring.
    #[must_use]
    pub fn section(&self) -> Section {
        self.penalty.section
    }

    /// Number of equations.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.domain.equations.unknowns()
    }

    /// Numbers that all points remember.
    #[must_use]
    pub fn states(&self) -> usize {
        let each = |(e, m): (&Element<_, _, 8>, &usize)| e.points.len() * self.each(*m);
        self.domain.elements.iter().zip(&self.of).map(each).sum()
    }

    /// Where the memories of points that yield begin among all.
    pub(super) fn yielding(&self) -> impl Iterator<Item = usize> {
        let mut at = 0;
        self.domain.elements.iter().zip(&self.of).flat_map(move |(element, material)| {
            let (each, start) = (self.each(*material), at);
            at += each * element.points.len();
            let yields = matches!(self.materials[*material], Material::Plastic(_));
            (0..element.points.len()).filter(move |_| yields).map(move |i| start + i * each)
        })
    }

    /// A material at a moment.
    #[must_use]
    pub fn matter(&self, material: usize, moment: &Moment) -> Matter<'_> {
        Matter { material: &self.materials[material], yield_mpa: moment.yield_mpa, step_s: moment.step_s }
    }

    /// Numbers that a point of a material remembers.
    #[must_use]
    pub fn each(&self, material: usize) -> usize {
        Matter { material: &self.materials[material], yield_mpa: 0.0, step_s: 0.0 }.states()
    }

    /// Displacements of the nodes in the frame of their body, of the values of the equations.
    #[must_use]
    pub fn displacements(&self, x: &[f64]) -> Vec<f64> {
        self.domain.equations.list().iter().map(|d| if *d == HELD { 0.0 } else { x[*d] }).collect()
    }

    /// The values of the equations at displacements of the nodes.
    #[must_use]
    pub fn values(&self, u: &[f64]) -> Vec<f64> {
        let mut x = vec![0.0; self.unknowns()];
        for (d, u) in self.domain.equations.list().iter().zip(u).filter(|(d, _)| **d != HELD) {
            x[*d] = *u;
        }
        x
    }

    /// Where a node is (mm).
    #[must_use]
    pub fn position(&self, node: usize, x: &[f64], travel_mm: f64) -> [f64; 2] {
        let list = self.domain.equations.list();
        let u = |i: usize| if list[2 * node + i] == HELD { 0.0 } else { x[list[2 * node + i]] };
        let down = if self.moving[node] { travel_mm } else { 0.0 };
        [self.nodes[node][0] + u(0), self.nodes[node][1] + u(1) - down]
    }

    /// Where an edge is (mm).
    #[must_use]
    pub fn edge(&self, nodes: &[usize; 3], x: &[f64], travel_mm: f64) -> Edge {
        nodes.map(|n| self.position(n, x, travel_mm))
    }

    /// What lies across now.
    #[must_use]
    pub fn across(&self, x: &[f64], travel_mm: f64) -> Across<'_> {
        match &self.counter {
            Counter::Rigid(rigid) => {
                let down = if self.penalty.above < 0.0 { travel_mm } else { 0.0 };
                Across::Rigid(rigid, rigid.tip_mm - down)
            }
            Counter::Edges(edges) => Across::edges(edges.iter().map(|e| self.edge(e, x, travel_mm))),
        }
    }

    /// Positions of an own edge and of what lies across.
    pub(super) fn ends<T>(
        &self,
        (own, other): (usize, usize),
        x: &[f64],
        travel_mm: f64,
        f: impl FnOnce(Ends) -> T,
    ) -> T {
        let edge = self.edge(&self.own[own], x, travel_mm);
        match &self.counter {
            Counter::Edges(edges) => {
                let other = self.edge(&edges[other], x, travel_mm);
                f(Ends { own: &edge, other: Some(&other), tip_mm: 0.0 })
            }
            Counter::Rigid(_) => {
                let down = if self.penalty.above < 0.0 { travel_mm } else { 0.0 };
                f(Ends { own: &edge, other: None, tip_mm: -down })
            }
        }
    }

    /// What grips at values and travel of a pass, over a step that started at others; nothing
    /// without friction.
    #[must_use]
    pub fn grips(&self, (x, travel_mm): (&[f64], f64), (start, start_mm): (&[f64], f64)) -> Vec<Grip> {
        let mut grips = Vec::new();
        let Some(friction) = &self.friction else { return grips };
        let across = self.across(x, travel_mm);
        self.facing(x, travel_mm, |number, own| {
            let from = grips.len();
            self.penalty.grips(friction, (number, own), &across, &mut grips);
            for grip in &mut grips[from..] {
                self.ends((number, grip.other), start, start_mm, |ends| grip.begin(&ends));
            }
        });
        grips
    }

    /// Visits every own edge that faces the other side, with its number, where it was and where it
    /// is.
    pub fn facing(&self, x: &[f64], travel_mm: f64, mut visit: impl FnMut(usize, Own)) {
        for (number, nodes) in self.own.iter().enumerate() {
            let now = self.edge(nodes, x, travel_mm);
            if !faces(&now) {
                break;
            }
            visit(number, Own { reference: &nodes.map(|n| self.nodes[n]), now: &now });
        }
    }

    /// Equations of two edges that meet; those of a rigid body are none.
    pub(super) fn pair(&self, own: usize, other: usize) -> [usize; DOFS] {
        let list = self.domain.equations.list();
        let mut dofs = [HELD; DOFS];
        let mut put = |from: usize, nodes: &[usize; 3]| {
            for (a, n) in nodes.iter().enumerate() {
                dofs[from + 2 * a..from + 2 * a + 2].copy_from_slice(&list[2 * n..2 * n + 2]);
            }
        };
        put(0, &self.own[own]);
        if let Counter::Edges(edges) = &self.counter {
            put(6, &edges[other]);
        }
        dofs
    }

    /// What pressure and friction push along y on the own edges (N, in the plane N/mm), positive
    /// when they press.
    #[must_use]
    pub fn force(&self, x: &[f64], travel_mm: f64, grips: &[Grip]) -> f64 {
        let across = self.across(x, travel_mm);
        let mut force = 0.0;
        let mut add = |push: &Push| force -= self.penalty.above * (push.force[1] + push.force[3] + push.force[5]);
        self.facing(x, travel_mm, |_, own| {
            self.penalty.push(own, &across, false, |_, push| add(push));
        });
        if let Some(friction) = &self.friction {
            for grip in grips {
                let mut push = Push::none();
                self.ends((grip.own, grip.other), x, travel_mm, |ends| grip.resist(friction, &ends, false, &mut push));
                add(&push);
            }
        }
        force
    }
}
