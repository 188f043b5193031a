//! A conversation goes on when the board behind the line restarts, and over another link: nothing is counted as lost that
//! was never sent, and the gap is told with its cause.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::cell::RefCell;
use std::rc::Rc;

use palpate::link::{InProcess, Link, LinkError, Pace};
use palpate::log::Recorder;
use palpate::plant::Jitter;
use palpate::session::{Event, Gap, Patience, Session, SessionError, gap_text};
use palpate::simulated_board::SimulatedBoard;
use protocol::message::ResetCause;

/// A line that stays open whatever is done to the board at its end.
#[derive(Clone)]
struct Bench(Rc<RefCell<State>>);

struct State {
    board: InProcess,
    /// Time that passed with boards before this one, s.
    before_s: f64,
    /// Nothing answers.
    dead: bool,
    /// The cable is out.
    pulled: bool,
}

fn board() -> InProcess {
    InProcess::new(SimulatedBoard::new(1, Jitter::NONE), Pace::Free)
}

impl Bench {
    fn new() -> Self {
        Bench(Rc::new(RefCell::new(State { board: board(), before_s: 0.0, dead: false, pulled: false })))
    }

    fn restart(&self) {
        let mut state = self.0.borrow_mut();
        state.before_s += state.board.now_s();
        state.board = board();
    }

    fn set(&self, change: impl FnOnce(&mut State)) {
        change(&mut self.0.borrow_mut());
    }

    /// The board lives on with nobody at the line.
    fn pass(&self, seconds: f64) {
        let mut state = self.0.borrow_mut();
        let until_s = state.board.now_s() + seconds;
        while state.board.now_s() < until_s {
            state.board.receive(&mut Vec::new(), until_s).unwrap();
        }
    }
}

impl Link for Bench {
    fn name(&self) -> &str {
        "the bench"
    }

    fn now_s(&self) -> f64 {
        let state = self.0.borrow();
        state.before_s + state.board.now_s()
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        let mut state = self.0.borrow_mut();
        if state.pulled {
            return Err(LinkError::Closed { link: "the bench".into() });
        }
        state.board.send(bytes)
    }

    fn receive(&mut self, into: &mut Vec<u8>, deadline_s: f64) -> Result<(), LinkError> {
        let mut state = self.0.borrow_mut();
        if state.pulled {
            return Err(LinkError::Closed { link: "the bench".into() });
        }
        let before_s = state.before_s;
        let mut heard = Vec::new();
        state.board.receive(&mut heard, deadline_s - before_s)?;
        if !state.dead {
            into.extend(heard);
        }
        Ok(())
    }
}

/// Events of the next seconds.
fn listen(session: &mut Session<Bench>, seconds: f64) -> Vec<Event> {
    let until_s = session.link().now_s() + seconds;
    std::iter::from_fn(|| session.poll(until_s).unwrap()).collect()
}

fn gaps(events: &[Event]) -> Vec<Gap> {
    events.iter().filter_map(|event| if let Event::Gap(gap) = event { Some(gap.clone()) } else { None }).collect()
}

fn ticks(events: &[Event]) -> Vec<u32> {
    events.iter().filter_map(|event| if let Event::Telemetry(t) = event { Some(t.tick) } else { None }).collect()
}

#[test]
fn a_board_that_restarts_is_heard_again_and_nothing_counts_as_lost() {
    // Also when it had hardly begun, so that its new clock is soon ahead of the old one.
    for up_s in [0.1, 0.5, 6.0, 30.0] {
        let bench = Bench::new();
        let (mut session, _) = Session::open(bench.clone(), Patience::default()).unwrap();
        session.set_telemetry(2).unwrap();
        let before = ticks(&listen(&mut session, up_s));
        bench.restart();
        let events = listen(&mut session, 5.0);
        let [gap] = &gaps(&events)[..] else { panic!("up {up_s} s: {:?}", gaps(&events)) };
        assert_eq!(gap.restarted, Some(ResetCause::PowerOn), "up {up_s} s: {}", gap_text(gap));
        assert_eq!(gap.after_tick, before.last().copied());
        assert!(gap.silent_s < 2.0, "{}", gap_text(gap));
        let after = ticks(&events);
        assert!(after.len() > 80 && after[0] < 100, "{} records from tick {}", after.len(), after[0]);
        // Every second tick, as before.
        assert!(after.windows(2).all(|pair| pair[1] == pair[0] + 2));
        let traffic = session.traffic();
        assert_eq!((traffic.frames_lost, traffic.telemetry_lost), (0, 0), "up {up_s} s");
    }
}

