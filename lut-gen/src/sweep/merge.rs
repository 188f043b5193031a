//! From journals to one table.

use std::collections::BTreeMap;

use super::{Forces, Journal, JournalHead, Purpose, SweepErrorBound, SweepSpec, SweepTable};

/// Why journals make no table.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MergeError {
    /// No journal at all.
    #[error("there is no journal to merge")]
    Nothing,
    /// A journal of something else.
    #[error("{journal} belongs to another sweep: {difference}")]
    Other {
        /// The journal's name.
        journal: String,
        /// What differs.
        difference: String,
    },
    /// Points that nobody has solved.
    #[error("{count} of {jobs} points are not solved yet: {listed}. {advice}")]
    Missing {
        /// How many.
        count: usize,
        /// Points in all.
        jobs: usize,
        /// The first of them.
        listed: String,
        /// The shards that are not finished.
        advice: String,
    },
    /// Two journals do not agree on a point.
    #[error(
        "{first} and {second} differ in point {job} ({label}): they were computed by different machines or engines"
    )]
    Disagree {
        /// One journal.
        first: String,
        /// The other.
        second: String,
        /// The point's number.
        job: usize,
        /// Its parameters.
        label: String,
    },
}

/// The first difference of a journal's sweep from another, in words; `None` when they belong together.
#[must_use]
pub fn difference(head: &JournalHead, spec: &SweepSpec, engine: Option<&str>) -> Option<String> {
    let fields = |s: &SweepSpec| serde_json::to_value(s).ok();
    if head.spec != *spec
        && let (Some(theirs), Some(ours)) = (fields(&head.spec), fields(spec))
        && let (Some(theirs), Some(ours)) = (theirs.as_object(), ours.as_object())
    {
        let name = ours.keys().find(|k| ours.get(*k) != theirs.get(*k))?;
        let shown = |v: Option<&serde_json::Value>| shortened(&v.map_or(String::new(), ToString::to_string));
        return Some(format!("its `{name}` is {}, here {}", shown(theirs.get(name)), shown(ours.get(name))));
    }
    let engine = engine.filter(|e| *e != head.engine)?;
    Some(format!("its engine is \"{}\", here \"{engine}\"", head.engine))
}

fn shortened(text: &str) -> String {
    if text.chars().count() <= 300 { text.to_owned() } else { text.chars().take(300).chain("...".chars()).collect() }
}

/// The table of a sweep from the journals of all its shards, each with a name for messages. It depends on
/// the outcomes alone: not on threads, shards, interruptions, or the order of journals.
///
/// A point that failed in one journal and is solved in another is solved.
///
/// # Errors
/// [`MergeError`]: nothing to merge, journals of other sweeps or engines, points that nobody has solved,
/// or that two have solved differently.
pub fn merge(spec: &SweepSpec, journals: &[(String, Journal)]) -> Result<SweepTable, MergeError> {
    let engine = &journals.first().ok_or(MergeError::Nothing)?.1.head.engine;
    let mut merged: BTreeMap<usize, (&str, &Result<Forces, String>)> = BTreeMap::new();
    for (name, journal) in journals {
        if let Some(difference) = difference(&journal.head, spec, Some(engine)) {
            return Err(MergeError::Other { journal: name.clone(), difference });
        }
        for (&job, outcome) in &journal.outcomes {
            let stored = merged.entry(job).or_insert((name, outcome));
            match (stored.1, outcome) {
                (Ok(a), Ok(b)) if a != b => {
                    return Err(MergeError::Disagree {
                        first: stored.0.to_owned(),
                        second: name.clone(),
                        job,
                        label: spec.label(job),
                    });
                }
                // Solved before failed; of two failures the text that sorts first, whatever the order of journals.
                (Err(_), Ok(_)) => *stored = (name, outcome),
                (Err(a), Err(b)) if b < a => *stored = (name, outcome),
                _ => {}
            }
        }
    }
    let jobs = spec.jobs();
    let missing: Vec<usize> = (0..jobs).filter(|j| !merged.contains_key(j)).collect();
    if !missing.is_empty() {
        return Err(lacking(spec, journals, &missing));
    }
    let mut points: Vec<Option<Forces>> = Vec::with_capacity(jobs);
    let mut failed = BTreeMap::new();
    for (job, (_, outcome)) in merged {
        if let Err(text) = outcome {
            failed.insert(job, text.clone());
        }
        points.push(outcome.as_ref().ok().cloned());
    }
    let checks = points.split_off(spec.grid());
    let mut table =
        SweepTable { spec: spec.clone(), engine: engine.clone(), failed, error: SweepErrorBound::default(), points };
    table.error = bound(&table, &checks);
    Ok(table)
}

fn lacking(spec: &SweepSpec, journals: &[(String, Journal)], missing: &[usize]) -> MergeError {
    const SHOWN: usize = 5;
    let mut listed: Vec<String> = missing.iter().take(SHOWN).map(|&j| format!("{j} ({})", spec.label(j))).collect();
    if missing.len() > SHOWN {
        listed.push(format!("and {} more", missing.len() - SHOWN));
    }
    let mut counts: Vec<usize> = journals.iter().map(|(_, j)| j.head.shard.count()).collect();
    counts.sort_unstable();
    counts.dedup();
    let advice = match counts[..] {
        [n] => {
            let mut shards: Vec<usize> = missing.iter().map(|j| j % n + 1).collect();
            shards.sort_unstable();
            shards.dedup();
            let shards: Vec<String> = shards.iter().map(|i| format!("{i}/{n}")).collect();
            format!("Run the sweep again for: shard {}", shards.join(", "))
        }
        _ => "Run the sweep again: it solves what is missing".to_owned(),
    };
    MergeError::Missing { count: missing.len(), jobs: spec.jobs(), listed: listed.join("; "), advice }
}

/// What the checks say, relative to the peak of the curve each checks.
fn bound(table: &SweepTable, checks: &[Option<Forces>]) -> SweepErrorBound {
    let mut error = SweepErrorBound::default();
    for (j, check) in checks.iter().enumerate() {
        let Some(forces) = check else { continue };
        let job = table.spec.grid() + j;
        match table.spec.purpose(job) {
            Some(Purpose::Finer(point)) => {
                if let Some(coarse) = &table.points[point] {
                    raise(&mut error.discretisation, deviation(coarse, forces));
                    error.finer += 1;
                }
            }
            Some(Purpose::Between(_)) => {
                if let Some(interpolated) = table.between(job) {
                    raise(&mut error.interpolation, deviation(&interpolated, forces));
                    error.between += 1;
                }
            }
            _ => {}
        }
    }
    error
}

/// Largest difference in units of the curve's peak, over all rates.
fn deviation(forces: &Forces, check: &Forces) -> f64 {
    let mut worst = 0.0_f64;
    for (curve, checked) in forces.iter().zip(check) {
        let peak = checked.iter().fold(f64::MIN_POSITIVE, |p, f| p.max(f.abs()));
        worst = curve.iter().zip(checked).fold(worst, |w, (a, b)| w.max((a - b).abs() / peak));
    }
    worst
}

fn raise(bound: &mut Option<f64>, deviation: f64) {
    *bound = Some(bound.unwrap_or(0.0).max(deviation));
}
