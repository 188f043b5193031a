//! Outputs off when nothing else works.

use defmt_rtt as _;

pub use super::interlock::outputs_off;

defmt::timestamp!("{=u64:us}", embassy_time::Instant::now().as_micros());
