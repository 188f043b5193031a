//! A terminal that takes no more output must not keep outputs on.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::io::{self, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use protocol::message::{Mode, State};
use ratatui::backend::CrosstermBackend;
use ratatui::crossterm::event::{Event, KeyCode, KeyEvent, KeyModifiers};
use ratatui::layout::Rect;
use ratatui::{Terminal, TerminalOptions, Viewport};

use super::loops::{keys, watch};
use super::{Command, Monitor, Settings, Worker};
use crate::link::Address;
use crate::plant::Jitter;
use crate::simulated_board::{SimulatedBoard, press_table, serve};

/// A terminal whose reader has gone to sleep, until it is told that the test is over.
#[derive(Clone, Default)]
struct Stalled {
    stalled: Arc<AtomicBool>,
    waits: Arc<AtomicBool>,
}

impl Write for Stalled {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        while self.stalled.load(Ordering::Relaxed) {
            self.waits.store(true, Ordering::Relaxed);
            std::thread::sleep(Duration::from_millis(1));
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// A board that displays in real time over TCP, watched by a monitor whose terminal has stalled.
struct Bench {
    state: Arc<Mutex<State>>,
    presses: Sender<io::Result<Event>>,
    terminal: Stalled,
    /// Ends the monitor.
    stop: Arc<AtomicBool>,
    /// Ends the board.
    over: Arc<AtomicBool>,
    threads: Vec<JoinHandle<()>>,
}

impl Bench {
    fn stalled() -> Self {
        let (over, terminal) = (Arc::new(AtomicBool::new(false)), Stalled::default());
        let state = Arc::new(Mutex::new(State::Idle));
        let server = serve("127.0.0.1:0", SimulatedBoard::new(1, Jitter::NONE)).unwrap();
        let board = Address::Tcp(server.address().unwrap().to_string());
        let (seen, ended) = (Arc::clone(&state), Arc::clone(&over));
        let served = std::thread::spawn(move || {
            server.run(|board| *seen.lock().unwrap() = board.state(), || !ended.load(Ordering::Relaxed));
        });
        let (presses, events) = channel::<io::Result<Event>>();
        let (screen, stop) = (terminal.clone(), Arc::<AtomicBool>::default());
        let stopped = Arc::clone(&stop);
        let watched = std::thread::spawn(move || {
            let settings = Settings {
                table: Some(press_table().to_bytes().unwrap()),
                upload_at_start: true,
                folder: std::env::temp_dir(),
                retry: Duration::from_millis(100),
                stop: Arc::clone(&stopped),
            };
            let worker = Worker::start(Box::new(move || crate::link::open(&board)), settings);
            worker.command(Command::Mode(Mode::Display { material: 0 }));
            let read = move || events.recv().unwrap_or_else(|_| Err(io::ErrorKind::UnexpectedEof.into()));
            let keys = keys(read, worker.off_switch(), Arc::clone(&stopped));
            let viewport = Viewport::Fixed(Rect::new(0, 0, 80, 24));
            let backend = CrosstermBackend::new(screen);
            let mut terminal = Terminal::with_options(backend, TerminalOptions { viewport }).unwrap();
            let mut monitor = Monitor::new("a board", None, 4.0);
            let _ = watch(&mut terminal, &worker, &mut monitor, &keys, &stopped);
        });
        let bench = Bench { state, presses, terminal, stop, over, threads: vec![served, watched] };
        bench.within(60.0, "it displays", || bench.state() == State::Display);
        bench.terminal.stalled.store(true, Ordering::Relaxed);
        bench.within(5.0, "the picture waits", || bench.terminal.waits.load(Ordering::Relaxed));
        bench
    }

    fn state(&self) -> State {
        *self.state.lock().unwrap()
    }

    /// Seconds until `wanted` holds.
    fn within(&self, most_s: f64, what: &str, wanted: impl Fn() -> bool) -> f64 {
        let began = Instant::now();
        while !wanted() {
            assert!(began.elapsed().as_secs_f64() < most_s, "not within {most_s} s: {what}");
            std::thread::sleep(Duration::from_millis(2));
        }
        began.elapsed().as_secs_f64()
    }

    fn press(&self, key: KeyCode) {
        self.presses.send(Ok(Event::Key(KeyEvent::new(key, KeyModifiers::NONE)))).unwrap();
    }
}

impl Drop for Bench {
    fn drop(&mut self) {
        self.terminal.stalled.store(false, Ordering::Relaxed);
        self.stop.store(true, Ordering::Relaxed);
        // The monitor first: it switches off before it ends.
        for thread in self.threads.drain(..).rev() {
            let _ = thread.join();
            self.over.store(true, Ordering::Relaxed);
        }
    }
}

#[test]
fn off_and_end_do_not_wait_for_a_terminal_that_takes_no_more() {
    for key in [KeyCode::Char(' '), KeyCode::Esc] {
        let bench = Bench::stalled();
        bench.press(key);
        // One turn of the worker (20 ms), the request, and one tick of the board; far below the second after which the picture counts
        // as standing still.
        bench.within(0.3, "outputs off by a key", || bench.state() == State::Idle);
    }
}

#[test]
fn a_mode_asked_for_before_off_stays_off() {
    let bench = Bench::stalled();
    for key in ['a', 'd', ' '] {
        bench.press(KeyCode::Char(key));
    }
    bench.within(0.3, "outputs off by a key", || bench.state() == State::Idle);
    // The picture goes on, and with it the keys from before.
    bench.terminal.stalled.store(false, Ordering::Relaxed);
    let until = Instant::now() + Duration::from_millis(500);
    while Instant::now() < until {
        assert_eq!(bench.state(), State::Idle);
        std::thread::sleep(Duration::from_millis(2));
    }
}

#[test]
fn a_picture_that_stands_still_switches_the_outputs_off() {
    let bench = Bench::stalled();
    // A second of standing still, and what the key above needs.
    let after_s = bench.within(2.0, "outputs off by themselves", || bench.state() == State::Idle);
    // Updates were last taken at most one picture before the terminal was seen to wait.
    assert!(after_s > 0.8, "{after_s} s");
}
