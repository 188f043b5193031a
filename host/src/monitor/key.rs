//! Keys, without the terminal's library.

/// A key that means something here.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Key {
    /// A character.
    Char(char),
    /// Arrow up.
    Up,
    /// Arrow down.
    Down,
    /// Escape.
    Escape,
    /// Ctrl-C.
    Interrupt,
}

impl Key {
    /// It switches the outputs off.
    #[must_use]
    pub const fn is_off(self) -> bool {
        matches!(self, Key::Char(' ' | 'o'))
    }

    /// It switches the outputs off and ends the monitor.
    #[must_use]
    pub const fn is_end(self) -> bool {
        matches!(self, Key::Interrupt | Key::Escape | Key::Char('q'))
    }
}

/// What the keys do, for the help line: key, word; what is left out first in a narrow terminal comes last.
pub const HELP: [(&str, &str); 13] = [
    ("space", "off"),
    ("a", "arm"),
    ("p", "palpate"),
    ("d", "display"),
    ("↑↓", "material"),
    ("+-", "rate"),
    ("c", "clear"),
    ("r", "record"),
    ("q", "quit"),
    ("t", "tare"),
    ("u", "upload table"),
    ("x", "forget"),
    ("b", "both"),
];
