//! The end of a palpation: contact point refined on the whole record, search from there, library compared. One piece a tick, so
//! that no tick is long.
//!
//! 1. *Contact point*: for a contact height h and a column of shape f(d), amplitude eliminated by least squares, the misfit is
//!    `sum F^2 - (sum f F)^2 / sum f^2`; the least over all shapes is a smooth function of h, whose minimum is found on a coarse and
//!    then on a fine line. With the amplitude free (mu multiplies force for a one-term Hyperfoam) the steps of the grid in mu do not
//!    push the contact point aside, which the sums of Eq. 17 over 30 values of mu would.
//! 2. *Search*: Eq. 17 over the record again, from the refined point.
//! 3. *Library*: Eq. 17 over the library's curves at contact offsets around the refined point.

use super::record::Record;
use crate::contact::{LeastOnLine, Sample};
use crate::recognition::Comparison;
use crate::search::{Search, Slice};
use protocol::lut::Table;
use protocol::message::Recognition;

/// How the analysis is divided.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AnalysisConfig {
    /// How far before the first estimate the record begins, mm; the refinement looks as far to either side.
    pub lead_mm: f32,
    /// Places on the coarse line.
    pub coarse: u8,
    /// Places on the fine line, over two coarse steps.
    pub fine: u8,
    /// Samples that the search takes in one tick.
    pub search_samples: u8,
    /// Contact offsets at which the library is compared.
    pub library_offsets: u8,
    /// Distance between these offsets, mm.
    pub library_step_mm: f32,
}

impl Default for AnalysisConfig {
    fn default() -> Self {
        AnalysisConfig {
            lead_mm: 0.4,
            coarse: 17,
            fine: 9,
            search_samples: 16,
            library_offsets: 9,
            library_step_mm: 0.02,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Phase {
    Start,
    Coarse(LeastOnLine),
    Fine(LeastOnLine),
    Searching { height_mm: f32, next: usize },
    Comparing { height_mm: f32, next: u8 },
}

/// State of the analysis.
#[derive(Debug, Clone)]
pub struct Analysis {
    phase: Phase,
    shapes: (usize, usize, usize),
    comparison: Comparison,
}

impl Default for Analysis {
    fn default() -> Self {
        Self::new()
    }
}

/// What the analysis found, besides the sums left in the search.
#[derive(Debug, Clone, PartialEq)]
pub struct Finished {
    /// Refined height of the specimen's surface, mm.
    pub height_mm: f32,
    /// Nearest library material.
    pub recognition: Recognition,
}

impl Analysis {
    /// Not begun.
    pub const fn new() -> Self {
        Analysis { phase: Phase::Start, shapes: (0, 1, 0), comparison: Comparison::new() }
    }

    /// One piece; the result after the last one. `first_mm` is the first estimate of the contact height.
    pub fn step(
        &mut self,
        config: &AnalysisConfig,
        table: &Table<'_>,
        slice: &Slice,
        record: &Record,
        first_mm: f32,
        search: &mut Search,
    ) -> Option<Finished> {
        let coarse_mm = 2.0 * config.lead_mm / f32::from(config.coarse.max(2) - 1);
        match &mut self.phase {
            Phase::Start => {
                let best = search.found(slice).map_or(0, |f| f.index);
                self.shapes = slice.shapes(table, best);
                self.phase = Phase::Coarse(LeastOnLine::new(first_mm - config.lead_mm, coarse_mm));
            }
            Phase::Coarse(line) => {
                line.put(shape_misfit(config, table, self.shapes, record, first_mm, line.next_x()));
                if line.taken() >= u16::from(config.coarse) {
                    let fine_mm = 2.0 * coarse_mm / f32::from(config.fine.max(2) - 1);
                    let from_mm = line.result().0 - coarse_mm;
                    self.phase = Phase::Fine(LeastOnLine::new(from_mm, fine_mm));
                }
            }
            Phase::Fine(line) => {
                line.put(shape_misfit(config, table, self.shapes, record, first_mm, line.next_x()));
                if line.taken() >= u16::from(config.fine) {
                    let height_mm = line.result().0;
                    search.reset();
                    self.phase = Phase::Searching { height_mm, next: 0 };
                }
            }
            Phase::Searching { height_mm, next } => {
                let end = *next + usize::from(config.search_samples.max(1));
                for sample in record.samples().iter().take(end).skip(*next) {
                    search.step(table, slice, *height_mm - sample.probe_mm, sample.force_n);
                }
                *next = end;
                if end >= record.samples().len() {
                    let height_mm = *height_mm;
                    self.phase = Phase::Comparing { height_mm, next: 0 };
                }
            }
            Phase::Comparing { height_mm, next } => {
                let offset = f32::from(*next) - 0.5 * (f32::from(config.library_offsets) - 1.0);
                let at_mm = *height_mm + offset * config.library_step_mm;
                let deepest = table.depth_max_mm() - 0.5 * f32::from(config.library_offsets) * config.library_step_mm;
                let pairs = record
                    .samples()
                    .iter()
                    // The same samples at every offset, or offsets could not be compared.
                    .filter(|s| *height_mm - s.probe_mm > 0.0 && *height_mm - s.probe_mm <= deepest)
                    .map(|s| (at_mm - s.probe_mm, s.force_n));
                self.comparison.step(table, pairs);
                *next += 1;
                if *next >= config.library_offsets {
                    return Some(Finished { height_mm: *height_mm, recognition: self.comparison.result(table) });
                }
            }
        }
        None
    }
}

/// Least misfit over all shapes for one contact height, N^2.
fn shape_misfit(
    config: &AnalysisConfig,
    table: &Table<'_>,
    shapes: (usize, usize, usize),
    record: &Record,
    first_mm: f32,
    height_mm: f32,
) -> f32 {
    // Samples that lie in the table at every height tried, so that all heights are judged on the same samples.
    let deepest_mm = table.depth_max_mm() - 1.1 * config.lead_mm;
    let used = |s: &&Sample| first_mm - s.probe_mm <= deepest_mm;
    let total: f32 = record.samples().iter().filter(used).map(|s| s.force_n * s.force_n).sum();
    let (first, stride, count) = shapes;
    let mut products = [(0.0f32, 0.0f32); crate::search::MAX_FACTORS];
    for sample in record.samples().iter().filter(used) {
        let Some(position) = table.locate(height_mm - sample.probe_mm) else {
            continue;
        };
        let forces = table.forces_n(position, first..first + (count.saturating_sub(1)) * stride + 1).step_by(stride);
        for ((ff, fm), f) in products.iter_mut().zip(forces) {
            *ff += f * f;
            *fm += f * sample.force_n;
        }
    }
    products
        .iter()
        .take(count)
        .filter(|(ff, fm)| *ff > 0.0 && *fm > 0.0)
        .map(|(ff, fm)| total - fm * fm / ff)
        .fold(total, f32::min)
}
