//! The board's image: segments and symbols of an ELF file.

use std::path::{Path, PathBuf};

use gimli::{EndianSlice, LittleEndian};
use object::{Object, ObjectSection, ObjectSegment, ObjectSymbol};

type ElfFile32<'a> = object::read::elf::ElfFile32<'a, object::Endianness>;

/// An image that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum ElfError {
    /// The file cannot be read.
    #[error("{}: {source}", .path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The file is no ELF file for the board.
    #[error("{what}: expected an ELF file of the board's image (thumbv7em-none-eabihf)")]
    NotAnImage {
        /// What is wrong with it.
        what: String,
    },
}

/// A loaded image.
#[derive(Debug, Clone)]
pub struct Image {
    /// Bytes by load address.
    pub segments: Vec<(u32, Vec<u8>)>,
    /// Functions of the executor's tasks and their addresses.
    polls: Vec<(String, u32)>,
}

impl Image {
    /// Reads an ELF file.
    ///
    /// # Errors
    /// [`ElfError`].
    pub fn read(path: &Path) -> Result<Self, ElfError> {
        let bytes = std::fs::read(path).map_err(|source| ElfError::File { path: path.into(), source })?;
        Image::parse(&bytes)
    }

    /// Takes an ELF file's bytes.
    ///
    /// # Errors
    /// [`ElfError::NotAnImage`].
    pub fn parse(bytes: &[u8]) -> Result<Self, ElfError> {
        let bad = |what: String| ElfError::NotAnImage { what };
        let file = ElfFile32::parse(bytes).map_err(|e| bad(e.to_string()))?;
        if file.architecture() != object::Architecture::Arm {
            return Err(bad(format!("architecture {:?}", file.architecture())));
        }
        let mut segments = Vec::new();
        for segment in file.segments() {
            let data = segment.data().map_err(|e| bad(e.to_string()))?;
            if !data.is_empty() {
                // Where the bytes lie in flash; `.data` runs elsewhere.
                let address = segment.elf_program_header().p_paddr.get(file.endian());
                segments.push((address, data.to_vec()));
            }
        }
        if !segments.iter().any(|(address, _)| *address == crate::chip::FLASH_BASE) {
            return Err(bad("no segment at 0x08000000".into()));
        }
        let polls = polls(&file).map_err(|e| bad(e.to_string()))?;
        Ok(Image { segments, polls })
    }

    /// Address of the function with which the executor polls the task whose future's type begins with a path that contains `part`; `None` if the
    /// debug information does not name exactly one.
    pub fn poll_of(&self, part: &str) -> Option<u32> {
        let mut found = self.polls.iter().filter(|(name, _)| name.contains(part)).map(|(_, address)| *address);
        found.next().filter(|first| found.all(|other| other == *first))
    }
}

/// Names (with their generic parameters) and addresses of the executor's functions `poll<F>`: the symbols have no parameters, the debug
/// information has both names.
fn polls(file: &ElfFile32<'_>) -> Result<Vec<(String, u32)>, gimli::Error> {
    let section = |id: gimli::SectionId| {
        let data = file.section_by_name(id.name()).and_then(|s| s.data().ok()).unwrap_or(&[]);
        Ok::<_, gimli::Error>(EndianSlice::new(data, LittleEndian))
    };
    let dwarf = gimli::Dwarf::load(section)?;
    let mut polls = Vec::new();
    let mut units = dwarf.units();
    while let Some(header) = units.next()? {
        let unit = dwarf.unit(header)?;
        let mut entries = unit.entries();
        while let Some((_, entry)) = entries.next_dfs()? {
            let text = |attribute| {
                let value = entry.attr_value(attribute).ok().flatten()?;
                Some(dwarf.attr_string(&unit, value).ok()?.to_string_lossy().into_owned())
            };
            if entry.tag() != gimli::DW_TAG_subprogram {
                continue;
            }
            let Some(name) = text(gimli::DW_AT_name).filter(|n| n.starts_with("poll<")) else {
                continue;
            };
            let symbol = text(gimli::DW_AT_linkage_name).and_then(|linkage| file.symbol_by_name(&linkage));
            if let Some(address) = symbol.and_then(|s| u32::try_from(s.address()).ok()) {
                polls.push((name, address & !1));
            }
        }
    }
    Ok(polls)
}
