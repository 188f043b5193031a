//! Which register answers at which address (RM0090 table 1).

use super::Chip;
use super::gpio::IDR;
use super::timer::Timer;

impl Chip {
    /// The program has written to flash, whose word there was `old`.
    pub fn write_flash(&mut self, offset: usize, size: usize, old: u32, value: u32) {
        let (change, stall) = self.flash.program(offset, size, old, value, self.now);
        self.flash_changes.push(change);
        self.now += stall;
    }

    /// Value of the register at an address, which is word-aligned.
    pub fn read(&mut self, address: u32) -> u32 {
        let now = self.now;
        let offset = (address & 0x3ff) as usize;
        match address & !0x3ff {
            0x4000_0400 => self.tim3.read(offset, now),
            0x4000_0800 => self.tim4.read(offset, now),
            0x4000_0c00 => self.tim5.read(offset, now),
            0x4000_1400 => self.tim7.read(offset, now),
            0x4000_3000 => self.watchdog.read(offset, now),
            0x4000_4800 => self.usart.read(offset, now),
            0x4000_7000 => self.pwr.read(offset),
            0x4001_0000 => self.tim1.read(offset, now),
            0x4001_0400 => self.tim8.read(offset, now),
            0x4001_2000 => self.adc.read(offset),
            0x4001_3c00 => self.exti.read(offset),
            port @ 0x4002_0000..0x4002_2c00 => self.read_port((port - 0x4002_0000) as usize / 0x400, offset),
            0x4002_3800 => self.rcc.read(offset),
            0x4002_3c00 => self.flash.read(offset, now),
            0x4002_6400 => self.dma2.read(offset),
            0x5000_0000..0x5004_0000 => self.usb.read((address - 0x5000_0000) as usize),
            0xe004_2000 => self.dbgmcu.read(offset),
            0xe000_e000..0xe000_f000 => self.nvic.read((address - 0xe000_e000) as usize),
            _ => 0,
        }
    }

    /// A register of a port; levels with what the timers drive (pins of the image: PC6, PD15, PE9, PE11).
    fn read_port(&self, number: usize, offset: usize) -> u32 {
        let port = &self.ports[number];
        let high = |timer: &Timer, channel, pin| {
            let held = timer.floats() && self.wiring.holds_high(number, pin);
            u32::from(held || timer.is_high(channel, self.now)) << pin
        };
        let driven = match (number, offset) {
            (2, IDR) => high(&self.tim8, 0, 6),
            (3, IDR) => high(&self.tim4, 3, 15),
            (4, IDR) => high(&self.tim1, 0, 9) | high(&self.tim1, 1, 11),
            _ => 0,
        };
        port.read(offset) | port.alternate(driven)
    }

    /// Sets the register at an address, which is word-aligned.
    pub fn write(&mut self, address: u32, value: u32) {
        let now = self.now;
        let offset = (address & 0x3ff) as usize;
        match address & !0x3ff {
            0x4000_0400 => self.tim3.write(offset, value, now),
            0x4000_0800 => {
                self.tim4.write(offset, value, now);
                self.ticks += u64::from(offset == 0x40);
            }
            0x4000_0c00 => self.tim5.write(offset, value, now),
            0x4000_1400 => self.tim7.write(offset, value, now),
            0x4000_3000 => self.watchdog.write(offset, value, now),
            0x4000_4800 => self.usart.write(offset, value, now),
            0x4000_7000 => self.pwr.write(offset, value),
            0x4001_0000 => self.tim1.write(offset, value, now),
            0x4001_0400 => self.tim8.write(offset, value, now),
            0x4001_2000 => {
                let starts = self.adc.write(offset, value);
                if starts {
                    self.scan();
                }
            }
            0x4001_3c00 => self.exti.write(offset, value),
            port @ 0x4002_0000..0x4002_2c00 => self.ports[(port - 0x4002_0000) as usize / 0x400].write(offset, value),
            0x4002_3800 => self.rcc.write(offset, value),
            0x4002_3c00 => {
                if let Some((change, stall)) = self.flash.write(offset, value, now) {
                    self.flash_changes.push(change);
                    self.now += stall;
                }
            }
            0x4002_6400 => self.dma2.write(offset, value),
            0x5000_0000..0x5004_0000 => self.usb.write((address - 0x5000_0000) as usize, value),
            0xe004_2000 => self.dbgmcu.write(offset, value),
            0xe000_e000..0xe000_f000 => self.nvic.write((address - 0xe000_e000) as usize, value),
            _ => {}
        }
        self.update();
    }
}
