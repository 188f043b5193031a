//! What a field holds: energy, co-energy, and the mean flux of a region.

use super::field::{Field, Matter, Solution};
use super::point::gradient;

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
        let mut energy = Energy::default();
        for (t, region) in self.mesh.regions.iter().enumerate() {
            let matter = &matter[*region];
            let own = self.own(solution, t);
            for point in self.points(t) {
                let g = gradient(&point, &own);
                let b = g[0].hypot(g[1]);
                let law = matter.law.at(b);
                let volume = point.area * point.width;
                energy.stored += volume * law.energy;
                energy.co += volume * (law.h * b - law.energy);
            }
        }
        if let (Some(outside), Some(air)) = (&self.outside, matter.first()) {
            let beyond = outside.energy(air.law.at(0.0).slope, &solution.potential);
            energy.stored += beyond;
            energy.co += beyond;
        }
        energy
    }

    /// Mean flux density over a region, T, as a sensor of its size reads it; `None` for a region without area.
    #[must_use]
    pub fn mean_flux(&self, solution: &Solution, region: usize) -> Option<[f64; 2]> {
        let (mut sum, mut volume) = ([0.0; 2], 0.0);
        for (t, _) in self.mesh.regions.iter().enumerate().filter(|(_, own)| **own == region) {
            let own = self.own(solution, t);
            for point in self.points(t) {
                let g = gradient(&point, &own);
                let own = point.area * point.width;
                sum = [sum[0] + own * g[0], sum[1] + own * g[1]];
                volume += own;
            }
        }
        (volume > 0.0).then(|| self.geometry.flux(sum.map(|s| s / volume)))
    }
}
