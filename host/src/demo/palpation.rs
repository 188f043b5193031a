//! One palpation of the demo.

use protocol::message::{Estimate, Mode, Outcome, State, Verdict};

use super::listening::Listening;
use super::{DemoError, Options, Stage, Watcher};
use crate::log::verdict_text;
use crate::plant::Foam;
use crate::session::{Event, fault_text, gap_text};

/// One control tick in contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TracePoint {
    /// Board time, s.
    pub time_s: f64,
    /// What the board is doing.
    pub pressing: bool,
    /// Depth as the board believes it during contact, mm.
    pub belief_depth_mm: f64,
    /// Height of the probe as read, mm.
    pub sensor_probe_mm: f64,
    /// Load cell as read, N.
    pub sensor_force_n: f64,
    /// True depth, mm.
    pub true_depth_mm: f64,
    /// True force, N.
    pub true_force_n: f64,
    /// Mean absolute difference of the best column so far, N.
    pub search_error_n: f64,
}

/// What one palpation was and what the board made of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Palpated {
    /// Its number, from 1.
    pub number: usize,
    /// The foam under the probe.
    pub truth: String,
    /// Its modulus, MPa.
    pub true_mu_mpa: f64,
    /// Its exponent.
    pub true_alpha: f64,
    /// Its height, mm.
    pub true_height_mm: f64,
    /// What the board said.
    pub verdict: Verdict,
    /// mu, alpha and height with standard errors, as it said before that.
    pub estimate: Option<Estimate>,
    /// Name of the identified library material; empty for none.
    pub identified: String,
    /// Approach, contact and return, tick by tick.
    pub trace: Vec<TracePoint>,
}

impl Palpated {
    /// True if the board named the foam that was there.
    pub fn recognised(&self) -> bool {
        self.truth == self.identified
    }

    /// How far mu and alpha lie from the truth, in stated standard errors; none if the board stated none.
    pub fn off(&self) -> Option<(f64, f64)> {
        let e = self.estimate.as_ref().filter(|_| self.verdict.outcome == Outcome::Identified)?;
        let off = |found: f32, truth: f64, error: f32| (f64::from(found) - truth) / f64::from(error);
        Some((off(e.mu_mpa, self.true_mu_mpa, e.mu_error_mpa), off(e.alpha, self.true_alpha, e.alpha_error)))
    }

    /// Truth and verdict in a line.
    pub fn sentence(&self) -> String {
        let name = if self.identified.is_empty() { "nothing known" } else { &self.identified };
        format!("{:>3}: {} taken for {name}", self.number, self.truth)
    }
}

/// Longest palpation, s of board time: 4 mm of approach and of depth at 1 mm/s, the return, the analysis, and as much again.
pub(super) const LONGEST_S: f64 = 30.0;

/// Lays a foam under the probe and palpates it.
pub(super) fn palpate(
    listening: &mut Listening,
    foam: &Foam,
    library: &[String],
    options: &Options,
    number: usize,
    watch: Watcher<'_>,
) -> Result<Palpated, DemoError> {
    listening.board().place(foam.clone());
    let mode = Mode::Palpate { rate_mm_s: options.rate_mm_s as f32, depth_mm: options.depth_mm as f32 };
    listening.session().set_mode(mode)?;
    let deadline_s = listening.now_s() + LONGEST_S;
    let mut trace = Vec::new();
    let mut estimate = None;
    let verdict = loop {
        match listening.next(deadline_s)? {
            None => {
                let state = format!("{:?}", listening.session().status()?.state);
                return Err(DemoError::Endless { number, waited_s: LONGEST_S, state });
            }
            Some((Event::Halves(_), _)) => {}
            Some((Event::Estimate(e), _)) => estimate = Some(e),
            Some((Event::Verdict(verdict), _)) => break verdict,
            Some((Event::Fault(fault), _)) => watch(Stage::Note(&fault_text(&fault))),
            Some((Event::Gap(gap), _)) => watch(Stage::Note(&gap_text(&gap))),
            Some((Event::Telemetry(t), truth)) => {
                // Records of the ticks before belong to the previous foam.
                if let Some(truth) = truth.filter(|_| t.state != State::Idle) {
                    trace.push(TracePoint {
                        time_s: truth.time_s,
                        pressing: t.state == State::Contact,
                        belief_depth_mm: f64::from(t.depth_mm),
                        sensor_probe_mm: f64::from(t.probe_mm),
                        sensor_force_n: f64::from(t.load_cell_n),
                        true_depth_mm: truth.depth_mm,
                        true_force_n: truth.force_n,
                        search_error_n: f64::from(t.search_error_n),
                    });
                }
            }
        }
    };
    if verdict.outcome == Outcome::Aborted {
        watch(Stage::Note(&verdict_text(&verdict, library)));
        listening.session().clear_faults()?;
    }
    let identified = library.get(usize::from(verdict.material.index)).cloned().unwrap_or_default();
    Ok(Palpated {
        number,
        truth: foam.name.clone(),
        true_mu_mpa: foam.mu_mpa,
        true_alpha: foam.alpha,
        true_height_mm: foam.height_mm,
        estimate: estimate.filter(|e| e.palpation == verdict.palpation),
        verdict,
        identified,
        trace,
    })
}
