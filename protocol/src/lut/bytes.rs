//! Little-endian reads that cannot fail: past the end they give zero, which no check accepts
//! where it matters (offsets are checked before use).

#[inline]
pub(crate) fn array<const N: usize>(data: &[u8], at: usize) -> [u8; N] {
    let mut out = [0; N];
    if let Some(source) = at.checked_add(N).and_then(|end| data.get(at..end)) {
        out.copy_from_slice(source);
    }
    out
}

#[inline]
pub(crate) fn u16_at(data: &[u8], at: usize) -> u16 {
    u16::from_le_bytes(array(data, at))
}

#[inline]
pub(crate) fn u32_at(data: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(array(data, at))
}

#[inline]
pub(crate) fn f32_at(data: &[u8], at: usize) -> f32 {
    f32::from_le_bytes(array(data, at))
}

/// ASCII name, zero-padded. `None` if it is not printable ASCII followed by zeros, or is empty.
pub(crate) fn name_at(data: &[u8], at: usize, len: usize) -> Option<&str> {
    let field = data.get(at..at.checked_add(len)?)?;
    let used = field.iter().position(|b| *b == 0).unwrap_or(len);
    let (text, padding) = field.split_at(used);
    let printable = text.iter().all(|b| (0x20..0x7f).contains(b));
    (printable && padding.iter().all(|b| *b == 0)).then(|| core::str::from_utf8(text).ok())?
}
