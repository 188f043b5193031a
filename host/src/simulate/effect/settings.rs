//! Effects as they are written.

use lut_gen::solid::law::PronyTerm;

use super::{Along, Effect, Kernel, ShareOf, Variable};

/// A parameter as written in a file.
#[derive(Debug, Clone, PartialEq)]
pub enum Setting {
    /// A number.
    Number(f64),
    /// A word.
    Word(String),
}

impl Effect {
    /// Parameters by the keys of a specification.
    #[must_use]
    pub fn parameters(&self) -> Vec<(String, Setting)> {
        let n = |list: &[(&str, f64)]| list.iter().map(|(k, v)| ((*k).to_owned(), Setting::Number(*v))).collect();
        let word = |key: &str, word: &str| (key.to_owned(), Setting::Word(word.to_owned()));
        match self {
            Self::Relaxation(terms) => {
                let one = |(i, term): (usize, &PronyTerm)| {
                    let key = |name: &str, unit: &str| format!("{name}{}{unit}", i + 1);
                    let bulk = (term.k != term.g).then(|| (key("k", ""), Setting::Number(term.k)));
                    let shear = (key("g", ""), Setting::Number(term.g));
                    [Some(shear), bulk, Some((key("tau", "_s"), Setting::Number(term.tau_s)))].into_iter().flatten()
                };
                terms.iter().enumerate().flat_map(one).collect()
            }
            Self::Poisson { nu } => n(&[("nu", *nu)]),
            Self::SecondTerm { mu2_ratio, alpha2 } => n(&[("mu2_ratio", *mu2_ratio), ("alpha2", *alpha2)]),
            Self::Softening { r, m_mpa, beta } => n(&[("r", *r), ("m_MPa", *m_mpa), ("beta", *beta)]),
            Self::Thickness { height_error_mm } => n(&[("height_error_mm", *height_error_mm)]),
            Self::SlidingBase => vec![word("base", "sliding")],
            Self::Friction { coefficient } => n(&[("coefficient", *coefficient)]),
            Self::Adhesion { work_n_per_mm, range_mm } => {
                n(&[("work_N_per_mm", *work_n_per_mm), ("range_mm", *range_mm)])
            }
            Self::ContactOffset { offset_mm } => n(&[("offset_mm", *offset_mm)]),
            Self::DepthGain { gain } | Self::TimeGain { gain } => n(&[("gain", *gain)]),
            Self::Compliance { mm_per_n } => n(&[("mm_per_N", *mm_per_n)]),
            Self::Radius { indenter, error_mm } => {
                vec![word("indenter", indenter), ("error_mm".to_owned(), Setting::Number(*error_mm))]
            }
            Self::Lag { lag_s } => n(&[("lag_s", *lag_s)]),
            Self::RateLimit { rate_mm_s } => n(&[("rate_limit_mm_s", *rate_mm_s)]),
            Self::SensorGain { gain } => n(&[("gain", *gain)]),
            Self::SensorNonlinearity { quadratic_per_n } => n(&[("quadratic_per_N", *quadratic_per_n)]),
            Self::SensorCreep { amplitude, tau_s } => n(&[("amplitude", *amplitude), ("tau_s", *tau_s)]),
            Self::SensorHysteresis { width } => n(&[("width", *width)]),
            Self::Drift { n_per_h, thermal_n, thermal_s } => {
                n(&[("N_per_h", *n_per_h), ("thermal_N", *thermal_n), ("thermal_s", *thermal_s)])
            }
            Self::Numerics { mesh, alpha_step } => {
                let given = [("mesh", *mesh), ("alpha_step", *alpha_step)];
                n(&given.iter().filter_map(|(k, v)| v.map(|v| (*k, v))).collect::<Vec<_>>())
            }
            Self::PowerLaw { amplitude, t0_s, beta } => {
                n(&[("amplitude", *amplitude), ("t0_s", *t0_s), ("beta", *beta)])
            }
            Self::PlasticSet { share } => n(&[("share", *share)]),
            Self::StiffSkin { stiffness_n_per_mm2 } => n(&[("stiffness_N_per_mm2", *stiffness_n_per_mm2)]),
            Self::Anisotropic { depth_power, radius_power } => {
                n(&[("depth_power", *depth_power), ("radius_power", *radius_power)])
            }
            Self::Tilt { angle_deg, distance_mm } => n(&[("angle_deg", *angle_deg), ("distance_mm", *distance_mm)]),
            Self::Hum { amplitude_n, frequency_hz } => {
                n(&[("amplitude_N", *amplitude_n), ("frequency_hz", *frequency_hz)])
            }
            Self::StickSlip { amplitude_n, period_mm } => {
                n(&[("amplitude_N", *amplitude_n), ("period_mm", *period_mm)])
            }
            Self::Rest(rest) => {
                let mut all = vec![word("along", word_of(&Along::ALL, rest.along))];
                all.extend(rest.by.map(|by| word("by", word_of(&Along::ALL, by))));
                all.push(word("kernel", word_of(&Kernel::ALL, rest.kernel)));
                all.extend(n(&[("length", rest.length), ("amplitude", rest.amplitude)]));
                all.push(word("of", word_of(&ShareOf::ALL, rest.of)));
                all.extend(n(&[("draw", f64::from(rest.draw))]));
                all
            }
            Self::Placebo { variable, amplitude } => {
                vec![
                    word("variable", word_of(&Variable::ALL, *variable)),
                    ("amplitude".to_owned(), Setting::Number(*amplitude)),
                ]
            }
        }
    }

    /// The effect as an `[[effect]]` of a specification.
    #[must_use]
    pub fn to_toml(&self) -> String {
        let mut text = format!("[[effect]]\ncode = \"{}\"\n", self.code());
        for (key, setting) in self.parameters() {
            match setting {
                Setting::Number(value) => text.push_str(&format!("{key} = {value:?}\n")),
                Setting::Word(word) => text.push_str(&format!("{key} = \"{word}\"\n")),
            }
        }
        text
    }
}

/// The word of a choice.
fn word_of<T: PartialEq>(all: &[(&'static str, T)], one: T) -> &'static str {
    all.iter().find(|(_, other)| *other == one).map_or("", |(word, _)| *word)
}
