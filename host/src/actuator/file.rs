//! Reading `actuator.toml`.

use std::path::Path;

use toml::Spanned;
use toml::de::DeValue;

use super::{Actuator, Form, Known, Pole};
use crate::experiment::section::{Document, Section};
use crate::experiment::{ExperimentError, Problem, text_of};

const KEYS: [&str; 10] = [
    "title",
    "source",
    "plant",
    "delay_s",
    "rate_limit_mm_per_s",
    "friction_v",
    "backlash_mm",
    "back_mm_per_n",
    "command_limit_v",
    "interval95",
];

/// Keys of the file itself that may have an interval.
const WITH_INTERVAL: [&str; 5] = ["delay_s", "rate_limit_mm_per_s", "friction_v", "backlash_mm", "back_mm_per_n"];

const DELAY: &str = "a dead time of 0 to 1 s";
const PAIR: &str = "two numbers, the lower first, the value between them";
const COEFFICIENTS: &str = "a list of numbers, that of the highest power of s first";
const POLES: &str = "a list of poles in 1/s: a number each, or [real, imaginary] of a pair";

/// Highest order of a plant.
const ORDER: usize = 6;

/// Reads an actuator.
///
/// # Errors
/// The first mistake found, with file, line and column.
pub fn read(file: &Path) -> Result<Actuator, ExperimentError> {
    parse(file, &text_of(file)?)
}

/// Reads an actuator that is already in memory; `file` is where it would be.
///
/// # Errors
/// As [`read`].
pub fn parse(file: &Path, text: &str) -> Result<Actuator, ExperimentError> {
    let document = Document { file, text };
    let root = document.table()?;
    let root = Section::new(document, "the file".to_owned(), 0..0, root.get_ref());
    root.only(&KEYS)?;
    let plant = root.section("plant", "[plant]".to_owned())?;
    let plant = plant
        .ok_or_else(|| root.missing("plant", "a table with numerator and denominator, or gain and poles_per_s"))?;
    let intervals = root.section("interval95", "interval95".to_owned())?;
    if let Some(intervals) = &intervals {
        intervals.only(&WITH_INTERVAL)?;
    }
    let known = |key: &str, most: f64, expected: &str| -> Result<Option<Known>, ExperimentError> {
        let Some(value) = root.number(key, 0.0..=most, expected)? else {
            // An interval of a number that is not there says nothing.
            return match intervals.as_ref().and_then(|own| own.value(key)) {
                Some(_) => Err(root.missing(key, expected)),
                None => Ok(None),
            };
        };
        let interval95 = intervals.as_ref().map(|own| interval(own, key, value)).transpose()?.flatten();
        Ok(Some(Known { value, interval95 }))
    };
    let stem = file.file_stem().map_or("actuator".into(), |name| name.to_string_lossy().into_owned());
    let limit = root.number("command_limit_v", 1e-3..=1000.0, "the driver's largest command, 0.001 to 1000 V")?;
    let read = Actuator {
        title: root.text("title", "a text in quotes")?.map_or(stem, str::to_owned),
        source: root.text("source", "a text in quotes")?.unwrap_or_default().to_owned(),
        form: form(&plant)?,
        delay_s: known("delay_s", 1.0, DELAY)?.unwrap_or(Known::exactly(0.0)),
        rate_limit_mm_per_s: known("rate_limit_mm_per_s", 1e6, "a speed above 0, to 1000000 mm/s")?,
        friction_v: known("friction_v", 1000.0, "a command of 0 to 1000 V")?.unwrap_or(Known::exactly(0.0)),
        backlash_mm: known("backlash_mm", 10.0, "a width of 0 to 10 mm")?.unwrap_or(Known::exactly(0.0)),
        back_mm_per_n: known("back_mm_per_n", 10.0, "how far a force drives it back, 0 to 10 mm/N")?
            .unwrap_or(Known::exactly(0.0)),
        command_limit_v: limit.unwrap_or(f64::from(firmware::pid::U_MAX_V)),
    };
    if read.rate_limit_mm_per_s.is_some_and(|known| known.value <= 0.0) {
        let text =
            "rate_limit_mm_per_s is 0: the shaft cannot move; expected a speed above 0, or no such key".to_owned();
        return Err(document.error(root.span.clone(), Problem::Contradiction(text)));
    }
    if read.flaws().any() && read.plant().numerator.degree() > 0 {
        let text = "rate limit, friction and backlash need a plant whose numerator is a number: they act on the \
                    speed of the spindle, which a numerator with powers of s does not tell; leave them out"
            .to_owned();
        return Err(document.error(plant.span.clone(), Problem::Contradiction(text)));
    }
    Ok(read)
}

