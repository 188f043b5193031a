//! Loading curves of specimens that are compressed between faces or pulled, of stated height and area.

use crate::experiment::motion::Motion;
use crate::experiment::{Experiment, Length};

use super::contact;
use super::data::{LEAST_SAMPLES, LeftOut, LoadingCurve, Selection};
use super::grip::Grip;
use super::samples::FACE_EXPONENT;
use super::spec::{Extra, FitSpec};
use super::zero::Unsure;

/// Largest share of its height that a specimen is shortened by in the model.
pub const SHORTEST: f64 = 0.9;
/// A loading of more samples than this is averaged over neighbours, which loses nothing: a curve has no more than some ten
/// independent shapes.
const MOST_SAMPLES: usize = 200;
/// Room past the deepest sample for a contact found later than guessed, as a share of the height.
const ROOM: f64 = 0.02;

impl Selection {
    /// Adds the first loading branch of a run between faces, cut at [`SHORTEST`] in compression, with its hold where holds are
    /// fitted.
    pub(super) fn add_coupon(
        &mut self,
        experiment: &Experiment,
        motions: &[Option<Motion>],
        at: usize,
        specimen: usize,
        grip: Grip,
    ) -> Result<(), LeftOut> {
        let (run, stated) = (&experiment.runs[at], &experiment.specimens[specimen]);
        let (Some(height_mm), Some(_)) = (stated.height_mm.known(), stated.radius_mm.known()) else {
            return Err(LeftOut::Unmeasured);
        };
        let motion = motions.get(at).and_then(Option::as_ref).ok_or(LeftOut::TooFewPoints)?;
        self.tell(run, motion);
        let recorded = &run.recording;
        let zero = self.zero_of(run, motion, FACE_EXPONENT);
        let all = zero.taken_off(run, 0..recorded.len());
        let forces = &all[motion.loading.clone()];
        let depths = &recorded.depth_mm[motion.loading.clone()];
        if depths.len() < LEAST_SAMPLES {
            return Err(LeftOut::TooFewPoints);
        }
        let contact = contact::guess_of_faces(depths, forces, height_mm).ok_or(LeftOut::NoContact)?;
        let most_mm = if grip == Grip::Jaws { f64::INFINITY } else { SHORTEST * height_mm };
        let kept = |depth: f64| depth - contact.low_mm <= most_mm;
        let cut = depths.iter().filter(|depth| !kept(**depth)).count();
        let whole = cut == 0;
        // A depth that is read less often than the file is written fits its force only where it is new.
        let is_new = |sample: &usize| *sample == 0 || recorded.depth_mm[*sample] != recorded.depth_mm[*sample - 1];
        let samples: Vec<usize> = motion.loading.clone().filter(|s| kept(recorded.depth_mm[*s]) && is_new(s)).collect();
        if !whole {
            self.messages.push(format!(
                "{}: shortened by more than {SHORTEST} of its height of {height_mm} mm; cut there, {} of {} samples are used",
                run.file,
                motion.loading.len() - cut,
                motion.loading.len(),
            ));
        }
        if samples.iter().filter(|&&sample| recorded.depth_mm[sample] > contact.contact_mm).count() < LEAST_SAMPLES {
            return Err(if whole { LeftOut::TooFewPoints } else { LeftOut::TooDeep });
        }
        let together = samples.len().div_ceil(MOST_SAMPLES);
        let mut blocks: Vec<Vec<usize>> = samples.chunks(together).map(<[usize]>::to_vec).collect();
        if together > 1 {
            self.messages.push(format!("{}: {together} samples each are averaged", run.file));
        }
        let hold_from = blocks.len();
        if self.holds {
            match motion.hold.clone().filter(|_| whole && motion.loading_is_whole()) {
                Some(hold) => blocks.extend(hold.map(|sample| vec![sample])),
                None => self.messages.push(format!("{}: no hold is fitted, only its loading", run.file)),
            }
        }
        let deepest = blocks.iter().flatten().map(|&s| recorded.depth_mm[s]).fold(f64::NEG_INFINITY, f64::max);
        let reach = (deepest - contact.low_mm + ROOM * height_mm).min(most_mm);
        let pairing = self.pairing(specimen, grip, Length::Known(height_mm), reach);
        let end_s = recorded.time_s[motion.loading.end - 1];
        let mean = |values: &[f64], block: &Vec<usize>| {
            block.iter().map(|&sample| values[sample]).sum::<f64>() / block.len() as f64
        };
        let column = |values: &[f64]| -> Vec<f64> { blocks.iter().map(|block| mean(values, block)).collect() };
        self.curves.push(LoadingCurve {
            run: at,
            pairing,
            unsure: Unsure::default(),
            zero_is_free: false,
            depth_mm: column(&recorded.depth_mm),
            force_n: column(&all),
            time_s: column(&recorded.time_s).iter().map(|time| time - end_s).collect(),
            hold_from,
            contact,
            rate_mm_per_s: motion.rate_mm_per_s,
            hold_out: run.hold_out,
        });
        Ok(())
    }
}

/// What is taken for granted of specimens between faces.
pub(super) fn assumptions(selection: &Selection, spec: &FitSpec) -> Vec<String> {
    let on = |grip: Grip| selection.pairings.iter().any(|pairing| pairing.grip == grip);
    let mut list = Vec::new();
    if on(Grip::Platens) {
        list.push(match (spec.rubs(), spec.free.contains(&Extra::PlatenFriction)) {
            (false, _) => {
                "platens do not rub: every point of a compressed specimen deforms alike, its sides free".to_owned()
            }
            (true, false) => format!("friction between platens and specimen {}", spec.platen_friction),
            (true, true) => "a compressed specimen is a round cylinder whose faces rub on the platens".to_owned(),
        });
    }
    if on(Grip::Ring) {
        list.push("a confined specimen fills its rigid ring from the start and does not rub on it".to_owned());
    }
    if on(Grip::Jaws) {
        list.push("a pulled specimen deforms alike over its stated height, its sides free".to_owned());
    }
    list
}
