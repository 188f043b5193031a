//! What was done in an experiment, and its data thinned to nodes: means over short windows of each branch.

use std::ops::Range;

use lut_gen::chain::{Geometry, Passage, RUBBER_NU, Window};
use lut_gen::effect::{Effect, Owner, Sizes};
use lut_gen::model::Specimen as Block;
use lut_gen::solve;

use crate::experiment::motion::{self, Event, Motion};
use crate::experiment::{Base, BaseLaw, Experiment, Recording, Test};
use crate::identify::contact;

use super::Refusal;
use super::check::{self, Check};

/// Windows of a loading branch, a hold and a way back.
const WINDOWS: (usize, usize, usize) = (36, 14, 24);
/// Share of the stroke above the contact from which on samples are used: they show the sensor's zero.
const ABOVE: f64 = 0.05;
/// Least samples of a loading branch.
pub(super) const LEAST_SAMPLES: usize = 12;
/// Rates that differ by less than this share are one rate.
const SAME_RATE: f64 = 0.05;
/// Largest depth over ball radius that the force models are asked for: beyond, a ball is a shank.
const DEEPEST: f64 = 1.2;
/// The same where the specimen hardly changes its volume.
const DEEPEST_RUBBER: f64 = 1.0;
/// How far past the contact the recorded zero may lie, mm: depths that the force models must cover.
const LATE_MM: f64 = 0.25;
/// Recorded zeros within this distance (mm) of the contact were meant to be the contact.
pub(super) const MEANT_MM: f64 = 0.4;

/// Below this share of the force that the same depth had on the way down a relaxing contact lifts off; how its edge does
/// is where the chain is farthest from finite elements. Where loading itself had less than the second share of the peak, nothing has lifted.
const LIFTED: (f64, f64) = (0.35, 0.05);

/// Readings at the beginning of a run whose mean is the force it begins at, and the parts of the largest force that a reading of them lies within and two runs differ by where
/// the zero drifts. Of a fast run all but the first may lie well past the contact, so that the mean says nothing of whether one began at no force.
const FIRST: usize = 3;
const DRIFTED: (f64, f64) = (0.02, 0.05);

/// Part of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Branch {
    /// On the way down.
    Loading,
    /// Standing at the deepest point.
    Hold,
    /// On the way back.
    Unloading,
}

/// Mean over a short window of one run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node {
    /// Middle of the window, s since the run's first used sample.
    pub time_s: f64,
    /// Length of the window, s.
    pub length_s: f64,
    /// Samples in it.
    pub samples: usize,
    /// Mean recorded depth, mm; the experiment's zero is taken off.
    pub depth_mm: f64,
    /// Mean force, N.
    pub force_n: f64,
    /// Branch.
    pub branch: Branch,
    /// Time since the hold began, s; 0 elsewhere.
    pub held_s: f64,
    /// On the way back, where the contact lifts off: not compared.
    pub lifted: bool,
}

/// One used run.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Index into [`Experiment::runs`].
    pub run: usize,
    /// Index of the specimen.
    pub specimen: usize,
    /// Index of the ball.
    pub indenter: usize,
    /// Index into [`Design::geometries`].
    pub geometry: usize,
    /// Index into [`Design::rates_mm_per_s`].
    pub rate: usize,
    /// n-th press on its spot, from 1.
    pub cycle: i64,
    /// Start on the session clock, s, if known.
    pub start_s: Option<f64>,
    /// Number of the spot; runs on one spot share their contact point and gain.
    pub spot: usize,
    /// Runs of one condition have the same number: they differ in labels only.
    pub condition: usize,
    /// Conditions without the cycle: what is left out together.
    pub group: usize,
    /// Never fitted, only predicted.
    pub hold_out: bool,
    /// Largest recorded depth of earlier presses on this spot, mm.
    pub pressed_before_mm: f64,
    /// The data.
    pub nodes: Vec<Node>,
    /// Time (s, as in the nodes) and recorded depth (mm) of the nodes and of the corners of the motion between them.
    pub path: Vec<(f64, f64)>,
    /// Place of every node in the path.
    pub at: Vec<usize>,
}

