//! Energy of one moment over the free displacements, and where its second derivative goes.

use super::contact::energy::Push;
use super::contact::friction::Grip;
use super::error::PadError;
use super::law::material::Matter;
use super::model::{Counter, Model, Moment};
use crate::fem::domain::Stiff;
use crate::fem::equations::spread;
use crate::fem::newton::Energy;
use crate::fem::sparse::{Factor, Pattern, Scatter, Stored, add_lower, elimination_order};

/// Degrees of freedom of an element.
const QUAD: usize = 16;

/// Pattern and factor of the elements and of the edges that may meet.
pub(super) struct Matrix {
    pub pattern: Pattern,
    pub factor: Factor,
    elements: Scatter,
    /// Of every own edge the other edges that it may meet, with the places of both.
    meetings: Vec<Vec<(usize, Vec<u32>)>>,
}

impl Model {
    /// Makes pattern and factor anew for edges that are or come within `reach_mm` of each other
    /// along x, unless the present ones know all that are within half of it. Equations get other
    /// numbers: displacements stay, values do not.
    pub(super) fn prepare(&mut self, u: &[f64], travel_mm: f64, reach_mm: f64) -> Result<(), PadError> {
        let near = |model: &Self, reach: f64| -> Vec<Vec<usize>> {
            let x = model.values(u);
            let Counter::Edges(edges) = &model.counter else { return vec![vec![0]; model.own.len()] };
            let range = |nodes: &[usize; 3]| {
                let edge = model.edge(nodes, &x, travel_mm);
                (edge.iter().map(|p| p[0]).fold(f64::MAX, f64::min), edge.iter().map(|p| p[0]).fold(f64::MIN, f64::max))
            };
            let others: Vec<(f64, f64)> = edges.iter().map(range).collect();
            let of = |own: &[usize; 3]| {
                let (low, high) = range(own);
                let meets = |(_, o): &(usize, &(f64, f64))| o.1 >= low - reach && o.0 <= high + reach;
                others.iter().enumerate().filter(meets).map(|(number, _)| number).collect()
            };
            model.own.iter().map(of).collect()
        };
        if let Some(matrix) = &self.matrix {
            let knows = |(own, wanted): (usize, &Vec<usize>)| {
                wanted.iter().all(|w| matrix.meetings[own].iter().any(|(other, _)| other == w))
            };
            if near(self, 0.5 * reach_mm).iter().enumerate().all(knows) {
                return Ok(());
            }
        }
        let meetings = near(self, reach_mm);
        let unknowns = self.unknowns();
        let memory = || PadError::Memory { unknowns };
        let groups = |model: &Self| -> Vec<Vec<usize>> {
            let pairs = meetings.iter().enumerate().flat_map(|(own, others)| others.iter().map(move |o| (own, *o)));
            let mut groups = model.domain.groups();
            groups.extend(pairs.map(|(own, other)| model.pair(own, other).to_vec()));
            groups
        };
        let before = groups(self);
        let (unordered, _) = Pattern::new(unknowns, before.iter().map(Vec::as_slice), Stored::Lower);
        let place = elimination_order(&unordered).ok_or_else(memory)?;
        self.domain.equations.renumber(&place);
        let ordered = groups(self);
        let (pattern, mut scatter) = Pattern::new(unknowns, ordered.iter().map(Vec::as_slice), Stored::Lower);
        let factor = Factor::new(&pattern).ok_or_else(memory)?;
        let mut pairs = scatter.split_off(self.domain.elements.len()).into_iter();
        let meetings = meetings.iter().map(|others| others.iter().copied().zip(pairs.by_ref()).collect()).collect();
        self.matrix = Some(Matrix { pattern, factor, elements: scatter, meetings });
        Ok(())
    }
}

/// The energy at one moment.
pub(super) struct Potential<'a> {
    pub model: &'a Model,
    pub matrix: &'a Places<'a>,
    pub moment: Moment<'a>,
    pub grips: &'a [Grip],
}

/// Where values go, apart from the factor that they are factorised into.
pub(super) struct Places<'a> {
    elements: &'a Scatter,
    meetings: &'a [Vec<(usize, Vec<u32>)>],
}

impl Matrix {
    /// The places, the pattern, and the factor.
    pub fn split(&mut self) -> (Places<'_>, &Pattern, &mut Factor) {
        (Places { elements: &self.elements, meetings: &self.meetings }, &self.pattern, &mut self.factor)
    }
}

impl Potential<'_> {
    /// Adds the contact; `None` where edges meet that the pattern does not know.
    fn contact(&self, x: &[f64], slope: &mut [f64], mut values: Option<&mut [f64]>) -> Option<f64> {
        let (model, travel) = (self.model, self.moment.travel_mm);
        let across = model.across(x, travel);
        let (mut energy, mut known) = (0.0, true);
        model.facing(x, travel, |number, own| {
            energy += model.penalty.push(own, &across, values.is_some(), |other, push| {
                known &= self.add((number, other), push, slope, values.as_deref_mut());
            });
        });
        let Some(friction) = &model.friction else { return known.then_some(energy) };
        for grip in self.grips {
            let mut push = Push::none();
            energy += model.ends((grip.own, grip.other), x, travel, |ends| {
                grip.resist(friction, &ends, values.is_some(), &mut push)
            });
            known &= self.add((grip.own, grip.other), &push, slope, values.as_deref_mut());
        }
        known.then_some(energy)
    }

    /// Adds what two edges do to each other; false where the pattern does not know them.
    fn add(&self, (own, other): (usize, usize), push: &Push, slope: &mut [f64], values: Option<&mut [f64]>) -> bool {
        spread(&self.model.pair(own, other), &push.force, slope);
        let Some(values) = values else { return true };
        let places = self.matrix.meetings[own].iter().find(|(o, _)| *o == other);
        places.inspect(|(_, places)| add_lower(values, places, &push.stiffness)).is_some()
    }

    fn matters(&self) -> Vec<Matter<'_>> {
        (0..self.model.materials.len()).map(|m| self.model.matter(m, &self.moment)).collect()
    }

    /// What the points will remember; `None` where a strain is impossible.
    pub fn remember(&self, x: &[f64]) -> Option<Vec<f64>> {
        let mut new = vec![0.0; self.moment.old.len()];
        let matters = self.matters();
        let law = |e: usize| Some(&matters[self.model.of[e]]);
        self.model.domain.forces(law, self.moment.old, Some(&mut new), x, |_: &[usize; QUAD], _| ())?;
        Some(new)
    }
}

impl Energy for Potential<'_> {
    fn slope(&self, x: &[f64], slope: &mut [f64]) -> Option<f64> {
        slope.fill(0.0);
        let matters = self.matters();
        let law = |e: usize| Some(&matters[self.model.of[e]]);
        let add = |dofs: &[usize; QUAD], force: &[f64; QUAD]| spread(dofs, force, slope);
        let energy = self.model.domain.forces(law, self.moment.old, None, x, add)?;
        Some(energy + self.contact(x, slope, None)?)
    }

    fn curvature(&self, x: &[f64], slope: &mut [f64], values: &mut [f64]) -> Option<f64> {
        slope.fill(0.0);
        values.fill(0.0);
        let matters = self.matters();
        let law = |e: usize| Some(&matters[self.model.of[e]]);
        let add = |e: usize, (dofs, force, k): Stiff<QUAD>| {
            spread(dofs, force, slope);
            add_lower(values, &self.matrix.elements[e], k);
        };
        let energy = self.model.domain.stiffness(law, self.moment.old, x, true, add)?;
        Some(energy + self.contact(x, slope, Some(values))?)
    }
}
