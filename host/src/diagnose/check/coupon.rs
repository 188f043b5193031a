//! Coupons: pieces of the foam that are compressed as a whole, between platens or in a ring.
//!
//! Every point deforms alike, so that the force is the law's own and knows nothing of ball, friction and contact. What a coupon is not: exactly as large and as stiff as it is
//! said to be, flat, or touched where it is said to be touched. That is what its rows may be off by together.

use std::sync::Arc;

use lut_gen::chain::{Model, Rubbing, Shortening, Sides};
use nalgebra::{DMatrix, DVector};

use crate::experiment::motion::{self, Motion};
use crate::experiment::{BaseLaw, Experiment, Recording, Run, Test};
use crate::identify::contact;

use super::super::design::usable::{LEAST_SAMPLES, MEANT_MM};
use super::super::design::windows::{Branch, Node, even, growing, lift, node};
use super::super::scatter::{Jitter, SensorNoise};
use super::super::variable::Variable;

/// A coupon with what is compared of its run.
#[derive(Debug, Clone, PartialEq)]
pub struct Coupon {
    /// Its motion at the places where force is predicted.
    run: Shortening,
    /// Which of these a row is the mean of, with weights that add up to 1.
    of: Vec<Vec<(usize, f64)>>,
    /// Rows.
    nodes: Vec<Node>,
}

/// Most windows of the way down, of a hold and of the way back.
const WINDOWS: (usize, usize, usize) = (24, 10, 12);
/// Places within a window: the mean of a force of exponent 20 over a fiftieth of the height is met to 0.02 % by four.
const PLACES: usize = 4;
/// Shares of the height from which and up to which the way down is compared: before, faces that are not quite parallel are still coming to rest; beyond, the cells of a foam
/// lie on each other, and no law of two or three parameters follows them.
const SHARES: (f64, f64) = (0.03, 0.6);
/// First touch is unknown by this beside the jitter of contacts (mm): faces that are not parallel touch one after the other.
const TOUCH_MM: f64 = 0.1;
/// Poisson's ratio of a rubber between platens.
const INCOMPRESSIBLE: f64 = 0.5;
/// Shapes and deepest shortenings that are one to the platens, as parts of themselves.
const ONE_SHAPE: f64 = 0.01;
/// A coupon's diameter is known to this (mm), which is 0.5 % of the area of one of 50 mm.
const DIAMETER_MM: f64 = 0.12;
/// Its height is known to this part of itself: a calliper presses on it.
const HEIGHT: f64 = 0.01;
/// Two kinds of test on one foam agree to this part of the force: a coupon is another piece of it than the one that is pressed.
const AGREE: f64 = 0.007;

impl Coupon {
    /// Of a run; what is left out of it is told in `messages`. `before_mm` is how far its coupon was shortened in earlier runs (recorded).
    ///
    /// # Errors
    /// Why it says nothing.
    pub(super) fn of(
        experiment: &Experiment,
        run: &Run,
        before_mm: f64,
        messages: &mut Vec<String>,
    ) -> Result<Self, String> {
        let sides = if run.test == Test::Confined { Sides::Held } else { Sides::Free };
        let at = run.specimen.ok_or("a coupon of no specimen says nothing of the material")?;
        let its = &experiment.specimens[at];
        match its.base_law {
            BaseLaw::Hyperfoam => {}
            BaseLaw::Ogden if run.test == Test::Confined => {
                return Err("a coupon of law ogden in a ring is not compared: only its compressibility shows there, and that is unknown".to_owned());
            }
            BaseLaw::Ogden if is_pressed(experiment, &its.material) => {
                return Err("a coupon of law ogden is not compared beside balls: these are computed with a Poisson's ratio of 0.4, and what is between platens hardly changes its volume".to_owned());
            }
            BaseLaw::Ogden => {}
            BaseLaw::Rigid => return Err("a stiff block between faces says nothing of the material".to_owned()),
        }
        let (Some(height_mm), Some(radius_mm)) = (its.height_mm.known(), its.radius_mm.known()) else {
            return Err("a coupon of unknown height or cross-section says nothing of the material".to_owned());
        };
        if run.hold_out {
            return Err("a coupon is fitted and not predicted: marked hold_out, it is left out".to_owned());
        }
        let area_mm2 = std::f64::consts::PI * radius_mm * radius_mm;
        let empty = Shortening {
            sides,
            height_mm,
            area_mm2,
            specimen: at,
            nu: (its.base_law == BaseLaw::Ogden).then_some(INCOMPRESSIBLE),
            rubbing: None,
            time_s: Vec::new(),
            depth_mm: Vec::new(),
            start_s: run.start_s.unwrap_or(0.0),
            before_mm,
        };
        let (coupon, told) = Self::compressed(&run.recording, empty)?;
        messages.extend(told.into_iter().map(|text| format!("{}: {text}", run.file)));
        Ok(coupon)
    }

