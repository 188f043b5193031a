//! The whole chain on the simulated board: a table by finite elements, uploaded over the framed link, four foams palpated in random order,
//! identified at 50 Hz, logged, displayed to a finger, then both at once, and felt by a hand on both displays.
//!
//! The foams under the probe have curves of their own ([`bench_foams`]), solved on finer meshes than the table's, so the board never
//! meets the numbers it searches.

mod display;
mod error;
mod extended;
mod felt;
mod figures;
mod foams;
mod listening;
mod options;
mod palpation;
mod report;
mod summary;
mod table;
mod together;
mod watcher;

use std::path::Path;
use std::time::Instant;

use protocol::lut::Table;

pub use display::{DisplayTrace, Displayed, LimitTicks};
pub use error::DemoError;
pub use foams::bench_foams;
pub use options::Options;
pub use palpation::{Palpated, TracePoint};
pub use report::overview_svg;
pub use summary::{Confusion, Summary};
pub use table::{BALL_RADIUS_MM, demo_table, demo_table_with};
pub use together::{ShownFoam, Tick, Together};
pub use watcher::{Stage, Watcher};

use crate::link::{Disturbed, InProcess, Pace};
use crate::log::{Recorder, library_names};
use crate::ownership::OwnFolder;
use crate::plant::{Noise, Source};
use crate::session::{Patience, Session};
use crate::simulated_board::SimulatedBoard;
use listening::Listening;

/// Names of the files in the demo's folder.
const TABLE: &str = "table.lut";
const CSV: &str = "telemetry.csv";
const MCAP: &str = "log.mcap";
const OVERVIEW: &str = "overview.svg";
const REPORT: &str = "report.html";
const FILES: [&str; 5] = [TABLE, CSV, MCAP, OVERVIEW, REPORT];

/// Opens the demo's folder: before anything is computed for one that is not to be written to.
///
/// # Errors
/// A folder that cannot be made, or holds files of the demo's names that the demo has not written.
pub(crate) fn folder(out: &Path) -> Result<OwnFolder, DemoError> {
    let failed = |source| DemoError::File { path: out.to_owned(), source };
    let folder = OwnFolder::open(out, "--out", Some("out/demo")).map_err(failed)?;
    FILES.iter().try_for_each(|name| folder.check(name)).map_err(failed)?;
    Ok(folder)
}

/// Runs the demo and writes its files.
///
/// # Errors
/// [`DemoError`].
pub fn run(options: &Options, watch: Watcher<'_>) -> Result<Summary, DemoError> {
    let started = Instant::now();
    let failed = |source| DemoError::File { path: options.out.clone(), source };
    let mut folder = folder(&options.out)?;
    let table_bytes = match &options.table {
        Some(path) => std::fs::read(path).map_err(|source| DemoError::File { path: path.clone(), source })?,
        None => {
            let bytes = match &options.model {
                Some(model) => extended::table(model, options.rate_mm_s, &options.control, watch)?,
                None => demo_table_with(&options.control, watch)?,
            };
            folder.write(TABLE, &bytes).map_err(failed)?;
            bytes
        }
    };
    let table = Table::parse(&table_bytes).map_err(crate::session::SessionError::from)?;
    let depth_mm = f64::from(table.depth_max_mm());
    let foams = match &options.model {
        Some(model) => extended::bench(model, options.rate_mm_s, depth_mm, watch)?,
        None => bench_foams(depth_mm, watch)?,
    };
    let solved_s = started.elapsed().as_secs_f64();

    let board = SimulatedBoard::new(options.seed, options.jitter);
    let line = Disturbed::new(InProcess::new(board, Pace::Free), options.line, options.seed);
    let (mut session, hello) = Session::open(line, Patience::default())?;
    let uploaded = Instant::now();
    let state = session.upload(&table_bytes, |p| {
        watch(Stage::Uploading { done: p.sent as usize, total: p.length as usize });
    })?;
    let upload_s = uploaded.elapsed().as_secs_f64();
    // The bench's load cell has an offset of its own until it is tared.
    session.tare_at_rest()?;

    let (csv, mcap) = (folder.clear(CSV).map_err(failed)?, folder.clear(MCAP).map_err(failed)?);
    let mut listening = Listening::new(session, Recorder::create_new(Some(&csv), Some(&mcap))?);
    let library = library_names(&table);
    let order = random_order(foams.len(), options.palpations, options.seed);
    let mut palpated = Vec::with_capacity(order.len());
    for (number, &foam) in order.iter().enumerate() {
        let one = palpation::palpate(&mut listening, &foams[foam], &library, options, number + 1, watch)?;
        watch(Stage::Palpated { done: number + 1, total: order.len(), verdict: &one.sentence() });
        palpated.push(one);
    }
    let displayed = display::display(&mut listening, &table, &palpated)?;
    let together = together::together(&mut listening, &foams, &table, options)?;
    let (session, recorder) = listening.into_parts();
    recorder.finish()?;
    [CSV, MCAP].iter().try_for_each(|name| folder.adopt(name)).map_err(failed)?;

    let pressed =
        options.magnet.as_ref().map(|links| felt::felt(&displayed.material, &options.control, links, options.seed));
    let summary = Summary {
        felt: pressed.transpose()?.flatten().unwrap_or_default(),
        together,
        hello,
        slot: state.active,
        table_bytes: table_bytes.len(),
        error_bound: f64::from(table.error_bound().total()),
        library,
        palpated,
        displayed,
        traffic: session.traffic(),
        virtual_s: session.link().inner().board().time_s(),
        solved_s,
        upload_s,
        seconds: started.elapsed().as_secs_f64(),
        options: options.clone(),
        foams: foams.iter().map(|f| f.name.clone()).collect(),
    };
    report::write(&summary, &foams, &table, &mut folder).map_err(failed)?;
    Ok(summary)
}

/// Random order in which every foam comes equally often, up to one.
fn random_order(foams: usize, palpations: usize, seed: u64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..palpations).map(|i| i % foams.max(1)).collect();
    Noise::new(seed, Source::Choice).shuffle(&mut order);
    order
}
