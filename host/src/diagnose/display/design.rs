//! The runs of one channel as a diagnosis sees them: what was told, what was measured, which runs repeat each other.

use crate::experiment::signal::range;
use crate::experiment::{Experiment, GAP_MM, Run, Test, UNDER_FINGER};
use crate::finger::round;

use super::channel::{Channel, FLUX_SLOPE};
use super::smooth::{self, Left};
use super::yielding;

/// One run of a channel.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Its file.
    pub file: String,
    /// What is measured.
    pub channel: Channel,
    /// Time, s; never falling.
    pub time_s: Vec<f64>,
    /// What was told; of a pulp its compression.
    pub input: Vec<f64>,
    /// Yield stress that the fluid under a finger has by its law, kPa; empty elsewhere.
    pub yield_kpa: Vec<f64>,
    /// The input is what the fluid has answered of it so far: the law adds no response time.
    pub is_answered: bool,
    /// What is left of their readings' noise in the input and in the yield stress.
    pub left: [Vec<Left>; 2],
    /// What was measured.
    pub output: Vec<f64>,
    /// Samples that are compared.
    pub compared: Vec<bool>,
    /// Gap of the magnet over the smallest of the experiment; 1 where none is recorded.
    pub gap_ratio: f64,
    /// Gap, mm; 0 where none is recorded.
    pub gap_mm: f64,
    /// Runs of one condition repeat each other.
    pub condition: usize,
    /// Never fitted, only predicted.
    pub hold_out: bool,
}

/// All runs of a channel.
#[derive(Debug, Clone)]
pub struct Design {
    /// What is measured.
    pub channel: Channel,
    /// Its runs.
    pub series: Vec<Series>,
    /// For every run the first one that was told exactly the same: a law predicts the same of both.
    pub first_alike: Vec<usize>,
    /// A name for every condition.
    pub conditions: Vec<String>,
    /// Largest less smallest output.
    pub span: f64,
    /// What the reader should know.
    pub messages: Vec<String>,
}

/// Why a channel cannot be diagnosed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Unusable {
    /// No run of the channel.
    #[error("no run records it")]
    Absent,
    /// Nothing moves.
    #[error("{column} varies by {range} {unit} over all runs; expected a command that moves the display")]
    Still {
        /// Column of the input.
        column: &'static str,
        /// Its range.
        range: f64,
        /// Its unit.
        unit: &'static str,
    },
    /// Too few samples.
    #[error("{count} samples can be compared; expected at least {LEAST_SAMPLES}{}", .channel.where_compared())]
    Short {
        /// What is measured.
        channel: Channel,
        /// Samples.
        count: usize,
    },
    /// The measured column does not move although the told one does.
    #[error(
        "{file}: {column} does not follow: it varies by {range} {unit} where about {expected} {unit} are expected; a dead sensor, or a wrong unit"
    )]
    Dead {
        /// The run.
        file: String,
        /// Column of the output.
        column: &'static str,
        /// Its range.
        range: f64,
        /// What the nominal law gives.
        expected: f64,
        /// Its unit.
        unit: &'static str,
    },
}

/// Inputs by file.
pub type Explained = std::collections::BTreeMap<String, Vec<f64>>;

/// Samples without which nothing can be said.
const LEAST_SAMPLES: usize = 40;
/// Inputs that differ by less than this share of the range, root mean square, are the same command.
const SAME_INPUT: f64 = 0.02;
/// The same of the yield stress under a finger, for a winding warms from press to press, and what some gauss make of it, kPa.
const SAME_YIELD: f64 = 0.05;
const GAUSS_KPA: f64 = 0.02;
/// Output below this share of what the nominal law gives is a dead sensor.
const DEAD: f64 = 0.02;
/// Largest step of time over the usual one before a run counts as interrupted.
const INTERRUPTED: f64 = 10.0;

