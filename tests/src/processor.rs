//! Time on the processor, which other jobs on the machine disturb less than the clock on the wall.

use std::time::Instant;

/// Measures from its start.
#[derive(Debug, Clone, Copy)]
pub struct Clock {
    read: fn() -> Option<f64>,
    cpu_s: Option<f64>,
    wall: Instant,
}

impl Clock {
    /// Of this thread.
    #[must_use]
    pub fn of_thread() -> Self {
        Self::of(thread_s)
    }

    /// Of all threads of this process together.
    #[must_use]
    pub fn of_process() -> Self {
        Self::of(process_s)
    }

    fn of(read: fn() -> Option<f64>) -> Self {
        Clock { read, cpu_s: read(), wall: Instant::now() }
    }

    /// Time on the processor since the start, s; wall time where the system does not count it (it is counted on Linux).
    #[must_use]
    pub fn cpu_s(&self) -> f64 {
        match (self.cpu_s, (self.read)()) {
            (Some(from), Some(to)) => to - from,
            _ => self.wall_s(),
        }
    }

    /// Time on the wall since the start, s.
    #[must_use]
    pub fn wall_s(&self) -> f64 {
        self.wall.elapsed().as_secs_f64()
    }
}

fn thread_s() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    Some(1e-9 * text.split_whitespace().next()?.parse::<f64>().ok()?)
}

/// User and system time in hundredths of a second: `USER_HZ` is 100 on every Linux (proc(5), times(2)). They follow the name of the program, which is in brackets and may hold blanks.
fn process_s() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/stat").ok()?;
    let fields: Vec<&str> = text.rsplit(')').next()?.split_whitespace().collect();
    let ticks = |at: usize| fields.get(at)?.parse::<f64>().ok();
    Some(0.01 * (ticks(11)? + ticks(12)?))
}

#[cfg(test)]
mod tests {
    use super::Clock;

    #[test]
    fn a_thread_that_sleeps_takes_no_time_of_the_processor() {
        let clock = Clock::of_thread();
        std::thread::sleep(std::time::Duration::from_millis(50));
        assert!(clock.wall_s() >= 0.05);
        // Elsewhere wall time stands in.
        assert!(clock.cpu_s() < 0.04 || !cfg!(target_os = "linux"), "{}", clock.cpu_s());
    }

    #[test]
    fn a_process_that_works_takes_time() {
        let clock = Clock::of_process();
        let mut x = 1.0_f64;
        while clock.wall_s() < 0.1 {
            x = (x + 1.0).sqrt();
        }
        // At least one tick of a tenth of a second, whatever else runs.
        assert!(x > 0.0 && clock.cpu_s() > 0.0, "{}", clock.cpu_s());
    }
}
