//! Why the board started.

use embassy_stm32::pac;
use protocol::message::ResetCause;

/// Reads and clears the reset flags. The pin flag is set by every reset, so it comes last.
pub fn cause() -> ResetCause {
    let flags = pac::RCC.csr().read();
    pac::RCC.csr().modify(|w| w.set_rmvf(true));
    if flags.wdgrstf() || flags.wwdgrstf() {
        ResetCause::Watchdog
    } else if flags.sftrstf() {
        ResetCause::Software
    } else if flags.porrstf() || flags.borrstf() {
        ResetCause::PowerOn
    } else if flags.padrstf() {
        ResetCause::Pin
    } else {
        ResetCause::Other
    }
}
