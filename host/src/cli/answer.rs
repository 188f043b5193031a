//! What a command on a board says.

/// An answer for programs and for people.
pub(super) type Answer = (serde_json::Value, String);
