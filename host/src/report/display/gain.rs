//! What `palpate gain` says about the model of a display.

use crate::extended::display::{CLOSELY, Gain, Missed};

use super::super::diagnosis::percent;
use super::super::figure::{Axis, Figure, Series, Stroke};
use super::super::{Page, number};

/// The part of an error that is gone, with its interval.
pub(super) fn gained(part: f64, part95: Option<(f64, f64)>) -> String {
    let part = percent(part);
    match part95 {
        Some((low, high)) => format!("{part} of the error is gone (95 %: {} to {}).", percent(low), percent(high)),
        None => format!("{part} of the error is gone; repeats do not differ, so nothing tells how sure that is."),
    }
}

/// What would tell a gain closely.
fn advice(gain: &Gain) -> String {
    let runs = gain.runs.len();
    let closely = format!("{} of itself", percent(CLOSELY));
    match (gain.part95, gain.more_runs()) {
        (None, _) => format!("{runs} runs of which none repeats another; give commands twice or more"),
        (Some(_), None) => format!("{runs} runs do not tell it from no gain"),
        (Some(_), Some(0)) => format!("{runs} runs tell it to {closely}"),
        (Some(_), Some(more)) => {
            format!("{runs} runs; about {more} more, as many of every command, would tell it to {closely}")
        }
    }
}

fn base(gain: &Gain) -> &'static str {
    if gain.is_as_diagnosed { "the base law as diagnosed" } else { "the base law fitted to these runs" }
}

/// All that is worth a line; of no channel at all a sentence.
#[must_use]
pub fn lines(gains: &[Gain]) -> Vec<String> {
    if gains.is_empty() {
        return vec!["nothing to predict: the experiment records none of the model's channels".to_owned()];
    }
    let mut out = Vec::new();
    for gain in gains {
        let unit = gain.channel.unit();
        out.push(format!("{:16} {}", gain.channel.word(), gained(gain.part(), gain.part95)));
        out.push(format!("  {:14} {}", "how sure", advice(gain)));
        let (before, after) = (number(gain.base()), number(gain.model()));
        out.push(format!(
            "  {:14} {before} -> {after}  by {}, by the model as it is",
            format!("rms, {unit}"),
            base(gain)
        ));
        if gain.is_as_diagnosed {
            let fitted = number(gain.fitted_base());
            out.push(format!("  {:14} {fitted} {unit} rms of the base law fitted to these very runs", "fitted here"));
        }
    }
    out
}

/// The page.
#[must_use]
pub fn page(gains: &[Gain]) -> Page {
    let mut page = Page::new(
        "Gain of the extended model of a display",
        "Errors of its predictions on recordings that no fit has seen, beside those of the base law. Units: mm, N, A, T.",
    );
    if gains.is_empty() {
        page.warning(&lines(gains).concat());
    }
    for gain in gains {
        let unit = gain.channel.unit();
        page.section(&format!("Channel: {}", gain.channel.word()));
        page.verdict(&gained(gain.part(), gain.part95));
        page.paragraph(&format!("{}.", advice(gain)));
        let row = |name: &str, rms: f64| vec![name.to_owned(), number(rms)];
        let mut rows = vec![row(base(gain), gain.base()), row("the model as it is", gain.model())];
        if gain.is_as_diagnosed {
            rows.push(row("the base law fitted to these runs", gain.fitted_base()));
        }
        page.table(&["law", &format!("rms error, {unit}")], &rows);
        page.figure(
            &runs(gain).svg(),
            "One mark a run, before and after. Runs that repeat a command differ by what no law has. Every command counts alike.",
        );
    }
    page
}

/// Error of every run.
fn runs(gain: &Gain) -> Figure {
    let unit = gain.channel.unit();
    let each = |of: fn(&Missed) -> f64| -> Vec<(f64, f64)> {
        let rms = gain.runs.iter().map(|run| (of(run) / run.samples.max(1) as f64).sqrt());
        rms.enumerate().map(|(at, rms)| ((at + 1) as f64, rms)).collect()
    };
    Figure::new("Error of every run", Axis::new("run"), Axis::new(&format!("rms of measured minus simulated ({unit})")))
        .with(Series::new("base", each(|run| run.before), Stroke::Circles, 0))
        .with(Series::new("extended", each(|run| run.after), Stroke::Dots, 1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::display::channel::Channel;

    fn gain(each: &[(usize, f64, f64)], is_as_diagnosed: bool) -> Gain {
        let run = |(command, before, after): &(usize, f64, f64)| Missed {
            file: "a.csv".to_owned(),
            command: *command,
            samples: 4,
            before: *before,
            after: *after,
            // 0.9 over four samples
            fitted: 4.0 * 0.81,
        };
        Gain::new(Channel::Force, is_as_diagnosed, each.iter().map(run).collect())
    }

    #[test]
    fn the_answer_comes_first_and_says_how_sure_it_is() {
        let told = |each: &[(usize, f64, f64)]| lines(&[gain(each, true)]).join("\n");
        let close = told(&[(0, 4.04, 0.99), (0, 3.96, 1.01), (0, 4.0, 1.0)]);
        assert!(close.starts_with("force            50 % of the error is gone (95 %: "), "{close}");
        assert!(close.contains("3 runs tell it to 10 % of itself") && close.contains("1 -> 0.5"), "{close}");
        assert!(close.contains("0.9 N rms of the base law fitted to these very runs"), "{close}");
        let wide = told(&[(0, 4.0, 1.0), (0, 4.6, 1.1), (0, 3.5, 1.3), (0, 4.2, 1.0)]);
        assert!(
            wide.contains("4 runs; about ") && wide.contains(" more, as many of every command, would tell it"),
            "{wide}"
        );
        let none = told(&[(0, 4.0, 1.0), (0, 1.0, 4.0)]);
        assert!(none.contains("2 runs do not tell it from no gain"), "{none}");
        let alone = lines(&[gain(&[(0, 4.0, 1.0)], false)]).join("\n");
        assert!(
            alone.contains("none repeats another") && alone.contains("by the base law fitted to these runs"),
            "{alone}"
        );
        assert!(lines(&[]).concat().contains("nothing to predict"));
    }
}
