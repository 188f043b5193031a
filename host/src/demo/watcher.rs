//! What a demo tells while it runs.

/// What is going on, for a progress bar.
#[derive(Debug, Clone, PartialEq)]
pub enum Stage<'a> {
    /// Finite elements.
    Solving {
        /// Of what.
        what: &'a str,
        /// Solves done.
        done: usize,
        /// Solves of this task.
        total: usize,
    },
    /// The table goes over the link.
    Uploading {
        /// Bytes the board has.
        done: usize,
        /// Bytes of the table.
        total: usize,
    },
    /// A palpation has ended.
    Palpated {
        /// Palpations done.
        done: usize,
        /// Palpations of the demo.
        total: usize,
        /// The verdict in words.
        verdict: &'a str,
    },
    /// Something a person should know.
    Note(&'a str),
}

/// Listens to [`Stage`]s, from several threads.
pub type Watcher<'a> = &'a (dyn Fn(Stage<'_>) + Send + Sync);