/// The used runs of one material, and what varies between them.
#[derive(Debug, Clone, PartialEq)]
pub struct Design {
    /// Name of the material.
    pub material: String,
    /// Used runs.
    pub series: Vec<Series>,
    /// Runs that a ball on the foam has no part in: of sensor and machine alone, and of coupons.
    pub checks: Vec<Check>,
    /// Balls on specimens.
    pub geometries: Vec<Geometry>,
    /// Rates of loading, mm/s, rising.
    pub rates_mm_per_s: Vec<f64>,
    /// Number of spots.
    pub spots: usize,
    /// Number of conditions.
    pub conditions: usize,
    /// Number of groups that are left out together.
    pub groups: usize,
    /// True when the recorded zero was meant to be the contact point, so that a common offset can be seen.
    pub zero_is_contact: bool,
    /// Recorded depth, mm, that was taken off everywhere: 0 when the zero was meant to be the contact.
    pub zero_mm: f64,
    /// What the reader should know.
    pub messages: Vec<String>,
}

/// A run before windows are cut.
struct Raw {
    run: usize,
    motion: Motion,
    contact_mm: f64,
}

impl Design {
    /// Largest force of all runs, N.
    #[must_use]
    pub fn largest_n(&self) -> f64 {
        self.series.iter().flat_map(|s| &s.nodes).map(|n| n.force_n).fold(0.0, f64::max)
    }

    /// Sizes that the amounts of an effect are in proportion to, of the ball or specimen that it belongs to; without one, of the largest.
    #[must_use]
    pub fn sizes(&self, effect: &Effect, owner: Option<usize>) -> Sizes {
        let own = |s: &Series| match effect.owner {
            Owner::All => true,
            Owner::Indenter => owner.is_none_or(|owner| s.indenter == owner),
            Owner::Specimen => owner.is_none_or(|owner| s.specimen == owner),
        };
        // no ball is pressed into a coupon: it is as high as the specimens are
        let has = self.series.iter().any(own);
        let of = |size: &dyn Fn(&Geometry) -> f64| {
            let each = self.series.iter().filter(|s| !has || own(s)).filter_map(|s| self.geometries.get(s.geometry));
            each.map(size).fold(0.0, f64::max)
        };
        Sizes {
            force_n: self.largest_n(),
            radius_mm: of(&|g| g.ball_mm),
            height_mm: of(&|g| g.specimen.height_mm),
            rate_mm_per_s: self.rates_mm_per_s.last().copied().unwrap_or(1.0),
            run_s: self.series.iter().flat_map(|s| &s.nodes).map(|n| n.time_s).fold(0.0, f64::max),
        }
    }

    /// Reads the design of one material from its data.
    ///
    /// # Errors
    /// [`Refusal`] when nothing can be used.
    pub fn of(experiment: &Experiment, material: &str) -> Result<Self, Refusal> {
        let mut messages = Vec::new();
        let raws = raw_runs(experiment, material, &mut messages);
        if raws.is_empty() {
            return Err(Refusal::NothingToFit(messages.join("; ")));
        }
        let contacts = contacts(&raws);
        let middle = contacts[contacts.len() / 2];
        let spread = contacts.last().zip(contacts.first()).map_or(0.0, |(b, a)| b - a);
        let zero_is_contact = middle.abs() < MEANT_MM && spread < 2.0 * MEANT_MM;
        let zero_mm = if zero_is_contact { 0.0 } else { middle };
        if !zero_is_contact {
            messages.push(format!(
                "the recorded depth is {middle:.2} mm at the contact (range {spread:.2} mm): it was not zeroed there, so an offset of the contact cannot be seen"
            ));
        }
        let mut design = Self {
            material: material.to_owned(),
            series: Vec::new(),
            checks: Vec::new(),
            geometries: Vec::new(),
            rates_mm_per_s: Vec::new(),
            spots: 0,
            conditions: 0,
            groups: 0,
            zero_is_contact,
            zero_mm,
            messages,
        };
        design.rates(&raws);
        for raw in &raws {
            design.add(experiment, raw);
        }
        design.number();
        let (checks, messages) = check::of(experiment, material, design.largest_n());
        design.checks = checks;
        design.messages.extend(messages);
        if design.geometries.iter().any(|geometry| geometry.nu > 0.0) {
            design.messages.push(format!(
                "ogden: computed with Poisson's ratio {RUBBER_NU}, as near to incompressible as the force models go; another Poisson's ratio cannot be seen"
            ));
        }
        Ok(design)
    }

    fn rates(&mut self, raws: &[Raw]) {
        let mut rates: Vec<f64> = raws.iter().map(|raw| raw.motion.rate_mm_per_s).collect();
        rates.sort_by(f64::total_cmp);
        for rate in rates {
            if self.rates_mm_per_s.last().is_none_or(|last| rate / last - 1.0 > SAME_RATE) {
                self.rates_mm_per_s.push(rate);
            }
        }
    }

