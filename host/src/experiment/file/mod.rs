//! One data file: bytes to cells, cells to segments and columns, columns to numbers, with the place of every cell that is
//! none.

pub(crate) mod clock;
pub(crate) mod content;
mod field;
mod header_hint;
mod need;
pub(crate) mod number;
mod row_hint;
mod rows;
mod segment;
pub(crate) mod table;
pub(crate) mod text;
pub(crate) mod workbook;

use std::collections::BTreeMap;
use std::path::Path;

pub(crate) use need::Need;
pub use need::{DISPLAY_PAIRS, FINGER, GAP_MM, UNDER_FINGER};
pub(crate) use rows::Window;

use super::error::{ExperimentError, Problem};
use super::{Format, Mapping, Recording};
use content::Content;

/// Reads the samples of a run. Rows outside the window need hold no numbers; those at its ends may be read as well.
pub(super) fn read(
    path: &Path,
    need: &Need,
    columns: &BTreeMap<String, Mapping>,
    format: &Format,
    window: Window,
) -> Result<Recording, ExperimentError> {
    let bytes =
        std::fs::read(path).map_err(|cause| ExperimentError::of_file(path, Problem::Unreadable(cause.to_string())))?;
    let table = match Content::of(&bytes) {
        Content::Packed | Content::Compound => workbook::table(path, &bytes, format)?,
        Content::Text | Content::Other => text::table(path, &bytes, format)?,
    };
    let plan = segment::Plan { path, need, columns, format };
    let segment = plan.segment(&table)?;
    rows::recording(&plan, &table, &segment, window)
}
