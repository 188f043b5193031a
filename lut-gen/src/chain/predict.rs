//! Force readings that a model predicts for the runs of an experiment.

use super::{Library, Model, Passage, Setting};
use crate::effect::{
    adhesion, compliance, contact_offset, depth_gain, drift, friction, lag, numerics, poisson, radius, relaxation,
    second_term, sensor_creep, sensor_gain, sensor_nonlinearity, softening, thickness, time_gain,
};
use crate::solid::model::ForceSlice;

/// A library and the runs it is asked for.
#[derive(Debug, Clone)]
pub struct Chain {
    /// Forces of every geometry.
    pub library: Library,
    /// The runs.
    pub passages: Vec<Passage>,
}

/// Readings of one run (N), one a node of its [`Passage`].
pub type Prediction = Vec<f64>;

/// Rounds in which the depth of the ball is found on a machine that gives way: the share `c dF/dd` that each leaves is below
/// 0.2 for what is in the bounds, squared by Newton's rule.
const ROUNDS: usize = 4;
/// Correction of the depth, mm, that is the last: what the next one would change is nothing even to a difference quotient.
const FOUND_MM: f64 = 1e-9;

/// Force of one geometry under a model.
struct Elastic {
    slices: Vec<(f64, ForceSlice)>,
    /// True over declared radius.
    scale: f64,
    /// Energy (N mm) stored at depths evenly in their square root, and the last of these; empty when nobody asks.
    energy: (Vec<f64>, f64),
}

/// Pieces of the table of energies: its error is `(5 * 4 / 8) / pieces^2` of an energy that grows as the fifth power of the root.
const ENERGIES: usize = 128;

impl Elastic {
    /// Forces (N) and slopes (N/mm) at some depths (mm). Lengths scale with the ball: `F(R s, h, d) = s^2 F(R, h / s, d / s)`.
    fn forces_and_slopes(&self, depth_mm: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let (mut force_n, mut slope) = (vec![0.0; depth_mm.len()], vec![0.0; depth_mm.len()]);
        for (mu_mpa, slice) in &self.slices {
            let mut places = force_n.iter_mut().zip(&mut slope);
            let unit = mu_mpa * self.scale;
            slice.forces_and_slopes(depth_mm.iter().map(|d| d / self.scale), |(f, df)| {
                places.next().into_iter().for_each(|(force, slope)| {
                    *force += unit * self.scale * f;
                    *slope += unit * df;
                });
            });
        }
        (force_n, slope)
    }

    /// The forces alone at some depths.
    fn forces(&self, depth_mm: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; depth_mm.len()];
        for (mu_mpa, slice) in &self.slices {
            let mut places = sum.iter_mut();
            let unit_n = mu_mpa * self.scale * self.scale;
            slice.forces(depth_mm.iter().map(|d| d / self.scale), |force| {
                places.next().into_iter().for_each(|sum| *sum += unit_n * force);
            });
        }
        sum
    }
}

impl Elastic {
    /// Tabulates the energy of a press, by Simpson's rule on `F dd = F 2 x dx`, `d = x^2`.
    fn store(&mut self, depth_mm: f64) {
        let end = depth_mm.sqrt();
        let step = end / ENERGIES as f64;
        let roots: Vec<f64> = (0..=2 * ENERGIES).map(|k| 0.5 * k as f64 * step).collect();
        let force_n = self.forces(&roots.iter().map(|x| x * x).collect::<Vec<_>>());
        let rate: Vec<f64> = force_n.iter().zip(&roots).map(|(f, x)| f * 2.0 * x).collect();
        let mut table = vec![0.0];
        let mut sum = 0.0;
        for piece in rate.windows(3).step_by(2) {
            sum += step / 6.0 * (piece[0] + 4.0 * piece[1] + piece[2]);
            table.push(sum);
        }
        self.energy = (table, end);
    }

