//! How a diagnosis is asked for.

/// Which way of coming to a verdict.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Edition {
    /// Effects must pass a list of demands, one after the other.
    #[default]
    First,
    /// Sets of effects are weighed by their evidence, with what no effect explains in each of them
    /// (docs/decisions/0005-one-model.md). In trial.
    Second,
}

/// How a diagnosis is asked for.
#[derive(Debug, Clone, Copy, Default)]
pub struct Asked<'a> {
    /// Codes that the catalogue lacks: what they would explain should then be unknown.
    pub without: &'a [&'a str],
    /// Which way of coming to a verdict.
    pub edition: Edition,
}
