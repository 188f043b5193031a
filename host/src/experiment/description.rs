//! `experiment.toml` itself.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::error::{ExperimentError, Problem};
use super::file::{self, Need, Window};
use super::layout;
use super::plausible;
use super::section::{Document, Section};
use super::sensor::{self, Trouble};
use super::{
    Base, BaseLaw, Experiment, Format, Indenter, Length, Mapping, Recording, Run, Sensor, Specimen, Test, replicate,
};

/// Lengths of specimens and balls that can be meant, mm; outside, a unit was confused.
const PLAUSIBLE_MM: std::ops::RangeInclusive<f64> = 0.05..=1000.0;

/// Areas of specimens that can be meant, mm^2.
const PLAUSIBLE_MM2: std::ops::RangeInclusive<f64> = 0.01..=1e6;
/// Places on a specimen that can be meant, mm from an origin of a machine's.
const PLACES_MM: std::ops::RangeInclusive<f64> = -1e4..=1e4;
/// Times that can be meant, s.
const TIMES_S: std::ops::RangeInclusive<f64> = -1e12..=1e12;

pub(super) fn experiment(file: &Path, text: &str) -> Result<Experiment, ExperimentError> {
    let document = Document { file, text };
    let root = document.table()?;
    let root = Section::new(document, "the file".to_owned(), 0..0, root.get_ref());
    root.only(&["name", "columns", "format", "specimen", "indenter", "sensor", "run"])?;
    let folder = file.parent().map(Path::to_owned).unwrap_or_default();
    let name = match root.text("name", "a text in quotes")? {
        Some(name) => name.to_owned(),
        None => folder.file_name().map_or("experiment".into(), |n| n.to_string_lossy().into()),
    };
    let columns = layout::columns(&root, BTreeMap::new())?;
    let format = layout::format(&root, Format::default())?;
    let specimens = root.named("specimen")?.iter().map(specimen).collect::<Result<Vec<_>, _>>()?;
    let indenters = root.named("indenter")?.iter().map(indenter).collect::<Result<Vec<_>, _>>()?;
    let sensor = force_sensor(&root)?;
    let places = Places {
        folder: &folder,
        specimens: specimens.iter().enumerate().map(|(i, s)| (s.name.clone(), i)).collect(),
        indenters: indenters.iter().enumerate().map(|(i, s)| (s.name.clone(), i)).collect(),
        balls: &indenters,
    };
    let sections = root.array("run")?;
    if sections.is_empty() {
        return Err(root.missing("run", "at least one [[run]] with the file it was recorded in"));
    }
    let runs = sections
        .iter()
        .map(|section| run(section, &places, &specimens, &columns, &format))
        .collect::<Result<Vec<_>, _>>()?;
    lie_still(&sections, &runs)?;
    repeat_alike(&sections, &runs)?;
    Ok(Experiment { name, folder, specimens, indenters, sensor, runs })
}

fn length(section: &Section<'_>, key: &str, expected: &str) -> Result<Length, ExperimentError> {
    if let Some(value) = section.value(key)
        && value.get_ref().as_str() == Some("unknown")
    {
        return Ok(Length::Unknown);
    }
    section.number(key, PLAUSIBLE_MM, expected)?.map(Length::Known).ok_or_else(|| section.missing(key, expected))
}

