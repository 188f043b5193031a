//! What a demo found, as a table for people and as JSON for programs.

use std::fmt;

use protocol::message::{Hello, Outcome, Slot};
use serde_json::{Value, json};

use super::{Displayed, Options, Palpated, Together, felt};
use crate::feel::Felt;
use crate::session::Traffic;

/// How often each foam was taken for each material.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Confusion {
    /// Foams that were there.
    pub truths: Vec<String>,
    /// Materials of the library, and last "none".
    pub answers: Vec<String>,
    /// `counts[truth][answer]`.
    pub counts: Vec<Vec<usize>>,
}

/// The result of a demo.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    /// The board's greeting.
    pub hello: Hello,
    /// Where the table lies.
    pub slot: Slot,
    /// Length of the table, bytes.
    pub table_bytes: usize,
    /// Its error bound, fraction of a curve's peak.
    pub error_bound: f64,
    /// Names of the library's materials.
    pub library: Vec<String>,
    /// Every palpation.
    pub palpated: Vec<Palpated>,
    /// The display.
    pub displayed: Displayed,
    /// Palpation and display in the same ticks.
    pub together: Together,
    /// The displayed material under a hand, on actuator and fluid; empty without magnet or control curve.
    pub felt: Vec<Felt>,
    /// What went over the link.
    pub traffic: Traffic,
    /// Board time, s.
    pub virtual_s: f64,
    /// Wall time of all finite elements, s.
    pub solved_s: f64,
    /// Wall time of the upload, s.
    pub upload_s: f64,
    /// Wall time of everything but the report, s.
    pub seconds: f64,
    /// What was asked for.
    pub options: Options,
    /// Names of the foams on the bench.
    pub foams: Vec<String>,
}

/// Head of the table of palpations.
pub(super) const HEAD: [&str; 12] = [
    "no",
    "true",
    "identified",
    "mu, MPa",
    "mu found",
    "+-",
    "alpha",
    "alpha found",
    "+-",
    "margin",
    "tick, us*",
    "tick max*",
];

/// What stands behind "+-".
pub(super) const STANDARD_ERROR: &str =
    "+- one standard error as the board states it: noise, contact point, zero, table, gain from press to press";

/// What the asterisk says.
pub(super) const HOST_TIME: &str =
    "* duration of the firmware's control tick on this computer (host time), not on the board";

impl Summary {
    /// Fraction of palpations whose foam was named, 0 to 1.
    pub fn recognised(&self) -> f64 {
        let right = self.palpated.iter().filter(|p| p.recognised()).count();
        right as f64 / self.palpated.len().max(1) as f64
    }

    /// Of how many palpations the board stated mu and alpha with errors, and how many of these lie within two errors of the truth: (all, mu,
    /// alpha).
    pub fn within_two_errors(&self) -> (usize, usize, usize) {
        let off = self.palpated.iter().filter_map(Palpated::off);
        off.fold((0, 0, 0), |(all, mu, alpha), off| {
            (all + 1, mu + usize::from(off.0.abs() <= 2.0), alpha + usize::from(off.1.abs() <= 2.0))
        })
    }

    /// How often each foam was taken for each material.
    pub fn confusion(&self) -> Confusion {
        let mut answers = self.library.clone();
        answers.push("none".into());
        let mut counts = vec![vec![0; answers.len()]; self.foams.len()];
        for p in &self.palpated {
            let truth = self.foams.iter().position(|f| *f == p.truth);
            let answer = answers.iter().position(|a| *a == p.identified).unwrap_or(answers.len() - 1);
            if let Some(row) = truth.and_then(|t| counts.get_mut(t)) {
                row[answer] += 1;
            }
        }
        Confusion { truths: self.foams.clone(), answers, counts }
    }

    /// Cells of the table of palpations.
    pub(super) fn rows(&self) -> Vec<Vec<String>> {
        self.palpated.iter().map(row).collect()
    }

