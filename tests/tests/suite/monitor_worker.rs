//! The monitor's worker against the simulated board: commands carried out, records written, a lost link opened again, outputs off at the end.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use palpate::link::{InProcess, Link, LinkError, Pace};
use palpate::log::COLUMNS;
use palpate::monitor::{Command, Opener, Settings, Update, Worker};
use palpate::plant::{Jitter, Truth};
use palpate::session::Event;
use palpate::simulated_board::SimulatedBoard;
use protocol::message::{Mode, State};
use tests::robustness::seeds;

/// A board that outlives its links, and a cable that can be pulled.
#[derive(Clone)]
struct Cable {
    board: Arc<Mutex<InProcess>>,
    pulled: Arc<Mutex<bool>>,
}

impl Cable {
    fn new() -> Self {
        let board = InProcess::new(SimulatedBoard::new(1, Jitter::NONE), Pace::Free);
        Cable { board: Arc::new(Mutex::new(board)), pulled: Arc::default() }
    }

    fn pull(&self, pulled: bool) {
        *self.pulled.lock().unwrap() = pulled;
    }

    fn whole(&self) -> Result<(), LinkError> {
        if *self.pulled.lock().unwrap() { Err(LinkError::Closed { link: "the cable".into() }) } else { Ok(()) }
    }

    fn opener(&self) -> Opener {
        let cable = self.clone();
        Box::new(move || {
            cable.whole()?;
            Ok(Box::new(cable.clone()))
        })
    }

    fn state(&self) -> State {
        self.board.lock().unwrap().board().state()
    }
}

impl Link for Cable {
    fn name(&self) -> &str {
        "the cable"
    }

    fn now_s(&self) -> f64 {
        self.board.lock().unwrap().now_s()
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.whole()?;
        self.board.lock().unwrap().send(bytes)
    }

    fn receive(&mut self, into: &mut Vec<u8>, deadline_s: f64) -> Result<(), LinkError> {
        self.whole()?;
        // Free pace would fill the channel with years of telemetry.
        std::thread::sleep(Duration::from_millis(1));
        self.board.lock().unwrap().receive(into, deadline_s)
    }

    fn take_truth(&mut self) -> Vec<Truth> {
        self.board.lock().unwrap().take_truth()
    }
}

struct Watched {
    worker: Worker,
    stop: Arc<AtomicBool>,
}

impl Watched {
    /// The first update that `wanted` takes.
    fn until<T>(&self, mut wanted: impl FnMut(&Update) -> Option<T>) -> T {
        let end = Instant::now() + Duration::from_secs(60);
        while Instant::now() < end {
            if let Some(update) = self.worker.update(Duration::from_millis(100)).unwrap()
                && let Some(found) = wanted(&update)
            {
                return found;
            }
        }
        panic!("it did not come within a minute");
    }

    fn done(&self) -> String {
        self.until(|update| match update {
            Update::Done(text) => Some(text.clone()),
            Update::Refused(text) => panic!("{text}"),
            _ => None,
        })
    }
}

fn start(cable: &Cable, folder: &std::path::Path) -> Watched {
    let settings = Settings {
        table: Some(seeds::small_table()),
        upload_at_start: true,
        folder: folder.into(),
        retry: Duration::from_millis(20),
        stop: Arc::default(),
    };
    let stop = Arc::clone(&settings.stop);
    Watched { worker: Worker::start(cable.opener(), settings), stop }
}

/// One that has tried to reach a board and has not.
fn start_without_a_board(folder: &std::path::Path) -> Watched {
    let cable = Cable::new();
    cable.pull(true);
    let watched = start(&cable, folder);
    watched.until(|update| matches!(update, Update::Lost(_)).then_some(()));
    watched
}

fn state_of(update: &Update) -> Option<State> {
    match update {
        Update::Event(Event::Telemetry(t), _) => Some(t.state),
        _ => None,
    }
}

#[test]
fn commands_are_carried_out_recorded_and_undone_at_the_end() {
    let folder = tempfile::tempdir().unwrap();
    let cable = Cable::new();
    let watched = start(&cable, folder.path());
    assert!(watched.done().starts_with("table of "));
    watched.worker.command(Command::Record(true));
    let csv = watched.until(|update| match update {
        Update::Recording(path) => path.clone(),
        _ => None,
    });
    watched.worker.command(Command::Mode(Mode::Display { material: 0 }));
    assert_eq!(watched.done(), "displaying material 0");
    watched.until(|update| state_of(update).filter(|state| *state == State::Display));
    watched.worker.command(Command::Mode(Mode::Display { material: 200 }));
    let refused = watched.until(|update| match update {
        Update::Refused(text) => Some(text.clone()),
        _ => None,
    });
    assert!(refused.starts_with("the cable refused SetMode: "), "{refused}");
    assert_eq!(cable.state(), State::Display);
    drop(watched);
    assert_eq!(cable.state(), State::Idle);
    let text = std::fs::read_to_string(&csv).unwrap();
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some(COLUMNS));
    assert!(text.contains(",Display,") && text.ends_with('\n'));
    let recovered = palpate::log::recover_mcap(&csv.with_extension("mcap")).unwrap();
    assert_eq!(recovered.torn, None);
    assert!(recovered.messages.iter().filter(|(topic, ..)| topic.contains("telemetry")).count() == lines.count());
}

