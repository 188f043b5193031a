//! From values to pixels, and where the ticks are.

use super::axis::Axis;

/// With fewer ticks nobody reads a value off an axis.
const LEAST_TICKS: f64 = 3.0;

/// A linear or logarithmic mapping of an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Scale {
    low: f64,
    high: f64,
    log: bool,
    /// Pixel of the low end.
    pub low_px: f64,
    /// Pixel of the high end.
    pub high_px: f64,
}

impl Scale {
    /// A scale over the axis' range, or over the values with a little room.
    pub fn fitting(axis: &Axis, values: impl Iterator<Item = f64>, px: (f64, f64)) -> Self {
        let (low, high) = axis.range.unwrap_or_else(|| {
            let usable = values.filter(|v| v.is_finite() && (!axis.log || *v > 0.0));
            let (low, high) = usable.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
            if low > high {
                return (if axis.log { 0.1 } else { 0.0 }, 1.0);
            }
            if axis.log {
                return (low / 1.1, high * 1.1);
            }
            let room = 0.04 * (high - low).max(1e-9 * high.abs()).max(1e-12);
            // A quantity that starts at zero keeps its zero.
            (if low >= 0.0 && low < 0.2 * high { 0.0 } else { low - room }, high + room)
        });
        Self { low, high: if high > low { high } else { low + 1.0 }, log: axis.log, low_px: px.0, high_px: px.1 }
    }

    /// Pixel of a value.
    pub fn px(&self, value: f64) -> f64 {
        let share = if self.log {
            (value.max(f64::MIN_POSITIVE) / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        };
        self.low_px + share.clamp(-10.0, 10.0) * (self.high_px - self.low_px)
    }

    /// Round values inside the range, about one every 55 pixels.
    pub fn ticks(&self) -> Vec<f64> {
        self.ticks_every(55.0)
    }

    /// Round values inside the range, not closer than some pixels.
    pub fn ticks_every(&self, pixels: f64) -> Vec<f64> {
        let most = ((self.high_px - self.low_px).abs() / pixels).max(2.0);
        if self.log {
            return self.log_ticks(most);
        }
        let rough = (self.high - self.low) / most;
        let power = 10_f64.powf(rough.log10().floor());
        // the widest steps that leave as many ticks as a scale needs
        let inside = |step: f64| (self.high / step + 1e-9).floor() - (self.low / step - 1e-9).ceil() + 1.0;
        let steps = [10.0, 5.0, 2.0, 1.0, 0.5].map(|m| m * power);
        let wide = steps.iter().rev().find(|s| **s >= rough).copied().unwrap_or(10.0 * power);
        let step = steps.into_iter().find(|s| *s <= wide && inside(*s) >= LEAST_TICKS).unwrap_or(wide);
        let first = (self.low / step - 1e-9).ceil();
        (0..40)
            .map(|i| (first + f64::from(i)) * step)
            .take_while(|value| *value <= self.high + 1e-9 * step)
            .map(|value| if value.abs() < 1e-9 * step { 0.0 } else { value })
            .collect()
    }

    fn log_ticks(&self, most: f64) -> Vec<f64> {
        let decades = (self.high / self.low).log10();
        let mantissas: &[f64] = if decades > most {
            &[1.0]
        } else if 3.0 * decades > most {
            &[1.0, 3.0]
        } else {
            &[1.0, 2.0, 5.0]
        };
        let (from, to) = (self.low.log10().floor() as i32, self.high.log10().ceil() as i32);
        (from..=to)
            .flat_map(|power| mantissas.iter().map(move |m| m * 10_f64.powi(power)))
            .filter(|value| (self.low..=self.high).contains(value))
            .collect()
    }
}

/// A number with four digits at most and no trailing zeros; "unbounded" for an infinite one, "unknown" for none.
pub fn number(value: f64) -> String {
    if value.is_nan() {
        return "unknown".to_owned();
    }
    if value.is_infinite() {
        return if value > 0.0 { "unbounded" } else { "-unbounded" }.to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let magnitude = value.abs().log10().floor() as i32;
    if !(-5..6).contains(&magnitude) {
        return format!("{value:.1e}");
    }
    let digits = usize::try_from((3 - magnitude).max(0)).unwrap_or(0);
    let text = format!("{value:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_number_is_not_zero() {
        let shown = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0, -0.5].map(number);
        assert_eq!(shown, ["unknown", "unbounded", "-unbounded", "0", "-0.5"]);
    }

    #[test]
    fn ticks_are_round_and_inside() {
        let axis = Axis::new("x").over(-0.013, 0.0471);
        let scale = Scale::fitting(&axis, std::iter::empty(), (0.0, 500.0));
        let names: Vec<String> = scale.ticks().into_iter().map(number).collect();
        assert_eq!(names, ["-0.01", "0", "0.01", "0.02", "0.03", "0.04"]);
        let narrow = Scale::fitting(&Axis::new("x").over(-0.0093, 0.0095), std::iter::empty(), (200.0, 0.0));
        let names: Vec<String> = narrow.ticks().into_iter().map(number).collect();
        assert_eq!(names, ["-0.005", "0", "0.005"]);
        let log = Axis::new("x").over(0.012, 0.7).logarithmic();
        let scale = Scale::fitting(&log, std::iter::empty(), (0.0, 500.0));
        let names: Vec<String> = scale.ticks().into_iter().map(number).collect();
        assert_eq!(names, ["0.02", "0.05", "0.1", "0.2", "0.5"]);
    }

    #[test]
    fn numbers_are_short() {
        let shown = [0.22, 10.526, 1234.0, 0.000123, 1e-9, 0.1 + 0.2].map(number);
        assert_eq!(shown, ["0.22", "10.53", "1234", "0.000123", "1.0e-9", "0.3"]);
    }
}
