//! What is told of long work.

/// Progress: what is done, how much of it, of how much.
pub type Progress<'a> = dyn Fn(&str, usize, usize) + Send + Sync + 'a;
