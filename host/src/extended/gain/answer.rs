//! The gain as JSON and as lines for a terminal.

use serde_json::{Value, json};

use super::{Gain, Palpated, Tally};
use crate::report::number;

fn finite(value: f64) -> Value {
    if value.is_finite() { json!(value) } else { Value::Null }
}

fn tally(tally: &Tally) -> Value {
    json!({
        "palpations": tally.count,
        "recognised": tally.recognised as f64 / tally.count.max(1) as f64,
        "mistaken": tally.mistaken as f64 / tally.count.max(1) as f64,
        "identified": tally.identified as f64 / tally.count.max(1) as f64,
        "mu_error": finite(tally.mu_error), "alpha_error": finite(tally.alpha_error),
        "force_error": finite(tally.force_error),
        "mu_spread": finite(tally.mu_spread), "alpha_spread": finite(tally.alpha_spread),
    })
}

impl Gain {
    /// One JSON object.
    #[must_use]
    pub fn json(&self) -> Value {
        let [before, after] = self.tallies();
        let palpated = |p: &Palpated| {
            json!({
                "outcome": p.outcome, "material": p.named.and_then(|at| self.library.get(at)),
                "mu_MPa": p.found.map(|f| f.0), "alpha": p.found.map(|f| f.1),
                "error_N": finite(p.error_n), "limit_N": finite(p.limit_n),
            })
        };
        let trials: Vec<Value> = self
            .trials
            .iter()
            .map(|t| {
                json!({
                    "file": t.file, "condition": t.condition, "before": palpated(&t.before), "after": palpated(&t.after),
                })
            })
            .collect();
        json!({
            "material": self.material, "library": self.library, "held_out": self.left_out_runs,
            "reference": self.reference, "before": tally(&before), "after": tally(&after),
            "in_table": self.kept, "left_out": self.left_out, "taken_off_recordings": self.freed,
            "palpations": trials, "fe_solves": self.fe_solves, "seconds": self.seconds,
        })
    }

    /// What is compared: its name, before, after.
    #[must_use]
    pub fn rows(&self) -> Vec<[String; 3]> {
        let [before, after] = self.tallies();
        let row = |what: &str, of: &dyn Fn(&Tally) -> String| [what.to_owned(), of(&before), of(&after)];
        let percent = |x: f64| if x.is_finite() { format!("{} %", number(100.0 * x)) } else { "none".to_owned() };
        vec![
            row("recognised", &|t| format!("{} of {}", t.recognised, t.count)),
            row("taken for a neighbour", &|t| format!("{} of {}", t.mistaken, t.count)),
            row("parameters given", &|t| format!("{} of {}", t.identified, t.count)),
            row("error of mu, rms", &|t| percent(t.mu_error)),
            row("error of alpha, rms", &|t| percent(t.alpha_error)),
            row("error of their force", &|t| percent(t.force_error)),
            row("spread of mu", &|t| percent(t.mu_spread)),
            row("spread of alpha", &|t| percent(t.alpha_spread)),
        ]
    }

    /// What of the model was used where, in sentences.
    #[must_use]
    pub fn uses(&self) -> Vec<String> {
        let parts =
            [("in the table", &self.kept), ("not in the table", &self.left_out), ("taken off recordings", &self.freed)];
        parts.iter().flat_map(|(what, list)| list.iter().map(move |sentence| format!("{what:20} {sentence}"))).collect()
    }

    /// Lines for a terminal.
    #[must_use]
    pub fn lines(&self) -> Vec<String> {
        let mut lines = vec![
            format!("{:24} {}; library: {}", "material", self.material, self.library.join(", ")),
            format!("{:24} {}: {}", "palpations", self.trials.len(), self.left_out_runs),
        ];
        let rows = self.rows();
        lines.extend(rows.iter().map(|[what, before, after]| format!("{what:24} {before:>10} -> {after}")));
        lines.push(format!("{:24} {}", "errors relative to", self.reference));
        lines.extend(self.uses());
        lines.push(format!("{:24} {} in {:.1} s", "solves", self.fe_solves, self.seconds));
        lines
    }
}