    fn add(&mut self, experiment: &Experiment, raw: &Raw) {
        let run = &experiment.runs[raw.run];
        let (Some(specimen), Some(indenter)) = (run.specimen, run.indenter) else { return };
        let ball_mm = experiment.indenters[indenter].radius_mm.known().unwrap_or(0.0);
        let (nodes, corners) = nodes(&run.recording, &raw.motion, raw.contact_mm, self.zero_mm);
        let (path, at) = path(&nodes, corners);
        let deepest = nodes.iter().map(|n| n.depth_mm).fold(0.0, f64::max) + LATE_MM;
        let geometry = self.geometry(experiment, specimen, ball_mm, deepest);
        let rate =
            self.rates_mm_per_s.iter().rposition(|rate| *rate <= raw.motion.rate_mm_per_s * (1.0 + 1e-12)).unwrap_or(0);
        let cycle = run.cycle.unwrap_or(1);
        let spot = self.spot(experiment, raw.run, cycle);
        let earlier = |s: &&Series| s.spot == spot;
        let pressed_before_mm =
            self.series.iter().filter(earlier).flat_map(|s| s.path.iter().map(|p| p.1)).fold(0.0, f64::max);
        self.series.push(Series {
            run: raw.run,
            specimen,
            indenter,
            geometry,
            rate,
            cycle,
            start_s: run.start_s,
            spot,
            condition: 0,
            group: 0,
            hold_out: run.hold_out,
            pressed_before_mm,
            nodes,
            path,
            at,
        });
    }

    fn geometry(&mut self, experiment: &Experiment, specimen: usize, ball_mm: f64, deepest_mm: f64) -> usize {
        let its = &experiment.specimens[specimen];
        let height_mm = its.height_mm.known().unwrap_or(0.0);
        let block = Block {
            height_mm,
            radius_mm: its.radius_mm.known().unwrap_or(6.0 * ball_mm),
            base: match its.base {
                Base::Bonded => solve::Base::Bonded,
                Base::Sliding => solve::Base::Sliding,
            },
        };
        // a margin for what contact and compliance add, in steps so that like experiments share their models
        let (nu, deepest) = if its.base_law == BaseLaw::Ogden { (RUBBER_NU, DEEPEST_RUBBER) } else { (0.0, DEEPEST) };
        let wanted = (1.06 * deepest_mm).min(deepest * ball_mm).min(0.8 * height_mm);
        let depth_mm = (wanted / 0.25).ceil() * 0.25;
        let known = self.geometries.iter_mut().enumerate();
        for (at, geometry) in known {
            if geometry.specimen == block && geometry.ball_mm == ball_mm && geometry.nu == nu {
                geometry.depth_mm = geometry.depth_mm.max(depth_mm);
                return at;
            }
        }
        self.geometries.push(Geometry { specimen: block, ball_mm, depth_mm, nu });
        self.geometries.len() - 1
    }

    /// The spot a run was made on: as labelled; else a later cycle is on the spot of the cycle before it.
    fn spot(&mut self, experiment: &Experiment, run: usize, cycle: i64) -> usize {
        let own = &experiment.runs[run];
        let same = |s: &&Series| {
            let other = &experiment.runs[s.run];
            if own.specimen != other.specimen {
                return false;
            }
            match own.spot {
                Some(spot) => other.spot == Some(spot),
                None => other.spot.is_none() && own.indenter == other.indenter && s.cycle + 1 == cycle && cycle > 1,
            }
        };
        if let Some(found) = self.series.iter().rev().find(same) {
            return found.spot;
        }
        self.spots += 1;
        self.spots - 1
    }

    fn number(&mut self) {
        let mut conditions: Vec<(usize, usize, usize, i64, bool, bool)> = Vec::new();
        let mut groups: Vec<(usize, usize, usize)> = Vec::new();
        for s in &mut self.series {
            let has = |branch: Branch| s.nodes.iter().any(|n| n.branch == branch);
            let key = (s.specimen, s.indenter, s.rate, s.cycle, has(Branch::Hold), has(Branch::Unloading));
            s.condition = place(&mut conditions, key);
            s.group = place(&mut groups, (s.specimen, s.indenter, s.rate));
        }
        self.conditions = conditions.len();
        self.groups = groups.len();
    }

