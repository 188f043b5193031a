//! The line between a log and its board: it may stay open while the board restarts, or be pulled.

use std::io::{ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU16, Ordering};
use std::thread;
use std::time::Duration;

/// Passes bytes on between one host and the board that listens at a port of this machine.
pub struct Line {
    /// Where hosts connect.
    pub port: u16,
    board: Arc<AtomicU16>,
    pulled: Arc<AtomicBool>,
    done: Arc<AtomicBool>,
}

/// Between two looks at either side.
const TURN: Duration = Duration::from_millis(2);

impl Line {
    /// A line to the board at `port`.
    pub fn to(port: u16) -> std::io::Result<Self> {
        let listener = TcpListener::bind("127.0.0.1:0")?;
        listener.set_nonblocking(true)?;
        let line = Line {
            port: listener.local_addr()?.port(),
            board: Arc::new(AtomicU16::new(port)),
            pulled: Arc::default(),
            done: Arc::default(),
        };
        let (board, pulled, done) = (line.board.clone(), line.pulled.clone(), line.done.clone());
        thread::spawn(move || {
            while !done.load(Ordering::Relaxed) {
                match listener.accept() {
                    Ok((host, _)) if !pulled.load(Ordering::Relaxed) => {
                        let _ = pass(&host, &board, &|| pulled.load(Ordering::Relaxed) || done.load(Ordering::Relaxed));
                    }
                    // A pulled cable has nobody at its end: the connection ends at once.
                    _ => thread::sleep(TURN),
                }
            }
        });
        Ok(line)
    }

    /// Pulls the cable out, or puts it back.
    pub fn pull(&self, out: bool) {
        self.pulled.store(out, Ordering::Relaxed);
    }
}

impl Drop for Line {
    fn drop(&mut self) {
        self.done.store(true, Ordering::Relaxed);
    }
}

/// Passes bytes on until the host leaves or the line ends; the board is connected to again and again.
fn pass(mut host: &TcpStream, board: &AtomicU16, ended: &dyn Fn() -> bool) -> std::io::Result<()> {
    host.set_nonblocking(true)?;
    host.set_nodelay(true)?;
    let mut other: Option<TcpStream> = None;
    let mut buffer = [0; 4096];
    while !ended() {
        if other.is_none()
            && let Ok(stream) = TcpStream::connect(("127.0.0.1", board.load(Ordering::Relaxed)))
        {
            stream.set_nonblocking(true)?;
            stream.set_nodelay(true)?;
            other = Some(stream);
        }
        match host.read(&mut buffer) {
            Ok(0) => return Ok(()),
            Ok(n) => {
                if let Some(stream) = &mut other
                    && stream.write_all(&buffer[..n]).is_err()
                {
                    other = None;
                }
            }
            Err(error) if error.kind() == ErrorKind::WouldBlock => {}
            Err(error) => return Err(error),
        }
        match other.as_mut().map(|stream| stream.read(&mut buffer)) {
            Some(Ok(n)) if n > 0 => host.write_all(&buffer[..n])?,
            Some(Err(error)) if error.kind() == ErrorKind::WouldBlock => {}
            None => {}
            _ => other = None,
        }
        thread::sleep(TURN);
    }
    Ok(())
}
