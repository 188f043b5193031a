//! From a recording to an actuator: order, parameters, and what the recording does not tell.

use super::begin;
use super::choose::{CLEARLY, Tried, chosen};
use super::fit::{Record, ends};
use super::interval::{Known, Known95, intervals, least_rate};
use super::law::{Law, Parameter, Structure};
use super::noise::autocorrelation;
use super::push::count;

/// Lags of the autocorrelation that is shown.
pub const SHOWN_LAGS: usize = 60;
/// Share of the rows that may lie at one end of the travel before the end of a stroke is suspected.
const AT_END: f64 = 0.02;

/// An actuator as a recording tells it.
#[derive(Debug, Clone)]
pub struct Identified {
    /// The recording, with the command turned round where `inverted`.
    pub record: Record,
    /// A command upwards moves the shaft down: the gain is negative, and all parameters are those of the turned command.
    pub inverted: bool,
    /// All structures that were tried, the simplest first.
    pub tried: Vec<Tried>,
    /// The chosen one.
    pub at: usize,
    /// Its parameters with their intervals.
    pub known: Known95,
    /// Least rate limit, mm/s, one-sided 95 %, where the recording reaches none.
    pub least_rate_mm_s: Option<f64>,
}

/// Identifies; `progress` is told how many structures are done. `None` where nothing can be fitted, as of a shaft that does not answer.
#[must_use]
pub fn identify(record: &Record, structures: &[Structure], progress: &dyn Fn(usize)) -> Option<Identified> {
    let best = structures.iter().filter_map(|s| begin::linear(record, *s).into_iter().next());
    let (_, law) = best.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let inverted = law.gain < 0.0;
    let mut record = record.clone();
    if inverted {
        record.command_v.iter_mut().for_each(|v| *v = -*v);
    }
    let (at, tried) = chosen(&record, structures, progress)?;
    let best = tried.get(at)?;
    let known = intervals(&record, &best.fitted);
    let least_rate_mm_s =
        (!best.is_limited()).then(|| least_rate(&record, &best.fitted, known.rough.sqrt() * known.sd_mm));
    Some(Identified { record, inverted, at, known, least_rate_mm_s, tried })
}

impl Identified {
    /// The chosen fit.
    #[must_use]
    pub fn best(&self) -> &Tried {
        &self.tried[self.at]
    }

    /// The chosen law; of an inverted actuator that of the turned command.
    #[must_use]
    pub fn law(&self) -> &Law {
        &self.best().fitted.law
    }

    /// A parameter, if it was searched.
    #[must_use]
    pub fn parameter(&self, parameter: Parameter) -> Option<&Known> {
        self.known.parameters.iter().find(|known| known.parameter == parameter)
    }

    /// Autocorrelation of the residual.
    #[must_use]
    pub fn correlation(&self) -> Vec<f64> {
        let residual = &self.best().fitted.residual_mm;
        autocorrelation(residual, SHOWN_LAGS.min(residual.len() / 4))
    }

    /// What one should know before using the numbers, a sentence each.
    #[must_use]
    pub fn remarks(&self) -> Vec<String> {
        let mut told = vec![self.order_told()];
        if let Some(bound) = self.least_rate_mm_s {
            let fastest = self.record.speed_mm_s();
            told.push(format!(
                "No rate limit is reached: the shaft went up to {fastest:.3} mm/s, so the limit is at least {bound:.3} mm/s (95 %). \
                 A larger step would show it."
            ));
        }
        for (parameter, name, more) in [
            (
                Parameter::Friction,
                "Friction",
                "steps smaller than a hundredth of the travel and a slow triangle would show it",
            ),
            (Parameter::Play, "Backlash", "reversals sampled faster would show it"),
            (Parameter::Delay, "The delay", "faster sampling would show it"),
        ] {
            if let Some(known) = self.parameter(parameter).filter(|known| known.interval95.0 <= 0.0) {
                let (high, unit) = (known.interval95.1, unit(parameter));
                told.push(if high.is_finite() {
                    format!("{name} is not told from none: it is at most {high:.3} {unit} (95 %); {more}.")
                } else {
                    format!("{name} cannot be known from this recording; {more}.")
                });
            }
        }
        told.extend(self.residual_told());
        told.extend(self.stroke_told());
        if self.inverted {
            told.push("A command upwards moves the shaft down: the gain is negative.".to_owned());
        }
        told
    }

    fn order_told(&self) -> String {
        let best = self.best();
        let name = best.fitted.law.structure.name();
        let rivals = self.tried.iter().enumerate().filter(|(at, _)| *at != self.at);
        let nearest = rivals.min_by(|a, b| a.1.bic.total_cmp(&b.1.bic));
        match nearest {
            None => format!("The order was given: {name}."),
            Some((_, rival)) => {
                let (other, far) = (rival.fitted.law.structure.name(), rival.bic - best.bic);
                if far.abs() < CLEARLY {
                    format!(
                        "Order: {name}. \"{other}\" describes the recording as well (BIC differs by {far:.1}), and is more complex."
                    )
                } else {
                    format!(
                        "Order: {name}. The nearest rival, \"{other}\", is worse by {far:.0} in BIC; {CLEARLY} is strong evidence."
                    )
                }
            }
        }
    }

    fn residual_told(&self) -> Option<String> {
        let fit = &self.best().fitted;
        let step = count(&self.record.position_mm);
        let sd = (fit.residual_mm.iter().map(|r| r * r).sum::<f64>() / fit.residual_mm.len() as f64).sqrt();
        let (is, allowed) = self.known.whiteness;
        if is > allowed {
            return Some(format!(
                "The residual of {sd:.4} mm is not white (Ljung-Box {is:.1} per degree of freedom, white noise stays below {allowed:.1}): \
                 something moves the shaft that the law does not know. The intervals take the correlation into account, not the bias that \
                 a missing cause may have."
            ));
        }
        if !fit.noise.coefficients.is_empty() {
            let order = fit.noise.coefficients.len();
            return Some(format!(
                "The residual of {sd:.4} mm is noise that depends on its last {order} samples; beyond that it is white."
            ));
        }
        let counted = step / 12.0_f64.sqrt();
        let share = if counted < sd {
            format!("{:.0} % of its variance", 100.0 * (counted / sd).powi(2))
        } else {
            "all of it".to_owned()
        };
        Some(format!("The residual of {sd:.4} mm is white; the sensor's step of {step:.4} mm makes {share}."))
    }

    /// A shaft that rests at an end of its travel although commands differ.
    fn stroke_told(&self) -> Option<String> {
        let (low, high) = ends(&self.record.position_mm);
        let near = 0.002 * (high - low);
        let suspect = |end: f64| {
            let there: Vec<f64> = (0..self.record.position_mm.len())
                .filter(|k| (self.record.position_mm[*k] - end).abs() <= near)
                .map(|k| self.record.command_v[k])
                .collect();
            let (a, b) = ends(&there);
            let (all_low, all_high) = ends(&self.record.command_v);
            there.len() as f64 > AT_END * self.record.position_mm.len() as f64 && b - a > 0.1 * (all_high - all_low)
        };
        let end = [low, high].into_iter().find(|end| suspect(*end))?;
        Some(format!(
            "The shaft rests at {end:.2} mm under commands that differ: if that is the end of its stroke, leave those rows out; the law \
             knows no stops."
        ))
    }
}

/// Unit of a parameter that may be zero.
fn unit(parameter: Parameter) -> &'static str {
    match parameter {
        Parameter::Friction => "V",
        Parameter::Delay => "s",
        _ => "mm",
    }
}
