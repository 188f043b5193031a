//! A design at one current after the other, on two meshes.

use super::design::{Design, DesignError, Mirror};
use super::field::{Field, FieldError, Geometry, Matter, Solution};
use crate::fem::triangle::Order;

/// How much longer the sides of the second mesh are. What both differ by is more than the finer one errs.
pub const COARSER: f64 = 1.6;

/// A study that cannot be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StudyError {
    /// The design.
    #[error(transparent)]
    Design(#[from] DesignError),
    /// Its field.
    #[error("at {ampere} A: {source}")]
    Field {
        /// The current, A.
        ampere: f64,
        /// Why.
        source: FieldError,
    },
    /// A point outside of the drawing.
    #[error("the point ({:.3}, {:.3}) mm lies outside of the boundary", at[0], at[1])]
    Outside {
        /// The point, mm.
        at: [f64; 2],
    },
    /// A probe without a region.
    #[error("the probe in region \"{region}\" has no area to average over")]
    NoProbe {
        /// Name of the region.
        region: String,
    },
}

/// What is wanted of every field.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Wanted {
    /// Order of the triangles.
    pub order: Order,
    /// Points, mm.
    pub points: Vec<[f64; 2]>,
    /// Numbers of regions to average over.
    pub probes: Vec<usize>,
    /// Multiplies the size of all triangles; 1 as the design says.
    pub coarser: f64,
    /// Only one mesh: errors are not known (NaN). For differences of two designs.
    pub is_single: bool,
}

/// A flux density with its discretisation error, T.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flux {
    /// Along x and y, or r and z.
    pub b_t: [f64; 2],
    /// What the two meshes differ by.
    pub error_t: f64,
}

/// A number with its discretisation error, in the same unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// On the finer mesh.
    pub value: f64,
    /// What the two meshes differ by.
    pub error: f64,
}

/// A field at one current.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Current that was asked for, A; a coil carries its share of it.
    pub ampere: f64,
    /// At the wanted points.
    pub points: Vec<Flux>,
    /// Over the wanted regions.
    pub probes: Vec<Flux>,
    /// Flux linkage of every coil, Wb.
    pub linkage_wb: Vec<Reading>,
    /// Energy of the field, J.
    pub energy_j: Reading,
    /// Its co-energy, J.
    pub coenergy_j: Reading,
    /// Newton steps on the finer mesh.
    pub steps: usize,
}

/// A design that was solved, kept for maps.
pub struct Study {
    /// The finer mesh's field.
    pub field: Field,
    /// Its potentials, one a current.
    pub solutions: Vec<Solution>,
    /// Area of every region of the mesh, mm^2; the first is air.
    pub areas: Vec<f64>,
    /// What was found.
    pub states: Vec<State>,
}

impl Flux {
    /// |B|, T.
    #[must_use]
    pub fn size_t(&self) -> f64 {
        self.b_t[0].hypot(self.b_t[1])
    }
}

/// A mesh of the design, ready to be solved.
struct Prepared {
    field: Field,
    areas: Vec<f64>,
}

impl Design {
    /// Solves it at these currents, A, each from the one before. `told` hears of every current that is done.
    ///
    /// # Errors
    /// [`StudyError`], which names region and reason.
    pub fn study(&self, wanted: &Wanted, currents: &[f64], told: &mut dyn FnMut(usize)) -> Result<Study, StudyError> {
        self.check()?;
        let coarser = if wanted.coarser > 0.0 { wanted.coarser } else { 1.0 };
        let mut fine = self.prepared(wanted.order, coarser)?;
        let mut coarse = match wanted.is_single {
            true => None,
            false => Some(self.prepared(wanted.order, COARSER * coarser)?),
        };
        let mut solutions: Vec<Solution> = Vec::new();
        let mut before: Option<Vec<f64>> = None;
        let mut states = Vec::new();
        for (i, ampere) in currents.iter().enumerate() {
            let start = ahead(&solutions, &currents[..=i]);
            let (exact, from_fine) = self.solve(&mut fine, *ampere, start.as_deref(), wanted)?;
            let mut from_coarse = None;
            if let Some(coarse) = &mut coarse {
                let (rough, read) = self.solve(coarse, *ampere, before.as_deref(), wanted)?;
                (from_coarse, before) = (Some(read), Some(rough.potential));
            }
            states.push(merged(*ampere, &from_fine, from_coarse.as_ref(), exact.steps));
            solutions.push(exact);
            told(i + 1);
        }
        Ok(Study { field: fine.field, solutions, areas: fine.areas, states })
    }

