//! Which build this is: the commit it was made from, and the CRC of what lies in flash.
#![allow(unsafe_code)]

use core::ptr::addr_of;

use protocol::frame::CRC32;
use protocol::message::Build;

/// Where the image begins.
const FLASH: usize = 0x0800_0000;

/// Longest image: what lies before the journals.
const IMAGE_MAX: usize = 0xc_0000;

unsafe extern "C" {
    // Places of the linker's script: begin and end of the variables with a value, and where their values lie in flash.
    static __sdata: u32;
    static __edata: u32;
    static __sidata: u32;
}

/// What this image is. The values of the variables are its last bytes in flash.
pub fn build() -> Build {
    let values = addr_of!(__edata) as usize - addr_of!(__sdata) as usize;
    let length = addr_of!(__sidata) as usize + values - FLASH;
    Build {
        commit: commit(option_env!("PALPATE_COMMIT")),
        modified: option_env!("PALPATE_MODIFIED").is_some(),
        image_crc: checksum(length),
    }
}

/// CRC-32 over the first bytes of the image.
pub fn checksum(length: usize) -> u32 {
    // SAFETY: memory-mapped flash of bank 1 below the journals, always readable and never written while this runs.
    let image = unsafe { core::slice::from_raw_parts(FLASH as *const u8, length.min(IMAGE_MAX)) };
    CRC32.checksum(image)
}

/// The first digits of a commit's hash, zeros without one.
fn commit(hash: Option<&str>) -> [u8; 8] {
    hash.and_then(|hash| hash.as_bytes().first_chunk().copied()).unwrap_or([0; 8])
}
