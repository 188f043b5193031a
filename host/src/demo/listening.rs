//! A conversation whose every word is logged.

use std::collections::VecDeque;

use crate::link::{Disturbed, InProcess};
use crate::log::{LogError, Recorder};
use crate::plant::Truth;
use crate::session::{Event, Session, SessionError};
use crate::simulated_board::SimulatedBoard;

/// Link of the demo.
pub(super) type Line = Disturbed<InProcess>;

/// Session and recorder together, with the truths that belong to records still to come.
pub(super) struct Listening {
    session: Session<Line>,
    recorder: Recorder,
    truths: VecDeque<Truth>,
}

/// Either side of listening.
#[derive(Debug, thiserror::Error)]
pub(super) enum ListeningError {
    #[error(transparent)]
    Session(#[from] SessionError),
    #[error(transparent)]
    Log(#[from] LogError),
}

impl From<ListeningError> for super::DemoError {
    fn from(error: ListeningError) -> Self {
        match error {
            ListeningError::Session(e) => e.into(),
            ListeningError::Log(e) => e.into(),
        }
    }
}

impl Listening {
    pub(super) fn new(mut session: Session<Line>, recorder: Recorder) -> Self {
        // What happened before the log began belongs to no log.
        let _ = crate::link::Link::take_truth(session.link_mut());
        Listening { session, recorder, truths: VecDeque::new() }
    }

    pub(super) fn session(&mut self) -> &mut Session<Line> {
        &mut self.session
    }

    pub(super) fn board(&mut self) -> &mut SimulatedBoard {
        self.session.link_mut().inner_mut().board_mut()
    }

    pub(super) fn now_s(&self) -> f64 {
        self.session.link().inner().board().time_s()
    }

    pub(super) fn into_parts(self) -> (Session<Line>, Recorder) {
        (self.session, self.recorder)
    }

    /// The next event until `deadline_s`, logged; for telemetry with the truth of its tick.
    pub(super) fn next(&mut self, deadline_s: f64) -> Result<Option<(Event, Option<Truth>)>, ListeningError> {
        let event = self.session.poll(deadline_s)?;
        for truth in crate::link::Link::take_truth(self.session.link_mut()) {
            self.truths.push_back(truth.clone());
            self.recorder.truth(truth)?;
        }
        let Some(event) = event else {
            self.recorder.keep_if_due()?;
            return Ok(None);
        };
        self.recorder.event(&event, &self.session.traffic())?;
        let mut truth = None;
        if let Event::Telemetry(record) = &event {
            while self.truths.front().is_some_and(|t| t.tick < record.tick) {
                self.truths.pop_front();
            }
            truth = self.truths.front().filter(|t| t.tick == record.tick).cloned();
        }
        Ok(Some((event, truth)))
    }
}