#[test]
fn a_lost_link_is_told_tried_again_and_found_with_outputs_off() {
    let folder = tempfile::tempdir().unwrap();
    let cable = Cable::new();
    let watched = start(&cable, folder.path());
    watched.done();
    watched.worker.command(Command::Mode(Mode::Display { material: 0 }));
    watched.done();
    cable.pull(true);
    let reason = watched.until(|update| match update {
        Update::Lost(reason) => Some(reason.clone()),
        _ => None,
    });
    assert_eq!(reason, "the cable closed the connection");
    // Commands meanwhile are refused by name, and it goes on trying.
    watched.worker.command(Command::Tare);
    watched.until(|update| matches!(update, Update::Refused(text) if text == "no link to the board").then_some(()));
    watched.until(|update| matches!(update, Update::Opening(_)).then_some(()));
    assert_eq!(cable.state(), State::Display, "the simulated board's time stands still without a link");
    cable.pull(false);
    watched.until(|update| matches!(update, Update::Opened(..)).then_some(()));
    watched.until(|update| state_of(update).filter(|state| *state == State::Idle));
}

#[test]
fn a_recording_goes_on_over_a_lost_link_and_notes_the_gap() {
    let folder = tempfile::tempdir().unwrap();
    let cable = Cable::new();
    let watched = start(&cable, folder.path());
    watched.done();
    watched.worker.command(Command::Record(true));
    let csv = watched.until(|update| match update {
        Update::Recording(path) => path.clone(),
        _ => None,
    });
    watched.until(|update| state_of(update).map(|_| ()));
    cable.pull(true);
    watched.until(|update| matches!(update, Update::Lost(_)).then_some(()));
    cable.pull(false);
    let gap = watched.until(|update| match update {
        Update::Event(Event::Gap(gap), _) => Some(gap.clone()),
        _ => None,
    });
    assert_eq!((gap.link_lost.as_deref(), gap.restarted), (Some("the cable closed the connection"), None));
    watched.until(|update| state_of(update).map(|_| ()));
    drop(watched);
    let text = std::fs::read_to_string(&csv).unwrap();
    assert!(text.contains(&palpate::session::gap_text(&gap)), "{text}");
    let recovered = palpate::log::recover_mcap(&csv.with_extension("mcap")).unwrap();
    assert_eq!(recovered.torn, None);
    let over = |topic: &str, value: &serde_json::Value| topic == "gap" && value["over"] == true;
    assert_eq!(recovered.messages.iter().filter(|(topic, _, value)| over(topic, value)).count(), 1);
}

#[test]
fn a_worker_that_is_dropped_without_a_board_ends_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let watched = start_without_a_board(folder.path());
    let began = Instant::now();
    drop(watched);
    assert!(began.elapsed() < Duration::from_secs(5), "{:?}", began.elapsed());
}

#[test]
fn a_signal_switches_the_outputs_off_though_nobody_takes_the_updates() {
    let folder = tempfile::tempdir().unwrap();
    let cable = Cable::new();
    let watched = start(&cable, folder.path());
    assert!(watched.done().starts_with("table of "));
    watched.worker.command(Command::Mode(Mode::Display { material: 0 }));
    watched.until(|update| (state_of(update) == Some(State::Display)).then_some(()));
    watched.stop.store(true, Ordering::Relaxed);
    let end = Instant::now() + Duration::from_secs(60);
    while cable.state() != State::Idle {
        assert!(Instant::now() < end, "the outputs stay on");
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn a_signal_ends_the_attempts_to_reach_a_board() {
    let folder = tempfile::tempdir().unwrap();
    let watched = start_without_a_board(folder.path());
    watched.stop.store(true, Ordering::Relaxed);
    let end = Instant::now() + Duration::from_secs(60);
    while watched.worker.update(Duration::from_millis(100)).is_ok() {
        assert!(Instant::now() < end, "it still tries");
    }
}
