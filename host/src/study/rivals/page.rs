//! The answer, the table and the picture of the race.

use lut_gen::solid::model::Resolution;
use serde_json::{Value, json};

use crate::identify::fe::{FeModel, ModelError, Progress};
use crate::identify::identify_from;
use crate::identify::model::ForwardModel;
use crate::identify::multistart::{self, Effort};
use crate::identify::newton::condition::{Condition, Source};
use crate::identify::newton::setup;
use crate::identify::spec::FitSpec;
use crate::report::figure::{Axis, Figure, Series, Stroke};
use crate::report::number;
use crate::report::strip::{Row, Strip};
use crate::study::findings::{Findings, Picture, Table};
use crate::study::{StudyError, Subject};

use super::landscape::{Ground, Landscape};
use super::method::{BUDGET, Method};
use super::two_terms::TwoTerms;
use super::{LOOSE, NEAR, Race, Record, race};

/// Parameters of the material that the rivals search.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Parameters {
    /// mu and alpha of one term, and the contact points.
    #[default]
    Two,
    /// mu and alpha of two terms.
    Four,
}

/// The study.
///
/// # Errors
/// Data that cannot be used, or a failing solve.
pub fn study(
    subject: &Subject,
    parameters: Parameters,
    starts: usize,
    seed: u64,
    progress: &Progress<'_>,
) -> Result<Findings, StudyError> {
    let selection = subject.foam_selection("rivals", false)?;
    let source = |_: &Condition| Source::Solves(Resolution::Standard);
    let terms = if parameters == Parameters::Two { 1 } else { 2 };
    let spec = FitSpec { terms: Some(terms), ..FitSpec::default() };
    let identified = || {
        progress("identify, for comparison", 0, 0);
        let identified = identify_from(&subject.experiment, &subject.material, &spec, &source)?;
        Ok::<_, StudyError>((identified.fe_solves, identified.seconds))
    };
    let nothing = || StudyError::NothingToFit {
        material: subject.material.clone(),
        reason: "no material pushes back like these data",
    };
    match parameters {
        Parameters::Two => {
            let model = FeModel::build(&subject.experiment, &selection, progress)?;
            let landscape = Landscape::new(&selection, &model).ok_or_else(nothing)?;
            let race = race(&landscape, starts, seed, progress);
            Ok(findings(subject, &landscape, &race, model.solves(), identified()?, seed))
        }
        Parameters::Four => {
            let mut problem = setup::problem(&subject.experiment, &selection, &subject.material, &spec, &source);
            let told = |solves: usize| progress("MultiStart, for the landscape", solves, 0);
            let effort = Effort::of(spec.most_solves);
            let failed = |cause| ModelError::Solve { what: subject.material.clone(), cause };
            let search = multistart::search(&mut problem, effort, &told).map_err(failed)?;
            let solves = problem.solves();
            let landscape = TwoTerms::new(problem, &selection, &search);
            let race = race(&landscape, starts, seed, progress);
            let mut findings = findings(subject, &landscape, &race, solves, identified()?, seed);
            findings.method.push("The landscape is what MultiStart solved: between its points stand the solves' own values and slopes, so that it has small waves of its own.".to_owned());
            Ok(findings)
        }
    }
}

fn findings(
    subject: &Subject,
    landscape: &dyn Ground,
    race: &Race,
    model_solves: usize,
    identify: (usize, f64),
    seed: u64,
) -> Findings {
    let starts = race.records.first().map_or(0, |record| record.searches.len());
    let conditions = landscape.conditions();
    let stem = if race.best.1.len() > 2 { "study-rivals-4" } else { "study-rivals" };
    let mut table = Table::new(&[
        "method",
        "code",
        "success (%)",
        "loosely (%)",
        "evaluations to success",
        "used",
        "per success",
        "ms a search",
        "as solves per success",
    ]);
    for record in &race.records {
        table.rows.push(row(record, conditions, race.loose_below));
    }
    Findings {
        study: "rivals",
        title: "Rival optimisers on one problem".to_owned(),
        subject: subject.sentence(),
        method: how(landscape, race, starts, model_solves, seed),
        answer: answer(race, conditions, identify),
        tables: vec![table],
        pictures: vec![picture(race, starts, stem), way(race, starts, stem)],
        json: [
            (
                "methods".to_owned(),
                race.records.iter().map(|record| of_json(record, conditions, race.loose_below)).collect(),
            ),
            ("starts".to_owned(), json!(starts)),
            ("best".to_owned(), best(race)),
            ("success_below".to_owned(), json!(race.success_below)),
            ("identify".to_owned(), json!({"fe_solves": identify.0, "seconds": identify.1})),
        ]
        .into_iter()
        .collect(),
    }
}

fn how(landscape: &dyn Ground, race: &Race, starts: usize, model_solves: usize, seed: u64) -> Vec<String> {
    vec![
        format!(
            "{} unknowns: {}, in a box; {starts} random starts in it, the same for all (seed {seed}), at most {BUDGET} evaluations each. The swarm takes only the seed.",
            landscape.dimension(),
            landscape.coordinates_in_words()
        ),
        "Objective: mean square of the differences, each relative to the largest force of its run. Eq. 14 adds absolute values; four of the methods need squares or slopes.".to_owned(),
        format!(
            "Success: the mean square comes within {} standard errors of the best known optimum ({:.6e}, {}), that is below {:.6e}; loosely: within {} of them.",
            number(NEAR),
            race.best.0,
            in_words(&race.best.1),
            race.success_below,
            number(LOOSE)
        ),
        "An evaluation is the force of all runs at one point; a slope by a difference quotient costs one more. Only the first row has its slopes from sensitivities, which come with the value.".to_owned(),
        format!(
            "Forces are read from a model of {model_solves} finite-element solves, so that the race takes seconds; the last column multiplies by the {} balls: what it would cost with a solve an evaluation, although mu and contact points need none.",
            landscape.conditions()
        ),
        "Every method runs with its own defaults or those stated in the code, without restarts; a method tuned to this problem would do better.".to_owned(),
    ]
}

