//! What each part of a magnet would have to differ by to explain a table alone.
//!
//! Five readings that nothing repeats name nothing. They still bound: a part that would have to differ by ten times of
//! what is plausible is not the cause, and parts whose changes are alike cannot be told apart by any repeats.

use nalgebra::DMatrix;

use super::readings::Table;
use crate::magnet::uncertain::PARTS;

/// One part as the only cause.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Alone {
    /// Its code; `remanence` is a flux density that is the same at all currents.
    pub code: &'static str,
    /// What it would have to differ by, in what is plausible; of a remanence, the flux density in the table's unit.
    pub amount: f64,
    /// Root mean square that is left, in the table's unit.
    pub left: f64,
}

/// Every part as the only cause, the one that leaves least first.
#[derive(Debug, Clone, PartialEq)]
pub struct AllAlone {
    /// Root mean square of measured less simulated.
    pub without: f64,
    /// The parts.
    pub parts: Vec<Alone>,
    /// Combinations of the parts that these readings could tell if they scattered by what a straight line leaves.
    pub combinations: usize,
    /// Parts whose change is in proportion to another's within a percent.
    pub alike: Vec<(&'static str, &'static str)>,
}

/// Cosine above which two changes are one.
const ALIKE: f64 = 0.9999;

/// Of a table beside a magnet; `None` beside none.
#[must_use]
pub fn all_alone(table: &Table, scatter: f64) -> Option<AllAlone> {
    if !table.parts.contains(&true) {
        return None;
    }
    let misfit: Vec<f64> = table.readings.iter().map(|r| r.y - r.simulated.unwrap_or(0.0)).collect();
    let rms = |values: &mut dyn Iterator<Item = f64>| (values.map(|v| v * v).sum::<f64>() / misfit.len() as f64).sqrt();
    let mut columns: Vec<(&'static str, Vec<f64>)> = Vec::new();
    for (part, code) in PARTS.into_iter().enumerate().filter(|(part, _)| table.parts[*part]) {
        columns.push((code, table.readings.iter().map(|r| table.span * r.built[part]).collect()));
    }
    let combinations = combinations(&columns, scatter);
    let alike = alike(&columns);
    columns.push(("remanence", vec![1.0; misfit.len()]));
    let mut parts: Vec<Alone> = columns
        .iter()
        .map(|(code, column)| {
            let square: f64 = column.iter().map(|c| c * c).sum();
            let along: f64 = column.iter().zip(&misfit).map(|(c, m)| c * m).sum();
            let amount = if square > 0.0 { along / square } else { 0.0 };
            let left = rms(&mut column.iter().zip(&misfit).map(|(c, m)| m - amount * c));
            Alone { code, amount, left }
        })
        .collect();
    parts.sort_by(|a, b| a.left.total_cmp(&b.left));
    Some(AllAlone { without: rms(&mut misfit.iter().copied()), parts, combinations, alike })
}

/// Combinations of plausible differences that stand out of the scatter.
fn combinations(columns: &[(&'static str, Vec<f64>)], scatter: f64) -> usize {
    let rows = columns.first().map_or(0, |(_, column)| column.len());
    let matrix = DMatrix::from_fn(rows, columns.len(), |i, j| columns[j].1[i]);
    matrix.singular_values().iter().filter(|value| **value > scatter.max(f64::MIN_POSITIVE)).count()
}

fn alike(columns: &[(&'static str, Vec<f64>)]) -> Vec<(&'static str, &'static str)> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut pairs = Vec::new();
    for (i, (code, own)) in columns.iter().enumerate() {
        for (other, there) in &columns[i + 1..] {
            let sizes = (dot(own, own) * dot(there, there)).sqrt();
            if sizes > 0.0 && dot(own, there).abs() / sizes > ALIKE {
                pairs.push((*code, *other));
            }
        }
    }
    pairs
}
