//! A board on a serial port.

use std::io::Write;
use std::time::{Duration, Instant};

use super::{Link, LinkError, read_once};

/// Rate of the board's UART, baud. USB CDC-ACM ignores it.
pub const BAUD: u32 = 115_200;

/// A serial port, time by the wall clock.
pub struct Serial {
    name: String,
    port: Box<dyn serialport::SerialPort>,
    opened: Instant,
}

impl Serial {
    /// Opens the port at `path` with 8 data bits, no parity, 1 stop bit.
    ///
    /// # Errors
    /// [`LinkError::Open`] when there is no such port, or it is in use.
    pub fn open(path: &str) -> Result<Self, LinkError> {
        let name = format!("serial:{path}");
        let port = serialport::new(path, BAUD)
            .timeout(Duration::from_millis(10))
            .open()
            .map_err(|error| LinkError::Open { link: name.clone(), source: error.into() })?;
        Ok(Serial { name, port, opened: Instant::now() })
    }
}

impl Link for Serial {
    fn name(&self) -> &str {
        &self.name
    }

    fn now_s(&self) -> f64 {
        self.opened.elapsed().as_secs_f64()
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        let failed = |e| LinkError::of(&self.name, e);
        // The port's timeout holds for writing as well: a frame at 115200 baud takes up to 22 ms.
        self.port.set_timeout(Duration::from_secs(1)).map_err(|e| failed(e.into()))?;
        self.port.write_all(bytes).map_err(failed)
    }

    fn receive(&mut self, into: &mut Vec<u8>, deadline_s: f64) -> Result<(), LinkError> {
        let wait = Duration::from_secs_f64((deadline_s - self.now_s()).clamp(1e-3, 3600.0));
        self.port.set_timeout(wait).map_err(|e| LinkError::of(&self.name, e.into()))?;
        read_once(&mut self.port, &self.name, into)
    }
}