    /// The runs as the chain sees them.
    #[must_use]
    pub fn passages(&self) -> Vec<Passage> {
        self.series
            .iter()
            .map(|s| Passage {
                time_s: s.path.iter().map(|p| p.0).collect(),
                depth_mm: s.path.iter().map(|p| p.1).collect(),
                start_s: s.start_s.unwrap_or(0.0),
                geometry: s.geometry,
                specimen: s.specimen,
                indenter: s.indenter,
                pressed_before_mm: s.pressed_before_mm,
            })
            .collect()
    }

    /// What the reading at every place of every run's path is the mean of; an instant for a corner.
    #[must_use]
    pub fn windows(&self) -> Vec<Vec<Window>> {
        let of = |s: &Series| {
            let mut windows = vec![Window::default(); s.path.len()];
            let own = s.at.iter().zip(&s.nodes);
            own.for_each(|(at, n)| windows[*at] = Window { length_s: n.length_s, samples: n.samples });
            windows
        };
        self.series.iter().map(of).collect()
    }

    /// Name of a group: ball, rate and specimen.
    #[must_use]
    pub fn group_name(&self, experiment: &Experiment, group: usize) -> String {
        self.series.iter().find(|s| s.group == group).map_or_else(String::new, |s| {
            let ball = &experiment.indenters[s.indenter].name;
            let specimen = &experiment.specimens[s.specimen].name;
            let rate = self.rates_mm_per_s[s.rate];
            if experiment.specimens.len() > 1 {
                format!("{ball}-v{rate:.3}-{specimen}")
            } else {
                format!("{ball}-v{rate:.3}")
            }
        })
    }
}

fn place<K: PartialEq>(list: &mut Vec<K>, key: K) -> usize {
    list.iter().position(|other| *other == key).unwrap_or_else(|| {
        list.push(key);
        list.len() - 1
    })
}

/// True where some runs begin at no force and others far from it, as those of a session whose zero drifts do; all that were triggered by a force begin at that one.
fn zero_drifts(experiment: &Experiment) -> bool {
    let rigid = |at: usize| experiment.specimens[at].base_law == BaseLaw::Rigid;
    let pressed =
        experiment.runs.iter().filter(|run| run.test == Test::Indentation && !run.specimen.is_some_and(rigid));
    let forces = pressed.map(|run| run.recording.force_n.as_slice());
    let (mut nearest, mut low, mut high, mut peak) = (f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, 0.0_f64);
    for own in forces {
        let begin = begins_at_n(own);
        (low, high) = (low.min(begin), high.max(begin));
        nearest = own.iter().take(FIRST).fold(nearest, |least, reading| least.min(reading.abs()));
        peak = own.iter().copied().fold(peak, f64::max);
    }
    nearest < DRIFTED.0 * peak && high - low > DRIFTED.1 * peak
}

/// Mean of the first readings, N.
fn begins_at_n(force_n: &[f64]) -> f64 {
    let first = &force_n[..force_n.len().min(FIRST)];
    first.iter().sum::<f64>() / first.len().max(1) as f64
}

fn raw_runs(experiment: &Experiment, material: &str, messages: &mut Vec<String>) -> Vec<Raw> {
    let mut raws = Vec::new();
    let drifts = zero_drifts(experiment);
    for (at, run) in experiment.runs.iter().enumerate() {
        let (Some(specimen), Some(indenter), Test::Indentation) = (run.specimen, run.indenter, run.test) else {
            continue;
        };
        let its = &experiment.specimens[specimen];
        if its.material != material || its.base_law == BaseLaw::Rigid {
            continue;
        }
        let Some(ball_mm) = experiment.indenters[indenter].radius_mm.known() else { continue };
        if its.height_mm.known().is_none() {
            messages.push(format!(
                "{}: the height of specimen \"{}\" is unknown; a diagnosis needs a declared one, which it may then find wrong",
                run.file, its.name
            ));
            continue;
        }
        let Some(motion) = motion::of(&run.recording) else {
            messages.push(format!("{}: the ball never went down", run.file));
            continue;
        };
        let loading = motion.loading.clone();
        let depth = &run.recording.depth_mm[loading.clone()];
        let force_n = &run.recording.force_n[loading.clone()];
        let zero_n = if drifts { begins_at_n(force_n) } else { 0.0 };
        let force_n: Vec<f64> = force_n.iter().map(|f| f - zero_n).collect();
        let guess = contact::guess(depth, &force_n, ball_mm);
        let Some(guess) = guess.filter(|_| depth.len() >= LEAST_SAMPLES) else {
            messages.push(format!("{}: no contact, or fewer than {LEAST_SAMPLES} samples on the way down", run.file));
            continue;
        };
        for event in &motion.events {
            messages.push(format!("{}: {event}", run.file));
        }
        raws.push(Raw { run: at, motion, contact_mm: guess.contact_mm });
    }
    raws
}

