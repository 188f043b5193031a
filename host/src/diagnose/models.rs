//! Force models that are made once: for the diagnoses of one call, and in a folder for those of later calls.

use std::fs;
use std::io;
use std::path::PathBuf;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use lut_gen::chain::{Geometry, Library, LibraryError, Need};

/// Force models that were made before, to be shared by many diagnoses.
///
/// No lock is held while finite elements are solved, so that threads of a pool whose work is shared may ask at the same time. What lacks a solve that failed is given to who asked
/// for it, with what is missing, and is not kept.
#[derive(Debug)]
pub struct Models {
    state: Mutex<State>,
    /// Tells that a solve has ended.
    ended: Condvar,
    folder: Option<PathBuf>,
    need: Need,
}

impl Default for Models {
    /// For one call, with all that effects need.
    fn default() -> Self {
        let need = Need { effects: true };
        Self { state: Mutex::default(), ended: Condvar::new(), folder: None, need }
    }
}

#[derive(Debug, Default)]
struct State {
    known: Library,
    /// What is being solved now.
    begun: Vec<Geometry>,
}

/// Geometries that one call solves; others may, once it is dropped.
struct Turn<'a> {
    models: &'a Models,
    geometries: &'a [Geometry],
}

impl Drop for Turn<'_> {
    fn drop(&mut self) {
        let mut state = self.models.state();
        for geometry in self.geometries {
            if let Some(at) = state.begun.iter().position(|other| other == geometry) {
                state.begun.swap_remove(at);
            }
        }
        drop(state);
        self.models.ended.notify_all();
    }
}

/// Names the folder of kept force models; empty, none is kept.
pub const FOLDER_VARIABLE: &str = "PALPATE_CACHE";

impl Models {
    /// Force models that later calls of the program find again, in the folder that `PALPATE_CACHE` names or in the user's own for such files (`~/.cache/palpate` on Linux). Those of one ball on one
    /// specimen take some ten kilobytes. A folder that cannot be used is none.
    #[must_use]
    pub fn kept() -> Self {
        let folder = match std::env::var_os(FOLDER_VARIABLE) {
            Some(folder) => (!folder.is_empty()).then(|| PathBuf::from(folder)),
            None => dirs::cache_dir().map(|folder| folder.join("palpate")),
        };
        folder.map_or_else(Self::default, Self::kept_in)
    }

    /// The same in a folder, which is made when the first of them is.
    #[must_use]
    pub fn kept_in(folder: PathBuf) -> Self {
        Self { folder: Some(folder), ..Self::default() }
    }

    /// A library of the wanted geometries; what is missing is solved.
    ///
    /// # Errors
    /// The first force model that fails.
    pub fn of(
        &self,
        wanted: &[Geometry],
        progress: &(dyn Fn(usize, usize) + Send + Sync),
    ) -> Result<Library, LibraryError> {
        let (mut own, missing) = self.begin(wanted);
        if !missing.is_empty() {
            let turn = Turn { models: self, geometries: &missing };
            let made = Library::build(&missing, self.need, progress)?;
            let mut state = self.state();
            for geometry in made.complete().geometries() {
                // what cannot be kept is made again next time
                let _ = self.keep(&geometry, &made);
                if let (None, Some(new)) = (state.known.of(&[geometry]), made.of(&[geometry])) {
                    state.known.extend(new);
                }
            }
            drop(state);
            drop(turn);
            own.extend(made);
        }
        own.of(wanted).ok_or_else(|| LibraryError::Parameter {
            parameter: "geometries",
            value: wanted.len() as f64,
            expected: "must have been solved".to_owned(),
        })
    }

