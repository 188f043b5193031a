//! PWM to converter over the three wires, and the levels of the driven pins.

use protocol::selftest::{Drive, Measured, Power};

use super::chip::at_rest;
use super::{Check, SelftestError, Step, Talk};
use crate::link::Link;

/// Duties of a wire's test.
const DUTIES: [f32; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// Largest difference of a reading from its duty, of the full scale: 0.5 % of levels and converter (data sheet, output
/// voltage and total unadjusted error), 0.2 % of the converter's load on 10 kOhm, rounded up to what a wrong resistor
/// would exceed.
const LINE: f32 = 0.015;

/// Largest spread of a millisecond's means while a wire is driven, codes: ripple of a filter of 1 ms, and noise.
const RIPPLE: f32 = 8.0;
const CODES: f32 = 4096.0;

/// Level that counts as low at the end of a wire.
const LOW: f32 = 0.01;

/// Analog inputs by name, in the order of the readings.
const INPUTS: [&str; 5] = ["PA3 (A0)", "PC0 (A1)", "PC3 (A2)", "PC2 (A7)", "PB1 (A6)"];

/// A wire: from a driven pin over 10 kOhm, with 100 nF to ground, to an analog input.
struct Wire {
    name: &'static str,
    input: usize,
    drive: fn(f32) -> Drive,
}

const fn display(coil: f32, actuator: f32) -> Drive {
    Drive { power: Power::Display, coil, actuator, arm: 0.0, settle_ms: 60, average_ms: 100 }
}

const WIRES: [Wire; 3] = [
    Wire { name: "PC6 (coil) to PB1", input: 4, drive: |duty| display(duty, 0.0) },
    Wire { name: "PE9 (actuator) to PC3", input: 2, drive: |duty| display(0.0, duty) },
    Wire {
        name: "PD15 (arm's rate) to PC2",
        input: 3,
        drive: |duty| Drive { power: Power::Arm, arm: duty, ..display(0.0, 0.0) },
    },
];

/// Each wire at each duty, then with the power off.
pub(super) fn wires<L: Link>(talk: &mut Talk<L>) -> Result<Vec<Check>, SelftestError> {
    let mut checks = Vec::new();
    for wire in &WIRES {
        let mut seen = Vec::new();
        for duty in DUTIES {
            seen.push(talk.measure((wire.drive)(duty))?);
        }
        checks.push(line(wire, &seen));
    }
    let powerless = Drive { power: Power::Off, ..display(1.0, 1.0) };
    let seen = talk.measure(powerless)?;
    let highest = seen.mean[4].max(seen.mean[2]);
    checks.push(Check::new(
        Step::Wires,
        "coil and actuator at full duty without power",
        format!("{:.1} % of the supply", 100.0 * highest),
        "below 1 %",
        highest < LOW && checks.iter().all(|check| check.outcome == super::Outcome::Passed),
    ));
    Ok(checks)
}

/// Largest difference of an input from the duties.
fn worst(seen: &[Measured], input: usize) -> f32 {
    seen.iter().zip(DUTIES).fold(0.0, |worst: f32, (m, duty)| worst.max((m.mean[input] - duty).abs()))
}

fn line(wire: &Wire, seen: &[Measured]) -> Check {
    let deviation = worst(seen, wire.input);
    let ripple = seen.iter().fold(0.0f32, |a, m| a.max(m.spread[wire.input])) * CODES;
    let elsewhere = (0..INPUTS.len()).find(|input| *input != wire.input && worst(seen, *input) <= LINE);
    let readings: Vec<String> = seen.iter().map(|m| format!("{:.1}", 100.0 * m.mean[wire.input])).collect();
    let mut found = format!("{} % at 0, 25, 50, 75, 100 %, spread {ripple:.1} codes", readings.join(", "));
    if let Some(input) = elsewhere.filter(|_| deviation > LINE) {
        found.push_str(&format!(", {} follows instead", INPUTS[input]));
    } else if deviation > LINE {
        found.push_str(", no input follows");
    }
    let expected = "within 1.5 %, spread below 8 codes";
    Check::new(Step::Wires, wire.name, found, expected, deviation <= LINE && ripple <= RIPPLE)
        .or_look_at("10 kOhm in the wire, 100 nF from the input to ground")
}

/// The driven pins at their pads: high with power and full duty, low in every other case.
pub(super) fn pins<L: Link>(talk: &mut Talk<L>) -> Result<Vec<Check>, SelftestError> {
    let arm = Drive { power: Power::Arm, arm: 1.0, ..display(0.0, 0.0) };
    // Case, what is set, and which of PC6, PE9, PE11, PD15, PD14 are then high.
    let cases = [
        ("coil and actuator forward", display(1.0, 1.0), [true, true, false, false, false]),
        ("actuator reverse", display(0.0, -1.0), [false, false, true, false, false]),
        ("arm", arm, [false, false, false, true, true]),
        ("nothing", at_rest(100), [false; 5]),
        ("full duties without power", Drive { power: Power::Off, ..display(1.0, 1.0) }, [false; 5]),
    ];
    let mut checks = Vec::new();
    for (name, drive, expected) in cases {
        let seen = talk.measure(drive)?;
        let found = named(|pin| seen.high[pin], seen.count);
        let expected = named(|pin| if expected[pin] { seen.count } else { 0 }, seen.count);
        let passed = seen.count > 0 && found == expected;
        checks.push(Check::new(Step::Pins, format!("high with {name}"), found, expected, passed));
    }
    Ok(checks)
}

/// The pins that are seen high, with the time of those that are not always so.
fn named(high: impl Fn(usize) -> u16, of: u16) -> String {
    let pins =
        ["PC6", "PE9", "PE11", "PD15", "PD14"].into_iter().enumerate().filter_map(|(pin, name)| match high(pin) {
            0 => None,
            high if high == of => Some(name.to_owned()),
            high => Some(format!("{name} for {high} of {of} ms")),
        });
    let pins: Vec<String> = pins.collect();
    if pins.is_empty() { "none".into() } else { pins.join(", ") }
}
