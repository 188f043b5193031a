//! Upload of a look-up table over the link.

use crate::wire::wire;

/// Most payload bytes in one [`TableChunk`].
pub const CHUNK_LEN: usize = 192;

wire! {
    /// Announces a table.
    pub struct TableBegin {
        /// Length of the whole table, bytes.
        pub length: u32,
        /// CRC-32 of the whole table.
        pub crc: u32,
    }
    /// A piece of the table. Pieces come in order; a repeated piece is acknowledged and ignored.
    pub struct TableChunk {
        /// Offset of the first byte.
        pub offset: u32,
        /// The bytes.
        pub data: heapless::Vec<u8, CHUNK_LEN>,
    }
    /// State of the upload and of the slots.
    pub struct TableState {
        /// The slot in use.
        pub active: Slot,
        /// Hash of the table in use, zero without one.
        pub hash: [u8; 16],
        /// Next byte the upload expects; 0 without an upload.
        pub next_offset: u32,
        /// Length announced; 0 without an upload.
        pub length: u32,
    }
}

wire! {
    /// Where a table lies in flash.
    pub enum Slot {
        /// No valid table.
        None,
        /// First half of bank 2.
        A,
        /// Second half of bank 2.
        B,
        /// The whole of bank 2 (one large table).
        Whole,
    }
}
