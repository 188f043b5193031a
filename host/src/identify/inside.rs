//! What the identified material looks like inside, at the deepest point of its runs.

use lut_gen::solid::field::{Field, FieldError};

use super::{Identification, Outcome};

/// Fields at the identified parameters and the depth of the run that went deepest, by one more solve.
/// `None` when nothing was fitted.
pub fn deepest_field(found: &Identification) -> Option<Result<Field, FieldError>> {
    let fit = found.fit.as_ref().filter(|_| found.outcome == Outcome::Fitted)?;
    fit.deepest.as_ref()?.fields().map(|mut fields| fields.pop()).transpose()
}
