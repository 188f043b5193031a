//! What a recording must be, however it ended.

use std::path::Path;

use palpate::log::{COLUMNS, recover_mcap};
use serde_json::Value;

/// A row of the CSV as far as it matters here.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    pub time_s: f64,
    pub tick: u64,
    pub frames_lost: u64,
    pub note: String,
}

/// Rows of a CSV whose lines are all whole.
pub fn rows(path: &Path) -> Result<Vec<Row>, String> {
    let text = std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))?;
    if !text.ends_with('\n') {
        return Err(format!("{} ends inside a line", path.display()));
    }
    if text.lines().next() != Some(COLUMNS) {
        return Err(format!("{} has no header", path.display()));
    }
    let mut rows = Vec::new();
    for record in csv::Reader::from_reader(text.as_bytes()).records() {
        let record = record.map_err(|e| e.to_string())?;
        let cell = |at: usize| record.get(at).unwrap_or_default();
        let last = record.len() - 1;
        rows.push(Row {
            time_s: cell(0).parse().map_err(|e| format!("time of {record:?}: {e}"))?,
            tick: cell(1).parse().map_err(|e| format!("tick of {record:?}: {e}"))?,
            frames_lost: cell(last - 2).parse().map_err(|e| format!("frames of {record:?}: {e}"))?,
            note: cell(last).to_owned(),
        });
    }
    Ok(rows)
}

/// Every gap in the ticks has its note, time never goes back, and a restart is no loss of 65,000 frames. Gives the notes
/// of gaps.
pub fn gaps_are_told(rows: &[Row]) -> Result<Vec<String>, String> {
    for pair in rows.windows(2) {
        let [before, now] = pair else { continue };
        let repeated = now.tick == before.tick && !now.note.is_empty();
        if now.tick != before.tick + 1 && !repeated && !now.note.contains("gap of ") {
            return Err(format!("tick {} after {} has no note of a gap: {:?}", now.tick, before.tick, now.note));
        }
        if now.time_s < before.time_s {
            return Err(format!("time {} after {}", now.time_s, before.time_s));
        }
    }
    if let Some(row) = rows.iter().find(|row| row.frames_lost > 1000) {
        return Err(format!("{} frames lost at tick {}", row.frames_lost, row.tick));
    }
    Ok(rows.iter().filter(|row| row.note.contains("gap of ")).map(|row| row.note.clone()).collect())
}

/// Topic, time (s) and content of a message.
pub type Message = (String, f64, Value);

/// Messages of an MCAP that is complete to its last chunk, whether it was ended properly, and how many gaps it tells.
pub fn messages(path: &Path) -> Result<(Vec<Message>, bool, usize), String> {
    let found = recover_mcap(path).map_err(|e| e.to_string())?;
    let telemetry: Vec<&Message> = found.messages.iter().filter(|(topic, ..)| topic == "telemetry").collect();
    if let Some(pair) = telemetry.windows(2).find(|pair| pair[1].1 < pair[0].1) {
        return Err(format!("time {} after {} in {}", pair[1].1, pair[0].1, path.display()));
    }
    let over = |(topic, _, value): &&(String, f64, Value)| topic == "gap" && value["over"] == true;
    let gaps = found.messages.iter().filter(over).count();
    Ok((found.messages, found.torn.is_none(), gaps))
}
