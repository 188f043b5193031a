//! The file a user writes for `palpate simulate` about a display.

use std::path::Path;

use crate::experiment::ExperimentError;
use crate::experiment::section::{Document, Section};

use super::{DisplayEffect, DisplayNoise, DisplayRun, DisplaySpec, Subject};

/// A specification with a comment at every key (`palpate simulate --example-display`).
pub const EXAMPLE: &str = include_str!("example.toml");

const SUBJECTS: [(&str, Subject); 5] = [
    ("position", Subject::Position),
    ("force", Subject::Force),
    ("coil", Subject::Coil),
    ("pulp", Subject::Pulp),
    ("fluid", Subject::Fluid),
];
/// What a finger is pressed to at most, and a coil takes.
const MOST_MM: f64 = 4.0;
const MOST_A: f64 = 2.7;

/// True for a specification of a display: it says `test = "display"` before its first table.
#[must_use]
pub fn is_display(text: &str) -> bool {
    let table: Option<toml::Table> = text.parse().ok();
    table.is_some_and(|t| t.get("test").and_then(toml::Value::as_str) == Some("display"))
}

/// Reads a specification that is already in memory; `file` is where it would be.
///
/// # Errors
/// The first mistake found, with file, line and column.
pub fn parse(file: &Path, text: &str) -> Result<DisplaySpec, ExperimentError> {
    let document = Document { file, text };
    let root = document.table()?;
    let root = Section::new(document, "the file".to_owned(), 0..0, root.get_ref());
    root.only(&["name", "seed", "test", "run", "noise", "effect"])?;
    root.word("test", &[("display", ())])?.ok_or_else(|| root.missing("test", "\"display\""))?;
    let name = root.text("name", "a text in quotes")?.unwrap_or("simulated display");
    let seed = root.integer("seed", 0..=i64::MAX, "a whole number from 0")?.unwrap_or(1);
    let mut spec = DisplaySpec::new(name, seed.unsigned_abs());
    let sections = root.array("run")?;
    if sections.is_empty() {
        return Err(root.missing("run", "at least one [[run]] with subject and values"));
    }
    spec.runs = sections.iter().map(run).collect::<Result<_, _>>()?;
    if let Some(section) = root.section("noise", "[noise]".to_owned())? {
        spec.noise = noise(&section)?;
    }
    spec.effects = root.array("effect")?.iter().map(effect).collect::<Result<_, _>>()?;
    Ok(spec)
}

fn run(section: &Section<'_>) -> Result<DisplayRun, ExperimentError> {
    section.only(&["subject", "values", "hold_s", "ramp_s", "replicates", "current_A", "gap_mm", "hold_out"])?;
    let subject = section.word("subject", &SUBJECTS)?;
    let subject = subject
        .ok_or_else(|| section.missing("subject", "\"position\", \"force\", \"coil\", \"pulp\" or \"fluid\""))?;
    let (most, expected) = match subject {
        Subject::Position => (20.0, "a list of positions of 0 to 20 mm"),
        Subject::Force => (30.0, "a list of loads of 0 to 30 N"),
        Subject::Coil => (MOST_A, CURRENTS),
        Subject::Pulp | Subject::Fluid => (MOST_MM, "a list of places of 0 to 4 mm"),
    };
    let values = section.numbers("values", expected)?.ok_or_else(|| section.missing("values", expected))?;
    if let Some(value) = section.value("values")
        && (values.is_empty() || values.len() > 1000 || values.iter().any(|v| !(0.0..=most).contains(v)))
    {
        return Err(section.bad("values", value, expected));
    }
    let current_a = currents(section, subject, values.len())?;
    let hold_s = section.number("hold_s", 0.0..=600.0, "a time of 0 to 600 s")?.unwrap_or(1.0);
    let ramp_s = section.number("ramp_s", 0.0..=600.0, "a time of 0 to 600 s")?.unwrap_or(0.0);
    let replicates = section.integer("replicates", 1..=100, "a whole number from 1 to 100")?.unwrap_or(3);
    let one = DisplayRun {
        subject,
        values,
        hold_s,
        ramp_s,
        replicates: usize::try_from(replicates).unwrap_or(1),
        current_a,
        gap_mm: section.number("gap_mm", 0.2..=10.0, "a gap of 0.2 to 10 mm")?.unwrap_or(1.0),
        hold_out: section.flag("hold_out")?.unwrap_or(false),
    };
    match section.value("values") {
        Some(value) if !(0.1..=1200.0).contains(&one.length_s()) => {
            Err(section.bad("values", value, "values that take 0.1 to 1200 s with their hold_s and ramp_s"))
        }
        _ => Ok(one),
    }
}

