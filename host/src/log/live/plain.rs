//! Lines for pipes and log files.

use super::{CurveNews, LiveView, estimate_text, verdict_text};
use crate::session::{Event, Traffic, fault_text, gap_text};
use protocol::TICK_HZ;

/// One line a second of board time, and one for each verdict and fault.
#[derive(Debug, Default)]
pub struct Plain {
    library: Vec<String>,
    next_tick: u32,
    curve: CurveNews,
}

impl Plain {
    /// A view that names materials as in `library`.
    pub fn new(library: Vec<String>) -> Self {
        Plain { library, ..Plain::default() }
    }
}

impl LiveView for Plain {
    fn event(&mut self, event: &Event, traffic: &Traffic) {
        match event {
            Event::Telemetry(t) => {
                if t.tick < self.next_tick && self.next_tick - t.tick <= TICK_HZ {
                    return;
                }
                self.next_tick = t.tick + TICK_HZ;
                errln!(
                    "{:8.2} s  {:<8} probe {:7.3} mm  depth {:6.3} mm  load cell {:7.4} N  shaft {:6.3} mm  \
                     coil {:5.3} A  tick {} us  lost {} of {}{}",
                    f64::from(t.tick) / f64::from(TICK_HZ),
                    format!("{:?}", t.state).to_lowercase(),
                    t.probe_mm,
                    t.depth_mm,
                    t.load_cell_n,
                    t.shaft_mm,
                    t.coil_a,
                    t.tick_us,
                    traffic.frames_lost,
                    traffic.frames_received + traffic.frames_lost,
                    t.shown.words().map(|word| format!("  {word}")).collect::<String>(),
                );
            }
            Event::Halves(h) => {
                if let Some(text) = self.curve.of(h, &self.library) {
                    errln!("{text}");
                }
            }
            Event::Estimate(e) => errln!("{}", estimate_text(e)),
            Event::Verdict(v) => errln!("{}", verdict_text(v, &self.library)),
            Event::Fault(f) => errln!("{}", fault_text(f)),
            Event::Gap(g) => {
                self.next_tick = 0;
                errln!("{}", gap_text(g));
            }
        }
    }

    fn note(&mut self, text: &str) {
        errln!("{text}");
    }

    fn refresh(&mut self) -> bool {
        false
    }
}
