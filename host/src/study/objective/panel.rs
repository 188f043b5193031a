//! The map of one choice of balls, and what is told of it.

use serde_json::{Value, json};

use crate::identify::multistart::Search;
use crate::identify::newton::coordinate::{Kind, Unknown};
use crate::identify::newton::fit::Newton;
use crate::report::number;

/// The map of one choice of balls.
#[derive(Debug, Clone)]
pub struct Panel {
    /// Which balls.
    pub balls: String,
    /// Map, threshold, starts and their paths.
    pub search: Search,
    /// Its finite-element solves.
    pub solves: usize,
    /// Gauss-Newton on the same data.
    pub newton: Newton,
    /// Finite-element solves of that.
    pub newton_solves: usize,
}

impl Panel {
    /// Best end of MultiStart, in the search's coordinates.
    #[must_use]
    pub fn best(&self) -> &[f64] {
        self.search.starts.first().map_or(&[], |start| &start.descent.point)
    }

    /// Distance between MultiStart's and Gauss-Newton's optimum in standard errors, parameter by parameter.
    #[must_use]
    pub fn apart(&self) -> Vec<f64> {
        let ends = self.best().iter().zip(&self.newton.minimum.x);
        ends.zip(&self.newton.errors).map(|((a, b), error)| (a - b).abs() / error).collect()
    }

    /// The largest of these.
    #[must_use]
    pub fn farthest(&self) -> f64 {
        self.apart().into_iter().fold(0.0, f64::max)
    }

    /// Ends that are the best one, and all.
    fn agreeing(&self) -> (usize, usize) {
        let starts = &self.search.starts;
        let best = starts.first().map_or(0.0, |start| start.descent.value);
        (starts.iter().filter(|start| start.descent.value <= best * (1.0 + ONE_END)).count(), starts.len())
    }

    pub(super) fn rows(&self) -> Vec<Vec<String>> {
        let (agreeing, starts) = self.agreeing();
        let apart = self.apart();
        let one = |(axis, unknown): (usize, &Unknown)| {
            let x = self.newton.minimum.x[axis];
            let first = axis == 0;
            let once = |text: String| if first { text } else { String::new() };
            let error = if unknown.is_logarithmic() {
                format!("{} %", number(100.0 * self.newton.errors[axis]))
            } else {
                number(self.newton.errors[axis])
            };
            vec![
                once(self.balls.clone()),
                once(format!("{agreeing} of {starts}")),
                once(self.search.evaluations().to_string()),
                once(self.solves.to_string()),
                unknown.name.clone(),
                number(unknown.value(self.best()[axis])),
                number(unknown.value(x)),
                error,
                number(apart[axis]),
                once(self.newton_solves.to_string()),
            ]
        };
        self.search.unknowns.iter().enumerate().map(one).collect()
    }

    pub(super) fn json(&self) -> Value {
        let named = |point: &[f64]| -> Value {
            self.search.named(point).map(|(name, value)| (name.to_owned(), json!(value))).collect()
        };
        let starts: Vec<Value> = self
            .search
            .starts
            .iter()
            .map(|start| {
                let descent = &start.descent;
                json!({
                    "path": descent.path.iter().map(|p| named(p)).collect::<Vec<_>>(),
                    "evaluations_along": descent.counts,
                    "end": named(&descent.point),
                    "objective_N": descent.value,
                    "evaluations": descent.evaluations,
                    "at_rest": start.at_rest,
                })
            })
            .collect();
        let sample = &self.search.sample;
        json!({
            "balls": self.balls,
            "map": {
                "points": sample.iter().map(|s| named(&s.point)).collect::<Vec<_>>(),
                "objective_N": sample.iter().map(|s| s.objective_n).collect::<Vec<_>>(),
            },
            "threshold_N": self.search.threshold_n,
            "starts": starts,
            "converged": self.search.converged(),
            "best": named(self.best()),
            "fe_solves": self.solves,
            "messages": self.search.messages(),
            "gauss_newton": {
                "end": named(&self.newton.minimum.x),
                "converged": self.newton.converged,
                "fe_solves": self.newton_solves,
                "path": self.newton.path.iter().map(|visit| named(&visit.point)).collect::<Vec<_>>(),
                "standard_errors_from_multistart": self.farthest(),
                "verdicts": self.newton.verdicts.iter().map(|v| v.sentence.clone()).collect::<Vec<_>>(),
            },
        })
    }

    pub(super) fn sentence(&self) -> String {
        let (agreeing, starts) = self.agreeing();
        let ends = if agreeing == starts {
            format!("all {starts} starts end at one value of the objective")
        } else {
            format!("{agreeing} of {starts} starts end at the best value of the objective")
        };
        let found: Vec<String> =
            self.search.named(self.best()).map(|(name, value)| format!("{name} {}", number(value))).collect();
        let rest = if self.search.converged() { "" } else { " (not at rest)" };
        format!(
            "{}: {ends}{rest}, {} after {} solves; Gauss-Newton ends {} standard errors from it after {} solves",
            self.balls,
            found.join(", "),
            self.solves,
            number(self.farthest()),
            self.newton_solves
        )
    }

    /// What can be said of Poisson's ratio or friction, where it was free.
    pub(super) fn verdict_of(&self, kind: Kind) -> Option<String> {
        let axis = self.search.unknowns.iter().position(|unknown| unknown.kind == kind)?;
        let (unknown, span) = (&self.search.unknowns[axis], &self.newton.spans[axis]);
        Some(format!(
            "{}: the simplex ends at {} {}; the 95 % interval of the same data is {} to {}: {}",
            self.balls,
            unknown.name,
            number(unknown.value(self.best()[axis])),
            number(unknown.value(span.low)),
            number(unknown.value(span.high)),
            self.newton.verdicts.get(axis).map_or("", |verdict| &verdict.sentence)
        ))
    }
}

/// Ends within this share of the best objective are one end.
const ONE_END: f64 = 1e-3;
