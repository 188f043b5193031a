//! The self-test program: it sets outputs, measures, and hurts itself on request. Drivers, interlock, watchdog and
//! ends of a run are those of the display board. `protocol::selftest` is what it understands.

use core::cell::RefCell;

use embassy_executor::Spawner;
use embassy_futures::select::{Either, select};
use embassy_stm32::gpio::{Level, Output, Speed};
use embassy_stm32::interrupt::{InterruptExt, Priority};
use embassy_stm32::pac::gpio::vals::Idr;
use embassy_stm32::{adc, interrupt, pac};
use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::pipe::Pipe;
use embassy_time::{Duration, Instant, Ticker, Timer, with_timeout};
use protocol::frame::{self, MAX_FRAME};
use protocol::message::ResetCause;
use protocol::rescue;
use protocol::selftest::{
    Computed, Drive, Ending, Hang, Identity, Measured, PINS, Released, Report, Request, SCHEMA_HASH, SECTOR, Way,
    Written,
};
use static_cell::StaticCell;

use super::flash::BoardFlash;
use super::outputs::{Actuator, Arm, Coil};
use super::sampling::{self, Sampling};
use super::{RECEIVED, SAMPLING, Start, TO_UART, TO_USB};
use super::{absent, guard, hang, identity, interlock, outputs, record, refuse_to_run, revision, serial};
use super::{spawn_links, start, usb, usb_pin};
use crate::board::FIRMWARE_VERSION;
use crate::fingerprint::fingerprint;
use crate::flash::{EraseProgress, TableStore, WORD, sector_range};
use crate::interlock::{Power, Task};
use crate::link::{LinkId, Receiver};
use crate::selftest::{Average, table};

/// A control tick.
const TICK: Duration = Duration::from_millis(20);

/// Ticks with outputs on before a run is ended or a permit released.
const TICKS_BEFORE: u32 = 5;

/// Longest times that a request may ask for, ms.
const SETTLE_MAX_MS: u16 = 2000;
const AVERAGE_MAX_MS: u16 = 5000;

/// How long a pin may stay high after the permit before it counts as stuck.
const STUCK: Duration = Duration::from_millis(200);

/// Words that are written in a tick, and in all.
const WORDS_A_TICK: u16 = 32;
const WORDS: u16 = 1024;

/// Bytes of the program whose CRC is read while bank 2 is busy: 2 ms of a tick.
const READ_LEN: usize = 8192;

/// Longest erase of a sector, ticks: 4 s (data sheet: at most 2 s for 128 KiB by words).
const ERASE_TICKS: u32 = 200;

static SEEN: Mutex<CriticalSectionRawMutex, RefCell<Average>> = Mutex::new(RefCell::new(Average::new()));

/// Levels of the driven pins, as they are at the pads.
fn levels() -> [bool; PINS] {
    let high = |port: pac::gpio::Gpio, pin| port.idr().read().idr(pin) == Idr::HIGH;
    [high(pac::GPIOC, 6), high(pac::GPIOE, 9), high(pac::GPIOE, 11), high(pac::GPIOD, 15), high(pac::GPIOD, 14)]
}

fn coil_is_low() -> bool {
    pac::GPIOC.idr().read().idr(6) == Idr::LOW
}

/// PE11 has no wire whose capacitor could hold it up; the interlock switches it with the coil.
fn reverse_is_low() -> bool {
    pac::GPIOE.idr().read().idr(11) == Idr::LOW
}

/// The internal reference, read before the ring takes the converter; 0 from one that does not convert. By registers:
/// the driver waits for a conversion without end.
fn reference() -> u16 {
    pac::ADC123_COMMON.ccr().modify(|w| w.set_tsvrefe(true));
    // 10 us until it stands (data sheet, embedded reference voltage).
    cortex_m::asm::delay(168 * 20);
    pac::ADC1.sqr1().modify(|w| w.set_l(0));
    pac::ADC1.sqr3().write(|w| w.set_sq(0, 17));
    pac::ADC1.smpr1().modify(|w| w.set_smp(7, adc::SampleTime::CYCLES480));
    pac::ADC1.cr2().modify(|w| w.set_swstart(true));
    let converted = (0..10_000).any(|_| pac::ADC1.sr().read().eoc());
    if converted { pac::ADC1.dr().read().data() } else { 0 }
}

/// A halfword that the factory has written (RM0090 chapter 39; data sheet, table of the reference's calibration).
fn factory(address: usize) -> u16 {
    // SAFETY: system memory, always readable.
    #[allow(unsafe_code)]
    unsafe {
        (address as *const u16).read_volatile()
    }
}

