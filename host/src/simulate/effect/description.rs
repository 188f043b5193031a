//! `[[effect]]` of a specification.

use crate::experiment::section::Section;
use crate::experiment::{ExperimentError, Problem};

use lut_gen::solid::law::PronyTerm;

use super::{Along, Effect, Kernel, Rest, ShareOf, Variable};

/// A parameter: key, lowest, highest, what is expected, and the value when it is left out.
type Key = (&'static str, f64, f64, &'static str, Option<f64>);

const TINY: f64 = 1e-9;

/// Of each Prony term. Without `k` the bulk relaxes as the shear does.
const RELAXATION: [[Key; 3]; 2] = [
    [("g1", 0.0, 0.95, PART, None), ("k1", 0.0, 0.95, PART, None), ("tau1_s", 1e-3, 1e5, TIME, None)],
    [("g2", 0.0, 0.95, PART, None), ("k2", 0.0, 0.95, PART, None), ("tau2_s", 1e-3, 1e5, TIME, Some(10.0))],
];
const PART: &str = "a part of 0 to 0.95";
const TIME: &str = "a time of 0.001 to 100000 s";
const POISSON: [Key; 1] = [("nu", -0.5, 0.49, "a ratio of -0.5 to 0.49", None)];
const SECOND_TERM: [Key; 2] = [
    ("mu2_ratio", -0.9, 10.0, "a ratio of -0.9 to 10, not 0", None),
    ("alpha2", -50.0, 50.0, "an exponent of -50 to 50, not 0", None),
];
const SOFTENING: [Key; 3] = [
    ("r", 1.001, 1e3, "a number of 1.001 to 1000", None),
    ("m_MPa", 0.0, 1e3, "an energy of 0 to 1000 MPa", None),
    ("beta", 0.0, 10.0, "a number of 0 to 10, positive if m_MPa is 0", Some(0.1)),
];
const FRICTION: [Key; 1] = [("coefficient", 0.0, 2.0, "a coefficient of 0 to 2", None)];
const ADHESION: [Key; 2] = [
    ("work_N_per_mm", TINY, 1.0, "a work of adhesion above 0, to 1 N/mm", None),
    ("range_mm", 0.005, 1.0, "a range of 0.005 to 1 mm", Some(0.05)),
];
const CONTACT_OFFSET: [Key; 1] = [("offset_mm", -2.0, 2.0, "an offset of -2 to 2 mm", None)];
const COMPLIANCE: [Key; 1] = [("mm_per_N", 0.0, 100.0, "a compliance of 0 to 100 mm/N", None)];
const DEPTH_GAIN: [Key; 1] = [("gain", 0.5, 2.0, "a gain of 0.5 to 2", None)];
const TIME_GAIN: [Key; 1] = [("gain", 0.5, 2.0, "a gain of 0.5 to 2", None)];
const SENSOR_GAIN: [Key; 1] = [("gain", 0.01, 100.0, "a gain of 0.01 to 100", None)];
const SENSOR_NONLINEARITY: [Key; 1] = [("quadratic_per_N", -1e6, 1e6, "a number of -1000000 to 1000000 1/N", None)];
const DRIFT: [Key; 3] = [
    ("N_per_h", -1e3, 1e3, "a drift of -1000 to 1000 N/h", Some(0.0)),
    ("thermal_N", -1e3, 1e3, "a force of -1000 to 1000 N", Some(0.0)),
    ("thermal_s", 1.0, 1e6, "a time of 1 to 1000000 s", Some(600.0)),
];
const POWER_LAW: [Key; 3] = [
    ("amplitude", 0.0, 1.0, "a part of 0 to 1", None),
    ("t0_s", 1e-3, 1e4, "a time of 0.001 to 10000 s", Some(0.1)),
    ("beta", 0.01, 2.0, "an exponent of 0.01 to 2", Some(0.3)),
];
const PLASTIC_SET: [Key; 1] = [("share", 0.0, 0.5, "a part of 0 to 0.5", None)];
const STIFF_SKIN: [Key; 1] = [("stiffness_N_per_mm2", 0.0, 1e3, "a stiffness of 0 to 1000 N/mm2", None)];
const ANISOTROPIC: [Key; 2] = [
    ("depth_power", -1.0, 1.0, "an exponent of -1 to 1", None),
    ("radius_power", -2.0, 2.0, "an exponent of -2 to 2", Some(0.0)),
];
const TILT: [Key; 2] = [
    ("angle_deg", -30.0, 30.0, "an angle of -30 to 30 degrees", None),
    ("distance_mm", 0.0, 100.0, "a distance of 0 to 100 mm", Some(10.0)),
];
const HUM: [Key; 2] = [
    ("amplitude_N", 0.0, 1e3, "an amplitude of 0 to 1000 N", None),
    ("frequency_hz", 0.01, 1e4, "a frequency of 0.01 to 10000 Hz", Some(50.0)),
];
const STICK_SLIP: [Key; 2] = [
    ("amplitude_N", 0.0, 1e3, "an amplitude of 0 to 1000 N", None),
    ("period_mm", 0.01, 10.0, "a way of 0.01 to 10 mm", Some(0.3)),
];

