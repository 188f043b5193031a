//! What runs on the microcontroller: start, tasks, peripherals. [`board`] is the display board, [`selftest`] the program
//! that tests a bare NUCLEO. On the host there is none of it.

pub mod board;
mod clock;
mod control;
mod crash;
mod debugger;
mod flash;
mod hang;
mod identity;
mod interlock;
mod lamp;
mod outputs;
mod panel;
mod record;
mod reset;
mod revision;
mod sampling;
pub mod selftest;
mod serial;
mod supply;
mod usb;

use core::cell::RefCell;

use crate::fast::FastLoop;
use crate::interlock::Task;
use crate::link::LinkId;
use defmt_rtt as _;
use embassy_executor::{InterruptExecutor, Spawner};
use embassy_stm32::interrupt;
use embassy_stm32::peripherals::PA12;
use embassy_stm32::{Peri, Peripherals, bind_interrupts, dma, peripherals, usart};
use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::channel::Channel;
use embassy_sync::pipe::Pipe;
use protocol::message::ResetCause;

bind_interrupts!(struct Irqs {
    DMA2_STREAM0 => dma::InterruptHandler<peripherals::DMA2_CH0>;
    OTG_FS => embassy_stm32::usb::InterruptHandler<peripherals::USB_OTG_FS>;
    USART3 => usart::BufferedInterruptHandler<peripherals::USART3>;
});

/// The fast loop, shared by the sampling task (1 kHz) and the control task (50 Hz). Both hold it for microseconds.
type SharedFast = Mutex<CriticalSectionRawMutex, RefCell<Option<FastLoop>>>;
static FAST: SharedFast = Mutex::new(RefCell::new(None));

/// Bytes from a link.
struct Packet {
    link: LinkId,
    bytes: heapless::Vec<u8, PACKET_LEN>,
}

/// Longest packet of a full-speed bulk endpoint.
const PACKET_LEN: usize = 64;

static RECEIVED: Channel<CriticalSectionRawMutex, Packet, 16> = Channel::new();
static TO_USB: Pipe<CriticalSectionRawMutex, 1024> = Pipe::new();
static TO_UART: Pipe<CriticalSectionRawMutex, 1024> = Pipe::new();

/// Runs the sampling task above everything in thread mode. UART5 is not used as such; its interrupt is the executor's.
static SAMPLING: InterruptExecutor = InterruptExecutor::new();

#[interrupt]
#[allow(unsafe_code)]
fn UART5() {
    // SAFETY: called from the interrupt the executor was started with, and from nowhere else.
    unsafe { SAMPLING.on_interrupt() }
}

/// Writes to the log what this start found.
fn tell_start(reset_cause: ResetCause, external: bool) {
    defmt::info!("start: reset cause {=u8}, chip revision {=u16:#x}", reset_cause as u8, revision::code());
    record::log();
    if !external {
        defmt::error!("no 8 MHz clock: running from the internal one, USB off");
    }
    if revision::is_old() {
        defmt::error!("chip before revision 3: USB off");
    }
}

defmt::timestamp!("{=u64:us}", embassy_time::Instant::now().as_micros());

/// What every program begins with: why it starts, the record of the last run, clocks, caches.
struct Start {
    p: Peripherals,
    reset_cause: ResetCause,
    /// The 8 MHz clock has come.
    external: bool,
}

fn start() -> Start {
    let reset_cause = reset::cause();
    record::begin();
    let external = clock::start_external();
    let p = embassy_stm32::init(clock::config(external));
    flash::accelerate();
    Start { p, reset_cause, external }
}

/// From here on a sagging supply and a lost clock end the run; told once the outputs are off.
fn guard(reset_cause: ResetCause, external: bool) {
    supply::guard();
    tell_start(reset_cause, external);
    if external {
        clock::guard();
    }
}

/// USB's pin, where USB and this chip go together; else kept still.
fn usb_pin(pin: Peri<'static, PA12>, external: bool) -> Option<Peri<'static, PA12>> {
    if external && !revision::is_old() {
        return Some(pin);
    }
    revision::quieten(pin);
    None
}

/// The links as they are: what has none is not watched.
fn absent(usb: bool, uart: bool) -> &'static [Task] {
    match (usb, uart) {
        (true, true) => &[],
        (false, true) => &[Task::UsbSend],
        (true, false) => &[Task::UartReceive, Task::UartSend],
        (false, false) => &[Task::UsbSend, Task::UartReceive, Task::UartSend],
    }
}

/// Spawns the tasks of the links.
fn spawn_links(
    spawner: Spawner,
    usb: Option<usb::Usb>,
    uart: Option<serial::Halves>,
) -> Result<(), embassy_executor::SpawnError> {
    match usb {
        Some(usb) => {
            spawner.spawn(usb::device(usb.device)?);
            spawner.spawn(usb::receive(usb.receiver)?);
            spawner.spawn(usb::send(usb.sender)?);
        }
        None => spawner.spawn(usb::absent()?),
    }
    // Without a UART (its baud rate cannot be wrong here) USB alone still serves.
    if let Some((tx, rx)) = uart {
        spawner.spawn(serial::receive(rx)?);
        spawner.spawn(serial::send(tx)?);
    }
    Ok(())
}

/// Each task has one place and is spawned once, so none can fail to start; without tasks nothing may run.
fn refuse_to_run() {
    interlock::outputs_off();
    defmt::error!("a task could not be started");
}
