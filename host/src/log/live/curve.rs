//! The displayed curve in words, once for each.

use protocol::message::{Curve, DisplayState, Halves};

/// Tells each new curve once.
#[derive(Debug, Clone, Default)]
pub struct CurveNews {
    last: Option<(Curve, u32)>,
}

impl CurveNews {
    /// One line where `halves` display another curve than those before; the library gives names to indices.
    pub fn of(&mut self, halves: &Halves, library: &[String]) -> Option<String> {
        if halves.display != DisplayState::On {
            self.last = None;
            return None;
        }
        let now = Some((halves.curve, halves.of_palpation));
        (std::mem::replace(&mut self.last, now) != now).then(|| curve_text(halves, library))
    }
}

/// The displayed curve, where it comes from, and what is uncertain about it.
fn curve_text(halves: &Halves, library: &[String]) -> String {
    let Curve { low, high, weight } = halves.curve;
    let name = |entry: u8| library.get(usize::from(entry)).cloned().unwrap_or(format!("material {entry}"));
    let curve = if low == high {
        name(low)
    } else {
        format!("{:.0} % {} and {:.0} % {}", 100.0 * (1.0 - weight), name(low), 100.0 * weight, name(high))
    };
    let of = match halves.of_palpation {
        0 => String::new(),
        number => format!(" for palpation {number}"),
    };
    let off = match (halves.departs > 0.0, halves.outside) {
        (false, _) => String::new(),
        (true, false) => format!(", travel within {:.0} %", 100.0 * halves.departs),
        (true, true) => {
            format!(", the nearest there is: the material lies outside, travel off by {:.0} %", 100.0 * halves.departs)
        }
    };
    format!("displaying {curve}{of}{off}")
}

#[cfg(test)]
mod tests {
    use protocol::message::{Parts, State};

    use super::*;

    const HALVES: Halves = Halves {
        tick: 1,
        palpation: State::Idle,
        display: DisplayState::On,
        parts: Parts::Both,
        curve: Curve { low: 0, high: 1, weight: 0.25 },
        share: 1.0,
        of_palpation: 3,
        departs: 0.04,
        outside: false,
        bound_a: 0.1,
    };

    #[test]
    fn each_curve_is_told_once_with_what_is_uncertain_about_it() {
        let library = ["A2".to_owned(), "ICF".to_owned()];
        let mut news = CurveNews::default();
        let mut told = |halves: &Halves| news.of(halves, &library);
        assert_eq!(
            told(&HALVES).as_deref(),
            Some("displaying 75 % A2 and 25 % ICF for palpation 3, travel within 4 %")
        );
        assert_eq!(told(&Halves { tick: 2, ..HALVES }), None);
        let outside = Halves { curve: Curve::of(2), of_palpation: 4, departs: 0.5, outside: true, ..HALVES };
        assert_eq!(
            told(&outside).as_deref(),
            Some(
                "displaying material 2 for palpation 4, the nearest there is: the material lies outside, travel off by 50 %"
            )
        );
        assert_eq!(told(&Halves { display: DisplayState::Waiting, ..HALVES }), None);
        let asked = Halves { curve: Curve::of(1), of_palpation: 0, departs: 0.0, ..HALVES };
        assert_eq!(told(&asked).as_deref(), Some("displaying ICF"));
    }
}
