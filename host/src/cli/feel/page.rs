//! The files of what was felt.

use std::path::PathBuf;

use miette::IntoDiagnostic;

use super::arguments::Arguments;
use super::told;
use crate::feel::Felt;
use crate::ownership::{OwnFolder, file_name};
use crate::report::{Page, feel as picture};

/// Writes page, pictures and samples; `before` with the curves before, if there are any.
///
/// # Errors
/// A file that cannot be written.
pub(super) fn write(
    folder: &mut OwnFolder,
    arguments: &Arguments,
    (all, before): (&[Felt], &[Felt]),
) -> miette::Result<Vec<PathBuf>> {
    let is_read = all.iter().any(|felt| felt.is_read);
    let subtitle = if is_read { told::READ[0].to_owned() } else { told::subtitle(&arguments.plant, &arguments.magnet) };
    let mut page = Page::new("What is felt", &subtitle);
    page.table(&told::HEAD, &told::rows(all));
    page.list(&told::notes(all).map(str::to_owned));
    if !before.is_empty() {
        page.section("What curves for the model gain");
        page.table(&told::GAIN, &told::gains(before, all));
    }
    let mut files = Vec::new();
    for felt in all {
        let name = format!("{}-{}", file_name(&felt.curve.material), told::word(felt.display));
        page.section(&format!("{}, {}", felt.curve.material, told::name(felt.display)));
        for (what, figure, caption) in picture::figures(felt) {
            let svg = figure.svg();
            page.figure(&svg, caption);
            files.push(folder.write(&format!("{name}-{what}.svg"), svg.as_bytes()).into_diagnostic()?);
        }
        files.push(folder.write(&format!("{name}.csv"), told::csv(felt).as_bytes()).into_diagnostic()?);
    }
    files.insert(0, folder.write("feel.html", page.html().as_bytes()).into_diagnostic()?);
    Ok(files)
}
