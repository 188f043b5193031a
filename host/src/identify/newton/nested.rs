//! Simpler laws inside a law. A fit begins from the best of the simpler one, so that it never ends higher.

use lut_gen::solid::solve::SolveError;

use crate::infer::descent::Region;

use super::coordinate::Kind;
use super::problem::Problem;
use super::search::{Budget, Effort, Found, Told};

/// Share that a second term begins with, and the factors between its exponent and the first one's.
const SHARE: f64 = 0.3;
const EXPONENTS: [f64; 2] = [1.0 / 3.0, 3.0];
/// Factor between the time of one relaxation and those of the two that it becomes.
const TIMES: f64 = 3.0;

/// What a simpler law lacks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Lacks {
    /// The second term.
    Term,
    /// The second relaxation.
    Relaxation,
    /// A Poisson's ratio of its own.
    Ratio,
}

impl Lacks {
    /// Where a coordinate is held for want of it.
    fn held(self, problem: &Problem<'_>, axis: usize) -> Option<f64> {
        let unknown = &problem.unknowns[axis];
        let value = match (self, unknown.kind) {
            (Lacks::Term, Kind::Share) => unknown.low,
            (Lacks::Relaxation, Kind::G(1) | Kind::K(1)) => 0.0,
            (Lacks::Ratio, Kind::Nu) => problem.base.nu,
            (Lacks::Term, Kind::Alpha(1)) | (Lacks::Relaxation, Kind::Tau(1)) => unknown.start,
            _ => return None,
        };
        Some(unknown.coordinate(value.clamp(unknown.low, unknown.high)))
    }

    /// Points at which the law that has it begins, from the best of the one that lacks it.
    fn gained(self, problem: &Problem<'_>, best: &[f64]) -> Vec<Vec<f64>> {
        let place = |kind: Kind| problem.unknowns.iter().position(|u| u.kind == kind);
        let region = problem.region();
        match self {
            Lacks::Ratio => Vec::new(),
            Lacks::Term => EXPONENTS
                .iter()
                .map(|factor| {
                    let mut point = best.to_vec();
                    for (axis, unknown) in problem.unknowns.iter().enumerate() {
                        let first =
                            problem.unknowns.iter().position(|u| u.kind == Kind::Alpha(0) && u.scope == unknown.scope);
                        match (unknown.kind, first) {
                            (Kind::Share, _) => point[axis] = SHARE,
                            (Kind::Alpha(1), Some(first)) => point[axis] = best[first] + factor.ln(),
                            _ => {}
                        }
                    }
                    region.inside(&point)
                })
                .collect(),
            Lacks::Relaxation => {
                let mut point = best.to_vec();
                for (one, other) in [(Kind::G(0), Kind::G(1)), (Kind::K(0), Kind::K(1))] {
                    if let (Some(one), Some(other)) = (place(one), place(other)) {
                        (point[one], point[other]) = (0.5 * best[one], 0.5 * best[one]);
                    }
                }
                if let (Some(one), Some(other)) = (place(Kind::Tau(0)), place(Kind::Tau(1))) {
                    (point[one], point[other]) = (best[one] - TIMES.ln(), best[one] + TIMES.ln());
                }
                vec![region.inside(&point)]
            }
        }
    }
}

impl Problem<'_> {
    /// What may be left out of the law, in the order in which it is gained.
    fn lacks(&self) -> Vec<Lacks> {
        let has = |kind: Kind| self.unknowns.iter().any(|u| u.kind == kind);
        let all = [(Lacks::Ratio, Kind::Nu), (Lacks::Relaxation, Kind::G(1)), (Lacks::Term, Kind::Share)];
        all.into_iter().filter(|(_, kind)| has(*kind)).map(|(lacks, _)| lacks).collect()
    }

    fn without(&self, lacking: &[Lacks]) -> Region {
        let mut region = self.region();
        for axis in 0..self.unknowns.len() {
            if let Some(at) = lacking.iter().find_map(|lacks| lacks.held(self, axis)) {
                (region.low[axis], region.high[axis]) = (at, at);
            }
        }
        region
    }

    /// Searches the simplest law first, and each richer one from its best.
    ///
    /// # Errors
    /// When no start can be solved.
    pub fn search_from_simpler(
        &mut self,
        starts: &[Vec<f64>],
        budget: &Budget,
        told: &Told<'_>,
    ) -> Result<Found, SolveError> {
        let lacks = self.lacks();
        let mut starts = starts.to_vec();
        let mut path = Vec::new();
        let mut failures = Vec::new();
        for (gained, lacking) in (0..lacks.len()).map(|at| (lacks[at], lacks[at..].to_vec())) {
            let region = self.without(&lacking);
            let inside: Vec<Vec<f64>> = starts.iter().map(|start| region.inside(start)).collect();
            // Where the simpler law cannot be solved the richer one begins where it would without it.
            let Ok(found) = self.search_in(&region, Effort::Start, &inside, budget, told) else { continue };
            starts = vec![found.minimum.x.clone()];
            starts.extend(gained.gained(self, &found.minimum.x));
            path.extend(found.path);
            failures.extend(found.failures);
        }
        let mut found = self.search(&starts, budget, told)?;
        path.append(&mut found.path);
        failures.append(&mut found.failures);
        Ok(Found { path, failures, ..found })
    }
}
