//! Chip, supply, clock, converter and links.

use protocol::selftest::{Drive, ECHO_LEN, Echo, Identity, Power, Report, Request};

use super::{Check, SelftestError, Step, Talk};
use crate::link::Link;
use crate::session::commit_text;

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
/// Longest delay of an answer on its way, s.
const DELAY_S: f64 = 0.2;
/// The flash's access as the firmware sets it (docs/decisions/0009).
const ACCELERATOR: &str = "prefetch on, instruction cache on, data cache off";
/// Mean length of readings for clock and converter, ms.
const LONG_MS: u16 = 2000;
/// Difference of the rate of readings from 1 kHz: a reading more or less of 2000.
const RATE: f64 = 0.002;
/// Inputs with a wire: PC3, PC2, PB1.
const WIRED: [usize; 3] = [2, 3, 4];
/// Noise of a millisecond's mean of 16 readings at rest, codes: a reading is off by at most 5 (data sheet, total unadjusted
/// error).
const NOISE: f32 = 8.0;
/// Codes of the converter.
const CODES: f32 = 4096.0;
/// Echoes, bytes of each from none to the longest.
const ECHOES: usize = 50;

/// Nothing driven, for so long.
pub(super) const fn at_rest(average_ms: u16) -> Drive {
    Drive { power: Power::Off, coil: 0.0, actuator: 0.0, arm: 0.0, settle_ms: 100, average_ms }
}

/// Which program runs: compared where it was written by this test.
pub(super) fn program(identity: &Identity, image_crc: Option<u32>) -> Check {
    let found = &identity.build.image_crc;
    let what = format!("program of {}, CRC {found:08x}", commit_text(&identity.build));
    match image_crc {
        Some(written) => Check::new(
            Step::Chip,
            what,
            format!("{found:08x}"),
            format!("{written:08x}, as written"),
            *found == written,
        ),
        None => Check::not_tested(Step::Chip, what, "--flash compares it with its file"),
    }
}

/// What the chip says of itself.
pub(super) fn chip(identity: &Identity) -> Vec<Check> {
    let new = |what: &str, found: String, expected: &str, passed| Check::new(Step::Chip, what, found, expected, passed);
    let supply_v = 3.3 * f64::from(identity.reference_at_3v3) / f64::from(identity.reference.max(1));
    let supply = match identity.reference {
        0 => "no reading, the converter does not convert".into(),
        _ => format!("{supply_v:.2} V"),
    };
    let level = 3 - ((identity.options & BROWN_OUT) >> 2);
    vec![
        new("device", format!("{:#x}", identity.device), "0x419", identity.device == DEVICE)
            .or_look_at("this is no STM32F42x"),
        new("revision", format!("{:#x}", identity.revision), "0x2001 or more", identity.revision >= REVISION_3)
            .or_look_at("on this chip USB stays off"),
        new("size of the flash", format!("{} KiB", identity.flash_kib), "2048 KiB", identity.flash_kib == FLASH_KIB),
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
            "flash access",
            accelerator(identity.flash_access),
            ACCELERATOR,
            accelerator(identity.flash_access) == ACCELERATOR,
        ),
        new("brown-out level", level.to_string(), "3", level == 3).or_look_at("palpate flash --setup sets it"),
    ]
}

/// What hides the flash's wait states (RM0090 section 3.9.1); the data cache stays off.
fn accelerator(access: u32) -> String {
    let word = |bit: u32| if access >> bit & 1 != 0 { "on" } else { "off" };
    format!("prefetch {}, instruction cache {}, data cache {}", word(8), word(9), word(10))
}

/// The board has not started anew since it was first asked.
pub(super) fn no_reset<L: Link>(
    talk: &mut Talk<L>,
    first: &Identity,
    began_s: f64,
) -> Result<Vec<Check>, SelftestError> {
    let now = talk.identify()?;
    let here_s = talk.now_s() - began_s;
    let there_s = now.uptime_us as f64 / 1e6 - first.uptime_us as f64 / 1e6;
    Ok(vec![Check::new(
        Step::Chip,
        "time since the first answer",
        format!("{there_s:.1} s by the board"),
        format!("{here_s:.1} s as by this computer: no reset"),
        (there_s - here_s).abs() <= CLOCK * here_s + DELAY_S,
    )])
}

/// The board's second against this computer's.
pub(super) fn clock<L: Link>(talk: &mut Talk<L>) -> Result<Vec<Check>, SelftestError> {
    let first = talk.measure(at_rest(20))?;
    let began_s = talk.now_s();
    let second = talk.measure(at_rest(LONG_MS))?;
    let here_s = talk.now_s() - began_s;
    let there_s = second.uptime_us.saturating_sub(first.uptime_us) as f64 / 1e6;
    let deviation = there_s / here_s.max(1e-3) - 1.0;
    Ok(vec![Check::new(
        Step::Chip,
        "clock against this computer's",
        format!("{:+.2} % over {here_s:.1} s", 100.0 * deviation),
        "within 1.5 %",
        deviation.abs() <= CLOCK,
    )])
}

/// Rate and losses of the readings.
pub(super) fn converter<L: Link>(talk: &mut Talk<L>) -> Result<Vec<Check>, SelftestError> {
    let rest = talk.measure(at_rest(LONG_MS))?;
    let rate = f64::from(rest.count) / f64::from(rest.took_us.max(1)) * 1e6;
    let noise = WIRED.iter().fold(0.0f32, |most, input| most.max(rest.spread[*input])) * CODES;
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
            "noise of a millisecond's mean at the wires",
            format!("{noise:.2} codes"),
            "below 8 codes",
            noise < NOISE,
        ),
        Check::not_tested(Step::Converter, "PA3 and PC0", "they have no wire"),
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
        match talk.ask_once(&Request::Repeat(sent.clone()), 0.5) {
            Ok(Report::Echo(back)) if back == sent => right += 1,
            Ok(_) | Err(SelftestError::NoAnswer { .. }) => {}
            Err(error) => return Err(error),
        }
    }
    let found = format!("{right} of {ECHOES} came back as sent");
    Ok(vec![Check::new(Step::Links, name, found, "all, 0 to 200 bytes", right == ECHOES)])
}
