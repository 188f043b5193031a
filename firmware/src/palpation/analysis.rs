//! The end of a palpation: contact point refined on the whole record, search from there, library compared. One piece a tick, so
//! that no tick is long.
//!
//! 1. *Contact point*: for a contact height h and a column of shape f(d), amplitude eliminated by least squares, the misfit is
//!    `sum F^2 - (sum f F)^2 / sum f^2`; the least over all shapes is a smooth function of h, whose minimum is found on a coarse and
//!    then on a fine line. With the amplitude free (mu multiplies force for a one-term Hyperfoam) the steps of the grid in mu do not
//!    push the contact point aside, which the sums of Eq. 17 over 30 values of mu would.
//!    At that minimum the same sums give mu and alpha between the columns of the grid: its steps in mu (a factor 1.25) are coarser than what
//!    the data resolve, and the best column of Eq. 17 can lie far along the valley in which mu and alpha make up for each other.
//! 2. *Kalman filter* (Eqs. 18-21) over the record for mu, alpha and what is left of the contact offset, from the result of the fast search.
//! 3. *Valley* ([`super::valley`]): from there, mean and standard error of all three.
//! 4. *Search*: Eq. 17 over the record again, from the refined point.
//! 5. *Library*: Eq. 17 over the library's curves at contact offsets around the refined point.

use super::record::Record;
use super::valley::{Estimated, Valley, ValleyConfig};
use crate::contact::{ContactPoint, LeastOnLine};
use crate::kalman::indentation::Indentation;
use crate::kalman::{Bounding, Estimator, Filter, Region};
use crate::profile::{Fitted, ProfileSearch};
use crate::recognition::Comparison;
use crate::search::{Search, Shapes, Slice};
use crate::surface::Surface;
use core::ops::Range;
use nalgebra::Vector3;
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
    /// Samples that the Kalman filter takes in one tick.
    pub filter_samples: u8,
    /// Passes of the Kalman filter over the record: each is a Gauss-Newton step from where the one before it ended.
    pub filter_passes: u8,
    /// How far the filter may move the contact point, mm.
    pub offset_mm: f32,
    /// What the standard errors hold.
    pub valley: ValleyConfig,
    /// Standard deviation of the force that the filter assumes at least, N: the load cell's quantisation.
    pub noise_floor_n: f32,
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
            filter_samples: 48,
            filter_passes: 3,
            offset_mm: 0.3,
            valley: ValleyConfig::default(),
            noise_floor_n: 0.0005,
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
    Filtering { height_mm: f32, next: usize, pass: u8, filtering: Filtering },
    Valley { height_mm: f32, valley: Valley },
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
        let profile = profile(table, shapes, record, lowest_mm, self.least.next_x());
        self.least.put(profile.least().1);
        self.least.taken() >= u16::from(self.places)
    }
}

