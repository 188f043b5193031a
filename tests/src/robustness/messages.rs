//! Messages in sound frames.

use firmware::flash::BANK_LEN;
use firmware::link::LinkId;
use protocol::frame::MAX_BODY;
use protocol::message::{Report, Request};

use super::board::{board, check_outputs, inputs, reports};
use super::frames::framed;
use super::{Held, seeds};

/// Messages one after the other, each a byte of kind, a byte of length and the body: each decodes to a message that encodes to itself, or to an
/// error; the board carries them out or refuses, breaks no rule of its flash, and its outputs stay within their limits.
///
/// # Errors
/// What does not hold.
pub fn messages(bytes: &[u8]) -> Held {
    let mut bank = vec![0xff; BANK_LEN];
    let table = seeds::small_table();
    bank[..table.len()].copy_from_slice(&table);
    let mut board = board(bank);
    let (mut rest, mut seq) = (bytes, 0u16);
    while let [kind, length, tail @ ..] = rest {
        let (body, after) = tail.split_at(usize::from(*length).min(MAX_BODY).min(tail.len()));
        rest = after;
        decode(*kind, body)?;
        board.receive(LinkId::Usb, &framed(*kind, seq, body)?);
        seq = seq.wrapping_add(1);
        // A finger on the display, and the ball in the air.
        check_outputs(&board.tick(&inputs(0.0, 30.0, 1.0)))?;
        reports(&mut board)?;
    }
    match board.store().rule_violations() {
        0 => Ok(()),
        count => Err(format!("{count} writes or erases that flash cannot do")),
    }
}

/// A body that decodes is a message: encoded and decoded again it is the same, to the bit.
fn decode(kind: u8, body: &[u8]) -> Held {
    let mut first = [0; MAX_BODY];
    let mut second = [0; MAX_BODY];
    // Encoded forms are compared, because a message may hold NaN.
    macro_rules! survives {
        ($set:ident) => {
            if let Ok(message) = $set::decode(kind, body) {
                let first = message.encode(&mut first).map_err(|e| format!("{message:?} does not encode: {e}"))?;
                let again = $set::decode(kind, first).map_err(|e| format!("{message:?} does not decode again: {e}"))?;
                let second = again.encode(&mut second).map_err(|e| format!("{again:?} does not encode: {e}"))?;
                if first != second {
                    return Err(format!("{message:?} became {again:?}"));
                }
            }
        };
    }
    survives!(Request);
    survives!(Report);
    Ok(())
}