    fn prepared(&self, order: Order, coarser: f64) -> Result<Prepared, StudyError> {
        let mesh = self.mesh(order, coarser)?;
        let field = Field::new(mesh, self.geometry, self.around(), |p| self.is_held(p))
            .map_err(|source| StudyError::Field { ampere: 0.0, source })?;
        let areas: Vec<f64> = (0..=self.regions.len()).map(|region| field.area(region)).collect();
        for (region, area) in self.regions.iter().zip(&areas[1..]) {
            let is_beyond = self.mirror.is_some() && region.shapes.iter().all(|shape| shape.bounds()[1][0] <= 0.0);
            if *area <= 0.0 && !is_beyond {
                let reason = "its shapes are cut away, or later regions cover it";
                return Err(DesignError::Empty { region: region.name.clone(), reason }.into());
            }
        }
        Ok(Prepared { field, areas })
    }

    /// Currents of the coils when this one is asked for, A.
    fn currents(&self, ampere: f64) -> Vec<f64> {
        self.coils.iter().map(|coil| coil.share * ampere).collect()
    }

    /// The field at a current, and what is wanted of it.
    fn solve(
        &self,
        on: &mut Prepared,
        ampere: f64,
        start: Option<&[f64]>,
        wanted: &Wanted,
    ) -> Result<(Solution, Raw), StudyError> {
        let matter = self.matter(&self.currents(ampere), &on.areas);
        let solution = on.field.solve(&matter, start).map_err(|source| StudyError::Field { ampere, source })?;
        let raw = self.raw(on, &solution, &matter, wanted)?;
        Ok((solution, raw))
    }

    fn raw(&self, on: &Prepared, solution: &Solution, matter: &[Matter], wanted: &Wanted) -> Result<Raw, StudyError> {
        let at = |p: &[f64; 2]| {
            // beyond a mirror: the field of the point's image
            let (there, signs) = match self.mirror.filter(|_| p[0] < 0.0) {
                None => (*p, [1.0, 1.0]),
                Some(Mirror::Across) => ([-p[0], p[1]], [1.0, -1.0]),
                Some(Mirror::Along) => ([-p[0], p[1]], [-1.0, 1.0]),
            };
            let bulge = self.bulge(self.region_at(there));
            let flux = on.field.flux_density(solution, there).ok_or(StudyError::Outside { at: *p })?;
            let mut flux = [bulge * signs[0] * flux[0], bulge * signs[1] * flux[1]];
            if let Some(mirror) = self.mirror.filter(|_| p[0] == 0.0) {
                flux[usize::from(mirror == Mirror::Across)] = 0.0;
            }
            Ok::<_, StudyError>(flux)
        };
        let mean = |region: &usize| {
            let none = || StudyError::NoProbe { region: self.name(*region).to_owned() };
            let mut flux = on.field.mean_flux(solution, *region).ok_or_else(none)?;
            // of a region on both sides of a mirror the images' parts along one direction cancel
            let shapes = region.checked_sub(1).map_or(&[][..], |i| &self.regions[i].shapes);
            if let Some(mirror) = self.mirror.filter(|_| shapes.iter().any(|shape| shape.bounds()[0][0] <= 0.0)) {
                flux[usize::from(mirror == Mirror::Across)] = 0.0;
            }
            Ok::<_, StudyError>(flux.map(|b| self.bulge(*region) * b))
        };
        let energy = on.field.energy(solution, matter);
        // T A mm^2 are 1e-6 J.
        let deep = 1e-6 * self.depth() * self.sides();
        Ok(Raw {
            points: wanted.points.iter().map(at).collect::<Result<_, _>>()?,
            probes: wanted.probes.iter().map(mean).collect::<Result<_, _>>()?,
            linkage_wb: (0..self.coils.len()).map(|coil| self.linkage_wb(on, solution, coil)).collect(),
            energy_j: deep * energy.stored,
            coenergy_j: deep * energy.co,
        })
    }

