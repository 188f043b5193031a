//! The journal of a session: a file of JSON lines that only grows.
//!
//! The first line says what the session is, every other one is an answer. A line is on the disk before the next presentation begins. A
//! session that was killed goes on where its last whole line ends; half a line is taken off.

use std::fs::{File, OpenOptions};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::order::{code, order};

/// What the first line begins with.
const MARK: &str = "{\"palpate_trial\":1,";
/// Most materials: a key each.
pub const MOST_STIMULI: usize = 9;
/// Most repeats.
pub const MOST_REPEATS: usize = 1000;

/// What a session is.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Session {
    /// Version of the format.
    palpate_trial: u32,
    /// Code of the subject.
    pub subject: String,
    /// Materials, in the order of their keys.
    pub stimuli: Vec<String>,
    /// Presentations of each.
    pub repeats: usize,
    /// What is shown when, as indices of materials.
    pub order: Vec<usize>,
}

impl Session {
    /// A session of a subject; 2 to 9 materials, 1 to 1000 repeats.
    #[must_use]
    pub fn new(stimuli: Vec<String>, repeats: usize, seed: u64, subject: u32) -> Self {
        let order = order(stimuli.len(), repeats, seed, subject);
        Self { palpate_trial: 1, subject: code(seed, subject), stimuli, repeats, order }
    }
}

/// An answer.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Given {
    /// Number of the presentation, from 1.
    pub trial: usize,
    /// What was shown.
    pub shown: usize,
    /// What was answered.
    pub answered: usize,
    /// Time from the presentation to the answer, s.
    pub seconds: f64,
}

/// What is wrong with a journal. The texts are part of the interface.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum JournalError {
    /// The operating system.
    #[error("{}: {cause}", file.display())]
    Refused {
        /// The file.
        file: PathBuf,
        /// Why.
        cause: std::io::Error,
    },
    /// No journal.
    #[error("{}: no journal of palpate trial; expected a first line that begins with {MARK}", file.display())]
    #[diagnostic(help("the file is kept; name another for a new session"))]
    Foreign {
        /// The file.
        file: PathBuf,
    },
    /// A line that breaks a rule.
    #[error("{}, line {line}: {what}; expected {expected}", file.display())]
    Line {
        /// The file.
        file: PathBuf,
        /// Line, from 1.
        line: usize,
        /// What is wrong.
        what: String,
        /// What was expected.
        expected: String,
    },
    /// The journal is that of another session.
    #[error("{}: holds a session of {found}; asked for is one of {asked}", file.display())]
    #[diagnostic(help("the journal is kept; go on with its own options, or name another file"))]
    Another {
        /// The file.
        file: PathBuf,
        /// In the file.
        found: String,
        /// By the options.
        asked: String,
    },
    /// Another process writes it.
    #[error("{}: another session writes this journal", file.display())]
    Busy {
        /// The file.
        file: PathBuf,
    },
}

/// A journal that is being written.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
    /// The session.
    pub session: Session,
    /// Answers so far.
    pub given: Vec<Given>,
    /// Bytes of half a line that were taken off.
    pub torn: usize,
}

fn refused(path: &Path) -> impl Fn(std::io::Error) -> JournalError {
    let file = path.to_owned();
    move |cause| JournalError::Refused { file: file.clone(), cause }
}

impl Journal {
    /// Begins a session, or goes on with the one that the file holds.
    ///
    /// # Errors
    /// [`JournalError`]; the file stays as it is.
    pub fn open(path: &Path, asked: &Session) -> Result<Self, JournalError> {
        if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
            std::fs::create_dir_all(folder).map_err(refused(folder))?;
        }
        let mut file =
            OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path).map_err(refused(path))?;
        if file.try_lock().is_err() {
            return Err(JournalError::Busy { file: path.to_owned() });
        }
        let mut text = String::new();
        let read = file.read_to_string(&mut text);
        if read.as_ref().is_err_and(|cause| cause.kind() == std::io::ErrorKind::InvalidData) {
            return Err(JournalError::Foreign { file: path.to_owned() });
        }
        read.map_err(refused(path))?;
        let whole = text.rfind('\n').map_or(0, |end| end + 1);
        let torn = text.len() - whole;
        // Half of a first line is ours only if it is the beginning of one.
        let beginning = &text[..text.len().min(MARK.len())];
        if whole == 0 && torn > 0 && beginning != &MARK[..beginning.len()] {
            return Err(JournalError::Foreign { file: path.to_owned() });
        }
        if whole == 0 {
            file.set_len(0).map_err(refused(path))?;
            let mut journal = Self { path: path.to_owned(), file, session: asked.clone(), given: Vec::new(), torn };
            journal.line(&serde_json::to_string(asked).unwrap_or_default())?;
            return Ok(journal);
        }
        let (session, given) = parse(path, &text[..whole])?;
        if session != *asked {
            let named = |s: &Session| format!("{}: {} shown {} times each", s.subject, s.stimuli.join(", "), s.repeats);
            return Err(JournalError::Another { file: path.to_owned(), found: named(&session), asked: named(asked) });
        }
        file.set_len(whole as u64).map_err(refused(path))?;
        Ok(Self { path: path.to_owned(), file, session, given, torn })
    }

    /// The next presentation: its number from 1, and the material. None when all are answered.
    #[must_use]
    pub fn next(&self) -> Option<(usize, usize)> {
        let at = self.given.len();
        self.session.order.get(at).map(|shown| (at + 1, *shown))
    }

    /// Writes an answer to the next presentation, and waits until it is on the disk. Nothing is written when all are answered.
    ///
    /// # Errors
    /// The operating system's.
    pub fn answer(&mut self, answered: usize, seconds: f64) -> Result<(), JournalError> {
        let Some((trial, shown)) = self.next() else { return Ok(()) };
        let given = Given { trial, shown, answered, seconds: (1e3 * seconds).round() / 1e3 };
        self.line(&serde_json::to_string(&given).unwrap_or_default())?;
        self.given.push(given);
        Ok(())
    }

    fn line(&mut self, text: &str) -> Result<(), JournalError> {
        let path = self.path.clone();
        let fail = refused(&path);
        self.file.seek(SeekFrom::End(0)).map_err(&fail)?;
        self.file.write_all(format!("{text}\n").as_bytes()).map_err(&fail)?;
        self.file.sync_data().map_err(&fail)
    }
}

