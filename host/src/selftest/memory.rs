//! Arithmetic to the bit, and flash under load.

use firmware::fingerprint::fingerprint;
use firmware::selftest::table;
use protocol::message::Empty;
use protocol::selftest::{Identity, Report, Request};

use super::{Check, SelftestError, Step, Talk};
use crate::link::Link;

/// Longest erase of a sector of 128 KiB by words, ms (STM32F429 data sheet, flash programming).
const ERASE_MS: u32 = 2000;
/// Longest write of a word, us: 100 by the data sheet, and the interrupts meanwhile.
const WORD_US: u32 = 200;
/// Longest time of the identification's test series, ms: 6.7 million instructions are 60 ms at 1.5 clocks each, which is
/// an assumption until a board has run it. Four clocks each would be more.
const COMPUTE_MS: f64 = 150.0;

/// The identification's hashes against this computer's.
pub(super) fn computed<L: Link>(talk: &mut Talk<L>) -> Result<Vec<Check>, SelftestError> {
    let Report::Computed(there) = talk.ask(&Request::Compute(Empty {}), 3.0)? else { return Err(talk.unexpected()) };
    let here = table().and_then(|table| fingerprint(&table));
    let pairs = here.map(|here| {
        [
            ("variance search", there.search == here.search),
            ("fast search", there.profile == here.profile),
            ("Kalman filter", there.filter == here.filter),
            ("filter with offset", there.offset_filter == here.offset_filter),
        ]
    });
    let other: Vec<&str> = pairs.iter().flatten().filter(|(_, same)| !same).map(|(name, _)| *name).collect();
    let found =
        if other.is_empty() { "the bits of this computer".into() } else { format!("other bits: {}", other.join(", ")) };
    let took_ms = f64::from(there.took_us) / 1e3;
    Ok(vec![
        Check::new(
            Step::Arithmetic,
            "identification",
            found,
            "the bits of this computer",
            pairs.is_some() && other.is_empty(),
        ),
        Check::new(
            Step::Arithmetic,
            "time of the identification",
            format!("{took_ms:.1} ms"),
            "below 150 ms",
            took_ms > 0.0 && took_ms < COMPUTE_MS,
        )
        .or_look_at("flash access and clock source above"),
    ])
}

/// Erase and write of bank 2 while the converter runs, the coil is driven and bank 1 is read.
pub(super) fn flash<L: Link>(talk: &mut Talk<L>, identity: &Identity) -> Result<Vec<Check>, SelftestError> {
    let Report::Written(found) = talk.ask_once(&Request::WriteFlash(Empty {}), 10.0)? else {
        return Err(talk.unexpected());
    };
    let new =
        |what: &str, found: String, expected: &str, passed| Check::new(Step::Flash, what, found, expected, passed);
    let after = talk.identify()?;
    Ok(vec![
        new(
            "erase of 128 KiB",
            if found.erase_ms == 0 { "failed".into() } else { format!("{} ms", found.erase_ms) },
            "at most 2000 ms",
            found.erase_ms > 0 && found.erase_ms <= ERASE_MS,
        ),
        new(
            "words read back right",
            format!("{} of {}", found.words_right, found.words),
            "all",
            found.words > 0 && found.words_right == found.words,
        ),
        new(
            "slowest word",
            format!("{} us", found.word_us),
            "at most 200 us",
            found.words > 0 && found.word_us <= WORD_US,
        ),
        new(
            "program read meanwhile",
            format!("{} times, wrong {}", found.reads, found.reads_wrong),
            "never wrong",
            found.reads > 0 && found.reads_wrong == 0,
        ),
        new(
            "readings meanwhile",
            format!("{} ms, lost {}", found.count, found.lost),
            "none lost",
            found.count > 0 && found.lost == 0,
        ),
        new(
            "CRC of the program before and after",
            format!("{:08x}, {:08x}", identity.build.image_crc, after.build.image_crc),
            "the same",
            identity.build.image_crc == after.build.image_crc,
        ),
    ])
}
