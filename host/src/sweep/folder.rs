//! The folder a sweep is kept in: one journal a shard.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use lut_gen::sweep::{Finished, Journal, JournalError, JournalHead, difference};

use super::SweepError;
use super::journals::{ENDING, journals, listed};

/// How often a journal is flushed to the disk. A killed process loses nothing that it has written;
/// a machine that loses its power loses this much.
const SYNCHRONISED: Duration = Duration::from_secs(2);

/// An opened folder.
#[derive(Debug)]
pub struct Folder {
    /// Writes the journal of the shard.
    pub keeper: Keeper,
    /// Jobs that any journal of the folder has, and whether they are solved.
    pub done: BTreeMap<usize, bool>,
    /// Bytes of a torn record that were cut off the shard's journal.
    pub cut: usize,
}

/// Writes a journal. As long as it lives no other process can.
#[derive(Debug)]
pub struct Keeper {
    file: File,
    path: PathBuf,
    synchronised: Instant,
    /// False where the file system has no locks: then nothing keeps two processes apart.
    pub locked: bool,
}

impl Folder {
    /// Opens the folder of a sweep for one of its shards, made if need be. What is there already is kept.
    ///
    /// # Errors
    /// [`SweepError`]: files that cannot be made, read or written, a journal that another process writes or
    /// that belongs to another sweep or engine, damaged headers.
    pub fn open(folder: &Path, head: &JournalHead) -> Result<Self, SweepError> {
        std::fs::create_dir_all(folder).map_err(SweepError::files("cannot make the folder", folder))?;
        let (index, count) = (head.shard.index(), head.shard.count());
        let width = count.to_string().len();
        let path = folder.join(format!("shard-{index:0width$}-of-{count}.{ENDING}"));
        let (mut keeper, bytes) = Keeper::lock(path)?;
        let (own, cut) = keeper.resume(head, &bytes)?;
        let mut done = BTreeMap::new();
        // The shard's own journal is read through the locked handle: some systems forbid a second one.
        for (path, journal) in std::iter::once((keeper.path.clone(), own)).chain(others(folder, &keeper.path)?) {
            if let Some(difference) = difference(&journal.head, &head.spec, Some(&head.engine)) {
                return Err(SweepError::Other { journal: path, difference });
            }
            for (job, outcome) in journal.outcomes {
                *done.entry(job).or_insert(false) |= outcome.is_ok();
            }
        }
        Ok(Self { keeper, done, cut })
    }
}

fn others(folder: &Path, own: &Path) -> Result<Vec<(PathBuf, Journal)>, SweepError> {
    let mut found = Vec::new();
    for file in listed(folder)?.iter().filter(|file| *file != own) {
        found.extend(journals(file)?.into_iter().map(|f| (f.path, f.journal)));
    }
    Ok(found)
}

impl Keeper {
    fn lock(path: PathBuf) -> Result<(Self, Vec<u8>), SweepError> {
        let mut file = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(&path)
            .map_err(SweepError::files("cannot open", &path))?;
        let locked = match file.try_lock() {
            Ok(()) => true,
            Err(TryLockError::WouldBlock) => return Err(SweepError::Busy(path)),
            // Some network file systems have no locks.
            Err(TryLockError::Error(cause)) if cause.kind() == ErrorKind::Unsupported => false,
            Err(TryLockError::Error(cause)) => return Err(SweepError::files("cannot lock", &path)(cause)),
        };
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(SweepError::files("cannot read", &path))?;
        Ok((Self { file, path, synchronised: Instant::now(), locked }, bytes))
    }

    /// Cuts a torn record off and goes to the end; begins the journal where there is none.
    fn resume(&mut self, head: &JournalHead, bytes: &[u8]) -> Result<(Journal, usize), SweepError> {
        let beginning = head.bytes();
        let whole = match Journal::parse(bytes) {
            Ok(journal) => {
                let (whole, torn) = (journal.whole as u64, journal.torn);
                // Another sweep's journal is refused later, but not touched.
                if torn > 0 && journal.head == *head {
                    self.file.set_len(whole).map_err(SweepError::files("cannot shorten", &self.path))?;
                }
                self.file.seek(SeekFrom::Start(whole)).map_err(SweepError::files("cannot write", &self.path))?;
                return Ok((journal, torn));
            }
            // Only what this very header begins with may be written over.
            Err(JournalError::Begun(_)) if beginning.starts_with(bytes) => Journal::parse(&beginning),
            Err(JournalError::Begun(_)) => Err(JournalError::Damaged),
            Err(cause) => Err(cause),
        };
        let journal = whole.map_err(|cause| SweepError::Journal { journal: self.path.clone(), cause })?;
        self.file
            .seek(SeekFrom::Start(0))
            .and_then(|_| self.file.write_all(&beginning))
            .and_then(|()| self.file.sync_data())
            .map_err(SweepError::files("cannot write", &self.path))?;
        Ok((journal, 0))
    }

    /// The journal.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Adds a record.
    ///
    /// # Errors
    /// [`SweepError::Files`], such as a full disk.
    pub fn keep(&mut self, finished: &Finished) -> Result<(), SweepError> {
        self.file.write_all(&finished.record()).map_err(SweepError::files("cannot write", &self.path))?;
        if self.synchronised.elapsed() >= SYNCHRONISED {
            self.finish()?;
        }
        Ok(())
    }

    /// Makes sure that all records are on the disk.
    ///
    /// # Errors
    /// [`SweepError::Files`].
    pub fn finish(&mut self) -> Result<(), SweepError> {
        self.synchronised = Instant::now();
        self.file.sync_data().map_err(SweepError::files("cannot write", &self.path))
    }
}
