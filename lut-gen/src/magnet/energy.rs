//! What a field holds: energy, co-energy, and the mean flux of a region.

use super::field::{Field, Geometry, Matter, Solution};
use super::point::gradient;
use crate::fem::triangle::NODES;

/// Energies of a field, T A mm per mm of depth (1e-6 J per mm), or T A mm^2 per radian.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Energy {
    /// The integral of H over B from no field (of a magnet: from its coercive field strength) up to here.
    pub stored: f64,
    /// The integral of H B less that: what a coil's linkage is the slope of over its current.
    pub co: f64,
}

impl Field {
    /// Its energies.
    #[must_use]
    pub fn energy(&self, solution: &Solution, matter: &[Matter]) -> Energy {
        let count = self.mesh.order.nodes();
        let mut energy = Energy::default();
        for (t, triangle) in self.mesh.triangles.iter().enumerate() {
            let matter = &matter[self.mesh.regions[t]];
            let own: [f64; NODES] =
                std::array::from_fn(|n| if n < count { solution.potential[triangle[n]] } else { 0.0 });
            for point in self.points(t) {
                let g = gradient(&point, &own);
                let b = g[0].hypot(g[1]);
                let law = matter.law.at(b);
                let volume = point.area * point.width;
                energy.stored += volume * law.energy;
                energy.co += volume * (law.h * b - law.energy);
            }
        }
        energy
    }

    /// Mean flux density over a region, T, as a sensor of its size reads it; `None` for a region without area.
    #[must_use]
    pub fn mean_flux(&self, solution: &Solution, region: usize) -> Option<[f64; 2]> {
        let count = self.mesh.order.nodes();
        let (mut sum, mut volume) = ([0.0; 2], 0.0);
        for (t, triangle) in self.mesh.triangles.iter().enumerate().filter(|(t, _)| self.mesh.regions[*t] == region) {
            let own: [f64; NODES] =
                std::array::from_fn(|n| if n < count { solution.potential[triangle[n]] } else { 0.0 });
            for point in self.points(t) {
                let g = gradient(&point, &own);
                let own = point.area * point.width;
                sum = [sum[0] + own * g[0], sum[1] + own * g[1]];
                volume += own;
            }
        }
        let [x, y] = sum.map(|s| s / volume);
        (volume > 0.0).then_some(match self.geometry {
            Geometry::Plane => [y, -x],
            Geometry::Axisymmetric => [-y, x],
        })
    }
}
