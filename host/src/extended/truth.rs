//! The extended model as the truth of a simulated experiment: finite elements, not the chain that named it.

use lut_gen::effect::{Owner, softening};
use lut_gen::solid::law::PronyTerm;

use crate::simulate::{Effect, Spec, TrueLaw};

use super::{Added, ExtendedError, ExtendedModel};

/// Range of a simulated adhesion, mm: the finite elements need one that their mesh resolves. The model holds the work alone.
const ADHESION_RANGE_MM: f64 = 0.05;
/// Largest part a simulated softening may leave: `r` of Ogden and Roxburgh is its reciprocal, and at most 1000.
const LEAST_LOSS: f64 = 1e-3;
/// Share of free sliding from which on a base counts as free.
pub(super) const SLIDES: f64 = 0.5;

/// Makes every foam of a specification the model's material, and its effects true. What the model has and the simulation cannot
/// have is said in sentences.
///
/// # Errors
/// [`ExtendedError`]: an owner that the specification does not describe, an effect that it has already, no foam in it.
pub fn apply(model: &ExtendedModel, spec: &mut Spec) -> Result<Vec<String>, ExtendedError> {
    let foams = spec.specimens.iter_mut().filter(|s| s.law == TrueLaw::Hyperfoam);
    let mut changed = 0;
    for foam in foams {
        (foam.mu_mpa, foam.alpha) = (model.mu_mpa, model.alpha);
        changed += 1;
    }
    if changed == 0 {
        let text = "a model is given, but no specimen of the specification is of law \"hyperfoam\"";
        return Err(ExtendedError::Contradiction(text.to_owned()));
    }
    let gain = model.effects.iter().find(|a| a.effect.code == "sensor-gain").map_or(1.0, |a| a.values[0]);
    let mut sentences = Vec::new();
    for added in &model.effects {
        if let Some(twin) = spec.effects.iter().find(|e| e.code() == added.effect.code) {
            let text = format!("{} is in the specification and in the model; expected it in one of them", twin.code());
            return Err(ExtendedError::Contradiction(text));
        }
        owned(added, spec)?;
    }
    let mut effects = Vec::new();
    for added in &model.effects {
        effects.extend(effect(added, (model.mu_mpa, gain), &mut sentences)?);
    }
    spec.effects.extend(effects);
    Ok(sentences)
}

/// The owner of an effect is described, and is the only one where the simulation knows one for all.
fn owned(added: &Added, spec: &Spec) -> Result<(), ExtendedError> {
    let (kind, names): (_, Vec<&str>) = match added.effect.owner {
        Owner::All => return Ok(()),
        Owner::Indenter => ("indenter", spec.indenters.iter().map(|one| one.name.as_str()).collect()),
        Owner::Specimen => {
            let soft = |law: &TrueLaw| !matches!(law, TrueLaw::Rigid { .. });
            ("specimen", spec.specimens.iter().filter(|s| soft(&s.law)).map(|one| one.name.as_str()).collect())
        }
    };
    let name = added.owner.as_deref().unwrap_or_default();
    if !names.contains(&name) {
        let (name, known) = (name.to_owned(), names.join(", "));
        return Err(ExtendedError::UnknownOwner { effect: added.effect.code, kind, name, known });
    }
    if kind == "specimen" && names.len() > 1 {
        return Err(ExtendedError::NoPhysics {
            effect: added.effect.code,
            form: added.effect.form,
            why: "a simulation has one such error for all its specimens, and this one has several specimens",
        });
    }
    Ok(())
}

fn effect(
    added: &Added,
    (mu_mpa, gain): (f64, f64),
    sentences: &mut Vec<String>,
) -> Result<Option<Effect>, ExtendedError> {
    let v = &added.values;
    let one = v[0];
    let made = match (added.effect.code, added.effect.form) {
        ("thickness", "height" | "every-height") => Effect::Thickness { height_error_mm: one },
        ("thickness", _) => {
            if one != 0.0 && one != 1.0 {
                sentences.push(format!(
                    "the base slides by {one:.2} of what a free one does: finite elements know bonded and free, taken as {}",
                    if one >= SLIDES { "free" } else { "bonded" }
                ));
            }
            if one < SLIDES {
                return Ok(None);
            }
            Effect::SlidingBase
        }
        ("relaxation", _) => Effect::Relaxation(v.chunks_exact(2).map(|t| PronyTerm::alike(t[0], t[1])).collect()),
        ("poisson", _) => Effect::Poisson { nu: one },
        ("second-term", _) if one != 0.0 => Effect::SecondTerm { mu2_ratio: one, alpha2: v[1] },
        ("softening", _) if one >= LEAST_LOSS => {
            let (r, m, beta) = softening::of_points(one, v[1]);
            Effect::Softening { r, m_mpa: m * mu_mpa, beta }
        }
        ("friction", _) => Effect::Friction { coefficient: one },
        ("adhesion", _) if one > 0.0 => Effect::Adhesion { work_n_per_mm: one, range_mm: ADHESION_RANGE_MM },
        ("contact-offset", _) => Effect::ContactOffset { offset_mm: one },
        ("depth-gain", _) => Effect::DepthGain { gain: one },
        ("time-gain", _) => Effect::TimeGain { gain: one },
        ("compliance", _) => Effect::Compliance { mm_per_n: one },
        ("radius", _) => Effect::Radius { indenter: added.owner.clone().unwrap_or_default(), error_mm: one },
        ("lag", "filter") => Effect::Lag { lag_s: one },
        ("lag", _) if one > 0.0 => Effect::RateLimit { rate_mm_s: 1.0 / one },
        ("sensor-gain", _) => Effect::SensorGain { gain: one },
        // the simulation squares what it has multiplied by the gain
        ("sensor-nonlinearity", _) => Effect::SensorNonlinearity { quadratic_per_n: one / gain },
        ("sensor-creep", "creep") => Effect::SensorCreep { amplitude: gain * one, tau_s: v[1] },
        ("sensor-creep", _) => Effect::SensorHysteresis { width: one },
        ("drift", _) => Effect::Drift { n_per_h: one, thermal_n: 0.0, thermal_s: 600.0 },
        ("numerics", _) => {
            sentences.push(format!(
                "{}: an error of the simulation that was diagnosed, not of the truth: left out",
                added.words()
            ));
            return Ok(None);
        }
        // amounts of nothing
        _ => return Ok(None),
    };
    Ok(Some(made))
}
