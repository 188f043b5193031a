//! The JSON answer of `palpate identify`.

use serde_json::{Map, Value, json};

use crate::experiment::Experiment;

use super::Identification;
use super::fit::Parameter;

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
            let why = "the experiment holds no run that indents, compresses or pulls a soft specimen";
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
    put("law", json!(found.law.word()));
    put("parameters", parameters(found));
    if let Some(fit) = &found.fit {
        put("rmse_N", json!(fit.rmse_n));
        put("noise_N", json!(fit.noise.sigma_n));
        put("noise_from", json!(fit.noise.source.sentence()));
        put("objective_N", json!(fit.objective_n));
        put("model_error", json!(fit.model_error));
    }
    if let Some(newton) = found.fit.as_ref().and_then(|fit| fit.newton.as_ref()) {
        put("method", json!("gauss-newton"));
        put("converged", json!(newton.converged));
        put("objective", json!(newton.minimum.at.value));
        put("promised", json!(newton.minimum.promised));
        put("came_back", json!([newton.came_back.0, newton.came_back.1]));
        if let Some(correlation) = &newton.correlation {
            let rows: Vec<Vec<f64>> = correlation.row_iter().map(|row| row.iter().copied().collect()).collect();
            put("correlation", json!(rows));
        }
    } else if let Some(search) = found.fit.as_ref().and_then(|fit| fit.search.as_ref()) {
        put("method", json!("simplex"));
        put("converged", json!(search.converged()));
        put("threshold_N", json!(search.threshold_n));
        put("map_points", json!(search.sample.len()));
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
        let mut value = json!({
            "value": parameter.value,
            "interval95": [parameter.interval95.low, parameter.interval95.high],
            "bounds": bounds(parameter.bounds),
            "at_bound": parameter.at_bound,
        });
        if let (Some(unseen), Some(map)) = (&parameter.unseen, value.as_object_mut()) {
            map.insert("interval95_noise".to_owned(), json!([unseen.noise.low, unseen.noise.high]));
            map.insert("widened_by".to_owned(), crate::infer::unseen::json(&unseen.by));
        }
        if let (Some(verdict), Some(map)) = (&parameter.verdict, value.as_object_mut()) {
            map.insert("standing".to_owned(), json!(verdict.standing.word()));
            map.insert("sentence".to_owned(), json!(verdict.sentence));
        }
        all.insert(parameter.name.clone(), value);
    }
    Value::Object(all)
}

/// A derived parameter has none.
fn bounds((low, high): (f64, f64)) -> Value {
    if low.is_finite() && high.is_finite() { json!([low, high]) } else { Value::Null }
}

fn starts(found: &Identification) -> Value {
    let Some(fit) = &found.fit else { return json!([]) };
    let simplices = fit.search.iter().flat_map(|search| search.starts.iter().map(move |start| (search, start)));
    let simplices = simplices.map(|(search, start)| {
        let named = |point: &[f64]| -> Map<String, Value> {
            search.named(point).map(|(name, value)| (name.to_owned(), json!(value))).collect()
        };
        let descent = &start.descent;
        let mut one = descent.path.first().map(|point| named(point)).unwrap_or_default();
        one.insert("end".to_owned(), Value::Object(named(&descent.point)));
        one.insert("objective".to_owned(), json!(descent.value));
        one.insert("evaluations".to_owned(), json!(descent.evaluations));
        one.insert("at_rest".to_owned(), json!(start.at_rest));
        Value::Object(one)
    });
    // Gauss-Newton goes on from the best of its first points: the path is one.
    let newton = fit.newton.iter().map(|newton| {
        let searched: Vec<&Parameter> = fit.parameters.iter().filter(|p| !p.derived).collect();
        let named = |point: &[f64]| -> Map<String, Value> {
            searched.iter().zip(point).map(|(p, x)| (p.name.clone(), json!(p.shown(*x)))).collect()
        };
        let mut start = newton.path.first().map(|visit| named(&visit.point)).unwrap_or_default();
        start.insert("end".to_owned(), Value::Object(named(&newton.minimum.x)));
        start.insert("objective".to_owned(), json!(newton.minimum.at.value));
        start.insert("evaluations".to_owned(), json!(newton.path.len()));
        let path: Vec<Value> = newton.path.iter().map(|visit| Value::Object(named(&visit.point))).collect();
        start.insert("path".to_owned(), Value::Array(path));
        Value::Object(start)
    });
    Value::Array(simplices.chain(newton).collect())
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
