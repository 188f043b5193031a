//! The simulated board over TCP, in real time.

use std::io::{ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream, ToSocketAddrs};
use std::time::{Duration, Instant};

use protocol::TICK_HZ;

use super::SimulatedBoard;

/// A listening simulated board.
#[derive(Debug)]
pub struct Server {
    listener: TcpListener,
    board: SimulatedBoard,
}

/// Listens at `place` (`HOST:PORT`, port 0 for a free one) for hosts that want to talk to `board`.
///
/// # Errors
/// When the address cannot be used.
pub fn serve(place: impl ToSocketAddrs, board: SimulatedBoard) -> std::io::Result<Server> {
    let listener = TcpListener::bind(place)?;
    listener.set_nonblocking(true)?;
    Ok(Server { listener, board })
}

impl Server {
    /// Where it listens.
    ///
    /// # Errors
    /// Those of the system.
    pub fn address(&self) -> std::io::Result<SocketAddr> {
        self.listener.local_addr()
    }

    /// Runs the board in real time until `go_on` says no; it is asked every tick. One host at a time; the board goes on
    /// without one. `between_ticks` may change the bench.
    pub fn run(mut self, mut between_ticks: impl FnMut(&mut SimulatedBoard), mut go_on: impl FnMut() -> bool) {
        let period = Duration::from_secs(1) / TICK_HZ;
        let mut next = Instant::now() + period;
        let mut host: Option<TcpStream> = None;
        let mut out = Vec::new();
        while go_on() {
            if host.is_none()
                && let Ok((stream, _)) = self.listener.accept()
                && stream.set_nonblocking(false).is_ok()
                && stream.set_nodelay(true).is_ok()
            {
                out.clear();
                host = Some(stream);
            }
            // Requests are answered between ticks too, so an upload is not slowed to one piece a tick.
            while Instant::now() < next {
                if !self.talk(&mut host, &mut out, next) {
                    std::thread::sleep(next.saturating_duration_since(Instant::now()));
                }
            }
            self.board.step();
            between_ticks(&mut self.board);
            self.board.transmit(&mut out);
            if let Some(stream) = &mut host
                && !out.is_empty()
                && stream.write_all(&out).is_err()
            {
                host = None;
            }
            out.clear();
            next += period;
            // A host that slept (a suspended laptop) is not caught up with.
            if Instant::now() > next + Duration::from_secs(1) {
                next = Instant::now() + period;
            }
        }
    }

    /// Waits for bytes of the host until `next`; false without a host.
    fn talk(&mut self, host: &mut Option<TcpStream>, out: &mut Vec<u8>, next: Instant) -> bool {
        let Some(stream) = host else {
            return false;
        };
        let wait = next.saturating_duration_since(Instant::now()).max(Duration::from_micros(100));
        let mut buffer = [0u8; 4096];
        let gone = match stream.set_read_timeout(Some(wait)).and_then(|()| stream.read(&mut buffer)) {
            Ok(0) => true,
            Ok(n) => {
                self.board.receive(&buffer[..n]);
                self.board.transmit(out);
                let sent = stream.write_all(out);
                out.clear();
                sent.is_err()
            }
            Err(e) => !matches!(e.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted),
        };
        if gone {
            *host = None;
        }
        true
    }
}
