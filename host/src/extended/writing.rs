//! The model file as text.

use std::fmt::Write as _;

use lut_gen::effect::Owner;

use crate::experiment::Base;

use super::{Added, ExtendedModel};

/// A key: bare where TOML allows it, else in quotes.
fn key(name: &str) -> String {
    let bare = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    if !name.is_empty() && name.chars().all(bare) { name.to_owned() } else { text(name) }
}

/// A basic string. It stays on one line, so that every value has a line of its own in messages.
pub(super) fn text(words: &str) -> String {
    let mut out = String::from("\"");
    for c in words.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            c if c.is_control() => {
                let _ = write!(out, "\\u{:04X}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

/// Intervals of some names as a key of their own; none where none is known.
pub(super) fn intervals<'a>(all: impl Iterator<Item = (&'a str, Option<(f64, f64)>)>) -> Option<String> {
    let known: Vec<String> = all
        .filter_map(|(name, interval)| interval.map(|(low, high)| format!("{name} = [{low:?}, {high:?}]")))
        .collect();
    (!known.is_empty()).then(|| format!("interval95 = {{ {} }}\n", known.join(", ")))
}

/// Codes that a diagnosis could not tell from one; nothing where there are none.
pub(super) fn twins(codes: &[String]) -> String {
    if codes.is_empty() {
        return String::new();
    }
    let codes: Vec<String> = codes.iter().map(|code| text(code)).collect();
    format!("ambiguous_with = [{}]\n", codes.join(", "))
}

impl ExtendedModel {
    /// The text of the model file.
    #[must_use]
    pub fn to_toml(&self) -> String {
        let mut out =
            String::from("# A material, and the effects that were found beside its law. Units: mm, N, MPa, s.\n");
        let _ = writeln!(out, "material = {}", text(&self.material));
        let _ = writeln!(out, "law = \"hyperfoam\"\nmu_MPa = {:?}\nalpha = {:?}", self.mu_mpa, self.alpha);
        let names = ["mu_MPa", "alpha"].into_iter().zip(self.intervals);
        out.push_str(&intervals(names).unwrap_or_default());
        for ball in &self.indenters {
            let _ = writeln!(out, "\n[indenter.{}]\nradius_mm = {:?}", key(&ball.name), ball.radius_mm);
        }
        for specimen in &self.specimens {
            let _ = writeln!(out, "\n[specimen.{}]\nheight_mm = {:?}", key(&specimen.name), specimen.height_mm);
            if let Some(radius_mm) = specimen.radius_mm {
                let _ = writeln!(out, "radius_mm = {radius_mm:?}");
            }
            let base = if specimen.base == Base::Bonded { "bonded" } else { "sliding" };
            let _ = writeln!(out, "base = \"{base}\"");
        }
        for added in &self.effects {
            effect(&mut out, added);
        }
        out
    }
}

fn effect(out: &mut String, added: &Added) {
    let effect = added.effect;
    let _ = writeln!(out, "\n# instead of: {}", effect.assumption);
    let _ = writeln!(out, "[[effect]]\ncode = \"{}\"\nform = \"{}\"", effect.code, effect.form);
    let _ = writeln!(out, "stage = \"{}\"", effect.stage.word());
    let kind = match effect.owner {
        Owner::All => None,
        Owner::Indenter => Some("indenter"),
        Owner::Specimen => Some("specimen"),
    };
    if let Some((kind, name)) = kind.zip(added.owner.as_ref()) {
        let _ = writeln!(out, "{kind} = {}", text(name));
    }
    for (quantity, value) in effect.quantities.iter().zip(&added.values) {
        let _ = writeln!(out, "{} = {value:?}", quantity.name);
    }
    let names = effect.quantities.iter().map(|q| q.name).zip(added.intervals.iter().copied());
    out.push_str(&intervals(names).unwrap_or_default());
    out.push_str(&twins(&added.ambiguous_with));
}