    /// Energy at a depth over that at the deepest, both in mm.
    fn energy_share(&self, depth_mm: f64, deepest_mm: f64) -> f64 {
        let (table, end) = &self.energy;
        let at = |depth_mm: f64| {
            let place = (depth_mm.max(0.0).sqrt() / end * ENERGIES as f64).min(ENERGIES as f64 - 1e-9);
            let k = place as usize;
            table[k] + (place - k as f64) * (table[k + 1] - table[k])
        };
        let whole = at(deepest_mm);
        if whole > 0.0 { (at(depth_mm) / whole).clamp(0.0, 1.0) } else { 0.0 }
    }
}

impl Chain {
    /// Readings of all runs. `contact_mm` is what each run's contact point adds to the recorded depth of contact.
    #[must_use]
    pub fn predict(&self, model: &Model, contact_mm: &[f64]) -> Vec<Prediction> {
        let mut known: Vec<((usize, usize, usize), Elastic)> = Vec::new();
        for passage in &self.passages {
            let key = (passage.geometry, passage.specimen, passage.indenter);
            if !known.iter().any(|(k, _)| *k == key) {
                known.push((key, self.elastic(model, passage)));
            }
        }
        let of = |p: &Passage| {
            let key = (p.geometry, p.specimen, p.indenter);
            known.iter().find(|(k, _)| *k == key).map(|(_, elastic)| elastic)
        };
        let each = self.passages.iter().enumerate().zip(contact_mm);
        each.map(|((run, p), contact)| {
            of(p).map_or_else(Vec::new, |elastic| {
                let (_, force) = self.pressed(model, (run, p), *contact, elastic);
                self.sensed(model, p, force)
            })
        })
        .collect()
    }

    /// Depth of the ball (mm), where machine and clock have done theirs to the recorded one.
    pub(super) fn ball_depth(&self, model: &Model, passage: &Passage, contact_mm: f64) -> Vec<f64> {
        let model = Model { whole: None, ..model.clone() };
        self.pressed(&model, (0, passage), contact_mm, &self.elastic(&model, passage)).0
    }

    /// Force (N) of the specimen on a ball that follows the depths of a passage.
    pub(super) fn on_ball(&self, model: &Model, passage: &Passage) -> Vec<f64> {
        let elastic = self.elastic(model, passage);
        let bare_n = elastic.forces(&passage.depth_mm);
        self.specimen_force(model, passage, (&passage.depth_mm, bare_n), &elastic)
    }

    fn elastic(&self, model: &Model, passage: &Passage) -> Elastic {
        let family = &self.library.families[passage.geometry];
        let geometry = &family.geometry;
        let scale = (geometry.ball_mm + model.first(&radius::EFFECT, passage.indenter)) / geometry.ball_mm;
        let height = geometry.specimen.height_mm + model.height_error_mm(passage.specimen);
        let sliding = model.first(&thickness::SLIDING, passage.specimen);
        let nu = model.first(&poisson::EFFECT, 0);
        let slice = |alpha: f64| family.slice(alpha, nu, height / scale, sliding);
        let mut slices = vec![(model.mu_mpa, slice(model.alpha))];
        for second in model.of(&second_term::EFFECT) {
            if let [ratio, alpha] = second.values[..] {
                slices.push((ratio * model.mu_mpa, slice(alpha)));
            }
        }
        let mut elastic = Elastic { slices, scale, energy: (Vec::new(), 0.0) };
        if model.of(&softening::EFFECT).next().is_some() {
            elastic.store(geometry.depth_mm);
        }
        elastic
    }

