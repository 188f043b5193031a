//! Requests to end that come as signals.

use std::io;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
#[cfg(unix)]
use std::{
    sync::atomic::Ordering,
    time::{Duration, Instant},
};

/// Signals that come sooner than this after the first one say the same thing: a closed window gives one from the kernel and
/// one from the shell, `timeout` one to the process and one to its group, and systemd two kinds at once.
#[cfg(unix)]
const SAME_REQUEST: Duration = Duration::from_secs(1);

/// Sets `stop` on SIGTERM, SIGINT and SIGQUIT, and on SIGHUP (a terminal whose window was closed, a lost ssh) unless `nohup`
/// asked to outlive it. One that is repeated after a second ends the process at once, in case the first one waits for a disk.
///
/// # Errors
/// Those of the system.
pub(crate) fn stop_on_signals(stop: &Arc<AtomicBool>) -> io::Result<()> {
    let mut signals = signal_hook::consts::TERM_SIGNALS.to_vec();
    #[cfg(unix)]
    if !is_ignored(signal_hook::consts::SIGHUP) {
        signals.push(signal_hook::consts::SIGHUP);
    }
    for signal in &signals {
        signal_hook::flag::register(*signal, Arc::clone(stop))?;
    }
    end_if_repeated(signals, Arc::clone(stop))
}

/// Ends the process when a signal is repeated.
#[cfg(unix)]
fn end_if_repeated(signals: Vec<i32>, stop: Arc<AtomicBool>) -> io::Result<()> {
    let mut signals = signal_hook::iterator::Signals::new(signals)?;
    let wait = move || {
        let mut first = None;
        for signal in signals.forever() {
            stop.store(true, Ordering::Relaxed);
            if is_repeated(*first.get_or_insert_with(Instant::now), Instant::now()) {
                signal_hook::low_level::exit(128 + signal);
            }
        }
    };
    std::thread::Builder::new().name("signals".into()).spawn(wait)?;
    Ok(())
}

/// Elsewhere a second signal ends it at once.
#[cfg(not(unix))]
fn end_if_repeated(signals: Vec<i32>, stop: Arc<AtomicBool>) -> io::Result<()> {
    for signal in signals {
        signal_hook::flag::register_conditional_shutdown(signal, 128 + signal, Arc::clone(&stop))?;
    }
    Ok(())
}

/// A signal at `now` is a request of its own beside the one at `first`.
#[cfg(unix)]
fn is_repeated(first: Instant, now: Instant) -> bool {
    now.duration_since(first) >= SAME_REQUEST
}

/// Makes a file that outgrows the shell's limit (`ulimit -f`) an error of its writer, which it can tell, instead of the
/// end of the process.
///
/// # Errors
/// Those of the system.
pub(crate) fn outlive_file_limits() -> io::Result<()> {
    #[cfg(unix)]
    signal_hook::flag::register(signal_hook::consts::SIGXFSZ, Arc::default())?;
    Ok(())
}

/// The process was started with `signal` ignored. Only Linux tells; elsewhere it counts as not ignored.
#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:")).map(str::trim);
    mask.and_then(|mask| u64::from_str_radix(mask, 16).ok()).is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
}
