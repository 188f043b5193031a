//! `palpate tour`.

use std::io::Write;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use clap::Args;
use clap::builder::PossibleValuesParser;
use miette::{Context, IntoDiagnostic, miette};
use protocol::lut::Table;
use serde_json::{Value, json};

use super::answer::{columns, entered};
use super::progress::Progress;
use super::range::within;
use crate::demo::{Stage, demo_table};
use crate::experiment::signal::mean;
use crate::link::{Address, InProcess, Link, Pace};
use crate::log::{library_names, quoted};
use crate::ownership::OwnFolder;
use crate::plant::Jitter;
use crate::report::{Page, number, tour as picture};
use crate::session::{Patience, Session, SessionError};
use crate::signals;
use crate::simulated_board::SimulatedBoard;
use crate::tour::{
    BOUNDINGS, Filtered, Pressed, Specimens, Stop, Surroundings, Tour, TourError, bounding, filtered, walk,
};
use crate::trial::exact::interval95;

/// Folder where none is asked for.
const DEFAULT_FOLDER: &str = "out/tour";
/// Presses, a row each, written as they are made.
const PRESSES: &str = "presses.csv";

/// Where to go, in which order, and how to press there.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The stops [default: the thesis' four foams and three tissues]
    #[arg(value_name = "TOUR.toml")]
    tour: Option<PathBuf>,
    /// The board: sim, auto (the one on USB), tcp:HOST:PORT or serial:PATH; at a real one you are told where to go
    #[arg(long, default_value = "sim")]
    board: Address,
    /// Rate of the probe, mm/s
    #[arg(long, default_value_t = 2.0, value_name = "MM_PER_S")]
    rate: f64,
    /// Depth after contact, mm
    #[arg(long, default_value_t = 4.0, value_name = "MM")]
    depth: f64,
    /// About so many presses in all, in the proportion of the file's visits [default: as often as the file says]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    presses: Option<u32>,
    /// Seed of the order: the same at every rate
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// White noise of the simulated load cell, as a part of each specimen's largest force
    #[arg(long, default_value_t = 0.01, value_name = "PART")]
    noise: f64,
    /// How the Kalman filter keeps its estimates within the region
    #[arg(long, default_value = "penalty", value_parser = PossibleValuesParser::new(BOUNDINGS.map(|(word, _)| word)))]
    bounding: String,
    /// The board's table; the simulated one is sent it [default: the demo's, computed first]
    #[arg(long, value_name = "FILE")]
    table: Option<PathBuf>,
    /// Folder for the page, its pictures and the presses
    #[arg(long, value_name = "DIR", default_value = DEFAULT_FOLDER)]
    out: PathBuf,
    /// Copy the thesis' stops to this new file, to change them, and press nothing
    #[arg(long, value_name = "FILE")]
    copy: Option<PathBuf>,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

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
    let specimens = Specimens::solved(&tour, (arguments.depth, arguments.rate), &|done| {
        progress.set("specimens", done, tour.stops.len());
    })
    .into_diagnostic()?;
    let mut begin = || folder.clear(PRESSES);
    let walked = gone(arguments, (&tour, &specimens), (&table, &bytes), (&mut begin, &stop), &progress);
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

/// All presses with what the filter makes of each.
type Found = Vec<One>;
/// A press, and the filter's.
type One = (Pressed, Option<Filtered>);

