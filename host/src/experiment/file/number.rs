//! Cells to numbers.

use super::super::error::Problem;
use super::super::format::Format;

/// How numbers are written in a file.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Digits {
    /// Decimal sign.
    pub decimal: char,
    /// Mark between thousands.
    pub thousands: Option<char>,
}

/// Why a cell is no number; made into a [`Problem`] only where it matters, because other columns may hold anything.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum NotNumber {
    Empty,
    Text,
    Nan,
    Infinite,
}

impl NotNumber {
    /// The mistake in words that name the cell.
    pub fn problem(self, cell: &str) -> Problem {
        match self {
            NotNumber::Empty => Problem::EmptyCell,
            NotNumber::Text => Problem::NotANumber(cell.to_owned()),
            NotNumber::Nan => Problem::Nan(cell.to_owned()),
            NotNumber::Infinite => Problem::Infinite(cell.to_owned()),
        }
    }
}

impl Digits {
    /// Those of a format.
    pub fn of(format: &Format) -> Self {
        Self { decimal: format.decimal, thousands: format.thousands }
    }

    /// The number in a cell.
    pub fn number(self, cell: &str) -> Result<f64, NotNumber> {
        if cell.is_empty() {
            return Err(NotNumber::Empty);
        }
        let parsed = if self.decimal == '.' && self.thousands.is_none() {
            cell.parse()
        } else {
            // On the stack: files have millions of cells.
            let mut plain = [0_u8; 48];
            let text = self.plain(cell, &mut plain).ok_or(NotNumber::Text)?;
            text.parse()
        };
        let value: f64 = parsed.map_err(|_| NotNumber::Text)?;
        if value.is_nan() {
            return Err(NotNumber::Nan);
        }
        if value.is_infinite() {
            return Err(NotNumber::Infinite);
        }
        Ok(value)
    }

    /// True for a cell that holds a number.
    pub fn are(self, cell: &str) -> bool {
        self.number(cell).is_ok()
    }

    /// The number as a computer writes it; `None` if a mark stands where none can.
    fn plain<'a>(self, cell: &str, room: &'a mut [u8; 48]) -> Option<&'a str> {
        let mut length = 0;
        // Digits since the last mark; the first group may have fewer than three.
        let (mut since_mark, mut marked, mut whole) = (0, false, true);
        for letter in cell.chars() {
            let letter = if whole && Some(letter) == self.thousands {
                if since_mark == 0 || since_mark > 3 || (marked && since_mark != 3) {
                    return None;
                }
                (since_mark, marked) = (0, true);
                continue;
            } else if letter == self.decimal {
                '.'
            } else if letter == '.' {
                // A point in a file with decimal commas is a mark or a slip: refuse both.
                return None;
            } else {
                letter
            };
            if whole && !letter.is_ascii_digit() && !matches!(letter, '+' | '-') {
                whole = false;
                if marked && since_mark != 3 {
                    return None;
                }
            }
            since_mark += usize::from(letter.is_ascii_digit());
            *room.get_mut(length)? = u8::try_from(letter).ok()?;
            length += 1;
        }
        if whole && marked && since_mark != 3 {
            return None;
        }
        std::str::from_utf8(&room[..length]).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimal_signs_and_marks() {
        let comma = Digits { decimal: ',', thousands: None };
        assert_eq!(comma.number("-1,5E-03"), Ok(-0.0015));
        assert_eq!(comma.number("1.5"), Err(NotNumber::Text));
        assert_eq!(comma.number("1.234,5"), Err(NotNumber::Text));
        let marked = Digits { decimal: ',', thousands: Some('.') };
        assert_eq!(marked.number("-1.234.567,25"), Ok(-1_234_567.25));
        assert_eq!(marked.number("12.345"), Ok(12_345.0));
        for wrong in ["1.5", "1234.567", "1.23,5", ".123", "1.", "1.234.5"] {
            assert_eq!(marked.number(wrong), Err(NotNumber::Text), "{wrong}");
        }
        let point = Digits { decimal: '.', thousands: Some('\'') };
        assert_eq!(point.number("1'000.5"), Ok(1000.5));
        assert_eq!(point.number("nan"), Err(NotNumber::Nan));
        assert_eq!(point.number("1e999"), Err(NotNumber::Infinite));
    }
}
