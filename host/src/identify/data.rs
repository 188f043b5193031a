//! From runs to loading curves: what is fitted, what is left out, and why.

use crate::experiment::motion::Motion;
use crate::experiment::{Experiment, Length, Test};

use super::contact::{self, ContactGuess};
use super::grip::Grip;
use super::samples::{BALL_EXPONENT, Samples};
use super::zero::{self, Unsure};

/// Deepest share of a specimen's height the model is trusted at.
pub const DEEPEST_OF_HEIGHT: f64 = 0.8;
/// Share of the height the model itself is built for: data end at [`DEEPEST_OF_HEIGHT`] past the
/// guessed contact, and the fitted contact may lie before it.
pub const MODEL_OF_HEIGHT: f64 = 0.82;
/// A curve with fewer samples past contact says nothing.
pub const LEAST_SAMPLES: usize = 8;
/// Bounds of a height written `"unknown"`, mm; the lower one also exceeds the depth reached.
pub const UNKNOWN_HEIGHT_MM: (f64, f64) = (5.0, 40.0);

/// Height of a specimen in the fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Height {
    /// Measured, mm.
    Known(f64),
    /// The n-th free height.
    Free(usize),
}

/// A specimen and what deforms it: one forward model.
#[derive(Debug, Clone, PartialEq)]
pub struct Pairing {
    /// Index into [`Experiment::specimens`].
    pub specimen: usize,
    /// The ball, or what else.
    pub grip: Grip,
    /// Height of the specimen.
    pub height: Height,
    /// Largest depth its runs reach, mm, with the whole search range of contact points.
    pub depth_mm: f64,
}

/// The first loading branch of a run, cut to what the model covers, and the hold after it where that is fitted.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadingCurve {
    /// Index into [`Experiment::runs`].
    pub run: usize,
    /// Index into [`Selection::pairings`].
    pub pairing: usize,
    /// Depth readings, mm.
    pub depth_mm: Vec<f64>,
    /// Forces, N.
    pub force_n: Vec<f64>,
    /// Times since the end of loading, s; negative before.
    pub time_s: Vec<f64>,
    /// Number of the first sample of the hold; that of all samples without one.
    pub hold_from: usize,
    /// Contact point to start from.
    pub contact: ContactGuess,
    /// Speed, mm/s.
    pub rate_mm_per_s: f64,
    /// What the zero of its force may still be.
    pub unsure: Unsure,
    /// No approach shows that zero.
    pub zero_is_free: bool,
    /// Only predicted.
    pub hold_out: bool,
}

/// A free height and its bounds.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeHeight {
    /// Index into [`Experiment::specimens`].
    pub specimen: usize,
    /// Lower bound, mm.
    pub low_mm: f64,
    /// Upper bound, mm.
    pub high_mm: f64,
}

/// Why a run is not fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LeftOut {
    /// The ball never went down, or too few samples were taken on the way.
    TooFewPoints,
    /// Force never rose above its noise.
    NoContact,
    /// What is left above the model's deepest point is too little.
    TooDeep,
    /// The height or the area of a specimen that is compressed or pulled is not known.
    Unmeasured,
}

/// Everything a material's fit works on.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Selection {
    /// Distinct forward models.
    pub pairings: Vec<Pairing>,
    /// Curves of the runs that are used.
    pub curves: Vec<LoadingCurve>,
    /// Heights to be found.
    pub heights: Vec<FreeHeight>,
    /// Runs that are not used.
    pub left_out: Vec<(usize, LeftOut)>,
    /// What the reader should know about the data.
    pub messages: Vec<String>,
    /// Holds are fitted as well.
    pub holds: bool,
}

