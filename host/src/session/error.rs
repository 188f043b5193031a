//! What can go wrong in a conversation with a board.

use protocol::PROTOCOL_VERSION;
use protocol::lut::TableError;
use protocol::message::Refusal;
use protocol::rescue;

use crate::link::LinkError;

/// A conversation with a board failed.
#[derive(Debug, thiserror::Error)]
pub enum SessionError {
    /// The way to the board failed.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The board did not answer, however often it was asked.
    #[error(
        "no answer from {board} within {waited_ms} ms to {request} ({attempts} attempts, {rejected} damaged frames meanwhile): \
         is the board powered, and is nothing else using the link?"
    )]
    NoAnswer {
        /// The link's name.
        board: String,
        /// The request's name in the table of messages.
        request: &'static str,
        /// Time waited over all attempts, ms of link time.
        waited_ms: u64,
        /// How often it was asked.
        attempts: u32,
        /// Frames that arrived meanwhile and failed their CRC.
        rejected: u64,
    },
    /// The board refused, with its reason.
    #[error("{board} refused {request}: {}", .reason.describe())]
    Refused {
        /// The link's name.
        board: String,
        /// The request's name in the table of messages.
        request: &'static str,
        /// Why.
        reason: Refusal,
    },
    /// Board and tool do not speak the same version.
    #[error("{}", version_text(.board, .answer))]
    Version {
        /// The link's name.
        board: String,
        /// Who the board says it is.
        answer: rescue::Answer,
    },
    /// The table does not pass its checks; nothing was sent.
    #[error("table not sent: {0}")]
    Table(#[from] TableError),
    /// The upload makes no progress.
    #[error("upload to {board} stuck at byte {offset} of {length} after {resumes} resumptions")]
    UploadStuck {
        /// The link's name.
        board: String,
        /// The byte that does not get through.
        offset: u32,
        /// Length of the table.
        length: u32,
        /// Resumptions at this byte.
        resumes: u32,
    },
    /// The board activated something else than what was sent.
    #[error("{board} activated a table with hash {found}, sent was {sent}")]
    WrongTable {
        /// The link's name.
        board: String,
        /// Hash the board reports, hexadecimal.
        found: String,
        /// Hash of the table sent, hexadecimal.
        sent: String,
    },
}

fn version_text(board: &str, answer: &rescue::Answer) -> String {
    let [major, minor, patch] = answer.firmware_version;
    if answer.schema_hash_low == protocol::selftest::SCHEMA_HASH as u32 {
        return format!("{board} runs the self-test program: `palpate flash ELF` puts the firmware back");
    }
    let who = format!("{board} runs firmware {major}.{minor}.{patch}");
    if answer.protocol_version == PROTOCOL_VERSION {
        format!(
            "{who}, built from another message table (schema {:08x}, this tool {:08x}): \
             write the firmware that belongs to this tool with `palpate flash`",
            answer.schema_hash_low,
            protocol::message::SCHEMA_HASH as u32,
        )
    } else if answer.protocol_version < PROTOCOL_VERSION {
        format!(
            "{who} with protocol version {}, this tool speaks version {PROTOCOL_VERSION}: \
             write newer firmware with `palpate flash`",
            answer.protocol_version,
        )
    } else {
        format!(
            "{who} with protocol version {}, this tool speaks version {PROTOCOL_VERSION}: use a newer palpate",
            answer.protocol_version,
        )
    }
}