/// The interval of a number, if it has one.
fn interval(section: &Section<'_>, key: &str, value: f64) -> Result<Option<(f64, f64)>, ExperimentError> {
    match section.numbers(key, PAIR)?.as_deref() {
        None => Ok(None),
        Some(&[low, high]) if low <= value && value <= high => Ok(Some((low, high))),
        Some(_) => {
            Err(section.value(key).map_or_else(|| section.missing(key, PAIR), |own| section.bad(key, own, PAIR)))
        }
    }
}

fn form(plant: &Section<'_>) -> Result<Form, ExperimentError> {
    if plant.value("gain").is_some() || plant.value("poles_per_s").is_some() {
        return poles(plant);
    }
    plant.only(&["numerator", "denominator", "interval95"])?;
    let list = |key: &str| plant.numbers(key, COEFFICIENTS)?.ok_or_else(|| plant.missing(key, COEFFICIENTS));
    let (numerator, denominator) = (list("numerator")?, list("denominator")?);
    let wrong = |text: String| Err(plant.document.error(plant.span.clone(), Problem::Contradiction(text)));
    let order = denominator.len().saturating_sub(1);
    if !(1..=ORDER).contains(&order) || denominator[0] == 0.0 {
        return wrong(format!("denominator has the order {order}; expected 1 to {ORDER}, the first number not 0"));
    }
    if numerator.is_empty() || numerator.len() > order || numerator.iter().all(|c| *c == 0.0) {
        return wrong(format!(
            "numerator has {} numbers; expected 1 to {order}, not all 0: a shaft does not jump with its command",
            numerator.len()
        ));
    }
    let own = plant.section("interval95", "interval95 of [plant]".to_owned())?;
    if let Some(own) = &own {
        own.only(&["numerator", "denominator"])?;
    }
    let with = |key: &str, values: &[f64]| -> Result<Vec<Known>, ExperimentError> {
        let found = own.as_ref().map(|own| pairs(own, key, values)).transpose()?.flatten();
        let interval = |i: usize| found.as_ref().map(|list| list[i]);
        Ok(values.iter().enumerate().map(|(i, value)| Known { value: *value, interval95: interval(i) }).collect())
    };
    let (numerator, denominator): (Vec<Known>, Vec<Known>) =
        (with("numerator", &numerator)?, with("denominator", &denominator)?);
    if denominator[0].interval95.is_some_and(|(low, high)| low <= 0.0 && high >= 0.0) {
        return wrong("the interval of the first number of denominator holds 0; expected one order for all".to_owned());
    }
    Ok(Form::Coefficients { numerator, denominator })
}