    /// A coupon that would be shortened to a depth (mm) at a rate (mm/s) and read as a model says, for a plan. None where that shows no contact.
    pub(crate) fn planned(
        model: &Model,
        coupon: &Shortening,
        (depth_mm, rate_mm_per_s): (f64, f64),
        sample_hz: f64,
    ) -> Option<Self> {
        let count = (depth_mm / rate_mm_per_s * sample_hz) as usize + 1;
        let time_s: Vec<f64> = (0..count).map(|k| k as f64 / sample_hz).collect();
        let depths: Vec<f64> = time_s.iter().map(|t| rate_mm_per_s * t).collect();
        let whole = Shortening { time_s: time_s.clone(), depth_mm: depths.clone(), ..coupon.clone() };
        let force_n = model.shortened(&whole, 0.0);
        Self::compressed(&Recording::from_samples(time_s, depths, force_n), coupon.clone()).ok().map(|(own, _)| own)
    }

    /// Cuts a recording into windows; `run` is the coupon, with no places yet. With what the reader should know.
    fn compressed(recording: &Recording, run: Shortening) -> Result<(Self, Vec<String>), String> {
        let motion = motion::of(recording).ok_or("the coupon was never shortened")?;
        let loading = motion.loading.clone();
        let (depth, force) = (&recording.depth_mm, &recording.force_n);
        let guess = contact::guess_of_faces(&depth[loading.clone()], &force[loading.clone()], run.height_mm)
            .ok_or("the coupon was not touched")?;
        let meant = guess.contact_mm.abs() < MEANT_MM;
        let zero_mm = if meant { 0.0 } else { guess.contact_mm };
        let share = |i: usize| (depth[i] - zero_mm) / run.height_mm;
        let begin = loading.clone().find(|i| share(*i) >= SHARES.0).unwrap_or(loading.end);
        let end = (begin..loading.end).find(|i| share(*i) > SHARES.1).unwrap_or(loading.end);
        if end - begin < LEAST_SAMPLES {
            return Err(format!(
                "{} samples between {} and {} % of shortening, of at least {LEAST_SAMPLES}",
                end - begin,
                100.0 * SHARES.0,
                100.0 * SHARES.1
            ));
        }
        let mut told: Vec<String> = motion.events.iter().map(ToString::to_string).collect();
        if end < loading.end {
            told.push(format!("shortened by more than {} % of its height; compared up to there", 100.0 * SHARES.1));
        }
        if !meant {
            told.push(format!("the recorded depth is {zero_mm:.2} mm where the coupon is touched; counted from there"));
        }
        let before_mm = (run.before_mm - zero_mm).max(0.0);
        let run = Shortening { before_mm, ..run };
        let mut coupon = Self { run, of: Vec::new(), nodes: Vec::new() };
        coupon.cut(recording, (&motion, begin..end), zero_mm);
        Ok((coupon, told))
    }

