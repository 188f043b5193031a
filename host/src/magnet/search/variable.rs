//! A parameter of a magnet that a search varies.

/// A parameter with its range.
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    /// Its name in the file.
    pub name: String,
    /// The least value.
    pub from: f64,
    /// The largest value.
    pub to: f64,
    /// Distance between the values that it may have, from the least on; 0 for any.
    pub step: f64,
}

impl Variable {
    /// Reads `turns=300:1500:10` or `gap=4:12`.
    ///
    /// # Errors
    /// What is wrong, in a sentence.
    pub fn parse(text: &str) -> Result<Self, String> {
        let bad = |what: &str| format!("--vary is {text}: {what}; expected NAME=FROM:TO or NAME=FROM:TO:STEP");
        let (name, range) = text.split_once('=').ok_or_else(|| bad("there is no ="))?;
        let number = |part: &str| {
            let value = part.trim().parse::<f64>().ok().filter(|v| v.is_finite());
            value.ok_or_else(|| bad(&format!("\"{part}\" is no number")))
        };
        let parts = range.split(':').map(number).collect::<Result<Vec<f64>, String>>()?;
        let (from, to, step) = match parts.as_slice() {
            [from, to] => (*from, *to, 0.0),
            [from, to, step] if *step > 0.0 => (*from, *to, *step),
            [_, _, _] => return Err(bad("the step must be more than 0")),
            _ => return Err(bad("one or two colons are wanted")),
        };
        if to <= from {
            return Err(bad("TO must be more than FROM"));
        }
        Ok(Self { name: name.trim().to_owned(), from, to, step })
    }

    /// One that is not varied.
    pub fn fixed(name: &str, value: f64) -> Self {
        Self { name: name.to_owned(), from: value, to: value, step: 0.0 }
    }

    /// The value at a part of its range, 0 to 1.
    pub fn at(&self, part: f64) -> f64 {
        if self.step == 0.0 {
            return self.from + part * (self.to - self.from);
        }
        let steps = ((self.to - self.from) / self.step + 1e-9).floor();
        // every value has a range as wide
        self.from + self.step * (part * (steps + 1.0)).floor().min(steps)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn steps_are_kept_and_ends_are_reached() {
        let wire = Variable::parse("wire=24:32:2").unwrap();
        let values: Vec<f64> = (0..=10).map(|i| wire.at(f64::from(i) / 10.0)).collect();
        assert_eq!(values, [24.0, 24.0, 26.0, 26.0, 28.0, 28.0, 30.0, 30.0, 32.0, 32.0, 32.0]);
        assert_eq!(Variable::parse("gap=4:12").unwrap().at(0.25), 6.0);
    }

    #[test]
    fn bad_ranges_are_told() {
        for (text, told) in [
            ("gap", "there is no ="),
            ("gap=4", "one or two colons"),
            ("gap=4:x", "\"x\" is no number"),
            ("gap=4:4", "TO must be more than FROM"),
            ("gap=4:9:0", "the step must be more than 0"),
        ] {
            assert!(Variable::parse(text).unwrap_err().contains(told), "{text}");
        }
    }
}