/// `[[low, high], ...]`, one pair a value.
fn pairs(section: &Section<'_>, key: &str, values: &[f64]) -> Result<Option<Vec<(f64, f64)>>, ExperimentError> {
    let Some(value) = section.value(key) else { return Ok(None) };
    let expected = format!("{} pairs of numbers, the lower first, each value between its own", values.len());
    let bad = || section.bad(key, value, &expected);
    let DeValue::Array(items) = value.get_ref() else { return Err(bad()) };
    if items.len() != values.len() {
        return Err(bad());
    }
    let one = |(item, value): (&Spanned<DeValue<'_>>, &f64)| pair(item).filter(|(l, h)| l <= value && value <= h);
    items.iter().zip(values).map(|both| one(both).ok_or_else(bad)).collect::<Result<Vec<_>, _>>().map(Some)
}

/// Two finite numbers.
fn pair(item: &Spanned<DeValue<'_>>) -> Option<(f64, f64)> {
    let DeValue::Array(ends) = item.get_ref() else { return None };
    let numbers: Vec<f64> = ends.iter().filter_map(Section::finite).collect();
    (ends.len() == 2 && numbers.len() == 2).then(|| (numbers[0], numbers[1]))
}

fn poles(plant: &Section<'_>) -> Result<Form, ExperimentError> {
    plant.only(&["gain", "poles_per_s", "interval95"])?;
    let expected = "a gain in mm/V, or mm/(V s) with a pole at 0; not 0";
    let gain = plant.number("gain", -1e6..=1e6, expected)?.ok_or_else(|| plant.missing("gain", expected))?;
    let Some(value) = plant.value("poles_per_s") else { return Err(plant.missing("poles_per_s", POLES)) };
    let bad = || plant.bad("poles_per_s", value, POLES);
    let DeValue::Array(items) = value.get_ref() else { return Err(bad()) };
    let own = plant.section("interval95", "interval95 of [plant]".to_owned())?;
    if let Some(own) = &own {
        own.only(&["gain", "poles_per_s"])?;
    }
    let intervals = own.as_ref().and_then(|own| own.value("poles_per_s"));
    let ends: Option<Vec<&Spanned<DeValue<'_>>>> = match intervals.map(Spanned::get_ref) {
        Some(DeValue::Array(list)) if list.len() == items.len() => Some(list.iter().collect()),
        Some(_) => {
            return Err(own
                .as_ref()
                .zip(intervals)
                .map_or_else(bad, |(own, v)| own.bad("poles_per_s", v, "one interval a pole")));
        }
        None => None,
    };
    let mut poles = Vec::new();
    for (i, item) in items.iter().enumerate() {
        let range = ends.as_ref().map(|ends| ends[i]);
        let pole = pole(item, range).ok_or_else(|| match (&own, intervals, range) {
            (Some(own), Some(intervals), Some(_)) if pole(item, None).is_some() => {
                own.bad("poles_per_s", intervals, "intervals with their poles inside, the lower end first")
            }
            _ => bad(),
        })?;
        poles.push(pole);
    }
    let order: usize = poles.iter().map(|pole| if matches!(pole, Pole::Pair(..)) { 2 } else { 1 }).sum();
    let at_zero = poles.iter().filter(|pole| matches!(pole, Pole::Real(known) if known.value == 0.0)).count();
    if !(1..=ORDER).contains(&order) || at_zero > 1 {
        return Err(plant.bad("poles_per_s", value, &format!("1 to {ORDER} poles, at most one of them 0")));
    }
    if gain == 0.0 {
        return Err(plant.value("gain").map_or_else(bad, |value| plant.bad("gain", value, expected)));
    }
    let interval95 = own.as_ref().map(|own| interval(own, "gain", gain)).transpose()?.flatten();
    Ok(Form::Poles { gain: Known { value: gain, interval95 }, poles })
}

/// A pole and, if given, its interval.
fn pole(item: &Spanned<DeValue<'_>>, ends: Option<&Spanned<DeValue<'_>>>) -> Option<Pole> {
    let known = |value: f64, ends: Option<(f64, f64)>| {
        let inside = ends.is_none_or(|(low, high)| low <= value && value <= high);
        inside.then_some(Known { value, interval95: ends })
    };
    if let Some(value) = Section::finite(item) {
        let ends = match ends {
            Some(ends) => Some(pair(ends)?),
            None => None,
        };
        return known(value, ends).map(Pole::Real);
    }
    let (real, imaginary) = pair(item).filter(|(_, imaginary)| *imaginary > 0.0)?;
    let ends = match ends.map(Spanned::get_ref) {
        Some(DeValue::Array(list)) if list.len() == 2 => [Some(pair(&list[0])?), Some(pair(&list[1])?)],
        Some(_) => return None,
        None => [None, None],
    };
    Some(Pole::Pair(known(real, ends[0])?, known(imaginary, ends[1])?))
}
