//! After the writing: does the board that starts run what was written?

use std::time::{Duration, Instant};

use firmware::board::FIRMWARE_VERSION;
use protocol::message::{Hello, ResetCause, Status};

use super::FlashingError;
use crate::link::{Link, LinkError};
use crate::session::{Patience, Session, SessionError};

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

/// Longest wait for the port of a board that has just been restarted: USB goes away with the reset and is enumerated anew, which takes a
/// second or two, and longer behind a hub or while another program looks at the new port.
const PORT: Duration = Duration::from_secs(5);

/// Between two attempts to open it.
const ATTEMPTS: Duration = Duration::from_millis(100);

/// What was written, as the board will tell it; `None` where nothing was.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Expected {
    /// CRC-32 of the image ([`super::Firmware::crc`]).
    pub image_crc: Option<u32>,
    /// Hash of the table.
    pub table_hash: Option<[u8; 16]>,
}

/// Greets the board whose link `opener` opens, and compares it with this tool and with what was written. A link that
/// cannot be opened yet, or is still the one from before the reset, is tried again for 5 s.
///
/// # Errors
/// [`FlashingError::Greeting`] when it does not answer or speaks another version of the protocol, [`FlashingError::Started`] for everything
/// else that is not as it should be.
pub fn greet<L: Link>(
    opener: impl FnMut() -> Result<L, LinkError>,
    expected: &Expected,
) -> Result<Greeted, FlashingError> {
    greet_within(PORT, opener, expected)
}

fn greet_within<L: Link>(
    port: Duration,
    mut opener: impl FnMut() -> Result<L, LinkError>,
    expected: &Expected,
) -> Result<Greeted, FlashingError> {
    let began = Instant::now();
    loop {
        let told = opener().map_err(SessionError::from).and_then(|link| {
            let (mut session, hello) = Session::open(link, PATIENCE)?;
            Ok((hello, session.status()?))
        });
        match told {
            Ok((hello, status)) => return compare(&hello, &status, expected),
            Err(SessionError::Link(_)) if began.elapsed() < port => std::thread::sleep(ATTEMPTS),
            Err(error) => return Err(error.into()),
        }
    }
}

fn compare(hello: &Hello, status: &Status, expected: &Expected) -> Result<Greeted, FlashingError> {
    let version = |[major, minor, patch]: [u8; 3]| format!("{major}.{minor}.{patch}");
    let hex = |hash: [u8; 16]| hash.iter().map(|b| format!("{b:02x}")).collect::<String>();
    let differs = |what, found, expected| Err(FlashingError::Started { what, found, expected });
    if hello.firmware_version != FIRMWARE_VERSION {
        return differs("firmware version", version(hello.firmware_version), version(FIRMWARE_VERSION));
    }
    if let Some(expected) = expected.image_crc.filter(|crc| *crc != hello.build.image_crc) {
        return differs("image's CRC", format!("{:08x}", hello.build.image_crc), format!("{expected:08x}"));
    }
    if hello.reset_cause == ResetCause::Watchdog {
        return differs("start", "a reset by the watchdog".into(), "one by the probe".into());
    }
    if let Some(expected) = expected.table_hash.filter(|hash| *hash != status.table_hash) {
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

    fn link() -> InProcess {
        InProcess::new(SimulatedBoard::new(1, Jitter::NONE), Pace::Free)
    }

    fn no_port() -> LinkError {
        LinkError::Open { link: "serial:/dev/ttyACM1".into(), source: std::io::ErrorKind::NotFound.into() }
    }

    #[test]
    fn a_board_of_this_version_is_greeted() {
        let greeted = greet(|| Ok(link()), &Expected::default()).unwrap();
        assert_eq!((greeted.firmware_version, greeted.table_hash), (FIRMWARE_VERSION, [0; 16]));
    }

    /// The port from before the reset: it opens, and is gone with the first word.
    struct Stale(InProcess);

    impl Link for Stale {
        fn name(&self) -> &str {
            "serial:/dev/ttyACM1"
        }
        fn now_s(&self) -> f64 {
            self.0.now_s()
        }
        fn send(&mut self, _: &[u8]) -> Result<(), LinkError> {
            Err(LinkError::Closed { link: "serial:/dev/ttyACM1".into() })
        }
        fn receive(&mut self, into: &mut Vec<u8>, deadline_s: f64) -> Result<(), LinkError> {
            self.0.receive(into, deadline_s)
        }
    }

    #[test]
    fn a_port_that_comes_back_after_the_reset_is_waited_for() {
        let mut attempt = 0;
        let opener = || -> Result<Box<dyn Link>, LinkError> {
            attempt += 1;
            match attempt {
                1 => Ok(Box::new(Stale(link()))),
                2..5 => Err(no_port()),
                _ => Ok(Box::new(link())),
            }
        };
        assert_eq!(greet(opener, &Expected::default()).unwrap().firmware_version, FIRMWARE_VERSION);
        assert_eq!(attempt, 5);
    }

    #[test]
    fn a_port_that_stays_away_is_named() {
        let began = Instant::now();
        let error = greet_within(Duration::from_millis(250), || Err::<InProcess, _>(no_port()), &Expected::default())
            .unwrap_err();
        assert!(began.elapsed() >= Duration::from_millis(250));
        let text = error.to_string();
        assert!(text.starts_with("written and verified, but cannot open serial:/dev/ttyACM1: "), "{text}");
    }

    #[test]
    fn what_differs_is_named_with_both_values() {
        let (hello, status) = said();
        let text = |hello: &Hello, table_hash| {
            compare(hello, &status, &Expected { table_hash, ..Expected::default() }).unwrap_err().to_string()
        };
        let old = Hello { firmware_version: [0, 0, 9], ..hello.clone() };
        assert_eq!(
            text(&old, None),
            "the board has started, but its firmware version is 0.0.9, expected 0.1.0: is the ELF file that of this tool?"
        );
        let other = Expected { image_crc: Some(7), ..Expected::default() };
        let other = compare(&hello, &status, &other).unwrap_err().to_string();
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