    /// Depth of the ball (mm) and force on it (N) in one run.
    fn pressed(
        &self,
        model: &Model,
        (run, passage): (usize, &Passage),
        contact_mm: f64,
        elastic: &Elastic,
    ) -> (Vec<f64>, Vec<f64>) {
        let recorded = model.driven(&passage.time_s, &passage.depth_mm, contact_mm);
        let missed_n: Vec<f64> =
            model.whole.iter().flat_map(|whole| whole.missed_n(run, recorded.len(), model)).collect();
        let force_on = |depth_mm: &[f64], bare_n: Vec<f64>| {
            let mut force = self.specimen_force(model, passage, (depth_mm, bare_n), elastic);
            force.iter_mut().zip(&missed_n).for_each(|(f, missed)| *f += missed);
            force
        };
        let mm_per_n = model.first(&compliance::EFFECT, 0);
        if mm_per_n == 0.0 {
            let force = force_on(&recorded, elastic.forces(&recorded));
            return (recorded, force);
        }
        let mut depth = recorded.clone();
        let (bare_n, mut slope) = elastic.forces_and_slopes(&depth);
        let mut force = force_on(&depth, bare_n);
        for _ in 0..ROUNDS {
            let mut longest: f64 = 0.0;
            for (((d, x), f), slope) in depth.iter_mut().zip(&recorded).zip(&force).zip(&slope) {
                let correction = compliance::correction(*x, *d, *f, *slope, mm_per_n);
                longest = longest.max(correction.abs());
                *d += correction;
            }
            let (bare_n, next) = elastic.forces_and_slopes(&depth);
            force = force_on(&depth, bare_n);
            slope = next;
            if longest < FOUND_MM {
                break;
            }
        }
        (depth, force)
    }

    /// Force of the specimen on the ball over depths (mm) of the ball, of which the elastic force (N) is given.
    fn specimen_force(
        &self,
        model: &Model,
        passage: &Passage,
        (depth_mm, mut force): (&[f64], Vec<f64>),
        elastic: &Elastic,
    ) -> Vec<f64> {
        let family = &self.library.families[passage.geometry];
        let share = model.first(&numerics::EFFECT, 0);
        let deepest = depth_mm.iter().copied().fold(0.0, f64::max);
        if share != 0.0 {
            force.iter_mut().zip(depth_mm).for_each(|(f, d)| *f *= 1.0 + share * d / family.geometry.depth_mm);
        }
        let coefficient = model.first(&friction::EFFECT, 0);
        if coefficient != 0.0 {
            let mut up = false;
            let mut before = f64::NEG_INFINITY;
            for (f, d) in force.iter_mut().zip(depth_mm) {
                // in a hold the ball has not turned yet
                up = if *d < before - friction::TURN * deepest { true } else { up && *d <= before };
                before = *d;
                *f *= family.rubbed(model.alpha, coefficient, d / deepest.max(f64::MIN_POSITIVE), up);
            }
        }
        for setting in model.of(&softening::EFFECT) {
            self.soften(&mut force, model, setting, passage, depth_mm, elastic);
        }
        self.relax(model, passage, depth_mm, elastic, &mut force);
        let work = model.first(&adhesion::EFFECT, 0);
        if work != 0.0 {
            let radius_mm = family.geometry.ball_mm * elastic.scale;
            force.iter_mut().zip(depth_mm).for_each(|(f, d)| *f -= adhesion::attraction_n(work, radius_mm, *d));
        }
        force
    }

    fn soften(
        &self,
        force: &mut [f64],
        model: &Model,
        setting: &Setting,
        passage: &Passage,
        depth_mm: &[f64],
        elastic: &Elastic,
    ) {
        let (loss, scale) = (setting.values[0], setting.values[1]);
        let mut deepest = model.before_mm(passage.pressed_before_mm, &passage.depth_mm, depth_mm);
        for (f, d) in force.iter_mut().zip(depth_mm) {
            if *d >= deepest {
                deepest = *d;
            } else if *d > 0.0 {
                *f *= softening::factor(loss, scale, elastic.energy_share(*d, deepest));
            }
        }
    }

    fn relax(&self, model: &Model, passage: &Passage, depth_mm: &[f64], elastic: &Elastic, force: &mut [f64]) {
        let terms = model.relaxing();
        if terms.is_empty() {
            return;
        }
        let family = &self.library.families[passage.geometry];
        let share = model.first(&relaxation::MEMORY, 0);
        let carried = share * family.carried(model.alpha) / (family.geometry.ball_mm * elastic.scale);
        let shape: Vec<f64> = depth_mm.iter().map(|d| (-carried * d.max(0.0)).exp()).collect();
        relaxation::relaxed(&passage.time_s, &shape, &terms, force);
    }

    fn sensed(&self, model: &Model, passage: &Passage, mut force: Vec<f64>) -> Prediction {
        model.read(&passage.time_s, passage.start_s, &mut force);
        force
    }
}