const CURRENTS: &str = "a list of currents of 0 to 2.7 A";

/// One current a value; of a fluid only.
fn currents(section: &Section<'_>, subject: Subject, values: usize) -> Result<Vec<f64>, ExperimentError> {
    const KEY: &str = "current_A";
    let expected = format!("{CURRENTS}, one a value of a fluid's run");
    let found = section.numbers(KEY, &expected)?;
    let is_fluid = subject == Subject::Fluid;
    match (found, section.value(KEY)) {
        (Some(found), _) if is_fluid && found.len() == values && found.iter().all(|a| (0.0..=MOST_A).contains(a)) => {
            Ok(found)
        }
        (_, Some(value)) => Err(section.bad(KEY, value, &expected)),
        _ if is_fluid => Err(section.missing(KEY, &expected)),
        _ => Ok(Vec::new()),
    }
}

fn noise(section: &Section<'_>) -> Result<DisplayNoise, ExperimentError> {
    section.only(&[
        "position_mm",
        "force_share",
        "current_A",
        "flux_T",
        "finger_N",
        "finger_mm",
        "correlation_s",
        "gain_jitter",
        "heavy_tails",
    ])?;
    let usual = DisplayNoise::default();
    let of = |key: &str, most: f64, usual: f64| -> Result<f64, ExperimentError> {
        Ok(section.number(key, 0.0..=most, &format!("a number of 0 to {most}"))?.unwrap_or(usual))
    };
    Ok(DisplayNoise {
        position_mm: of("position_mm", 5.0, usual.position_mm)?,
        force_share: of("force_share", 0.5, usual.force_share)?,
        current_a: of("current_A", 1.0, usual.current_a)?,
        flux_t: of("flux_T", 0.1, usual.flux_t)?,
        finger_n: of("finger_N", 1.0, usual.finger_n)?,
        finger_mm: of("finger_mm", 1.0, usual.finger_mm)?,
        correlation_s: of("correlation_s", 100.0, usual.correlation_s)?,
        gain_jitter: of("gain_jitter", 0.2, usual.gain_jitter)?,
        heavy_tails: section.flag("heavy_tails")?.unwrap_or(false),
    })
}

/// Codes, with the keys of each: name, least, largest value, the value where it may be left out.
type Keys = &'static [(&'static str, f64, f64, Option<f64>)];

const EFFECTS: [(&str, Keys); 22] = [
    ("delay", &[("delay_s", 0.0, 1.0, None)]),
    ("rate-limit", &[("mm_per_s", 0.1, 1000.0, None)]),
    ("stiction", &[("friction_mm", 0.0, 10.0, Some(0.0)), ("play_mm", 0.0, 10.0, Some(0.0))]),
    (
        "sensor-creep",
        &[
            ("per_decade", -0.5, 0.5, Some(0.0)),
            ("half_width", 0.0, 0.5, Some(0.0)),
            ("amplitude", -0.9, 2.0, Some(0.0)),
            ("tau_s", 0.01, 1000.0, Some(1.0)),
        ],
    ),
    ("sensor-nonlinearity", &[("power", 0.3, 3.0, None)]),
    ("coil-heating", &[("J_per_K", 0.5, 1e4, None)]),
    ("saturation", &[("limit_T", 0.01, 10.0, None)]),
    ("remanence", &[("remanence_T", 0.0, 0.5, None), ("coercive_A", 0.01, 5.0, Some(0.5))]),
    ("gap", &[("offset_mm", -0.15, 10.0, None)]),
    ("pulp-size", &[("ratio", 0.3, 3.0, None)]),
    ("pulp-relaxation", &[("part", 0.0, 0.9, None), ("tau_s", 0.01, 100.0, Some(0.5))]),
    ("yield-law", &[("most_kPa", 0.1, 100.0, None)]),
    ("fluid-rest", &[("kPa", 0.0, 5.0, None)]),
    ("fluid-viscosity", &[("kPa_s_per_mm", 0.0, 2.0, None)]),
    ("fluid-response", &[("seconds", 0.0, 10.0, None)]),
    ("outside-ridges", &[("part", 0.0, 1.0, None), ("pitch_mm", 0.1, 5.0, Some(0.5))]),
    ("outside-cup", &[("part", 0.0, 10.0, None)]),
    ("outside-ripple", &[("amplitude_mm", 0.0, 5.0, None), ("pitch_mm", 0.1, 50.0, Some(2.0))]),
    ("outside-wobble", &[("share", 0.0, 1.0, None), ("frequency_hz", 0.2, 20.0, Some(4.0))]),
    ("outside-viscous", &[("seconds", 0.0, 1.0, None)]),
    ("outside-clip", &[("current_A", 0.01, 10.0, None)]),
    ("outside-eddy", &[("seconds", 0.0, 10.0, None)]),
];

