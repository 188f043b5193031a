//! What is asked of the study.

use crate::identify::multistart::STARTS;
use crate::identify::spec::Extra;

/// What is mapped.
#[derive(Debug, Clone, PartialEq)]
pub struct Asked {
    /// Terms of the foam, 1 or 2.
    pub terms: usize,
    /// Free besides: Poisson's ratio, friction.
    pub free: Vec<Extra>,
    /// Most simplex searches a map.
    pub starts: usize,
    /// Most finite-element solves a map, and again for Gauss-Newton beside it.
    pub most_solves: usize,
}

impl Default for Asked {
    fn default() -> Self {
        Self { terms: 1, free: Vec::new(), starts: STARTS, most_solves: 400 }
    }
}
