//! The report of `palpate identify`: the answer first, then the fit, the parameters, and what they rest on.

mod curves;
mod words;

use crate::experiment::Experiment;
use crate::identify::fit::{Fit, Parameter};
use crate::identify::newton::fit::Newton;
use crate::identify::newton::valley::Valley;
use crate::identify::{Identification, Outcome, deepest_field};

use super::{Page, field, map, number, valley};

pub use words::{answer, spoken};

/// Words of messages that must not be overlooked.
const GRAVE: [&str; 5] = ["systematically", "lies on a bound", "not used", "fault", "not determined"];

/// Builds the page for all materials of an experiment.
pub fn page(experiment: &Experiment, found: &[Identification]) -> Page {
    let mut page = Page::new(&format!("Identification: {}", experiment.name), "");
    if found.is_empty() {
        page.warning("Nothing to identify: no run indents, compresses or pulls a soft specimen. `test` in [[run]] says what was done.");
    }
    for one in found {
        if found.len() > 1 {
            page.section(&format!("Material: {}", one.material));
        }
        material(&mut page, experiment, one);
    }
    page
}

/// Answer, fit, parameters; then, folded, what they rest on.
fn material(page: &mut Page, experiment: &Experiment, found: &Identification) {
    match found.outcome {
        Outcome::Fitted => page.verdict(&words::answer(found)),
        _ => page.warning(&words::answer(found)),
    }
    let grave = |message: &&String| GRAVE.iter().any(|word| message.contains(word));
    words::open(found).iter().for_each(|sentence| page.paragraph(sentence));
    for message in found.messages.iter().filter(grave) {
        page.warning(message);
    }
    if let Some(fit) = &found.fit {
        page.section("Fit");
        curves::overview(page, experiment, found, fit);
        page.section("Parameters");
        let rows: Vec<Vec<String>> = fit.parameters.iter().map(parameter_row).collect();
        page.table(&["parameter", "value", "95 % interval", "bounds of the search", ""], &rows);
        words::widened(found).iter().for_each(|sentence| page.paragraph(sentence));
        page.fold("Each run by itself");
        for run in &fit.runs {
            curves::one_run(page, experiment, found, run);
        }
        page.unfold();
        inside(page, found);
        objective(page, found, fit);
    }
    page.section("Method");
    page.paragraph(
        "The law is fitted to the first loading branch of every run, and with relaxation to the hold after it. \
         Under a ball its force is that of finite elements; where all of a specimen deforms alike it is a closed form.",
    );
    if let Some(fit) = &found.fit {
        page.table(&["", "value"], &figures_of_fit(found, fit));
    }
    page.heading("Assumptions");
    page.list(&found.assumptions);
    // the table has the sentences about parameters
    let verdicts = || found.fit.iter().flat_map(|fit| &fit.parameters).filter_map(|p| p.verdict.as_ref());
    let told = |message: &String| verdicts().any(|verdict| verdict.sentence == *message);
    let plain: Vec<String> = found.messages.iter().filter(|m| !grave(m) && !told(m)).cloned().collect();
    if !plain.is_empty() {
        page.heading("Notes");
        page.list(&plain);
    }
}

/// The objective around the minimum, folded away.
fn objective(page: &mut Page, found: &Identification, fit: &Fit) {
    page.fold("How the parameters hang together");
    if let Some(search) = &fit.search {
        page.figure(
            &map::svg("Objective of MultiStart", search),
            "Sum of absolute force differences (Eq. 14). Lines: simplex paths. Contact points and other parameters at their best.",
        );
    }
    if let Some(newton) = &fit.newton {
        around(page, found, newton);
    }
    page.unfold();
}

/// How the parameters hang together: the objective around the minimum, correlations.
fn around(page: &mut Page, found: &Identification, newton: &Newton) {
    let Some(valley) = Valley::around(newton, &found.selection) else {
        page.paragraph("There is one parameter. Only the contact points can make up for it.");
        return;
    };
    page.figure(&valley::svg("Objective around the minimum", newton, &valley), &valley::caption(newton, &valley));
    let Some(correlation) = &newton.correlation else {
        page.warning("Some parameters are exactly tied, so there are no correlations.");
        return;
    };
    let names: Vec<&str> = newton.solved.unknowns.iter().map(|unknown| unknown.name.as_str()).collect();
    let rows: Vec<Vec<String>> = names
        .iter()
        .enumerate()
        .map(|(i, name)| {
            let cells =
                (0..names.len()).map(|j| if j > i { String::new() } else { format!("{:.2}", correlation[(i, j)]) });
            std::iter::once((*name).to_owned()).chain(cells).collect()
        })
        .collect();
    page.paragraph("Correlation of the estimates:");
    page.table(&std::iter::once("").chain(names.iter().copied()).collect::<Vec<_>>(), &rows);
}

/// The specimen at the deepest point, computed with what was found.
fn inside(page: &mut Page, found: &Identification) {
    match deepest_field(found) {
        None => {}
        Some(Err(cause)) => page.warning(&format!("The inside of the specimen is not shown: {cause}.")),
        Some(Ok(field)) => {
            page.fold("Inside the specimen, at the deepest point");
            page.figure(
                &field::mises("Mises stress at the deepest point, with the parameters found", &field),
                &field::caption(&field),
            );
            page.unfold();
        }
    }
}

/// Name, value, interval, bounds and a word of warning.
fn parameter_row(parameter: &Parameter) -> Vec<String> {
    let range = |(low, high): (f64, f64)| match low.is_finite() && high.is_finite() {
        true => format!("{} to {}", number(low), number(high)),
        false => String::new(),
    };
    vec![
        parameter.name.clone(),
        number(parameter.value),
        range((parameter.interval95.low, parameter.interval95.high)),
        range(parameter.bounds),
        match (&parameter.verdict, parameter.at_bound, parameter.derived, parameter.fills_its_bounds()) {
            (_, true, ..) => "on a bound".to_owned(),
            (_, _, true, _) => "follows from the others".to_owned(),
            (Some(verdict), ..) => verdict.sentence.clone(),
            (None, .., true) => "not determined".to_owned(),
            _ => String::new(),
        },
    ]
}

fn figures_of_fit(found: &Identification, fit: &Fit) -> Vec<Vec<String>> {
    let row = |name: &str, value: String| vec![name.to_owned(), value];
    let mut rows = vec![
        row("residual, rms (N)", number(fit.rmse_n)),
        row("noise of a sample, as the intervals take it (N)", number(fit.noise.sigma_n)),
        row("neighbouring samples that count as one", number(fit.noise.correlated_samples)),
        row("error bound of the model, of the largest force (%)", number(100.0 * fit.model_error)),
    ];
    if let Some(check) = found.direct_check {
        rows.push(row("force model against a solve at the end (%)", number(100.0 * check)));
    }
    rows.push(row("finite element solves", found.fe_solves.to_string()));
    rows.push(row("time (s)", number(found.seconds)));
    rows
}
