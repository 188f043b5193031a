//! Measures the thesis' figures on simulated foams and rewrites docs/thesis-numbers.md with its pictures:
//! `cargo run --release -p tests --example thesis_numbers`.

mod assumptions;
mod bounding;
mod inverse;
mod pictures;
mod recognition;
mod row;
mod spread;
mod times;
mod what_if;

use std::path::{Path, PathBuf};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use lut_gen::solid::model::Resolution;
use protocol::lut::Table;
use row::Row;
use tests::document::replace_section;
use tests::palpations::{Conditions, PressedFoam, RATES_MM_S, Study, THESIS_COUNTS, pressed_foams, tables};

/// Sessions of 150 palpations at each rate: 1,500, so that a failure in a hundred is seen fifteen times.
const SESSIONS: usize = 10;

/// What everything is measured on.
struct Bench {
    foams: Vec<PressedFoam>,
    tables: Vec<Vec<u8>>,
}

impl Bench {
    fn solve() -> Result<Self, Box<dyn std::error::Error>> {
        let bar = bar("tables", 0);
        let solved = |done: usize, total: usize| {
            bar.set_length(total as u64);
            bar.set_position(done as u64);
        };
        let tables = tables(Resolution::Standard, &solved)?;
        bar.finish_and_clear();
        Ok(Bench { foams: pressed_foams(Resolution::Standard.finer())?, tables })
    }

    fn table(&self, rate: usize) -> Result<Table<'_>, String> {
        Table::parse(&self.tables[rate]).map_err(|e| e.to_string())
    }

    /// Sessions at every rate.
    fn studies(&self, sessions: usize, conditions: &Conditions, bar: &ProgressBar) -> Result<Vec<Study>, String> {
        let at = |rate| {
            let table = self.table(rate)?;
            let of = (sessions, THESIS_COUNTS.as_slice());
            Ok(Study::run(&self.foams, &table, rate, of, conditions, &mut || bar.inc(1)))
        };
        (0..RATES_MM_S.len()).map(at).collect()
    }

    /// Place of a foam among the pressed ones.
    fn foam(&self, name: &str) -> usize {
        self.foams.iter().position(|f| f.name == name).unwrap_or(0)
    }
}

fn bar(what: &str, steps: usize) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(steps as u64), ProgressDrawTarget::stderr());
    if let Ok(style) = ProgressStyle::with_template("{msg:24} [{bar:30}] {pos:>3}/{len}, {eta} left") {
        bar.set_style(style.progress_chars("=> "));
    }
    bar.set_message(what.to_owned());
    bar
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    let bench = Bench::solve()?;
    let conditions = Conditions::default();
    let counting = bar("palpations, sessions", SESSIONS * RATES_MM_S.len());
    let studies = bench.studies(SESSIONS, &conditions, &counting)?;
    counting.finish_and_clear();

    let mut rows = recognition::rows(&bench, &studies);
    rows.extend(spread::rows(&bench, &studies));
    let (bounds, successes) = bounding::measure(&docs)?;
    rows.extend(bounds);
    rows.extend(times::rows()?);
    let (inverse, six) = inverse::measure()?;
    rows.extend(inverse);
    let sections = [
        ("rows", row::table(&rows)),
        ("assumptions", assumptions::table(&conditions)),
        ("recognition", recognition::table(&bench, &studies)),
        ("what if", what_if::table(&bench, &docs)?),
        ("spread", spread::table(&bench, &studies)),
        ("bounding", successes),
        ("six parameters", six),
    ];
    let path = docs.join("thesis-numbers.md");
    let mut text = std::fs::read_to_string(&path)?;
    for (name, content) in &sections {
        println!("{content}");
        text = replace_section(&text, name, content)?;
    }
    pictures::curves(&bench, &docs)?;
    pictures::identified(&bench, &studies, &docs)?;
    std::fs::write(&path, text)?;
    println!("wrote {}", path.display());
    let missed: Vec<&Row> = rows.iter().filter(|r| r.met == Some(false)).collect();
    for row in &missed {
        println!("MISSED: {} {}: {}", row.what, row.case, row.measured);
    }
    Ok(())
}

/// Writes a picture beside the document.
fn save(docs: &Path, name: &str, svg: &str) -> std::io::Result<PathBuf> {
    let path = docs.join("figures").join(name);
    std::fs::write(&path, svg)?;
    Ok(path)
}