impl Model {
    /// Depth (mm) past touch that a machine drives to which does not give way, where `depth_mm` was recorded at times (s) and touch was recorded at `contact_mm`.
    pub(super) fn driven(&self, time_s: &[f64], depth_mm: &[f64], contact_mm: f64) -> Vec<f64> {
        let (offset, gain) = (self.first(&contact_offset::EFFECT, 0), self.first(&depth_gain::EFFECT, 0));
        let mut driven: Vec<f64> =
            depth_mm.iter().map(|d| depth_gain::true_mm(d - contact_mm, gain) + offset).collect();
        let clock = self.clock();
        for setting in self.of(&lag::FILTER) {
            driven = lag::filtered(time_s, &driven, clock * setting.values[0]);
        }
        for setting in self.of(&lag::RATE_LIMIT) {
            driven = lag::limited(time_s, &driven, clock * setting.values[0]);
        }
        driven
    }

    /// Depth (mm) of the ball in earlier presses on a spot, 0 on a fresh one, where it was recorded as `before_mm` and the ball of this run follows
    /// `depth_mm` for the recorded `recorded_mm`.
    pub(super) fn before_mm(&self, before_mm: f64, recorded_mm: &[f64], depth_mm: &[f64]) -> f64 {
        if before_mm <= 0.0 {
            return 0.0;
        }
        let gain = self.first(&depth_gain::EFFECT, 0);
        let shift_mm =
            recorded_mm.first().zip(depth_mm.first()).map_or(0.0, |(x, d)| d - depth_gain::true_mm(*x, gain));
        depth_gain::true_mm(before_mm, gain) + shift_mm
    }

    /// Recorded over true time: by so much longer is what takes its time.
    fn clock(&self) -> f64 {
        self.first(&time_gain::EFFECT, 0)
    }

    /// Parts and times (s, on the recorded clock) of all relaxation.
    #[must_use]
    pub fn relaxing(&self) -> Vec<(f64, f64)> {
        let clock = self.clock();
        let settings = [&relaxation::ONE, &relaxation::TWO].into_iter().flat_map(|effect| self.of(effect));
        let terms = settings.flat_map(|s| s.values.chunks_exact(2)).map(|t| (t[0], t[1]));
        let spectra = self.of(&relaxation::SPECTRUM).flat_map(|s| s.values.chunks_exact(2));
        let all = terms.chain(spectra.flat_map(|s| relaxation::spectrum(s[0], s[1])));
        all.map(|(part, tau_s)| (part, clock * tau_s)).collect()
    }

    /// Makes readings of the forces (N) on a sensor at times (s) of a run that begins at `start_s` on the session clock.
    pub fn read(&self, time_s: &[f64], start_s: f64, force_n: &mut [f64]) {
        self.remember(time_s, force_n);
        let quadratic = self.first(&sensor_nonlinearity::EFFECT, 0);
        let gain = self.first(&sensor_gain::EFFECT, 0);
        let per_hour = self.first(&drift::EFFECT, 0) / self.clock();
        for (f, t) in force_n.iter_mut().zip(time_s) {
            *f = gain * (*f + quadratic * *f * *f) + drift::zero_n(per_hour, start_s + t);
        }
    }

    /// The part of [`Model::read`] that depends on earlier forces: creep and hysteresis of the sensor.
    pub fn remember(&self, time_s: &[f64], force_n: &mut [f64]) {
        for setting in self.of(&sensor_creep::CREEP) {
            sensor_creep::creep(time_s, force_n, (setting.values[0], self.clock() * setting.values[1]));
        }
        for setting in self.of(&sensor_creep::HYSTERESIS) {
            sensor_creep::hysteresis(force_n, setting.values[0]);
        }
    }

    /// Recorded depth (mm) on a block that does not give way, where its surface is at 0: what the machine yields under a force (N), less what
    /// the recorded contact is too late, as the gauge of the depth reads it.
    #[must_use]
    pub fn yielded_mm(&self, force_n: f64) -> f64 {
        let true_mm = self.first(&compliance::EFFECT, 0) * force_n - self.first(&contact_offset::EFFECT, 0);
        self.first(&depth_gain::EFFECT, 0) * true_mm
    }
}