/// The codes, in physical order.
const CODES: [&str; 27] = [
    "thickness",
    "relaxation",
    "poisson",
    "second-term",
    "softening",
    "friction",
    "adhesion",
    "contact-offset",
    "depth-gain",
    "compliance",
    "radius",
    "lag",
    "sensor-gain",
    "sensor-nonlinearity",
    "sensor-creep",
    "drift",
    "time-gain",
    "numerics",
    "outside-power-law",
    "outside-plastic-set",
    "outside-stiff-skin",
    "outside-anisotropic",
    "outside-tilt",
    "outside-hum",
    "outside-stick-slip",
    "outside-rest",
    "placebo",
];

/// Reads an `[[effect]]`.
///
/// # Errors
/// Unknown codes and keys, missing values and values out of their range, with their place.
pub(crate) fn effect(section: &Section<'_>) -> Result<Effect, ExperimentError> {
    let words = CODES.map(|code| (code, code));
    let code = section
        .word("code", &words)?
        .ok_or_else(|| section.missing("code", "the effect, such as \"relaxation\" or \"compliance\""))?;
    let all = |keys: &[Key]| numbers(section, keys);
    Ok(match code {
        "relaxation" => relaxation(section)?,
        "poisson" => Effect::Poisson { nu: all(&POISSON)?[0] },
        "second-term" => {
            let v = all(&SECOND_TERM)?;
            for (at, (key, _, _, expected, _)) in SECOND_TERM.iter().enumerate() {
                if let Some(value) = section.value(key).filter(|_| v[at] == 0.0) {
                    return Err(section.bad(key, value, expected));
                }
            }
            Effect::SecondTerm { mu2_ratio: v[0], alpha2: v[1] }
        }
        "softening" => {
            let v = all(&SOFTENING)?;
            if let Some(value) = section.value("beta").filter(|_| v[1] + v[2] <= 0.0) {
                return Err(section.bad("beta", value, SOFTENING[2].3));
            }
            Effect::Softening { r: v[0], m_mpa: v[1], beta: v[2] }
        }
        "thickness" => thickness(section)?,
        "friction" => Effect::Friction { coefficient: all(&FRICTION)?[0] },
        "adhesion" => {
            let v = all(&ADHESION)?;
            Effect::Adhesion { work_n_per_mm: v[0], range_mm: v[1] }
        }
        "contact-offset" => Effect::ContactOffset { offset_mm: all(&CONTACT_OFFSET)?[0] },
        "depth-gain" => Effect::DepthGain { gain: all(&DEPTH_GAIN)?[0] },
        "time-gain" => Effect::TimeGain { gain: all(&TIME_GAIN)?[0] },
        "compliance" => Effect::Compliance { mm_per_n: all(&COMPLIANCE)?[0] },
        "radius" => radius(section)?,
        "lag" => lag(section)?,
        "sensor-gain" => Effect::SensorGain { gain: all(&SENSOR_GAIN)?[0] },
        "sensor-nonlinearity" => Effect::SensorNonlinearity { quadratic_per_n: all(&SENSOR_NONLINEARITY)?[0] },
        "sensor-creep" => creep(section)?,
        "drift" => {
            let v = all(&DRIFT)?;
            Effect::Drift { n_per_h: v[0], thermal_n: v[1], thermal_s: v[2] }
        }
        "numerics" => numerics(section)?,
        "outside-power-law" => {
            let v = all(&POWER_LAW)?;
            Effect::PowerLaw { amplitude: v[0], t0_s: v[1], beta: v[2] }
        }
        "outside-plastic-set" => Effect::PlasticSet { share: all(&PLASTIC_SET)?[0] },
        "outside-stiff-skin" => Effect::StiffSkin { stiffness_n_per_mm2: all(&STIFF_SKIN)?[0] },
        "outside-anisotropic" => {
            let v = all(&ANISOTROPIC)?;
            Effect::Anisotropic { depth_power: v[0], radius_power: v[1] }
        }
        "outside-tilt" => {
            let v = all(&TILT)?;
            Effect::Tilt { angle_deg: v[0], distance_mm: v[1] }
        }
        "outside-hum" => {
            let v = all(&HUM)?;
            Effect::Hum { amplitude_n: v[0], frequency_hz: v[1] }
        }
        "outside-stick-slip" => {
            let v = all(&STICK_SLIP)?;
            Effect::StickSlip { amplitude_n: v[0], period_mm: v[1] }
        }
        "outside-rest" => rest(section)?,
        _ => placebo(section)?,
    })
}

