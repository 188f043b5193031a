//! Chip, supply, clock, converter and links.

use protocol::message::Build;
use protocol::selftest::{Drive, ECHO_LEN, Echo, Identity, Power, Report, Request};

use super::{Check, SelftestError, Step, Talk};
use crate::link::Link;

/// Device code of F42x and F43x (RM0090 section 38.6.1).
const DEVICE: u16 = 0x419;
/// Revision code from which USB and tables in bank 2 go together (ES0206 section 2.2.11).
const REVISION_3: u16 = 0x2001;
/// Flash of an STM32F429ZI, KiB.
const FLASH_KIB: u16 = 2048;
/// Bits of the brown-out level in the option control register; level 3 is none of them set (RM0090 table 17).
const BROWN_OUT: u32 = 0b1100;
/// Supply of the NUCLEO: 3.3 V within 2 % of its regulator and 1 % of the chip's calibration, V.
const SUPPLY_V: (f64, f64) = (3.2, 3.4);
/// Difference of the board's clock from this computer's: the UART works up to 2 %; a link's delay is 20 ms of 2 s.
const CLOCK: f64 = 0.015;
/// The clock source as it should be.
const EXTERNAL: &str = "8 MHz of the ST-LINK";
/// Mean length of readings for clock and converter, ms.
const LONG_MS: u16 = 2000;
/// Difference of the rate of readings from 1 kHz: a reading more or less of 2000.
const RATE: f64 = 0.002;
/// Noise of a millisecond's mean at rest, codes: 16 readings of at most 5 (data sheet, total unadjusted error), and what an
/// open input picks up.
const NOISE: f32 = 20.0;
/// Codes of the converter.
const CODES: f32 = 4096.0;
/// Echoes, bytes of each from none to the longest.
const ECHOES: usize = 50;

/// Nothing driven, for so long.
pub(super) const fn at_rest(average_ms: u16) -> Drive {
    Drive { power: Power::Off, coil: 0.0, actuator: 0.0, arm: 0.0, settle_ms: 100, average_ms }
}

/// What the chip says of itself.
pub(super) fn chip(identity: &Identity) -> Vec<Check> {
    let new = |what: &str, found: String, expected: &str, passed| Check::new(Step::Chip, what, found, expected, passed);
    let Build { commit, modified, image_crc } = &identity.build;
    let commit = if commit[0] == 0 { "unknown".into() } else { String::from_utf8_lossy(commit).into_owned() };
    let changed = if *modified { ", with changes" } else { "" };
    let program = format!("commit {commit}{changed}, CRC {image_crc:08x}");
    let supply_v = 3.3 * f64::from(identity.reference_at_3v3) / f64::from(identity.reference.max(1));
    let supply = match identity.reference {
        0 => "no reading, the converter does not convert".into(),
        _ => format!("{supply_v:.2} V"),
    };
    let level = 3 - ((identity.options & BROWN_OUT) >> 2);
    vec![
        new("program", program.clone(), &program, true),
        new("device", format!("{:#x}", identity.device), "0x419", identity.device == DEVICE)
            .or_look_at("this is no STM32F42x"),
        new("revision", format!("{:#x}", identity.revision), "0x2001 or more", identity.revision >= REVISION_3)
            .or_look_at("on this chip USB stays off"),
        new("flash", format!("{} KiB", identity.flash_kib), "2048 KiB", identity.flash_kib == FLASH_KIB),
        new(
            "clock source",
            if identity.external_clock { EXTERNAL } else { "internal" }.into(),
            EXTERNAL,
            identity.external_clock,
        )
        .or_look_at("the solder bridge of MCO"),
        new(
            "supply by the internal reference",
            supply,
            "3.20 to 3.40 V",
            (SUPPLY_V.0..=SUPPLY_V.1).contains(&supply_v),
        )
        .or_look_at("jumper JP3 and the cable's supply"),
        new(
            "voltage detector",
            if identity.supply_low { "below 2.9 V" } else { "above 2.9 V" }.into(),
            "above 2.9 V",
            !identity.supply_low,
        ),
        new("brown-out level", level.to_string(), "3", level == 3).or_look_at("palpate flash --setup sets it"),
    ]
}

/// The board's second against this computer's.
pub(super) fn clock<L: Link>(talk: &mut Talk<L>) -> Result<Vec<Check>, SelftestError> {
    let first = talk.measure(at_rest(20))?;
    let began_s = talk.now_s();
    let second = talk.measure(at_rest(LONG_MS))?;
    let here_s = talk.now_s() - began_s;
    let there_s = second.uptime_us.saturating_sub(first.uptime_us) as f64 / 1e6;
    let off = there_s / here_s.max(1e-3) - 1.0;
    Ok(vec![Check::new(
        Step::Chip,
        "clock against this computer's",
        format!("{:+.2} % over {here_s:.1} s", 100.0 * off),
        "within 1.5 %",
        off.abs() <= CLOCK,
    )])
}

/// Rate and losses of the readings.
pub(super) fn converter<L: Link>(talk: &mut Talk<L>) -> Result<Vec<Check>, SelftestError> {
    let rest = talk.measure(at_rest(LONG_MS))?;
    let rate = f64::from(rest.count) / f64::from(rest.took_us.max(1)) * 1e6;
    let noise = rest.spread.iter().fold(0.0f32, |a, b| a.max(*b)) * CODES;
    Ok(vec![
        Check::new(
            Step::Converter,
            "rate of the readings",
            format!("{rate:.1} a second"),
            "1000 within 0.2 %",
            (rate / 1e3 - 1.0).abs() <= RATE,
        ),
        Check::new(Step::Converter, "lost readings", rest.lost.to_string(), "none", rest.lost == 0),
        Check::new(
            Step::Converter,
            "largest noise of a millisecond's mean",
            format!("{noise:.2} codes"),
            "below 20 codes",
            noise < NOISE,
        ),
    ])
}

/// Bytes there and back, of every length and value.
pub(super) fn echo<L: Link>(talk: &mut Talk<L>, name: &str) -> Result<Vec<Check>, SelftestError> {
    let mut right = 0;
    for number in 0..ECHOES {
        let length = number * ECHO_LEN / (ECHOES - 1);
        let value = |i: usize| (i * 37 + number * 11) as u8;
        let bytes: heapless::Vec<u8, ECHO_LEN> = (0..length).map(value).collect();
        let sent = Echo { bytes };
        match talk.ask(&Request::Repeat(sent.clone()), 0.5) {
            Ok(Report::Echo(back)) if back == sent => right += 1,
            Ok(_) | Err(SelftestError::NoAnswer { .. }) => {}
            Err(error) => return Err(error),
        }
    }
    let found = format!("{right} of {ECHOES} came back as sent");
    Ok(vec![Check::new(Step::Links, name, found, "all, 0 to 200 bytes", right == ECHOES)])
}
