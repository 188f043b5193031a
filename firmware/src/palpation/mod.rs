//! One palpation from approach to verdict.
//!
//! *Approach*: [`crate::contact`] watches for contact. *Pressing*: every sample is recorded and, one depth step a tick (a few while the
//! buffered samples are caught up), added to the variance search at the first estimate of the contact point; that is what
//! telemetry shows. *Analysis*, while the probe returns, a bounded piece a tick ([`analysis`]): the contact point is refined on the whole
//! record, the search is run again from the refined point, and the library is compared.

pub mod analysis;
mod record;
pub mod valley;

pub use record::{RECORD_LEN, Record};

use crate::contact::{Contact, ContactConfig, ContactPoint, Sample};
use crate::profile::Fitted;
use crate::readings::{Readings, ReadingsConfig};
use crate::recognition::NOT_RECOGNISED;
use crate::search::{Found, NoSlice, Search, Slice, Tolerance};
use analysis::Analysis;
use protocol::lut::Table;
use protocol::message::{Estimate, Outcome, Recognition, Verdict};
use valley::Estimated;

/// How a palpation is judged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PalpationConfig {
    /// Contact detection.
    pub contact: ContactConfig,
    /// How far specimen and rate may be from the nearest slice of the table.
    pub tolerance: Tolerance,
    /// What the samples must be for a verdict.
    pub readings: ReadingsConfig,
    /// Buffered samples that the search catches up with in one tick.
    pub catch_up: u8,
    /// Refinement of the contact point.
    pub analysis: analysis::AnalysisConfig,
}

impl Default for PalpationConfig {
    fn default() -> Self {
        PalpationConfig {
            contact: ContactConfig::default(),
            tolerance: Tolerance::default(),
            readings: ReadingsConfig::default(),
            catch_up: 4,
            analysis: analysis::AnalysisConfig::default(),
        }
    }
}

/// State of one palpation.
#[derive(Debug, Clone, Default)]
pub struct Palpation {
    contact: Contact,
    point: Option<ContactPoint>,
    /// Commanded rate, mm/s.
    rate_mm_s: f32,
    #[cfg(test)]
    first_mm: f32,
    slice: Option<Slice>,
    record: Record,
    /// Samples whose height or force was no number, and all.
    bad: u16,
    taken: u16,
    search: Search,
    /// Samples of the record that the live search has taken.
    searched: usize,
    peak_force_n: f32,
    analysis: Analysis,
    recognition: Option<Recognition>,
    found: Option<Found>,
    fitted: Option<Fitted>,
    estimated: Option<Estimated>,
}

/// What one sample brought.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Progress {
    /// No contact yet.
    Approaching,
    /// Contact found in this tick, and a slice of the table is near.
    Contact,
    /// Contact found in this tick, but no slice of the table is near the specimen's height.
    NoSuchHeight,
    /// Contact found in this tick, but no slice of the table is near the commanded rate.
    NoSuchRate,
    /// In contact.
    Pressing,
    /// The record is full: as good as at depth.
    Full,
}

impl Progress {
    /// How a palpation ends that no slice of the table serves.
    pub const fn refused(self) -> Option<Outcome> {
        match self {
            Progress::NoSuchHeight => Some(Outcome::NoSuchHeight),
            Progress::NoSuchRate => Some(Outcome::NoSuchRate),
            Progress::Approaching | Progress::Contact | Progress::Pressing | Progress::Full => None,
        }
    }
}

impl Palpation {
    /// Before the first palpation.
    pub const fn new() -> Self {
        Palpation {
            contact: Contact::new(),
            point: None,
            rate_mm_s: 0.0,
            #[cfg(test)]
            first_mm: 0.0,
            slice: None,
            record: Record::new(),
            bad: 0,
            taken: 0,
            search: Search::new(),
            searched: 0,
            peak_force_n: 0.0,
            analysis: Analysis::new(),
            recognition: None,
            found: None,
            fitted: None,
            estimated: None,
        }
    }

    /// Forgets the last palpation; the next one goes at `rate_mm_s`.
    pub fn start(&mut self, rate_mm_s: f32) {
        self.rate_mm_s = rate_mm_s;
        self.contact = Contact::new();
        self.point = None;
        self.slice = None;
        self.record.clear();
        (self.bad, self.taken) = (0, 0);
        self.search.reset();
        self.searched = 0;
        self.peak_force_n = 0.0;
        self.analysis = Analysis::new();
        self.recognition = None;
        self.found = None;
        self.fitted = None;
        self.estimated = None;
    }

    /// True once contact is found.
    pub const fn has_contact(&self) -> bool {
        self.point.is_some()
    }

