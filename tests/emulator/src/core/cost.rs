//! How long the core takes for a block of instructions.

use crate::chip::FLASH_BASE;

/// Core clocks an instruction, times two. The Cortex-M4 needs 1 to 2 clocks for most instructions,
/// more for loads in a row, taken branches and divisions, and the flash's instruction cache and
/// prefetch, which the image switches on, hide most of the 5 wait states: 1.5 on average is an
/// assumption.
const HALF_CLOCKS: u64 = 3;

/// The same with wait states and nothing to hide them: 1.9 times as many were measured on this very
/// NUCLEO (zephyrproject-rtos/zephyr, pull request 36277: 499 clocks for 263).
const SLOW_HALF_CLOCKS: u64 = 6;

/// Instructions of every block of the code in flash, counted once a block.
#[derive(Debug, Clone)]
pub struct Cost {
    code: Vec<u8>,
    /// By halfword of the code: bytes and instructions of the block that begins there.
    blocks: Vec<(u16, u16)>,
    /// Instructions executed.
    pub instructions: u64,
    /// Half clocks an instruction in place of those above, to see what a slower core would do.
    pub assumed: Option<u64>,
}

impl Cost {
    /// For code that begins at the flash's base.
    pub fn new(code: Vec<u8>) -> Self {
        Cost { blocks: vec![(0, 0); code.len() / 2], code, instructions: 0, assumed: None }
    }

    /// Half core clocks of a block of `size` bytes at `address`; `slow` if its fetches wait for the
    /// flash.
    pub fn half_clocks(&mut self, address: u32, size: u32, slow: bool) -> u64 {
        let at = address.wrapping_sub(FLASH_BASE) as usize / 2;
        let count = match self.blocks.get(at) {
            Some(&(known, count)) if u32::from(known) == size => u64::from(count),
            Some(_) => {
                let count = instructions(&self.code[2 * at..], size as usize);
                self.blocks[at] = (size as u16, count as u16);
                count
            }
            None => u64::from(size / 2),
        };
        self.instructions += count;
        count * self.assumed.unwrap_or(if slow { SLOW_HALF_CLOCKS } else { HALF_CLOCKS })
    }

    /// Addresses of the halfwords that read `wanted`: where an instruction of that encoding may be.
    pub fn halfwords(&self, wanted: u16) -> Vec<u32> {
        let halves = self.code.as_chunks::<2>().0.iter().enumerate();
        let hits = halves.filter(|(_, h)| u16::from_le_bytes(**h) == wanted);
        hits.map(|(i, _)| FLASH_BASE + 2 * i as u32).collect()
    }
}

/// Number of Thumb instructions in `size` bytes of code.
fn instructions(code: &[u8], size: usize) -> u64 {
    let (mut at, mut count) = (0, 0);
    while at < size {
        let first = code.get(at + 1).map_or(0, |high| high >> 3);
        // ARMv7-M ARM, A5.1: 0b11101, 0b11110 and 0b11111 begin a 32-bit instruction.
        at += if first >= 0b11101 { 4 } else { 2 };
        count += 1;
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thumb_instructions_of_both_lengths_are_counted() {
        // push {r7, lr}; bl (32 bit); nop; wfe
        let code = [0x80, 0xb5, 0x00, 0xf0, 0x01, 0xf8, 0x00, 0xbf, 0x20, 0xbf];
        assert_eq!(instructions(&code, code.len()), 4);
        let mut cost = Cost::new(code.to_vec());
        assert_eq!(cost.half_clocks(FLASH_BASE, 6, false), 2 * HALF_CLOCKS);
        assert_eq!(cost.half_clocks(FLASH_BASE, 10, true), 4 * SLOW_HALF_CLOCKS);
        assert_eq!((cost.instructions, cost.halfwords(0xbf20)), (6, vec![FLASH_BASE + 8]));
    }
}
