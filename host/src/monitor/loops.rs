//! The terminal: keys in, pictures out, and its return whatever happens.

use std::io::{IsTerminal, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use ratatui::Terminal;
use ratatui::backend::CrosstermBackend;
use ratatui::crossterm::event::{self, Event, KeyCode, KeyEventKind, KeyModifiers};

use super::{Key, Library, Monitor, OffSwitch, Opener, Palette, Settings, Worker, draw};

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
    let keys = keys(event::read, worker.off_switch(), Arc::clone(&stop));
    let ended = watch(&mut terminal, &worker, &mut monitor, &keys, &stop);
    let restored = ratatui::try_restore();
    // Waits until the outputs are off, also where the terminal is gone.
    drop(worker);
    ended?;
    Ok(restored?)
}

/// Draws and takes keys until one of them, or `stop`, ends it.
pub(super) fn watch<W: Write>(
    terminal: &mut Terminal<CrosstermBackend<W>>,
    worker: &Worker,
    monitor: &mut Monitor,
    keys: &Receiver<Pressed>,
    stop: &AtomicBool,
) -> Result<(), MonitorError> {
    let palette = Palette::of_environment();
    let mut drawn: Option<Instant> = None;
    loop {
        let mut wait = FRAME;
        // All of them before any key: what was switched off meanwhile has disarmed the keys.
        loop {
            match worker.update(std::mem::take(&mut wait)) {
                Ok(Some(update)) => monitor.update(update),
                Ok(None) => break,
                // The worker sees the signal by itself, and may do so first.
                Err(_) if stop.load(Ordering::Relaxed) => return Ok(()),
                Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => return Err(MonitorError::Ended),
            }
        }
        for pressed in keys.try_iter() {
            let (presses, key) = pressed?;
            for command in monitor.key(key) {
                worker.command_after(presses, command);
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

/// A key, and how often outputs had been switched off before it.
pub(super) type Pressed = std::io::Result<(u32, Key)>;

/// The keys, read in a thread of its own. Those that switch off press `off` there, and those that end the monitor set `stop`: the
/// picture may wait for its terminal for ever. A closed window has no end for its reader: crossterm 0.29 reads the terminal that is gone
/// again and again and never returns, and who waits for it never switches the outputs off.
pub(super) fn keys(
    mut read: impl FnMut() -> std::io::Result<Event> + Send + 'static,
    off: OffSwitch,
    stop: Arc<AtomicBool>,
) -> Receiver<Pressed> {
    let (pressed, keys) = channel();
    std::thread::spawn(move || {
        loop {
            let event = read();
            let failed = event.is_err();
            let Some(key) = event.map(|event| key_of(&event)).transpose() else { continue };
            let before = off.presses();
            if key.as_ref().is_ok_and(|key| key.is_off()) {
                off.press();
            }
            if key.as_ref().is_ok_and(|key| key.is_end()) {
                stop.store(true, Ordering::Relaxed);
            }
            if pressed.send(key.map(|key| (before, key))).is_err() || failed {
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
