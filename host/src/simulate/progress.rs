//! How a simulation tells where it is.

/// Told what is being solved, how many are done, and how many there are.
pub type Progress<'a> = &'a (dyn Fn(&str, usize, usize) + Sync);
