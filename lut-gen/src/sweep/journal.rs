//! The journal of a sweep: what has been solved so far, one record a point.
//!
//! ```text
//! header   "PALJOUR1", u32 length of text, text, u32 CRC-32 of all before
//! record   u32 length of body, body, u32 CRC-32 of length and body
//! body     u32 job, f64 seconds, u8 outcome, then
//!          outcome 0: rates x samples f64; outcome 1: text of the error
//! ```
//! Numbers are little-endian. Records stand in the order in which they were solved; of two for one job the later
//! one counts. A process that is killed while it writes leaves a torn record at the end, which its
//! CRC gives away; what is before it is whole.

use std::collections::BTreeMap;

use crc::{CRC_32_ISO_HDLC, Crc};
use serde::{Deserialize, Serialize};

use super::{Finished, Forces, Shard, SweepSpec};

const MAGIC: &[u8; 8] = b"PALJOUR1";
const CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// Bytes of a body besides forces or text.
const BODY: usize = 13;

/// Longest error text that is kept (bytes).
const LONGEST_TEXT: usize = 2000;

/// Whose journal it is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JournalHead {
    /// What is swept.
    pub spec: SweepSpec,
    /// By what engine, see [`super::engine`].
    pub engine: String,
    /// Which part of it.
    pub shard: Shard,
}

/// A journal as it was read.
#[derive(Debug, Clone, PartialEq)]
pub struct Journal {
    /// Whose it is.
    pub head: JournalHead,
    /// Outcome of every job in it.
    pub outcomes: BTreeMap<usize, Result<Forces, String>>,
    /// Time that all its solves took (s).
    pub seconds: f64,
    /// Bytes up to the end of the last whole record.
    pub whole: usize,
    /// Bytes after it: of a torn record, or damaged.
    pub torn: usize,
}

/// Why bytes are no journal.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum JournalError {
    /// Shorter than its own header; a process was killed as it began. Nothing is lost.
    #[error("the file ends inside its header, after {0} bytes")]
    Begun(usize),
    /// Something else.
    #[error("the file does not begin like the journal of a sweep")]
    Foreign,
    /// The header's CRC is wrong.
    #[error("the header is damaged: its CRC is wrong")]
    Damaged,
    /// The header's text is not understood.
    #[error("the header is of another version: {0}")]
    Version(String),
    /// A whole record that cannot belong to the sweep.
    #[error("record {record} is for point {job} of {jobs}, or not of {forces} forces: another version wrote it")]
    Record {
        /// Counted from 1.
        record: usize,
        /// The job it names.
        job: usize,
        /// Jobs of the sweep.
        jobs: usize,
        /// Forces of a point.
        forces: usize,
    },
}

impl JournalHead {
    /// The bytes a journal begins with.
    #[must_use]
    pub fn bytes(&self) -> Vec<u8> {
        let text = serde_json::to_string(self).unwrap_or_default();
        let mut bytes = MAGIC.to_vec();
        bytes.extend((text.len() as u32).to_le_bytes());
        bytes.extend(text.as_bytes());
        sealed(bytes)
    }

    /// See [`SweepSpec::identity`].
    #[must_use]
    pub fn identity(&self) -> [u8; 32] {
        self.spec.identity(&self.engine)
    }
}

impl Finished {
    /// The record of a journal.
    #[must_use]
    pub fn record(&self) -> Vec<u8> {
        let mut body = Vec::new();
        body.extend((self.job as u32).to_le_bytes());
        body.extend(self.seconds.to_le_bytes());
        match &self.outcome {
            Ok(forces) => {
                body.push(0);
                body.extend(forces.iter().flatten().flat_map(|f| f.to_le_bytes()));
            }
            Err(text) => {
                let mut end = text.len().min(LONGEST_TEXT);
                while !text.is_char_boundary(end) {
                    end -= 1;
                }
                body.push(1);
                body.extend(&text.as_bytes()[..end]);
            }
        }
        let mut bytes = (body.len() as u32).to_le_bytes().to_vec();
        bytes.extend(body);
        sealed(bytes)
    }
}

