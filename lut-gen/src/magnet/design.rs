//! A magnet as a drawing: regions with their materials, coils, and where the field ends.

use super::bh::Law;
pub use super::edge::{Edge, Mirror};
use super::field::{Geometry, Matter};
use super::shape::{Shape, ShapeError};
use super::winding::Winding;

/// A part of a magnet.
#[derive(Debug, Clone, PartialEq)]
pub struct Region {
    /// Its name.
    pub name: String,
    /// What it is drawn with: all that lies in one of these ...
    pub shapes: Vec<Shape>,
    /// ... and in none of those.
    pub without: Vec<Shape>,
    /// Its law.
    pub law: Law,
    /// Coercive field strength of a magnet along its magnetisation, A/mm; zero for all else.
    pub coercive: [f64; 2],
    /// The coil that it belongs to, and its sense: 1 out of the plane, -1 into it.
    pub coil: Option<(usize, f64)>,
    /// Wanted length of a triangle's side, mm; without, a sixth of its smallest extent.
    pub size_mm: Option<f64>,
}

/// A coil: the regions that belong to it share its turns by their areas.
#[derive(Debug, Clone, PartialEq)]
pub struct Coil {
    /// Its name.
    pub name: String,
    /// Its wire.
    pub winding: Winding,
    /// Its current over the one that is asked for.
    pub share: f64,
}

/// What a plane drawing of a ring with a gap lacks: flux that leaves the plane before and behind the core.
///
/// Fitted to magnetostatics in three dimensions (`bench/versus-ngsolve/depth.csv`: depths of 3 to 48 mm, gaps of 2 to 10 mm,
/// steel and linear, up to 4 A): flux density in the gap within 3.5 %, linkage within 3 %. The thinnest core
/// (3 mm) with the widest gap is missed by 5.4 %; a magnet that the fit had not seen (radii 20 and 28, gap 4, 10 mm deep) by 2.2 %.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutOfPlane {
    /// Mean radius of the core, mm.
    pub mean_radius_mm: f64,
    /// Width of the core in the plane, mm.
    pub width_mm: f64,
    /// Gap between the poles, mm.
    pub gap_mm: f64,
}

impl OutOfPlane {
    /// Relative permeability of the plane's air and coils that carries as much flux beside a core of this depth (mm) as air
    /// before, behind and beside it does.
    #[must_use]
    pub fn air(&self, depth_mm: f64) -> f64 {
        1.0 + (0.75 * self.mean_radius_mm + 2.0 * self.width_mm) / depth_mm
    }

    /// Flux density in the middle of the gap, half way of the depth, over that of the plane: the field bulges out.
    #[must_use]
    pub fn bulge(&self, depth_mm: f64) -> f64 {
        1.0 - 0.45 * (-1.5 * std::f64::consts::PI * depth_mm / self.gap_mm).exp()
    }
}

/// A magnet. Where regions overlap the later one counts; what no region covers is air.
#[derive(Debug, Clone, PartialEq)]
pub struct Design {
    /// Plane, or about an axis.
    pub geometry: Geometry,
    /// Depth of a plane magnet out of the plane, mm; not used about an axis.
    pub depth_mm: f64,
    /// What leaves the plane; without, the plane is infinitely deep.
    pub out_of_plane: Option<OutOfPlane>,
    /// A mirror at x = 0, beside which only x of 0 and more counts; without, and about an axis, none.
    pub mirror: Option<Mirror>,
    /// Where it ends.
    pub edge: Edge,
    /// Its parts.
    pub regions: Vec<Region>,
    /// Its coils.
    pub coils: Vec<Coil>,
}

