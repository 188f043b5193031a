//! Columns that a kind of test cannot do without.

use super::super::Test;
use super::super::format::Pace;

/// Columns of a display run: what it was told and what was measured, in pairs of which a run has at least one.
pub const DISPLAY_PAIRS: [(&str, &str); 5] = [
    ("command_mm", "position_mm"),
    ("reference_N", "force_N"),
    ("command_A", "current_A"),
    ("current_A", "flux_T"),
    (FINGER, "reference_N"),
];

/// Place of a finger's bone.
pub const FINGER: &str = "finger_mm";
/// What tells on what it presses: the cap's place, or the flux density in the fluid.
pub const UNDER_FINGER: [&str; 2] = ["position_mm", "flux_T"];

/// Gap of a display's magnet: a column of its own, the same in all rows.
pub const GAP_MM: &str = "gap_mm";

/// What a run needs of its file.
pub(crate) struct Need {
    /// Names of columns, and why each is needed.
    pub columns: Vec<(&'static str, &'static str)>,
    /// Columns that may be missing but must hold numbers where they are there.
    pub numbers: &'static [&'static str],
    /// Time of a file without a time column.
    pub pace: Option<Pace>,
}

impl Need {
    /// Of a kind of test, with or without a stated pace.
    pub fn of(test: Test, pace: Option<Pace>) -> Self {
        const TIME: (&str, &str) = ("time_s", "every run needs time");
        let mut columns = match test {
            Test::Air | Test::Mass => vec![TIME, ("force_N", "the run measures force")],
            Test::Display => vec![TIME],
            Test::Table => vec![],
            Test::Print => vec![("force_N", "a print without force says nothing")],
            _ => vec![
                TIME,
                ("depth_mm", "force without depth says nothing"),
                ("force_N", "depth without force says nothing"),
            ],
        };
        if pace.is_some() {
            columns.retain(|column| *column != TIME);
        }
        let numbers: &[_] = match test {
            Test::Display => &[
                "command_mm",
                "position_mm",
                "reference_N",
                "force_N",
                "command_A",
                "current_A",
                "flux_T",
                FINGER,
                GAP_MM,
            ],
            Test::Print => &["area_mm2", "a_mm", "b_mm"],
            _ => &[],
        };
        Self { columns, numbers, pace }
    }

    /// True for a column without which the run says nothing.
    pub fn includes(&self, wanted: &str) -> bool {
        self.columns.iter().any(|(name, _)| *name == wanted)
    }
}
