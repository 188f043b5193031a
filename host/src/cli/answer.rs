//! What a command on a board says, and what it asks.

use std::io::{BufRead, IsTerminal};

/// An answer for programs and for people.
pub(super) type Answer = (serde_json::Value, String);

/// There is somebody to ask.
pub(super) fn can_ask() -> bool {
    std::io::stdin().is_terminal() && std::io::stderr().is_terminal()
}

/// Asks in the terminal; anything but a yes is a no, and so is nobody to ask.
pub(super) fn agreed(question: &str) -> bool {
    if !can_ask() {
        return false;
    }
    errln!("{question} [y/N]");
    let mut answer = String::new();
    std::io::stdin().read_line(&mut answer).is_ok() && matches!(answer.trim(), "y" | "Y" | "yes")
}

/// Waits for Enter; false for a line of "q", and where nothing is to be read any more.
pub(super) fn entered() -> bool {
    let mut line = String::new();
    let read = std::io::stdin().lock().read_line(&mut line);
    read.is_ok_and(|bytes| bytes > 0) && line.trim() != "q"
}

/// Prints a table, its columns as wide as they must be.
pub(super) fn columns(head: &[&str], rows: &[Vec<String>]) {
    let wide = |at: usize| rows.iter().map(|row| row[at].len()).chain([head[at].len()]).max().unwrap_or(0);
    let line = |cells: &[String]| {
        let cells: Vec<String> = cells.iter().enumerate().map(|(at, cell)| format!("{cell:<0$}", wide(at))).collect();
        cells.join("  ").trim_end().to_owned()
    };
    outln!("{}", line(&head.iter().map(|word| (*word).to_owned()).collect::<Vec<_>>()));
    rows.iter().for_each(|row| outln!("{}", line(row)));
}
