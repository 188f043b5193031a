//! Measured and fitted curves, as `result.json` has them.

use serde_json::{Value, json};

use crate::diagnose::Diagnosis;
use crate::experiment::Experiment;
use crate::identify::Identification;

/// Most samples of a run; of longer ones every n-th is written.
const MOST_SAMPLES: usize = 20_000;

/// Every n-th value.
fn thinned(values: &[f64], every: usize) -> Vec<f64> {
    values.iter().step_by(every).copied().collect()
}

/// One entry a run of every material: readings of depth, time since the end of loading, forces.
#[must_use]
pub fn identified(experiment: &Experiment, found: &[Identification]) -> Value {
    let of_material = |one: &Identification| -> Vec<Value> {
        let runs = one.fit.iter().flat_map(|fit| &fit.runs);
        let curve = |run: &crate::identify::fit::RunFit| {
            let data = &one.selection.curves[run.curve];
            let every = data.depth_mm.len().div_ceil(MOST_SAMPLES).max(1);
            json!({
                "material": one.material, "file": experiment.runs[data.run].file, "hold_out": data.hold_out,
                "contact_mm": run.contact_mm, "every": every,
                "time_s": thinned(&data.time_s, every), "depth_mm": thinned(&data.depth_mm, every),
                "measured_N": thinned(&data.force_n, every), "fitted_N": thinned(&run.model_n, every),
            })
        };
        runs.map(curve).collect()
    };
    Value::Array(found.iter().flat_map(of_material).collect())
}

/// One entry a run that was compared with a simulation: its samples, the base's forces and the extended model's.
#[must_use]
pub fn diagnosed(experiment: &Experiment, found: &[Diagnosis]) -> Value {
    let of_material = |one: &Diagnosis| -> Vec<Value> {
        let Some(evidence) = one.evidence.as_deref() else { return Vec::new() };
        let named = one.is_named();
        let each = evidence.design.series.iter().enumerate();
        let curve = |(at, series): (usize, &crate::diagnose::design::Series)| {
            let of = |value: &dyn Fn(&crate::diagnose::design::Node) -> f64| -> Vec<f64> {
                series.nodes.iter().map(value).collect()
            };
            let extended = evidence.after.as_ref().filter(|_| named).map(|after| &after.curves[at].force_n);
            json!({
                "material": one.material, "file": experiment.runs[series.run].file, "hold_out": series.hold_out,
                "time_s": of(&|node| node.time_s), "depth_mm": of(&|node| node.depth_mm),
                "measured_N": of(&|node| node.force_n),
                "base_N": evidence.before.curves[at].force_n, "extended_N": extended,
            })
        };
        each.map(curve).collect()
    };
    Value::Array(found.iter().flat_map(of_material).collect())
}
