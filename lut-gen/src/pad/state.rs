//! What is known at one depth.

use super::contact::energy::Touch;
use super::contact::friction::Grip;
use super::contact::segment::gap;
use super::law::gradient::{IDENTITY, cauchy, mises};
use super::law::material::Material;
use super::law::plastic::PLASTIC_STRAIN;
use super::model::{Counter, Model, Moment};
use crate::fem::operator::PointLaw;
use crate::fem::shape::line3;

/// An equilibrium.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Time since the start (s).
    pub time_s: f64,
    /// How far the upper body has come down since the first touch (mm).
    pub travel_mm: f64,
    /// Force (N; in the plane N per mm of length, of both halves).
    pub force_n: f64,
    /// Radius of the contact, in the plane its half width (mm).
    pub half_width_mm: f64,
    /// Area of the curved contact (mm2); in the plane its width along the curve (mm2 per mm).
    pub area_mm2: f64,
    /// Height of the contact's edge above its lowest point (mm): the cap that the upper body dips
    /// in with.
    pub cap_mm: f64,
    /// How far the lower body is pressed in on the axis (mm).
    pub depression_mm: f64,
    /// Places that touch, from the axis outward, with their pressure.
    pub pressure: Vec<Touch>,
    /// Positions of the nodes (mm), the upper body's first.
    pub nodes: Vec<[f64; 2]>,
    /// Number of the first node of the lower body; the number of all where that is rigid.
    pub lower: usize,
    /// Von Mises' stress at the nodes (MPa).
    pub mises_mpa: Vec<f64>,
    /// Largest equivalent plastic strain of a point.
    pub plastic_strain: f64,
    /// Factorisations since the last depth.
    pub steps: usize,
}

impl State {
    /// Of the values of the equations at a moment; `next` is what the points remember after it;
    /// time and steps are the path's to tell.
    pub(super) fn of(model: &Model, x: &[f64], moment: &Moment, next: &[f64], grips: &[Grip]) -> Self {
        let travel = moment.travel_mm;
        let nodes: Vec<[f64; 2]> = (0..model.nodes.len()).map(|n| model.position(n, x, travel)).collect();
        let mut state = Self {
            time_s: 0.0,
            travel_mm: travel,
            force_n: model.force(x, travel, grips),
            half_width_mm: 0.0,
            area_mm2: 0.0,
            cap_mm: 0.0,
            depression_mm: 0.0,
            pressure: Vec::new(),
            mises_mpa: mises_at_nodes(model, x, moment),
            nodes,
            lower: model.moving.iter().filter(|m| **m).count(),
            plastic_strain: model.yielding().map(|at| next[at + PLASTIC_STRAIN]).fold(0.0, f64::max),
            steps: 0,
        };
        state.touch(model, x, travel);
        state.depression_mm = depression(model, &state.nodes);
        state
    }

    fn touch(&mut self, model: &Model, x: &[f64], travel: f64) {
        let (across, above) = (model.across(x, travel), model.penalty.above);
        let (mut lowest, mut edge) = (f64::MAX, f64::MIN);
        model.facing(x, travel, |_, own| {
            model.penalty.touches(own, &across, |part, touch| {
                self.area_mm2 += touch.length_mm * model.section().depth_mm(touch.at[0]);
                lowest = lowest.min(touch.at[1]);
                self.pressure.push(touch);
                let end = line3(part.to).0;
                let at = [0, 1].map(|i| (0..3).map(|a| end[a] * own.now[a][i]).sum::<f64>());
                if at[0] > self.half_width_mm && gap(own.now, &across, part.other, above, part.to).is_some() {
                    self.half_width_mm = at[0];
                    edge = at[1];
                }
            });
        });
        if edge > f64::MIN {
            self.cap_mm = (edge - lowest).max(0.0);
        }
    }
}

/// How far the lower body's first surface node went down.
fn depression(model: &Model, nodes: &[[f64; 2]]) -> f64 {
    let node = match &model.counter {
        Counter::Edges(edges) if model.penalty.above > 0.0 => edges.first().map(|e| e[0]),
        Counter::Edges(_) => model.own.first().map(|e| e[0]),
        Counter::Rigid(_) if model.penalty.above < 0.0 => model.own.first().map(|e| e[0]),
        Counter::Rigid(_) => None,
    };
    node.map_or(0.0, |n| model.nodes[n][1] - nodes[n][1])
}

/// Of stresses that go from the outer four points to the corners by their bilinear, to the middles
/// by the mean of two corners, and are averaged over the elements of one material around a node;
/// where materials meet the larger counts.
fn mises_at_nodes(model: &Model, x: &[f64], moment: &Moment) -> Vec<f64> {
    let count = model.materials.len();
    let mut sums = vec![([0.0; 4], 0_u32); count * model.nodes.len()];
    let mut at = 0;
    for (element, &material) in model.domain.elements.iter().zip(&model.of) {
        let matter = model.matter(material, moment);
        let each = matter.states();
        let (_, u) = model.domain.equations.gather::<f64, 16>(&element.nodes, x);
        let stress = |(i, f): (usize, [f64; 5])| {
            let old = &moment.old[at + i * each..at + (i + 1) * each];
            matter.flux(&f, old, None).map_or([0.0; 4], |(_, p)| cauchy(&f, &p))
        };
        let points: Vec<[f64; 4]> = element.strains(IDENTITY, &u).enumerate().map(stress).collect();
        at += each * points.len();
        for (a, node) in element.nodes.iter().enumerate() {
            let (sum, elements) = &mut sums[count * node + material];
            sum.iter_mut().zip(extrapolated(&points, a)).for_each(|(sum, s)| *sum += s);
            *elements += 1;
        }
    }
    // no stress goes beyond the yield stress between points that do not
    let limits: Vec<f64> = model
        .materials
        .iter()
        .map(|m| if matches!(m, Material::Plastic(_)) { moment.yield_mpa } else { f64::INFINITY })
        .collect();
    let of = |((sum, elements), limit): (&([f64; 4], u32), &f64)| match elements {
        0 => 0.0,
        _ => mises(&sum.map(|s| s / f64::from(*elements))).min(*limit),
    };
    sums.chunks(count).map(|sums| sums.iter().zip(&limits).map(of).fold(0.0, f64::max)).collect()
}

/// The stress of an element's points at its node `a`.
fn extrapolated(points: &[[f64; 4]], a: usize) -> [f64; 4] {
    // points run along the second coordinate first; the outer four of a rule of side `n`
    let n = if points.len() == 4 { 2 } else { 3 };
    let outer = [0, (n - 1) * n, n * n - 1, n - 1].map(|i| points[i]);
    let reach = if n == 2 { 3_f64.sqrt() } else { (5.0_f64 / 3.0).sqrt() };
    const CORNER: [[f64; 2]; 8] =
        [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]];
    let [s, t] = CORNER[a].map(|c| c * reach);
    std::array::from_fn(|c| {
        (0..4).map(|k| 0.25 * (1.0 + CORNER[k][0] * s) * (1.0 + CORNER[k][1] * t) * outer[k][c]).sum()
    })
}