impl Journal {
    /// Reads a journal. A torn or damaged end is measured and left out.
    ///
    /// # Errors
    /// [`JournalError`] when the header cannot be read or a whole record does not fit to it.
    pub fn parse(bytes: &[u8]) -> Result<Self, JournalError> {
        let (head, mut at) = parse_head(bytes)?;
        let jobs = head.spec.jobs();
        let (rates, samples) = (head.spec.motion.rates_mm_s.len(), head.spec.motion.samples());
        let mut outcomes = BTreeMap::new();
        let mut record = 0;
        let mut seconds = 0.0;
        while let Some((body, end)) = block(bytes, at, at) {
            record += 1;
            let (job, outcome) = parse_body(body, rates, samples);
            match outcome {
                Some(outcome) if job < jobs => outcomes.insert(job, outcome),
                _ => return Err(JournalError::Record { record, job, jobs, forces: rates * samples }),
            };
            seconds += body.get(4..12).and_then(|b| b.try_into().ok()).map_or(0.0, f64::from_le_bytes);
            at = end;
        }
        Ok(Self { head, outcomes, seconds, whole: at, torn: bytes.len() - at })
    }
}

fn sealed(mut bytes: Vec<u8>) -> Vec<u8> {
    let crc = CRC.checksum(&bytes);
    bytes.extend(crc.to_le_bytes());
    bytes
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    let four = bytes.get(at..at.checked_add(4)?)?;
    four.try_into().ok().map(u32::from_le_bytes)
}

/// The text after the length at `at`, if it is whole and the CRC from `from` on agrees; and its end.
fn block(bytes: &[u8], from: usize, at: usize) -> Option<(&[u8], usize)> {
    let length = u32_at(bytes, at)? as usize;
    let end = at.checked_add(4)?.checked_add(length)?;
    let text = bytes.get(at + 4..end)?;
    (CRC.checksum(&bytes[from..end]) == u32_at(bytes, end)?).then_some((text, end + 4))
}

fn parse_head(bytes: &[u8]) -> Result<(JournalHead, usize), JournalError> {
    let start = &bytes[..bytes.len().min(MAGIC.len())];
    if !MAGIC.starts_with(start) {
        return Err(JournalError::Foreign);
    }
    let wanted = u32_at(bytes, MAGIC.len()).map(|length| MAGIC.len() + 8 + length as usize);
    if wanted.is_none_or(|wanted| bytes.len() < wanted) {
        return Err(JournalError::Begun(bytes.len()));
    }
    let (text, end) = block(bytes, 0, MAGIC.len()).ok_or(JournalError::Damaged)?;
    let head: JournalHead = serde_json::from_slice(text).map_err(|e| JournalError::Version(e.to_string()))?;
    head.spec.check().map_err(|e| JournalError::Version(e.to_string()))?;
    Ok((head, end))
}

/// Job and outcome; no outcome where the body does not have the shape of one.
fn parse_body(body: &[u8], rates: usize, samples: usize) -> (usize, Option<Result<Forces, String>>) {
    let job = u32_at(body, 0).map_or(usize::MAX, |j| j as usize);
    let outcome = match (body.get(BODY - 1), body.get(BODY..)) {
        (Some(0), Some(rest)) if rest.len() == 8 * rates * samples => Some(Ok(forces(rest, rates, samples))),
        (Some(1), Some(rest)) => String::from_utf8(rest.to_vec()).ok().map(Err),
        _ => None,
    };
    (job, outcome)
}

/// `rates` curves of `samples` numbers.
pub(super) fn forces(bytes: &[u8], rates: usize, samples: usize) -> Forces {
    let mut numbers = bytes.chunks_exact(8).map(|b| b.try_into().map_or(f64::NAN, f64::from_le_bytes));
    (0..rates).map(|_| numbers.by_ref().take(samples).collect()).collect()
}
