//! The file of a display's model: a section a channel, its base law, the base law alone and the effects.

use std::fmt::Write as _;
use std::path::Path;

use super::{Added, ChannelModel, DisplayModel, Known};
use crate::diagnose::display::channel::Channel;
use crate::diagnose::display::effect::{self, Effect};
use crate::experiment::section::{Document, Section};
use crate::experiment::{ExperimentError, Problem as Mistake};
use crate::extended::file::{intervals, needed, twins};
use crate::extended::writing;

impl DisplayModel {
    /// True for the text of a model of a display rather than of a material.
    #[must_use]
    pub fn is_one(text: &str) -> bool {
        text.parse::<toml::Table>().is_ok_and(|table| table.contains_key("channel"))
    }

    /// The text of the file.
    #[must_use]
    pub fn to_toml(&self) -> String {
        let mut out = String::from(
            "# The laws of a display's channels and the effects that a diagnosis found. Units: mm, N, A, T, s, kPa.\n",
        );
        for one in &self.channels {
            let word = one.channel.word();
            let _ = writeln!(out, "\n[channel.{word}]");
            let names = || one.channel.base().iter().map(|p| p.name);
            numbers(&mut out, names(), &one.base);
            if !one.alone.is_empty() {
                let _ = writeln!(out, "\n# the base law alone, fitted to the same runs: gains are beside it");
                let _ = writeln!(out, "[channel.{word}.alone]");
                numbers(&mut out, names(), &one.alone);
            }
            for added in &one.effects {
                let _ = writeln!(out, "\n# instead of: {}", added.effect.assumption);
                let _ = writeln!(out, "[[channel.{word}.effect]]");
                let _ = writeln!(out, "code = \"{}\"\nform = \"{}\"", added.effect.code, added.effect.form);
                numbers(&mut out, added.effect.quantities.iter().map(|q| q.name), &added.values);
                out.push_str(&writing::twins(&added.ambiguous_with));
            }
        }
        out
    }

    /// Reads a model file that is already in memory; `file` is where it would be.
    ///
    /// # Errors
    /// The first mistake, with file, line and column, the key, its value and what was expected.
    pub fn parse(file: &Path, text: &str) -> Result<Self, ExperimentError> {
        let document = Document { file, text };
        let root = document.table()?;
        let root = Section::new(document, "the file".to_owned(), 0..0, root.get_ref());
        root.only(&["channel"])?;
        let mut channels = Vec::new();
        for (name, section) in root.named("channel")? {
            let channel = Channel::ALL.into_iter().find(|channel| channel.word() == name).ok_or_else(|| {
                let known = Channel::ALL.map(|channel| channel.word().to_owned()).to_vec();
                let problem = Mistake::UnknownName { key: "channel".to_owned(), name: name.clone(), known };
                document.error(section.span.clone(), problem)
            })?;
            channels.push(read_channel(channel, &section)?);
        }
        channels.sort_by_key(|one: &ChannelModel| one.channel);
        Ok(Self { channels })
    }
}

fn numbers<'a>(out: &mut String, names: impl Iterator<Item = &'a str> + Clone, known: &[Known]) {
    for (name, (value, _)) in names.clone().zip(known) {
        let _ = writeln!(out, "{name} = {value:?}");
    }
    let each = names.zip(known.iter().map(|(_, interval)| *interval));
    out.push_str(&writing::intervals(each).unwrap_or_default());
}

/// Numbers of a section in their bounds, with their intervals.
fn read_numbers(section: &Section<'_>, known: &[(&'static str, (f64, f64))]) -> Result<Vec<Known>, ExperimentError> {
    let names: Vec<&str> = known.iter().map(|(name, _)| *name).collect();
    let intervals = intervals(section, &names)?;
    let mut out = Vec::new();
    for ((name, (low, high)), interval) in known.iter().zip(intervals) {
        let expected = format!("a number from {low} to {high}");
        out.push((needed(section, name, &expected, section.number(name, *low..=*high, &expected)?)?, interval));
    }
    Ok(out)
}