/// Selects the first loading branches of all runs that indent, compress or pull specimens of `material`, with the holds
/// after them if `holds`.
pub fn select(experiment: &Experiment, motions: &[Option<Motion>], material: &str, holds: bool) -> Selection {
    let mut selection = Selection { holds, ..Selection::default() };
    for (at, run) in experiment.runs.iter().enumerate() {
        let Some(specimen) = run.specimen else { continue };
        let belongs = experiment.specimens[specimen].material == material
            && experiment.specimens[specimen].base_law != crate::experiment::BaseLaw::Rigid;
        if !belongs {
            continue;
        }
        selection.messages.extend(run.troubles.iter().map(|trouble| format!("{}: {trouble}", run.file)));
        let added = match (run.test, run.indenter, Grip::without_ball(run.test)) {
            (Test::Indentation, Some(indenter), _) => selection.add(experiment, motions, at, specimen, indenter),
            (_, _, Some(grip)) => selection.add_coupon(experiment, motions, at, specimen, grip),
            _ => continue,
        };
        if let Err(why) = added {
            let text = match why {
                LeftOut::TooFewPoints => "too few samples on the way down",
                LeftOut::NoContact => "force never rises above its noise: no contact",
                LeftOut::TooDeep => "too few samples above the deepest point of the model",
                LeftOut::Unmeasured => "the specimen's height and radius_mm (or area_mm2) must be known in this test",
            };
            selection.messages.push(format!("{}: not used, {text}", run.file));
            selection.left_out.push((at, why));
        }
    }
    selection.bound_heights();
    selection.tell_holds(experiment, motions);
    selection.compare_lengths(experiment);
    selection
}

impl Selection {
    fn add(
        &mut self,
        experiment: &Experiment,
        motions: &[Option<Motion>],
        at: usize,
        specimen: usize,
        indenter: usize,
    ) -> Result<(), LeftOut> {
        let run = &experiment.runs[at];
        let motion = motions.get(at).and_then(Option::as_ref).ok_or(LeftOut::TooFewPoints)?;
        self.tell(run, motion);
        if motion.loading.len() < LEAST_SAMPLES {
            return Err(LeftOut::TooFewPoints);
        }
        let zero = self.zero_of(run, motion, BALL_EXPONENT);
        let mut samples = Samples::of(run, &zero, motion.loading.clone());
        if samples.together > 1 {
            self.messages.push(format!("{}: {} samples each are averaged", run.file, samples.together));
        }
        let ball_mm = experiment.indenters[indenter].radius_mm.known().ok_or(LeftOut::NoContact)?;
        let contact = contact::guess(&samples.depth_mm, &samples.force_n, ball_mm).ok_or(LeftOut::NoContact)?;
        let height = experiment.specimens[specimen].height_mm;
        let deepest = deepest(ball_mm, height);
        // Past the guessed contact, not past the reading's zero, so that the cut does not depend on
        // the fit.
        let (all, goes_mm) = (samples.len(), samples.depth_mm[samples.len() - 1] - contact.contact_mm);
        samples.cut(contact.contact_mm + deepest);
        let kept = samples.len();
        if kept < all {
            let reason = if deepest < ball_mm { "0.8 of the specimen's height" } else { "the ball's equator" };
            self.messages.push(format!(
                "{}: goes {goes_mm:.2} mm past contact, deeper than {reason} ({deepest:.2} mm); cut there, {kept} of {all} samples are used",
                run.file,
            ));
        }
        let touching = samples.depth_mm.iter().filter(|d| **d > contact.contact_mm).count();
        if touching < LEAST_SAMPLES {
            return Err(if kept < LEAST_SAMPLES { LeftOut::TooDeep } else { LeftOut::TooFewPoints });
        }
        let reach = samples.depth_mm.iter().copied().fold(f64::NEG_INFINITY, f64::max) - contact.low_mm;
        // The model also has to reach where an earlier contact puts the last sample, but not the
        // specimen's base.
        let reach = height.known().map_or(reach, |mm| reach.min(MODEL_OF_HEIGHT * mm));
        let pairing = self.pairing(specimen, Grip::Ball { indenter, radius_mm: ball_mm }, height, reach);
        if let Height::Free(free) = self.pairings[pairing].height {
            // The table was not met, so the block is higher than the ball ever went into it.
            let deepest = run.recording.depth_mm.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let low_mm = &mut self.heights[free].low_mm;
            *low_mm = low_mm.max(deepest - contact.contact_mm);
        }
        if self.holds {
            // A ramp that was cut does not reach the depth at which the ball stood.
            match motion.hold.clone().filter(|_| kept == all && motion.loading_is_whole()) {
                Some(hold) => samples.append(Samples::of(run, &zero, hold)),
                None => self.messages.push(format!("{}: no hold is fitted, only its loading", run.file)),
            }
        }
        let end_s = run.recording.time_s[motion.loading.end - 1];
        let Samples { depth_mm, force_n, time_s, .. } = samples;
        let time_s = time_s.iter().map(|time| time - end_s).collect();
        let (rate_mm_per_s, hold_out) = (motion.rate_mm_per_s, run.hold_out);
        let zero_is_free = zero.approach.is_none() && !experiment.sensor.zero_is_known;
        let unsure = match zero.approach {
            Some(approach) if zero.is_off => approach.unsure(&depth_mm),
            None if zero_is_free => zero::unseen(&depth_mm, &force_n),
            _ => Unsure::default(),
        };
        self.curves.push(LoadingCurve {
            zero_is_free: zero_is_free && !unsure.is_empty(),
            unsure,
            run: at,
            pairing,
            depth_mm,
            force_n,
            time_s,
            hold_from: kept,
            contact,
            rate_mm_per_s,
            hold_out,
        });
        Ok(())
    }