const FLASH_KIB: usize = 0x1fff_7a22;
const REFERENCE_AT_3V3: usize = 0x1fff_7a2a;

/// Starts everything.
pub fn run(spawner: Spawner) {
    let Start { p, reset_cause, external } = start();
    let hang = hang::take();
    core::mem::forget(Output::new(p.PD14, Level::Low, Speed::Low));
    let coil = Coil::new(p.TIM8, p.PC6);
    let actuator = Actuator::new(p.TIM1, p.PE9, p.PE11);
    let arm = Arm::new(p.TIM4, p.PD15);
    interlock::outputs_off();
    guard(reset_cause, external);
    let usb_pin = usb_pin(p.PA12, external);
    let converter = adc::Adc::new(p.ADC1);
    let reference = reference();
    interrupt::UART5.set_priority(Priority::P6);
    let pins = sampling::Pins {
        load_cell: p.PA3,
        fsr: p.PC0,
        potentiometer: p.PC3,
        probe_position: p.PC2,
        coil_current: p.PB1,
    };
    // An erase here stalls the core: before the links.
    let flash = BoardFlash::take(p.FLASH);
    let sampling = Sampling::new(converter, p.DMA2_CH0, p.TIM3, pins);
    let usb = usb_pin.map(|pin| usb::start(p.USB_OTG_FS, pin, p.PA11));
    let uart = serial::start(p.USART3, p.PD9, p.PD8);
    static PROGRAM: StaticCell<Program> = StaticCell::new();
    let program = PROGRAM.init_with(|| Program {
        coil,
        actuator,
        arm,
        flash,
        ticker: Ticker::every(TICK),
        power: Power::OFF,
        start: Found { reset_cause, external, reference, hang },
        receivers: [Receiver::new(), Receiver::new()],
    });
    interlock::start(p.TIM7, p.IWDG, absent(usb.is_some(), uart.is_some()));
    let spawned = (|| {
        SAMPLING.start(interrupt::UART5).spawn(sample(sampling)?);
        spawn_links(spawner, usb, uart)?;
        spawner.spawn(serve(program)?);
        Ok::<(), embassy_executor::SpawnError>(())
    })();
    if spawned.is_err() {
        refuse_to_run();
    }
}

/// The 1 kHz task: it only looks.
#[embassy_executor::task]
async fn sample(mut sampling: Sampling) -> ! {
    sampling.begin();
    loop {
        let readings = sampling.next().await.map(|raw| raw.channels());
        SEEN.lock(|cell| cell.borrow_mut().take(readings, levels()));
        interlock::turn(Task::Sampling);
    }
}

/// What the start found.
struct Found {
    reset_cause: ResetCause,
    external: bool,
    reference: u16,
    hang: Hang,
}

/// What the program holds.
struct Program {
    coil: Coil,
    actuator: Actuator,
    arm: Arm,
    flash: BoardFlash,
    ticker: Ticker,
    power: Power,
    start: Found,
    receivers: [Receiver; 2],
}

/// Ticks with outputs off, and carries out what arrives.
#[embassy_executor::task]
async fn serve(program: &'static mut Program) -> ! {
    loop {
        match select(program.ticker.next(), RECEIVED.receive()).await {
            Either::First(()) => program.end_tick(),
            Either::Second(packet) => {
                for byte in &packet.bytes {
                    if let Some((request, seq)) = program.push(packet.link, *byte).await {
                        let report = program.carry_out(request, packet.link, seq).await;
                        send(packet.link, &report, seq).await;
                        // What arrived meanwhile was not listened to.
                        break;
                    }
                }
            }
        }
    }
}

/// Queues an answer; one that a closed port does not fetch is lost.
async fn send(link: LinkId, report: &Report, seq: u16) {
    let mut buffer = [0; MAX_FRAME];
    if let Ok(bytes) = frame::encode_selftest_report(report, seq, &mut buffer) {
        queue(link, bytes).await;
    }
}

async fn queue(link: LinkId, bytes: &[u8]) {
    let pipe: &Pipe<CriticalSectionRawMutex, 1024> = match link {
        LinkId::Usb => &TO_USB,
        LinkId::Uart => &TO_UART,
    };
    // Half a frame would spoil the next one.
    if pipe.free_capacity() >= bytes.len() {
        let _ = with_timeout(TICK, pipe.write_all(bytes)).await;
    }
}