    fn cut(&mut self, recording: &Recording, (motion, used): (&Motion, std::ops::Range<usize>), zero_mm: f64) {
        let mut windows = Vec::new();
        even(&mut windows, used.clone(), WINDOWS.0, Branch::Loading);
        let mut held_from_s = f64::NAN;
        let whole = used.end == motion.loading.end && motion.loading_is_whole();
        if let Some(hold) = motion.hold.clone().filter(|hold| whole && !hold.is_empty()) {
            held_from_s = recording.time_s[hold.start];
            growing(&mut windows, recording, hold, WINDOWS.1);
        }
        // what follows a way down that is not followed to its end has another past
        let back = motion.unloading.clone().filter(|back| used.end == motion.loading.end && !back.is_empty());
        if let Some(back) = back {
            let shallow = zero_mm + SHARES.0 * self.run.height_mm;
            let end = back.clone().find(|i| recording.depth_mm[*i] < shallow).unwrap_or(back.end);
            even(&mut windows, back.start..end, WINDOWS.2, Branch::Unloading);
        }
        let start_s = recording.time_s[motion.loading.start];
        let of = |window: &std::ops::Range<usize>, branch: Branch| {
            node(recording, window, branch, start_s, held_from_s, zero_mm)
        };
        let mut nodes: Vec<Node> = windows.iter().map(|(window, branch)| of(window, *branch)).collect();
        lift(&mut nodes);
        // the way from the first sample on, of which memories are made and nothing is compared
        let first = motion.loading.start;
        self.place(&of(&(first..first + 1), Branch::Loading));
        let mut before = Vec::new();
        even(&mut before, first + 1..used.start.max(first + 1), PLACES, Branch::Loading);
        before.iter().for_each(|(window, branch)| self.place(&of(window, *branch)));
        for (at, ((window, branch), node)) in windows.iter().zip(nodes).enumerate() {
            let mut parts = Vec::new();
            even(&mut parts, window.clone(), PLACES, *branch);
            let mut row = Vec::new();
            for (part, _) in &parts {
                row.push((self.run.time_s.len(), part.len() as f64 / window.len() as f64));
                self.place(&of(part, *branch));
            }
            if !node.lifted {
                self.of.push(row);
                self.nodes.push(node);
            }
            // where the motion turns
            if windows.get(at + 1).is_some_and(|(_, next)| next != branch) {
                self.place(&of(&(window.end - 1..window.end), *branch));
            }
        }
    }

    fn place(&mut self, node: &Node) {
        self.run.time_s.push(node.time_s);
        self.run.depth_mm.push(node.depth_mm);
    }