impl Design {
    /// The runs of a channel. `explained`: inputs (by file) that are known better than they were measured, because their own channel was
    /// explained; a reading's noise would otherwise pass for motion.
    ///
    /// # Errors
    /// [`Unusable`].
    pub fn of(experiment: &Experiment, channel: Channel, explained: &Explained) -> Result<Self, Unusable> {
        let mut messages = Vec::new();
        let mut series: Vec<Series> = Vec::new();
        let runs: Vec<&Run> = experiment.runs.iter().filter(|run| run.test == Test::Display).collect();
        for run in runs {
            let Some(one) = one(run, channel, explained.get(&run.file)) else { continue };
            if let Some(at_s) = interrupted(&one.time_s) {
                messages.push(format!("{}: recording interrupted at {at_s:.2} s; the run is left out", run.file));
            } else {
                series.push(one);
            }
        }
        if series.is_empty() {
            return Err(Unusable::Absent);
        }
        let (told, measured) = channel.columns();
        let input_range = range(series.iter().flat_map(Series::told));
        // what a converter's single code or a display's rounding would make of rest
        if input_range < 1e-6 {
            return Err(Unusable::Still { column: told, range: input_range, unit: channel.input_unit() });
        }
        let count = series.iter().map(Series::count).sum();
        if count < LEAST_SAMPLES {
            return Err(Unusable::Short { channel, count });
        }
        for one in &series {
            let expected = one.expected();
            let found = range(one.output.iter().copied());
            if expected > channel.least_output(input_range) && found < DEAD * expected {
                let (file, unit) = (one.file.clone(), channel.unit());
                return Err(Unusable::Dead { file, column: measured, range: found, expected, unit });
            }
        }
        let gap_mm = series.iter().map(|s| s.gap_mm).fold(f64::INFINITY, f64::min);
        for one in series.iter_mut().filter(|s| s.gap_mm > 0.0 && gap_mm > 0.0) {
            one.gap_ratio = one.gap_mm / gap_mm;
        }
        let mut conditions: Vec<(usize, String)> = Vec::new();
        for at in 0..series.len() {
            let same = conditions.iter().position(|(first, _)| alike(&series[*first], &series[at], input_range));
            series[at].condition = same.unwrap_or(conditions.len());
            if same.is_none() {
                conditions.push((at, series[at].file.clone()));
            }
        }
        let conditions = conditions.into_iter().map(|(_, file)| file).collect();
        let span = range(series.iter().flat_map(|s| s.output.iter().copied()));
        let first_alike = first_alike(&series);
        Ok(Self { channel, series, first_alike, conditions, span, messages })
    }

    /// True when two runs that may be fitted repeat each other.
    #[must_use]
    pub fn has_replicates(&self) -> bool {
        let all = &self.series;
        all.iter().enumerate().any(|(i, a)| all[..i].iter().any(|b| a.condition == b.condition))
    }

    /// First sample of a run among those of all runs.
    #[must_use]
    pub fn first(&self, run: usize) -> usize {
        self.series[..run].iter().map(|s| s.time_s.len()).sum()
    }

    /// Samples of all runs.
    #[must_use]
    pub fn samples(&self) -> usize {
        self.series.iter().map(|s| s.time_s.len()).sum()
    }
}

impl Series {
    /// Samples that are compared.
    #[must_use]
    pub fn count(&self) -> usize {
        self.compared.iter().filter(|compared| **compared).count()
    }

    /// What was told; of a finger what it presses: a way through the air is none.
    fn told(&self) -> impl Iterator<Item = f64> {
        let is_finger = self.channel.is_finger();
        self.input.iter().map(move |x| if is_finger { x.max(0.0) } else { *x })
    }

    /// Range of the output where it is compared, by the nominal law.
    fn expected(&self) -> f64 {
        let nominal = |k: usize| match self.channel {
            Channel::Flux => FLUX_SLOPE * self.input[k],
            Channel::Pulp => round::pulp_n(self.input[k]),
            Channel::Fluid => round::fluid_n(self.input[k], self.yield_kpa[k]),
            Channel::Position | Channel::Force | Channel::Current => self.input[k],
        };
        range((0..self.input.len()).filter(|k| self.compared[*k]).map(nominal))
    }
}

