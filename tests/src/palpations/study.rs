//! Many palpations at one rate, counted.

use protocol::lut::Table;
use protocol::message::Outcome;

use super::{Conditions, Judged, PressedFoam, RATES_MM_S, Spread, ThesisWay, by_threshold, judge, session};

/// Presses of EVA, B1, ICF and A2 in a session of 150 (thesis section 3.4).
pub const THESIS_COUNTS: [usize; 4] = [34, 50, 24, 42];

/// A press and both verdicts.
#[derive(Debug, Clone, PartialEq)]
pub struct Palpated {
    /// Which of the foams.
    pub foam: usize,
    /// How often it was pressed in the session, from 1.
    pub number: usize,
    /// True height of the surface, mm.
    pub surface_mm: f64,
    /// The board's verdict.
    pub judged: Judged,
    /// The thesis' way on the same samples.
    pub thesis: Option<ThesisWay>,
}

/// How many of how many.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Count {
    /// Recognised.
    pub right: usize,
    /// All.
    pub of: usize,
}

impl Count {
    /// In percent.
    pub fn percent(&self) -> f64 {
        100.0 * self.right as f64 / self.of.max(1) as f64
    }
}

/// Sessions at one rate.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// Rate, mm/s.
    pub rate_mm_s: f64,
    /// All presses, in order, session by session.
    pub palpated: Vec<Palpated>,
}

impl Study {
    /// Palpates `sessions` sessions of `counts` presses each at rate number `rate`; the seeds are 1, 2, ... `done` is called
    /// after every session.
    pub fn run(
        foams: &[PressedFoam],
        table: &Table<'_>,
        rate: usize,
        (sessions, counts): (usize, &[usize]),
        conditions: &Conditions,
        done: &mut dyn FnMut(),
    ) -> Study {
        let rate_mm_s = RATES_MM_S[rate];
        let mut palpated = Vec::new();
        for number in 0..sessions {
            for press in session(foams, counts, rate, conditions, 1 + number as u64) {
                let foam = &foams[press.foam];
                let noise_n = conditions.noise_n(foam.peak_n(rate));
                palpated.push(Palpated {
                    foam: press.foam,
                    number: press.number,
                    surface_mm: press.surface_mm,
                    judged: judge(table, &press.samples, rate_mm_s),
                    thesis: by_threshold(table, &press.samples, foam.height_mm, noise_n),
                });
            }
            done();
        }
        Study { rate_mm_s, palpated }
    }

    fn of(&self, foam: Option<usize>) -> impl Iterator<Item = &Palpated> {
        self.palpated.iter().filter(move |p| foam.is_none_or(|f| f == p.foam))
    }

    /// Presses of a foam, or of all, that the board named rightly.
    pub fn recognised(&self, foams: &[PressedFoam], foam: Option<usize>) -> Count {
        let right = self.of(foam).filter(|p| p.judged.named == Some(foams[p.foam].index)).count();
        Count { right, of: self.of(foam).count() }
    }

    /// The same for the thesis' way: nearest curve of the library at the contact of the threshold.
    pub fn recognised_by_threshold(&self, foams: &[PressedFoam], foam: Option<usize>) -> Count {
        let right = self.of(foam).filter(|p| p.thesis.is_some_and(|t| t.nearest == foams[p.foam].index)).count();
        Count { right, of: self.of(foam).count() }
    }

    /// The same for the Kalman filter: nearest curve of the library to that of its estimate.
    pub fn recognised_by_filter(&self, foams: &[PressedFoam], foam: Option<usize>) -> Count {
        let named = |p: &Palpated| p.judged.filtered.as_ref().and_then(|f| f.named);
        let right = self.of(foam).filter(|p| named(p) == Some(foams[p.foam].index)).count();
        Count { right, of: self.of(foam).count() }
    }

    /// Spread of the exponent that the board found for a foam, over the presses for which it gave one.
    pub fn alpha(&self, foam: usize) -> Spread {
        let given = |p: &&Palpated| p.judged.verdict.outcome == Outcome::Identified;
        Spread::of(&self.of(Some(foam)).filter(given).map(|p| f64::from(p.judged.verdict.alpha)).collect::<Vec<_>>())
    }

    /// Spread of the exponent that the thesis' way found for a foam.
    pub fn alpha_by_threshold(&self, foam: usize) -> Spread {
        Spread::of(&self.of(Some(foam)).filter_map(|p| p.thesis.map(|t| t.alpha)).collect::<Vec<_>>())
    }

    /// Spread of the exponent that the filter found for a foam.
    pub fn alpha_by_filter(&self, foam: usize) -> Spread {
        Spread::of(
            &self
                .of(Some(foam))
                .filter_map(|p| p.judged.filtered.as_ref().map(|f| f64::from(f.estimate.alpha)))
                .collect::<Vec<_>>(),
        )
    }
}
