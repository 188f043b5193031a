//! Bytes on the line.

use firmware::link::LinkId;
use palpate::link::{Link, LinkError};
use palpate::session::{Patience, Session};
use protocol::frame::{Decoder, MAX_FRAME, encode, encode_report};
use protocol::message::{FaultReport, Report};

use super::Held;
use super::board::{Portrait, blank_board, check_outputs, inputs};

/// A line from which these bytes come, and into which everything vanishes.
#[derive(Debug)]
pub struct Recorded {
    bytes: std::collections::VecDeque<u8>,
    now_s: f64,
}

impl Recorded {
    /// A line on which `bytes` have arrived.
    pub fn new(bytes: impl IntoIterator<Item = u8>) -> Self {
        Recorded { bytes: bytes.into_iter().collect(), now_s: 0.0 }
    }
}

impl Link for Recorded {
    fn name(&self) -> &str {
        "recorded bytes"
    }

    fn now_s(&self) -> f64 {
        self.now_s
    }

    fn send(&mut self, _: &[u8]) -> Result<(), LinkError> {
        Ok(())
    }

    fn receive(&mut self, into: &mut Vec<u8>, deadline_s: f64) -> Result<(), LinkError> {
        into.extend(self.bytes.drain(..));
        self.now_s = deadline_s;
        Ok(())
    }
}

/// Bytes on the line, in both directions: each accepted frame is one that can be sent, bytes without a sound frame leave the board as it was,
/// and after a zero both sides accept the next frame.
///
/// # Errors
/// What does not hold.
pub fn frames(bytes: &[u8]) -> Held {
    let accepted = parser(bytes)?;
    board(bytes, accepted)?;
    host(bytes)
}

/// The decoder alone; returns how many frames it accepted.
fn parser(bytes: &[u8]) -> Result<usize, String> {
    let (mut decoder, mut accepted, mut last) = (Decoder::new(), 0, (0, 0, Vec::new()));
    for byte in bytes {
        if let Some(Ok(frame)) = decoder.push(*byte) {
            accepted += 1;
            last = (frame.kind, frame.seq, frame.body.to_vec());
            let again = framed(last.0, last.1, &last.2)?;
            if decoded(&again).as_ref() != Some(&last) {
                return Err(format!("frame {last:?} does not survive the line"));
            }
        }
    }
    let probe = framed(0x55, 0xa5a5, b"\0ok")?;
    // A frame that lacks its end alone is whole as soon as the next one begins.
    accepted += usize::from(matches!(decoder.push(0), Some(Ok(_))));
    for byte in probe {
        if let Some(Ok(frame)) = decoder.push(byte) {
            last = (frame.kind, frame.seq, frame.body.to_vec());
        }
    }
    if last != (0x55, 0xa5a5, b"\0ok".to_vec()) {
        return Err("the frame after a zero was not accepted".into());
    }
    Ok(accepted)
}

/// A frame around a body.
///
/// # Errors
/// A body that is too long.
pub(super) fn framed(kind: u8, seq: u16, body: &[u8]) -> Result<Vec<u8>, String> {
    let mut out = [0; MAX_FRAME];
    let fill = |room: &mut [u8]| {
        room.get_mut(..body.len())?.copy_from_slice(body);
        Some(body.len())
    };
    encode(kind, seq, fill, &mut out).map(<[u8]>::to_vec).map_err(|e| format!("{} bytes of body: {e}", body.len()))
}

/// The last frame of some bytes.
fn decoded(bytes: &[u8]) -> Option<(u8, u16, Vec<u8>)> {
    let mut decoder = Decoder::new();
    let mut found = None;
    for byte in bytes {
        if let Some(Ok(frame)) = decoder.push(*byte) {
            found = Some((frame.kind, frame.seq, frame.body.to_vec()));
        }
    }
    found
}

fn board(bytes: &[u8], accepted: usize) -> Held {
    let mut board = blank_board();
    let before = Portrait::of(&mut board)?;
    board.receive(LinkId::Usb, bytes);
    let after = Portrait::of(&mut board)?;
    if accepted == 0 && before != after {
        return Err(format!("bytes without a frame changed the board: {before:?} became {after:?}"));
    }
    check_outputs(&board.tick(&inputs(0.0, 30.0, 0.0)))
}

fn host(bytes: &[u8]) -> Held {
    let known = Report::Fault(FaultReport { tick: 7, fault: 3, value: 1.5, limit: 1.0 });
    let mut out = [0; MAX_FRAME];
    let frame = encode_report(&known, 9, &mut out).map_err(|e| e.to_string())?;
    let line = Recorded::new(bytes.iter().chain(&[0]).chain(frame).copied());
    let mut session = Session::unopened(line, Patience::default());
    let mut last = None;
    while let Some(event) = session.poll(1.0).map_err(|e| e.to_string())? {
        last = Some(event);
    }
    match last {
        Some(palpate::session::Event::Fault(fault)) if Report::Fault(fault.clone()) == known => Ok(()),
        other => Err(format!("the host did not accept the frame after a zero, its last event was {other:?}")),
    }
}
