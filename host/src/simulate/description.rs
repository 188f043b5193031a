//! The file a user writes for `palpate simulate`, in the manner of `experiment.toml`.

use std::path::Path;

use toml::Spanned;

use crate::experiment::section::{Document, Section};
use crate::experiment::{self, Base, ExperimentError, Problem, Test, circle_mm};
use crate::extended::{ExtendedModel, truth};

use super::effect;
use super::spec::{
    FINER, Noise, RunTemplate, SAMPLE_HZ, SecondTerm, Session, Spec, TrueIndenter, TrueLaw, TrueSpecimen,
};

/// A specification with a comment at every key (`palpate simulate --example`).
pub const EXAMPLE: &str = include_str!("example.toml");

/// Poisson's ratio of an Ogden law unless given.
const OGDEN_NU: f64 = 0.475;
/// Reduced modulus of a rigid block unless given, MPa: hard plastic.
const RIGID_MPA: f64 = 3000.0;

/// Reads a specification.
///
/// # Errors
/// The first mistake found, with file, line and column.
pub fn read(file: &Path) -> Result<Spec, ExperimentError> {
    parse(file, &experiment::text_of(file)?)
}

/// Reads a specification that is already in memory; `file` is where it would be.
///
/// # Errors
/// As [`read`].
pub fn parse(file: &Path, text: &str) -> Result<Spec, ExperimentError> {
    let document = Document { file, text };
    let root = document.table()?;
    let root = Section::new(document, "the file".to_owned(), 0..0, root.get_ref());
    root.only(&[
        "name",
        "model",
        "seed",
        "sample_hz",
        "refinement",
        "specimen",
        "indenter",
        "run",
        "session",
        "noise",
        "effect",
    ])?;
    let stem = file.file_stem().map_or("simulated".into(), |n| n.to_string_lossy().into_owned());
    let name = root.text("name", "a text in quotes")?.map_or(stem, str::to_owned);
    let seed = root.integer("seed", 0..=i64::MAX, "a whole number from 0")?.unwrap_or(1);
    let mut spec = Spec::new(&name, seed.unsigned_abs());
    spec.sample_hz = root.number("sample_hz", 1.0..=1e4, "1 to 10000 samples a second")?.unwrap_or(SAMPLE_HZ);
    spec.refinement = root.number("refinement", 0.3..=6.0, "a number of 0.3 to 6")?.unwrap_or(FINER);
    let modelled = root.value("model").is_some();
    spec.specimens = root.named("specimen")?.iter().map(|one| specimen(one, modelled)).collect::<Result<_, _>>()?;
    spec.indenters = root.named("indenter")?.iter().map(indenter).collect::<Result<_, _>>()?;
    let sections = root.array("run")?;
    if sections.is_empty() {
        return Err(root.missing("run", "at least one [[run]] with specimen, indenter, rate_mm_s and depth_mm"));
    }
    spec.runs = sections.iter().map(|section| run(section, &spec)).collect::<Result<_, _>>()?;
    spec.session = session(&root)?;
    (spec.noise, spec.state_noise) = noise(&root)?;
    for section in root.array("effect")? {
        spec.effects.push(effect::parse(&section)?);
        if let Some(effect::Effect::Radius { indenter, .. }) = spec.effects.last() {
            known(&section, "indenter", indenter, spec.indenters.iter().map(|one| &one.name))?;
        }
    }
    if let Some(section) = root.section("model", "[model]".to_owned())? {
        extended(&section, file, &mut spec)?;
    }
    super::check::check(&spec)
        .map_err(|error| ExperimentError::of_file(file, Problem::Contradiction(error.to_string())))?;
    Ok(spec)
}

