//! A program on a bare Cortex-M4F, without a chip around it: `firmware/src/bits.rs`, the identification alone. It says numbers at a port, and between two of
//! them its instructions are counted.

use std::path::Path;

use object::{Object, ObjectSegment};
use unicorn_engine::{Arch, ArmCpuModel, HookType, Mode, Prot, RegisterARM, Unicorn, uc_error};

use crate::board::BANK_2;
use crate::chip::{FLASH_BASE, FLASH_LEN};
use crate::elf::ElfError;

/// Where the program says its numbers.
const PORT: u64 = 0x4000_0000;

/// Its stack: twice what the board has.
const STACK: u64 = 0x2000_0000;
const STACK_LEN: u64 = 128 << 10;

const PAGE: u64 = 0x1000;

/// Never reached: there is no memory.
const NOWHERE: u64 = 0xf000_0000;

/// After the measured pieces, and at the end.
const END_OF_PIECES: u32 = u32::MAX - 1;
const END: u32 = u32::MAX;

/// The program could not be run.
#[derive(Debug, thiserror::Error)]
pub enum BareError {
    /// The program cannot be used.
    #[error(transparent)]
    Program(#[from] ElfError),
    /// The CPU emulator failed.
    #[error("the CPU emulator failed: {0:?}")]
    Emulator(uc_error),
    /// The program has said less than expected.
    #[error("the program said {found} numbers after its pieces, expected {expected}: did it panic?")]
    Silent {
        /// Numbers said.
        found: usize,
        /// Numbers expected.
        expected: usize,
    },
}

impl From<uc_error> for BareError {
    fn from(error: uc_error) -> Self {
        BareError::Emulator(error)
    }
}

/// What has been said, with the instructions before each number.
#[derive(Debug, Default)]
struct Heard {
    numbers: Vec<(u32, u64)>,
    instructions: u64,
}

/// The four hashes of the program's fingerprint, in the order of [`firmware::fingerprint::Fingerprint`].
///
/// # Errors
/// [`BareError`].
pub fn fingerprint(elf: &Path) -> Result<[u64; 4], BareError> {
    let numbers = run(elf, &[], false)?;
    let hashes: Vec<u64> =
        numbers.as_chunks::<2>().0.iter().map(|[low, high]| low.0 as u64 | (high.0 as u64) << 32).collect();
    hashes.try_into().map_err(|_| BareError::Silent { found: numbers.len(), expected: 8 })
}

/// Instructions of a piece: the slot of its table, its number in the program, and the mean over its samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    /// 1 for slot A, 2 for slot B.
    pub slot: u32,
    /// Number of the piece, from 1.
    pub number: u32,
    /// Instructions, mean of ten samples.
    pub instructions: f64,
}

/// Counts the pieces of the identification over two tables.
///
/// # Errors
/// [`BareError`].
pub fn count(elf: &Path, slot_a: &[u8], slot_b: &[u8]) -> Result<Vec<Piece>, BareError> {
    let heard = run(elf, &[(0, slot_a), (firmware::flash::SLOT_LEN, slot_b)], true)?;
    let mut sums = std::collections::BTreeMap::<u32, (u64, u32)>::new();
    for (mark, instructions) in heard.into_iter().filter(|(mark, _)| mark & 0xff != 0) {
        let (sum, count) = sums.entry(mark).or_default();
        *sum += instructions;
        *count += 1;
    }
    let piece = |(mark, (sum, count)): (u32, (u64, u32))| Piece {
        slot: mark >> 8,
        number: mark & 0xff,
        instructions: sum as f64 / f64::from(count),
    };
    Ok(sums.into_iter().map(piece).collect())
}

/// Runs the program with tables in bank 2: what it says before the end of its pieces if it is counted, or after it.
fn run(elf: &Path, tables: &[(usize, &[u8])], counting: bool) -> Result<Vec<(u32, u64)>, BareError> {
    let bytes = std::fs::read(elf).map_err(|source| ElfError::File { path: elf.into(), source })?;
    let bad = |what: String| BareError::Program(ElfError::NotAnImage { what });
    let file = object::File::parse(&*bytes).map_err(|e| bad(e.to_string()))?;
    let mut uc = Unicorn::new_with_data(Arch::ARM, Mode::THUMB | Mode::MCLASS, Heard::default())?;
    uc.ctl_set_cpu_model(ArmCpuModel::CORTEX_M4 as i32)?;
    let mut pages = std::collections::BTreeSet::new();
    for segment in file.segments().filter(|segment| segment.size() > 0) {
        for page in segment.address() / PAGE..(segment.address() + segment.size()).div_ceil(PAGE) {
            if pages.insert(page) {
                uc.mem_map(page * PAGE, PAGE, Prot::ALL)?;
            }
        }
        uc.mem_write(segment.address(), segment.data().map_err(|e| bad(e.to_string()))?)?;
    }
    let bank = u64::from(FLASH_BASE) + BANK_2 as u64;
    uc.mem_map(bank, (FLASH_LEN - BANK_2) as u64, Prot::READ)?;
    for (offset, table) in tables {
        uc.mem_write(bank + *offset as u64, table)?;
    }
    uc.mem_map(STACK, STACK_LEN, Prot::ALL)?;
    uc.mem_map(PORT, PAGE, Prot::ALL)?;
    for (register, value) in [
        (RegisterARM::SP, STACK + STACK_LEN - 16),
        // The floating-point unit, switched on.
        (RegisterARM::C1_C0_2, 0xf << 20),
        (RegisterARM::FPEXC, 1 << 30),
    ] {
        uc.reg_write(register, value)?;
    }
    if counting {
        uc.add_code_hook(1, 0, |uc, _, _| uc.get_data_mut().instructions += 1)?;
    }
    uc.add_mem_hook(HookType::MEM_WRITE, PORT, PORT + 3, move |uc, _, _, _, value| {
        let number = value as u32;
        let heard = uc.get_data_mut();
        let instructions = std::mem::take(&mut heard.instructions);
        if number == END || number == END_OF_PIECES && counting {
            let _ = uc.emu_stop();
        } else if number == END_OF_PIECES {
            heard.numbers.clear();
        } else {
            heard.numbers.push((number, instructions));
        }
        true
    })?;
    // Ends at the program's last number only.
    uc.emu_start(file.entry() | 1, NOWHERE, 0, 0)?;
    Ok(std::mem::take(&mut uc.get_data_mut().numbers))
}