    /// One JSON object.
    pub fn json(&self) -> Value {
        let confusion = self.confusion();
        let (all, mu, alpha) = self.within_two_errors();
        let limits = self.displayed.limits();
        let file = |name: &str| self.options.out.join(name).display().to_string();
        json!({
            "palpations": self.palpated.iter().map(palpation_json).collect::<Vec<_>>(),
            "recognised": self.recognised(),
            "within_two_errors": { "palpations": all, "mu": mu, "alpha": alpha },
            "confusion": { "truths": confusion.truths, "answers": confusion.answers, "counts": confusion.counts },
            "display": {
                "material": self.displayed.material,
                "tracking_rms_mm": self.displayed.tracking_rms_mm(),
                "ticks": self.displayed.ticks.json(),
                "touched_ticks_at_coil_limit": limits.at_limit,
                "touched_ticks_marked_unreachable": limits.unreachable,
                "touched_ticks_both": limits.both,
                "limit_is_what_is_marked": limits.agree(),
            },
            "together": {
                "foams": self.together.foams.iter().map(|foam| json!({"true": foam.truth, "shown": foam.shown})).collect::<Vec<_>>(),
                "right": self.together.right(),
            },
            "felt": felt::json(&self.felt),
            "telemetry": self.traffic,
            "telemetry_loss": self.traffic.loss(),
            "table": { "bytes": self.table_bytes, "error_bound": self.error_bound, "slot": format!("{:?}", self.slot) },
            "board": {
                "simulated": self.hello.simulated,
                "firmware": self.hello.firmware_version,
                "time_s": self.virtual_s,
            },
            "seconds": { "finite_elements": self.solved_s, "upload": self.upload_s, "all": self.seconds },
            "files": {
                "report": file("report.html"), "csv": file("telemetry.csv"), "mcap": file("log.mcap"),
            },
        })
    }
}

/// A parameter and its standard error, if one was stated.
type Stated = (f32, Option<f32>);

/// mu and alpha of a palpation that gives them: the estimate's with their errors, or the verdict's.
fn parameters(p: &Palpated) -> Option<(Stated, Stated)> {
    if p.verdict.outcome != Outcome::Identified {
        return None;
    }
    Some(match &p.estimate {
        Some(e) => ((e.mu_mpa, Some(e.mu_error_mpa)), (e.alpha, Some(e.alpha_error))),
        None => ((p.verdict.mu_mpa, None), (p.verdict.alpha, None)),
    })
}

fn row(p: &Palpated) -> Vec<String> {
    let v = &p.verdict;
    let identified = match v.outcome {
        Outcome::Identified | Outcome::GridEdge if !p.identified.is_empty() => p.identified.clone(),
        Outcome::Identified | Outcome::GridEdge => "none".into(),
        other => format!("({other:?})"),
    };
    let given = parameters(p);
    let cell = |x: Option<f32>, digits: usize| x.map_or("-".into(), |x| format!("{x:.digits$}"));
    vec![
        p.number.to_string(),
        p.truth.clone(),
        identified,
        format!("{:.4}", p.true_mu_mpa),
        cell(given.map(|(mu, _)| mu.0), 4),
        cell(given.and_then(|(mu, _)| mu.1), 4),
        format!("{:.2}", p.true_alpha),
        cell(given.map(|(_, alpha)| alpha.0), 2),
        cell(given.and_then(|(_, alpha)| alpha.1), 2),
        format!("{:.3}", v.material.margin),
        format!("{:.1}", v.tick_mean_us),
        v.tick_max_us.to_string(),
    ]
}

