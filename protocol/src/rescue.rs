//! The frozen message: any host can ask any board who it is, whatever their versions.
//!
//! It is no part of the table in [`crate::message`], has no postcard encoding, and must never change.
//! It travels in an ordinary frame of kind [`KIND`] (0), so a version that changes the framing
//! must keep answering this one frame.

/// Kind of the rescue frame in both directions.
pub const KIND: u8 = 0x00;

/// Body of the question.
pub const QUESTION: [u8; 5] = *b"PALP?";

/// Length of the answer.
pub const ANSWER_LEN: usize = 14;

/// Who a board is, in 14 bytes: `"PALP!"`, protocol version (u16 LE), firmware version (3 bytes),
/// low half of the schema hash (u32 LE).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Answer {
    /// [`crate::PROTOCOL_VERSION`] of the board.
    pub protocol_version: u16,
    /// Firmware version: major, minor, patch.
    pub firmware_version: [u8; 3],
    /// Low 32 bits of [`crate::message::SCHEMA_HASH`] of the board.
    pub schema_hash_low: u32,
}

impl Answer {
    /// The answer of this build.
    pub const fn of_this_build(firmware_version: [u8; 3]) -> Self {
        Answer {
            protocol_version: crate::PROTOCOL_VERSION,
            firmware_version,
            schema_hash_low: crate::message::SCHEMA_HASH as u32,
        }
    }

    /// The 14 bytes.
    pub fn to_bytes(self) -> [u8; ANSWER_LEN] {
        let [v0, v1] = self.protocol_version.to_le_bytes();
        let [a, b, c] = self.firmware_version;
        let [h0, h1, h2, h3] = self.schema_hash_low.to_le_bytes();
        [b'P', b'A', b'L', b'P', b'!', v0, v1, a, b, c, h0, h1, h2, h3]
    }

    /// Reads an answer; longer bodies are accepted so that a future board may say more.
    pub fn from_bytes(body: &[u8]) -> Option<Self> {
        let [b'P', b'A', b'L', b'P', b'!', v0, v1, a, b, c, h0, h1, h2, h3, ..] = *body else {
            return None;
        };
        Some(Answer {
            protocol_version: u16::from_le_bytes([v0, v1]),
            firmware_version: [a, b, c],
            schema_hash_low: u32::from_le_bytes([h0, h1, h2, h3]),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// These bytes are frozen: a change here cuts off every board in the field.
    #[test]
    fn the_frozen_bytes() {
        let answer = Answer { protocol_version: 0x0201, firmware_version: [3, 4, 5], schema_hash_low: 0x0908_0706 };
        assert_eq!(&answer.to_bytes(), b"PALP!\x01\x02\x03\x04\x05\x06\x07\x08\x09");
        assert_eq!(Answer::from_bytes(&answer.to_bytes()), Some(answer));
        assert_eq!(Answer::from_bytes(b"PALP!\x01\x02\x03\x04\x05\x06\x07\x08\x09 and more"), Some(answer));
        assert_eq!(Answer::from_bytes(b"PALP?"), None);
        assert_eq!(&QUESTION, b"PALP?");
    }
}
