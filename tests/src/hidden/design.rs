//! The four designs of DIAGNOSIS.md, and those of others.

/// Which runs an experiment has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Design {
    /// The thesis' own: balls of 4 and 6 mm, three spots each, 2 mm/s, loading only, 12.7 mm.
    D6,
    /// The same at 0.5, 2 and 8 mm/s.
    D18,
    /// Balls of 4 and 6 mm, three rates, two spots, three cycles; a hold of 5 s and unloading in every run.
    D36,
    /// D36, and at 2 mm/s, two spots and three cycles each: both balls at 25.4 mm, a ball of 9 mm at either height.
    D60,
    /// What a laboratory of its own would choose, drawn from the seed: one to three balls of 2 to 12.5 mm, one or two slabs of 10 to 50 mm, one to four
    /// rates of 0.1 to 10 mm/s, two to four spots, with and without holds, ways back and cycles, at 20 to 200 Hz. Not one of the four that are scored by
    /// default: what the diagnosis was not tuned on.
    Own,
}

impl Design {
    /// Those of DIAGNOSIS.md, smallest first.
    pub const ALL: [Self; 4] = [Self::D6, Self::D18, Self::D36, Self::D60];

    /// Number of runs; `None` where every experiment has its own.
    #[must_use]
    pub fn runs(self) -> Option<usize> {
        match self {
            Self::D6 => Some(6),
            Self::D18 => Some(18),
            Self::D36 => Some(36),
            Self::D60 => Some(60),
            Self::Own => None,
        }
    }

    /// Its name, such as "D36".
    #[must_use]
    pub fn name(self) -> String {
        self.runs().map_or_else(|| "own".to_owned(), |runs| format!("D{runs}"))
    }

    /// The design of a name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().chain([Self::Own]).find(|design| design.name() == name)
    }
}
