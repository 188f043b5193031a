//! All that a report on gains tells.

use super::gains::{Gains, THESIS};
use super::roots::{Spread, Varied, spread};
use super::step::Step;
use super::worst::Worst;
use super::{Asked, Judged, NoCertificate, TuneError, Tuned, certify, judge, sample, tune};

/// Part by which the thesis varies coefficients (section 5.6).
pub const THESIS_PART: f64 = 0.1;

/// Gains with everything that is known of them.
#[derive(Debug, Clone)]
pub struct Study {
    /// What was asked for.
    pub asked: Asked,
    /// The search; none where the gains were given.
    pub tuned: Option<Tuned>,
    /// The gains on the plant.
    pub judged: Judged,
    /// Others on the same loop: name and figures.
    pub others: Vec<(&'static str, Judged)>,
    /// The worst plant of the box.
    pub worst: Result<Worst, NoCertificate>,
    /// Random plants of the box, and their worst; none where no box or no samples were asked for.
    pub sampled: Option<(usize, Step)>,
    /// Roots of the continuous loop while something varies.
    pub spreads: Vec<Spread>,
    /// Part of its value by which every number of the characteristic equation varies in `spreads`.
    pub part: f64,
}

impl Study {
    /// Searches the gains, or takes those that are given, and looks at them; `samples` random plants and as many roots are drawn.
    ///
    /// # Errors
    /// As [`tune`].
    pub fn of(asked: Asked, given: Option<Gains>, part: f64, samples: usize) -> Result<Self, TuneError> {
        let tuned = if given.is_some() { None } else { Some(tune(&asked)?) };
        let gains = given.or(tuned.as_ref().map(|tuned| tuned.gains)).unwrap_or(THESIS);
        let board = Gains::from(firmware::pid::DEFAULT_GAINS);
        let others = [("gains of the thesis", THESIS), ("the board's default", board)];
        let others =
            others.into_iter().filter(|(_, other)| *other != gains).map(|(name, other)| (name, judge(&asked, &other)));
        let others = others.collect();
        let worst = certify(&asked, &gains);
        let linear = !matches!(worst, Err(NoCertificate::NotLinear | NoCertificate::NoBox));
        let sampled = (linear && samples > 0).then(|| (samples, sample(&asked, &gains, samples)));
        let spreads = if asked.uncertain.plant.delay_s > 0.0 || asked.way != super::Way::Continuous {
            Vec::new()
        } else {
            [Varied::Plant, Varied::Equation]
                .into_iter()
                .filter_map(|varied| spread(&asked.uncertain, &gains, varied, part, samples))
                .collect()
        };
        Ok(Self { judged: judge(&asked, &gains), asked, tuned, others, worst, sampled, spreads, part })
    }
}