fn palpation_json(p: &Palpated) -> Value {
    let (v, given) = (&p.verdict, parameters(p));
    json!({
        "number": p.number,
        "true_material": p.truth,
        "material": if p.identified.is_empty() { Value::Null } else { json!(p.identified) },
        "recognised": p.recognised(),
        "outcome": format!("{:?}", v.outcome),
        "true_mu_MPa": p.true_mu_mpa,
        "mu_MPa": given.map(|(mu, _)| mu.0),
        "mu_error_MPa": given.and_then(|(mu, _)| mu.1),
        "true_alpha": p.true_alpha,
        "alpha": given.map(|(_, alpha)| alpha.0),
        "alpha_error": given.and_then(|(_, alpha)| alpha.1),
        "margin": v.material.margin,
        "grid_margin": v.margin,
        "material_error_N": v.material.error_n,
        "material_limit_N": v.material.limit_n,
        "error_N": v.error_n,
        "height_mm": v.height_mm,
        "samples": v.samples,
        "filter": p.estimate.as_ref().map(|e| json!({
            "mu_MPa": e.mu_mpa, "mu_error_MPa": e.mu_error_mpa, "alpha": e.alpha, "alpha_error": e.alpha_error,
            "height_mm": e.height_mm, "height_error_mm": e.height_error_mm, "noise_N": e.noise_n,
        })),
        "tick_mean_us_host": v.tick_mean_us,
        "tick_max_us_host": v.tick_max_us,
    })
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rows = self.rows();
        write_table(f, &HEAD.map(String::from), &rows)?;
        writeln!(f, "{STANDARD_ERROR}")?;
        writeln!(f, "{HOST_TIME}\n")?;

        let confusion = self.confusion();
        let mut head = vec!["true \\ identified".to_owned()];
        head.extend(confusion.answers.iter().cloned());
        let rows: Vec<Vec<String>> = confusion
            .truths
            .iter()
            .zip(&confusion.counts)
            .map(|(truth, counts)| {
                let cells = counts.iter().map(|c| if *c == 0 { "·".into() } else { c.to_string() });
                std::iter::once(truth.clone()).chain(cells).collect()
            })
            .collect();
        write_table(f, &head, &rows)?;
        let right = self.palpated.iter().filter(|p| p.recognised()).count();
        writeln!(
            f,
            "recognised {right} of {} palpations ({:.1} %) at {} mm/s",
            self.palpated.len(),
            100.0 * self.recognised(),
            self.options.rate_mm_s
        )?;
        let (all, mu, alpha) = self.within_two_errors();
        writeln!(f, "errors     within two of them lie mu {mu} and alpha {alpha} of {all} times")?;
        let t = &self.traffic;
        writeln!(
            f,
            "telemetry  {} of {} records lost, {} of {} frames lost, {} damaged, {} requests repeated",
            t.telemetry_lost,
            t.telemetry_received + t.telemetry_lost,
            t.frames_lost,
            t.frames_received + t.frames_lost,
            t.frames_damaged,
            t.requests_repeated
        )?;
        writeln!(
            f,
            "display    {} to a finger, shaft follows its target within {:.2} mm rms",
            self.displayed.material,
            self.displayed.tracking_rms_mm()
        )?;
        writeln!(f, "           {}", self.displayed.ticks)?;
        writeln!(f, "           {}", self.displayed.limits())?;
        writeln!(f, "together   {}", self.together.sentence())?;
        for (i, sentence) in felt::sentences(&self.felt).iter().enumerate() {
            writeln!(f, "{}{sentence}", if i == 0 { "felt       " } else { "           " })?;
        }
        writeln!(
            f,
            "time       {:.1} s ({:.1} s finite elements, {:.1} s upload of {} kB) for {:.0} s of board time",
            self.seconds,
            self.solved_s,
            self.upload_s,
            self.table_bytes / 1000,
            self.virtual_s
        )?;
        write!(f, "report     {}", self.options.out.join("report.html").display())
    }
}

/// Columns as wide as their widest cell; text to the left, numbers to the right.
fn write_table(f: &mut fmt::Formatter<'_>, head: &[String], rows: &[Vec<String>]) -> fmt::Result {
    let widths: Vec<usize> = head
        .iter()
        .enumerate()
        .map(|(i, h)| {
            let cells = rows.iter().filter_map(|r| r.get(i)).map(|c| c.chars().count());
            cells.chain([h.chars().count()]).max().unwrap_or(0)
        })
        .collect();
    let line = |f: &mut fmt::Formatter<'_>, cells: &[String]| {
        for (i, (cell, width)) in cells.iter().zip(&widths).enumerate() {
            let text = rows.iter().filter_map(|r| r.get(i)).any(|c| c.parse::<f64>().is_err() && c != "·");
            let gap = if i == 0 { "" } else { "  " };
            if text {
                write!(f, "{gap}{cell:<width$}")?;
            } else {
                write!(f, "{gap}{cell:>width$}")?;
            }
        }
        writeln!(f)
    };
    line(f, head)?;
    writeln!(f, "{}", "─".repeat(widths.iter().sum::<usize>() + 2 * widths.len().saturating_sub(1)))?;
    for row in rows {
        line(f, row)?;
    }
    Ok(())
}