    /// Solves what friction on the platens adds to rubbers among some coupons, one shape after the other.
    ///
    /// # Errors
    /// Why a shape cannot be solved; it is then taken not to rub.
    pub(in super::super) fn rub<'a>(coupons: impl Iterator<Item = &'a mut Self>) -> Result<(), String> {
        type Shape = (f64, f64, bool);
        let mut solved: Vec<(Shape, Option<Arc<Rubbing>>)> = Vec::new();
        let mut failed = None;
        for coupon in coupons.filter(|coupon| coupon.run.nu.is_some()) {
            let (run, returns) = (&coupon.run, coupon.nodes.iter().any(|node| node.branch == Branch::Unloading));
            let radius_mm = (run.area_mm2 / std::f64::consts::PI).sqrt();
            let deepest_mm = run.depth_mm.iter().copied().fold(0.0, f64::max);
            let (shape, turn) = (radius_mm / run.height_mm, deepest_mm / run.height_mm);
            let near = |a: f64, b: f64| (a - b).abs() <= ONE_SHAPE * b;
            let known = |own: &&(Shape, _)| near(shape, own.0.0) && near(turn, own.0.1) && own.0.2 == returns;
            if let Some((_, rubbing)) = solved.iter().find(known) {
                coupon.run.rubbing.clone_from(rubbing);
                continue;
            }
            let rubbing = match Rubbing::solved(shape, turn, returns) {
                Ok(rubbing) => Some(Arc::new(rubbing)),
                Err(cause) => {
                    failed.get_or_insert(format!("friction on the platens is left out: {cause}"));
                    None
                }
            };
            coupon.run.rubbing.clone_from(&rubbing);
            solved.push(((shape, turn, returns), rubbing));
        }
        failed.map_or(Ok(()), Err)
    }

    /// What holds its sides.
    pub(super) fn sides(&self) -> Sides {
        self.run.sides
    }

    /// Its height, mm.
    pub(in super::super) fn height_mm(&self) -> f64 {
        self.run.height_mm
    }

    /// How far it was shortened before, mm.
    pub(in super::super) fn before_mm(&self) -> f64 {
        self.run.before_mm
    }

    /// Index of its specimen.
    pub(super) fn specimen(&self) -> usize {
        self.run.specimen
    }

    /// Windows that are compared, a row each.
    pub(in super::super) fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// True for one that was compressed as another was: the same piece or its like, as far and as fast.
    pub(in super::super) fn repeats(&self, other: &Self) -> bool {
        /// Parts of themselves that times and depths of repeats differ by.
        const ALIKE: f64 = 0.02;
        let (a, b) = (&self.run, &other.run);
        let piece = |run: &Shortening| (run.sides, run.specimen, run.height_mm, run.area_mm2);
        let near = |a: f64, b: f64| (a - b).abs() <= ALIKE * a.abs().max(b.abs());
        let last_s = |own: &Self| own.nodes.last().map_or(0.0, |node| node.time_s);
        let deepest_mm = |own: &Self| own.nodes.iter().map(|node| node.depth_mm).fold(0.0, f64::max);
        let way = near(last_s(self), last_s(other)) && near(deepest_mm(self), deepest_mm(other));
        let way = way && near(a.before_mm, b.before_mm);
        piece(a) == piece(b) && self.nodes.len() == other.nodes.len() && way
    }

    /// What repeats differ by besides sensor noise, a column each: a zero (a newton), a gain, a first touch (a millimetre), a height (relative).
    pub(in super::super) fn shapes(&self) -> DMatrix<f64> {
        let slopes = self.slopes();
        DMatrix::from_fn(self.nodes.len(), 4, |k, column| {
            let (node, slope) = (&self.nodes[k], slopes[k]);
            match column {
                0 => 1.0,
                1 => node.force_n,
                2 => -slope,
                _ => -node.depth_mm * slope,
            }
        })
    }

    /// Number of rows, each a reading in N.
    pub(super) fn rows(&self) -> usize {
        self.nodes.len()
    }

    /// What was recorded, a row each.
    pub(in super::super) fn measured(&self) -> Vec<f64> {
        self.nodes.iter().map(|n| n.force_n).collect()
    }

    /// What a model makes of it.
    pub(super) fn predicted(&self, model: &Model) -> Vec<f64> {
        let force_n = model.shortened(&self.run, 0.0);
        self.of.iter().map(|row| row.iter().map(|(at, weight)| weight * force_n[*at]).sum()).collect()
    }

    /// Lower triangular factor of the covariance of its rows; none where that is not positive definite.
    pub(super) fn factor(&self, noise: &SensorNoise) -> Option<DMatrix<f64>> {
        Some(noise.factor(&self.nodes, &self.measured())?.lower())
    }

    /// What its rows may be off by together, a column of unit variance each: zero; gain (jitter, cross-section, another piece of the foam); first touch; height.
    pub(super) fn freedom(&self, jitter: &Jitter) -> DMatrix<f64> {
        let diameter_mm = 2.0 * (self.run.area_mm2 / std::f64::consts::PI).sqrt();
        let gain = jitter.gain.hypot(2.0 * DIAMETER_MM / diameter_mm).hypot(AGREE);
        let touch_mm = jitter.contact_mm.hypot(TOUCH_MM);
        let each = [jitter.zero_n, gain, touch_mm, HEIGHT];
        self.shapes() * DMatrix::from_diagonal(&DVector::from_row_slice(&each))
    }

    /// Slope (N/mm) of what was read over depth at every row; in a hold that of the way down before it.
    fn slopes(&self) -> Vec<f64> {
        let mut last = 0.0;
        let of = |k: usize| {
            let node = &self.nodes[k];
            let beside = |at: Option<usize>| at.and_then(|at| self.nodes.get(at)).filter(|n| n.branch == node.branch);
            let (a, b) = (beside(k.checked_sub(1)).unwrap_or(node), beside(Some(k + 1)).unwrap_or(node));
            if node.branch != Branch::Hold && (b.depth_mm - a.depth_mm).abs() > 1e-9 {
                last = (b.force_n - a.force_n) / (b.depth_mm - a.depth_mm);
            }
            last
        };
        (0..self.nodes.len()).map(of).collect()
    }

    /// Directions that a discrepancy may lie in: variable, label, and a weight a row, in proportion to the force.
    pub(super) fn directions(&self) -> Vec<(Variable, String, Vec<f64>)> {
        const PARTS: usize = 3;
        let (variable, name) = match self.run.sides {
            Sides::Held => (Variable::Confined, "confined"),
            Sides::Free => (Variable::Compression, "compression"),
        };
        let deepest = self.nodes.iter().map(|n| n.depth_mm).fold(0.0, f64::max);
        let part = |n: &Node| ((n.depth_mm / deepest * PARTS as f64) as usize).min(PARTS - 1);
        let own = |within: &dyn Fn(&Node) -> bool| -> Vec<f64> {
            self.nodes.iter().map(|n| if within(n) { n.force_n } else { 0.0 }).collect()
        };
        let mut list = Vec::new();
        for k in 0..PARTS {
            let label = format!("{name}, {} to {} %", 100 * k / PARTS, 100 * (k + 1) / PARTS);
            list.push((variable, label, own(&|n| n.branch == Branch::Loading && part(n) == k)));
        }
        for (branch, word) in [(Branch::Hold, "hold"), (Branch::Unloading, "way back")] {
            list.push((variable, format!("{name}, {word}"), own(&|n| n.branch == branch)));
        }
        list.retain(|(_, _, weights)| weights.iter().any(|w| *w != 0.0));
        list
    }
}