    /// What is known of the wanted geometries, in memory or in the folder, and the others: they are this call's to solve.
    ///
    /// A thread outside of any pool waits for those that another call solves. One of a pool must not, since what it would wait for may be work that it has itself
    /// interrupted: it solves them as well.
    fn begin(&self, wanted: &[Geometry]) -> (Library, Vec<Geometry>) {
        let waits = rayon::current_thread_index().is_none();
        let mut state = self.state();
        loop {
            let (mut own, mut missing) = (Library::default(), Vec::new());
            for geometry in wanted {
                if own.of(&[*geometry]).is_some() || missing.contains(geometry) {
                    continue;
                }
                let found = state.known.of(&[*geometry]).or_else(|| {
                    let kept = self.read(geometry)?;
                    state.known.extend(kept.clone());
                    Some(kept)
                });
                match found {
                    Some(found) => own.extend(found),
                    None => missing.push(*geometry),
                }
            }
            if !waits || !missing.iter().any(|geometry| state.begun.contains(geometry)) {
                state.begun.extend(&missing);
                return (own, missing);
            }
            state = self.ended.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn read(&self, geometry: &Geometry) -> Option<Library> {
        let bytes = fs::read(self.folder.as_ref()?.join(Library::file_name(geometry))).ok()?;
        Library::from_bytes(&bytes, geometry)
    }

    /// Under its name only once it is whole: two calls at a time may write the same file.
    fn keep(&self, geometry: &Geometry, library: &Library) -> io::Result<()> {
        let (Some(folder), Some(bytes)) = (&self.folder, library.to_bytes(geometry)) else { return Ok(()) };
        fs::create_dir_all(folder)?;
        let name = Library::file_name(geometry);
        let part = folder.join(format!("{name}.{}", std::process::id()));
        let written = fs::write(&part, bytes).and_then(|()| fs::rename(&part, folder.join(name)));
        if written.is_err() {
            let _ = fs::remove_file(&part);
        }
        written
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use lut_gen::solid::model::Specimen;
    use rayon::prelude::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// Of a foam without effects: a tenth of the solves.
    fn plain(folder: Option<PathBuf>) -> Models {
        Models { folder, need: Need::default(), ..Models::default() }
    }

    /// Solves counted by the progress of making models.
    fn made(models: &Models, geometry: Geometry) -> usize {
        let parts = AtomicUsize::new(0);
        let count = |_: usize, _: usize| {
            parts.fetch_add(1, Ordering::Relaxed);
        };
        let library = models.of(&[geometry], &count).unwrap();
        assert_eq!(library.geometries(), [geometry]);
        parts.into_inner()
    }

    /// Threads of one pool and threads of their own ask for the same model at the same time: all get it, and none waits for what it has itself interrupted.
    #[test]
    fn many_threads_may_ask_at_once() {
        let models = plain(None);
        let geometry = Geometry { specimen: Specimen::of_height(12.7), ball_mm: 4.0, depth_mm: 0.2, nu: 0.0 };
        let ask = || models.of(&[geometry], &|_, _| {}).unwrap().geometries();
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
        std::thread::scope(|scope| {
            let outside = scope.spawn(ask);
            let within = pool.install(|| (0..3).into_par_iter().map(|_| ask()).collect::<Vec<_>>());
            assert!(within.iter().all(|found| *found == [geometry]));
            assert_eq!(outside.join().unwrap(), [geometry]);
        });
        assert_eq!(made(&models, geometry), 0);
    }

    #[test]
    fn kept_models_are_read_damaged_ones_are_made_again_and_a_folder_that_is_none_does_no_harm() {
        let folder = tempfile::tempdir().unwrap();
        let within = folder.path().join("force models");
        let geometry = Geometry { specimen: Specimen::of_height(12.7), ball_mm: 4.0, depth_mm: 0.2, nu: 0.0 };
        assert!(made(&plain(Some(within.clone())), geometry) > 0);
        let again = plain(Some(within.clone()));
        assert_eq!(made(&again, geometry), 0);
        assert_eq!(made(&again, geometry), 0);

        let files: Vec<PathBuf> = fs::read_dir(&within).unwrap().map(|entry| entry.unwrap().path()).collect();
        let [file] = &files[..] else { panic!("{files:?}") };
        let whole = fs::read(file).unwrap();
        fs::write(file, &whole[..whole.len() / 2]).unwrap();
        assert!(made(&plain(Some(within)), geometry) > 0);
        assert_eq!(fs::read(file).unwrap(), whole);

        // a file where the folder should be
        assert!(made(&plain(Some(file.join("below"))), geometry) > 0);
    }
}
