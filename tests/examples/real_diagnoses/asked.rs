//! What `palpate diagnose` says of a recording, as a table for the page.

use palpate::diagnose::compression;
use palpate::diagnose::display::ChannelDiagnosis;
use palpate::diagnose::table;
use palpate::report::number;
use tests::document;

/// A row of a table.
fn row(what: &str, told: String) -> Vec<String> {
    vec![what.to_owned(), told]
}

/// Parameters with their intervals.
fn parameters(list: &[(&'static str, f64, (f64, f64))]) -> String {
    let one = |(name, value, (low, high)): &(&'static str, f64, (f64, f64))| {
        format!("{name} {} ({} to {})", number(*value), number(*low), number(*high))
    };
    list.iter().map(one).collect::<Vec<_>>().join(", ")
}

/// Effects that are likely, with what each explains.
fn likely<'a>(beliefs: impl Iterator<Item = (&'a str, f64, Option<f64>)>) -> String {
    const OF_NOTE: f64 = 0.05;
    let told = beliefs.filter(|(_, p, _)| *p > OF_NOTE).map(|(name, p, share)| {
        let share = share.map_or_else(String::new, |share| format!(", explains {:.0} %", 100.0 * share));
        format!("{name} (probability {p:.3}{share})")
    });
    let told: Vec<String> = told.collect();
    if told.is_empty() { "none".to_owned() } else { told.join("; ") }
}

fn remainder(share: Option<f64>, of: &str, shows_in: &[&str]) -> String {
    match share {
        None => "nothing beyond the noise".to_owned(),
        Some(share) => format!("{:.1} % of the {of}, over {}", 100.0 * share, shows_in.join(", ")),
    }
}

fn made(rows: &[Vec<String>]) -> String {
    document::table(&["`palpate diagnose`", "answer"], rows)
}

/// Of a material that is compressed only.
pub fn of_compression(found: &compression::Diagnosis) -> String {
    let mut rows = vec![row("verdict", found.verdict.word().to_owned())];
    for finding in &found.findings {
        rows.push(row("named", format!("{}: {}", finding.code, parameters(&finding.parameters))));
    }
    if let Some(evidence) = found.evidence.as_deref() {
        let judged = &evidence.judged;
        let beliefs = judged.beliefs.iter().map(|b| (b.name, b.probability, b.explains));
        rows.push(row("what is believed", likely(beliefs)));
        let kinds = judged.kinds().into_iter().filter(|(_, p)| *p > 0.5);
        let kinds: Vec<String> = kinds.map(|(kind, p)| format!("{} ({p:.3})", kind.words())).collect();
        rows.push(row("kinds", kinds.join("; ")));
        rows.push(row("remainder", remainder(judged.remainder, "force", &judged.shows_in)));
    }
    made(&rows)
}

/// Of one channel of a display or sensor.
pub fn of_channel(found: &ChannelDiagnosis) -> String {
    let mut rows = vec![row("verdict", found.verdict.word().to_owned())];
    for finding in &found.findings {
        let told = format!("{} ({}): {}", finding.code, finding.form, parameters(&finding.parameters));
        rows.push(row("named", told));
    }
    if let Some(evidence) = found.evidence.as_deref() {
        let judged = &evidence.judged;
        let beliefs = judged.beliefs.iter().map(|b| (b.name, b.probability, b.explains));
        rows.push(row("what is believed", likely(beliefs)));
        rows.push(row("remainder", remainder(judged.remainder, "span", &judged.shows_in)));
        if let Some(held_out) = &evidence.held_out {
            let unit = found.channel.unit();
            let (was, is) = (number(held_out.rmse_before), number(held_out.rmse_after));
            rows.push(row("error on what was left out", format!("{was} to {is} {unit}")));
        }
    }
    made(&rows)
}

/// Of a table.
pub fn of_table(found: &table::Diagnosis) -> String {
    let mut rows = vec![row("verdict", found.verdict.word().to_owned())];
    if let Some(cause) = &found.too_few {
        rows.push(row("because", cause.to_string()));
    }
    for finding in &found.findings {
        rows.push(row("named", format!("{}: {}", finding.effect.code, parameters(&finding.parameters))));
    }
    if let Some(next) = found.proposals.first() {
        rows.push(row("next readings", next.what.clone()));
    }
    made(&rows)
}