/// True where a ball is pressed into a material.
fn is_pressed(experiment: &Experiment, material: &str) -> bool {
    let of = |run: &Run| run.specimen.is_some_and(|at| experiment.specimens[at].material == material);
    experiment.runs.iter().any(|run| run.test == Test::Indentation && of(run))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use lut_gen::chain::Setting;
    use lut_gen::effect::{poisson, relaxation, softening};
    use lut_gen::solid::homogeneous::{self, Programme};
    use lut_gen::solid::law::{Hyperfoam, Material, OgdenRoxburgh, PronyTerm, Term};

    use super::*;
    use crate::experiment::{Base, Length, Specimen};

    const HEIGHT_MM: f64 = 12.7;
    const RADIUS_MM: f64 = 12.0;
    const MU_MPA: f64 = 0.15;
    const ALPHA: f64 = 9.0;
    const NU: f64 = 0.1;
    const G: f64 = 0.25;
    const TAU_S: f64 = 0.6;

    fn foam() -> Material {
        Hyperfoam::new(vec![Term { mu_mpa: MU_MPA, alpha: ALPHA, nu: NU }]).unwrap().into()
    }

    fn with(settings: Vec<Setting>) -> Model {
        let nu = Setting { effect: &poisson::EFFECT, owner: 0, values: vec![NU] };
        Model { settings: settings.into_iter().chain([nu]).collect(), ..Model::base(MU_MPA, ALPHA) }
    }

    /// From 0.3 mm above the coupon down to half its height at 2 mm/s, standing for 3 s, and back, at 50 Hz; recorded zero at `zero_mm` past the touch.
    fn recorded(material: Material, test: Test, zero_mm: f64) -> Run {
        let count = 50 * 10;
        let time_s: Vec<f64> = (0..count).map(|k| 0.02 * f64::from(k)).collect();
        let down_s = (0.5 * HEIGHT_MM + 0.3) / 2.0;
        let depth = |t: f64| -0.3 + 2.0 * t.min(down_s) - 2.0 * (t - down_s - 3.0).max(0.0);
        let depth_mm: Vec<f64> = time_s.iter().map(|t| depth(*t)).collect();
        let sides = if test == Test::Confined { Sides::Held } else { Sides::Free };
        let area_mm2 = std::f64::consts::PI * RADIUS_MM * RADIUS_MM;
        let coupon = homogeneous::Coupon { material, mode: sides.mode(), area_mm2 };
        let stretch = depth_mm.iter().map(|d| 1.0 - d.max(0.0) / HEIGHT_MM).collect();
        let response = coupon.follow(&Programme { time_s: time_s.clone(), stretch }, &[]).unwrap();
        let force_n = response.force_n(&coupon).iter().map(|f| (-f).max(0.0)).collect();
        let depth_mm = depth_mm.iter().map(|d| d + zero_mm).collect();
        let recording = Recording::from_samples(time_s, depth_mm, force_n);
        Run { test, indenter: None, ..Run::indentation("c.csv".to_owned(), 0, 0, recording) }
    }

    fn experiment(runs: Vec<Run>) -> Experiment {
        let specimen = Specimen {
            name: "coupon".to_owned(),
            material: "foam".to_owned(),
            base_law: BaseLaw::Hyperfoam,
            terms: 1,
            height_mm: Length::Known(HEIGHT_MM),
            radius_mm: Length::Known(RADIUS_MM),
            base: Base::Bonded,
        };
        Experiment {
            name: "x".to_owned(),
            folder: std::path::PathBuf::new(),
            specimens: vec![specimen],
            indenters: Vec::new(),
            sensor: crate::experiment::Sensor::default(),
            runs,
        }
    }

    fn of(experiment: &Experiment) -> Result<(Coupon, Vec<String>), String> {
        let mut messages = Vec::new();
        Coupon::of(experiment, &experiment.runs[0], 0.0, &mut messages).map(|coupon| (coupon, messages))
    }

    /// Largest miss of a model as a part of the largest force, and the rows.
    fn missed(material: Material, test: Test, model: &Model) -> (f64, Coupon) {
        let (coupon, _) = of(&experiment(vec![recorded(material, test, 0.0)])).unwrap();
        let peak = coupon.measured().into_iter().fold(0.0, f64::max);
        let each = coupon.measured().into_iter().zip(coupon.predicted(model)).map(|(a, b)| (a - b).abs());
        (each.fold(0.0, f64::max) / peak, coupon)
    }

    /// Means over windows of a run at 50 Hz against the material point along all its samples: 0.2 % of the force at the most, a fifth of what a coupon's gain is
    /// unknown by.
    #[test]
    fn the_prediction_is_that_of_the_homogeneous_solve() {
        let prony = foam().relaxing(vec![PronyTerm { g: G, k: G, tau_s: TAU_S }]).unwrap();
        let relaxing = Setting { effect: &relaxation::ONE, owner: 0, values: vec![G, TAU_S] };
        let (r, m, beta) = softening::of_points(0.2, 0.7);
        let soft = foam().softening(OgdenRoxburgh::new(r, m * MU_MPA, beta).unwrap());
        let softening = Setting { effect: &softening::EFFECT, owner: 0, values: vec![0.2, 0.7] };
        let all = [(foam(), Vec::new()), (prony, vec![relaxing]), (soft, vec![softening])];
        for (material, settings) in all {
            for test in [Test::Uniaxial, Test::Confined] {
                let (miss, coupon) = missed(material.clone(), test, &with(settings.clone()));
                assert!(miss < 0.002, "{miss} of {}", material.label());
                assert!(coupon.rows() > 40 && coupon.rows() <= 46, "{}", coupon.rows());
                let (wrong, _) = missed(material.clone(), test, &Model::base(MU_MPA, ALPHA));
                assert!(wrong > 0.02, "{wrong}");
            }
        }
    }

    /// A recorded zero far from the touch is none, and the touch is found.
    #[test]
    fn a_zero_that_was_not_meant_is_told() {
        let (coupon, told) = of(&experiment(vec![recorded(foam(), Test::Confined, 2.0)])).unwrap();
        assert!(
            told.len() == 1 && told[0].starts_with("c.csv: the recorded depth is 1.98 mm where the coupon is"),
            "{told:?}"
        );
        let deepest = coupon.nodes.iter().map(|n| n.depth_mm).fold(0.0, f64::max);
        assert!((deepest - 0.5 * HEIGHT_MM).abs() < 0.1, "{deepest}");
    }

    /// One like it, at another zero, repeats a coupon; a slower one, one between platens and one that was shortened before do not.
    #[test]
    fn repeats_are_compressed_alike() {
        let (coupon, _) = of(&experiment(vec![recorded(foam(), Test::Confined, 0.0)])).unwrap();
        let like = |change: &dyn Fn(&mut Run)| {
            let mut run = recorded(foam(), Test::Confined, 0.0);
            change(&mut run);
            of(&experiment(vec![run])).unwrap().0
        };
        assert!(coupon.repeats(&coupon));
        let shifted = like(&|run| run.recording.depth_mm.iter_mut().for_each(|d| *d += 2.0));
        assert!(shifted.repeats(&coupon), "{:?} {:?}", shifted.nodes.last(), coupon.nodes.last());
        assert!(!like(&|run| run.recording.time_s.iter_mut().for_each(|t| *t *= 1.5)).repeats(&coupon));
        assert!(!like(&|run| run.test = Test::Uniaxial).repeats(&coupon));
        let again = Coupon { run: Shortening { before_mm: 5.0, ..coupon.run.clone() }, ..coupon.clone() };
        assert!(!again.repeats(&coupon) && !coupon.repeats(&again));
    }

    #[test]
    fn what_says_nothing_is_told() {
        let good = experiment(vec![recorded(foam(), Test::Confined, 0.0)]);
        let why = |change: &dyn Fn(&mut Experiment)| {
            let mut other = good.clone();
            change(&mut other);
            of(&other).unwrap_err()
        };
        let unknown = "a coupon of unknown height or cross-section says nothing of the material";
        assert_eq!(why(&|e| e.specimens[0].height_mm = Length::Unknown), unknown);
        assert_eq!(why(&|e| e.specimens[0].radius_mm = Length::Unknown), unknown);
        let rubber = |e: &mut Experiment| e.specimens[0].base_law = BaseLaw::Ogden;
        assert!(why(&rubber).starts_with("a coupon of law ogden in a ring is not compared"));
        let beside = |e: &mut Experiment| {
            rubber(e);
            e.runs[0].test = Test::Uniaxial;
            let pressed = Run { test: Test::Indentation, ..e.runs[0].clone() };
            e.runs.push(pressed);
        };
        assert!(why(&beside).starts_with("a coupon of law ogden is not compared beside balls"));
        assert!(why(&|e| e.specimens[0].base_law = BaseLaw::Rigid).starts_with("a stiff block between faces"));
        assert!(why(&|e| e.runs[0].hold_out = true).starts_with("a coupon is fitted and not predicted"));
        assert_eq!(why(&|e| e.runs[0].recording.force_n.fill(0.0)), "the coupon was not touched");
        assert_eq!(why(&|e| e.runs[0].recording.depth_mm.fill(0.0)), "the coupon was never shortened");
        let few = why(&|e| e.specimens[0].height_mm = Length::Known(100.0 * HEIGHT_MM));
        assert!(few.ends_with(" samples between 3 and 60 % of shortening, of at least 12"), "{few}");
    }

    /// What the rows may be off by together: a gain of 1.7 % (jitter of 1 %, a diameter of 24 mm to 0.12, another piece of foam), a tenth of a millimetre, 1 % of the height.
    #[test]
    fn a_coupon_is_known_as_far_as_it_can_be() {
        let (_, coupon) = missed(foam(), Test::Confined, &with(Vec::new()));
        let jitter = Jitter { contact_mm: 0.02, gain: 0.01, zero_n: 0.003 };
        let noise = SensorNoise { sigma_n: 0.01, white: 1.0, correlation_s: 0.02, relative: 0.0 };
        let freedom = coupon.freedom(&jitter);
        let (gain, k) = (0.01_f64.hypot(0.01).hypot(0.007), 12);
        let node = coupon.nodes[k];
        assert!((freedom[(k, 0)], freedom[(k, 1)]) == (0.003, gain * node.force_n));
        let slope = |by: f64| {
            let moved: Vec<f64> = coupon.run.depth_mm.iter().map(|d| d + by).collect();
            let run = Shortening { depth_mm: moved, ..coupon.run.clone() };
            Coupon { run, ..coupon.clone() }.predicted(&with(Vec::new()))[k]
        };
        let slope = (slope(0.01) - slope(-0.01)) / 0.02;
        // a difference over two windows of a fiftieth of the height
        assert!((freedom[(k, 2)] / (-0.02_f64.hypot(0.1) * slope) - 1.0).abs() < 0.02, "{slope}");
        assert!((freedom[(k, 3)] / (-0.01 * node.depth_mm * slope) - 1.0).abs() < 0.02, "{slope}");
        assert!(coupon.factor(&noise).is_some());
    }
}
