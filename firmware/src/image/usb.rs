//! USB link: a CDC-ACM serial port on the full-speed device (PA11, PA12).

use crate::interlock::Task;
use crate::link::LinkId;
use embassy_stm32::Peri;
use embassy_stm32::peripherals::{PA11, PA12, USB_OTG_FS};
use embassy_stm32::usb::{Config as OtgConfig, Driver};
use embassy_time::{Duration, with_timeout};
use embassy_usb::class::cdc_acm::{CdcAcmClass, Receiver, Sender, State};
use embassy_usb::{Builder, Config, UsbDevice};
use static_cell::StaticCell;

use super::{Irqs, PACKET_LEN, Packet, RECEIVED, TO_USB, interlock};

type Otg = Driver<'static, USB_OTG_FS>;

/// pid.codes, test pid: not for distribution with hardware.
const VENDOR: u16 = 0x1209;
const PRODUCT: u16 = 0x0001;

const TURN: Duration = Duration::from_millis(50);

/// A host that does not fetch a packet for so many turns has closed the port.
const STUCK_TURNS: u32 = 4;

/// The parts that become tasks.
pub struct Usb {
    pub device: UsbDevice<'static, Otg>,
    pub sender: Sender<'static, Otg>,
    pub receiver: Receiver<'static, Otg>,
}

pub fn start(usb: Peri<'static, USB_OTG_FS>, dp: Peri<'static, PA12>, dm: Peri<'static, PA11>) -> Usb {
    static ENDPOINT_OUT: StaticCell<[u8; 256]> = StaticCell::new();
    static DESCRIPTORS: StaticCell<[[u8; 256]; 2]> = StaticCell::new();
    static CONTROL: StaticCell<[u8; 64]> = StaticCell::new();
    static STATE: StaticCell<State<'static>> = StaticCell::new();
    let mut otg = OtgConfig::default();
    // The NUCLEO's VBUS pin is not wired to the device in every jumper setting.
    otg.vbus_detection = false;
    let driver = Driver::new_fs(usb, Irqs, dp, dm, ENDPOINT_OUT.init([0; 256]), otg);
    let mut config = Config::new(VENDOR, PRODUCT);
    config.manufacturer = Some("Palpate");
    config.product = Some("Palpate display board");
    config.serial_number = Some(embassy_stm32::uid::uid_hex());
    let [descriptor, bos] = DESCRIPTORS.init([[0; 256]; 2]);
    let mut builder = Builder::new(driver, config, descriptor, bos, &mut [], CONTROL.init([0; 64]));
    let class = CdcAcmClass::new(&mut builder, STATE.init(State::new()), PACKET_LEN as u16);
    let (sender, receiver) = class.split();
    Usb { device: builder.build(), sender, receiver }
}

#[embassy_executor::task]
pub async fn device(mut device: UsbDevice<'static, Otg>) -> ! {
    device.run().await
}

/// In place of the three tasks where USB is off: nothing arrives, and what is sent there is lost.
#[embassy_executor::task]
pub async fn absent() -> ! {
    let mut buffer = [0; PACKET_LEN];
    loop {
        let _ = with_timeout(TURN, TO_USB.read(&mut buffer)).await;
        interlock::turn(Task::UsbReceive);
    }
}

#[embassy_executor::task]
pub async fn receive(mut receiver: Receiver<'static, Otg>) -> ! {
    let mut buffer = [0; PACKET_LEN];
    loop {
        match with_timeout(TURN, receiver.read_packet(&mut buffer)).await {
            Ok(Ok(count)) => {
                if let Some(bytes) = buffer.get(..count).and_then(|b| heapless::Vec::from_slice(b).ok()) {
                    RECEIVED.send(Packet { link: LinkId::Usb, bytes }).await;
                }
            }
            // Not connected: wait for it, but no longer than a turn.
            Ok(Err(_)) => {
                let _ = with_timeout(TURN, receiver.wait_connection()).await;
            }
            Err(_) => {}
        }
        interlock::turn(Task::UsbReceive);
    }
}

#[embassy_executor::task]
pub async fn send(mut sender: Sender<'static, Otg>) -> ! {
    let mut buffer = [0; PACKET_LEN];
    loop {
        interlock::turn(Task::UsbSend);
        // Woken now and then, to show that the task lives.
        let Ok(count) = with_timeout(TURN, TO_USB.read(&mut buffer)).await else {
            continue;
        };
        let Some(bytes) = buffer.get(..count) else {
            continue;
        };
        // A full packet must be followed by an empty one for the host to see the end of the transfer.
        if write(&mut sender, bytes).await && count == PACKET_LEN {
            write(&mut sender, &[]).await;
        }
    }
}

/// Writes one packet; false if nobody fetches it. Without a listener the bytes are lost, which the sequence numbers tell.
async fn write(sender: &mut Sender<'static, Otg>, packet: &[u8]) -> bool {
    for _ in 0..STUCK_TURNS {
        match with_timeout(TURN, sender.write_packet(packet)).await {
            Ok(written) => return written.is_ok(),
            Err(_) => interlock::turn(Task::UsbSend),
        }
    }
    false
}
