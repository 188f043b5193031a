//! MCAP: JSON messages with their JSON schema, uncompressed chunks, no longer than [`super::KEEP_S`].

use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};

use mcap::records::MessageHeader;
use mcap::{McapError, WriteOptions, Writer};
use protocol::fault::Fault;
use protocol::message::{FaultReport, Telemetry};
use serde::Serialize;
use serde_json::{Map, Value, json};

use super::LogError;
use crate::session::Traffic;

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
}

impl Channel {
    /// Every channel.
    pub const ALL: [Channel; 5] =
        [Channel::Telemetry, Channel::Verdict, Channel::Fault, Channel::Truth, Channel::Estimate];

    /// Name in the file.
    pub const fn topic(self) -> &'static str {
        match self {
            Channel::Telemetry => "telemetry",
            Channel::Verdict => "verdict",
            Channel::Fault => "fault",
            Channel::Truth => "truth",
            Channel::Estimate => "estimate",
        }
    }
}

/// An MCAP log. Times in the file are board time since start, ns.
pub struct McapLog {
    path: PathBuf,
    file: File,
    writer: Writer<BufWriter<File>>,
    /// Number in the file and next sequence number of each channel that has had a message.
    channels: [Option<(u16, u32)>; Channel::ALL.len()],
}

impl std::fmt::Debug for McapLog {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("McapLog").field("path", &self.path).finish_non_exhaustive()
    }
}

impl McapLog {
    /// Makes the file and writes its header.
    ///
    /// # Errors
    /// [`LogError`].
    pub fn create(path: &Path) -> Result<Self, LogError> {
        let failed = |source| LogError::File { path: path.into(), source };
        let file = File::create(path).map_err(failed)?;
        let out = BufWriter::new(file.try_clone().map_err(failed)?);
        // Without seeking a chunk is written in one piece when it is closed: a killed process
        // leaves whole chunks and at most one torn one at the end.
        let writer = WriteOptions::new()
            .compression(None)
            .disable_seeking(true)
            .profile("")
            .library(concat!("palpate ", env!("CARGO_PKG_VERSION")))
            .create(out)
            .map_err(|e| mcap_error(path, &e))?;
        Ok(McapLog { path: path.into(), file, writer, channels: [None; Channel::ALL.len()] })
    }

    /// Writes one message at a board time.
    ///
    /// # Errors
    /// [`LogError`].
    pub fn write(&mut self, channel: Channel, board_s: f64, message: &impl Serialize) -> Result<(), LogError> {
        let value = serde_json::to_value(message)
            .map_err(|e| LogError::Mcap { path: self.path.clone(), reason: e.to_string() })?;
        self.write_value(channel, board_s, &value)
    }

    /// Writes a telemetry record with the counters of that moment.
    ///
    /// # Errors
    /// [`LogError`].
    pub fn telemetry(&mut self, board_s: f64, record: &Telemetry, traffic: &Traffic) -> Result<(), LogError> {
        let mut value = json!(record);
        if let Value::Object(fields) = &mut value {
            fields.insert("frames_lost".into(), traffic.frames_lost.into());
            fields.insert("telemetry_lost".into(), traffic.telemetry_lost.into());
        }
        self.write_value(Channel::Telemetry, board_s, &value)
    }

    /// Writes a fault with its code and words.
    ///
    /// # Errors
    /// [`LogError`].
    pub fn fault(&mut self, board_s: f64, report: &FaultReport) -> Result<(), LogError> {
        let code = Fault::from_bit(report.fault).map_or("unknown", Fault::code);
        let value = json!({
            "tick": report.tick, "code": code, "value": report.value, "limit": report.limit,
            "text": crate::session::fault_text(report),
        });
        self.write_value(Channel::Fault, board_s, &value)
    }

    fn write_value(&mut self, channel: Channel, board_s: f64, value: &Value) -> Result<(), LogError> {
        let failed = |e: McapError| mcap_error(&self.path, &e);
        let (channel_id, sequence) = match self.channels[channel as usize] {
            Some(known) => known,
            None => {
                let schema = schema_of(value).to_string();
                let schema_id =
                    self.writer.add_schema(channel.topic(), "jsonschema", schema.as_bytes()).map_err(failed)?;
                let id =
                    self.writer.add_channel(schema_id, channel.topic(), "json", &BTreeMap::new()).map_err(failed)?;
                (id, 0)
            }
        };
        self.channels[channel as usize] = Some((channel_id, sequence.wrapping_add(1)));
        let time = (board_s.max(0.0) * 1e9).round() as u64;
        let header = MessageHeader { channel_id, sequence, log_time: time, publish_time: time };
        self.writer.write_to_known_channel(&header, value.to_string().as_bytes()).map_err(failed)
    }

    /// Closes the chunk and writes it; with `sync` waits until it is on the disk.
    ///
    /// # Errors
    /// [`LogError`].
    pub fn keep(&mut self, sync: bool) -> Result<(), LogError> {
        self.writer.flush().map_err(|e| mcap_error(&self.path, &e))?;
        if sync {
            self.file.sync_data().map_err(|source| LogError::File { path: self.path.clone(), source })?;
        }
        Ok(())
    }

    /// Writes the summary that ends the file.
    ///
    /// # Errors
    /// [`LogError`].
    pub fn finish(mut self) -> Result<(), LogError> {
        self.writer.finish().map_err(|e| mcap_error(&self.path, &e))?;
        self.file.sync_data().map_err(|source| LogError::File { path: self.path.clone(), source })
    }
}

fn mcap_error(path: &Path, error: &McapError) -> LogError {
    LogError::Mcap { path: path.into(), reason: error.to_string() }
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
