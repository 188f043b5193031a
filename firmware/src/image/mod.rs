//! Start of the image: clocks, pins, tasks.

mod clock;
mod control;
mod crash;
mod debugger;
mod flash;
mod identity;
mod interlock;
mod lamp;
mod outputs;
mod panel;
mod record;
mod reset;
mod revision;
mod sampling;
mod serial;
mod supply;
mod usb;

use core::cell::RefCell;

use defmt_rtt as _;
use embassy_executor::{InterruptExecutor, Spawner};
use embassy_stm32::gpio::{Level, Output, Speed};
use embassy_stm32::interrupt;
use embassy_stm32::interrupt::{InterruptExt, Priority};
use embassy_stm32::{adc, bind_interrupts, dma, peripherals, usart};
use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::channel::Channel;
use embassy_sync::pipe::Pipe;
use firmware::board::{Board, Identity};
use firmware::config::BoardConfig;
use firmware::fast::FastLoop;
use firmware::interlock::Task;
use firmware::link::LinkId;
use protocol::fault::Fault;
use protocol::message::ResetCause;
use static_cell::StaticCell;

use self::flash::BoardFlash;

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

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    let reset_cause = reset::cause();
    record::begin();
    let external = clock::start_external();
    let p = embassy_stm32::init(clock::config(external));
    flash::accelerate();
    // Off before anything else can go wrong.
    // Stays an output for ever; its level is the interlock's.
    core::mem::forget(Output::new(p.PD14, Level::Low, Speed::Low));
    let coil = outputs::Coil::new(p.TIM8, p.PC6);
    let actuator = outputs::Actuator::new(p.TIM1, p.PE9, p.PE11);
    let arm = outputs::Arm::new(p.TIM4, p.PD15);
    // The drivers have enabled their main outputs, at a duty of nothing.
    interlock::outputs_off();

    supply::guard();
    tell_start(reset_cause, external);
    if external {
        clock::guard();
    }
    let usb_pin = if external && !revision::is_old() {
        Some(p.PA12)
    } else {
        revision::quieten(p.PA12);
        None
    };

    let config = BoardConfig::default();
    let fast = FastLoop::new(&config.circuit, &config.shunt, config.safety.coil_a);
    FAST.lock(|cell| cell.replace(Some(fast)));

    static BOARD: StaticCell<Board<BoardFlash>> = StaticCell::new();
    let identity = Identity {
        unique_id: embassy_stm32::uid::uid(),
        reset_cause,
        build: identity::build(),
        last_run: record::last_run(),
    };
    let board = BOARD.init_with(|| Board::new(config, BoardFlash::take(p.FLASH), identity));
    if usb_pin.is_none() {
        board.latch(Fault::UsbOff);
    }

    let panel = panel::Panel::new(p.PB0, p.PB7, p.PB14, p.PC13);

    interrupt::UART5.set_priority(Priority::P6);
    let sampling = sampling::Sampling::new(
        adc::Adc::new(p.ADC1),
        p.DMA2_CH0,
        p.TIM3,
        sampling::Pins {
            load_cell: p.PA3,
            fsr: p.PC0,
            potentiometer: p.PC3,
            probe_position: p.PC2,
            coil_current: p.PB1,
        },
    );
    let usb = usb_pin.map(|pin| usb::start(p.USB_OTG_FS, pin, p.PA11));
    let uart = serial::start(p.USART3, p.PD9, p.PD8);

    let absent: &[Task] = match (&usb, &uart) {
        (Some(_), Some(_)) => &[],
        (None, Some(_)) => &[Task::UsbSend],
        (Some(_), None) => &[Task::UartReceive, Task::UartSend],
        (None, None) => &[Task::UsbSend, Task::UartReceive, Task::UartSend],
    };
    interlock::start(p.TIM7, p.IWDG, absent);
    let spawned = (|| {
        SAMPLING.start(interrupt::UART5).spawn(sampling::run(sampling, coil)?);
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
        spawner.spawn(control::run(board, actuator, arm, panel)?);
        Ok::<(), embassy_executor::SpawnError>(())
    })();
    if spawned.is_err() {
        // Each task has one place and is spawned once, so this cannot be; without tasks nothing may run.
        interlock::outputs_off();
        defmt::error!("a task could not be started");
    }
}
