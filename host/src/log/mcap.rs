//! MCAP: JSON messages with their JSON schema, uncompressed chunks, no longer than [`super::KEEP_S`].

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use mcap::records::{MessageHeader, Metadata};
use mcap::write::NoSeek;
use mcap::{McapError, WriteOptions, Writer};
use protocol::fault::Fault;
use protocol::message::{FaultReport, Telemetry};
use serde::Serialize;
use serde_json::{Map, Value, json};

use super::whole::{WholeFile, all_or_nothing};
use super::{About, At, LogError};
use crate::session::{Gap, Traffic, cause_text, gap_text};

/// A stream of messages in the log.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Channel {
    /// Telemetry with the counters of lost frames and records.
    Telemetry,
    /// Ends of palpations.
    Verdict,
    /// Latched faults, in words.
    Fault,
    /// True physics of a simulated board.
    Truth,
    /// Results of the Kalman filter.
    Estimate,
    /// Stretches in which the board was not heard: when they begin, and how they ended.
    Gap,
    /// What palpation and display do, where they are asked for by themselves.
    Halves,
}

impl Channel {
    /// Every channel.
    pub const ALL: [Channel; 7] = [
        Channel::Telemetry,
        Channel::Verdict,
        Channel::Fault,
        Channel::Truth,
        Channel::Estimate,
        Channel::Gap,
        Channel::Halves,
    ];

    /// Name in the file.
    pub const fn topic(self) -> &'static str {
        match self {
            Channel::Telemetry => "telemetry",
            Channel::Verdict => "verdict",
            Channel::Fault => "fault",
            Channel::Truth => "truth",
            Channel::Estimate => "estimate",
            Channel::Gap => "gap",
            Channel::Halves => "halves",
        }
    }
}

/// An MCAP log. `log_time` is the host's wall clock, `publish_time` the board's time since its start, which goes on by the host's
/// clock when the board restarts; both in ns. A metadata record named `palpate` says whose recording it is.
pub struct McapLog {
    path: PathBuf,
    /// `None` once a write has failed: the file then ends after the last complete chunk.
    writer: Option<Writer<NoSeek<WholeFile>>>,
    /// The same file, to wait for the disk.
    file: File,
    /// Number in the file and next sequence number of each channel that has had a message.
    channels: [Option<(u16, u32)>; Channel::ALL.len()],
}

impl std::fmt::Debug for McapLog {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("McapLog").field("path", &self.path).finish_non_exhaustive()
    }
}