fn one(run: &Run, channel: Channel, explained: Option<&Vec<f64>>) -> Option<Series> {
    let (told, measured) = channel.columns();
    let mut read = run.recording.column(told)?.to_vec();
    let output = run.recording.column(measured)?.to_vec();
    let (mut yield_kpa, mut yield_left) = (Vec::new(), Vec::new());
    let [shaft_mm, flux_t] = UNDER_FINGER.map(|name| run.recording.column(name));
    match (channel, flux_t, shaft_mm) {
        (Channel::Fluid, Some(flux_t), _) => {
            let (flux_t, left) = smooth::smoothed(&run.recording.time_s, flux_t);
            yield_kpa = flux_t.iter().map(|t| round::yield_kpa(*t)).collect();
            yield_left = left;
            for Left { first, errors } in &mut yield_left {
                let own = errors.iter_mut().zip(&flux_t[*first..]);
                own.for_each(|(error, t)| *error = round::yield_kpa(t + *error) - round::yield_kpa(*t));
            }
        }
        (Channel::Pulp, None, Some(shaft_mm)) => read.iter_mut().zip(shaft_mm).for_each(|(x, shaft)| *x -= shaft),
        (Channel::Pulp | Channel::Fluid, ..) => return None,
        _ => {}
    }
    let gap_mm = run.recording.column(GAP_MM).and_then(|gap| gap.first().copied()).unwrap_or(0.0);
    let explained = explained.filter(|input| input.len() == read.len());
    let (input, input_left) = match explained {
        Some(input) => (input.clone(), Vec::new()),
        None if channel.input_is_measured() => smooth::smoothed(&run.recording.time_s, &read),
        None => (read.clone(), Vec::new()),
    };
    let compared = compared(channel, &run.recording.time_s, (&read, &input), &yield_kpa);
    Some(Series {
        file: run.file.clone(),
        channel,
        time_s: run.recording.time_s.clone(),
        compared,
        input,
        yield_kpa,
        output,
        is_answered: explained.is_some(),
        left: [input_left, yield_left],
        gap_ratio: 1.0,
        gap_mm: if channel == Channel::Flux { gap_mm } else { 0.0 },
        condition: 0,
        hold_out: run.hold_out,
    })
}

/// Samples that are compared: where the sensor tells, and a fluid yields under a finger whose place is smoothed.
pub(super) fn compared(
    channel: Channel,
    time_s: &[f64],
    (input, place_mm): (&[f64], &[f64]),
    yield_kpa: &[f64],
) -> Vec<bool> {
    let mut compared: Vec<bool> = input.iter().map(|x| *x >= channel.least_input()).collect();
    if channel == Channel::Fluid {
        compared
            .iter_mut()
            .zip(yielding::is_borne(time_s, place_mm, yield_kpa))
            .for_each(|(compared, borne)| *compared &= borne);
    }
    compared
}

/// For every run the first one that was told the same, to the last bit: every repeat of a logged command on one clock.
pub(super) fn first_alike(series: &[Series]) -> Vec<usize> {
    let same = |a: &Series, b: &Series| {
        let state = |s: &Series| (s.is_answered, s.gap_ratio, s.gap_mm);
        state(a) == state(b) && a.time_s == b.time_s && a.input == b.input && a.yield_kpa == b.yield_kpa
    };
    (0..series.len()).map(|at| (0..at).find(|first| same(&series[*first], &series[at])).unwrap_or(at)).collect()
}

/// Where time jumps, if it does.
fn interrupted(time_s: &[f64]) -> Option<f64> {
    let mut steps: Vec<f64> = time_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let at = steps.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).map(|(at, _)| at)?;
    let largest = steps[at];
    steps.sort_by(f64::total_cmp);
    (largest > INTERRUPTED * steps[steps.len() / 2]).then(|| time_s[at])
}

fn alike(a: &Series, b: &Series, input_range: f64) -> bool {
    let count = a.input.len().min(b.input.len());
    if a.input.len().abs_diff(b.input.len()) * 50 > count || (a.gap_mm - b.gap_mm).abs() > 1e-6 {
        return false;
    }
    let rms = |square: f64| (square / count.max(1) as f64).sqrt();
    let told: f64 = a.told().zip(b.told()).map(|(x, y)| (x - y).powi(2)).sum();
    let yields: f64 = a.yield_kpa.iter().zip(&b.yield_kpa).map(|(x, y)| (x - y).powi(2)).sum();
    let most_kpa = a.yield_kpa.iter().fold(0.0_f64, |most, kpa| most.max(*kpa));
    let clock = a.time_s.iter().zip(&b.time_s).all(|(x, y)| ((x - a.time_s[0]) - (y - b.time_s[0])).abs() < 5e-3);
    clock && rms(told) < SAME_INPUT * input_range && rms(yields) < SAME_YIELD * most_kpa + GAUSS_KPA
}
