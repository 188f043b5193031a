//! Progress bars on standard error.

use std::sync::Mutex;

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

    /// `done` of `total` solves of the task `what`; a new name starts a new bar.
    pub fn set(&self, what: &str, done: usize, total: usize) {
        let Ok(mut bar) = self.bar.lock() else { return };
        let same = bar.as_ref().is_some_and(|(name, _)| name == what);
        if !same {
            *bar = Some((what.to_owned(), started(what, total)));
        }
        if let Some((_, bar)) = bar.as_ref() {
            bar.set_position(done as u64);
            if done >= total {
                bar.finish();
            }
        }
    }
}

fn started(what: &str, total: usize) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(total as u64), ProgressDrawTarget::stderr());
    let template = "{msg:32} [{bar:30}] {pos:>3}/{len} solves, {eta} left";
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style.progress_chars("=> "));
    }
    bar.set_message(what.to_owned());
    bar
}
