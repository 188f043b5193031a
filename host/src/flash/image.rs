//! What can be written: firmware and tables, checked before a probe is touched.

use std::path::{Path, PathBuf};

use object::Endianness;
use object::elf;
use object::read::elf::{ElfFile32, ProgramHeader};
use protocol::frame::CRC32;
use protocol::lut::Table;

use super::{BANK_2_LEN, FlashingError};

/// An ELF file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Firmware {
    path: PathBuf,
    bytes: Vec<u8>,
}

impl Firmware {
    /// Reads an ELF file.
    ///
    /// # Errors
    /// [`FlashingError::File`], [`FlashingError::Firmware`] for a file of another kind.
    pub fn read(path: &Path) -> Result<Self, FlashingError> {
        Self::from_bytes(path, read(path)?)
    }

    /// Takes the content of an ELF file.
    ///
    /// # Errors
    /// [`FlashingError::Firmware`] for content of another kind.
    pub fn from_bytes(path: &Path, bytes: Vec<u8>) -> Result<Self, FlashingError> {
        if !bytes.starts_with(b"\x7fELF") {
            return Err(FlashingError::Firmware {
                path: path.into(),
                reason: "it is not an ELF file; build it with `cargo build --profile board --target thumbv7em-none-eabihf -p firmware`".into(),
            });
        }
        Ok(Firmware { path: path.into(), bytes })
    }

    /// Where it came from.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Its content.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// CRC-32 of what it puts into flash, from the start of bank 1 to its last byte, as the board finds it at its start.
    ///
    /// # Errors
    /// [`FlashingError::Firmware`] for an ELF file that puts nothing there.
    pub fn crc(&self) -> Result<u32, FlashingError> {
        Ok(CRC32.checksum(&self.raw()?))
    }

    /// What it puts into flash, from the start of bank 1 to its last byte: a `.bin` file.
    ///
    /// # Errors
    /// [`FlashingError::Firmware`] for an ELF file that puts nothing there.
    pub fn raw(&self) -> Result<Vec<u8>, FlashingError> {
        let wrong = |reason: String| FlashingError::Firmware { path: self.path.clone(), reason };
        let elf = ElfFile32::<Endianness>::parse(&*self.bytes).map_err(|error| wrong(error.to_string()))?;
        let mut image = Vec::new();
        for header in elf.elf_program_headers() {
            let (begin, data) = (header.p_paddr(elf.endian()), header.data(elf.endian(), &*self.bytes));
            let data = data.map_err(|()| wrong("a segment lies beyond its end".into()))?;
            let offset = begin.checked_sub(BANK_1).map(|offset| offset as usize);
            if header.p_type(elf.endian()) != elf::PT_LOAD || data.is_empty() {
                continue;
            }
            let Some(offset) = offset.filter(|offset| offset + data.len() <= BANK_1_LEN) else {
                return Err(wrong(format!("it loads to {begin:#010x}, which is not in bank 1")));
            };
            // Flash between two segments is erased.
            image.resize(image.len().max(offset + data.len()), 0xff);
            image[offset..offset + data.len()].copy_from_slice(data);
        }
        if image.is_empty() {
            return Err(wrong("it puts nothing into flash".into()));
        }
        Ok(image)
    }
}

/// Bank 1 of the flash, where the image lies.
const BANK_1: u32 = 0x0800_0000;
const BANK_1_LEN: usize = 1 << 20;

/// A look-up table that has passed its checks.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TableImage {
    bytes: Vec<u8>,
    hash: [u8; 16],
}

impl TableImage {
    /// Reads and checks a table.
    ///
    /// # Errors
    /// [`FlashingError::File`], [`FlashingError::Table`], [`FlashingError::TableTooLarge`].
    pub fn read(path: &Path) -> Result<Self, FlashingError> {
        Self::from_bytes(path, read(path)?)
    }

    /// Checks the bytes of a table.
    ///
    /// # Errors
    /// [`FlashingError::Table`], [`FlashingError::TableTooLarge`].
    pub fn from_bytes(path: &Path, mut bytes: Vec<u8>) -> Result<Self, FlashingError> {
        let table = Table::parse(&bytes).map_err(|source| FlashingError::Table { path: path.into(), source })?;
        let (length, hash) = (table.bytes().len(), table.hash());
        bytes.truncate(length);
        if length as u64 > BANK_2_LEN {
            return Err(FlashingError::TableTooLarge { path: path.into(), length: length as u64, limit: BANK_2_LEN });
        }
        Ok(TableImage { bytes, hash })
    }

    /// The table.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Its identity, as the board tells it.
    pub fn hash(&self) -> [u8; 16] {
        self.hash
    }
}

fn read(path: &Path) -> Result<Vec<u8>, FlashingError> {
    std::fs::read(path).map_err(|source| FlashingError::File { path: path.into(), source })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn files_of_another_kind_are_named() {
        let error = Firmware::from_bytes("notes.txt".as_ref(), b"hello".to_vec()).unwrap_err();
        assert!(error.to_string().starts_with("notes.txt: not firmware for this board: it is not an ELF file"));
        let error = TableImage::from_bytes("notes.txt".as_ref(), b"hello, world".to_vec()).unwrap_err();
        assert_eq!(error.to_string(), "notes.txt: not a Palpate table: the first 8 bytes are not PALPLUT");
        let error = Firmware::read("no such file.elf".as_ref()).unwrap_err();
        assert!(error.to_string().starts_with("no such file.elf: "));
    }
}