/// `[model] file = "model.toml"`: an extended model, its path relative to the specification.
fn extended(section: &Section<'_>, file: &Path, spec: &mut Spec) -> Result<(), ExperimentError> {
    section.only(&["file"])?;
    let expected = "the path of a model file, relative to this one";
    let path = needed(section, "file", expected, section.text("file", expected)?)?;
    let path = file.parent().map_or_else(|| path.into(), |folder| folder.join(path));
    let model = ExtendedModel::read(&path)?;
    truth::apply(&model, spec).map(|_| ()).map_err(|cause| {
        let span = section.value("file").map_or(0..0, Spanned::span);
        section.document.error(span, Problem::Contradiction(cause.to_string()))
    })
}

/// A value that must be there.
fn needed<T>(section: &Section<'_>, key: &str, expected: &str, found: Option<T>) -> Result<T, ExperimentError> {
    found.ok_or_else(|| section.missing(key, expected))
}

fn number(
    section: &Section<'_>,
    key: &str,
    low: f64,
    high: f64,
    expected: &str,
) -> Result<Option<f64>, ExperimentError> {
    section.number(key, low..=high, expected)
}

const LENGTH: &str = "a length of 0.05 to 1000 mm";

fn specimen((name, section): &(String, Section<'_>), modelled: bool) -> Result<TrueSpecimen, ExperimentError> {
    section.only(&[
        "law",
        "mu_MPa",
        "alpha",
        "nu",
        "mu2_MPa",
        "alpha2",
        "height_mm",
        "radius_mm",
        "area_mm2",
        "base",
        "thermal_strain",
        "reduced_modulus_MPa",
    ])?;
    let modulus = number(section, "reduced_modulus_MPa", 1.0, 1e6, "a modulus of 1 to 1000000 MPa")?;
    let rigid = TrueLaw::Rigid { reduced_modulus_mpa: modulus.unwrap_or(RIGID_MPA) };
    let laws = [("hyperfoam", TrueLaw::Hyperfoam), ("ogden", TrueLaw::Ogden), ("rigid", rigid)];
    let law = section.word("law", &laws)?.unwrap_or(TrueLaw::Hyperfoam);
    let stiffness = "a shear modulus of 0.000001 to 10000 MPa";
    let exponent = "an exponent of -50 to 50, not 0";
    let mut mu_mpa = number(section, "mu_MPa", 1e-6, 1e4, stiffness)?;
    let mut alpha = number(section, "alpha", -50.0, 50.0, exponent)?;
    // a model gives foams theirs
    if law == rigid || (modelled && law == TrueLaw::Hyperfoam) {
        (mu_mpa, alpha) = (mu_mpa.or(Some(1.0)), alpha.or(Some(2.0)));
    }
    let alpha = needed(section, "alpha", exponent, alpha)?;
    if let Some(value) = section.value("alpha").filter(|_| alpha == 0.0) {
        return Err(section.bad("alpha", value, exponent));
    }
    let second = match number(section, "mu2_MPa", -1e4, 1e4, "a modulus of -10000 to 10000 MPa, not 0")? {
        None => None,
        Some(mu_mpa) => {
            let alpha = number(section, "alpha2", -50.0, 50.0, exponent)?;
            Some(SecondTerm { mu_mpa, alpha: needed(section, "alpha2", exponent, alpha)? })
        }
    };
    let nu = number(section, "nu", -0.9, 0.4999, "a ratio of -0.9 to 0.4999")?;
    let height_mm = number(section, "height_mm", 0.05, 1000.0, LENGTH)?;
    let thermal = number(section, "thermal_strain", -0.3, 0.3, "a linear strain of -0.3 to 0.3")?;
    if let Some(value) = section.value("thermal_strain").filter(|_| law == rigid) {
        let problem = "a rigid block does not grow; `thermal_strain` belongs to a specimen that is soft".to_owned();
        return Err(section.document.error(value.span(), Problem::Contradiction(problem)));
    }
    let bases = [("bonded", Base::Bonded), ("sliding", Base::Sliding)];
    Ok(TrueSpecimen {
        name: name.clone(),
        law,
        mu_mpa: needed(section, "mu_MPa", stiffness, mu_mpa)?,
        alpha,
        nu: nu.unwrap_or(if law == TrueLaw::Ogden { OGDEN_NU } else { 0.0 }),
        second,
        height_mm: needed(section, "height_mm", LENGTH, height_mm)?,
        radius_mm: radius(section)?,
        base: section.word("base", &bases)?.unwrap_or(Base::Bonded),
        thermal_strain: thermal.unwrap_or(0.0),
    })
}

/// The radius of a specimen, or that of the circle of a stated area.
fn radius(section: &Section<'_>) -> Result<f64, ExperimentError> {
    let radius_mm = number(section, "radius_mm", 0.05, 1000.0, LENGTH)?;
    Ok(circle_mm(section)?.or(radius_mm).unwrap_or(25.0))
}

fn indenter((name, section): &(String, Section<'_>)) -> Result<TrueIndenter, ExperimentError> {
    section.only(&["radius_mm"])?;
    let radius_mm = number(section, "radius_mm", 0.05, 1000.0, LENGTH)?;
    Ok(TrueIndenter { name: name.clone(), radius_mm: needed(section, "radius_mm", LENGTH, radius_mm)? })
}

/// Refuses a name that nothing has.
fn known<'a>(
    section: &Section<'_>,
    key: &str,
    name: &str,
    names: impl Iterator<Item = &'a String>,
) -> Result<(), ExperimentError> {
    let known: Vec<String> = names.cloned().collect();
    if known.iter().any(|one| one == name) {
        return Ok(());
    }
    let span = section.value(key).map_or(0..0, Spanned::span);
    let problem = Problem::UnknownName { key: key.to_owned(), name: name.to_owned(), known };
    Err(section.document.error(span, problem))
}

fn run(section: &Section<'_>, spec: &Spec) -> Result<RunTemplate, ExperimentError> {
    section.only(&[
        "test",
        "specimen",
        "indenter",
        "rate_mm_s",
        "depth_mm",
        "hold_s",
        "unload",
        "cycles",
        "rest_s",
        "replicates",
        "load_N",
        "air_mm",
        "hold_out",
    ])?;
    let tests = [
        ("indentation", Test::Indentation),
        ("uniaxial", Test::Uniaxial),
        ("confined", Test::Confined),
        ("air", Test::Air),
        ("mass", Test::Mass),
    ];
    let test = section.word("test", &tests)?.unwrap_or(Test::Indentation);
    let coupon = matches!(test, Test::Uniaxial | Test::Confined);
    let presses = test == Test::Indentation || coupon;
    let mut run = RunTemplate { test, ..RunTemplate::ramp("", "", 1.0, 1.0) };
    let name = "a name in quotes";
    run.specimen = section.text("specimen", name)?.map(str::to_owned);
    run.indenter = section.text("indenter", name)?.map(str::to_owned);
    if presses {
        let specimen = needed(section, "specimen", name, run.specimen.as_deref())?;
        known(section, "specimen", specimen, spec.specimens.iter().map(|one| &one.name))?;
        if let Some(value) = section.value("indenter").filter(|_| coupon) {
            let problem = "a coupon is compressed as a whole; `indenter` belongs to test = \"indentation\"".to_owned();
            return Err(section.document.error(value.span(), Problem::Contradiction(problem)));
        }
        if !coupon {
            let indenter = needed(section, "indenter", name, run.indenter.as_deref())?;
            known(section, "indenter", indenter, spec.indenters.iter().map(|one| &one.name))?;
        }
        let expected = "a rate of 0.00001 to 10000 mm/s";
        let rate = number(section, "rate_mm_s", 1e-5, 1e4, expected)?;
        run.rate_mm_s = needed(section, "rate_mm_s", expected, rate)?;
    }
    let rigid = run.specimen.as_deref().and_then(|name| spec.specimen(name));
    let rigid = rigid.is_some_and(|one| matches!(one.law, TrueLaw::Rigid { .. }));
    if let Some(value) = section.value("specimen").filter(|_| coupon && rigid) {
        let problem = "a rigid block cannot be compressed as a coupon; expected a specimen that is soft".to_owned();
        return Err(section.document.error(value.span(), Problem::Contradiction(problem)));
    }
    let expected = "a depth of 0.01 to 1000 mm";
    let depth = number(section, "depth_mm", 0.01, 1000.0, expected)?;
    if presses && !rigid {
        run.depth_mm = needed(section, "depth_mm", expected, depth)?;
    }
    let expected = "a load in N";
    let load = number(section, "load_N", -1e6, 1e6, expected)?;
    if rigid || test == Test::Mass {
        run.load_n = needed(section, "load_N", expected, load)?;
    }
    let whole = |key, left_out: usize| -> Result<usize, ExperimentError> {
        let found = section.integer(key, 1..=1000, "a whole number from 1 to 1000")?;
        Ok(found.and_then(|n| usize::try_from(n).ok()).unwrap_or(left_out))
    };
    (run.cycles, run.replicates) = (whole("cycles", 1)?, whole("replicates", 1)?);
    let time = "a time of 0 to 100000 s";
    let hold = number(section, "hold_s", 0.0, 1e5, time)?;
    run.hold_s = if presses { hold.unwrap_or(0.0) } else { needed(section, "hold_s", time, hold)? };
    run.rest_s = number(section, "rest_s", 0.0, 1e6, "a time of 0 to 1000000 s")?.unwrap_or(run.rest_s);
    run.air_mm = number(section, "air_mm", 0.0, 100.0, "a length of 0 to 100 mm")?.unwrap_or(0.0);
    run.unload = section.flag("unload")?.unwrap_or(false);
    run.hold_out = section.flag("hold_out")?.unwrap_or(false);
    Ok(run)
}

fn session(root: &Section<'_>) -> Result<Session, ExperimentError> {
    let mut session = Session::default();
    let Some(section) = root.section("session", "[session]".to_owned())? else { return Ok(session) };
    section.only(&["order", "gap_s", "start_s"])?;
    let orders = [("random", true), ("as-written", false)];
    session.random_order = section.word("order", &orders)?.unwrap_or(session.random_order);
    session.gap_s = number(&section, "gap_s", 0.0, 1e6, "a time of 0 to 1000000 s")?.unwrap_or(session.gap_s);
    session.start_s = number(&section, "start_s", 0.0, 1e6, "a time of 0 to 1000000 s")?.unwrap_or(session.start_s);
    Ok(session)
}

fn noise(root: &Section<'_>) -> Result<(Noise, bool), ExperimentError> {
    let Some(section) = root.section("noise", "[noise]".to_owned())? else { return Ok((Noise::default(), false)) };
    section.only(&[
        "sensor_N",
        "correlation_s",
        "contact_jitter_mm",
        "gain_jitter",
        "memory_jitter",
        "quantum_N",
        "drift_N_per_h",
        "heavy_tails",
        "proportional",
        "stated",
    ])?;
    let one = |key, high, expected| number(&section, key, 0.0, high, expected).map(|found| found.unwrap_or(0.0));
    let noise = Noise {
        sensor_n: one("sensor_N", 1e6, "a standard deviation of 0 N or more")?,
        correlation_s: one("correlation_s", 1e4, "a time of 0 to 10000 s")?,
        contact_jitter_mm: one("contact_jitter_mm", 1.0, "a standard deviation of 0 to 1 mm")?,
        gain_jitter: one("gain_jitter", 0.5, "a relative standard deviation of 0 to 0.5")?,
        memory_jitter: one("memory_jitter", 0.5, "a standard deviation of 0 to 0.5 of a logarithm")?,
        quantum_n: one("quantum_N", 1e6, "a step of 0 N or more")?,
        drift_n_per_h: one("drift_N_per_h", 1e6, "a standard deviation of 0 N or more after an hour")?,
        heavy_tails: section.flag("heavy_tails")?.unwrap_or(false),
        proportional: one("proportional", 1.0, "a part of 0 to 1")?,
    };
    Ok((noise, section.flag("stated")?.unwrap_or(false)))
}
