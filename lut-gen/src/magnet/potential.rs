//! The energy of a field over the potential of its free nodes: a square of the linear regions, and the rest.

use super::bh::Law;
use super::outside::Outside;
use super::point::{Isotropic, Parts, Turn};
use crate::fem::domain::{Domain, Stiff};
use crate::fem::equations::spread;
use crate::fem::krylov::dot;
use crate::fem::mesh::Mesh;
use crate::fem::newton::Energy;
use crate::fem::sparse::{HELD, Pattern, Scatter, add_lower};
use crate::fem::triangle::NODES;

/// Matrix of the regions of constant permeability, as it was last assembled.
#[derive(Debug, Default)]
pub(super) struct Square {
    /// The linear laws by region.
    laws: Vec<Option<Law>>,
    /// Values in the pattern.
    values: Vec<f64>,
}

impl Square {
    /// Assembles it anew where a linear law is another; the first region is the air, also that of the outside.
    pub fn renew<'a>(
        &mut self,
        parts: &Parts,
        mesh: &Mesh,
        laws: impl Iterator<Item = &'a Law>,
        pattern: &Pattern,
        scatter: &Scatter,
        outside: Option<&Outside>,
    ) {
        let linear = |law: &Law| matches!(law, Law::Linear(_)).then(|| law.clone());
        let laws: Vec<Option<Law>> = laws.map(linear).collect();
        if laws == self.laws {
            return;
        }
        self.laws = laws;
        self.values = vec![0.0; pattern.entries()];
        let by_region: Vec<Option<Isotropic>> = self.laws.iter().map(|law| law.as_ref().map(Isotropic::of)).collect();
        match parts {
            Parts::First(domain) => square(domain, &mesh.regions, &by_region, scatter, &mut self.values),
            Parts::Second(domain) => square(domain, &mesh.regions, &by_region, scatter, &mut self.values),
            Parts::Third(domain) => square(domain, &mesh.regions, &by_region, scatter, &mut self.values),
        }
        // the circle's group is the last
        if let (Some(outside), Some(Some(air)), Some(places)) = (outside, self.laws.first(), scatter.last()) {
            outside.add(air.at(0.0).slope, places, &mut self.values);
        }
    }

    /// Its values.
    pub fn values(&self) -> &[f64] {
        &self.values
    }
}

fn square<const COUNT: usize>(
    domain: &Domain<f64, Turn, COUNT, 1>,
    regions: &[usize],
    laws: &[Option<Isotropic>],
    scatter: &Scatter,
    values: &mut [f64],
) {
    let none = vec![0.0; domain.equations.unknowns()];
    let law = |t: usize| laws[regions[t]].as_ref();
    // a linear law has an answer to every strain
    let _ = domain.stiffness(law, &[], &none, true, |t, (_, _, k): Stiff<COUNT>| {
        add_lower(values, &scatter[t], k);
    });
}

/// The energy of one state of currents.
pub(super) struct Potential<'a, const COUNT: usize> {
    pub domain: &'a Domain<f64, Turn, COUNT, 1>,
    pub regions: &'a [usize],
    /// Laws by region; `None` for those in the square.
    pub laws: Vec<Option<Isotropic<'a>>>,
    pub pattern: &'a Pattern,
    pub scatter: &'a Scatter,
    pub square: &'a [f64],
    /// What currents and magnets push with, A.
    pub load: &'a [f64],
}

impl<'a, const COUNT: usize> Potential<'a, COUNT> {
    fn law(&self, t: usize) -> Option<&Isotropic<'a>> {
        self.laws[self.regions[t]].as_ref()
    }

    /// Energy and slope of all that is a square.
    fn linear(&self, x: &[f64], slope: &mut [f64]) -> f64 {
        self.pattern.multiply_symmetric(self.square, x, slope);
        let energy = 0.5 * dot(x, slope) - dot(x, self.load);
        slope.iter_mut().zip(self.load).for_each(|(slope, load)| *slope -= load);
        energy
    }
}

impl<const COUNT: usize> Energy for Potential<'_, COUNT> {
    fn slope(&self, x: &[f64], slope: &mut [f64]) -> Option<f64> {
        let energy = self.linear(x, slope);
        let add = |dofs: &[usize; COUNT], force: &[f64; COUNT]| spread(dofs, force, slope);
        Some(energy + self.domain.forces(|t| self.law(t), &[], None, x, add)?)
    }

    fn curvature(&self, x: &[f64], slope: &mut [f64], values: &mut [f64]) -> Option<f64> {
        let energy = self.linear(x, slope);
        values.copy_from_slice(self.square);
        let add = |t: usize, (dofs, force, k): Stiff<COUNT>| {
            spread(dofs, force, slope);
            add_lower(values, &self.scatter[t], k);
        };
        Some(energy + self.domain.stiffness(|t| self.law(t), &[], x, true, add)?)
    }
}

/// Adds what the currents and magnets of a triangle push its nodes with: `volume (push . slope + current shape)`.
pub(super) fn add_load(
    points: &[(f64, [[f64; 2]; NODES])],
    shapes: &[[f64; NODES]],
    push: [f64; 2],
    current: f64,
    equations: &[usize],
    load: &mut [f64],
) {
    for ((volume, slope), shape) in points.iter().zip(shapes) {
        for (n, equation) in equations.iter().enumerate().filter(|(_, equation)| **equation != HELD) {
            load[*equation] += volume * (push[0] * slope[n][0] + push[1] * slope[n][1] + current * shape[n]);
        }
    }
}