impl McapLog {
    /// Writes the header to a new file.
    ///
    /// # Errors
    /// [`LogError`].
    pub fn new(path: PathBuf, file: File) -> Result<Self, LogError> {
        let second = file.try_clone().map_err(|source| LogError::File { path: path.clone(), source })?;
        // Without seeking a chunk is written in one piece when it is closed: a killed process
        // leaves whole chunks and at most one torn one at the end.
        let writer = WriteOptions::new()
            .compression(None)
            .disable_seeking(true)
            .profile("")
            .library(concat!("palpate ", env!("CARGO_PKG_VERSION")))
            .create(NoSeek::new(WholeFile::new(file, all_or_nothing)))
            .map_err(|e| mcap_error(&path, e))?;
        Ok(McapLog { path, writer: Some(writer), file: second, channels: [None; Channel::ALL.len()] })
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes whose recording it is.
    ///
    /// # Errors
    /// [`LogError`].
    pub fn about(&mut self, about: &About) -> Result<(), LogError> {
        let Some(writer) = &mut self.writer else { return Ok(()) };
        let record = Metadata { name: "palpate".into(), metadata: about.entries().clone() };
        let written = writer.write_metadata(&record);
        self.kept(written)
    }

    /// Writes one message at a time of the recording.
    ///
    /// # Errors
    /// [`LogError`].
    pub fn write(&mut self, channel: Channel, at: At, message: &impl Serialize) -> Result<(), LogError> {
        let value = serde_json::to_value(message)
            .map_err(|e| LogError::Mcap { path: self.path.clone(), reason: e.to_string() })?;
        self.write_value(channel, at, &value)
    }

    /// Writes a telemetry record with the counters of that moment.
    ///
    /// # Errors
    /// [`LogError`].
    pub fn telemetry(&mut self, at: At, record: &Telemetry, traffic: &Traffic) -> Result<(), LogError> {
        let mut value = json!(record);
        if let Value::Object(fields) = &mut value {
            fields.insert("frames_lost".into(), traffic.frames_lost.into());
            fields.insert("telemetry_lost".into(), traffic.telemetry_lost.into());
        }
        self.write_value(Channel::Telemetry, at, &value)
    }

    /// Writes a fault with its code and words.
    ///
    /// # Errors
    /// [`LogError`].
    pub fn fault(&mut self, at: At, report: &FaultReport) -> Result<(), LogError> {
        let code = Fault::from_bit(report.fault).map_or("unknown", Fault::code);
        let value = json!({
            "tick": report.tick, "code": code, "value": report.value, "limit": report.limit,
            "text": crate::session::fault_text(report),
        });
        self.write_value(Channel::Fault, at, &value)
    }

    /// Writes that nothing is heard any more, and why.
    ///
    /// # Errors
    /// [`LogError`].
    pub fn gap_begins(&mut self, at: At, why: &str) -> Result<(), LogError> {
        let value = json!({
            "over": false, "text": why, "silent_s": null, "after_tick": null, "uptime_s": null, "cause": "", "link_lost": why,
        });
        self.write_value(Channel::Gap, at, &value)
    }

    /// Writes how a gap ended.
    ///
    /// # Errors
    /// [`LogError`].
    pub fn gap(&mut self, at: At, gap: &Gap) -> Result<(), LogError> {
        let value = json!({
            "over": true, "text": gap_text(gap), "silent_s": gap.silent_s, "after_tick": gap.after_tick,
            "uptime_s": gap.uptime_s, "cause": gap.restarted.map_or("", cause_text),
            "link_lost": gap.link_lost.as_deref().unwrap_or_default(),
        });
        self.write_value(Channel::Gap, at, &value)
    }

    fn write_value(&mut self, channel: Channel, at: At, value: &Value) -> Result<(), LogError> {
        let Some(writer) = &mut self.writer else { return Ok(()) };
        let written = write_message(writer, &mut self.channels[channel as usize], channel, at, value);
        self.kept(written)
    }

    /// After an error nothing is written any more, not even the summary of a writer that is dropped.
    fn kept(&mut self, written: Result<(), McapError>) -> Result<(), LogError> {
        written.map_err(|error| {
            self.writer.take().map(Writer::into_inner);
            mcap_error(&self.path, error)
        })
    }

    /// Closes the chunk and writes it; with `sync` waits until it is on the disk.
    ///
    /// # Errors
    /// [`LogError`].
    pub fn keep(&mut self, sync: bool) -> Result<(), LogError> {
        let Some(writer) = &mut self.writer else { return Ok(()) };
        let flushed = writer.flush();
        self.kept(flushed)?;
        self.sync(sync)
    }

    fn sync(&self, wanted: bool) -> Result<(), LogError> {
        let synced = if wanted { self.file.sync_data() } else { Ok(()) };
        synced.map_err(|source| LogError::File { path: self.path.clone(), source })
    }

    /// Writes the summary that ends the file.
    ///
    /// # Errors
    /// [`LogError`].
    pub fn finish(mut self) -> Result<(), LogError> {
        let Some(mut writer) = self.writer.take() else { return Ok(()) };
        let written = writer.finish().and_then(|_| Ok(writer.into_inner().into_inner().flush()?));
        self.kept(written)?;
        self.sync(true)
    }
}

fn write_message(
    writer: &mut Writer<NoSeek<WholeFile>>,
    state: &mut Option<(u16, u32)>,
    channel: Channel,
    at: At,
    value: &Value,
) -> Result<(), McapError> {
    let (channel_id, sequence) = match *state {
        Some(known) => known,
        None => {
            let schema = schema_of(value).to_string();
            let schema_id = writer.add_schema(channel.topic(), "jsonschema", schema.as_bytes())?;
            (writer.add_channel(schema_id, channel.topic(), "json", &BTreeMap::new())?, 0)
        }
    };
    *state = Some((channel_id, sequence.wrapping_add(1)));
    let publish_time = (at.board_s.max(0.0) * 1e9).round() as u64;
    let header = MessageHeader { channel_id, sequence, log_time: at.wall_ns, publish_time };
    writer.write_to_known_channel(&header, value.to_string().as_bytes())
}

fn mcap_error(path: &Path, error: McapError) -> LogError {
    match error {
        McapError::Io(source) => LogError::File { path: path.into(), source },
        other => LogError::Mcap { path: path.into(), reason: other.to_string() },
    }
}

/// JSON schema of messages shaped like `value`; a number that is not finite is written as null.
fn schema_of(value: &Value) -> Value {
    match value {
        Value::Object(fields) => {
            let properties: Map<String, Value> = fields.iter().map(|(name, v)| (name.clone(), schema_of(v))).collect();
            json!({"type": "object", "properties": properties})
        }
        Value::Array(items) => {
            json!({"type": "array", "items": items.first().map_or(json!({}), schema_of)})
        }
        Value::String(_) => json!({"type": "string"}),
        Value::Bool(_) => json!({"type": "boolean"}),
        Value::Number(_) | Value::Null => json!({"type": "number"}),
    }
}
