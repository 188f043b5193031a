//! The terminal: keys in, pictures out, and its return whatever happens.

use std::io::IsTerminal;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use ratatui::DefaultTerminal;
use ratatui::crossterm::event::{self, KeyCode, KeyEventKind, KeyModifiers};

use super::{Key, Library, Monitor, Opener, Palette, Settings, Worker, draw};

/// Between two pictures: that of the telemetry.
const FRAME: Duration = Duration::from_millis(20);

/// The dashboard cannot be shown.
#[derive(Debug, thiserror::Error)]
pub enum MonitorError {
    /// Standard output or input is a file or a pipe.
    #[error(
        "{0} is not a terminal, and the monitor draws on one and reads its keys: `palpate log` writes lines, CSV and MCAP instead"
    )]
    NoTerminal(&'static str),
    /// The terminal refused.
    #[error("terminal: {0}")]
    Terminal(#[from] std::io::Error),
    /// The thread that talks to the board has ended by itself.
    #[error("the conversation with the board has ended; please report what was printed above")]
    Ended,
}

/// Standard output and input are a terminal.
///
/// # Errors
/// [`MonitorError::NoTerminal`] names the one that is not.
pub fn check_terminal() -> Result<(), MonitorError> {
    for (name, is_terminal) in
        [("standard output", std::io::stdout().is_terminal()), ("standard input", std::io::stdin().is_terminal())]
    {
        if !is_terminal {
            return Err(MonitorError::NoTerminal(name));
        }
    }
    Ok(())
}

/// Shows the board called `board`, reached by `opener`, until a key or a signal ends it. Palpations go `depth_mm` deep.
///
/// # Errors
/// [`MonitorError`].
pub fn run(
    board: &str,
    opener: Opener,
    library: Option<Library>,
    settings: Settings,
    depth_mm: f32,
) -> Result<(), MonitorError> {
    check_terminal()?;
    let stop = Arc::clone(&settings.stop);
    crate::signals::stop_on_signals(&stop)?;
    crate::signals::outlive_file_limits()?;
    // Gives the terminal back before a panic is printed, too.
    let mut terminal = ratatui::try_init()?;
    let worker = Worker::start(opener, settings);
    let mut monitor = Monitor::new(board, library, depth_mm);
    let ended = watch(&mut terminal, &worker, &mut monitor, &stop);
    let restored = ratatui::try_restore();
    // Waits until the outputs are off, also where the terminal is gone.
    drop(worker);
    ended?;
    Ok(restored?)
}

fn watch(
    terminal: &mut DefaultTerminal,
    worker: &Worker,
    monitor: &mut Monitor,
    stop: &AtomicBool,
) -> Result<(), MonitorError> {
    let palette = Palette::of_environment();
    let keys = keys();
    let mut drawn: Option<Instant> = None;
    loop {
        match worker.update(FRAME) {
            Ok(Some(update)) => monitor.update(update),
            Ok(None) => {}
            // The worker sees the signal by itself, and may do so first.
            Err(_) if stop.load(Ordering::Relaxed) => return Ok(()),
            Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => return Err(MonitorError::Ended),
        }
        for key in keys.try_iter() {
            for command in monitor.key(key?) {
                worker.command(command);
            }
        }
        if monitor.is_done() || stop.load(Ordering::Relaxed) {
            return Ok(());
        }
        if drawn.is_none_or(|drawn| drawn.elapsed() >= FRAME) {
            drawn = Some(Instant::now());
            terminal.draw(|frame| draw(frame, monitor, palette))?;
        }
    }
}

/// The keys, read in a thread of its own. A closed window has no end for its reader: crossterm 0.29 reads the terminal that is gone again and again and never returns, and who waits
/// for it never switches the outputs off.
fn keys() -> Receiver<std::io::Result<Key>> {
    let (pressed, keys) = channel();
    std::thread::spawn(move || {
        loop {
            let event = event::read();
            let failed = event.is_err();
            let Some(key) = event.map(|event| key_of(&event)).transpose() else { continue };
            if pressed.send(key).is_err() || failed {
                return;
            }
        }
    });
    keys
}

fn key_of(event: &event::Event) -> Option<Key> {
    let event::Event::Key(key) = event else {
        return None;
    };
    if key.kind == KeyEventKind::Release {
        return None;
    }
    match key.code {
        KeyCode::Char('c') if key.modifiers.contains(KeyModifiers::CONTROL) => Some(Key::Interrupt),
        // Other chords mean nothing; Shift is in the character already.
        KeyCode::Char(_) if key.modifiers.intersects(KeyModifiers::CONTROL | KeyModifiers::ALT) => None,
        KeyCode::Char(letter) => Some(Key::Char(letter)),
        KeyCode::Up => Some(Key::Up),
        KeyCode::Down => Some(Key::Down),
        KeyCode::Esc => Some(Key::Escape),
        _ => None,
    }
}
