//! Times of day and dates to seconds.

use jiff::Unit;
use jiff::civil::Date;

/// Seconds in a day.
const DAY_S: f64 = 86_400.0;

/// Counts from the first time that it is given.
#[derive(Debug, Default)]
pub(crate) struct Clock {
    first_s: Option<f64>,
    last_s: f64,
    /// Days begun since the first time, where the cells have no dates.
    midnights: f64,
}

impl Clock {
    /// Seconds from the first cell to this one; `None` if it holds no time.
    pub fn seconds(&mut self, cell: &str) -> Option<f64> {
        let (dated, mut at_s) = moment(cell)?;
        if !dated {
            at_s += self.midnights * DAY_S;
            // Half a day back is midnight, and no clock that was set.
            if self.first_s.is_some() && at_s < self.last_s - 0.5 * DAY_S {
                self.midnights += 1.0;
                at_s += DAY_S;
            }
        }
        self.last_s = at_s;
        Some(at_s - *self.first_s.get_or_insert(at_s))
    }
}

/// True for a time of day or a date with one: "14:03:22.5", "2024-05-01 14:03:22.5", "01.05.2024 02:03:22 PM".
pub(crate) fn is_clock(cell: &str) -> bool {
    moment(cell).is_some()
}

/// Whether a cell has a date, and its seconds since 1970 or midnight.
fn moment(cell: &str) -> Option<(bool, f64)> {
    if !cell.is_ascii() || !cell.contains(':') {
        return None;
    }
    let (date, time) = match cell.find(['T', 't']).or_else(|| cell.find(' ').filter(|at| !cell[..*at].contains(':'))) {
        Some(at) => (Some(&cell[..at]), &cell[at + 1..]),
        None => (None, cell),
    };
    let seconds = time_of_day(time.trim())?;
    match date {
        None => Some((false, seconds)),
        Some(date) => Some((true, day(date.trim())? * DAY_S + seconds)),
    }
}

/// Seconds since midnight of "14:03:22.5", "2:03:22,5 PM", "14:03:22:500", "03:22.5", "14:03:22+02:00", "140:03:22".
fn time_of_day(text: &str) -> Option<f64> {
    let lower = text.to_ascii_lowercase();
    let (text, noon) = match (lower.strip_suffix("am"), lower.strip_suffix("pm")) {
        (Some(text), _) => (text.trim_end(), Some(0.0)),
        (_, Some(text)) => (text.trim_end(), Some(12.0)),
        _ => (lower.strip_suffix('z').unwrap_or(&lower), None),
    };
    let (text, zone_s) = match text.rfind(['+', '-']) {
        Some(at) if at > 0 => {
            let (hours, minutes) = text[at + 1..].split_once(':').or_else(|| text[at + 1..].split_at_checked(2))?;
            let ahead = 3600.0 * whole(hours)? + 60.0 * whole(minutes)?;
            (&text[..at], if text[at..].starts_with('+') { ahead } else { -ahead })
        }
        _ => (text, 0.0),
    };
    let parts: Vec<&str> = text.split(':').collect();
    let seconds = |text: &str| {
        let text = text.replace(',', ".");
        let plain =
            text.starts_with(|c: char| c.is_ascii_digit()) && text.bytes().all(|b| b.is_ascii_digit() || b == b'.');
        text.parse::<f64>().ok().filter(|s| plain && *s < 60.0)
    };
    let minutes = |text: &str| whole(text).filter(|m| *m < 60.0);
    let (hours, minutes, seconds) = match parts[..] {
        // Without hours only with a fraction: "14:03" may be either.
        [m, s] if s.contains(['.', ',']) => (0.0, whole(m)?, seconds(s)?),
        [h, m, s] => (whole(h)?, minutes(m)?, seconds(s)?),
        [h, m, s, ms] if ms.len() == 3 => (whole(h)?, minutes(m)?, seconds(s)? + 1e-3 * whole(ms)?),
        _ => return None,
    };
    let hours = match noon {
        Some(noon) if (1.0..=12.0).contains(&hours) => hours % 12.0 + noon,
        Some(_) => return None,
        None => hours,
    };
    Some(3600.0 * hours + 60.0 * minutes + seconds - zone_s)
}

/// A whole number of up to six digits.
fn whole(text: &str) -> Option<f64> {
    let digits = !text.is_empty() && text.len() <= 6 && text.bytes().all(|byte| byte.is_ascii_digit());
    text.parse().ok().filter(|_| digits)
}

/// Days since 1970 of "2024-05-01", "2024/05/01", "01.05.2024", "05/01/2024" (the month first, unless it is none).
fn day(text: &str) -> Option<f64> {
    let mark = text.find(['-', '/', '.']).and_then(|at| text[at..].chars().next())?;
    let parts: Vec<i16> = text.split(mark).map(|part| part.parse().ok()).collect::<Option<_>>()?;
    let [a, b, c] = parts[..] else { return None };
    let (year, month, day) = match mark {
        _ if a > 31 => (a, b, c),
        '/' if a <= 12 => (c, a, b),
        _ => (c, b, a),
    };
    let date = Date::new(year, i8::try_from(month).ok()?, i8::try_from(day).ok()?).ok()?;
    let epoch = Date::new(1970, 1, 1).ok()?;
    Some(f64::from(epoch.until((Unit::Day, date)).ok()?.get_days()))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn times_count_from_the_first() {
        let mut clock = Clock::default();
        let cells = ["23:59:59.5", "23:59:59,75", "00:00:00.25", "00:00:01"];
        let found: Vec<f64> = cells.iter().map(|cell| clock.seconds(cell).unwrap()).collect();
        assert_eq!(found, [0.0, 0.25, 0.75, 1.5]);
    }

    #[test]
    fn dates_as_laboratories_write_them() {
        let moments = [
            "2024-05-01 14:03:22.5",
            "2024-05-01T14:03:22.500",
            "2024-05-01T14:03:22.5Z",
            "01.05.2024 14:03:22,5",
            "2024/05/01 2:03:22.5 PM",
            "05/01/2024 14:03:22.5",
            "2024-05-01T16:03:22.5+02:00",
            "2024-05-01 14:03:22:500",
        ];
        for text in moments {
            assert_eq!(moment(text), moment(moments[0]), "{text}");
        }
        for wrong in ["14:03", "25.00", "1:2:3:4:5", "14:61:00", "2024-13-01 00:00:00", "::", "T:", "13:00:00 PM", "é:"]
        {
            assert!(!is_clock(wrong), "{wrong}");
        }
    }
}
