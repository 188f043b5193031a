//! The JSON answer of `palpate identify`.

use serde_json::{Map, Value, json};

use crate::experiment::Experiment;

use super::Identification;
use super::objective::{ALPHA, FIRST_HEIGHT, LN_MU};

/// The answer for all materials: that of the first one, and, if there are several, all of them
/// again under `materials`. `report` is the path of the HTML report, if one was written.
pub fn json(experiment: &Experiment, found: &[Identification], report: Option<&str>) -> Value {
    let mut answer = match found.first() {
        Some(first) => material(experiment, first),
        None => {
            let mut answer = Map::new();
            answer.insert("outcome".to_owned(), json!("too-few-points"));
            answer.insert("law".to_owned(), json!("hyperfoam"));
            answer.insert("parameters".to_owned(), json!({}));
            answer.insert("fe_solves".to_owned(), json!(0));
            answer.insert("seconds".to_owned(), json!(0.0));
            answer.insert("starts".to_owned(), json!([]));
            let why = "the experiment holds no indentation run into a soft specimen";
            answer.insert("messages".to_owned(), json!([why]));
            answer
        }
    };
    if found.len() > 1 {
        let all: Vec<Value> = found.iter().map(|one| Value::Object(material(experiment, one))).collect();
        answer.insert("materials".to_owned(), Value::Array(all));
    }
    if let Some(report) = report {
        answer.insert("report".to_owned(), json!(report));
    }
    Value::Object(answer)
}

fn material(experiment: &Experiment, found: &Identification) -> Map<String, Value> {
    let mut answer = Map::new();
    let mut put = |key: &str, value: Value| answer.insert(key.to_owned(), value);
    put("outcome", json!(found.outcome.word()));
    put("material", json!(found.material));
    put("law", json!("hyperfoam"));
    put("parameters", parameters(found));
    if let Some(fit) = &found.fit {
        put("rmse_N", json!(fit.rmse_n));
        put("noise_N", json!(fit.noise.sigma_n));
        put("noise_from", json!(fit.noise.source.sentence()));
        put("objective_N", json!(fit.objective_n));
        put("model_error", json!(fit.model_error));
    }
    put("fe_solves", json!(found.fe_solves));
    put("direct_check", json!(found.direct_check));
    put("seconds", json!(found.seconds));
    put("starts", starts(found));
    put("runs", runs(experiment, found));
    put("assumptions", json!(found.assumptions));
    put("messages", json!(found.messages));
    answer
}

fn parameters(found: &Identification) -> Value {
    let mut all = Map::new();
    for parameter in found.fit.iter().flat_map(|fit| &fit.parameters) {
        let value = json!({
            "value": parameter.value,
            "interval95": [parameter.interval95.low, parameter.interval95.high],
            "bounds": [parameter.bounds.0, parameter.bounds.1],
            "at_bound": parameter.at_bound,
        });
        all.insert(parameter.name.clone(), value);
    }
    Value::Object(all)
}

fn place(point: &[f64]) -> Map<String, Value> {
    let mut place = Map::new();
    place.insert("mu_MPa".to_owned(), json!(point[LN_MU].exp()));
    place.insert("alpha".to_owned(), json!(point[ALPHA]));
    if point.len() > FIRST_HEIGHT {
        place.insert("heights_mm".to_owned(), json!(point[FIRST_HEIGHT..]));
    }
    place
}

fn starts(found: &Identification) -> Value {
    let descents = found.fit.iter().flat_map(|fit| &fit.search.descents);
    let starts = descents.map(|descent| {
        let mut start = descent.path.first().map(|point| place(point)).unwrap_or_default();
        start.insert("end".to_owned(), Value::Object(place(&descent.point)));
        start.insert("objective".to_owned(), json!(descent.value));
        start.insert("evaluations".to_owned(), json!(descent.evaluations));
        Value::Object(start)
    });
    Value::Array(starts.collect())
}

fn runs(experiment: &Experiment, found: &Identification) -> Value {
    let runs = found.fit.iter().flat_map(|fit| &fit.runs).map(|run| {
        let data = &found.selection.curves[run.curve];
        json!({
            "file": experiment.runs[data.run].file,
            "contact_mm": run.contact_mm,
            "contact_at_bound": run.contact_at_bound,
            "rate_mm_per_s": data.rate_mm_per_s,
            "samples": data.depth_mm.len(),
            "rmse_N": run.rmse_n,
            "hold_out": data.hold_out,
        })
    });
    Value::Array(runs.collect())
}