fn gone(
    arguments: &Arguments,
    (tour, specimens): (&Tour, &Specimens),
    (table, bytes): (&Table<'_>, &[u8]),
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
    let way = (arguments.rate, arguments.depth);
    let walked = if arguments.board == Address::Simulated {
        let jitter = Jitter { force: arguments.noise, ..Jitter::default() };
        let link = InProcess::new(SimulatedBoard::new(arguments.seed, jitter), Pace::Free);
        let (mut session, _) = Session::open(link, Patience::default()).into_diagnostic()?;
        session.upload(bytes, |_| {}).into_diagnostic()?;
        session.tare_at_rest().into_diagnostic()?;
        walk(&mut session, (tour, &order), way, (&mut Simulated { tour, specimens }, stop), &mut told)
    } else {
        let link = crate::link::open(&arguments.board).into_diagnostic()?;
        let (mut session, _) = Session::open(link, Patience::default()).into_diagnostic()?;
        let own = session.status().into_diagnostic()?.table_hash;
        if own != table.hash() {
            return Err(miette!(
                help = "write the table with `palpate lut --demo`, or name the board's own by --table",
                "the board has another table than that of the tour"
            ));
        }
        walk(&mut session, (tour, &order), way, (&mut Operator, stop), &mut told)
    };
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

/// The bench of the simulation.
struct Simulated<'a> {
    tour: &'a Tour,
    specimens: &'a Specimens,
}

impl Surroundings<InProcess> for Simulated<'_> {
    fn bring(
        &mut self,
        session: &mut Session<InProcess>,
        (at, stop): (usize, &Stop),
        of_stop: usize,
    ) -> Result<(), TourError> {
        let foam = self.specimens.foam(self.tour, at, of_stop);
        let foam = foam.ok_or_else(|| TourError::Forceless { stop: stop.name.clone() })?;
        session.link_mut().board_mut().place(foam);
        Ok(())
    }

    fn mend(&mut self, session: &mut Session<InProcess>, _: &[String]) -> Result<(), TourError> {
        Ok(session.clear_faults()?)
    }
}

/// Somebody who moves probe or cart.
struct Operator;

impl<L: Link> Surroundings<L> for Operator {
    fn bring(&mut self, _: &mut Session<L>, (_, stop): (usize, &Stop), of_stop: usize) -> Result<(), TourError> {
        let [x, y, z] = stop.at_mm;
        errln!("{} (its press {of_stop}): move the probe above ({x}, {y}, {z}) mm, then Enter; q ends", stop.name);
        goes_on()
    }

    /// A fault is cleared by whoever has seen to its cause.
    fn mend(&mut self, session: &mut Session<L>, why: &[String]) -> Result<(), TourError> {
        loop {
            errln!("aborted: {}; see to it, then Enter clears the fault; q ends", why.join("; "));
            goes_on()?;
            match session.clear_faults() {
                Ok(()) => return Ok(()),
                Err(error @ SessionError::Refused { .. }) => errln!("{error}"),
                Err(error) => return Err(error.into()),
            }
        }
    }
}

/// Goes on at Enter; `walk` says before which press it ended.
fn goes_on() -> Result<(), TourError> {
    if entered() { Ok(()) } else { Err(TourError::Ended { number: 0 }) }
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

/// A tour that was gone.
struct Round<'a> {
    tour: &'a Tour,
    table: &'a Table<'a>,
    names: Vec<String>,
    arguments: &'a Arguments,
    found: Found,
}

/// What is told of one stop by one way: right, wrong and unnamed presses, and the spread of alpha.
struct Told {
    right: u32,
    wrong: u32,
    presses: u32,
    alpha: Option<(f64, f64)>,
}

/// Columns of the recognition.
const COLUMNS: [&str; 6] = ["stop", "way", "right", "95 %", "another name", "alpha: mean, deviation"];