/// Reads a journal without changing it.
///
/// # Errors
/// [`JournalError`].
pub fn read(path: &Path) -> Result<(Session, Vec<Given>), JournalError> {
    let text = std::fs::read_to_string(path).map_err(refused(path))?;
    let whole = text.rfind('\n').map_or(0, |end| end + 1);
    parse(path, &text[..whole])
}

/// True where a text is a journal's.
#[must_use]
pub fn is_journal(text: &str) -> bool {
    text.starts_with(MARK)
}

fn parse(path: &Path, text: &str) -> Result<(Session, Vec<Given>), JournalError> {
    let file = || path.to_owned();
    let mut lines = text.lines().enumerate();
    let Some((_, first)) = lines.next().filter(|(_, line)| is_journal(line)) else {
        return Err(JournalError::Foreign { file: file() });
    };
    let wrong = |line: usize, what: String, expected: &str| JournalError::Line {
        file: file(),
        line: line + 1,
        what,
        expected: expected.to_owned(),
    };
    let session: Session = serde_json::from_str(first)
        .map_err(|cause| wrong(0, cause.to_string(), "subject, stimuli, repeats and order of a session"))?;
    let count = session.stimuli.len();
    if !(2..=MOST_STIMULI).contains(&count) || session.repeats > MOST_REPEATS {
        return Err(wrong(
            0,
            format!("{count} stimuli, {} repeats", session.repeats),
            "2 to 9 stimuli, up to 1000 repeats",
        ));
    }
    if session.order.len() != count * session.repeats || session.order.iter().any(|s| *s >= count) {
        return Err(wrong(
            0,
            "the order does not fit the stimuli".to_owned(),
            "an index of a stimulus for each presentation",
        ));
    }
    let mut given = Vec::new();
    for (at, line) in lines {
        let one: Given = serde_json::from_str(line)
            .map_err(|cause| wrong(at, cause.to_string(), "trial, shown, answered and seconds of an answer"))?;
        if one.trial != at || session.order.get(at - 1) != Some(&one.shown) || one.answered >= count {
            let what = format!("trial {}, shown {}, answered {}", one.trial, one.shown, one.answered);
            return Err(wrong(at, what, "the next trial of the order, and an answer among the stimuli"));
        }
        given.push(one);
    }
    Ok((session, given))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn session() -> Session {
        Session::new(vec!["ICF".into(), "A2".into()], 5, 3, 1)
    }

    #[test]
    fn half_a_line_is_taken_off_and_the_session_goes_on() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new/a.jsonl");
        let mut journal = Journal::open(&path, &session()).unwrap();
        journal.answer(0, 1.5).unwrap();
        journal.answer(1, 0.25).unwrap();
        drop(journal);
        let before = std::fs::read_to_string(&path).unwrap();
        // Wherever the power goes during the third line.
        let third = "{\"trial\":3,\"shown\":0,\"answered\":1,\"seconds\":1.0}\n";
        for cut in 0..third.len() {
            std::fs::write(&path, format!("{before}{}", &third[..cut])).unwrap();
            let journal = Journal::open(&path, &session()).unwrap();
            assert_eq!((journal.given.len(), journal.torn, journal.next().unwrap().0), (2, cut, 3));
            assert_eq!(std::fs::read_to_string(&path).unwrap(), before);
        }
        // And during the first.
        for cut in 0..before.lines().next().unwrap().len() {
            std::fs::write(&path, &before[..cut]).unwrap();
            assert_eq!(Journal::open(&path, &session()).unwrap().next().unwrap().0, 1);
        }
    }

    #[test]
    fn what_is_no_journal_or_another_session_is_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.jsonl");
        for foreign in ["my notes\n", "my notes", "{}\n"] {
            std::fs::write(&path, foreign).unwrap();
            assert!(matches!(Journal::open(&path, &session()).unwrap_err(), JournalError::Foreign { .. }));
            assert_eq!(std::fs::read_to_string(&path).unwrap(), foreign);
        }
        std::fs::remove_file(&path).unwrap();
        drop(Journal::open(&path, &session()).unwrap());
        let other = Session::new(vec!["ICF".into(), "A2".into()], 6, 3, 1);
        let error = Journal::open(&path, &other).unwrap_err().to_string();
        assert!(
            error.contains("shown 5 times each; asked for is one of") && error.contains("shown 6 times"),
            "{error}"
        );
        let _first = Journal::open(&path, &session()).unwrap();
        assert!(matches!(Journal::open(&path, &session()).unwrap_err(), JournalError::Busy { .. }));
    }

    #[test]
    fn a_changed_line_is_told_with_its_number() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.jsonl");
        let mut journal = Journal::open(&path, &session()).unwrap();
        journal.answer(0, 1.0).unwrap();
        drop(journal);
        let text = std::fs::read_to_string(&path).unwrap().replace("\"answered\":0", "\"answered\":7");
        std::fs::write(&path, text).unwrap();
        let error = read(&path).unwrap_err().to_string();
        assert!(
            error.contains("line 2: trial 1, shown") && error.contains("answered 7; expected the next trial"),
            "{error}"
        );
    }
}
