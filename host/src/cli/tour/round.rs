//! What is told of a tour that was gone: recognition by stop, page and pictures.

use std::path::PathBuf;

use miette::IntoDiagnostic;
use protocol::lut::Table;
use serde_json::{Value, json};

use super::arguments::Arguments;
use crate::cli::answer::columns;
use crate::cli::file::names;
use crate::experiment::signal::mean;
use crate::link::Address;
use crate::ownership::OwnFolder;
use crate::report::{Page, number, tour as picture};
use crate::tour::{Filtered, Pressed, Specimens, Stop, Tour};
use crate::trial::exact::interval95;

/// All presses with what the filter makes of each.
pub(super) type Found = Vec<One>;

/// A press, and the filter's.
pub(super) type One = (Pressed, Option<Filtered>);

/// A tour that was gone.
pub(super) struct Round<'a> {
    pub tour: &'a Tour,
    pub table: &'a Table<'a>,
    pub names: Vec<String>,
    pub arguments: &'a Arguments,
    pub found: Found,
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

    pub fn print(&self) {
        columns(&COLUMNS, &self.rows());
        outln!("\n{}", self.note());
    }

    pub fn write(&self, folder: &mut OwnFolder, specimens: &Specimens) -> miette::Result<Vec<PathBuf>> {
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

    pub fn json(&self, files: &[PathBuf]) -> Value {
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
               "files": names(files)})
    }
}
