//! Frames: `COBS( kind, seq (u16 LE), body, CRC-32 (LE) ) 0x00`.
//!
//! COBS keeps the zero byte out of the frame, so a receiver that has lost its place is in step again
//! at the next zero. The CRC (CRC-32/ISO-HDLC, as postcard's) covers kind, sequence number and body.
//! Each side numbers its frames; a gap is counted as loss.

use crc::{CRC_32_ISO_HDLC, Crc, Table};

/// The CRC of frames and tables: CRC-32/ISO-HDLC, 16-entry-per-nibble table kept small for the board.
pub const CRC32: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);

/// Bytes of a frame besides its body, before COBS: kind, sequence number, CRC.
pub const OVERHEAD: usize = 1 + 2 + 4;

/// Longest body.
pub const MAX_BODY: usize = 240;

/// Longest frame before COBS.
pub const MAX_RAW: usize = MAX_BODY + OVERHEAD;

/// Longest encoded frame with its terminating zero: COBS adds one byte in 254, and one.
pub const MAX_FRAME: usize = MAX_RAW + MAX_RAW / 254 + 2;

/// A frame's content, borrowed from the decoder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Frame<'a> {
    /// Kind of message: [`crate::message`], or 0 for [`crate::rescue`].
    pub kind: u8,
    /// Sender's frame counter, wraps.
    pub seq: u16,
    /// Body.
    pub body: &'a [u8],
}

/// Why bytes between two zeros are not a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum FrameError {
    /// More bytes than a frame can have.
    TooLong,
    /// Fewer bytes than a frame must have.
    TooShort,
    /// Not COBS.
    BadCobs,
    /// CRC does not match.
    BadCrc,
}

impl core::fmt::Display for FrameError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            FrameError::TooLong => "frame longer than the protocol allows",
            FrameError::TooShort => "frame shorter than the protocol allows",
            FrameError::BadCobs => "frame is not COBS",
            FrameError::BadCrc => "frame fails its CRC-32: bytes were changed on the line",
        })
    }
}

impl core::error::Error for FrameError {}

/// Why a message does not fit a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BodyTooLong;

impl core::fmt::Display for BodyTooLong {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "message body longer than {MAX_BODY} bytes")
    }
}

impl core::error::Error for BodyTooLong {}

/// Encodes a frame around a body that `fill` writes; returns the bytes to send.
///
/// # Errors
/// [`BodyTooLong`] when `fill` fails for want of room.
pub fn encode(
    kind: u8,
    seq: u16,
    fill: impl FnOnce(&mut [u8]) -> Option<usize>,
    out: &mut [u8; MAX_FRAME],
) -> Result<&[u8], BodyTooLong> {
    let mut raw = [0u8; MAX_RAW];
    raw[0] = kind;
    raw[1..3].copy_from_slice(&seq.to_le_bytes());
    let body_len = fill(&mut raw[3..3 + MAX_BODY]).filter(|n| *n <= MAX_BODY).ok_or(BodyTooLong)?;
    let end = 3 + body_len;
    let crc = CRC32.checksum(&raw[..end]);
    raw[end..end + 4].copy_from_slice(&crc.to_le_bytes());
    // `out` has room for the worst case of COBS by the definition of MAX_FRAME.
    let n = cobs::try_encode(&raw[..end + 4], &mut out[..MAX_FRAME - 1]).map_err(|_| BodyTooLong)?;
    out[n] = 0;
    Ok(&out[..=n])
}

/// Encodes a frame around a body that is there already; see [`encode`].
///
/// # Errors
/// [`BodyTooLong`] when it is longer than [`MAX_BODY`].
pub fn encode_body<'o>(kind: u8, seq: u16, body: &[u8], out: &'o mut [u8; MAX_FRAME]) -> Result<&'o [u8], BodyTooLong> {
    let fill = |room: &mut [u8]| {
        room.get_mut(..body.len())?.copy_from_slice(body);
        Some(body.len())
    };
    encode(kind, seq, fill, out)
}

/// Encodes one message of either direction; see [`encode`].
macro_rules! encode_message {
    ($($(#[$doc:meta])* $function:ident($set:ty);)*) => {$(
        $(#[$doc])*
        ///
        /// # Errors
        /// [`BodyTooLong`] when the body does not fit; no message of the table does that.
        pub fn $function<'o>(message: &$set, seq: u16, out: &'o mut [u8; MAX_FRAME]) -> Result<&'o [u8], BodyTooLong> {
            encode(message.kind(), seq, |b| message.encode(b).ok().map(|used| used.len()), out)
        }
    )*};
}

encode_message! {
    /// Frames a request.
    encode_request(crate::message::Request);
    /// Frames a report.
    encode_report(crate::message::Report);
    /// Frames a request to the self-test program.
    encode_selftest_request(crate::selftest::Request);
    /// Frames an answer of the self-test program.
    encode_selftest_report(crate::selftest::Report);
}

/// Collects bytes and hands out frames. Garbage costs at most the frame it falls into.
#[derive(Debug, Clone)]
pub struct Decoder {
    buffer: [u8; MAX_FRAME],
    len: usize,
    /// Too many bytes without a zero: skip to the next zero.
    skipping: bool,
}

impl Default for Decoder {
    fn default() -> Self {
        Self::new()
    }
}

impl Decoder {
    /// An empty decoder.
    pub const fn new() -> Self {
        Decoder { buffer: [0; MAX_FRAME], len: 0, skipping: false }
    }