/// The numbers of the keys; nothing but these and `code` may stand there.
fn numbers(section: &Section<'_>, keys: &[Key]) -> Result<Vec<f64>, ExperimentError> {
    let mut known = vec!["code"];
    known.extend(keys.iter().map(|key| key.0));
    section.only(&known)?;
    keys.iter().map(|key| one(section, key)).collect()
}

fn one(section: &Section<'_>, (key, low, high, expected, left_out): &Key) -> Result<f64, ExperimentError> {
    let found = section.number(key, *low..=*high, expected)?;
    found.or(*left_out).ok_or_else(|| section.missing(key, expected))
}

fn relaxation(section: &Section<'_>) -> Result<Effect, ExperimentError> {
    let known = RELAXATION.iter().flatten().map(|key| key.0);
    section.only(&std::iter::once("code").chain(known).collect::<Vec<_>>())?;
    let mut terms = Vec::new();
    for (at, [g, k, tau]) in RELAXATION.iter().enumerate() {
        let stands = |key: &Key| section.value(key.0).is_some();
        if at == 0 || stands(g) || stands(k) {
            let shear = one(section, g)?;
            let bulk = section.number(k.0, k.1..=k.2, k.3)?.unwrap_or(shear);
            terms.push(PronyTerm { g: shear, k: bulk, tau_s: one(section, tau)? });
        }
    }
    for (name, sum) in [("g", terms.iter().map(|t| t.g).sum::<f64>()), ("k", terms.iter().map(|t| t.k).sum())] {
        if sum >= 1.0 {
            let problem = format!("the parts {name}1 and {name}2 add up to {sum}; expected less than 1");
            return Err(section.document.error(section.span.clone(), Problem::Contradiction(problem)));
        }
    }
    Ok(Effect::Relaxation(terms))
}

/// One of two keys, not both.
fn either(section: &Section<'_>, keys: [&str; 2]) -> Result<bool, ExperimentError> {
    match keys.map(|key| section.value(key).is_some()) {
        [true, false] => Ok(true),
        [false, true] => Ok(false),
        _ => {
            let problem = format!("{} has `{}` or `{}`; expected one of the two", section.name, keys[0], keys[1]);
            Err(section.document.error(section.span.clone(), Problem::Contradiction(problem)))
        }
    }
}

fn thickness(section: &Section<'_>) -> Result<Effect, ExperimentError> {
    section.only(&["code", "height_error_mm", "base"])?;
    if either(section, ["height_error_mm", "base"])? {
        let key = ("height_error_mm", -100.0, 100.0, "a length of -100 to 100 mm", None);
        return Ok(Effect::Thickness { height_error_mm: one(section, &key)? });
    }
    section.word("base", &[("sliding", ())])?;
    Ok(Effect::SlidingBase)
}