fn specimen((name, section): &(String, Section<'_>)) -> Result<Specimen, ExperimentError> {
    section.only(&["base_law", "terms", "height_mm", "radius_mm", "area_mm2", "base", "material"])?;
    let expected = "a length of 0.05 to 1000 mm, or \"unknown\"";
    let laws = [("hyperfoam", BaseLaw::Hyperfoam), ("ogden", BaseLaw::Ogden), ("rigid", BaseLaw::Rigid)];
    let bases = [("bonded", Base::Bonded), ("sliding", Base::Sliding)];
    let terms = section.integer("terms", 1..=6, "a whole number from 1 to 6")?.unwrap_or(1);
    Ok(Specimen {
        name: name.clone(),
        material: section.text("material", "a text in quotes")?.unwrap_or("specimen").to_owned(),
        base_law: section.word("base_law", &laws)?.unwrap_or(BaseLaw::Hyperfoam),
        terms: usize::try_from(terms).unwrap_or(1),
        height_mm: length(section, "height_mm", expected)?,
        radius_mm: radius(section, expected)?,
        base: section.word("base", &bases)?.unwrap_or(Base::Bonded),
    })
}

/// The radius, or that of the circle of a stated area.
fn radius(section: &Section<'_>, expected: &str) -> Result<Length, ExperimentError> {
    match circle_mm(section)? {
        Some(radius_mm) => Ok(Length::Known(radius_mm)),
        None => length(section, "radius_mm", expected),
    }
}

/// The radius of the circle of a stated area, where one is stated and no radius beside it.
pub(crate) fn circle_mm(section: &Section<'_>) -> Result<Option<f64>, ExperimentError> {
    let area = section.number("area_mm2", PLAUSIBLE_MM2, "an area of 0.01 to 1000000 mm2")?;
    if let Some(value) = section.value("area_mm2").filter(|_| section.value("radius_mm").is_some()) {
        let problem = "`area_mm2` and `radius_mm` say the same; state one of them".to_owned();
        return Err(section.document.error(value.span(), Problem::Contradiction(problem)));
    }
    Ok(area.map(|area_mm2| (area_mm2 / std::f64::consts::PI).sqrt()))
}

fn indenter((name, section): &(String, Section<'_>)) -> Result<Indenter, ExperimentError> {
    section.only(&["radius_mm"])?;
    let expected = "the ball's radius, 0.05 to 1000 mm, or \"unknown\"";
    Ok(Indenter { name: name.clone(), radius_mm: length(section, "radius_mm", expected)? })
}

fn force_sensor(root: &Section<'_>) -> Result<Sensor, ExperimentError> {
    let Some(section) = root.section("sensor", "[sensor]".to_owned())? else {
        return Ok(Sensor::default());
    };
    section.only(&["noise_N", "zero"])?;
    let expected = "a standard deviation above 0 N";
    Ok(Sensor {
        noise_n: section.number("noise_N", f64::MIN_POSITIVE..=1e6, expected)?,
        zero_is_known: section.word("zero", &[("known", true), ("free", false)])?.unwrap_or(false),
    })
}

/// Names and places of everything a run can refer to.
type Names = BTreeMap<String, usize>;

/// What the runs refer to.
struct Places<'a> {
    folder: &'a Path,
    specimens: Names,
    indenters: Names,
    balls: &'a [Indenter],
}

const TESTS: [(&str, Test); 10] = [
    ("indentation", Test::Indentation),
    ("uniaxial", Test::Uniaxial),
    ("confined", Test::Confined),
    ("tension", Test::Tension),
    ("shear", Test::Shear),
    ("air", Test::Air),
    ("mass", Test::Mass),
    ("display", Test::Display),
    ("table", Test::Table),
    ("print", Test::Print),
];

fn run(
    section: &Section<'_>,
    places: &Places<'_>,
    specimens: &[Specimen],
    columns: &BTreeMap<String, Mapping>,
    format: &Format,
) -> Result<Run, ExperimentError> {
    section.only(&[
        "file",
        "specimen",
        "indenter",
        "spot",
        "place_mm",
        "cycle",
        "order",
        "start_s",
        "hold_out",
        "test",
        "columns",
        "format",
        "from_s",
        "to_s",
        "load_N",
        "magnet",
        "flux_unit",
        "interval_s",
        "rate_mm_per_s",
        "repeats",
    ])?;
    let test = section.word("test", &TESTS)?.unwrap_or(Test::Indentation);
    let expected = "the name of a data file";
    let file = section.text("file", expected)?.ok_or_else(|| section.missing("file", expected))?;
    let path = located(places.folder, file);
    if !path.is_file() {
        let span = section.value("file").map_or(0..0, toml::Spanned::span);
        return Err(section.document.error(span, Problem::MissingFile(path.display().to_string())));
    }
    let whole = "a whole number";
    let specimen = reference(section, "specimen", &places.specimens, touches_specimen(test))?;
    let indenter = reference(section, "indenter", &places.indenters, test == Test::Indentation)?;
    let columns = layout::columns(section, columns.clone())?;
    let format = layout::format(section, format.clone())?;
    let pace = layout::pace(section)?;
    let window = window(section)?;
    let mut recording = file::read(&path, &Need::of(test, pace), &columns, &format, window)?;
    crop(section, window, &mut recording)?;
    if test == Test::Display {
        recording.check_pairs(&path)?;
    }
    let at_file = |problem| ExperimentError::of_file(&path, problem);
    let height_mm = specimen.and_then(|at| specimens.get(at)?.height_mm.known()).filter(|_| test != Test::Tension);
    let check_depth = |recording: &Recording| match height_mm {
        Some(height_mm) => recording.check_depth(&path, height_mm),
        None => Ok(()),
    };
    // A depth that cannot be is a mistake of the description, no code of the device.
    let as_recorded = check_depth(&recording);
    let mut troubles = match test {
        Test::Indentation | Test::Uniaxial | Test::Confined | Test::Shear => {
            sensor::cleaned(&mut recording).map_err(at_file)?
        }
        _ => Vec::new(),
    };
    if troubles.contains(&Trouble::Turned) { check_depth(&recording) } else { as_recorded }?;
    let ball_mm = indenter.and_then(|at| places.balls[at].radius_mm.known());
    let soft = specimen.is_some_and(|at| specimens[at].base_law != BaseLaw::Rigid);
    if let Some(ball_mm) = ball_mm.filter(|_| test == Test::Indentation && soft) {
        troubles.extend(plausible::check(&recording, ball_mm, &columns).map_err(at_file)?);
    }
    if test == Test::Tension {
        recording.turn_to_push();
    }
    Ok(Run {
        file: file.to_owned(),
        specimen,
        indenter,
        test,
        spot: section.integer("spot", i64::MIN..=i64::MAX, whole)?,
        place_mm: place(section)?,
        cycle: section.integer("cycle", 0..=i64::MAX, "a whole number from 0")?,
        order: section.integer("order", i64::MIN..=i64::MAX, whole)?,
        start_s: section.number("start_s", TIMES_S, "a time in s")?,
        hold_out: section.flag("hold_out")?.unwrap_or(false),
        magnet: magnet(section, test)?,
        load_n: section.number("load_N", -1e6..=1e6, "the known load in N, pressing positive")?,
        repeats: section.text("repeats", "a label in quotes that the runs share")?.map(str::to_owned),
        path,
        troubles,
        recording,
    })
}

/// The magnet that a table stands beside, with the unit of y over T.
fn magnet(section: &Section<'_>, test: Test) -> Result<Option<(String, f64)>, ExperimentError> {
    let units = [("T", 1.0), ("mT", 1e3), ("G", 1e4)];
    let unit = section.word("flux_unit", &units)?.unwrap_or(1.0);
    let Some(value) = section.value("magnet") else { return Ok(None) };
    let expected = "a magnet.toml, or the name of a magnet that comes with the program";
    let name = section.text("magnet", expected)?.unwrap_or_default();
    if test != Test::Table {
        let text = "`magnet` stands beside test = \"table\", current and flux density".to_owned();
        return Err(section.document.error(value.span(), Problem::Contradiction(text)));
    }
    Ok(Some((name.to_owned(), unit)))
}

/// Refuses a spot that lies in two places.
fn lie_still(sections: &[Section<'_>], runs: &[Run]) -> Result<(), ExperimentError> {
    for (at, (section, run)) in sections.iter().zip(runs).enumerate() {
        let (Some(spot), Some([x, y])) = (run.spot, run.place_mm) else { continue };
        let same = |other: &&Run| other.specimen == run.specimen && other.spot == Some(spot);
        let before = runs[..at].iter().filter(same).find_map(|other| Some((other, other.place_mm?)));
        if let Some((other, [was_x, was_y])) = before.filter(|(_, place)| *place != [x, y]) {
            let problem = format!("spot {spot} lies at [{x}, {y}] mm here and at [{was_x}, {was_y}] in {}", other.file);
            let span = section.value("place_mm").map_or(0..0, toml::Spanned::span);
            return Err(section.document.error(span, Problem::Contradiction(problem)));
        }
    }
    Ok(())
}

/// Refuses runs that repeat each other by declaration and were made with another test, specimen or ball.
fn repeat_alike(sections: &[Section<'_>], runs: &[Run]) -> Result<(), ExperimentError> {
    for (at, (section, run)) in sections.iter().zip(runs).enumerate() {
        let first = runs[..at].iter().find(|other| replicate::declared(other, run));
        let Some(other) = first.filter(|other| !replicate::comparable(other, run)) else { continue };
        let label = run.repeats.as_deref().unwrap_or_default();
        let problem = format!(
            "runs that repeat \"{label}\" differ in test, specimen or indenter: {} and {}",
            other.file, run.file
        );
        let span = section.value("repeats").map_or(0..0, toml::Spanned::span);
        return Err(section.document.error(span, Problem::Contradiction(problem)));
    }
    Ok(())
}

/// Where on the specimen a run pressed, mm.
fn place(section: &Section<'_>) -> Result<Option<[f64; 2]>, ExperimentError> {
    let expected = "two places in mm, each of -10000 to 10000, such as place_mm = [4.0, -2.5]";
    let Some(numbers) = section.numbers("place_mm", expected)? else { return Ok(None) };
    match <[f64; 2]>::try_from(numbers) {
        Ok(place) if place.iter().all(|mm| PLACES_MM.contains(mm)) => Ok(Some(place)),
        _ => Err(section
            .value("place_mm")
            .map_or_else(|| section.missing("place_mm", expected), |value| section.bad("place_mm", value, expected))),
    }
}

/// The part of the file's clock that is read.
fn window(section: &Section<'_>) -> Result<Window, ExperimentError> {
    let time = |key| section.number(key, TIMES_S, "a time in s on the file's clock");
    Ok(Window { from_s: time("from_s")?, to_s: time("to_s")? })
}

/// Keeps the samples from `from_s` to `to_s` of the file's own clock.
fn crop(section: &Section<'_>, window: Window, recording: &mut Recording) -> Result<(), ExperimentError> {
    let Some(key) = ["from_s", "to_s"].into_iter().find_map(|key| section.value(key)) else { return Ok(()) };
    let (first, last) = (recording.time_s.first().copied(), recording.time_s.last().copied());
    recording.keep_between(window.from_s.unwrap_or(f64::NEG_INFINITY), window.to_s.unwrap_or(f64::INFINITY));
    if !recording.is_empty() {
        return Ok(());
    }
    let time = |at: Option<f64>| at.map_or("none".to_owned(), |t| t.to_string());
    let problem = format!(
        "no sample lies between `from_s` and `to_s`; the recording has times from {} to {} s",
        time(first),
        time(last)
    );
    Err(section.document.error(key.span(), Problem::Contradiction(problem)))
}

fn touches_specimen(test: Test) -> bool {
    matches!(test, Test::Indentation | Test::Uniaxial | Test::Confined | Test::Tension | Test::Shear)
}

fn reference(
    section: &Section<'_>,
    key: &str,
    names: &Names,
    required: bool,
) -> Result<Option<usize>, ExperimentError> {
    let expected = "a name in quotes";
    let Some(name) = section.text(key, expected)? else {
        return if required { Err(section.missing(key, expected)) } else { Ok(None) };
    };
    names.get(name).copied().map(Some).ok_or_else(|| {
        let span = section.value(key).map_or(0..0, toml::Spanned::span);
        let problem =
            Problem::UnknownName { key: key.to_owned(), name: name.to_owned(), known: names.keys().cloned().collect() };
        section.document.error(span, problem)
    })
}

/// Where a data file is: beside `experiment.toml`, or, with the prefix `shared:`, in the folder
/// of shared recordings, which is the nearest folder `shared` on the way up from the experiment,
/// or what the environment variable `PALPATE_SHARED` names.
fn located(folder: &Path, file: &str) -> PathBuf {
    let Some(inside) = file.strip_prefix("shared:") else {
        return folder.join(file);
    };
    let root = std::env::var_os("PALPATE_SHARED").map(PathBuf::from).or_else(|| {
        let absolute = std::path::absolute(folder).ok()?;
        absolute.ancestors().map(|up| up.join("shared")).find(|shared| shared.join(inside).exists())
    });
    root.unwrap_or_else(|| PathBuf::from("shared")).join(inside)
}
