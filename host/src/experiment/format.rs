//! How data files are written.

/// Where a wanted column is found in the files.
#[derive(Debug, Clone, PartialEq)]
pub struct Mapping {
    /// Name in the header.
    pub name: String,
    /// Factor from the file's unit to the wanted one.
    pub scale: f64,
    /// +1 or -1: compression and force into the specimen are positive.
    pub sign: f64,
}

/// How the data files are written.
#[derive(Debug, Clone, PartialEq)]
pub struct Format {
    /// Character between cells.
    pub delimiter: u8,
    /// Lines before the header.
    pub skip_lines: usize,
    /// Decimal sign.
    pub decimal: char,
    /// Label of the text encoding.
    pub encoding: String,
}

impl Default for Format {
    fn default() -> Self {
        Self { delimiter: b',', skip_lines: 0, decimal: '.', encoding: "utf-8".to_owned() }
    }
}
