//! Listening to a board until told to stop, across its restarts and across a link that is lost and found.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use super::{Freeze, LiveView, LogError, Recorder, frozen_text};
use crate::link::{Link, LinkError};
use crate::session::{Event, Gap, Session, SessionError};

/// Longest wait between two drawings, s.
const REFRESH_S: f64 = 0.1;

/// Silence after which the board is asked whether it is still there, s.
const SILENCE_S: f64 = 1.0;

/// Between two attempts to open a lost link.
const ATTEMPTS: Duration = Duration::from_millis(500);

/// How long to listen, and what to do about a board that is lost.
pub struct Terms<'a> {
    /// Ends it after this time, s; `None`: never.
    pub seconds: Option<f64>,
    /// A lost board is tried again for this long, s.
    pub retry_s: f64,
    /// Ends it when set.
    pub stop: &'a AtomicBool,
    /// Opens the link anew.
    pub opener: &'a mut dyn FnMut() -> Result<Box<dyn Link>, LinkError>,
}

/// A recording ended before it should.
#[derive(Debug, thiserror::Error)]
pub enum ListenError {
    /// The board speaks, but not as it should.
    #[error("the board cannot be heard any more: {0}. What was recorded before is kept")]
    Session(#[from] SessionError),
    /// A file takes no more.
    #[error(transparent)]
    Log(#[from] LogError),
    /// The board is gone.
    #[error(
        "the board was lost ({why}) and not heard again within {retry_s} s (last attempt: {last}). What was recorded before is \
         kept. Check cable and power; --retry SECONDS waits longer"
    )]
    Lost {
        /// What ended the conversation.
        why: String,
        /// Time tried, s.
        retry_s: f64,
        /// What the last attempt met with.
        last: String,
    },
    /// Told to stop while the board was gone.
    #[error("the recording ended while the board was lost ({why}). What was recorded before is kept")]
    EndedInGap {
        /// What ended the conversation.
        why: String,
    },
}

/// A conversation that is recorded and shown.
pub struct Listening<'a> {
    /// The conversation.
    pub session: Session<Box<dyn Link>>,
    /// Where it goes.
    pub recorder: Recorder,
    /// Where the second before a fault goes.
    pub freeze: Freeze,
    /// Who sees it.
    pub view: Box<dyn LiveView>,
    /// Stretches in which the board was not heard, those that have ended.
    pub gaps: Vec<Gap>,
    terms: Terms<'a>,
    began: Instant,
}

impl<'a> Listening<'a> {
    /// Begins now.
    pub fn new(
        session: Session<Box<dyn Link>>,
        recorder: Recorder,
        freeze: Freeze,
        view: Box<dyn LiveView>,
        terms: Terms<'a>,
    ) -> Self {
        Listening { session, recorder, freeze, view, gaps: Vec::new(), terms, began: Instant::now() }
    }

    /// Time since the beginning, s.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        self.began.elapsed().as_secs_f64()
    }

    fn is_over(&mut self) -> bool {
        let over = self.terms.seconds.is_some_and(|seconds| self.seconds() >= seconds);
        self.view.refresh() || over || self.terms.stop.load(Ordering::Relaxed)
    }

    /// Listens until told to stop.
    ///
    /// # Errors
    /// [`ListenError`]. The recorder is not finished in either case.
    pub fn run(&mut self) -> Result<(), ListenError> {
        let mut heard_s = self.session.link().now_s();
        while !self.is_over() {
            match self.turn(&mut heard_s) {
                Ok(()) => {}
                Err(ListenError::Session(error @ (SessionError::Link(_) | SessionError::NoAnswer { .. }))) => {
                    self.find_again(&error.to_string())?;
                    heard_s = self.session.link().now_s();
                }
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// Takes what comes, for at most [`REFRESH_S`].
    fn turn(&mut self, heard_s: &mut f64) -> Result<(), ListenError> {
        let now_s = self.session.link().now_s();
        let event = self.session.poll(now_s + REFRESH_S);
        for truth in self.session.link_mut().take_truth() {
            self.recorder.truth(truth)?;
        }
        if let Some(event) = event? {
            *heard_s = now_s;
            self.recorder.event(&event, &self.session.traffic())?;
            self.view.event(&event, &self.session.traffic());
            let frozen = self.freeze.event(&event, &self.session.traffic());
            self.tell_frozen(frozen);
            if let Event::Gap(gap) = event {
                self.gaps.push(gap);
            }
        }
        self.recorder.keep_if_due()?;
        // Telemetry may be rare; a status request tells a slow board from a silent one.
        if self.session.link().now_s() - *heard_s > SILENCE_S {
            self.session.status()?;
            *heard_s = self.session.link().now_s();
        }
        Ok(())
    }

    /// A second that cannot be kept ends nothing: the recording goes on.
    fn tell_frozen(&mut self, frozen: Result<Option<PathBuf>, LogError>) {
        match frozen {
            Ok(Some(path)) => self.view.note(&frozen_text(&path)),
            Ok(None) => {}
            Err(error) => self.view.note(&error.to_string()),
        }
    }

    /// Opens the link until the board is heard again.
    fn find_again(&mut self, why: &str) -> Result<(), ListenError> {
        let lost = Instant::now();
        let retry_s = self.terms.retry_s;
        let told = format!("board lost: {why}; trying again for {retry_s} s");
        self.view.note(&told);
        self.recorder.gap_begins(&told)?;
        let frozen = self.freeze.lost();
        self.tell_frozen(frozen);
        let mut last = why.to_owned();
        while lost.elapsed().as_secs_f64() < retry_s {
            match (self.terms.opener)().map_err(SessionError::from).and_then(|link| self.session.resume(link, why)) {
                Ok(_) => return Ok(()),
                Err(error @ (SessionError::Link(_) | SessionError::NoAnswer { .. })) => last = error.to_string(),
                Err(error) => return Err(error.into()),
            }
            let next = Instant::now() + ATTEMPTS;
            while Instant::now() < next {
                if self.is_over() {
                    return Err(ListenError::EndedInGap { why: why.to_owned() });
                }
                self.recorder.keep_if_due()?;
                std::thread::sleep(Duration::from_millis(50));
            }
        }
        Err(ListenError::Lost { why: why.to_owned(), retry_s, last })
    }
}