fn lag(section: &Section<'_>) -> Result<Effect, ExperimentError> {
    section.only(&["code", "lag_s", "rate_limit_mm_s"])?;
    if either(section, ["lag_s", "rate_limit_mm_s"])? {
        return Ok(Effect::Lag { lag_s: one(section, &("lag_s", 0.0, 10.0, "a time of 0 to 10 s", None))? });
    }
    let key = ("rate_limit_mm_s", 1e-3, 1e4, "a rate of 0.001 to 10000 mm/s", None);
    Ok(Effect::RateLimit { rate_mm_s: one(section, &key)? })
}

fn creep(section: &Section<'_>) -> Result<Effect, ExperimentError> {
    section.only(&["code", "amplitude", "tau_s", "width"])?;
    if either(section, ["amplitude", "width"])? {
        let amplitude = one(section, &("amplitude", -0.9, 10.0, "a part of -0.9 to 10", None))?;
        let tau_s = one(section, &("tau_s", 1e-3, 1e5, "a time of 0.001 to 100000 s", None))?;
        return Ok(Effect::SensorCreep { amplitude, tau_s });
    }
    Ok(Effect::SensorHysteresis { width: one(section, &("width", 0.0, 0.5, "a part of 0 to 0.5", None))? })
}

fn numerics(section: &Section<'_>) -> Result<Effect, ExperimentError> {
    section.only(&["code", "mesh", "alpha_step"])?;
    let mesh = section.number("mesh", 0.3..=6.0, "a divisor of the element sizes of 0.3 to 6")?;
    let alpha_step = section.number("alpha_step", 0.1..=20.0, "a step of 0.1 to 20")?;
    if mesh.is_none() && alpha_step.is_none() {
        return Err(section.missing("mesh", "a divisor of the element sizes of 0.3 to 6; or an alpha_step"));
    }
    Ok(Effect::Numerics { mesh, alpha_step })
}

fn radius(section: &Section<'_>) -> Result<Effect, ExperimentError> {
    section.only(&["code", "indenter", "error_mm"])?;
    let expected = "the name of an indenter";
    let indenter = section.text("indenter", expected)?.ok_or_else(|| section.missing("indenter", expected))?;
    let error_mm = one(section, &("error_mm", -20.0, 20.0, "a length of -20 to 20 mm", None))?;
    Ok(Effect::Radius { indenter: indenter.to_owned(), error_mm })
}

fn placebo(section: &Section<'_>) -> Result<Effect, ExperimentError> {
    section.only(&["code", "variable", "amplitude"])?;
    let variable = section.word("variable", &Variable::ALL)?;
    let variable = variable.ok_or_else(|| section.missing("variable", "such as \"depth\" or \"rate\""))?;
    let amplitude = one(section, &("amplitude", 0.0, 1.0, "a part of the largest force, 0 to 1", None))?;
    Ok(Effect::Placebo { variable, amplitude })
}

fn rest(section: &Section<'_>) -> Result<Effect, ExperimentError> {
    section.only(&["code", "along", "by", "kernel", "length", "amplitude", "of", "draw"])?;
    let along = section.word("along", &Along::ALL)?;
    let along = along.ok_or_else(|| section.missing("along", "such as \"depth\" or \"time\""))?;
    let by = section.word("by", &Along::ALL)?;
    if let Some(value) = section.value("by").filter(|_| by == Some(along)) {
        return Err(section.bad("by", value, "another variable than that of `along`"));
    }
    let kernel = section.word("kernel", &Kernel::ALL)?.unwrap_or(Kernel::Matern52);
    let length = one(section, &("length", 0.01, 100.0, "a part of the variable's range, 0.01 to 100", Some(0.5)))?;
    let amplitude = one(section, &("amplitude", 0.0, 1.0, "a share of the force, 0 to 1", None))?;
    let of = section.word("of", &ShareOf::ALL)?.unwrap_or(ShareOf::Force);
    let expected = "a whole number of 0 to 1000000";
    let draw = one(section, &("draw", 0.0, 1e6, expected, Some(0.0)))?;
    if let Some(value) = section.value("draw").filter(|_| draw.fract() != 0.0) {
        return Err(section.bad("draw", value, expected));
    }
    Ok(Effect::Rest(Rest { along, by, kernel, length, amplitude, of, draw: draw as u32 }))
}