/// State of the analysis.
#[derive(Debug, Clone)]
pub struct Analysis {
    phase: Phase,
    shapes: Shapes,
    fitted: Option<Fitted>,
    estimated: Option<Estimated>,
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
    /// mu, alpha and contact point with their errors.
    pub estimated: Option<Estimated>,
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
            estimated: None,
            comparison: Comparison::new(),
        }
    }

    /// One piece; the result after the last one. `point` is the first estimate of the contact point.
    pub fn step(
        &mut self,
        config: &AnalysisConfig,
        table: &Table<'_>,
        slice: &Slice,
        record: &Record,
        point: &ContactPoint,
        search: &mut Search,
    ) -> Option<Finished> {
        let (first_mm, noise_n) = (point.height_mm, point.noise_n);
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
                    let lowest_mm = height_mm - table.depth_max_mm();
                    self.fitted = profile(table, self.shapes, record, lowest_mm, height_mm).found(table);
                    search.reset();
                    self.phase = match begin(config, table, self.fitted) {
                        Some(filtering) => Phase::Filtering { height_mm, next: 0, pass: 1, filtering },
                        None => Phase::Searching { height_mm, next: 0 },
                    };
                }
            }
            Phase::Filtering { height_mm, next, pass, filtering } => {
                let end = *next + usize::from(config.filter_samples.max(1));
                filtering.take(table, slice, record, *next..end, *height_mm, noise_n.max(config.noise_floor_n));
                *next = end;
                if end >= record.samples().len() && *pass < config.filter_passes {
                    (*next, *pass) = (0, *pass + 1);
                    filtering.again();
                } else if end >= record.samples().len() {
                    let (height_mm, mut estimator) = (*height_mm, filtering.estimator);
                    estimator.filter.state = estimator.most_likely();
                    self.phase = if estimator.samples > 0 {
                        let noise_n = noise_n.max(config.noise_floor_n);
                        let valley = Valley::new(&config.valley, table, record, height_mm, point, noise_n, &estimator);
                        Phase::Valley { height_mm, valley }
                    } else {
                        Phase::Searching { height_mm, next: 0 }
                    };
                }
            }
            Phase::Valley { height_mm, valley } => {
                if let Some(estimated) = valley.step(&config.valley, table, slice, record) {
                    self.estimated = estimated;
                    let height_mm = *height_mm;
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
                compare(config, table, slice, record, *height_mm, *next, &mut self.comparison);
                *next += 1;
                if *next >= config.library_offsets {
                    return Some(Finished {
                        height_mm: *height_mm,
                        fitted: self.fitted,
                        estimated: self.estimated,
                        recognition: self.comparison.result(table, noise_n),
                    });
                }
            }
        }
        None
    }
}

/// The filter over the record, linearised at one place a pass.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Filtering {
    /// Before the first sample.
    first: Filter<3>,
    /// Where the model is linearised.
    reference: Vector3<f32>,
    estimator: Estimator<3>,
}

/// The filter before the first sample: at the result of the fast search, with the covariance of Eq. 21 over the table's region. `None` for
/// a table without mu and alpha.
fn begin(config: &AnalysisConfig, table: &Table<'_>, fitted: Option<Fitted>) -> Option<Filtering> {
    let range = |name| table.axis(name).map(|a| (a.value(0), a.value(a.len().saturating_sub(1))));
    let (mus, alphas) = (range(axis_name::MU)?, range(axis_name::ALPHA)?);
    let region = Region {
        low: Vector3::new(mus.0, alphas.0, -config.offset_mm),
        high: Vector3::new(mus.1, alphas.1, config.offset_mm),
    };
    let fitted = fitted?;
    let reference = region.nearest(&Vector3::new(fitted.mu_mpa, fitted.alpha, 0.0));
    let estimator = Estimator::new(reference, region, Bounding::Constrained { linearisations: 1 });
    Some(Filtering { first: estimator.filter, reference, estimator })
}

impl Filtering {
    /// Takes some samples of the record.
    fn take(
        &mut self,
        table: &Table<'_>,
        slice: &Slice,
        record: &Record,
        some: Range<usize>,
        height_mm: f32,
        noise_n: f32,
    ) {
        let Some(surface) = Surface::new(table, slice) else {
            return;
        };
        let model = Indentation { surface };
        for sample in record.samples().iter().take(some.end).skip(some.start) {
            let depth_mm = height_mm - sample.probe_mm;
            self.estimator.step_about(&model, &self.reference, depth_mm, sample.force_n, noise_n * noise_n);
        }
    }

    /// From the first sample again, linearised where the last pass ended.
    fn again(&mut self) {
        self.reference = self.estimator.most_likely();
        self.estimator.filter = self.first;
        self.estimator.samples = 0;
    }
}

/// Compares the record with the library at contact offset number `offset`.
fn compare(
    config: &AnalysisConfig,
    table: &Table<'_>,
    slice: &Slice,
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
    comparison.step(table, slice.rate_mm_s, samples.map(|s| (at_mm - s.probe_mm, s.force_n)));
}

/// Sums over the record for one contact height, over the samples at or above `lowest_mm`.
fn profile(table: &Table<'_>, shapes: Shapes, record: &Record, lowest_mm: f32, height_mm: f32) -> ProfileSearch {
    let mut profile = ProfileSearch::over(shapes);
    for sample in record.samples().iter().filter(|s| s.probe_mm >= lowest_mm) {
        profile.step(table, height_mm - sample.probe_mm, sample.force_n);
    }
    profile
}
