//! A field over its whole mesh: for pictures and for ParaView.

use std::collections::HashMap;

use super::field::{Field, Geometry, Solution};
use super::point::{gradient, point};
use crate::fem::triangle::{NODES, Order};
use crate::vtk;

/// Flux density and potential at the nodes of every region; where two regions meet, a node is there twice, for the flux
/// density jumps.
#[derive(Debug, Clone, PartialEq)]
pub struct Map {
    /// Positions, mm.
    pub points: Vec<[f64; 2]>,
    /// Flux density, T.
    pub flux_t: Vec<[f64; 2]>,
    /// What is constant along a line of flux: the potential, T mm, or about an axis radius times potential, T mm^2.
    pub stream: Vec<f64>,
    /// Points of every triangle, in the order of its nodes ([`NODES`]).
    pub triangles: Vec<[usize; NODES]>,
    /// Region of every triangle.
    pub regions: Vec<usize>,
    /// Order of the triangles.
    pub order: Order,
}

impl Field {
    /// Flux density and potential everywhere.
    #[must_use]
    pub fn map(&self, solution: &Solution) -> Map {
        let count = self.mesh.order.nodes();
        let mut map = Map {
            points: Vec::new(),
            flux_t: Vec::new(),
            stream: Vec::new(),
            triangles: Vec::new(),
            regions: self.mesh.regions.clone(),
            order: self.mesh.order,
        };
        let mut known: HashMap<(usize, usize), usize> = HashMap::new();
        let mut areas: Vec<f64> = Vec::new();
        for (t, triangle) in self.mesh.triangles.iter().enumerate() {
            let own = self.own(solution, t);
            let mut nodes = [0; NODES];
            for n in 0..count {
                let node = triangle[n];
                let at = *known.entry((node, self.mesh.regions[t])).or_insert_with(|| {
                    let p = self.mesh.nodes[node];
                    let width = if self.geometry == Geometry::Axisymmetric { p[0] } else { 1.0 };
                    map.points.push(p);
                    map.stream.push(width * solution.potential[node]);
                    map.flux_t.push([0.0; 2]);
                    areas.push(0.0);
                    areas.len() - 1
                });
                nodes[n] = at;
                let Some(point) = point(&self.mesh, self.geometry, t, self.mesh.order.coordinates(n), 1.0) else {
                    continue;
                };
                let b = self.geometry.flux(gradient(&point, &own));
                map.flux_t[at] = [map.flux_t[at][0] + point.area * b[0], map.flux_t[at][1] + point.area * b[1]];
                areas[at] += point.area;
            }
            map.triangles.push(nodes);
        }
        for (b, area) in map.flux_t.iter_mut().zip(areas) {
            *b = b.map(|own| own / area);
        }
        map
    }
}

impl Map {
    /// |B| at every point, T.
    #[must_use]
    pub fn sizes_t(&self) -> Vec<f64> {
        self.flux_t.iter().map(|b| b[0].hypot(b[1])).collect()
    }

    /// Triangles of three corners: those of second order in four, those of third in nine.
    pub fn corners(&self) -> impl Iterator<Item = (usize, [usize; 3])> + '_ {
        let parts: &[[usize; 3]] = match self.order {
            Order::First => &[[0, 1, 2]],
            Order::Second => &[[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]],
            Order::Third => {
                &[[0, 3, 8], [3, 9, 8], [3, 4, 9], [4, 5, 9], [4, 1, 5], [8, 9, 7], [9, 6, 7], [9, 5, 6], [7, 6, 2]]
            }
        };
        let all = self.triangles.iter().zip(&self.regions);
        all.flat_map(move |(nodes, region)| parts.iter().map(move |part| (*region, part.map(|n| nodes[n]))))
    }

    /// As a `.vtu` document for ParaView: `flux_T`, `flux_size_T`, `stream_T_mm`, and of every cell its `region`.
    #[must_use]
    pub fn vtu(&self, ampere: f64) -> String {
        let mut body = String::new();
        vtk::points(&mut body, self.points.iter().copied());
        let count = self.order.nodes();
        let cells: Vec<&[usize]> = self.triangles.iter().map(|t| &t[..count]).collect();
        let kind = match self.order {
            Order::First => vtk::TRIANGLE,
            Order::Second => vtk::QUADRATIC_TRIANGLE,
            Order::Third => vtk::LAGRANGE_TRIANGLE,
        };
        vtk::cells(&mut body, &cells, kind);
        body.push_str("<PointData Scalars=\"flux_size_T\" Vectors=\"flux_T\">\n");
        vtk::array(&mut body, "flux_T", 3, self.flux_t.iter().flat_map(|b| [b[0], b[1], 0.0]));
        vtk::array(&mut body, "flux_size_T", 1, self.sizes_t().iter());
        vtk::array(&mut body, "stream_T_mm", 1, self.stream.iter());
        body.push_str("</PointData>\n<CellData Scalars=\"region\">\n");
        vtk::array(&mut body, "region", 1, self.regions.iter());
        body.push_str("</CellData>\n");
        vtk::document(&[("current_A", ampere)], self.points.len(), cells.len(), &body)
    }
}