    /// What a plane answer is multiplied with: mm; about an axis a whole turn, rad.
    fn depth(&self) -> f64 {
        match self.geometry {
            Geometry::Plane => self.depth_mm,
            Geometry::Axisymmetric => std::f64::consts::TAU,
        }
    }

    /// How many halves there are of what is meshed.
    fn sides(&self) -> f64 {
        if self.mirror.is_some() { 2.0 } else { 1.0 }
    }

    /// Flux linkage of a coil, Wb: turns times the mean potential out of the plane less that into it, times the depth.
    fn linkage_wb(&self, on: &Prepared, solution: &Solution, coil: usize) -> f64 {
        let window = self.window_mm2(coil, &on.areas);
        let mut linked = 0.0;
        for (i, region) in self.regions.iter().enumerate() {
            // one beyond a mirror has no area of its own
            if let Some((_, sense)) = region.coil.filter(|(own, _)| *own == coil && on.areas[i + 1] > 0.0) {
                let part = on.areas[i + 1] / window[usize::from(sense < 0.0)];
                linked += sense * part * on.field.mean(solution, i + 1);
            }
        }
        1e-6 * self.coils[coil].winding.turns * self.depth() * self.sides() * linked
    }
}

/// Where to start for the last of these currents: as far beyond the last potential as the current goes on.
fn ahead(solutions: &[Solution], currents: &[f64]) -> Option<Vec<f64>> {
    let [.., first, last] = solutions else { return solutions.last().map(|s| s.potential.clone()) };
    let [.., a, b, c] = currents else { return None };
    let part = (c - b) / (b - a);
    // Far beyond, a straight line says less than the last potential does.
    if part.abs() <= 2.0 { last.beyond(first, part) } else { Some(last.potential.clone()) }
}

/// What one mesh says.
struct Raw {
    points: Vec<[f64; 2]>,
    probes: Vec<[f64; 2]>,
    linkage_wb: Vec<f64>,
    energy_j: f64,
    coenergy_j: f64,
}

fn merged(ampere: f64, fine: &Raw, coarse: Option<&Raw>, steps: usize) -> State {
    let fluxes = |of: fn(&Raw) -> &[[f64; 2]]| -> Vec<Flux> {
        let off = |(i, a): (usize, &[f64; 2])| {
            let other = coarse.and_then(|coarse| of(coarse).get(i));
            Flux { b_t: *a, error_t: other.map_or(f64::NAN, |b| (a[0] - b[0]).hypot(a[1] - b[1])) }
        };
        of(fine).iter().enumerate().map(off).collect()
    };
    let reading = |of: &dyn Fn(&Raw) -> f64| Reading {
        value: of(fine),
        error: coarse.map_or(f64::NAN, |coarse| (of(fine) - of(coarse)).abs()),
    };
    State {
        ampere,
        points: fluxes(|raw| &raw.points),
        probes: fluxes(|raw| &raw.probes),
        linkage_wb: (0..fine.linkage_wb.len()).map(|i| reading(&|raw| raw.linkage_wb[i])).collect(),
        energy_j: reading(&|raw| raw.energy_j),
        coenergy_j: reading(&|raw| raw.coenergy_j),
        steps,
    }
}