impl Program {
    /// Takes a byte; a request with its number when it completes one.
    async fn push(&mut self, link: LinkId, byte: u8) -> Option<(Request, u16)> {
        let frame = self.receivers.get_mut(link as usize)?.push(byte)?;
        let seq = frame.seq;
        if frame.kind == rescue::KIND && frame.body.starts_with(&rescue::QUESTION) {
            // By this hash a tool for boards knows what it has found.
            let answer = rescue::Answer {
                schema_hash_low: SCHEMA_HASH as u32,
                ..rescue::Answer::of_this_build(FIRMWARE_VERSION)
            };
            let mut buffer = [0; MAX_FRAME];
            if let Ok(bytes) = frame::encode_body(rescue::KIND, seq, &answer.to_bytes(), &mut buffer) {
                queue(link, bytes).await;
            }
            return None;
        }
        Request::decode(frame.kind, frame.body).ok().map(|request| (request, seq))
    }

    async fn carry_out(&mut self, request: Request, link: LinkId, seq: u16) -> Report {
        match request {
            Request::Identify(_) => Report::Identity(self.identity()),
            Request::Measure(drive) => Report::Measured(self.measure(&drive).await),
            Request::Release(_) => Report::Released(self.release().await),
            Request::Compute(_) => Report::Computed(compute()),
            Request::WriteFlash(_) => Report::Written(self.write_flash().await),
            Request::Repeat(echo) => Report::Echo(echo),
            Request::End(ending) => {
                send(link, &Report::Ending(ending.clone()), seq).await;
                self.end(&ending).await
            }
        }
    }

    /// The end of a control tick, with a permit for what is on.
    fn end_tick(&mut self) {
        interlock::turn(Task::Control);
        interlock::end_of_tick(self.power, true);
    }

    /// A tick within a request. Whoever talks meanwhile is not heard; the links' tasks must not wait for it.
    async fn tick(&mut self) {
        self.ticker.next().await;
        while RECEIVED.try_receive().is_ok() {}
        self.end_tick();
    }

    /// At least so many milliseconds of ticks.
    async fn ticks(&mut self, time_ms: u16) {
        for _ in 0..u32::from(time_ms).div_ceil(TICK.as_millis() as u32) {
            self.tick().await;
        }
    }

    /// All duties and power off, at the end of a tick.
    async fn off(&mut self) {
        self.power = Power::OFF;
        self.coil.set(0.0);
        self.actuator.set_v(0.0);
        self.arm.set_rate(0.0);
        self.tick().await;
    }

    fn identity(&self) -> Identity {
        let Found { reset_cause, external, reference, hang } = &self.start;
        Identity {
            schema_hash: SCHEMA_HASH,
            firmware_version: FIRMWARE_VERSION,
            build: identity::build(),
            unique_id: embassy_stm32::uid::uid(),
            device: pac::DBGMCU.idcode().read().dev_id(),
            revision: revision::code(),
            flash_kib: factory(FLASH_KIB),
            options: pac::FLASH.optcr().read().0,
            external_clock: *external,
            flash_access: pac::FLASH.acr().read().0,
            reference: *reference,
            reference_at_3v3: factory(REFERENCE_AT_3V3),
            reset_cause: *reset_cause,
            last_run: record::last_run(),
            hang: hang.clone(),
            uptime_us: Instant::now().as_micros(),
        }
    }

    async fn measure(&mut self, drive: &Drive) -> Measured {
        self.power = match drive.power {
            protocol::selftest::Power::Off => Power::OFF,
            protocol::selftest::Power::Display => Power::DISPLAY,
            protocol::selftest::Power::Arm => Power::ARM,
        };
        self.coil.set(drive.coil);
        self.actuator.set_v(drive.actuator * outputs::ACTUATOR_SUPPLY_V);
        self.arm.set_rate(drive.arm * outputs::ARM_FULL_RATE_MM_S);
        self.ticks(drive.settle_ms.min(SETTLE_MAX_MS)).await;
        let from = Instant::now();
        SEEN.lock(|cell| cell.replace(Average::new()));
        self.ticks(drive.average_ms.min(AVERAGE_MAX_MS)).await;
        let seen = SEEN.lock(|cell| *cell.borrow());
        let now = Instant::now();
        self.off().await;
        seen.measured(now.duration_since(from).as_micros() as u32, now.as_micros())
    }