fn read_channel(channel: Channel, section: &Section<'_>) -> Result<ChannelModel, ExperimentError> {
    let known: Vec<(&'static str, (f64, f64))> = channel.base().iter().map(|p| (p.name, p.bounds)).collect();
    let keys: Vec<&str> = known.iter().map(|(name, _)| *name).chain(["interval95", "alone", "effect"]).collect();
    section.only(&keys)?;
    let base = read_numbers(section, &known)?;
    let alone = match section.section("alone", format!("[channel.{}.alone]", channel.word()))? {
        Some(own) => {
            let names: Vec<&str> = known.iter().map(|(name, _)| *name).collect();
            own.only(&names)?;
            read_numbers(&own, &known)?
        }
        None => Vec::new(),
    };
    let mut effects: Vec<Added> = Vec::new();
    for own in section.array("effect")? {
        let added = read_effect(channel, &own)?;
        if effects.iter().any(|other| other.effect.code == added.effect.code) {
            let text = format!("[[effect]] {} is there twice; expected each effect once", added.effect.code);
            return Err(own.document.error(own.span.clone(), Mistake::Contradiction(text)));
        }
        effects.push(added);
    }
    Ok(ChannelModel { channel, base, alone, effects })
}

fn read_effect(channel: Channel, section: &Section<'_>) -> Result<Added, ExperimentError> {
    let all: Vec<&'static Effect> = effect::CATALOGUE.iter().copied().filter(|e| e.channel == channel).collect();
    let mut codes: Vec<(&str, &'static str)> = all.iter().map(|e| (e.code, e.code)).collect();
    codes.dedup();
    let code = needed(section, "code", "the code of an effect of the channel", section.word("code", &codes)?)?;
    let forms: Vec<(&str, &'static Effect)> = all.iter().filter(|e| e.code == code).map(|e| (e.form, *e)).collect();
    let found = section.word("form", &forms)?.or_else(|| forms.first().map(|(_, effect)| *effect));
    let effect = needed(section, "form", "a form of the effect", found)?;
    let known: Vec<(&'static str, (f64, f64))> = effect.quantities.iter().map(|q| (q.name, q.bounds)).collect();
    let mut keys: Vec<&str> = known.iter().map(|(name, _)| *name).collect();
    keys.extend(["code", "form", "interval95", "ambiguous_with"]);
    section.only(&keys)?;
    let ambiguous_with = twins(section, &codes.iter().map(|(code, _)| *code).collect::<Vec<_>>())?;
    Ok(Added { effect, values: read_numbers(section, &known)?, ambiguous_with })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::diagnose::display::effect::{delay, rate_limit};

    fn model() -> DisplayModel {
        let one = |value: f64| (value, Some((0.9 * value, 1.1 * value)));
        let added = |effect, value: f64, ambiguous_with| Added { effect, values: vec![one(value)], ambiguous_with };
        let position = ChannelModel {
            channel: Channel::Position,
            base: vec![one(1.02), (0.03, None), one(85.0), one(23.0)],
            alone: vec![(1.01, None), (0.02, None), (80.0, None), (25.0, None)],
            effects: vec![
                added(&rate_limit::EFFECT, 12.5, vec!["stiction".to_owned()]),
                added(&delay::EFFECT, 0.031, Vec::new()),
            ],
        };
        DisplayModel { channels: vec![position] }
    }

    #[test]
    fn what_is_written_is_read_again() {
        let text = model().to_toml();
        assert!(DisplayModel::is_one(&text), "{text}");
        assert_eq!(DisplayModel::parse(Path::new("m.toml"), &text).unwrap(), model());
        assert_eq!(model().channels[0].law().settings.len(), 2);
    }

    #[test]
    fn mistakes_are_told_with_their_place() {
        let told = |from: &str, to: &str| {
            let text = model().to_toml().replacen(from, to, 1);
            DisplayModel::parse(Path::new("m.toml"), &text).unwrap_err().to_string()
        };
        let bad = told("limit_mm_per_s = 12.5", "limit_mm_per_s = -1.0");
        assert!(bad.contains("m.toml") && bad.contains("limit_mm_per_s") && bad.contains("0.5 to 500"), "{bad}");
        let bad = told("code = \"delay\"", "code = \"saturation\"");
        assert!(bad.contains("saturation") && bad.contains("rate-limit"), "{bad}");
        let bad = told("[channel.position]", "[channel.heat]");
        assert!(bad.contains("heat") && bad.contains("position"), "{bad}");
        let bad = told("gain = 1.02\n", "");
        assert!(bad.contains("gain"), "{bad}");
    }
}
