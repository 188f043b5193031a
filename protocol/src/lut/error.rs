//! Why bytes are not a table.

/// What [`super::Table::parse`] found wrong, with the value and what was expected.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum TableError {
    /// The first bytes are not the magic.
    NotATable,
    /// A layout version this build cannot read.
    WrongVersion {
        /// Version found.
        found: u16,
    },
    /// Fewer bytes than the header says, or than a header has.
    Truncated {
        /// Bytes expected.
        expected: u32,
        /// Bytes there.
        found: u32,
    },
    /// The header's CRC does not match.
    HeaderCorrupt,
    /// The payload's CRC does not match.
    PayloadCorrupt,
    /// A section lies outside the table, or overlaps the header.
    BadSection {
        /// Which.
        section: &'static str,
    },
    /// An axis breaks a rule.
    BadAxis {
        /// Number of the axis.
        axis: u8,
        /// The rule.
        rule: &'static str,
    },
    /// The product of the column axes is not the number of stored columns.
    ColumnsMismatch {
        /// Product of the axes.
        axes: u32,
        /// Number in the header.
        header: u32,
    },
    /// A column's scale is not a number above zero, or so large that its forces are not finite.
    BadScale {
        /// Number of the column.
        column: u32,
    },
    /// A library material breaks a rule.
    BadMaterial {
        /// Number of the material.
        material: u8,
        /// The rule.
        rule: &'static str,
    },
    /// The error bound holds something that is not a number >= 0.
    BadErrorBound,
}

impl core::fmt::Display for TableError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match *self {
            TableError::NotATable => f.write_str("not a Palpate table: the first 8 bytes are not PALPLUT"),
            TableError::WrongVersion { found } => write!(
                f,
                "table layout version {found}, this build reads versions 1 to {}: make the table again with `palpate lut`",
                super::VERSION
            ),
            TableError::Truncated { expected, found } => {
                write!(f, "table truncated: {found} bytes of {expected}")
            }
            TableError::HeaderCorrupt => f.write_str("table header fails its CRC-32"),
            TableError::PayloadCorrupt => f.write_str("table payload fails its CRC-32"),
            TableError::BadSection { section } => {
                write!(f, "table section `{section}` lies outside the table")
            }
            TableError::BadAxis { axis, rule } => write!(f, "table axis {axis}: {rule}"),
            TableError::ColumnsMismatch { axes, header } => {
                write!(f, "table axes span {axes} columns, the header says {header}")
            }
            TableError::BadScale { column } => {
                write!(
                    f,
                    "table column {column}: scale is not a number above zero, or so large that forces are not finite"
                )
            }
            TableError::BadMaterial { material, rule } => {
                write!(f, "table library material {material}: {rule}")
            }
            TableError::BadErrorBound => f.write_str("table error bound is not a finite number >= 0"),
        }
    }
}

impl core::error::Error for TableError {}
