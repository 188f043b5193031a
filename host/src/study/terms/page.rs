//! The answer, the table and the picture of the study of two terms.

use serde_json::{Value, json};

use crate::identify::data::Selection;
use crate::identify::fe::Progress;
use crate::identify::identify_from;
use crate::identify::newton::condition::{Condition, Source};
use crate::report::figure::{Axis, Figure, Series, Stroke};
use crate::report::number;
use crate::study::findings::{Findings, Picture, Table};
use crate::study::subject::of_balls;
use crate::study::{StudyError, Subject};

use super::{EQUAL, Effort, End, Optimum, VANISHED, ends, two_terms};

/// What identify says of each parameter of two terms from the same data.
fn sentences(subject: &Subject, selection: &Selection, effort: &Effort) -> Result<Vec<String>, StudyError> {
    let mut experiment = subject.experiment.clone();
    for (at, run) in experiment.runs.iter_mut().enumerate() {
        run.hold_out |= !selection.curves.iter().any(|curve| curve.run == at);
    }
    let source = |_: &Condition| Source::Solves(effort.resolution);
    let found = identify_from(&experiment, &subject.material, &two_terms(), &source)?;
    let verdicts = found.fit.iter().flat_map(|fit| &fit.parameters).filter_map(|p| p.verdict.as_ref());
    Ok(verdicts.map(|verdict| verdict.sentence.clone()).collect())
}

/// The study.
///
/// # Errors
/// As [`ends`].
pub fn study(subject: &Subject, effort: &Effort, progress: &Progress<'_>) -> Result<Findings, StudyError> {
    let all = subject.foam_selection("terms", false)?;
    // The thesis used the smaller ball alone.
    let ball = subject.balls(&all).first().copied().unwrap_or(0);
    let selection = of_balls(&all, &[ball]);
    let (ends, solves) = ends(subject, &selection, effort, progress)?;
    progress("what identify says", 0, 0);
    let said = sentences(subject, &selection, effort)?;
    let count = |kind: Optimum| ends.iter().filter(|end| end.optimum == kind).count();
    let mut answer: Vec<String> = Vec::new();
    let ended = |kind: &Optimum| format!("{} at {}", count(*kind), kind.word());
    let counted: Vec<String> = Optimum::ALL[..3].iter().map(ended).collect();
    answer.push(format!(
        "of {} starts end {}; {} at a mixture of two different terms",
        ends.len(),
        counted.join(", "),
        count(Optimum::Mixture)
    ));
    let farthest = ends.iter().map(|end| end.above_best).fold(0.0, f64::max);
    answer.push(format!(
        "their losses differ by {} at most, where a 95 % interval reaches to 3.84: {}",
        number(farthest),
        if farthest < 3.84 { "they are one optimum to these data" } else { "not all of them are equally good" }
    ));
    answer.extend(said.iter().map(|sentence| format!("identify says: {sentence}")));
    Ok(Findings {
        study: "terms",
        title: "Two terms fitted to a foam of one".to_owned(),
        subject: subject.sentence(),
        method: vec![
            format!("MultiStart: a grid of 4 x 4 exponents and 3 shares of the second term in the modulus, the best {} of it as starts, Gauss-Newton on finite elements from each, {} alone (as thesis Table 2); {solves} solves in all, the mirror images of the grid come free.", ends.len(), subject.ball_name(ball)),
            format!("A modulus below {} % of the whole counts as zero, exponents within {} % as equal.", 100.0 * VANISHED, 100.0 * EQUAL),
            "A mixture has two different exponents and both moduli; the thesis does not list it. Its force differs from one term's by less than the noise.".to_owned(),
        ],
        answer,
        tables: vec![table(&ends)],
        pictures: vec![picture(&ends)],
        json: [
            ("counts".to_owned(), Optimum::ALL.iter().map(|&kind| (kind.word().to_owned(), json!(count(kind)))).collect()),
            ("ends".to_owned(), ends.iter().map(json_of).collect()),
            ("sentences".to_owned(), json!(said)),
            ("largest_loss_above_best".to_owned(), json!(farthest)),
            ("fe_solves".to_owned(), json!(solves)),
        ]
        .into_iter()
        .collect(),
    })
}

fn json_of(end: &End) -> Value {
    json!({
        "start": {"alpha": end.start.0, "share_2": end.start.1},
        "mu_MPa": [end.mu_mpa * (1.0 - end.share_2), end.mu_mpa * end.share_2],
        "alpha": end.alpha,
        "loss_above_best": end.above_best,
        "kind": end.optimum.word(),
    })
}

fn table(ends: &[End]) -> Table {
    let mut table = Table::new(&["mu_1 (MPa)", "alpha_1", "mu_2 (MPa)", "alpha_2", "loss above best", "kind"]);
    let mut sorted: Vec<&End> = ends.iter().collect();
    sorted.sort_by_key(|end| Optimum::ALL.iter().position(|kind| *kind == end.optimum));
    for end in sorted {
        table.rows.push(vec![
            number(end.mu_mpa * (1.0 - end.share_2)),
            number(end.alpha[0]),
            number(end.mu_mpa * end.share_2),
            number(end.alpha[1]),
            format!("{:.3}", end.above_best),
            end.optimum.word().to_owned(),
        ]);
    }
    table
}

/// The three kinds of optimum are three lines of this plane, in the shape of an H.
fn picture(ends: &[End]) -> Picture {
    let at = |alpha: [f64; 2], share: f64| (share, alpha[1] / alpha[0]);
    let y = Axis::new("alpha_2 / alpha_1").logarithmic().over(0.09, 11.0);
    let mut figure =
        Figure::new("Where the starts end", Axis::new("share of the second term in mu").over(-0.03, 1.03), y);
    figure.size.1 = 400.0;
    for line in [vec![(0.0, 0.09), (0.0, 11.0)], vec![(1.0, 0.09), (1.0, 11.0)], vec![(0.0, 1.0), (1.0, 1.0)]] {
        figure = figure.with(Series::new("", line, Stroke::Dotted, 5));
    }
    for end in ends {
        let way = vec![at(end.start.0, end.start.1), at(end.alpha, end.share_2)];
        figure = figure.with(Series::new("", way, Stroke::Faint, 5));
    }
    for (colour, kind) in Optimum::ALL.into_iter().enumerate() {
        let of_kind: Vec<(f64, f64)> =
            ends.iter().filter(|end| end.optimum == kind).map(|end| at(end.alpha, end.share_2)).collect();
        figure = figure.with(Series::new(kind.word(), of_kind, Stroke::Dots, colour));
    }
    Picture {
        file: "study-terms".to_owned(),
        svg: figure.svg(),
        caption: "Dots: ends, joined to their starts. On the three dotted lines two terms are exactly one: left mu_2 = 0, right mu_1 = 0, across alpha_1 = alpha_2.".to_owned(),
    }
}
