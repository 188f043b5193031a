//! A design at one current after the other, on two meshes.

use super::design::{Design, DesignError};
use super::field::{Field, FieldError, Geometry, Matter, Solution};
use crate::fem::mesh::MeshError;
use crate::fem::triangle::Order;

/// How much longer the sides of the second mesh are. What both differ by is more than the finer one errs.
pub const COARSER: f64 = 1.6;

/// A study that cannot be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StudyError {
    /// The design.
    #[error(transparent)]
    Design(#[from] DesignError),
    /// Its mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
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
        let mut coarse = self.prepared(wanted.order, COARSER * coarser)?;
        let mut solutions: Vec<Solution> = Vec::new();
        let mut before: Option<Solution> = None;
        let mut states = Vec::new();
        for (i, ampere) in currents.iter().enumerate() {
            let rough = self.solve(&mut coarse, *ampere, before.as_ref())?;
            let exact = self.solve(&mut fine, *ampere, solutions.last())?;
            let [from_fine, from_coarse] =
                [(&fine, &exact), (&coarse, &rough)].map(|(p, s)| self.raw(p, s, *ampere, wanted));
            states.push(merged(*ampere, &from_fine?, &from_coarse?, exact.steps));
            solutions.push(exact);
            before = Some(rough);
            told(i + 1);
        }
        Ok(Study { field: fine.field, solutions, areas: fine.areas, states })
    }

    fn prepared(&self, order: Order, coarser: f64) -> Result<Prepared, StudyError> {
        let mesh = self.mesh(order, coarser)?;
        let field = Field::new(mesh, self.geometry, |p| self.is_held(p))
            .map_err(|source| StudyError::Field { ampere: 0.0, source })?;
        let areas: Vec<f64> = (0..=self.regions.len()).map(|region| field.area(region)).collect();
        for (region, area) in self.regions.iter().zip(&areas[1..]) {
            if *area <= 0.0 {
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

    fn solve(&self, on: &mut Prepared, ampere: f64, start: Option<&Solution>) -> Result<Solution, StudyError> {
        let matter = self.matter(&self.currents(ampere), &on.areas);
        let start = start.map(|s| s.potential.as_slice());
        on.field.solve(&matter, start).map_err(|source| StudyError::Field { ampere, source })
    }

    fn raw(&self, on: &Prepared, solution: &Solution, ampere: f64, wanted: &Wanted) -> Result<Raw, StudyError> {
        let at = |p: &[f64; 2]| on.field.flux_density(solution, *p).ok_or(StudyError::Outside { at: *p });
        let mean = |region: &usize| {
            let none = || StudyError::NoProbe { region: self.name(*region).to_owned() };
            on.field.mean_flux(solution, *region).ok_or_else(none)
        };
        let matter: Vec<Matter> = self.matter(&self.currents(ampere), &on.areas);
        let energy = on.field.energy(solution, &matter);
        // T A mm^2 are 1e-6 J.
        let deep = 1e-6 * self.depth();
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

    /// Flux linkage of a coil, Wb: turns times the mean potential out of the plane less that into it, times the depth.
    fn linkage_wb(&self, on: &Prepared, solution: &Solution, coil: usize) -> f64 {
        let window = self.window_mm2(coil, &on.areas);
        let mut linked = 0.0;
        for (i, region) in self.regions.iter().enumerate() {
            if let Some((_, sense)) = region.coil.filter(|(own, _)| *own == coil) {
                let part = on.areas[i + 1] / window[usize::from(sense < 0.0)];
                linked += sense * part * on.field.mean(solution, i + 1);
            }
        }
        1e-6 * self.coils[coil].winding.turns * self.depth() * linked
    }
}

/// What one mesh says.
struct Raw {
    points: Vec<[f64; 2]>,
    probes: Vec<[f64; 2]>,
    linkage_wb: Vec<f64>,
    energy_j: f64,
    coenergy_j: f64,
}

fn merged(ampere: f64, fine: &Raw, coarse: &Raw, steps: usize) -> State {
    let flux = |(a, b): (&[f64; 2], &[f64; 2])| Flux { b_t: *a, error_t: (a[0] - b[0]).hypot(a[1] - b[1]) };
    let reading = |a: f64, b: f64| Reading { value: a, error: (a - b).abs() };
    State {
        ampere,
        points: fine.points.iter().zip(&coarse.points).map(flux).collect(),
        probes: fine.probes.iter().zip(&coarse.probes).map(flux).collect(),
        linkage_wb: fine.linkage_wb.iter().zip(&coarse.linkage_wb).map(|(a, b)| reading(*a, *b)).collect(),
        energy_j: reading(fine.energy_j, coarse.energy_j),
        coenergy_j: reading(fine.coenergy_j, coarse.coenergy_j),
        steps,
    }
}
