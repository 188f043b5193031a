//! A DMA controller: streams from a peripheral to memory, halfword by halfword (RM0090 section 10).

/// One stream.
#[derive(Debug, Clone, Copy, Default)]
struct Stream {
    cr: u32,
    remaining: u32,
    whole: u32,
    par: u32,
    memory: u32,
    fcr: u32,
}

/// Flags of a stream in its six bits.
const HALF: u32 = 1 << 4;
const COMPLETE: u32 = 1 << 5;

const EN: u32 = 1;
const CIRC: u32 = 1 << 8;

/// Shift of a stream's flags within its status register.
const SHIFT: [u32; 4] = [0, 6, 16, 22];

/// The controller with its eight streams.
#[derive(Debug, Clone, Default)]
pub struct Dma {
    status: [u32; 2],
    streams: [Stream; 8],
}

impl Dma {
    fn flag(&mut self, stream: usize, flags: u32) {
        self.status[stream / 4] |= flags << SHIFT[stream % 4];
    }

    /// Takes one halfword for a stream: the address it goes to, or `None` if the stream is off.
    pub fn request(&mut self, number: usize) -> Option<u32> {
        let stream = &mut self.streams[number];
        if stream.cr & EN == 0 || stream.remaining == 0 {
            return None;
        }
        let address = stream.memory + 2 * (stream.whole - stream.remaining);
        stream.remaining -= 1;
        let left = stream.remaining;
        let half = left == stream.whole / 2;
        if left == 0 {
            if stream.cr & CIRC != 0 {
                stream.remaining = stream.whole;
            } else {
                stream.cr &= !EN;
            }
            self.flag(number, COMPLETE);
        } else if half {
            self.flag(number, HALF);
        }
        Some(address)
    }

    /// Items of the ring that a stream has filled since the ring's beginning; `None` if it is off.
    pub fn filled(&self, number: usize) -> Option<u32> {
        let stream = &self.streams[number];
        (stream.cr & EN != 0).then(|| stream.whole - stream.remaining)
    }

    /// True while a stream asks for its interrupt.
    pub fn line(&self, number: usize) -> bool {
        let flags = self.status[number / 4] >> SHIFT[number % 4];
        let cr = self.streams[number].cr;
        (flags & HALF != 0 && cr & 1 << 3 != 0) || (flags & COMPLETE != 0 && cr & 1 << 4 != 0)
    }

    /// Value of a register.
    pub fn read(&self, offset: usize) -> u32 {
        match offset {
            0x00 | 0x04 => self.status[offset / 4],
            0x10..0xd0 => {
                let stream = &self.streams[(offset - 0x10) / 0x18];
                match (offset - 0x10) % 0x18 {
                    0x00 => stream.cr,
                    0x04 => stream.remaining,
                    0x08 => stream.par,
                    0x0c => stream.memory,
                    0x14 => stream.fcr,
                    _ => 0,
                }
            }
            _ => 0,
        }
    }

    /// Sets a register.
    pub fn write(&mut self, offset: usize, value: u32) {
        match offset {
            0x08 | 0x0c => self.status[offset / 4 - 2] &= !value,
            0x10..0xd0 => {
                let number = (offset - 0x10) / 0x18;
                let stream = &mut self.streams[number];
                let was_on = stream.cr & EN != 0;
                match (offset - 0x10) % 0x18 {
                    0x00 => {
                        stream.cr = value;
                        if !was_on && value & EN != 0 {
                            stream.whole = stream.remaining;
                        }
                        if was_on && value & EN == 0 {
                            // A stream that is switched off sets its complete flag (RM0090, 10.3.14).
                            self.flag(number, COMPLETE);
                        }
                    }
                    // The count is protected while the stream is on.
                    0x04 if !was_on => stream.remaining = value & 0xffff,
                    0x08 => stream.par = value,
                    0x0c => stream.memory = value,
                    0x14 => stream.fcr = value,
                    _ => {}
                }
            }
            _ => {}
        }
    }
}
