//! What a data file is, by its bytes.

/// Kinds of files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Content {
    /// Lines of text in one of many encodings.
    Text,
    /// Packed, as xlsx and ods are.
    Packed,
    /// The container of an old xls, or of a workbook with a password.
    Compound,
    /// No text at all.
    Other,
}

/// Bytes that are looked at.
const LOOKED_AT: usize = 4096;

impl Content {
    /// What the bytes are, as far as they show it.
    pub fn of(bytes: &[u8]) -> Self {
        if bytes.starts_with(b"PK\x03\x04") {
            Content::Packed
        } else if bytes.starts_with(&[0xd0, 0xcf, 0x11, 0xe0, 0xa1, 0xb1, 0x1a, 0xe1]) {
            Content::Compound
        } else if encoding_rs::Encoding::for_bom(bytes).is_none()
            && utf16(bytes).is_none()
            && bytes.iter().take(LOOKED_AT).any(|byte| *byte == 0)
        {
            Content::Other
        } else {
            Content::Text
        }
    }
}

/// The label of UTF-16 without a mark: western text has a zero in every second byte.
pub(crate) fn utf16(bytes: &[u8]) -> Option<&'static str> {
    let head = bytes.get(..bytes.len().min(LOOKED_AT) & !1).filter(|head| head.len() >= 8)?;
    let zeros = |offset: usize| head.iter().skip(offset).step_by(2).filter(|byte| **byte == 0).count();
    let (even, odd, half) = (zeros(0), zeros(1), head.len() / 2);
    // Three quarters leave room for Greek letters and signs such as the per mille.
    if odd * 4 >= half * 3 && even * 20 <= half {
        Some("utf-16le")
    } else if even * 4 >= half * 3 && odd * 20 <= half {
        Some("utf-16be")
    } else {
        None
    }
}
