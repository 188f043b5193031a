//! What a recording says of the board it is of.

use std::collections::BTreeMap;

use protocol::message::{Calibration, Hello};
use serde_json::Value;

use crate::link::Link;
use crate::session::{Session, SessionError};

/// Who the board is, what runs on it, and what turned its readings into units. Gains are not among it: the board does not tell them.
#[derive(Debug, Clone, PartialEq)]
pub struct About {
    entries: BTreeMap<String, String>,
}

impl About {
    /// Asks the board that has said `hello`.
    ///
    /// # Errors
    /// As [`Session::request`].
    pub fn of<L: Link>(session: &mut Session<L>, hello: &Hello) -> Result<Self, SessionError> {
        let table = session.status()?.table_hash;
        let calibration = session.calibration()?;
        Ok(About::new(hello, table, &calibration))
    }

    fn new(hello: &Hello, table: [u8; 16], calibration: &Calibration) -> Self {
        let hex = |bytes: &[u8]| bytes.iter().map(|byte| format!("{byte:02x}")).collect::<String>();
        let [major, minor, patch] = hello.firmware_version;
        let mut entries: BTreeMap<String, String> = [
            ("palpate", env!("CARGO_PKG_VERSION").to_owned()),
            ("board", hex(&hello.unique_id)),
            ("surroundings", if hello.simulated { "simulated" } else { "real" }.to_owned()),
            ("firmware", format!("{major}.{minor}.{patch}")),
            ("protocol", hello.protocol_version.to_string()),
            ("table", if table == [0; 16] { "none".to_owned() } else { hex(&table) }),
        ]
        .into_iter()
        .map(|(name, value)| (name.to_owned(), value))
        .collect();
        flatten("calibration", &serde_json::json!(calibration), &mut entries);
        About { entries }
    }

    /// Names and values.
    #[must_use]
    pub fn entries(&self) -> &BTreeMap<String, String> {
        &self.entries
    }

    /// In one line, without commas: a cell of a table.
    #[must_use]
    pub fn line(&self) -> String {
        self.entries.iter().map(|(name, value)| format!("{name} {value}")).collect::<Vec<_>>().join("; ")
    }
}

