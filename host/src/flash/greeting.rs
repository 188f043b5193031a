//! After the writing: does the board that starts run what was written?

use firmware::board::FIRMWARE_VERSION;
use protocol::message::{Hello, ResetCause, Status};

use super::FlashingError;
use crate::link::Link;
use crate::session::{Patience, Session};

/// What a freshly written board says of itself.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Greeted {
    /// Firmware version: major, minor, patch.
    pub firmware_version: [u8; 3],
    /// CRC-32 of the image that runs.
    pub image_crc: u32,
    /// Protocol version.
    pub protocol_version: u16,
    /// Hash of the table in use; zero without one.
    pub table_hash: [u8; 16],
}

/// Patience with a board that has just been restarted: its start takes 0.1 s, the check of a large table and an erase that tidies up some seconds.
const PATIENCE: Patience = Patience { answer_s: 0.5, erase_s: 20.0, attempts: 10, keep_alive_s: 0.2 };

/// Greets the board behind `link` and compares it with this tool, and with the image and the table that were written, if any
/// were.
///
/// # Errors
/// [`FlashingError::Greeting`] when it does not answer or speaks another version of the protocol, [`FlashingError::Started`] for everything else that is
/// not as it should be.
pub fn greet(link: impl Link, image_crc: Option<u32>, table_hash: Option<[u8; 16]>) -> Result<Greeted, FlashingError> {
    let (mut session, hello) = Session::open(link, PATIENCE)?;
    let status = session.status()?;
    compare(&hello, &status, image_crc, table_hash)
}

fn compare(
    hello: &Hello,
    status: &Status,
    image_crc: Option<u32>,
    table_hash: Option<[u8; 16]>,
) -> Result<Greeted, FlashingError> {
    let version = |[major, minor, patch]: [u8; 3]| format!("{major}.{minor}.{patch}");
    let hex = |hash: [u8; 16]| hash.iter().map(|b| format!("{b:02x}")).collect::<String>();
    let differs = |what, found, expected| Err(FlashingError::Started { what, found, expected });
    if hello.firmware_version != FIRMWARE_VERSION {
        return differs("firmware version", version(hello.firmware_version), version(FIRMWARE_VERSION));
    }
    if let Some(expected) = image_crc.filter(|crc| *crc != hello.build.image_crc) {
        return differs("image's CRC", format!("{:08x}", hello.build.image_crc), format!("{expected:08x}"));
    }
    if hello.reset_cause == ResetCause::Watchdog {
        return differs("start", "a reset by the watchdog".into(), "one by the probe".into());
    }
    if let Some(expected) = table_hash.filter(|hash| *hash != status.table_hash) {
        return differs("table", hex(status.table_hash), hex(expected));
    }
    Ok(Greeted {
        firmware_version: hello.firmware_version,
        image_crc: hello.build.image_crc,
        protocol_version: hello.protocol_version,
        table_hash: status.table_hash,
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::link::{InProcess, Pace};
    use crate::plant::Jitter;
    use crate::simulated_board::SimulatedBoard;

    fn said() -> (Hello, Status) {
        let link = InProcess::new(SimulatedBoard::new(1, Jitter::NONE), Pace::Free);
        let (mut session, hello) = Session::open(link, PATIENCE).unwrap();
        let status = session.status().unwrap();
        (hello, status)
    }

    #[test]
    fn a_board_of_this_version_is_greeted() {
        let link = InProcess::new(SimulatedBoard::new(1, Jitter::NONE), Pace::Free);
        let greeted = greet(link, None, None).unwrap();
        assert_eq!((greeted.firmware_version, greeted.table_hash), (FIRMWARE_VERSION, [0; 16]));
    }

    #[test]
    fn what_differs_is_named_with_both_values() {
        let (hello, status) = said();
        let text = |hello: &Hello, table| compare(hello, &status, None, table).unwrap_err().to_string();
        let old = Hello { firmware_version: [0, 0, 9], ..hello.clone() };
        assert_eq!(
            text(&old, None),
            "the board has started, but its firmware version is 0.0.9, expected 0.1.0: is the ELF file that of this tool?"
        );
        let other = compare(&hello, &status, Some(7), None).unwrap_err().to_string();
        assert!(other.contains("its image's CRC is 00000000, expected 00000007"), "{other}");
        let hung = Hello { reset_cause: ResetCause::Watchdog, ..hello.clone() };
        assert!(
            text(&hung, None).starts_with(
                "the board has started, but its start is a reset by the watchdog, expected one by the probe"
            )
        );
        let expected = "the board has started, but its table is 00000000000000000000000000000000, expected 01010101010101010101010101010101";
        assert!(text(&hello, Some([1; 16])).starts_with(expected));
    }
}