    /// Coil and actuator's reverse pin high for some ticks, each with its permit.
    async fn both_on(&mut self) {
        self.coil.set(1.0);
        self.actuator.set_v(-outputs::ACTUATOR_SUPPLY_V);
        self.power = Power::DISPLAY;
        for _ in 0..TICKS_BEFORE {
            self.tick().await;
        }
    }

    async fn release(&mut self) -> Released {
        self.both_on().await;
        let from = Instant::now();
        let (mut pin_low_us, mut coil_low_us) = (0, 0);
        while (pin_low_us == 0 || coil_low_us == 0) && from.elapsed() < STUCK {
            // The task lives, it only grants nothing.
            interlock::turn(Task::Control);
            let now_us = from.elapsed().as_micros() as u32;
            for (low_us, is_low) in [(&mut pin_low_us, reverse_is_low()), (&mut coil_low_us, coil_is_low())] {
                if *low_us == 0 && is_low {
                    *low_us = now_us.max(1);
                }
            }
            Timer::after_micros(100).await;
        }
        let told = interlock::trip().is_some();
        self.ticker.reset();
        self.off().await;
        Released { pin_low_us, coil_low_us, told }
    }

    /// Half duty on the coil, everything else as always, and bank 2 busy.
    async fn write_flash(&mut self) -> Written {
        let whole = identity::checksum(READ_LEN);
        let mut written =
            Written { erase_ms: 0, word_us: 0, words_right: 0, words: 0, reads: 0, reads_wrong: 0, count: 0, lost: 0 };
        self.coil.set(0.5);
        self.power = Power::DISPLAY;
        SEEN.lock(|cell| cell.replace(Average::new()));
        let from = Instant::now();
        let mut progress = self.flash.start_erase(SECTOR).map(|()| EraseProgress::Busy);
        for _ in 0..ERASE_TICKS {
            if progress != Ok(EraseProgress::Busy) {
                break;
            }
            self.tick().await;
            check_program(&mut written, whole);
            progress = self.flash.poll_erase();
        }
        if progress == Ok(EraseProgress::Done) {
            written.erase_ms = from.elapsed().as_millis() as u32;
            while written.words < WORDS {
                self.tick().await;
                check_program(&mut written, whole);
                for _ in 0..WORDS_A_TICK {
                    self.write_word(&mut written);
                }
            }
        }
        let seen = SEEN.lock(|cell| *cell.borrow());
        (written.count, written.lost) = (seen.count(), seen.lost());
        self.off().await;
        written
    }

    fn write_word(&mut self, written: &mut Written) {
        let at = sector_range(SECTOR).map_or(0, |range| range.start) + usize::from(written.words) * WORD;
        // Every bit is written as one and as zero somewhere.
        let word = (u32::from(written.words) + 1).wrapping_mul(2_654_435_761).to_le_bytes();
        let blank = self.flash.bytes().get(at..at + WORD) == Some(&[0xff; WORD]);
        let from = Instant::now();
        let done = self.flash.write(at, &word).is_ok();
        written.word_us = written.word_us.max(from.elapsed().as_micros() as u32);
        written.words += 1;
        written.words_right += u16::from(blank && done && self.flash.bytes().get(at..at + WORD) == Some(&word));
    }

    async fn end(&mut self, ending: &Ending) -> ! {
        self.both_on().await;
        match ending.way {
            Way::Hang => hang::until_reset(reverse_is_low),
            Way::HangMasked => {
                cortex_m::interrupt::disable();
                hang::until_reset(reverse_is_low)
            }
            // What is tested is that its place is on record.
            #[allow(clippy::panic)]
            Way::Panic => panic!("as asked"),
            Way::HardFault => cortex_m::asm::udf(),
        }
    }
}

/// The identification, once.
fn compute() -> Computed {
    let from = Instant::now();
    let found = table().and_then(|table| fingerprint(&table));
    let took_us = from.elapsed().as_micros() as u32;
    let hash = |of: fn(&crate::fingerprint::Fingerprint) -> u64| found.as_ref().map_or(0, of);
    Computed {
        search: hash(|f| f.search),
        profile: hash(|f| f.profile),
        filter: hash(|f| f.filter),
        offset_filter: hash(|f| f.offset_filter),
        took_us,
    }
}

/// Reads the program while the other bank is written.
fn check_program(written: &mut Written, whole: u32) {
    written.reads = written.reads.saturating_add(1);
    written.reads_wrong = written.reads_wrong.saturating_add(u16::from(identity::checksum(READ_LEN) != whole));
}
