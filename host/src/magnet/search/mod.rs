//! The best magnets within limits: parameters of files varied, flux density against volume.

mod candidate;
mod evolution;
mod variable;

use std::collections::BTreeMap;
use std::path::PathBuf;

pub use candidate::{Candidate, Limits, Unfit};
use candidate::{Care, candidate, score};
pub use evolution::Settings;
use evolution::front;
use rayon::prelude::*;
pub use variable::Variable;

/// A file whose parameters are varied.
#[derive(Debug, Clone, PartialEq)]
pub struct Source {
    /// Its name.
    pub name: String,
    /// Where it is.
    pub path: PathBuf,
    /// Its text.
    pub text: String,
    /// What is varied of it.
    pub variables: Vec<Variable>,
}

/// A search that found no magnet.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SearchError {
    /// None of a file's candidates is one.
    #[error("{name}: none of {looked} magnets is within the limits; the nearest {nearest}")]
    None {
        /// Name of the file.
        name: String,
        /// How many were looked at.
        looked: usize,
        /// What is wrong with the one nearest to a magnet.
        nearest: String,
    },
}

/// Magnets of a front that are computed with care, evenly along it.
const CAREFUL: usize = 12;

/// The front of flux density over volume of all files together, by volume, each magnet computed on two meshes. `told` hears
/// how many of how many magnets were looked at.
///
/// # Errors
/// [`SearchError`] of the first file that has no magnet within the limits.
pub fn search(
    sources: &[Source],
    limits: &Limits,
    settings: Settings,
    told: &mut dyn FnMut(usize, usize),
) -> Result<Vec<Candidate>, SearchError> {
    let total = sources.len() * settings.evaluations;
    let mut found = Vec::new();
    for (file, source) in sources.iter().enumerate() {
        let look = |at: &[f64]| {
            let set = set(source, at);
            let found = candidate((file, &source.text), &set, limits, Care::Rough);
            (score(&found), found)
        };
        let before = file * settings.evaluations;
        let best = front(source.variables.len(), settings, look, |looked| told(before + looked, total));
        let good: Vec<Candidate> = best.iter().filter_map(|scored| scored.found.clone().ok()).collect();
        if good.is_empty() {
            let nearest = best.first().and_then(|scored| scored.found.clone().err());
            let nearest = nearest.map_or("is unknown".to_owned(), |unfit| unfit.to_string());
            return Err(SearchError::None { name: source.name.clone(), looked: settings.evaluations, nearest });
        }
        found.extend(good);
    }
    let careful = |rough: &Candidate| {
        let text = &sources[rough.file].text;
        candidate((rough.file, text), &rough.set, limits, Care::Usual).ok()
    };
    let chosen = evenly(undominated(found));
    Ok(undominated(chosen.par_iter().filter_map(careful).collect()))
}

/// Values of a file's variables at a point of the unit cube.
fn set(source: &Source, at: &[f64]) -> BTreeMap<String, f64> {
    source.variables.iter().zip(at).map(|(variable, part)| (variable.name.clone(), variable.at(*part))).collect()
}

/// Candidates that no other is smaller than and as strong, by volume.
fn undominated(mut found: Vec<Candidate>) -> Vec<Candidate> {
    found.sort_by(|a, b| a.volume_cm3.total_cmp(&b.volume_cm3).then(b.flux.size_t().total_cmp(&a.flux.size_t())));
    let mut most = 0.0;
    found.retain(|candidate| {
        let is_stronger = candidate.flux.size_t() > most;
        most = candidate.flux.size_t().max(most);
        is_stronger
    });
    found
}

/// So many of a front that are as far from each other in flux density as can be, both ends among them.
fn evenly(front: Vec<Candidate>) -> Vec<Candidate> {
    let (Some(first), Some(last)) = (front.first(), front.last()) else { return front };
    if front.len() <= CAREFUL {
        return front;
    }
    let (low, high) = (first.flux.size_t(), last.flux.size_t());
    let mut chosen: Vec<usize> = (0..CAREFUL)
        .filter_map(|i| {
            let wanted = low + (high - low) * i as f64 / (CAREFUL - 1) as f64;
            let off = |k: &usize| (front[*k].flux.size_t() - wanted).abs();
            (0..front.len()).min_by(|a, b| off(a).total_cmp(&off(b)))
        })
        .collect();
    chosen.dedup();
    chosen.into_iter().map(|i| front[i].clone()).collect()
}