    /// Depth after contact as believed now, mm, negative above the surface; 0 before contact.
    pub fn depth_mm(&self, probe_mm: f32) -> f32 {
        self.point.map_or(0.0, |p| p.height_mm - probe_mm)
    }

    /// Noise of the force before contact, N, once there is contact.
    pub fn contact_noise_n(&self) -> Option<f32> {
        self.point.map(|p| p.noise_n)
    }

    /// Mean absolute difference of the best column so far, N.
    pub fn error_n(&mut self) -> f32 {
        self.slice.as_ref().map_or(0.0, |slice| self.search.error_n(slice))
    }

    /// Takes a sample while the probe goes down.
    pub fn step(&mut self, config: &PalpationConfig, table: &Table<'_>, sample: Sample) -> Progress {
        self.taken = self.taken.saturating_add(1);
        if !(sample.probe_mm.is_finite() && sample.force_n.is_finite()) {
            self.bad = self.bad.saturating_add(1);
            return if self.has_contact() { Progress::Pressing } else { Progress::Approaching };
        }
        let Some(point) = self.point else {
            if !self.contact.step(&config.contact, sample) {
                return Progress::Approaching;
            }
            return self.touch(config, table);
        };
        let pushed = self.keep(&point, sample);
        self.catch_up(config, table);
        if pushed { Progress::Pressing } else { Progress::Full }
    }

    fn touch(&mut self, config: &PalpationConfig, table: &Table<'_>) -> Progress {
        let point = self.contact.locate(&config.contact);
        self.point = Some(point);
        #[cfg(test)]
        {
            self.first_mm = point.height_mm;
        }
        let near = Slice::choose(table, point.height_mm, self.rate_mm_s, &config.tolerance);
        self.slice = near.ok();
        // The record begins a little before contact: the refinement needs to see the flat part.
        let from_mm = point.height_mm + config.analysis.lead_mm;
        for i in 0..crate::contact::BUFFER_LEN {
            let Some(sample) = self.contact.samples().nth(i) else {
                break;
            };
            if sample.probe_mm <= from_mm {
                self.keep(&point, sample);
            }
        }
        match near {
            Ok(_) => Progress::Contact,
            Err(NoSlice::Rate) => Progress::NoSuchRate,
            Err(NoSlice::Height | NoSlice::TooLarge) => Progress::NoSuchHeight,
        }
    }

    fn keep(&mut self, point: &ContactPoint, sample: Sample) -> bool {
        let force_n = sample.force_n - point.zero_n;
        if force_n > self.peak_force_n {
            self.peak_force_n = force_n;
        }
        self.record.push(Sample { probe_mm: sample.probe_mm, force_n })
    }

    fn catch_up(&mut self, config: &PalpationConfig, table: &Table<'_>) {
        let (Some(slice), Some(point)) = (&self.slice, &self.point) else {
            return;
        };
        for _ in 0..config.catch_up {
            let Some(sample) = self.record.get(self.searched) else {
                break;
            };
            self.searched += 1;
            self.search.step(table, slice, point.height_mm - sample.probe_mm, sample.force_n);
        }
    }

    /// One piece of the analysis; true when the verdict is ready. Without contact or slice it is ready at once.
    pub fn analyse(&mut self, config: &PalpationConfig, table: &Table<'_>) -> bool {
        let (Some(slice), Some(point)) = (self.slice, self.point) else {
            return true;
        };
        if self.recognition.is_some() {
            return true;
        }
        let done = self.analysis.step(&config.analysis, table, &slice, &self.record, &point, &mut self.search);
        if let Some(finished) = done {
            self.found = self.search.found(&slice);
            self.fitted = finished.fitted;
            self.estimated = finished.estimated;
            self.recognition = Some(finished.recognition);
            self.point = Some(ContactPoint { height_mm: finished.height_mm, ..point });
        }
        self.recognition.is_some()
    }

    /// The samples, counted.
    fn readings(&self, depth_max_mm: f32) -> Readings {
        let height_mm = self.point.map_or(0.0, |p| p.height_mm);
        let samples = self.record.samples().iter().map(|s| (height_mm - s.probe_mm, s.force_n));
        Readings { bad: self.bad, all: self.taken, ..Readings::of(samples, depth_max_mm) }
    }

