//! Diagnosis of a table of x and y: a calibration, or measured values beside simulated ones.
//!
//! The same questions in the same order as for an indentation ([`crate::diagnose`]): what do repeats of one
//! reading differ by; does the law, a line or the simulation, miss by more; which effects explain it; what
//! do they gain on readings that were left out; which readings would decide.

mod alone;
pub mod answer;
pub mod effect;
mod fit;
mod forward;
mod magnet;
mod plan;
pub mod readings;

use std::time::Instant;

use crate::calibration::lack_of_fit::{LackOfFit, LackOfFitError};
use crate::calibration::polynomial::Polynomial;
use crate::diagnose::Verdict;
use crate::experiment::Experiment;
use crate::infer::covariance::Z95;
use crate::infer::sets::{Outcome, Told, Weighing};

pub use alone::{AllAlone, Alone};
use fit::Problem;
pub use fit::{Fit, Judged, Law, Weighed};
use forward::Search;
pub use plan::{Proposal, passes};
pub use readings::{Table, Unusable};

/// A parameter with its 95 % interval.
pub type Estimate = (&'static str, f64, (f64, f64));

/// Degrees of freedom of repeats without which noise is not known well enough to name anything.
const LEAST_FREEDOM: usize = 3;
/// Level at which a law counts as missed though nothing has a name.
const LEVEL: f64 = 0.01;

/// Why nothing is named.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TooFew {
    /// The test of lack of fit cannot be made.
    #[error("{0}")]
    NoTest(#[from] LackOfFitError),
    /// No repeat comes from the side of the first.
    #[error(
        "what is read again comes from the other side: a loop and noise cannot be told apart; read at least one x twice from the same side"
    )]
    OtherSide,
    /// Too few repeats.
    #[error(
        "repeats have {found} degrees of freedom, expected at least {LEAST_FREEDOM}: what a reading scatters by is not known; read every x again, from the same side"
    )]
    Freedom {
        /// What they have.
        found: usize,
    },
}

/// One effect, or a set of names that stands for it.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// The effect.
    pub effect: &'static effect::Effect,
    /// Parameters with 95 % intervals.
    pub parameters: Vec<Estimate>,
    /// Other names that these readings cannot tell from it.
    pub ambiguous_with: Vec<&'static str>,
    /// Probability that it is there.
    pub probability: f64,
    /// Share of the misfit that it explains alone.
    pub explains: Option<f64>,
}

/// Error on x that were left out, in the unit of y.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeldOut {
    /// With the base.
    pub before: f64,
    /// With what was found.
    pub after: f64,
}

/// What was found about a table.
#[derive(Debug)]
pub struct Diagnosis {
    /// The readings.
    pub table: Table,
    /// The verdict.
    pub verdict: Verdict,
    /// Named effects.
    pub findings: Vec<Finding>,
    /// What the misfit varies with, the largest first.
    pub shows_in: Vec<&'static str>,
    /// Effects of which a plausible amount would not be seen.
    pub blind_to: Vec<&'static str>,
    /// Next readings, the best first.
    pub proposals: Vec<Proposal>,
    /// Why nothing is named, if so.
    pub too_few: Option<TooFew>,
    /// Test of the base against repeats.
    pub lack_of_fit: Option<LackOfFit>,
    /// Straight line through what the base is compared with: y, or y less the simulated value.
    pub line: Option<Polynomial>,
    /// The same with a curvature.
    pub parabola: Option<Polynomial>,
    /// What the verdict rests on.
    pub evidence: Option<Evidence>,
    /// Beside a magnet: every part of it as the only cause.
    pub alone: Option<AllAlone>,
    /// Wall time, s.
    pub seconds: f64,
}

/// What a verdict rests on.
#[derive(Debug)]
pub struct Evidence {
    /// Standard deviation of a reading, and degrees of freedom behind it.
    pub sigma: (f64, usize),
    /// The base.
    pub base: Weighed,
    /// Sets that were weighed, the likeliest first.
    pub sets: Vec<Weighed>,
    /// The likeliest set of what is named, one for each choice among twins.
    pub held: Vec<Weighed>,
    /// What is believed.
    pub judged: Judged,
    /// Error on x that were left out.
    pub held_out: Option<HeldOut>,
}

impl Weighed {
    /// Parameters with 95 % intervals, discrepancies allowed for: of the base, or of its `effect`-th effect.
    #[must_use]
    pub fn told(&self, effect: Option<usize>) -> Vec<Estimate> {
        let law = &self.fit.law;
        let first = |at: usize| law.base.len() + law.settings[..at].iter().map(|(_, v)| v.len()).sum::<usize>();
        let range = effect.map_or(0..law.base.len(), |at| first(at)..first(at + 1));
        let each =
            range.map(|j| self.fit.coordinates[j].estimate(self.evidence.x[j], Z95 * self.evidence.deviations[j]));
        each.collect()
    }
}

/// Diagnoses the table of an experiment; none when it holds none.
///
/// # Errors
/// A table that cannot be used.
pub fn diagnose(experiment: &Experiment) -> Result<Option<Diagnosis>, Unusable> {
    let start = Instant::now();
    let Some(table) = Table::of(experiment)? else { return Ok(None) };
    let mut out = Diagnosis {
        verdict: Verdict::TooFewData,
        findings: Vec::new(),
        shows_in: Vec::new(),
        blind_to: Vec::new(),
        proposals: Vec::new(),
        too_few: None,
        lack_of_fit: None,
        line: None,
        parabola: None,
        evidence: None,
        alone: None,
        seconds: 0.0,
        table,
    };
    out.examine();
    out.seconds = start.elapsed().as_secs_f64();
    Ok(Some(out))
}

