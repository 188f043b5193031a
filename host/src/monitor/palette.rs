//! Colours, or none.

use ratatui::style::{Color, Modifier, Style};

/// How things stand out. Without colour they do by weight alone, and traces by their dots.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Palette {
    /// False where the environment or the terminal wants none.
    pub colour: bool,
}

impl Palette {
    /// As `NO_COLOR` says: any value but an empty one wants no colour (<https://no-color.org>).
    #[must_use]
    pub fn of_environment() -> Self {
        Palette { colour: std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty()) }
    }

    fn with(self, colour: Color) -> Style {
        if self.colour { Style::new().fg(colour) } else { Style::new() }
    }

    /// A measured quantity's trace.
    pub(super) fn measured(self) -> Style {
        self.with(Color::Cyan)
    }

    /// A second measured quantity in the same chart.
    pub(super) fn second(self) -> Style {
        self.with(Color::Magenta)
    }

    /// What is wanted.
    pub(super) fn wanted(self) -> Style {
        self.with(Color::Yellow)
    }

    /// Something is wrong.
    pub(super) fn alarm(self) -> Style {
        self.with(Color::Red).add_modifier(Modifier::BOLD)
    }

    /// Something was found.
    pub(super) fn good(self) -> Style {
        self.with(Color::Green).add_modifier(Modifier::BOLD)
    }

    /// Outputs may go on.
    pub(super) fn armed(self) -> Style {
        self.with(Color::Yellow).add_modifier(Modifier::BOLD | Modifier::REVERSED)
    }

    /// Frames, scales and words that never change.
    pub(super) fn quiet(self) -> Style {
        Style::new().add_modifier(Modifier::DIM)
    }

    /// What stands out without an alarm.
    pub(super) fn strong(self) -> Style {
        Style::new().add_modifier(Modifier::BOLD)
    }
}