/// Contacts (mm), rising, of the runs whose way down no fall of the force ends early, if half of them are such: what is left of one before a knock may be a tenth of a millimetre and the noise.
fn contacts(raws: &[Raw]) -> Vec<f64> {
    let whole = |raw: &&Raw| !raw.motion.events.iter().any(|event| matches!(event, Event::ForceDrop { .. }));
    let of = |raws: &mut dyn Iterator<Item = &Raw>| -> Vec<f64> {
        let mut each: Vec<f64> = raws.map(|raw| raw.contact_mm).collect();
        each.sort_by(f64::total_cmp);
        each
    };
    let own = of(&mut raws.iter().filter(whole));
    if 2 * own.len() >= raws.len() { own } else { of(&mut raws.iter()) }
}

/// Windows of equal numbers of samples on the ways down and back, and of growing length in a hold.
fn nodes(recording: &Recording, motion: &Motion, contact_mm: f64, zero_mm: f64) -> (Vec<Node>, Vec<(f64, f64)>) {
    let depth = &recording.depth_mm;
    let loading = motion.loading.clone();
    let last = loading.end.saturating_sub(1);
    let above = contact_mm - ABOVE * (depth[last] - contact_mm);
    let begin = loading.clone().find(|i| depth[*i] >= above).unwrap_or(loading.start);
    let start_s = recording.time_s[begin];
    let mut windows: Vec<(Range<usize>, Branch)> = Vec::new();
    even(&mut windows, begin..loading.end, WINDOWS.0, Branch::Loading);
    let mut held_from_s = f64::NAN;
    if let Some(hold) = motion.hold.clone().filter(|hold| !hold.is_empty()) {
        held_from_s = recording.time_s[hold.start];
        growing(&mut windows, recording, hold, WINDOWS.1);
    }
    if let Some(back) = motion.unloading.clone().filter(|back| !back.is_empty()) {
        let end = back.clone().find(|i| depth[*i] < above).unwrap_or(back.end);
        even(&mut windows, back.start..end, WINDOWS.2, Branch::Unloading);
    }
    let nodes = windows.iter().map(|(window, branch)| node(recording, window, *branch, start_s, held_from_s, zero_mm));
    let placed = |(time_s, depth_mm): (f64, f64)| (time_s - start_s, depth_mm - zero_mm);
    let mut nodes: Vec<Node> = nodes.collect();
    lift(&mut nodes);
    // the ball came from farther away than what is compared: a machine that lags has lagged since
    let mut corners: Vec<(f64, f64)> = vec![placed((recording.time_s[begin], depth[begin]))];
    if loading.start < begin {
        corners.push(placed((recording.time_s[loading.start], depth[loading.start])));
    }
    let turns = [Some(last), motion.hold.as_ref().map(|hold| hold.end.saturating_sub(1))];
    corners.extend(turns.into_iter().flatten().filter_map(|at| corner(recording, at)).map(placed));
    (nodes, corners)
}

/// Marks the nodes of the way back from where the contact lifts off: means of three beside each other, so that noise does not decide.
pub(super) fn lift(nodes: &mut [Node]) {
    let loading: Vec<(f64, f64)> =
        nodes.iter().filter(|n| n.branch == Branch::Loading).map(|n| (n.depth_mm, n.force_n)).collect();
    let peak = loading.iter().map(|(_, f)| *f).fold(0.0, f64::max);
    let before = |depth_mm: f64| {
        let next = loading.partition_point(|(d, _)| *d < depth_mm);
        let ((d0, f0), (d1, f1)) = next.checked_sub(1).map(|i| loading[i]).zip(loading.get(next).copied())?;
        Some(f0 + (f1 - f0) * (depth_mm - d0) / (d1 - d0).max(1e-12))
    };
    let back: Vec<usize> = (0..nodes.len()).filter(|k| nodes[*k].branch == Branch::Unloading).collect();
    let lifts = |three: &&[usize]| {
        let now: f64 = three.iter().map(|k| nodes[*k].force_n).sum();
        let then: Option<f64> = three.iter().map(|k| before(nodes[*k].depth_mm)).sum();
        then.is_some_and(|then| then > 3.0 * LIFTED.1 * peak && now < LIFTED.0 * then)
    };
    let Some(first) = back.windows(3).find(lifts).map(|three| three[1]) else { return };
    back.iter().filter(|k| **k >= first).for_each(|k| nodes[*k].lifted = true);
}