    /// What palpation number `palpation` says of its foam, with standard errors that hold noise, contact point, zero, table and gains; `None`
    /// before the analysis has ended, or if there was no sample to use.
    pub fn estimate(&self, config: &PalpationConfig, palpation: u32) -> Option<Estimate> {
        let (estimated, point) = (self.estimated.as_ref()?, self.point?);
        let (mean, errors) = (&estimated.mean, &estimated.deviations);
        let height_mm = point.height_mm + mean[2];
        let valley = &config.analysis.valley;
        let gains = [valley.press_gain, valley.cell_gain, GAIN_OF_DEPTH * valley.probe_gain];
        Some(Estimate {
            palpation,
            mu_mpa: mean[0],
            alpha: mean[1],
            height_mm,
            mu_error_mpa: root_of_squares(errors[0], &gains.map(|gain| gain * mean[0])),
            alpha_error: errors[1],
            height_error_mm: root_of_squares(errors[2], &[valley.probe_gain * height_mm]),
            noise_n: point.noise_n.max(config.analysis.noise_floor_n),
            samples: estimated.samples,
        })
    }

    /// What is sent of palpation number `motion.number`: the filter's estimate, if the palpation was identified, and the verdict, as
    /// [`Palpation::verdict`].
    pub fn report(
        &self,
        config: &PalpationConfig,
        table: Option<&Table<'_>>,
        ended: Outcome,
        motion: Motion,
    ) -> (Option<Estimate>, Verdict) {
        let verdict = self.verdict(config, table, ended, motion);
        let identified = verdict.outcome == Outcome::Identified;
        (self.estimate(config, motion.number).filter(|_| identified), verdict)
    }

    /// The verdict. `ended` is how the motion ended ([`Outcome::Identified`] for full depth); an analysis that was not run to its end
    /// gives no parameters.
    pub fn verdict(
        &self,
        config: &PalpationConfig,
        table: Option<&Table<'_>>,
        ended: Outcome,
        motion: Motion,
    ) -> Verdict {
        let mut verdict = Verdict {
            palpation: motion.number,
            outcome: ended,
            rate_mm_s: motion.rate_mm_s,
            height_mm: self.point.map_or(0.0, |p| p.height_mm),
            table_height_mm: self.slice.map_or(0.0, |s| s.height_mm),
            mu_mpa: 0.0,
            alpha: 0.0,
            error_n: 0.0,
            runner_up_error_n: 0.0,
            margin: 0.0,
            peak_force_n: self.peak_force_n,
            samples: self.search.samples(),
            material: NOT_RECOGNISED,
            tick_max_us: motion.tick_max_us,
            tick_mean_us: motion.tick_mean_us,
        };
        let readings = self.readings(table.map_or(f32::INFINITY, Table::depth_max_mm));
        let refused = readings.refused(&config.readings);
        let judged = matches!(ended, Outcome::Identified | Outcome::NoContact | Outcome::TooShort);
        if judged && refused == Some(Outcome::BadReadings) {
            verdict.outcome = Outcome::BadReadings;
        }
        if verdict.outcome != Outcome::Identified {
            return verdict;
        }
        let (Some(slice), Some(table), Some(found)) = (&self.slice, table, &self.found) else {
            verdict.outcome = refused.unwrap_or(Outcome::TooShort);
            return verdict;
        };
        if let Some(refused) = refused {
            verdict.outcome = refused;
            return verdict;
        }
        let (mu_mpa, alpha, at_edge) = match &self.fitted {
            Some(fitted) => (fitted.mu_mpa, fitted.alpha, fitted.at_edge),
            None => {
                let (mu_mpa, alpha) = slice.parameters(table, found.index);
                (mu_mpa, alpha, found.at_edge)
            }
        };
        if at_edge {
            verdict.outcome = Outcome::GridEdge;
        } else {
            (verdict.mu_mpa, verdict.alpha) = (mu_mpa, alpha);
        }
        verdict.error_n = found.error_n;
        verdict.runner_up_error_n = found.runner_up_error_n;
        verdict.margin = found.margin;
        if let Some(recognition) = &self.recognition {
            verdict.material = recognition.clone();
        }
        verdict
    }
}

/// Gain of the force for a gain of the depth: force goes with the depth to the power of 1.5 (Hertz), whatever mu.
const GAIN_OF_DEPTH: f32 = 1.5;

/// Independent deviations together.
fn root_of_squares(one: f32, others: &[f32]) -> f32 {
    crate::number::sqrt(others.iter().fold(one * one, |sum, x| sum + x * x))
}

/// What the verdict says about the motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// Number of the palpation since start.
    pub number: u32,
    /// Commanded rate, mm/s.
    pub rate_mm_s: f32,
    /// Longest tick of the palpation, us.
    pub tick_max_us: u16,
    /// Mean tick in contact, us.
    pub tick_mean_us: f32,
}

#[cfg(test)]
mod tests;
