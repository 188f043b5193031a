//! The display board: pins and tasks around [`Board`].

use embassy_executor::Spawner;
use embassy_stm32::gpio::{Level, Output, Speed};
use embassy_stm32::interrupt::{InterruptExt, Priority};
use embassy_stm32::{adc, interrupt};
use static_cell::StaticCell;

use super::flash::BoardFlash;
use super::{FAST, SAMPLING, Start};
use super::{absent, control, guard, identity, interlock, outputs, panel, record, refuse_to_run, sampling, serial};
use super::{spawn_links, start, usb, usb_pin};
use crate::board::{Board, Identity};
use crate::config::BoardConfig;
use crate::fast::FastLoop;
use protocol::fault::Fault;

/// Starts everything.
pub fn run(spawner: Spawner) {
    let Start { p, reset_cause, external } = start();
    // Off before anything else can go wrong.
    // Stays an output for ever; its level is the interlock's.
    core::mem::forget(Output::new(p.PD14, Level::Low, Speed::Low));
    let coil = outputs::Coil::new(p.TIM8, p.PC6);
    let actuator = outputs::Actuator::new(p.TIM1, p.PE9, p.PE11);
    let arm = outputs::Arm::new(p.TIM4, p.PD15);
    // The drivers have enabled their main outputs, at a duty of nothing.
    interlock::outputs_off();
    guard(reset_cause, external);
    let usb_pin = usb_pin(p.PA12, external);

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
    let pins = sampling::Pins {
        load_cell: p.PA3,
        fsr: p.PC0,
        potentiometer: p.PC3,
        probe_position: p.PC2,
        coil_current: p.PB1,
    };
    let sampling = sampling::Sampling::new(adc::Adc::new(p.ADC1), p.DMA2_CH0, p.TIM3, pins);
    let usb = usb_pin.map(|pin| usb::start(p.USB_OTG_FS, pin, p.PA11));
    let uart = serial::start(p.USART3, p.PD9, p.PD8);
    interlock::start(p.TIM7, p.IWDG, absent(usb.is_some(), uart.is_some()));
    let spawned = (|| {
        SAMPLING.start(interrupt::UART5).spawn(sampling::run(sampling, coil)?);
        spawn_links(spawner, usb, uart)?;
        spawner.spawn(control::run(board, actuator, arm, panel)?);
        Ok::<(), embassy_executor::SpawnError>(())
    })();
    if spawned.is_err() {
        refuse_to_run();
    }
}
