//! One thing that was looked at.

use serde::Serialize;

/// Part of the self test.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Step {
    /// Chip, supply, clock.
    Chip,
    /// Analog readings.
    Converter,
    /// PWM to converter over the three wires.
    Wires,
    /// Levels of the driven pins.
    Pins,
    /// Arithmetic, to the bit.
    Arithmetic,
    /// Erase and write while everything runs.
    Flash,
    /// Bytes there and back.
    Links,
    /// Permit of the outputs.
    Interlock,
    /// Runs that end badly.
    Ends,
}

impl Step {
    /// Its word.
    pub const fn name(self) -> &'static str {
        match self {
            Step::Chip => "chip",
            Step::Converter => "converter",
            Step::Wires => "wires",
            Step::Pins => "pins",
            Step::Arithmetic => "arithmetic",
            Step::Flash => "flash",
            Step::Links => "links",
            Step::Interlock => "interlock",
            Step::Ends => "ends",
        }
    }
}

/// What came of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    /// As expected.
    Passed,
    /// Not as expected.
    Failed,
    /// Could not be looked at.
    NotTested,
}

/// A thing, what was found and what was expected.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Check {
    /// Part of the test.
    pub step: Step,
    /// The thing.
    pub what: String,
    /// What was found.
    pub found: String,
    /// What was expected.
    pub expected: String,
    /// What to look at where it was not found; may be empty.
    pub help: &'static str,
    /// What came of it.
    pub outcome: Outcome,
}

impl Check {
    /// A check that can fail.
    pub fn new(
        step: Step,
        what: impl Into<String>,
        found: impl Into<String>,
        expected: impl Into<String>,
        passed: bool,
    ) -> Self {
        let outcome = if passed { Outcome::Passed } else { Outcome::Failed };
        Check { step, what: what.into(), found: found.into(), expected: expected.into(), help: "", outcome }
    }

    /// The same with what to look at if it fails.
    #[must_use]
    pub fn or_look_at(mut self, help: &'static str) -> Self {
        self.help = help;
        self
    }

    /// One that was not made, and what would help.
    pub fn not_tested(step: Step, what: impl Into<String>, help: &'static str) -> Self {
        let found = "not tested".to_owned();
        Check { step, what: what.into(), found, expected: String::new(), help, outcome: Outcome::NotTested }
    }

    /// One line: word, step, thing, found; what was expected unless it says the same, and what to look at.
    pub fn line(&self) -> String {
        let word = match self.outcome {
            Outcome::Passed => "ok",
            Outcome::Failed => "FAILED",
            Outcome::NotTested => "-",
        };
        let expected = match self.outcome {
            Outcome::Failed => format!(", expected {}", self.expected),
            Outcome::Passed if self.expected != self.found => format!(" ({})", self.expected),
            _ => String::new(),
        };
        let help = match self.outcome {
            Outcome::Passed => "",
            _ => self.help,
        };
        let colon = if help.is_empty() { "" } else { "; " };
        format!("{word:<7} {:<11} {}: {}{expected}{colon}{help}", self.step.name(), self.what, self.found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_says_what_was_expected_only_where_it_tells_more() {
        let check = |found: &str, passed| {
            Check::new(Step::Chip, "brown-out level", found, "3", passed).or_look_at("palpate flash --setup sets it")
        };
        assert_eq!(check("3", true).line(), "ok      chip        brown-out level: 3");
        assert_eq!(
            check("0", false).line(),
            "FAILED  chip        brown-out level: 0, expected 3; palpate flash --setup sets it"
        );
        let left = Check::not_tested(Step::Links, "USB", "name its port with --usb");
        assert_eq!(left.line(), "-       links       USB: not tested; name its port with --usb");
        let timed = Check::new(Step::Flash, "erase", "1009 ms", "at most 2000 ms", true);
        assert_eq!(timed.line(), "ok      flash       erase: 1009 ms (at most 2000 ms)");
    }
}
