//! What the identified material looks like inside, at the deepest point of its runs.

use lut_gen::contact::Ball;
use lut_gen::field::{Field, FieldError};
use lut_gen::law::Hyperfoam;
use lut_gen::model::{Indentation, Resolution, Specimen as Block};
use lut_gen::solve::SolveError;

use crate::experiment::Experiment;

use super::data::Height;
use super::fe::block;
use super::objective::{ALPHA, FIRST_HEIGHT, LN_MU};
use super::{Identification, Outcome};

/// Fields at the identified parameters and the depth of the run that went deepest, by one more solve.
/// `None` when nothing was fitted.
pub fn deepest_field(experiment: &Experiment, found: &Identification) -> Option<Result<Field, FieldError>> {
    let fit = found.fit.as_ref().filter(|_| found.outcome == Outcome::Fitted)?;
    let depths = fit.runs.iter().filter_map(|run| {
        let data = &found.selection.curves[run.curve];
        let last = data.depth_mm.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        Some((last - run.contact_mm, data.pairing)).filter(|(depth, _)| *depth > 0.0)
    });
    let (depth_mm, pairing) = depths.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let pairing = &found.selection.pairings[pairing];
    let mut specimen: Block = block(experiment, &found.selection, pairing);
    if let Height::Free(at) = pairing.height {
        specimen.height_mm = fit.point[FIRST_HEIGHT + at];
    }
    let law = match Hyperfoam::one_term(fit.point[LN_MU].exp(), fit.point[ALPHA]) {
        Ok(law) => law,
        Err(cause) => return Some(Err(SolveError::from(cause).into())),
    };
    let ball = Ball { radius_mm: pairing.ball_mm };
    let indentation = Indentation { law, specimen, ball, depth_mm, resolution: Resolution::Standard };
    Some(indentation.fields_at(&[depth_mm]).map(|mut fields| fields.swap_remove(0)))
}