    /// Takes one byte. `None` until a zero ends a run of bytes; an empty run is not an error.
    pub fn push(&mut self, byte: u8) -> Option<Result<Frame<'_>, FrameError>> {
        if byte != 0 {
            match self.buffer.get_mut(self.len) {
                Some(slot) if !self.skipping => {
                    *slot = byte;
                    self.len += 1;
                }
                _ => self.skipping = true,
            }
            return None;
        }
        let len = core::mem::take(&mut self.len);
        if core::mem::take(&mut self.skipping) {
            return Some(Err(FrameError::TooLong));
        }
        if len == 0 {
            return None;
        }
        Some(check(&mut self.buffer, len))
    }
}

fn check(buffer: &mut [u8; MAX_FRAME], len: usize) -> Result<Frame<'_>, FrameError> {
    let n = match cobs::decode_in_place(&mut buffer[..len]) {
        Ok(n) => n,
        Err(_) => return Err(FrameError::BadCobs),
    };
    if n < OVERHEAD {
        return Err(FrameError::TooShort);
    }
    let (content, tail) = buffer[..n].split_at(n - 4);
    let mut sent = [0u8; 4];
    sent.copy_from_slice(tail);
    if CRC32.checksum(content) != u32::from_le_bytes(sent) {
        return Err(FrameError::BadCrc);
    }
    let [kind, s0, s1, body @ ..] = content else {
        return Err(FrameError::TooShort);
    };
    Ok(Frame { kind: *kind, seq: u16::from_le_bytes([*s0, *s1]), body })
}

/// Counts frames that never arrived, from the gaps in their sequence numbers.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct LossCounter {
    next: Option<u16>,
    /// Frames received.
    pub received: u64,
    /// Frames lost.
    pub lost: u64,
}

impl LossCounter {
    /// Takes the sequence number of a received frame; returns how many were lost before it.
    pub fn see(&mut self, seq: u16) -> u16 {
        let gap = self.next.map_or(0, |next| seq.wrapping_sub(next));
        self.next = Some(seq.wrapping_add(1));
        self.received += 1;
        self.lost += u64::from(gap);
        gap
    }

    /// How many frames [`see`](Self::see) would count as lost before one with this sequence number.
    #[must_use]
    pub fn gap_before(&self, seq: u16) -> u16 {
        self.next.map_or(0, |next| seq.wrapping_sub(next))
    }

    /// The sender has begun to count anew: no frame is missing before its next one.
    pub fn begin_again(&mut self) {
        self.next = None;
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use proptest::prelude::*;

    fn frame(kind: u8, seq: u16, body: &[u8]) -> Vec<u8> {
        encode_body(kind, seq, body, &mut [0; MAX_FRAME]).unwrap().to_vec()
    }

    /// All frames a decoder finds in `bytes`, and how many runs of bytes it rejected.
    fn decode_all(bytes: &[u8]) -> (Vec<(u8, u16, Vec<u8>)>, usize) {
        let mut decoder = Decoder::new();
        let (mut good, mut bad) = (vec![], 0);
        for byte in bytes {
            match decoder.push(*byte) {
                Some(Ok(f)) => good.push((f.kind, f.seq, f.body.to_vec())),
                Some(Err(_)) => bad += 1,
                None => {}
            }
        }
        (good, bad)
    }

    #[test]
    fn longest_body_fits_and_one_more_byte_does_not() {
        let body = [0xff; MAX_BODY];
        let (good, _) = decode_all(&frame(1, 2, &body));
        assert_eq!(good, [(1, 2, body.to_vec())]);
        let mut out = [0; MAX_FRAME];
        assert_eq!(encode(1, 2, |_| Some(MAX_BODY + 1), &mut out), Err(BodyTooLong));
    }

    #[test]
    fn a_run_of_bytes_longer_than_a_frame_is_one_error_and_the_next_frame_is_read() {
        let mut bytes = vec![7; 3 * MAX_FRAME];
        bytes.push(0);
        bytes.extend(frame(5, 6, b"after"));
        let (good, bad) = decode_all(&bytes);
        assert_eq!(good, [(5, 6, b"after".to_vec())]);
        assert_eq!(bad, 1);
    }

    #[test]
    fn loss_is_the_gap_in_sequence_numbers_across_the_wrap() {
        let mut loss = LossCounter::default();
        for seq in [65533, 65534, 1, 2, 4] {
            loss.see(seq);
        }
        // 65535, 0 and 3 never came.
        assert_eq!((loss.received, loss.lost), (5, 3));
    }

    proptest! {
        #[test]
        fn a_frame_survives_and_garbage_before_it_costs_nothing_but_itself(
            garbage in prop::collection::vec(any::<u8>(), 0..600),
            kind: u8, seq: u16,
            body in prop::collection::vec(any::<u8>(), 0..=MAX_BODY),
        ) {
            // A zero ends whatever the garbage began: what comes after is read whatever came before.
            let mut bytes = garbage;
            bytes.push(0);
            bytes.extend(frame(kind, seq, &body));
            let (good, _) = decode_all(&bytes);
            prop_assert_eq!(good.last(), Some(&(kind, seq, body)));
        }

        #[test]
        fn random_bytes_never_make_a_frame(bytes in prop::collection::vec(any::<u8>(), 0..2000)) {
            // Not a law but a CRC of 32 bit: one chance in 4e9 a run.
            prop_assert!(decode_all(&bytes).0.is_empty());
        }
    }
}
