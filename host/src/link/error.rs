//! What can go wrong below the frames.

use super::FindError;

/// The way to the board failed.
#[derive(Debug, thiserror::Error)]
pub enum LinkError {
    /// The link could not be opened.
    #[error("cannot open {link}: {source}{}", access(.source))]
    Open {
        /// The link's name.
        link: String,
        /// Why.
        source: std::io::Error,
    },
    /// There is not just one board to open.
    #[error(transparent)]
    Find(#[from] FindError),
    /// The other side closed the connection, or the cable is out.
    #[error("{link} closed the connection")]
    Closed {
        /// The link's name.
        link: String,
    },
    /// Reading or writing failed.
    #[error("{link}: {source}")]
    Broken {
        /// The link's name.
        link: String,
        /// Why.
        source: std::io::Error,
    },
}

/// What lets this user open a port.
fn access(source: &std::io::Error) -> &'static str {
    match source.kind() {
        std::io::ErrorKind::PermissionDenied => {
            "; on Linux install firmware/70-palpate.rules, or join the group `dialout`: \
             sudo usermod -aG dialout $USER, then log in anew"
        }
        _ => "",
    }
}

impl LinkError {
    /// Sorts an error of an open link: a vanished peer is not the same as a failing system.
    pub(super) fn of(link: &str, source: std::io::Error) -> Self {
        use std::io::ErrorKind as Kind;
        match source.kind() {
            Kind::BrokenPipe
            | Kind::ConnectionReset
            | Kind::ConnectionAborted
            | Kind::UnexpectedEof
            | Kind::NotConnected => LinkError::Closed { link: link.into() },
            _ => LinkError::Broken { link: link.into(), source },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::ErrorKind;

    #[test]
    fn a_port_that_may_not_be_opened_says_what_lets_it() {
        let text =
            |kind: ErrorKind| LinkError::Open { link: "serial:/dev/ttyACM0".into(), source: kind.into() }.to_string();
        let denied = text(ErrorKind::PermissionDenied);
        assert!(denied.contains("dialout") && denied.contains("firmware/70-palpate.rules"), "{denied}");
        assert!(!text(ErrorKind::NotFound).contains("dialout"));
    }
}
