//! The folder of a track: page and figures.

use std::path::{Path, PathBuf};

use miette::IntoDiagnostic;

use super::told;
use super::tracked::Tracked;
use crate::ownership::OwnFolder;
use crate::report::{Page, track as picture};

/// Writes the pictures and the page, which is returned.
pub(super) fn write(folder: &Path, tracked: &Tracked) -> miette::Result<PathBuf> {
    let mut folder = OwnFolder::open(folder, "--report", None).into_diagnostic()?;
    let Tracked { first, roi, measure, positions, encoder, .. } = tracked;
    let encoder = encoder.as_ref().map(|encoder| encoder.rows.as_slice());
    let mut pictures = vec![
        (
            "still.svg",
            picture::still(first, *roi, measure, positions),
            "The first frame with the region that is looked for, and the tip's path (as Fig. 60b of the thesis).",
        ),
        (
            "height.svg",
            picture::height(measure, positions, encoder).svg(),
            "Gaps are frames in which the tip is lost (as Fig. 63).",
        ),
        ("across.svg", picture::across(measure, positions).svg(), "To the right in the frame."),
        (
            "uncertainty.svg",
            picture::uncertainty(positions).svg(),
            "Standard deviations with the noise of the first frame, in whose place they are told.",
        ),
        (
            "likeness.svg",
            picture::likeness(positions).svg(),
            "Correlation with the first frame, of what is seen; below, what part of the tip's edges is seen.",
        ),
    ];
    let mut page = Page::new("Positions of a tip", "");
    for line in told::lines(tracked, None, None) {
        page.paragraph(&line);
    }
    for (name, svg, caption) in pictures.drain(..) {
        page.figure(&svg, caption);
        folder.write(name, svg.as_bytes()).into_diagnostic()?;
    }
    folder.write("track.html", page.html().as_bytes()).into_diagnostic()
}