/// A design that cannot be solved, with the region and the reason.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DesignError {
    /// A shape has no inside.
    #[error("region \"{region}\": {source}")]
    Shape {
        /// Name of the region.
        region: String,
        /// Why.
        source: ShapeError,
    },
    /// A region has no shape, or later ones cover it.
    #[error("region \"{region}\" has no area: {reason}")]
    Empty {
        /// Name of the region.
        region: String,
        /// Why.
        reason: &'static str,
    },
    /// A region reaches out of the drawing.
    #[error(
        "region \"{region}\" reaches {reach_mm:.3} mm from the origin: the boundary must be at least {least_mm:.3} mm away"
    )]
    Outside {
        /// Name of the region.
        region: String,
        /// How far it reaches, mm.
        reach_mm: f64,
        /// What the boundary must be at least, mm.
        least_mm: f64,
    },
    /// A region is on the other side of the axis.
    #[error("region \"{region}\" begins at a radius of {radius_mm} mm: about an axis radii are 0 or more")]
    LeftOfAxis {
        /// Name of the region.
        region: String,
        /// Its smallest radius, mm.
        radius_mm: f64,
    },
    /// A region belongs to a coil that there is not.
    #[error("region \"{region}\" belongs to coil {coil}, and there are {coils}")]
    NoCoil {
        /// Name of the region.
        region: String,
        /// Number of the coil.
        coil: usize,
        /// How many there are.
        coils: usize,
    },
    /// A wanted size is not usable.
    #[error(
        "region \"{region}\" wants triangles of {size_mm} mm: expected more than 0, at most {most_mm:.3} mm, four times its extent"
    )]
    Size {
        /// Name of the region.
        region: String,
        /// The size, mm.
        size_mm: f64,
        /// The largest that is usable, mm.
        most_mm: f64,
    },
    /// A coil has no region.
    #[error("coil \"{coil}\" has no region that carries its current out of the plane")]
    Unwound {
        /// Name of the coil.
        coil: String,
    },
    /// The drawing cannot be meshed.
    #[error("region \"{region}\", with triangles of {size_mm:.2e} mm: {source}")]
    Mesh {
        /// Name of the region.
        region: String,
        /// Its wanted size, mm.
        size_mm: f64,
        /// Why.
        source: crate::fem::mesh::MeshError,
    },
    /// Currents whose field has no end.
    #[error(
        "the coils carry {ampere_turns} ampere turns more out of the plane than into it at 1 A: their field falls so \
         slowly that it has no open boundary; give boundary = {{ radius_mm = .. }}, or the coils' other sides"
    )]
    Net {
        /// Ampere turns that do not come back, at 1 A.
        ampere_turns: f64,
    },
    /// The boundary is no number.
    #[error("the boundary is at {value} mm: expected more than 0")]
    Edge {
        /// Its radius or half width.
        value: f64,
    },
}

/// Parts of a region's smallest extent that a side is long where no size is told.
const PARTS: f64 = 6.0;
/// Longest side of a triangle over the smallest extent of its region: a thin winding may have long triangles.
const SLENDER: f64 = 4.0;
/// How much farther away than any region the boundary must be at least.
const ROOM: f64 = 1.05;

impl Region {
    /// True when a point belongs to it, whatever lies above.
    #[must_use]
    pub fn covers(&self, p: [f64; 2]) -> bool {
        self.shapes.iter().any(|s| s.contains(p)) && !self.without.iter().any(|s| s.contains(p))
    }

    /// Wanted length of a triangle's side in it, mm.
    #[must_use]
    pub fn side_mm(&self) -> f64 {
        self.size_mm.unwrap_or(self.extent_mm() / PARTS)
    }

    /// Its smallest extent, mm.
    #[must_use]
    pub fn extent_mm(&self) -> f64 {
        self.shapes.iter().map(Shape::thickness).fold(f64::INFINITY, f64::min)
    }
}

impl Design {
    /// Number of the region at a point: 0 is air, 1 the first.
    #[must_use]
    pub fn region_at(&self, p: [f64; 2]) -> usize {
        self.regions.iter().rposition(|region| region.covers(p)).map_or(0, |i| i + 1)
    }

    /// Name of a region by its number.
    #[must_use]
    pub fn name(&self, number: usize) -> &str {
        if number == 0 { "air" } else { self.regions.get(number - 1).map_or("?", |region| &region.name) }
    }

    /// Law of a region by its number.
    #[must_use]
    pub fn law(&self, number: usize) -> &Law {
        if number == 0 { &Law::Linear(1.0) } else { &self.regions[number - 1].law }
    }

    /// Checks every region.
    ///
    /// # Errors
    /// [`DesignError`] of the first that cannot be solved.
    pub fn check(&self) -> Result<(), DesignError> {
        let far = self.edge.extent();
        if far.is_nan() || far <= 0.0 || self.regions.is_empty() {
            return Err(DesignError::Edge { value: far });
        }
        for region in &self.regions {
            self.check_region(region, far)?;
        }
        for (i, coil) in self.coils.iter().enumerate() {
            let is_mirrored = self.mirror == Some(Mirror::Along);
            let is_out = |(own, sense): (usize, f64)| own == i && (sense > 0.0 || is_mirrored);
            if !self.regions.iter().any(|region| region.coil.is_some_and(is_out)) {
                return Err(DesignError::Unwound { coil: coil.name.clone() });
            }
        }
        let ampere_turns = self.net();
        let comes_back = self.geometry == Geometry::Axisymmetric || self.mirror == Some(Mirror::Along);
        if self.edge == Edge::Open && !comes_back && ampere_turns != 0.0 {
            return Err(DesignError::Net { ampere_turns });
        }
        Ok(())
    }

