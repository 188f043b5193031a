//! A board over TCP.

use std::io::{ErrorKind, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::time::{Duration, Instant};

use super::{Link, LinkError, read_once};

/// Longest wait for the connection.
const CONNECT: Duration = Duration::from_secs(3);

/// A TCP connection, time by the wall clock.
#[derive(Debug)]
pub struct Tcp {
    name: String,
    stream: TcpStream,
    opened: Instant,
}

impl Tcp {
    /// Connects to `place`, `HOST:PORT`.
    ///
    /// # Errors
    /// [`LinkError::Open`] when nothing answers there within 3 s.
    pub fn open(place: &str) -> Result<Self, LinkError> {
        let name = format!("tcp:{place}");
        let failed = |source| LinkError::Open { link: name.clone(), source };
        let mut last = std::io::Error::new(ErrorKind::NotFound, "the name has no address");
        for address in place.to_socket_addrs().map_err(failed)? {
            match TcpStream::connect_timeout(&address, CONNECT) {
                Ok(stream) => {
                    // A request waits for its answer: small frames must leave at once.
                    stream.set_nodelay(true).map_err(failed)?;
                    return Ok(Tcp { name, stream, opened: Instant::now() });
                }
                Err(error) => last = error,
            }
        }
        Err(failed(last))
    }
}

impl Link for Tcp {
    fn name(&self) -> &str {
        &self.name
    }

    fn now_s(&self) -> f64 {
        self.opened.elapsed().as_secs_f64()
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.stream.write_all(bytes).map_err(|e| LinkError::of(&self.name, e))
    }

    fn receive(&mut self, into: &mut Vec<u8>, deadline_s: f64) -> Result<(), LinkError> {
        // A zero timeout would mean "for ever"; a millisecond still takes what is already there.
        let wait = Duration::from_secs_f64((deadline_s - self.now_s()).clamp(1e-3, 3600.0));
        self.stream.set_read_timeout(Some(wait)).map_err(|e| LinkError::of(&self.name, e))?;
        read_once(&mut self.stream, &self.name, into)
    }
}
