//! The end of a palpation: contact point refined on the whole record, search from there, library compared. One piece a tick, so
//! that no tick is long.
//!
//! 1. *Contact point*: for a contact height h and a column of shape f(d), amplitude eliminated by least squares, the misfit is
//!    `sum F^2 - (sum f F)^2 / sum f^2`; the least over all shapes is a smooth function of h, whose minimum is found on a coarse and
//!    then on a fine line. With the amplitude free (mu multiplies force for a one-term Hyperfoam) the steps of the grid in mu do not
//!    push the contact point aside, which the sums of Eq. 17 over 30 values of mu would.
//!    At that minimum the same sums give mu and alpha between the columns of the grid: its steps in mu (a factor 1.25) are coarser than what
//!    the data resolve, and the best column of Eq. 17 can lie far along the valley in which mu and alpha make up for each other.
//! 2. *Search*: Eq. 17 over the record again, from the refined point.
//! 3. *Library*: Eq. 17 over the library's curves at contact offsets around the refined point.

use super::record::Record;
use crate::contact::LeastOnLine;
use crate::recognition::Comparison;
use crate::search::{MAX_FACTORS, Search, Shapes, Slice};
use protocol::lut::{Table, axis_name};
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
    /// Contact offsets at which the library is compared, one a tick. They span three deviations of the refined contact point at 4 mm/s
    /// and 1 % noise (0.08 mm); more would let an offset pass for another material.
    pub library_offsets: u8,
    /// Distance between these offsets, mm.
    pub library_step_mm: f32,
}