impl Round<'_> {
    /// The search's, then the filter's.
    fn of(&self, stop: usize) -> [(&'static str, Told); 2] {
        let name = &self.tour.stops[stop].name;
        let own = || self.found.iter().filter(|(press, _)| press.stop == stop);
        let told = |named: &dyn Fn(&One) -> Option<usize>, alpha: &dyn Fn(&One) -> Option<f64>| {
            let is = |one| named(one).and_then(|index| self.names.get(index)).map(|found| found == name);
            let alphas: Vec<f64> = own().filter_map(alpha).collect();
            let middle = mean(alphas.iter().copied());
            let spread = middle.and_then(|m| mean(alphas.iter().map(|a| (a - m).powi(2)))).map(f64::sqrt);
            Told {
                right: own().filter(|one| is(one) == Some(true)).count() as u32,
                wrong: own().filter(|one| is(one) == Some(false)).count() as u32,
                presses: own().count() as u32,
                alpha: middle.zip(spread),
            }
        };
        [
            ("search", told(&|one| one.0.named(), &|one| Some(one.0.identified()?.1))),
            ("filter", told(&|one| one.1.as_ref()?.named, &|one| Some(one.1.as_ref()?.alpha))),
        ]
    }

    fn rows(&self) -> Vec<Vec<String>> {
        let stops = self.tour.stops.iter().enumerate().flat_map(|(at, stop)| self.of(at).map(|told| (stop, told)));
        stops
            .map(|(stop, (way, told))| {
                let known = self.names.contains(&stop.name);
                let (low, high) = interval95(told.right, told.presses);
                let alpha = told.alpha.map_or("-".to_owned(), |(middle, spread)| {
                    format!("{}, {:.1} %", number((100.0 * middle).round() / 100.0), 100.0 * spread / middle)
                });
                let interval = format!("{:.0} to {:.0} %", 100.0 * low, 100.0 * high);
                vec![
                    stop.name.clone(),
                    way.to_owned(),
                    if known { format!("{} of {}", told.right, told.presses) } else { "not in the library".to_owned() },
                    if known { interval } else { String::new() },
                    told.wrong.to_string(),
                    alpha,
                ]
            })
            .collect()
    }

    fn is_simulated(&self) -> bool {
        self.arguments.board == Address::Simulated
    }

    fn note(&self) -> String {
        let where_ = if self.is_simulated() { "Simulated. " } else { "" };
        format!(
            "{where_}{} presses at {} mm/s to {} mm, order by seed {}; Kalman filter bounded by {}.",
            self.found.len(),
            self.arguments.rate,
            self.arguments.depth,
            self.arguments.seed,
            self.arguments.bounding
        )
    }

    fn print(&self) {
        columns(&COLUMNS, &self.rows());
        outln!("\n{}", self.note());
    }

    fn write(&self, folder: &mut OwnFolder, specimens: &Specimens) -> miette::Result<Vec<PathBuf>> {
        let mut page = Page::new("A tour of the bench", &self.note());
        page.table(&COLUMNS, &self.rows());
        let mut drawn = picture::identified(self.tour, &self.found, (&self.arguments.bounding, self.is_simulated()));
        drawn.extend(picture::indentations(self.tour, specimens));
        drawn.push(picture::compressions(self.tour));
        drawn.extend(picture::surface(self.table));
        let mut files = Vec::new();
        for (name, figure, caption) in drawn {
            let svg = figure.svg();
            page.figure(&svg, &caption);
            files.push(folder.write(&format!("{name}.svg"), svg.as_bytes()).into_diagnostic()?);
        }
        files.insert(0, folder.write("tour.html", page.html().as_bytes()).into_diagnostic()?);
        Ok(files)
    }

    fn json(&self, files: &[PathBuf]) -> Value {
        let told = |told: &Told| {
            json!({"right": told.right, "wrong": told.wrong, "presses": told.presses,
                   "interval95": interval95(told.right, told.presses),
                   "alpha": told.alpha.map(|(mean, deviation)| json!({"mean": mean, "deviation": deviation}))})
        };
        let stop = |(at, stop): (usize, &Stop)| {
            let [search, filter] = self.of(at);
            json!({"stop": stop.name, "at_mm": stop.at_mm, "in_library": self.names.contains(&stop.name),
                   "search": told(&search.1), "filter": told(&filter.1)})
        };
        json!({"rate_mm_s": self.arguments.rate, "depth_mm": self.arguments.depth, "seed": self.arguments.seed,
               "bounding": self.arguments.bounding, "simulated": self.is_simulated(),
               "stops": self.tour.stops.iter().enumerate().map(stop).collect::<Vec<_>>(),
               "files": super::file::names(files)})
    }
}
