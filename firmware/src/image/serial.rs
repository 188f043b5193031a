//! UART link: USART3 to the ST-LINK's virtual serial port, 115200 8N1.

use crate::interlock::Task;
use crate::link::LinkId;
use embassy_stm32::Peri;
use embassy_stm32::peripherals::{PD8, PD9, USART3};
use embassy_stm32::usart::{BufferedUart, BufferedUartRx, BufferedUartTx, Config};
use embassy_time::{Duration, Instant, with_timeout};
use embedded_io_async::{Read, Write};
use static_cell::StaticCell;

use super::{Irqs, PACKET_LEN, Packet, RECEIVED, TO_UART, interlock};

/// Idle wait before the task shows that it lives.
const TURN: Duration = Duration::from_millis(50);

/// Longest time for 64 bytes at 115200 baud is 6 ms; without progress for this long the line is given up.
const STUCK: Duration = Duration::from_millis(200);

/// Time for 23 bytes. The driver (embassy-stm32 0.6.0) does not wake a writer that waits for room in its buffer, so it is asked again.
const ROOM: Duration = Duration::from_millis(2);

/// Transmitter and receiver.
pub type Halves = (BufferedUartTx<'static>, BufferedUartRx<'static>);

pub fn start(uart: Peri<'static, USART3>, rx: Peri<'static, PD9>, tx: Peri<'static, PD8>) -> Option<Halves> {
    static TX: StaticCell<[u8; 256]> = StaticCell::new();
    static RX: StaticCell<[u8; 256]> = StaticCell::new();
    let mut config = Config::default();
    config.baudrate = 115_200;
    BufferedUart::new(uart, rx, tx, TX.init([0; 256]), RX.init([0; 256]), Irqs, config).ok().map(BufferedUart::split)
}

#[embassy_executor::task]
pub async fn receive(mut rx: BufferedUartRx<'static>) -> ! {
    let mut buffer = [0; PACKET_LEN];
    loop {
        // A line error (noise, framing) costs the bytes; the CRC of the frame tells.
        if let Ok(Ok(count)) = with_timeout(TURN, rx.read(&mut buffer)).await
            && let Some(bytes) = buffer.get(..count).and_then(|b| heapless::Vec::from_slice(b).ok())
        {
            RECEIVED.send(Packet { link: LinkId::Uart, bytes }).await;
        }
        interlock::turn(Task::UartReceive);
    }
}

#[embassy_executor::task]
pub async fn send(mut tx: BufferedUartTx<'static>) -> ! {
    let mut buffer = [0; PACKET_LEN];
    loop {
        interlock::turn(Task::UartSend);
        // Woken now and then, to show that the task lives.
        let Ok(count) = with_timeout(TURN, TO_UART.read(&mut buffer)).await else {
            continue;
        };
        let Some(bytes) = buffer.get(..count) else {
            continue;
        };
        let until = Instant::now() + STUCK;
        // Whole or not at all: a packet is no larger than the driver's buffer.
        while with_timeout(ROOM, Write::write(&mut tx, bytes)).await.is_err() {
            interlock::turn(Task::UartSend);
            if Instant::now() > until {
                defmt::warn!("UART does not send");
                break;
            }
        }
    }
}