/// Samples to either side of a corner that its two straight pieces are taken from.
const BESIDE: usize = 4;

/// Where the motion turns near a sample: two straight pieces, before and after it, meet there, between two samples.
fn corner(recording: &Recording, at: usize) -> Option<(f64, f64)> {
    let point = |i: usize| (recording.time_s[i], recording.depth_mm[i]);
    let (before, after) = (at.checked_sub(BESIDE)?, at + BESIDE);
    if after >= recording.len() {
        return Some(point(at));
    }
    let line = |a: usize, b: usize| {
        let ((t, d), (t2, d2)) = (point(a), point(b));
        (t2 > t).then(|| (t, d, (d2 - d) / (t2 - t)))
    };
    let (t0, d0, v0) = line(before, at - 1)?;
    let (t1, d1, v1) = line(at + 1, after)?;
    if (v0 - v1).abs() < 1e-9 {
        return Some(point(at));
    }
    let time_s = (d1 - d0 + v0 * t0 - v1 * t1) / (v0 - v1);
    let within = (recording.time_s[at - 1]..=recording.time_s[at + 1]).contains(&time_s);
    Some(if within { (time_s, d0 + v0 * (time_s - t0)) } else { point(at) })
}

/// Nodes and corners in order of time, and where the nodes are among them.
fn path(nodes: &[Node], corners: Vec<(f64, f64)>) -> (Vec<(f64, f64)>, Vec<usize>) {
    let mut all: Vec<(f64, f64, Option<usize>)> =
        nodes.iter().enumerate().map(|(i, n)| (n.time_s, n.depth_mm, Some(i))).collect();
    for (time_s, depth_mm) in corners {
        // a window of one sample may be the corner itself
        if nodes.iter().all(|n| (n.time_s - time_s).abs() > 1e-6) {
            all.push((time_s, depth_mm, None));
        }
    }
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut at = vec![0; nodes.len()];
    for (place, (_, _, node)) in all.iter().enumerate() {
        if let Some(node) = node {
            at[*node] = place;
        }
    }
    (all.into_iter().map(|(t, d, _)| (t, d)).collect(), at)
}

/// Windows of equal numbers of samples, at most so many.
pub(super) fn even(windows: &mut Vec<(Range<usize>, Branch)>, samples: Range<usize>, most: usize, branch: Branch) {
    let count = samples.len().min(most);
    for k in 0..count {
        let at = |k: usize| samples.start + k * samples.len() / count;
        windows.push((at(k)..at(k + 1), branch));
    }
}

/// Windows of growing length, at most so many.
pub(super) fn growing(
    windows: &mut Vec<(Range<usize>, Branch)>,
    recording: &Recording,
    hold: Range<usize>,
    most: usize,
) {
    let time = &recording.time_s;
    let (from, to) = (time[hold.start], time[hold.end - 1]);
    let mut start = hold.start;
    for k in 1..=most {
        // a hundredth of the hold first, the rest evenly in the logarithm
        let share = (100.0_f64.ln() * (k as f64 / most as f64 - 1.0)).exp();
        let end_s = from + share * (to - from);
        let end = if k == most { hold.end } else { time[hold.clone()].partition_point(|t| *t <= end_s) + hold.start };
        if end > start {
            windows.push((start..end, Branch::Hold));
            start = end;
        }
    }
}

/// Mean of some samples; the depth is 0 where none was recorded.
pub(super) fn node(
    recording: &Recording,
    window: &Range<usize>,
    branch: Branch,
    start_s: f64,
    held_from_s: f64,
    zero_mm: f64,
) -> Node {
    let mean =
        |values: &[f64]| values.get(window.clone()).map_or(0.0, |own| own.iter().sum::<f64>() / window.len() as f64);
    let time_s = mean(&recording.time_s) - start_s;
    let first = recording.time_s[window.start];
    let next = recording.time_s.get(window.end).copied().unwrap_or_else(|| {
        let last = recording.time_s[window.end - 1];
        last + (last - first) / (window.len().max(2) - 1) as f64
    });
    Node {
        time_s,
        length_s: (next - first).max(1e-6),
        samples: window.len(),
        depth_mm: mean(&recording.depth_mm) - zero_mm,
        force_n: mean(&recording.force_n),
        branch,
        held_s: if branch == Branch::Hold { (time_s + start_s - held_from_s).max(0.0) } else { 0.0 },
        lifted: false,
    }
}
