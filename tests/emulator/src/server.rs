//! The emulated board's UART over TCP, in real time.

use std::io::{ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream, ToSocketAddrs};
use std::time::{Duration, Instant};

use crate::board::{EmulatedBoard, EmulatorError};

/// How often bytes are passed on.
const TURN: Duration = Duration::from_millis(2);

/// Serving failed.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// The address cannot be listened at.
    #[error("cannot listen at {place}: {source}")]
    Listen {
        /// The address.
        place: String,
        /// Why.
        source: std::io::Error,
    },
    /// The board cannot go on.
    #[error(transparent)]
    Board(#[from] EmulatorError),
}

/// A listening board.
pub struct Server {
    listener: TcpListener,
    address: SocketAddr,
    board: EmulatedBoard,
}

impl Server {
    /// Listens at `place` (`HOST:PORT`, port 0 for a free one).
    ///
    /// # Errors
    /// [`ServeError::Listen`].
    pub fn listen(place: &str, board: EmulatedBoard) -> Result<Self, ServeError> {
        let failed = |source| ServeError::Listen { place: place.into(), source };
        let mut places = place.to_socket_addrs().map_err(failed)?;
        let first = places.next().ok_or_else(|| failed(ErrorKind::NotFound.into()))?;
        let listener = TcpListener::bind(first).map_err(failed)?;
        listener.set_nonblocking(true).map_err(failed)?;
        let address = listener.local_addr().map_err(failed)?;
        Ok(Server { listener, address, board })
    }

    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Runs the board as fast as the wall clock until `go_on` says no. One host at a time; the board goes on without one.
    ///
    /// # Errors
    /// [`ServeError::Board`].
    pub fn run(mut self, mut go_on: impl FnMut() -> bool) -> Result<(), ServeError> {
        let mut host: Option<TcpStream> = None;
        let mut last = Instant::now();
        while go_on() {
            if host.is_none() {
                host = self.accept();
                // What was sent to nobody is lost, as on a line without a listener.
                self.board.take_transmit();
            }
            if host.as_mut().is_some_and(|stream| !take(stream, &mut self.board)) {
                host = None;
            }
            std::thread::sleep(TURN);
            // A host that slept is not caught up with.
            let passed = last.elapsed().min(Duration::from_secs(1));
            last = Instant::now();
            self.board.run_s(passed.as_secs_f64())?;
            let bytes = self.board.take_transmit();
            if host.as_mut().is_some_and(|stream| !give(stream, &bytes)) {
                host = None;
            }
        }
        Ok(())
    }

    fn accept(&self) -> Option<TcpStream> {
        let (stream, _) = self.listener.accept().ok()?;
        (stream.set_nonblocking(true).is_ok() && stream.set_nodelay(true).is_ok()).then_some(stream)
    }
}

/// Passes on what the host has sent; false when it is gone.
fn take(stream: &mut TcpStream, board: &mut EmulatedBoard) -> bool {
    let mut buffer = [0; 4096];
    match stream.read(&mut buffer) {
        Ok(0) => false,
        Ok(count) => {
            board.receive(&buffer[..count]);
            true
        }
        Err(e) => matches!(e.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted),
    }
}

/// Passes on what the board has sent; false when the host is gone or does not read.
fn give(stream: &mut TcpStream, bytes: &[u8]) -> bool {
    stream.write_all(bytes).is_ok()
}