    pub(super) fn pairing(&mut self, specimen: usize, grip: Grip, height: Length, depth_mm: f64) -> usize {
        let known = self.pairings.iter().position(|p| p.specimen == specimen && p.grip == grip);
        if let Some(at) = known {
            self.pairings[at].depth_mm = self.pairings[at].depth_mm.max(depth_mm);
            return at;
        }
        let height = match height {
            Length::Known(mm) => Height::Known(mm),
            Length::Unknown => Height::Free(self.free_height(specimen)),
        };
        self.pairings.push(Pairing { specimen, grip, height, depth_mm });
        self.pairings.len() - 1
    }

    fn free_height(&mut self, specimen: usize) -> usize {
        self.heights.iter().position(|h| h.specimen == specimen).unwrap_or_else(|| {
            let (low_mm, high_mm) = UNKNOWN_HEIGHT_MM;
            self.heights.push(FreeHeight { specimen, low_mm, high_mm });
            self.heights.len() - 1
        })
    }

    /// True when a run compresses or pulls a whole specimen.
    #[must_use]
    pub fn has_coupons(&self) -> bool {
        self.pairings.iter().any(|pairing| pairing.grip.mode().is_some())
    }

    /// Free heights also leave room for the model.
    fn bound_heights(&mut self) {
        for pairing in &self.pairings {
            if let Height::Free(at) = pairing.height {
                let height = &mut self.heights[at];
                height.low_mm = height.low_mm.max(pairing.depth_mm / MODEL_OF_HEIGHT);
                height.high_mm = height.high_mm.max(2.0 * height.low_mm);
            }
        }
    }

    /// Eq. 14 adds up samples, so a long run weighs more than a short one.
    fn compare_lengths(&mut self, experiment: &Experiment) {
        let fitted = self.curves.iter().filter(|c| !c.hold_out);
        let Some(longest) = fitted.clone().max_by_key(|c| c.depth_mm.len()) else { return };
        let Some(shortest) = fitted.min_by_key(|c| c.depth_mm.len()) else { return };
        let (most, least) = (longest.depth_mm.len(), shortest.depth_mm.len());
        if most as f64 > 1.1 * least as f64 {
            self.messages.push(format!(
                "runs differ in length: {} has {most} samples, {} has {least}; every sample counts, so the longer one weighs more",
                experiment.runs[longest.run].file, experiment.runs[shortest.run].file,
            ));
        }
    }
}

/// Deepest indentation that a ball's model covers, mm: its equator, or a share of the height.
pub fn deepest(ball_mm: f64, height: Length) -> f64 {
    height.known().map_or(ball_mm, |height_mm| ball_mm.min(DEEPEST_OF_HEIGHT * height_mm))
}
