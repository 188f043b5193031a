//! Reading an MCAP log, also one whose writer was killed.

use std::path::Path;

use mcap::read::{MessageStream, Options};
use serde_json::Value;

use super::LogError;

/// What a log still holds.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Recovered {
    /// Topic, board time in s, and content of every message, in the order of the file.
    pub messages: Vec<(String, f64, Value)>,
    /// Why reading ended before the proper end of the file; `None` for a finished log.
    pub torn: Option<String>,
}

/// Reads every complete message of an MCAP log.
///
/// # Errors
/// [`LogError`] when the file cannot be read or does not begin as MCAP. A torn end is no error.
pub fn recover_mcap(path: &Path) -> Result<Recovered, LogError> {
    let bytes = std::fs::read(path).map_err(|source| LogError::File { path: path.into(), source })?;
    let broken = |reason: String| LogError::Mcap { path: path.into(), reason };
    if !bytes.starts_with(mcap::MAGIC) {
        return Err(broken("not an MCAP file".into()));
    }
    // The end magic is asked for below, as the sign of a finished file; here it would hide the messages.
    let stream =
        MessageStream::new_with_options(&bytes, Options::IgnoreEndMagic.into()).map_err(|e| broken(e.to_string()))?;
    let mut recovered = Recovered::default();
    for message in stream {
        match message {
            Ok(message) => {
                let value =
                    serde_json::from_slice(&message.data).map_err(|e| broken(format!("a message is not JSON: {e}")))?;
                recovered.messages.push((message.channel.topic.clone(), message.publish_time as f64 * 1e-9, value));
            }
            Err(error) => {
                recovered.torn = Some(error.to_string());
                break;
            }
        }
    }
    if recovered.torn.is_none() && !bytes.ends_with(mcap::MAGIC) {
        recovered.torn = Some("the file ends without its summary".into());
    }
    Ok(recovered)
}
