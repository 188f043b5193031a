//! Writing `actuator.toml`.

use std::fmt::Write;

use super::{Actuator, Form, Known, Pole};

impl Actuator {
    /// The file, which [`super::parse`] reads as the same actuator.
    pub fn to_toml(&self) -> String {
        let mut text = String::new();
        let quoted = |text: &str| toml::Value::String(text.to_owned()).to_string();
        let _ = writeln!(text, "title = {}", quoted(&self.title));
        if !self.source.is_empty() {
            let _ = writeln!(text, "source = {}", quoted(&self.source));
        }
        let mut intervals = Vec::new();
        let mut line = |key: &str, comment: &str, known: Known| {
            let _ = writeln!(text, "{key} = {:?}  # {comment}", known.value);
            intervals.extend(known.interval95.map(|ends| format!("{key} = {}", pair(ends))));
        };
        line("delay_s", "dead time of the plant, without the board's tick", self.delay_s);
        if let Some(rate) = self.rate_limit_mm_per_s {
            line("rate_limit_mm_per_s", "largest speed", rate);
        }
        line("friction_v", "the command that a resting shaft resists", self.friction_v);
        line("backlash_mm", "whole width of the gap", self.backlash_mm);
        if self.back_mm_per_n.value != 0.0 {
            line("back_mm_per_n", "how far a force on the shaft drives it back, mm/N", self.back_mm_per_n);
        }
        let _ = writeln!(text, "command_limit_v = {:?}", self.command_limit_v);
        if !intervals.is_empty() {
            let _ = writeln!(text, "interval95 = {{ {} }}", intervals.join(", "));
        }
        let _ = writeln!(text, "\n[plant]  # command in V to shaft in mm");
        match &self.form {
            Form::Coefficients { numerator, denominator } => {
                let lists = [("numerator", numerator), ("denominator", denominator)];
                for (key, list) in lists {
                    let values: Vec<String> = list.iter().map(|known| format!("{:?}", known.value)).collect();
                    let _ = writeln!(text, "{key} = [{}]", values.join(", "));
                }
                let all = lists.iter().filter_map(|(key, list)| Some(format!("{key} = [{}]", of_all(list)?)));
                bounds(&mut text, &all.collect::<Vec<_>>());
            }
            Form::Poles { gain, poles } => {
                let values: Vec<String> = poles
                    .iter()
                    .map(|pole| match pole {
                        Pole::Real(real) => format!("{:?}", real.value),
                        Pole::Pair(real, imaginary) => format!("[{:?}, {:?}]", real.value, imaginary.value),
                    })
                    .collect();
                let _ = writeln!(text, "gain = {:?}\npoles_per_s = [{}]", gain.value, values.join(", "));
                let one = |pole: &Pole| match pole {
                    Pole::Real(real) => real.interval95.map(pair),
                    Pole::Pair(real, imaginary) => {
                        Some(format!("[{}, {}]", pair(real.interval95?), pair(imaginary.interval95?)))
                    }
                };
                let gain = gain.interval95.map(|ends| format!("gain = {}", pair(ends)));
                let poles = poles.iter().map(one).collect::<Option<Vec<_>>>();
                let poles = poles.map(|list| format!("poles_per_s = [{}]", list.join(", ")));
                bounds(&mut text, &gain.into_iter().chain(poles).collect::<Vec<_>>());
            }
        }
        text
    }
}

fn pair((low, high): (f64, f64)) -> String {
    format!("[{low:?}, {high:?}]")
}

/// Intervals of a list in which one number at least has one; the others are known exactly.
fn of_all(list: &[Known]) -> Option<String> {
    let any = list.iter().any(|known| known.interval95.is_some());
    let one = |known: &Known| pair(known.interval95.unwrap_or((known.value, known.value)));
    any.then(|| list.iter().map(one).collect::<Vec<_>>().join(", "))
}

fn bounds(text: &mut String, all: &[String]) {
    if !all.is_empty() {
        let _ = writeln!(text, "interval95 = {{ {} }}", all.join(", "));
    }
}
