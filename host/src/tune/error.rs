//! Why no gains were found. The texts are part of the interface.

use miette::Diagnostic;

use super::frequency::Margins;
use super::gains::Gains;
use super::limits::Limits;
use super::step::Step;

/// What is in the way.
#[derive(Debug, thiserror::Error, Diagnostic)]
pub enum TuneError {
    /// The plant runs away by itself.
    #[error(
        "the plant is not stable: it has a pole at {real:.4} +- {imaginary:.4}i 1/s; expected poles with negative real parts, or one at 0"
    )]
    #[diagnostic(help("a pole's sign is often lost in copying: s^2 + 23.4 s + 86 has its poles at -18.8 and -4.56"))]
    Unstable {
        /// Real part, 1/s.
        real: f64,
        /// Imaginary part, 1/s.
        imaginary: f64,
    },
    /// The poles of the plant were not found.
    #[error("the poles of the plant cannot be computed; expected coefficients that are numbers of like size")]
    NoRoots,
    /// No point could be scored.
    #[error("no gains can be scored on this plant; expected a plant that a step can be computed of")]
    NoStart,
    /// The command cannot hold the target.
    #[error(
        "a shaft {step_mm} mm out takes {needed_v:.4} V at rest, and the limit is {command_v} V; expected more than that"
    )]
    #[diagnostic(help("raise --u-max, or take a smaller --step"))]
    TooWeak {
        /// Command at rest, V.
        needed_v: f64,
        /// Limit, V.
        command_v: f64,
        /// Step, mm.
        step_mm: f64,
    },
    /// The plant moves the other way.
    #[error("the plant moves {gain:.4} mm a V: a positive command pulls the shaft in; expected a positive gain")]
    #[diagnostic(help("change the sign of the numerator and swap the actuator's wires"))]
    Backwards {
        /// mm/V.
        gain: f64,
    },
    /// Too many coefficients vary.
    #[error("{found} coefficients of the plant vary; expected at most {most} for a robust search")]
    #[diagnostic(help("leave the intervals of those out that are known best"))]
    TooMany {
        /// In the box.
        found: usize,
        /// At most.
        most: usize,
    },
    /// Appendix E knows one loop.
    #[error("Appendix E is a continuous loop without dead time; expected --loop continuous and a plant without delay")]
    OtherLoop,
    /// Flaws need a sampled loop.
    #[error(
        "a limit of speed, friction, backlash and a cut command are computed for sampled loops; expected --loop sampled or delayed"
    )]
    #[diagnostic(help("--ideal leaves the flaws out"))]
    NotContinuous,
    /// No gains keep the limits.
    #[error("{}", infeasible(gains, step, margins, limits))]
    #[diagnostic(help("these gains keep {}", options(step, margins, limits, *exactly)))]
    Infeasible {
        /// Those that break the limits least.
        gains: Box<Gains>,
        /// Their step: the worst of all plants that count.
        step: Box<Step>,
        /// Their margins on the plant itself.
        margins: Box<Margins>,
        /// The limits.
        limits: Box<Limits>,
        /// Overshoot and undershoot are to be at their limits (Appendix E).
        exactly: bool,
    },
}

/// A number rounded up in its third digit after the point, so that a limit of this size is kept.
fn up(value: f64) -> f64 {
    (1000.0 * value + 1e-6).ceil() / 1000.0
}

fn infeasible(gains: &Gains, step: &Step, margins: &Margins, limits: &Limits) -> String {
    let Limits { command_v, overshoot, undershoot, .. } = limits;
    let mut asked = vec![
        format!("overshoot {overshoot} (nearest {:.4})", step.overshoot),
        format!("undershoot {undershoot} (nearest {:.4})", step.undershoot),
    ];
    if !limits.cut {
        asked.insert(0, format!("{command_v} V (nearest {:.4} V)", step.command));
    }
    if let Some(most) = limits.sensitivity {
        asked.push(format!("sensitivity {most} (nearest {:.4})", margins.peak_sensitivity));
    }
    if let Some(least) = limits.phase_deg {
        asked.push(format!("phase margin {least} degrees (nearest {:.2})", margins.phase_margin_deg.unwrap_or(180.0)));
    }
    asked.push(format!("a mean error below 10 % over 100 s (nearest {:.1} %)", step.cost));
    let Gains { kp, ki, kd, n } = gains;
    format!(
        "no gains were found that keep {}; the nearest are kp {kp:.4}, ki {ki:.4}, kd {kd:.5}, n {n:.3}",
        asked.join(", ")
    )
}

/// Options under which the nearest gains are good.
fn options(step: &Step, margins: &Margins, limits: &Limits, exactly: bool) -> String {
    let mut all = Vec::new();
    if !limits.cut && step.command > limits.command_v {
        all.push(format!("--u-max {}", up(step.command)));
    }
    let other = |own: f64, limit: f64| own > limit || (exactly && own < limit - 1e-3);
    if other(step.overshoot, limits.overshoot) {
        all.push(format!("--overshoot {}", up(step.overshoot)));
    }
    if other(step.undershoot, limits.undershoot) {
        all.push(format!("--undershoot {}", up(step.undershoot)));
    }
    if limits.sensitivity.is_some_and(|most| margins.peak_sensitivity > most) {
        all.push(format!("--sensitivity {}", up(margins.peak_sensitivity)));
    }
    if let (Some(least), Some(own)) = (limits.phase_deg, margins.phase_margin_deg)
        && own < least
    {
        all.push(format!("--phase {:.1}", (10.0 * own).floor() / 10.0));
    }
    if all.is_empty() { "limits that are 0.001 wider".to_owned() } else { all.join(" ") }
}