/// Nested fields by names with dots.
fn flatten(name: &str, value: &Value, into: &mut BTreeMap<String, String>) {
    match value {
        Value::Object(fields) => {
            for (field, value) in fields {
                flatten(&format!("{name}.{field}"), value, into);
            }
        }
        Value::Array(items) => {
            for (index, value) in items.iter().enumerate() {
                flatten(&format!("{name}.{index}"), value, into);
            }
        }
        value => {
            // Calibrations are of single precision: 0.1, not 0.10000000149.
            let text = value.as_f64().map_or_else(|| value.to_string(), |number| (number as f32).to_string());
            into.insert(name.to_owned(), text);
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use std::time::{SystemTime, UNIX_EPOCH};

    use protocol::message::ResetCause;

    use super::*;
    use crate::link::{InProcess, Pace};
    use crate::log::{COLUMNS, Recorder};
    use crate::plant::Jitter;
    use crate::session::{Event, Gap, Patience};
    use crate::simulated_board::SimulatedBoard;

    fn seconds_since_1970() -> f64 {
        SystemTime::now().duration_since(UNIX_EPOCH).unwrap().as_secs_f64()
    }

    /// A second, a restart of the board, and the same second again, recorded in `folder`.
    fn recorded(folder: &std::path::Path) -> About {
        let link = InProcess::new(SimulatedBoard::new(1, Jitter::NONE), Pace::Free);
        let (mut session, hello) = Session::open(link, Patience::default()).unwrap();
        let about = About::of(&mut session, &hello).unwrap();
        let until_s = session.link().now_s() + 1.0;
        let events: Vec<Event> = std::iter::from_fn(|| session.poll(until_s).unwrap()).collect();
        let (csv, mcap) = (folder.join("a.csv"), folder.join("a.mcap"));
        let mut recorder = Recorder::create_new(Some(&csv), Some(&mcap)).unwrap();
        recorder.about(&about).unwrap();
        let restarted = Some(ResetCause::Watchdog);
        let gap = Gap { silent_s: 3.0, after_tick: Some(50), uptime_s: 0.1, restarted, link_lost: None };
        for event in events.iter().chain([&Event::Gap(gap)]).chain(&events) {
            recorder.event(event, &session.traffic()).unwrap();
        }
        recorder.finish().unwrap();
        about
    }

    #[test]
    fn times_are_those_of_the_wall_and_go_on_over_a_restart() {
        let folder = tempfile::tempdir().unwrap();
        let before_s = seconds_since_1970();
        recorded(folder.path());
        let after_s = seconds_since_1970();
        let bytes = std::fs::read(folder.path().join("a.mcap")).unwrap();
        let times: Vec<(f64, f64)> = mcap::MessageStream::new(&bytes)
            .unwrap()
            .map(|message| message.unwrap())
            .filter(|message| message.channel.topic == "telemetry")
            .map(|message| (message.log_time as f64 * 1e-9, message.publish_time as f64 * 1e-9))
            .collect();
        // The first record is anchored to the wall clock; those that follow keep the board's distance.
        assert!(
            before_s - 0.01 <= times[0].0 && times[0].0 <= after_s + 0.01,
            "{:?} in {before_s}..{after_s}",
            times[0]
        );
        assert!(times.windows(2).all(|t| t[1].0 > t[0].0 && t[1].1 > t[0].1), "{times:?}");
        let board_s: Vec<f64> = times.iter().map(|t| t.1).collect();
        assert!(board_s[0] < 1.0, "publish_time is the board's: {board_s:?}");
        // One second, the gap of three, and a second again; doubles hold wall time in ns to 0.3 us.
        let (first, last) = (times[0], times[times.len() - 1]);
        assert!(((last.0 - first.0) - (last.1 - first.1)).abs() < 1e-5 && last.0 - first.0 > 4.5, "{first:?} {last:?}");
    }

    #[test]
    fn both_files_say_whose_they_are() {
        let folder = tempfile::tempdir().unwrap();
        let about = recorded(folder.path());
        for (name, value) in [("board", "70616c706174652d73696d01"), ("surroundings", "simulated"), ("table", "none")] {
            assert_eq!(about.entries()[name], value);
        }
        assert_eq!(about.entries()["calibration.load_cell.zero_ratio"], "0.1");
        let bytes = std::fs::read(folder.path().join("a.mcap")).unwrap();
        let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
        let kept = mcap::read::metadata(&bytes, &summary.metadata_indexes[0]).unwrap();
        assert_eq!((kept.name.as_str(), &kept.metadata), ("palpate", about.entries()));
        let text = std::fs::read_to_string(folder.path().join("a.csv")).unwrap();
        let mut lines = text.lines();
        assert_eq!(lines.next(), Some(COLUMNS));
        let first = lines.next().unwrap();
        assert!(first.ends_with(&about.line()) && !about.line().contains(','), "{first}");
    }

    #[test]
    fn the_csv_says_the_day_and_is_still_an_experiments_run() {
        let folder = tempfile::tempdir().unwrap();
        recorded(folder.path());
        let text = std::fs::read_to_string(folder.path().join("a.csv")).unwrap();
        let at = COLUMNS.split(',').position(|name| name == "utc").unwrap();
        let cell = text.lines().nth(2).unwrap().split(',').nth(at).unwrap();
        let told: jiff::Timestamp = cell.parse().unwrap();
        assert!((told.as_millisecond() as f64 * 1e-3 - seconds_since_1970()).abs() < 60.0, "{cell}");
        let description = "name = \"log\"\n[columns]\ndepth_mm = \"belief_depth_mm\"\nforce_N = \"sensor_load_cell_n\"\n\
            [[run]]\nfile = \"a.csv\"\ntest = \"air\"\n";
        std::fs::write(folder.path().join("experiment.toml"), description).unwrap();
        let experiment = crate::experiment::read(folder.path()).unwrap();
        assert_eq!(experiment.runs.len(), 1);
    }
}
