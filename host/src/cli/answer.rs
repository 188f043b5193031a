//! What a command on a board says, and what it asks.

use std::io::IsTerminal;

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