fn effect(section: &Section<'_>) -> Result<DisplayEffect, ExperimentError> {
    let all = EFFECTS;
    let (code, keys) = section
        .word("code", &all.iter().map(|one| (one.0, *one)).collect::<Vec<_>>())?
        .ok_or_else(|| section.missing("code", "the code of an effect, such as \"rate-limit\""))?;
    let known: Vec<&str> = std::iter::once("code").chain(keys.iter().map(|k| k.0)).collect();
    section.only(&known)?;
    let mut values = Vec::new();
    for (key, low, high, usual) in keys {
        let expected = format!("a number of {low} to {high}");
        let found = section.number(key, *low..=*high, &expected)?.or(*usual);
        values.push(found.ok_or_else(|| section.missing(key, &expected))?);
    }
    let (a, b) = (values[0], values.get(1).copied().unwrap_or(0.0));
    Ok(match code {
        "delay" => DisplayEffect::Delay { seconds: a },
        "rate-limit" => DisplayEffect::RateLimit { mm_per_s: a },
        "stiction" if b > 0.0 => DisplayEffect::Backlash { mm: b },
        "stiction" => DisplayEffect::Stiction { mm: a },
        "sensor-creep" if b > 0.0 => DisplayEffect::Hysteresis { half_width: b },
        "sensor-creep" if values[2] != 0.0 => DisplayEffect::Memory { amplitude: values[2], tau_s: values[3] },
        "sensor-creep" => DisplayEffect::Creep { per_decade: a },
        "sensor-nonlinearity" => DisplayEffect::Nonlinearity { power: a },
        "coil-heating" => DisplayEffect::Heating { j_per_k: a },
        "saturation" => DisplayEffect::Saturation { tesla: a },
        "remanence" => DisplayEffect::Remanence { tesla: a, ampere: b },
        "gap" => DisplayEffect::Gap { mm: a },
        "pulp-size" => DisplayEffect::PulpSize { ratio: a },
        "pulp-relaxation" => DisplayEffect::PulpRelaxation { part: a, tau_s: b },
        "yield-law" => DisplayEffect::YieldLaw { most_kpa: a },
        "fluid-rest" => DisplayEffect::FluidRest { kpa: a },
        "fluid-viscosity" => DisplayEffect::FluidViscosity { kpa_s_per_mm: a },
        "fluid-response" => DisplayEffect::FluidResponse { seconds: a },
        "outside-ridges" => DisplayEffect::OutsideRidges { part: a, pitch_mm: b },
        "outside-cup" => DisplayEffect::OutsideCup { part: a },
        "outside-ripple" => DisplayEffect::OutsideRipple { mm: a, pitch_mm: b },
        "outside-wobble" => DisplayEffect::OutsideWobble { share: a, hz: b },
        "outside-viscous" => DisplayEffect::OutsideViscous { seconds: a },
        "outside-clip" => DisplayEffect::OutsideClip { ampere: a },
        _ => DisplayEffect::OutsideEddy { seconds: a },
    })
}
