//! Fields inside the block along the path of a simulation.

use super::{Indentation, Simulation, Watcher};
use crate::solid::field::{Field, FieldError, Step};
use crate::solid::mesh::BlockMesh;
use crate::solid::solve::{Accepted, HELD, Motion, Observer, SolveError, System};

/// Collects the fields of the equilibria it sees.
struct Collector {
    mesh: Option<BlockMesh>,
    fields: Vec<Field>,
    /// Segment of the motion each belongs to.
    segments: Vec<usize>,
    failure: Option<FieldError>,
}

impl Collector {
    fn look(&mut self, at: &Accepted, mesh: &BlockMesh) -> Result<Field, FieldError> {
        let equation = at.system.equation();
        let moved = |dof: usize| if equation[dof] == HELD { 0.0 } else { at.u[equation[dof]] };
        let displacement_mm = (0..mesh.nodes.len()).map(|n| [moved(2 * n), moved(2 * n + 1)]).collect();
        let material = at.step.material;
        let each = material.history();
        let old = &at.step.old.matter;
        let station = &at.station;
        Field::new(
            mesh,
            displacement_mm,
            |point, f| {
                let old = old.get(point * each..(point + 1) * each)?;
                material.stress(&at.step.relaxation, f, old, None).map(|(_, p)| p)
            },
            at.system.surface(),
            Step { time_s: station.time_s, depth_mm: station.depth_mm, force_n: station.force_n },
        )
    }
}

impl Observer for Collector {
    fn accepted(&mut self, at: &Accepted) -> Result<(), SolveError> {
        let Some(mesh) = self.mesh.take() else { return Ok(()) };
        match self.look(at, &mesh) {
            Ok(field) => {
                self.fields.push(field);
                self.segments.push(at.station.segment);
            }
            Err(cause) => self.failure = Some(cause),
        }
        self.mesh = Some(mesh);
        Ok(())
    }
}

impl Watcher for Collector {
    fn begins(&mut self, _: &Simulation, mesh: &BlockMesh, _: f64, _: &System) -> Result<(), SolveError> {
        self.mesh = Some(mesh.clone());
        Ok(())
    }

    fn restarted(&mut self) {
        self.fields.clear();
        self.segments.clear();
        self.failure = None;
    }
}

impl Simulation {
    /// Fields at every equilibrium of the path on the finest mesh, in order of time. The force is the
    /// integral of the pressure shown, that is with the penalty as it is.
    ///
    /// # Errors
    /// [`FieldError::Solve`] for parameters out of range and where no equilibrium is found.
    pub fn fields(&self) -> Result<Vec<Field>, FieldError> {
        Ok(self.collected()?.0)
    }

    fn collected(&self) -> Result<(Vec<Field>, Vec<usize>), FieldError> {
        let mut seen = Collector { mesh: None, fields: Vec::new(), segments: Vec::new(), failure: None };
        self.watch(&mut seen)?;
        match seen.failure {
            Some(cause) => Err(cause),
            None => Ok((seen.fields, seen.segments)),
        }
    }
}

impl Indentation {
    /// Fields at the given depths (mm), each at most the largest depth, in the order asked, on the
    /// finest mesh; one path leads through all of them.
    ///
    /// The force is with the penalty as it is; [`Indentation::solve`] frees it from the penalty (a
    /// difference below 1 %).
    ///
    /// # Errors
    /// [`FieldError::Solve`] for parameters out of range and where no equilibrium is found.
    pub fn fields_at(&self, depths: &[f64]) -> Result<Vec<Field>, FieldError> {
        let mut stops = depths.to_vec();
        for &d in depths {
            if d.is_nan() || d <= 0.0 {
                return Err(SolveError::parameter("depth_mm", d, "must be positive").into());
            }
            if d > self.depth_mm * (1.0 + 1e-9) {
                let expected = format!("must not exceed the largest depth, {} mm", self.depth_mm);
                return Err(SolveError::Parameter { parameter: "depth_mm", value: d, expected }.into());
            }
        }
        stops.sort_by(f64::total_cmp);
        stops.dedup();
        if stops.is_empty() {
            return Ok(Vec::new());
        }
        // the rate of an elastic material means nothing: a millimetre a second makes time read as depth
        let motion = stops.iter().fold(Motion::from_touch(), |motion, d| motion.to_depth(*d, 1.0));
        let (fields, segments) = Simulation { motion, ..self.simulation() }.collected()?;
        let last = |stop: usize| segments.iter().rposition(|s| *s == stop);
        let found = |d: &f64| fields.get(last(stops.iter().position(|s| s == d)?)?).cloned();
        Ok(depths.iter().filter_map(found).collect())
    }
}
