//! Who are you? Version and schema are checked before anything else is said.

use protocol::PROTOCOL_VERSION;
use protocol::frame::{self, MAX_FRAME};
use protocol::message::{Build, EARLIER, Hello, HelloRequest, Refusal, Report, Request, SCHEMA_HASH, is_known_schema};
use protocol::rescue;

use super::{Incoming, Patience, Session, SessionError};
use crate::link::Link;

/// The commit of a build in words.
#[must_use]
pub fn commit_text(build: &Build) -> String {
    let commit = String::from_utf8_lossy(&build.commit);
    let commit = if commit.starts_with('\0') { "unknown" } else { &*commit };
    format!("commit {commit}{}", if build.modified { ", with changes" } else { "" })
}

impl<L: Link> Session<L> {
    /// Greets the board behind `link`.
    ///
    /// # Errors
    /// [`SessionError::Version`] when board and tool do not speak the same version or were built from different
    /// message tables: the board is then asked once more by the frozen [rescue] message, which every
    /// version answers. [`SessionError::NoAnswer`] when it is silent to both.
    pub fn open(link: L, patience: Patience) -> Result<(Self, Hello), SessionError> {
        let mut session = Session::unopened(link, patience);
        let hello = session.greet()?;
        // What was sent before we listened is not lost to us.
        session.sequence.lost = 0;
        Ok((session, hello))
    }

    /// Greets the board, which switches its telemetry on. One of an earlier table is greeted as a tool of that table: what came
    /// later it refuses as unknown.
    pub(super) fn greet(&mut self) -> Result<Hello, SessionError> {
        let greeting = |schema_hash| Request::Hello(HelloRequest { protocol_version: PROTOCOL_VERSION, schema_hash });
        // Bytes of an earlier conversation may lie in front of our first frame; a zero ends them.
        self.link.send(&[0])?;
        let mut answer = self.request(&greeting(SCHEMA_HASH));
        if let Ok(Report::Hello(hello)) = &answer
            && EARLIER.contains(&hello.schema_hash)
        {
            answer = self.request(&greeting(hello.schema_hash));
        }
        match answer {
            Ok(Report::Hello(hello))
                if hello.protocol_version == PROTOCOL_VERSION && is_known_schema(hello.schema_hash) =>
            {
                Ok(hello)
            }
            Ok(_)
            | Err(SessionError::NoAnswer { .. })
            | Err(SessionError::Refused {
                reason: Refusal::SchemaMismatch | Refusal::Unknown | Refusal::Malformed,
                ..
            }) => match self.rescue()? {
                Some(answer) => Err(SessionError::Version { board: self.link.name().into(), answer }),
                None => answer.and_then(|_| Err(self.no_sense("Hello"))),
            },
            Err(other) => Err(other),
        }
    }

    /// Asks by the frozen message, as often as any request.
    fn rescue(&mut self) -> Result<Option<rescue::Answer>, SessionError> {
        for _ in 0..self.patience.attempts.max(1) {
            let mut buffer = [0u8; MAX_FRAME];
            let seq = self.seq;
            self.seq = self.seq.wrapping_add(1);
            if let Ok(bytes) = frame::encode_body(rescue::KIND, seq, &rescue::QUESTION, &mut buffer) {
                self.link.send(bytes)?;
            }
            let deadline_s = self.link.now_s() + self.patience.answer_s;
            loop {
                while let Some(incoming) = self.arrived.pop_front() {
                    if let Incoming::Rescue(answer) = incoming {
                        return Ok(Some(answer));
                    }
                }
                if self.link.now_s() >= deadline_s {
                    break;
                }
                self.receive(deadline_s)?;
            }
        }
        Ok(None)
    }
}
