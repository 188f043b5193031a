//! What can go wrong below the frames.

/// The way to the board failed.
#[derive(Debug, thiserror::Error)]
pub enum LinkError {
    /// The link could not be opened.
    #[error("cannot open {link}: {source}")]
    Open {
        /// The link's name.
        link: String,
        /// Why.
        source: std::io::Error,
    },
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
