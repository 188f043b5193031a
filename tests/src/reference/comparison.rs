//! The default solver against a reference curve.

use std::fmt::Write as _;

use lut_gen::solid::model::{Indentation, Resolution, Stats};
use lut_gen::solid::solve::Base;

use super::{Reference, ReferenceError};

/// What the product promises, percent of a curve's peak force.
pub const PROMISE_PERCENT: f64 = 0.2;
/// Depth from which curves are compared (mm): before it the other codes' contact is not resolved.
pub const FROM_MM: f64 = 0.5;
/// Depths whose errors the table shows (mm).
pub const SHOWN_MM: [f64; 5] = [0.5, 1.0, 2.0, 3.0, 4.0];

/// One depth of a comparison.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// Depth (mm).
    pub depth_mm: f64,
    /// Our force less the reference's, percent of the reference's peak.
    pub error_percent: f64,
    /// What the error may be, percent of the peak.
    pub allowed_percent: f64,
}

/// A curve of the default solver against a reference.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// What it is compared with.
    pub reference: Reference,
    /// All depths of the reference from [`FROM_MM`] on.
    pub rows: Vec<Row>,
    /// What the solve cost.
    pub stats: Stats,
    /// The solver's own estimate of its relative error.
    pub discretisation: f64,
}

impl Comparison {
    /// Solves the reference's problem with default settings and compares every depth.
    ///
    /// # Errors
    /// [`ReferenceError`] when the solver refuses or fails.
    pub fn of(reference: Reference) -> Result<Self, ReferenceError> {
        let fail = |problem| ReferenceError { file: reference.name.clone(), problem };
        let smooth = Indentation {
            law: reference.law.clone(),
            specimen: reference.specimen,
            ball: reference.ball,
            depth_mm: reference.depth_mm(),
            resolution: Resolution::Standard,
        };
        let mut problem = smooth.simulation();
        problem.interface.friction = reference.friction;
        let compared: Vec<(f64, f64)> = reference.rows.iter().copied().filter(|r| r.0 >= FROM_MM - 1e-9).collect();
        let depths: Vec<f64> = compared.iter().map(|r| r.0).collect();
        let curve = problem.curve(&depths).map_err(|e| fail(e.to_string()))?;
        let peak = reference.peak_n();
        let rows = compared.iter().zip(&curve.force_n).map(|(&(depth_mm, force), ours)| Row {
            depth_mm,
            error_percent: 100.0 * (ours - force) / peak,
            allowed_percent: PROMISE_PERCENT + reference.uncertainty_percent * force / peak,
        });
        Ok(Self { rows: rows.collect(), stats: curve.stats, discretisation: curve.discretisation, reference })
    }

    /// The depth with the largest error, in percent of the peak.
    #[must_use]
    pub fn worst(&self) -> Row {
        self.largest(|r| r.error_percent.abs())
    }

    /// The depth that uses most of what is allowed there.
    #[must_use]
    pub fn tightest(&self) -> Row {
        self.largest(Row::share)
    }

    /// Whether every depth is within what is allowed.
    #[must_use]
    pub fn met(&self) -> bool {
        self.rows.iter().all(|r| r.share() <= 1.0)
    }

    fn largest(&self, size: impl Fn(&Row) -> f64) -> Row {
        let worse = |a: Row, b: &Row| if size(b) > size(&a) || size(b).is_nan() { *b } else { a };
        self.rows.iter().fold(self.rows[0], worse)
    }
}

impl Row {
    /// Part of what is allowed that the error takes; not a number when the error is none.
    #[must_use]
    pub fn share(&self) -> f64 {
        self.error_percent.abs() / self.allowed_percent
    }
}

/// The comparisons as a table in Markdown.
#[must_use]
pub fn table(comparisons: &[Comparison]) -> String {
    let mut out = String::from("| curve | alpha | nu | R | h | base | friction | worst | at | allowed there | share |");
    for d in SHOWN_MM {
        let _ = write!(out, " {d} mm |");
    }
    out.push_str(" unknowns | iterations |\n|---|---|---|---|---|---|---|---|---|---|---|");
    out.push_str(&"---|".repeat(SHOWN_MM.len() + 2));
    out.push('\n');
    for c in comparisons {
        let r = &c.reference;
        let list = |f: &dyn Fn(&lut_gen::solid::law::Term) -> f64| {
            let mut values: Vec<String> = r.law.terms().iter().map(|t| f(t).to_string()).collect();
            values.dedup();
            values.join(", ")
        };
        let (worst, tightest) = (c.worst(), c.tightest());
        let _ = write!(
            out,
            "| {} | {} | {} | {} | {} | {} | {} | {} | {} | {:.2} | {:.0} % |",
            r.name,
            list(&|t| t.alpha),
            list(&|t| t.nu),
            r.ball.radius_mm,
            r.specimen.height_mm,
            if r.specimen.base == Base::Bonded { "bonded" } else { "sliding" },
            r.friction,
            signed(worst.error_percent),
            worst.depth_mm,
            worst.allowed_percent,
            100.0 * tightest.share(),
        );
        for d in SHOWN_MM {
            match c.rows.iter().find(|row| (row.depth_mm - d).abs() < 1e-6) {
                Some(row) => {
                    let _ = write!(out, " {} |", signed(row.error_percent));
                }
                None => out.push_str(" |"),
            }
        }
        let _ = writeln!(out, " {} | {} |", c.stats.unknowns, c.stats.iterations);
    }
    out
}

/// Two decimals with their sign, which zero has not.
fn signed(percent: f64) -> String {
    let text = format!("{percent:+.2}");
    if text == "+0.00" || text == "-0.00" { "0.00".into() } else { text }
}