    /// Ampere turns that do not come back into the plane, at 1 A.
    fn net(&self) -> f64 {
        let has = |coil: usize, positive: bool| {
            let own = |r: &Region| r.coil.is_some_and(|(own, sense)| own == coil && (sense > 0.0) == positive);
            f64::from(u8::from(self.regions.iter().any(own)))
        };
        let net = |(i, coil): (usize, &Coil)| coil.share * coil.winding.turns * (has(i, true) - has(i, false));
        self.coils.iter().enumerate().map(net).sum()
    }

    fn check_region(&self, region: &Region, far: f64) -> Result<(), DesignError> {
        let name = || region.name.clone();
        if region.shapes.is_empty() {
            return Err(DesignError::Empty { region: name(), reason: "it has no shape" });
        }
        for shape in region.shapes.iter().chain(&region.without) {
            shape.check().map_err(|source| DesignError::Shape { region: name(), source })?;
        }
        for shape in &region.shapes {
            let reach_mm = shape.reach();
            if reach_mm * ROOM > far {
                return Err(DesignError::Outside { region: name(), reach_mm, least_mm: reach_mm * ROOM });
            }
            if self.geometry == Geometry::Axisymmetric && shape.bounds()[0][0] < -1e-9 {
                return Err(DesignError::LeftOfAxis { region: name(), radius_mm: shape.bounds()[0][0] });
            }
        }
        if let Some((coil, _)) = region.coil.filter(|(coil, _)| *coil >= self.coils.len()) {
            return Err(DesignError::NoCoil { region: name(), coil, coils: self.coils.len() });
        }
        if let Some(size_mm) = region.size_mm {
            let extent_mm = region.extent_mm();
            if !(size_mm > 0.0 && size_mm <= SLENDER * extent_mm) {
                return Err(DesignError::Size { region: name(), size_mm, most_mm: SLENDER * extent_mm });
            }
        }
        Ok(())
    }

    /// Area of each sense of a coil, mm^2: out of the plane, into it, those beyond a mirror among them. `areas` are those of the
    /// mesh's regions.
    #[must_use]
    pub fn window_mm2(&self, coil: usize, areas: &[f64]) -> [f64; 2] {
        let mut window = [0.0; 2];
        for (region, area) in self.regions.iter().zip(&areas[1..]) {
            if let Some((_, sense)) = region.coil.filter(|(own, _)| *own == coil) {
                window[usize::from(sense < 0.0)] += area;
            }
        }
        match self.mirror {
            None => window,
            Some(Mirror::Across) => window.map(|area| 2.0 * area),
            Some(Mirror::Along) => [window[0] + window[1]; 2],
        }
    }

    /// The matter of the mesh's regions when these currents flow through the coils, A.
    #[must_use]
    pub fn matter(&self, currents: &[f64], areas: &[f64]) -> Vec<Matter> {
        let around = Law::Linear(self.out_of_plane.map_or(1.0, |out| out.air(self.depth_mm)));
        let air = Matter { law: around.clone(), current: 0.0, coercive: [0.0; 2] };
        let regions = self.regions.iter().map(|region| {
            let current = region.coil.map_or(0.0, |(coil, sense)| {
                let window = self.window_mm2(coil, areas)[usize::from(sense < 0.0)];
                sense * self.coils[coil].winding.turns * currents.get(coil).copied().unwrap_or(0.0) / window
            });
            let is_around = region.coil.is_some() && region.law == Law::Linear(1.0);
            let law = if is_around { around.clone() } else { region.law.clone() };
            Matter { law, current, coercive: region.coercive }
        });
        std::iter::once(air).chain(regions).collect()
    }

    /// What the flux density of a plane region is multiplied with half way of the depth: 1 in steel.
    #[must_use]
    pub fn bulge(&self, number: usize) -> f64 {
        let out = self.out_of_plane.filter(|_| !matches!(self.law(number), Law::Table(_)));
        out.map_or(1.0, |out| out.bulge(self.depth_mm))
    }
}
