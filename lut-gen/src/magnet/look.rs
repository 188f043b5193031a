//! What a field is at a point and over a region.

use crate::fem::triangle::{NODES, Order};

use super::field::{Field, Solution};
use super::point::{gradient, point};

impl Field {
    /// Flux density at a point, (x, y) or (r, z), T; `None` where there is no field. Recovered from the triangles around it.
    #[must_use]
    pub fn flux_density(&self, solution: &Solution, at: [f64; 2]) -> Option<[f64; 2]> {
        let Some((t, coordinates)) = self.locator.find(&self.mesh, at) else {
            return self.outside.as_ref()?.flux_density(&solution.potential, at);
        };
        let g = match self.mesh.order {
            // A cubic's slope is as good as a fit through its neighbours'.
            Order::Third => {
                Some(gradient(&point(&self.mesh, self.geometry, t, coordinates, 1.0)?, &self.own(solution, t)))
            }
            _ => self.fitted(solution, t, at).or_else(|| self.averaged(solution, t, coordinates)),
        }?;
        Some(self.geometry.flux(g))
    }

    /// g at a point of triangle `t`: at each of its nodes the mean of its region's triangles there.
    fn averaged(&self, solution: &Solution, t: usize, coordinates: [f64; 3]) -> Option<[f64; 2]> {
        let count = self.mesh.order.nodes();
        let shape = self.mesh.order.shapes(coordinates);
        let mut g = [0.0; 2];
        for (n, node) in self.mesh.triangles[t].iter().enumerate().take(count) {
            let (mut sum, mut area) = ([0.0; 2], 0.0);
            for other in self.around[*node].iter().filter(|other| self.mesh.regions[**other] == self.mesh.regions[t]) {
                let place = self.mesh.triangles[*other][..count].iter().position(|own| own == node)?;
                let point = point(&self.mesh, self.geometry, *other, self.mesh.order.coordinates(place), 1.0)?;
                let there = gradient(&point, &self.own(solution, *other));
                sum = [sum[0] + point.area * there[0], sum[1] + point.area * there[1]];
                area += point.area;
            }
            g = [g[0] + shape[n] * sum[0] / area, g[1] + shape[n] * sum[1] / area];
        }
        Some(g)
    }

    /// Potential at the nodes of a triangle.
    pub(super) fn own(&self, solution: &Solution, t: usize) -> [f64; NODES] {
        let count = self.mesh.order.nodes();
        std::array::from_fn(|n| if n < count { solution.potential[self.mesh.triangles[t][n]] } else { 0.0 })
    }

    /// Mean over a region of the potential, T mm, or about an axis of radius times potential, T mm^2: what a turn there
    /// links, per mm of depth or per radian.
    #[must_use]
    pub fn mean(&self, solution: &Solution, region: usize) -> f64 {
        let count = self.mesh.order.nodes();
        let (mut sum, mut area) = (0.0, 0.0);
        for (t, triangle) in self.mesh.triangles.iter().enumerate().filter(|(t, _)| self.mesh.regions[*t] == region) {
            for point in self.points(t) {
                let here: f64 = (0..count).map(|n| point.shape[n] * solution.potential[triangle[n]]).sum();
                sum += point.area * point.width * here;
                area += point.area;
            }
        }
        sum / area
    }

    /// Area of a region, mm^2.
    #[must_use]
    pub fn area(&self, region: usize) -> f64 {
        let own = (0..self.mesh.triangles.len()).filter(|t| self.mesh.regions[*t] == region);
        own.flat_map(|t| self.points(t)).map(|point| point.area).sum()
    }
}