impl Default for AnalysisConfig {
    fn default() -> Self {
        AnalysisConfig {
            lead_mm: 0.8,
            coarse: 33,
            fine: 9,
            search_samples: 16,
            library_offsets: 25,
            library_step_mm: 0.02,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Phase {
    Start,
    Coarse(Line),
    Fine(Line),
    Searching { height_mm: f32, next: usize },
    Comparing { height_mm: f32, next: u8 },
}

/// Contact heights that are tried.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Line {
    least: LeastOnLine,
    places: u8,
    step_mm: f32,
    /// The highest one.
    top_mm: f32,
}

impl Line {
    /// `places` heights, evenly over `[middle - half, middle + half]`.
    fn around(middle_mm: f32, half_mm: f32, places: u8) -> Self {
        let step_mm = 2.0 * half_mm / f32::from(places.max(3) - 1);
        Line {
            least: LeastOnLine::new(middle_mm - half_mm, step_mm),
            places: places.max(3),
            step_mm,
            top_mm: middle_mm + half_mm,
        }
    }

    /// Tries the next height; true after the last one.
    fn step(&mut self, table: &Table<'_>, shapes: Shapes, record: &Record) -> bool {
        // Samples that lie in the table at every height tried, so that all heights are judged on the same samples.
        let lowest_mm = self.top_mm - table.depth_max_mm();
        let products = Products::sum(table, shapes, record, lowest_mm, self.least.next_x());
        self.least.put(products.least().1);
        self.least.taken() >= u16::from(self.places)
    }
}

/// State of the analysis.
#[derive(Debug, Clone)]
pub struct Analysis {
    phase: Phase,
    shapes: Shapes,
    fitted: Option<Fitted>,
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
    /// Parameters between the columns.
    pub fitted: Option<Fitted>,
    /// Nearest library material.
    pub recognition: Recognition,
}

impl Analysis {
    /// Not begun.
    pub const fn new() -> Self {
        Analysis {
            phase: Phase::Start,
            shapes: Shapes { first: 0, stride: 1, count: 0 },
            fitted: None,
            comparison: Comparison::new(),
        }
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
        match &mut self.phase {
            Phase::Start => {
                let best = search.found(slice).map_or(0, |f| f.index);
                self.shapes = slice.shapes(table, best);
                self.phase = Phase::Coarse(Line::around(first_mm, config.lead_mm, config.coarse));
            }
            Phase::Coarse(line) => {
                if line.step(table, self.shapes, record) {
                    self.phase = Phase::Fine(Line::around(line.least.result().0, line.step_mm, config.fine));
                }
            }
            Phase::Fine(line) => {
                if line.step(table, self.shapes, record) {
                    let height_mm = line.least.result().0;
                    self.fitted = fit(table, self.shapes, record, height_mm);
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
                compare(config, table, record, *height_mm, *next, &mut self.comparison);
                *next += 1;
                if *next >= config.library_offsets {
                    return Some(Finished {
                        height_mm: *height_mm,
                        fitted: self.fitted,
                        recognition: self.comparison.result(table),
                    });
                }
            }
        }
        None
    }
}

/// Compares the record with the library at contact offset number `offset`.
fn compare(
    config: &AnalysisConfig,
    table: &Table<'_>,
    record: &Record,
    height_mm: f32,
    offset: u8,
    comparison: &mut Comparison,
) {
    let reach_mm = 0.5 * (f32::from(config.library_offsets) - 1.0) * config.library_step_mm;
    let at_mm = height_mm - reach_mm + f32::from(offset) * config.library_step_mm;
    let lowest_mm = height_mm + reach_mm - table.depth_max_mm();
    // Nor samples that no offset brings into contact: their zeros would only dilute the mean.
    let highest_mm = height_mm + reach_mm;
    let samples = record.samples().iter().filter(|s| s.probe_mm >= lowest_mm && s.probe_mm <= highest_mm);
    let bottom_mm = samples.clone().fold(height_mm, |bottom, s| f32::min(bottom, s.probe_mm));
    comparison.deepest_mm = height_mm - bottom_mm;
    comparison.step(table, samples.map(|s| (at_mm - s.probe_mm, s.force_n)));
}

/// Sums over the record that amplitude and misfit of every shape follow from.
struct Products {
    /// `sum F^2`, N^2.
    total_n2: f32,
    /// `sum f^2` and `sum f F` of every shape.
    shapes: [(f32, f32); MAX_FACTORS],
    count: usize,
}

impl Products {
    /// For one contact height, over the samples at or above `lowest_mm`.
    fn sum(table: &Table<'_>, shapes: Shapes, record: &Record, lowest_mm: f32, height_mm: f32) -> Self {
        let mut products =
            Products { total_n2: 0.0, shapes: [(0.0, 0.0); MAX_FACTORS], count: shapes.count.min(MAX_FACTORS) };
        for sample in record.samples().iter().filter(|s| s.probe_mm >= lowest_mm) {
            products.total_n2 += sample.force_n * sample.force_n;
            let Some(position) = table.locate(height_mm - sample.probe_mm) else {
                continue;
            };
            let forces = table.forces_n(position, shapes.columns()).step_by(shapes.stride);
            for ((ff, fm), f) in products.shapes.iter_mut().zip(forces) {
                *ff += f * f;
                *fm += f * sample.force_n;
            }
        }
        products
    }

    /// Squares left by shape number `i` at its best amplitude, N^2.
    fn misfit_n2(&self, i: usize) -> Option<f32> {
        let (ff, fm) = self.shapes.get(..self.count)?.get(i)?;
        (*ff > 0.0 && *fm > 0.0).then(|| self.total_n2 - fm * fm / ff)
    }

    /// Best amplitude of shape number `i`.
    fn amplitude(&self, i: usize) -> Option<f32> {
        let (ff, fm) = self.shapes.get(..self.count)?.get(i)?;
        (*ff > 0.0).then(|| fm / ff)
    }

    /// The least misfit along the shapes, which are in the order of alpha: place (a fraction between shapes) and value, N^2. The parabola
    /// makes it smooth in the contact height, where a plain minimum would have a corner for every shape.
    fn least(&self) -> (f32, f32) {
        let mut line = LeastOnLine::new(0.0, 1.0);
        for i in 0..self.count {
            line.put(self.misfit_n2(i).unwrap_or(self.total_n2));
        }
        let (place, misfit_n2) = line.result();
        (crate::number::limit(place, 0.0, self.count.saturating_sub(1) as f32), misfit_n2)
    }
}

/// Parameters between the columns of the grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fitted {
    /// Shear modulus, MPa.
    pub mu_mpa: f32,
    /// Exponent.
    pub alpha: f32,
    /// True if the least misfit lies at the edge of the grid in alpha, or mu beyond the grid.
    pub at_edge: bool,
}

/// mu and alpha by least squares at the refined contact point: mu from the amplitude, alpha from the parabola through the least misfit
/// and its neighbours. `None` for a table without these axes.
fn fit(table: &Table<'_>, shapes: Shapes, record: &Record, height_mm: f32) -> Option<Fitted> {
    let products = Products::sum(table, shapes, record, height_mm - table.depth_max_mm(), height_mm);
    let (place, _) = products.least();
    let below = place as usize;
    let above = (below + 1).min(products.count.saturating_sub(1));
    let weight = place - below as f32;
    let between = |value: &dyn Fn(usize) -> Option<f32>| {
        let (low, high) = (value(below)?, value(above)?);
        Some(low + weight * (high - low))
    };
    let column = |i: usize| shapes.first + i * shapes.stride;
    let unit_mpa = |i: usize| match table.factor() {
        Some(_) => Some(1.0),
        None => table.column_value(column(i), axis_name::MU),
    };
    let alpha = between(&|i| table.column_value(column(i), axis_name::ALPHA))?;
    let mu_mpa = between(&|i| Some(unit_mpa(i)? * products.amplitude(i)?))?;
    let mus = table.axis(axis_name::MU)?;
    let mu_inside = mu_mpa >= mus.value(0) && mu_mpa <= mus.value(mus.len().saturating_sub(1));
    let best = (place + 0.5) as usize;
    let alpha_inside = products.count == 1 || (best > 0 && best + 1 < products.count);
    Some(Fitted { mu_mpa, alpha, at_edge: !(mu_inside && alpha_inside) })
}
