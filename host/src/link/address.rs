//! `--board sim | auto | tcp:HOST:PORT | serial:PATH`.

use std::fmt;
use std::str::FromStr;

/// Where a board is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Address {
    /// Simulated, in this process.
    Simulated,
    /// The one board that is plugged in, found by its USB numbers.
    Auto,
    /// Host and port.
    Tcp(String),
    /// Device path of a serial port.
    Serial(String),
}

/// Text that is not an [`Address`].
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("board `{found}`: expected sim, auto, tcp:HOST:PORT or serial:PATH")]
pub struct BadAddress {
    /// The text.
    pub found: String,
}

impl FromStr for Address {
    type Err = BadAddress;

    fn from_str(text: &str) -> Result<Self, BadAddress> {
        let bad = || BadAddress { found: text.into() };
        match text.split_once(':') {
            None if text == "sim" => Ok(Address::Simulated),
            None if text == "auto" => Ok(Address::Auto),
            Some(("tcp", place)) => match place.rsplit_once(':') {
                Some((host, port)) if !host.is_empty() && port.parse::<u16>().is_ok() => Ok(Address::Tcp(place.into())),
                _ => Err(bad()),
            },
            Some(("serial", path)) if !path.is_empty() => Ok(Address::Serial(path.into())),
            _ => Err(bad()),
        }
    }
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Address::Simulated => f.write_str("sim"),
            Address::Auto => f.write_str("auto"),
            Address::Tcp(place) => write!(f, "tcp:{place}"),
            Address::Serial(path) => write!(f, "serial:{path}"),
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn addresses_read_back_as_written() {
        for text in ["sim", "auto", "tcp:127.0.0.1:4750", "tcp:[::1]:1", "serial:/dev/ttyACM0", "serial:COM3"] {
            assert_eq!(text.parse::<Address>().unwrap().to_string(), text);
        }
    }

    #[test]
    fn other_texts_are_named_with_what_was_expected() {
        for text in ["", "usb", "tcp:", "tcp:host", "tcp:host:port", "tcp::80", "serial:", "sim:1", "auto:1"] {
            let error = text.parse::<Address>().unwrap_err();
            assert_eq!(error.to_string(), format!("board `{text}`: expected sim, auto, tcp:HOST:PORT or serial:PATH"));
        }
    }
}
