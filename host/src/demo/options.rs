//! What is asked of the demo.

use std::path::PathBuf;

use crate::control::Curves;
use crate::control::compose::Links;
use crate::extended::ExtendedModel;
use crate::link::Disturbance;
use crate::plant::Jitter;

/// What the demo does.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Number of palpations.
    pub palpations: usize,
    /// Rate of the probe, 1 to 4 mm/s.
    pub rate_mm_s: f64,
    /// Depth, mm; at most the table's 4 mm.
    pub depth_mm: f64,
    /// Seed of everything random.
    pub seed: u64,
    /// Randomness of the bench.
    pub jitter: Jitter,
    /// What the line does to bytes.
    pub line: Disturbance,
    /// Folder for report, logs, table and figures.
    pub out: PathBuf,
    /// A table to use instead of computing one.
    pub table: Option<PathBuf>,
    /// Control curves for materials of a table that is computed, in the place of the program's.
    pub control: Curves,
    /// An extended model: its effects in the table and in the foams, and its material among these.
    pub model: Option<ExtendedModel>,
    /// Magnet and fluid of the displays that a hand presses at the end; without them none does.
    pub magnet: Option<Links>,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            palpations: 20,
            rate_mm_s: 2.0,
            depth_mm: 4.0,
            seed: 1,
            jitter: Jitter::default(),
            line: Disturbance::default(),
            out: "out/demo".into(),
            table: None,
            control: Curves::default(),
            model: None,
            magnet: None,
        }
    }
}
