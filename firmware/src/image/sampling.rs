//! The 1 kHz task: converter readings in, coil duty out.
//!
//! TIM3 triggers one scan of the five channels every 62.5 us; DMA fills a ring, and every half of it (16 scans, 1 ms) wakes this task. A
//! half that is not fetched within another millisecond is overwritten: the ring reports an overrun, which is counted, told to the control
//! loop, and sampling goes on with the next half.

use core::sync::atomic::{AtomicBool, Ordering};

use crate::fast::FAST_HZ;
use crate::interlock::Task;
use crate::sensor::RawSamples;
use embassy_stm32::adc::{Adc, AdcChannel, Exten, RingBufferedAdc, SampleTime};
use embassy_stm32::peripherals::{ADC1, DMA2_CH0, PA3, PB1, PC0, PC2, PC3, TIM3};
use embassy_stm32::time::Hertz;
use embassy_stm32::timer::low_level::{MasterMode, RoundTo, Timer};
use embassy_stm32::{Peri, pac, triggers};
use embassy_time::{Duration, with_timeout};
use static_cell::StaticCell;

use super::outputs::Coil;
use super::{FAST, Irqs, interlock};

/// Channels of a scan, and scans of a half ring.
const CHANNELS: usize = 5;
const SCANS: usize = 16;
const HALF: usize = CHANNELS * SCANS;

/// Full scale of the 12-bit converter.
const FULL_SCALE: f32 = 4096.0;

/// A half ring comes every millisecond; without one for this long the trigger or the converter has stopped.
const PATIENCE: Duration = Duration::from_millis(5);

/// Set when the ring overran or no reading came; the control task takes it.
pub static OVERRUN: AtomicBool = AtomicBool::new(false);

/// The converter's pins.
pub struct Pins {
    pub load_cell: Peri<'static, PA3>,
    pub fsr: Peri<'static, PC0>,
    pub potentiometer: Peri<'static, PC3>,
    pub probe_position: Peri<'static, PC2>,
    pub coil_current: Peri<'static, PB1>,
}

/// Converter and its trigger.
pub struct Sampling {
    ring: RingBufferedAdc<'static, ADC1>,
    trigger: Timer<'static, TIM3>,
}

impl Sampling {
    /// Prepares both; [`Sampling::begin`] lets them go.
    pub fn new(adc: Adc<'static, ADC1>, dma: Peri<'static, DMA2_CH0>, timer: Peri<'static, TIM3>, pins: Pins) -> Self {
        static RING: StaticCell<[u16; 2 * HALF]> = StaticCell::new();
        // 84 + 12 clocks of 21 MHz a channel: 23 us a scan.
        let sequence = [
            pins.load_cell.degrade_adc(),
            pins.fsr.degrade_adc(),
            pins.potentiometer.degrade_adc(),
            pins.probe_position.degrade_adc(),
            pins.coil_current.degrade_adc(),
        ]
        .map(|channel| (channel, SampleTime::CYCLES84));
        let ring = adc.into_ring_buffered(
            dma,
            RING.init([0; 2 * HALF]),
            Irqs,
            sequence.into_iter(),
            triggers::TIM3_TRGO,
            Exten::RISING_EDGE,
        );
        let trigger = Timer::new(timer);
        trigger.set_frequency(Hertz(FAST_HZ * SCANS as u32), RoundTo::Slower);
        trigger.set_master_mode(MasterMode::UPDATE);
        Sampling { ring, trigger }
    }

    /// Lets them go. The ring first: a scan that finds its stream off overruns the converter.
    pub fn begin(&mut self) {
        self.ring.start();
        self.trigger.start();
    }

    /// The mean of the next millisecond; `None`, and [`OVERRUN`] set, if the ring overran or no reading came for
    /// [`PATIENCE`]: then the converter has been started anew.
    pub async fn next(&mut self) -> Option<RawSamples> {
        let mut half = [0u16; HALF];
        match with_timeout(PATIENCE, self.ring.read(&mut half)).await {
            Ok(Ok(_)) => return Some(mean(&half)),
            Ok(Err(_)) => defmt::warn!("converter ring overran"),
            Err(_) => {
                defmt::error!("no readings for 5 ms, converter restarted");
                self.restart();
            }
        }
        OVERRUN.store(true, Ordering::Relaxed);
        None
    }

    /// After a stop of the converter (its overrun flag blocks DMA): starts converter and ring from their beginnings.
    ///
    /// A stream that is only switched off and on again goes on with its old remaining count, and channels would change places in
    /// the ring for good if the stop fell into a scan. So the scan is aborted (ADON) and the count written anew (RM0090, 10.3.17 and 13.8.1).
    fn restart(&mut self) {
        self.ring.stop();
        let stream = pac::DMA2.st(0);
        // The stream ends its last item within a few bus clocks; the bound is for a bus that does not answer.
        for _ in 0..1000 {
            if !stream.cr().read().en() {
                break;
            }
        }
        pac::ADC1.cr2().modify(|w| {
            w.set_adon(false);
            w.set_dma(false);
        });
        pac::ADC1.sr().modify(|w| w.set_ovr(false));
        stream.ndtr().write(|w| w.set_ndt((2 * HALF) as u16));
        pac::ADC1.cr2().modify(|w| {
            w.set_adon(true);
            w.set_dma(true);
        });
        self.ring.clear();
        self.ring.start();
    }
}

/// Mean of a half ring, as fractions of the reference.
fn mean(half: &[u16; HALF]) -> RawSamples {
    let mut sums = [0u32; CHANNELS];
    for scan in half.chunks_exact(CHANNELS) {
        for (sum, reading) in sums.iter_mut().zip(scan) {
            *sum += u32::from(*reading);
        }
    }
    RawSamples::from_channels(sums.map(|sum| sum as f32 / (SCANS as f32 * FULL_SCALE)))
}

/// Deadline 1 ms. A late step leaves the duty as it is for that long; a lost half of the ring sets it to 0, as does a
/// converter that says nothing for 5 ms.
#[embassy_executor::task]
pub async fn run(mut sampling: Sampling, mut coil: Coil) -> ! {
    sampling.begin();
    loop {
        // Without a reading nobody has looked at the current, whatever it is now.
        let duty = match sampling.next().await {
            Some(raw) => FAST.lock(|cell| cell.borrow_mut().as_mut().map_or(0.0, |fast| fast.step(&raw))),
            None => 0.0,
        };
        coil.set(duty);
        // Readings or not: that none come is latched as a fault; a reset would not bring a dead converter back.
        interlock::turn(Task::Sampling);
    }
}
