//! Cases that were scored before: a line of JSON a case, so that a run that was cut off goes on where it ended.

use std::collections::HashMap;
use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use serde::{Deserialize, Serialize};

use crate::goals::Counted;

/// A case and what it counts for; a world that cannot be made counts for nothing.
#[derive(Serialize, Deserialize)]
struct Line {
    case: String,
    counted: Option<Counted>,
}

/// The file, and what it held.
pub struct Kept {
    file: Option<Mutex<File>>,
    before: HashMap<String, Option<Counted>>,
}

impl Kept {
    /// Reads the file of an earlier run of the same build, and goes on writing to it. Without one nothing is kept.
    ///
    /// # Errors
    /// A file that cannot be read or holds anything else.
    pub fn open(path: Option<&Path>) -> Result<Self, Box<dyn std::error::Error>> {
        let Some(path) = path else { return Ok(Kept { file: None, before: HashMap::new() }) };
        let file = OpenOptions::new().read(true).append(true).create(true).open(path)?;
        let mut before = HashMap::new();
        for (number, text) in BufReader::new(&file).lines().enumerate() {
            let wrong = |error| format!("{}:{}: {error}", path.display(), number + 1);
            let line: Line = serde_json::from_str(&text?).map_err(wrong)?;
            before.insert(line.case, line.counted);
        }
        Ok(Kept { file: Some(Mutex::new(file)), before })
    }

    /// How many were there at the start.
    pub fn len(&self) -> usize {
        self.before.len()
    }

    /// What a case counts for: as it was kept, or as it is found now.
    ///
    /// # Errors
    /// Those of finding it; a line that cannot be written is told and the run goes on.
    pub fn of<E>(&self, case: String, find: impl FnOnce() -> Result<Option<Counted>, E>) -> Result<Option<Counted>, E> {
        if let Some(counted) = self.before.get(&case) {
            return Ok(counted.clone());
        }
        let counted = find()?;
        if let Some(file) = &self.file {
            let line = Line { case, counted: counted.clone() };
            let mut file = file.lock().unwrap_or_else(PoisonError::into_inner);
            let kept =
                serde_json::to_string(&line).map_err(std::io::Error::from).and_then(|text| writeln!(file, "{text}"));
            if let Err(error) = kept {
                eprintln!("not kept: {error}");
            }
        }
        Ok(counted)
    }
}