#[test]
fn another_link_takes_the_conversation_up_and_tells_a_restart_from_a_pulled_cable() {
    for (up_s, away_s, restarts) in
        [(5.0, 3.0, false), (5.0, 3.0, true), (0.2, 0.3, true), (0.2, 0.0, true), (1.0, 0.0, false)]
    {
        let bench = Bench::new();
        let (mut session, _) = Session::open(bench.clone(), Patience::default()).unwrap();
        listen(&mut session, up_s);
        bench.set(|state| state.pulled = true);
        let until_s = session.link().now_s() + 1.0;
        let lost = std::iter::from_fn(|| Some(session.poll(until_s))).find_map(Result::err).unwrap();
        assert!(session.resume(bench.clone(), &lost.to_string()).is_err());
        if restarts {
            bench.restart();
        }
        bench.pass(away_s);
        bench.set(|state| state.pulled = false);
        session.resume(bench.clone(), &lost.to_string()).unwrap();
        let events = listen(&mut session, 1.0);
        let [gap] = &gaps(&events)[..] else { panic!("{:?}", gaps(&events)) };
        assert_eq!(gap.restarted.is_some(), restarts, "up {up_s} s, away {away_s} s: {}", gap_text(gap));
        assert_eq!(gap.link_lost.as_deref(), Some("the bench closed the connection"));
        assert!((gap.silent_s - away_s).abs() < 0.2, "{}", gap_text(gap));
        assert_eq!(session.traffic().frames_lost, 0);
        assert!(ticks(&events).len() > 40);
    }
}

#[test]
fn a_board_that_does_not_come_back_is_an_error() {
    let bench = Bench::new();
    let (mut session, _) = Session::open(bench.clone(), Patience::default()).unwrap();
    listen(&mut session, 2.0);
    bench.restart();
    // It says that it has restarted, and nothing more.
    let until_s = session.link().now_s() + 0.25;
    while session.link().now_s() < until_s {
        bench.pass(0.02);
    }
    bench.set(|state| state.dead = true);
    let error = session.status().unwrap_err();
    assert!(matches!(error, SessionError::NoAnswer { .. }), "{error}");
}

#[test]
fn a_recording_goes_on_over_a_restart_with_time_that_never_goes_back() {
    let folder = tempfile::tempdir().unwrap();
    let [csv, mcap] = ["rec.csv", "rec.mcap"].map(|name| folder.path().join(name));
    let bench = Bench::new();
    let (mut session, _) = Session::open(bench.clone(), Patience::default()).unwrap();
    let mut recorder = Recorder::create_new(Some(&csv), Some(&mcap)).unwrap();
    let mut told = Vec::new();
    for _ in 0..2 {
        for event in listen(&mut session, 3.0) {
            recorder.event(&event, &session.traffic()).unwrap();
            told.extend(gaps(&[event]));
        }
        bench.restart();
    }
    // What is said after the last record stands in that record once more.
    recorder.gap_begins("board lost: the end, \"really\"").unwrap();
    recorder.finish().unwrap();
    let text = std::fs::read_to_string(&csv).unwrap();
    let rows: Vec<csv::StringRecord> =
        csv::Reader::from_reader(text.as_bytes()).records().map(Result::unwrap).collect();
    let time = |row: &csv::StringRecord| row[0].parse::<f64>().unwrap();
    assert!(rows.windows(2).all(|pair| time(&pair[1]) >= time(&pair[0])));
    let noted: Vec<&csv::StringRecord> = rows.iter().filter(|row| !row[row.len() - 1].is_empty()).collect();
    assert_eq!(noted.len(), 2, "{noted:?}");
    assert_eq!(noted[0][noted[0].len() - 1], gap_text(&told[0]));
    let [.., before, last] = &rows[..] else { panic!("{} rows", rows.len()) };
    assert_eq!((&last[1], &last[last.len() - 1]), (&before[1], "board lost: the end, \"really\""));
    let messages = palpate::log::recover_mcap(&mcap).unwrap().messages;
    let gaps: Vec<&serde_json::Value> = messages.iter().filter(|m| m.0 == "gap").map(|m| &m.2).collect();
    assert_eq!(gaps.len(), 2);
    assert_eq!(
        (&gaps[0]["cause"], &gaps[0]["over"], &gaps[1]["over"]),
        (&"power on or brown-out".into(), &true.into(), &false.into())
    );
}