fn answer(race: &Race, conditions: usize, (solves, seconds): (usize, f64)) -> Vec<String> {
    let with_price = race.records.iter().filter_map(|record| record.price().map(|price| (record, price)));
    let quotients = with_price.filter(|(record, _)| record.method != Method::GaussNewton);
    let mut answer = Vec::new();
    if let Some((record, price)) = quotients.min_by(|a, b| a.1.total_cmp(&b.1)) {
        answer.push(format!(
            "without sensitivities the cheapest is {}: {} evaluations a success, which would be {} finite-element solves were each one a ball",
            record.method.word(),
            number(price.round()),
            number((price * conditions as f64).round())
        ));
    }
    let never: Vec<&str> =
        race.records.iter().filter(|record| record.success() == 0.0).map(|record| record.method.word()).collect();
    if !never.is_empty() {
        answer.push(format!("no start of {} succeeds within {BUDGET} evaluations", never.join(", ")));
    }
    answer.push(format!(
        "identify took {solves} finite-element solves ({} a ball) in {} s from no start of the user's: sensitivities come with each solve, and neither mu nor a contact point costs one",
        number(solves as f64 / conditions.max(1) as f64),
        number(seconds)
    ));
    answer
}

fn row(record: &Record, conditions: usize, loose_below: f64) -> Vec<String> {
    let whole = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:.0}"));
    vec![
        record.method.word().to_owned(),
        record.method.code().to_owned(),
        format!("{:.0}", 100.0 * record.success()),
        format!("{:.0}", 100.0 * record.below(loose_below)),
        whole(record.to_success().map(|count| count as f64)),
        record.used().to_string(),
        whole(record.price()),
        format!("{:.1}", record.milliseconds()),
        whole(record.price().map(|price| price * conditions as f64)),
    ]
}

fn of_json(record: &Record, conditions: usize, loose_below: f64) -> Value {
    json!({
        "method": record.method.word(),
        "code": record.method.code(),
        "success": record.success(),
        "success_loosely": record.below(loose_below),
        "evaluations_to_success_median": record.to_success(),
        "evaluations_used_median": record.used(),
        "evaluations_per_success": record.price(),
        "fe_solves_per_success": record.price().map(|price| price * conditions as f64),
        "seconds_a_search": record.milliseconds() / 1e3,
        "evaluations_to_success": record.searches.iter().map(|search| search.to_success).collect::<Vec<_>>(),
    })
}

fn in_words(named: &[(String, f64)]) -> String {
    named.iter().map(|(name, value)| format!("{name} {}", number(*value))).collect::<Vec<_>>().join(", ")
}

fn best(race: &Race) -> Value {
    let parameters = race.best.1.iter().map(|(name, value)| (name.clone(), json!(value)));
    std::iter::once(("mean_square".to_owned(), json!(race.best.0))).chain(parameters).collect()
}

/// Points of a curve over the evaluations, from 1 to the budget.
const NODES: usize = 60;

/// Fig. 89: what is left over against evaluations, a line a method.
fn way(race: &Race, starts: usize, stem: &str) -> Picture {
    let places: Vec<usize> =
        (0..=NODES).map(|i| (BUDGET as f64).powf(i as f64 / NODES as f64).round() as usize).collect();
    let x = Axis::new("evaluations").over(1.0, BUDGET as f64).logarithmic();
    let mut figure =
        Figure::new("The best so far over evaluations", x, Axis::new("rms of what is left over (%)").logarithmic());
    for (at, record) in race.records.iter().enumerate() {
        let points = places.iter().map(|n| (*n as f64, 100.0 * record.after(*n).sqrt()));
        let points = points.filter(|(_, rms)| rms.is_finite()).collect();
        let stroke = Stroke::LINES[at % Stroke::LINES.len()];
        figure = figure.with(Series::new(record.method.word(), points, stroke, at));
    }
    Picture {
        file: format!("{stem}-way"),
        svg: figure.svg(),
        caption: format!(
            "The median over {starts} starts of the best objective after so many evaluations, as thesis Fig. 89 shows one search of each."
        ),
    }
}

fn picture(race: &Race, starts: usize, stem: &str) -> Picture {
    let rows = race.records.iter().map(|record| Row {
        name: record.method.word().to_owned(),
        dots: record.searches.iter().filter_map(|search| search.to_success.map(|count| count as f64)).collect(),
        mark: record.price(),
        note: format!("{:.0} %", 100.0 * record.success()),
    });
    let strip = Strip {
        title: "Evaluations until success".to_owned(),
        axis: "evaluations".to_owned(),
        note: "success".to_owned(),
        rows: rows.collect(),
    };
    Picture {
        file: stem.to_owned(),
        svg: strip.svg(),
        caption: format!(
            "A dot a start that succeeded, of {starts}; upright bar: all evaluations of the method divided by its successes, what a success costs with restarts."
        ),
    }
}
