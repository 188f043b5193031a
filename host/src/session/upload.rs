//! Upload of a look-up table in chunks, continued after loss.

use protocol::frame::CRC32;
use protocol::lut::{Table, TableError};
use protocol::message::{CHUNK_LEN, Empty, Refusal, Report, Request, TableBegin, TableChunk, TableState};

use super::{Session, SessionError};
use crate::link::Link;

/// How far an upload is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// Bytes the board has.
    pub sent: u32,
    /// Bytes of the table.
    pub length: u32,
}

/// Resumptions without a byte of progress before an upload counts as stuck.
const RESUMES: u32 = 5;

impl<L: Link> Session<L> {
    /// Sends a table and activates it. An upload that an earlier conversation left half done is continued where
    /// the board says it stopped.
    ///
    /// # Errors
    /// [`SessionError::Table`] when the table does not pass its checks (nothing is sent then),
    /// [`SessionError::UploadStuck`] when the link loses too much, [`SessionError::Refused`] with the board's
    /// reason, and as [`Session::request`].
    pub fn upload(&mut self, table: &[u8], mut progress: impl FnMut(Progress)) -> Result<TableState, SessionError> {
        let checked = Table::parse(table)?;
        let length = checked.bytes().len() as u32;
        if table.len() as u32 != length {
            return Err(TableError::Truncated { expected: length, found: table.len() as u32 }.into());
        }
        let hash = checked.hash();
        let state = self.table_state(&Request::TableQuery(Empty {}))?;
        let resumable = state.length == length && state.next_offset > 0;
        if resumable {
            // The unfinished upload may have been of another table: then the board's check at the end fails,
            // and this one is sent from its first byte.
            match self.send_from(table, state.next_offset, &mut progress) {
                Err(SessionError::Refused { reason: Refusal::TableRejected | Refusal::OutOfOrder, .. }) => {}
                other => return self.activated(other?, hash),
            }
        }
        let begin = TableBegin { length, crc: CRC32.checksum(table) };
        let state = self.table_state(&Request::TableBegin(begin))?;
        let done = self.send_from(table, state.next_offset, &mut progress)?;
        self.activated(done, hash)
    }

    /// Sends bytes as a table without checking them first: what the board makes of a host it cannot trust.
    ///
    /// # Errors
    /// As [`Session::upload`]; a board accepts nothing but a sound table.
    pub fn upload_unchecked(&mut self, bytes: &[u8]) -> Result<TableState, SessionError> {
        let begin = TableBegin { length: bytes.len() as u32, crc: CRC32.checksum(bytes) };
        let state = self.table_state(&Request::TableBegin(begin))?;
        self.send_from(bytes, state.next_offset, &mut |_| {})
    }

    fn activated(&self, state: TableState, sent: [u8; 16]) -> Result<TableState, SessionError> {
        if state.hash == sent {
            return Ok(state);
        }
        let hex = |hash: [u8; 16]| hash.iter().map(|b| format!("{b:02x}")).collect::<String>();
        Err(SessionError::WrongTable { board: self.link.name().into(), found: hex(state.hash), sent: hex(sent) })
    }

    /// Sends everything from `offset` on, then commits.
    fn send_from(
        &mut self,
        table: &[u8],
        mut offset: u32,
        progress: &mut impl FnMut(Progress),
    ) -> Result<TableState, SessionError> {
        let length = table.len() as u32;
        let mut resumes = 0;
        while offset < length {
            progress(Progress { sent: offset, length });
            let from = offset as usize;
            let piece = &table[from..table.len().min(from + CHUNK_LEN)];
            let mut data = heapless::Vec::new();
            // A piece has at most CHUNK_LEN bytes, the capacity of the vector.
            let _ = data.extend_from_slice(piece);
            match self.table_state(&Request::TableChunk(TableChunk { offset, data })) {
                Ok(state) => {
                    resumes = 0;
                    offset = state.next_offset;
                }
                // The board is elsewhere than we think, or was silent: ask where to continue.
                Err(SessionError::NoAnswer { .. } | SessionError::Refused { reason: Refusal::OutOfOrder, .. })
                    if resumes < RESUMES =>
                {
                    resumes += 1;
                    let state = self.table_state(&Request::TableQuery(Empty {}))?;
                    if state.length != length {
                        return Err(SessionError::Refused {
                            board: self.link.name().into(),
                            request: "TableChunk",
                            reason: Refusal::OutOfOrder,
                        });
                    }
                    offset = state.next_offset;
                }
                Err(SessionError::NoAnswer { .. }) => {
                    return Err(SessionError::UploadStuck { board: self.link.name().into(), offset, length, resumes });
                }
                Err(other) => return Err(other),
            }
        }
        progress(Progress { sent: length, length });
        let repeated = self.traffic.requests_repeated;
        match self.table_state(&Request::TableCommit(Empty {})) {
            // A repeated commit finds no upload if only the answer to the first one was lost; the hash tells.
            Err(SessionError::Refused { reason: Refusal::OutOfOrder, .. })
                if self.traffic.requests_repeated > repeated =>
            {
                self.table_state(&Request::TableQuery(Empty {}))
            }
            other => other,
        }
    }

    fn table_state(&mut self, request: &Request) -> Result<TableState, SessionError> {
        match self.request(request)? {
            Report::TableState(state) => Ok(state),
            _ => Err(self.no_sense("TableQuery")),
        }
    }
}
