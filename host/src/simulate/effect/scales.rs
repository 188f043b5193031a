//! Gains of the gauges that record: of the depth, and of the time.

use super::Effect;

/// Recorded over true values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scales {
    /// Of the depth.
    pub depth: f64,
    /// Of all times.
    pub time: f64,
}

impl Scales {
    /// The gains that effects make; two of a kind multiply.
    pub fn of(effects: &[Effect]) -> Self {
        let mut scales = Self { depth: 1.0, time: 1.0 };
        for effect in effects {
            match effect {
                Effect::DepthGain { gain } => scales.depth *= gain,
                Effect::TimeGain { gain } => scales.time *= gain,
                _ => {}
            }
        }
        scales
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gains_multiply_and_are_one_without_an_effect() {
        let two = [Effect::DepthGain { gain: 1.02 }, Effect::DepthGain { gain: 0.5 }, Effect::TimeGain { gain: 1.1 }];
        assert_eq!(Scales::of(&two), Scales { depth: 0.51, time: 1.1 });
        assert_eq!(Scales::of(&[]), Scales { depth: 1.0, time: 1.0 });
    }
}
