//! Progress bars on standard error.

use std::io::IsTerminal;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A bar a task, drawn only where somebody watches: on a terminal.
#[derive(Debug)]
pub struct Progress {
    bar: Mutex<Option<(String, ProgressBar)>>,
}

impl Default for Progress {
    fn default() -> Self {
        Self::new()
    }
}

impl Progress {
    /// No task yet.
    pub fn new() -> Self {
        Self { bar: Mutex::new(None) }
    }

    /// Takes away what is drawn.
    pub fn end(&self) {
        if let Some((_, bar)) = self.bar.lock().ok().and_then(|mut bar| bar.take()) {
            bar.finish_and_clear();
        }
    }

    /// `done` of `total` solves of the task `what`; a new name starts a new bar. With a total of 0 nobody knows how many there
    /// will be, and they are only counted.
    pub fn set(&self, what: &str, done: usize, total: usize) {
        let Ok(mut bar) = self.bar.lock() else { return };
        let same = bar.as_ref().is_some_and(|(name, _)| name == what);
        if !same {
            *bar = Some((what.to_owned(), started(what, total)));
        }
        if let Some((_, bar)) = bar.as_ref() {
            bar.set_position(done as u64);
            if total > 0 && done >= total {
                bar.finish();
            }
        }
    }
}

fn started(what: &str, total: usize) -> ProgressBar {
    if total == 0 {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
        if let Ok(style) = ProgressStyle::with_template("{spinner} {msg:30} {pos:>3} solves, {elapsed}") {
            bar.set_style(style);
        }
        bar.set_message(what.to_owned());
        bar.enable_steady_tick(TICK);
        return bar;
    }
    let bar = ProgressBar::with_draw_target(Some(total as u64), ProgressDrawTarget::stderr());
    let template = "{msg:32} [{bar:30}] {pos:>3}/{len} solves, {eta} left";
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style.progress_chars("=> "));
    }
    bar.set_message(what.to_owned());
    bar
}

/// Between two turns of a spinner.
const TICK: Duration = Duration::from_millis(120);

/// Between two lines where nobody watches.
const QUIET: Duration = Duration::from_secs(10);

/// Progress of a long run with the time left: a bar on a terminal, elsewhere a line now and then.
#[derive(Debug)]
pub struct Countdown {
    bar: Option<ProgressBar>,
    start: Instant,
    told: Instant,
    done: usize,
    total: usize,
}

impl Countdown {
    /// A run of `total` points that begins now.
    pub fn new(what: &str, total: usize) -> Self {
        let bar = std::io::stderr().is_terminal().then(|| started(what, total));
        Self { bar, start: Instant::now(), told: Instant::now(), done: 0, total }
    }

    /// One more point is done; so many have failed so far.
    pub fn step(&mut self, failed: usize) {
        self.done += 1;
        if let Some(bar) = &self.bar {
            bar.set_position(self.done as u64);
        } else if self.told.elapsed() >= QUIET {
            self.told = Instant::now();
            errln!("{}", line(self.done, self.total, failed, self.start.elapsed()));
        }
    }

    /// Takes the bar away.
    pub fn end(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

fn line(done: usize, total: usize, failed: usize, elapsed: Duration) -> String {
    let left = elapsed.as_secs_f64() / done.max(1) as f64 * total.saturating_sub(done) as f64;
    let failures = if failed > 0 { format!(", {failed} failed") } else { String::new() };
    format!("{done} of {total} points solved{failures}; {} left", time(left))
}

/// A time in the largest unit of which it is at least two.
fn time(seconds: f64) -> String {
    match seconds {
        s if s < 120.0 => format!("{s:.0} s"),
        s if s < 7200.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_says_how_long_it_will_take() {
        assert_eq!(line(10, 40, 0, Duration::from_secs(20)), "10 of 40 points solved; 60 s left");
        assert_eq!(line(10, 740, 2, Duration::from_secs(60)), "10 of 740 points solved, 2 failed; 73 min left");
        assert_eq!(line(1, 1001, 0, Duration::from_secs(36)), "1 of 1001 points solved; 10.0 h left");
    }
}
