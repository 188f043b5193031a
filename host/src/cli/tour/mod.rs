//! `palpate tour`.

mod arguments;
mod bench;
mod round;

use std::io::Write;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use miette::{Context, IntoDiagnostic, miette};
use protocol::lut::Table;

pub use self::arguments::Arguments;
use self::arguments::DEFAULT_FOLDER;
use self::bench::Bench;
use self::round::{Found, Round};
use super::progress::Progress;
use super::range::within;
use crate::demo::{Stage, demo_table};
use crate::log::{library_names, quoted};
use crate::ownership::OwnFolder;
use crate::signals;
use crate::tour::{Filtered, Pressed, Specimens, Stop, Tour, TourError, bounding, filtered};

/// Presses, a row each, written as they are made.
const PRESSES: &str = "presses.csv";

/// Goes round, identifies and writes.
///
/// # Errors
/// A file with a mistake, a board that cannot be reached or refuses, a press without an end, a file that cannot be written.
pub fn run(arguments: &Arguments) -> miette::Result<()> {
    if let Some(copy) = &arguments.copy {
        return super::file::copy(copy, Tour::THESIS);
    }
    let (slowest, fastest) = firmware::mode::ModeConfig::default().rate_mm_s;
    within("--rate", arguments.rate, f64::from(slowest)..=f64::from(fastest), "mm/s")?;
    within("--depth", arguments.depth, 0.5..=4.0, "mm")?;
    within("--noise", arguments.noise, 0.0..=0.2, "of the largest force")?;
    let tour = match &arguments.tour {
        Some(file) => Tour::read(file)?,
        None => Tour::thesis()?,
    };
    let tour = match arguments.presses {
        Some(presses) => tour.of_visits(presses as usize),
        None => tour,
    };
    let mut folder = OwnFolder::open(&arguments.out, "--out", Some(DEFAULT_FOLDER)).into_diagnostic()?;
    let stop = Arc::new(AtomicBool::new(false));
    signals::stop_on_signals(&stop).into_diagnostic()?;
    let progress = Progress::new();
    let bytes = table(arguments, &progress)?;
    let table = Table::parse(&bytes).into_diagnostic().wrap_err("table")?;
    let mut bench = Bench::open(arguments, &table, &bytes)?;
    let specimens = Specimens::solved(&tour, (arguments.depth, arguments.rate), &|done| {
        progress.set("specimens", done, tour.stops.len());
    })
    .into_diagnostic()?;
    let mut begin = || folder.clear(PRESSES);
    let walked = gone(arguments, (&mut bench, &table), (&tour, &specimens), (&mut begin, &stop), &progress);
    progress.end();
    if arguments.out.join(PRESSES).exists() {
        folder.adopt(PRESSES).into_diagnostic()?;
    }
    let round = Round { tour: &tour, table: &table, names: library_names(&table), arguments, found: walked? };
    let mut files = vec![arguments.out.join(PRESSES)];
    files.extend(round.write(&mut folder, &specimens)?);
    if arguments.json {
        outln!("{}", round.json(&files));
        return Ok(());
    }
    round.print();
    super::file::told(&files);
    Ok(())
}

fn table(arguments: &Arguments, progress: &Progress) -> miette::Result<Vec<u8>> {
    match &arguments.table {
        Some(path) => std::fs::read(path).into_diagnostic().wrap_err_with(|| path.display().to_string()),
        None => Ok(demo_table(&|stage| {
            if let Stage::Solving { what, done, total } = stage {
                progress.set(what, done, total);
            }
        })?),
    }
}

/// Clears the file of the presses, once the board has answered: what an earlier tour left is kept until then.
type Begin<'a> = dyn FnMut() -> std::io::Result<PathBuf> + 'a;

fn gone(
    arguments: &Arguments,
    (bench, table): (&mut Bench, &Table<'_>),
    (tour, specimens): (&Tour, &Specimens),
    (begin, stop): (&mut Begin<'_>, &AtomicBool),
    progress: &Progress,
) -> miette::Result<Found> {
    let kind = bounding(&arguments.bounding).ok_or_else(|| miette!("--bounding is {}", arguments.bounding))?;
    let order = tour.order(arguments.seed);
    let mut log: Option<std::fs::File> = None;
    let names = library_names(table);
    let mut found = Found::new();
    let mut told = |press: &Pressed| {
        let slice = (press.verdict.height_mm, press.verdict.rate_mm_s);
        let by_filter = filtered(table, &press.samples, slice, kind);
        let line = row(&tour.stops[press.stop], press, by_filter.as_ref(), &names);
        let log = match &mut log {
            Some(log) => log,
            none => none.insert(begun(begin).map_err(|cause| TourError::Unwritten(cause.to_string()))?),
        };
        writeln!(log, "{line}").and_then(|()| log.flush()).map_err(|cause| TourError::Unwritten(cause.to_string()))?;
        progress.set("presses", press.number, order.len());
        found.push((press.clone(), by_filter));
        Ok(())
    };
    let walked = bench.walk((tour, specimens), &order, (arguments.rate, arguments.depth), stop, &mut told);
    match walked {
        // what was pressed until then is worth a page
        Err(error) if !found.is_empty() => {
            errln!("{error}");
            Ok(found)
        }
        walked => walked.into_diagnostic().map(|_| found),
    }
}

/// The file of the presses with its head.
fn begun(begin: &mut Begin<'_>) -> std::io::Result<std::fs::File> {
    let mut log = std::fs::File::create(begin()?)?;
    writeln!(log, "{HEAD}")?;
    Ok(log)
}

/// Columns of the presses.
const HEAD: &str = "press,stop,x_mm,y_mm,z_mm,stated_mu_MPa,stated_alpha,outcome,search_mu_MPa,search_alpha,search_named,\
                    filter_mu_MPa,filter_alpha,filter_named";

fn row(stop: &Stop, press: &Pressed, filter: Option<&Filtered>, names: &[String]) -> String {
    let name = |index: Option<usize>| index.and_then(|i| names.get(i)).map(|own| quoted(own)).unwrap_or_default();
    let pair = |own: Option<(f64, f64)>| own.map_or(",".to_owned(), |(mu, alpha)| format!("{mu:.6},{alpha:.4}"));
    let [x, y, z] = stop.at_mm;
    format!(
        "{},{},{x},{y},{z},{:.6},{:.4},{:?},{},{},{},{}",
        press.number,
        quoted(&stop.name),
        stop.mu_mpa * stop.softened(press.of_stop),
        stop.alpha,
        press.verdict.outcome,
        pair(press.identified()),
        name(press.named()),
        pair(filter.map(|found| (found.mu_mpa, found.alpha))),
        name(filter.and_then(|found| found.named)),
    )
}