/// Standard deviation of a reading from its repeats, and their degrees of freedom.
fn scatter(table: &Table) -> (f64, usize) {
    let (mut square, mut freedom) = (0.0, 0);
    for group in table.repeats() {
        let mean = group.iter().map(|at| table.readings[*at].y).sum::<f64>() / group.len() as f64;
        square += group.iter().map(|at| (table.readings[*at].y - mean).powi(2)).sum::<f64>();
        freedom += group.len() - 1;
    }
    ((square / freedom.max(1) as f64).sqrt(), freedom)
}

/// Root mean square of what a straight line leaves, its two coefficients counted.
fn off_line(points: &[(f64, f64)], line: Option<&Polynomial>) -> f64 {
    let Some(line) = line else { return f64::INFINITY };
    let left = |(x, y): &(f64, f64)| y - line.coefficients[0].0 - line.coefficients[1].0 * x;
    let square: f64 = points.iter().map(left).map(|v| v * v).sum();
    (square / points.len().saturating_sub(2).max(1) as f64).sqrt()
}

impl Diagnosis {
    fn examine(&mut self) {
        let table = self.table.clone();
        let used = vec![true; table.readings.len()];
        let base = Problem { table: &table, sigma: 1.0, used: used.clone() }.fit(&table.nominal());
        let rest: Vec<(f64, f64)> = match table.is_simulated {
            true => table.readings.iter().map(|r| (r.x, r.y - r.simulated.unwrap_or(0.0))).collect(),
            false => table.points(),
        };
        self.line = Polynomial::fit(&rest, 1).ok();
        self.parabola = Polynomial::fit(&rest, 2).ok();
        self.alone = alone::all_alone(&table, off_line(&rest, self.line.as_ref()));
        let predicted: Vec<f64> = table.readings.iter().map(|r| base.law.predict(&table, r)).collect();
        let mut repeated: Vec<(f64, f64)> = table.points();
        for (number, group) in table.repeats().into_iter().enumerate() {
            group.into_iter().for_each(|at| repeated[at].0 = number as f64);
        }
        let test = LackOfFit::of(&repeated, &predicted, base.law.base.len());
        let (sigma, freedom) = scatter(&table);
        self.lack_of_fit = test.as_ref().ok().copied();
        let few = match test {
            Err(LackOfFitError::NoRepeats) if table.readings.len() > table.places.len() => Some(TooFew::OtherSide),
            Err(cause) => Some(cause.into()),
            Ok(_) if freedom < LEAST_FREEDOM => Some(TooFew::Freedom { found: freedom }),
            Ok(_) => None,
        };
        if few.is_some() {
            self.too_few = few;
            self.proposals = plan::without_noise(self);
            return;
        }
        // a reading that repeats exactly is rounded; what is not known of the noise widens it as Student's t does
        let rounded = 1e-4 * table.span;
        let wide = (freedom as f64 / (freedom as f64 - 2.0)).sqrt();
        let sigma = (wide * sigma).max(rounded);
        self.judge(Search::new(Problem { table: &table, sigma, used }), (sigma, freedom));
    }

    fn judge(&mut self, search: Search<'_>, sigma: (f64, usize)) {
        let groups = search.groups();
        let Some(mut found) = Weighing::of(&search, &groups, search.base.law.base.len()) else { return };
        let best = found.held.first();
        let held_out = best.and_then(|best| left_out(&search.problem, &search.base.law, &best.fit.law));
        let predicts = held_out.is_none_or(|h| h.after < h.before);
        found.keep_names(predicts && best.is_some_and(|best| !best.fit.at_bound));
        let is_missed = self.lack_of_fit.is_some_and(|test| test.probability < LEVEL);
        if found.judged.outcome == Outcome::Clean && is_missed {
            found.judged.outcome = Outcome::Unknown;
        }
        self.verdict = found.judged.outcome.into();
        self.findings = found.held.first().map_or_else(Vec::new, |best| findings(&found.judged, best));
        self.shows_in = found.shows_in(&groups);
        self.blind_to = found.blind_to(&search, &groups, effect::CATALOGUE.map(|effect| effect.code));
        self.proposals = plan::proposals(&search, &found.sets, &found.judged, &self.blind_to);
        let Weighing { base, sets, held, judged } = found;
        self.evidence = Some(Evidence { sigma, base, sets, held, judged, held_out });
    }
}

/// What is named, of the likeliest set.
fn findings(judged: &Judged, best: &Weighed) -> Vec<Finding> {
    let each = best.fit.effects.iter().enumerate().map(|(at, effect)| {
        let Told { probability, explains, twins } = judged.told(effect.code);
        Finding { effect, parameters: best.told(Some(at)), ambiguous_with: twins, probability, explains }
    });
    each.collect()
}

/// Error on every x as the readings at all others predict it, with the base and with a law.
fn left_out(problem: &Problem<'_>, base: &Law, law: &Law) -> Option<HeldOut> {
    let table = problem.table;
    if table.places.len() < law.base.len() + law.settings.iter().map(|(_, v)| v.len()).sum::<usize>() + 1 {
        return None;
    }
    let error = |law: &Law| {
        let of = |place: usize| {
            let used = table.readings.iter().map(|r| r.place != place).collect();
            let fit = Problem { used, ..problem.clone() }.fit(law);
            let own = table.readings.iter().filter(|r| r.place == place);
            own.map(|r| (r.y - fit.law.predict(table, r)).powi(2)).sum::<f64>()
        };
        let sum: f64 = (0..table.places.len()).map(of).sum();
        (sum / table.readings.len() as f64).sqrt()
    };
    Some(HeldOut { before: error(base), after: error(law) })
}
