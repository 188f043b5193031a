//! What was done in an experiment, and its data thinned to nodes.

pub(super) mod usable;
pub(super) mod windows;

use lut_gen::chain::{Geometry, Passage, RUBBER_NU, Window};
use lut_gen::effect::{Effect, Owner, Sizes};
use lut_gen::solid::model::Specimen as Block;
use lut_gen::solid::solve;
use nalgebra::{DMatrix, DVector};

use super::Refusal;
use super::check::{self, Check, Coupon};
use crate::experiment::{Base, BaseLaw, Experiment};
pub(super) use usable::LEAST_SAMPLES;
use usable::{MEANT_MM, Raw, contacts, raw_runs};
pub use windows::{Branch, Node};
use windows::{nodes, path};

/// Rates that differ by less than this share are one rate.
const SAME_RATE: f64 = 0.05;
/// Largest depth over ball radius that the force models are asked for: beyond, a ball is a shank.
const DEEPEST: f64 = 1.2;
/// The same where the specimen hardly changes its volume.
const DEEPEST_RUBBER: f64 = 1.0;
/// Powers of depth or time that a smooth curve has on a branch.
const SHAPES: usize = 3;
/// Shapes that differ by less than this are one.
const SAME_SHAPE: f64 = 1e-6;
/// How far past the contact the recorded zero may lie, mm: depths that the force models must cover.
const LATE_MM: f64 = 0.25;

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
    /// Where on the specimen, mm, if known.
    pub place_mm: Option<[f64; 2]>,
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

impl Series {
    /// True where another run, or this one, is of the same condition with as many nodes: they are compared one by one.
    pub(super) fn is_like(&self, other: &Series) -> bool {
        self.condition == other.condition && self.nodes.len() == other.nodes.len()
    }
}

impl Design {
    /// Largest force of all runs, N.
    #[must_use]
    pub fn largest_n(&self) -> f64 {
        self.series.iter().flat_map(|s| &s.nodes).map(|n| n.force_n).fold(0.0, f64::max)
    }

    /// A smooth curve through the force of a run at its nodes, N: a prediction of it times what the mean of all repeats of its condition is of that, smooth over the depth on
    /// either way and over the time of a hold.
    ///
    /// Gains scale with it. Where they scale with a fit instead, a softer fit has the smaller errors and so the better likelihood; where they scale with the samples, their own noise
    /// is in the errors and pulls the same way (Peelle's puzzle).
    #[must_use]
    pub fn smooth_n(&self, series: usize, predicted_n: &[f64]) -> Vec<f64> {
        let own = &self.series[series];
        let repeats: Vec<&Series> = self.series.iter().filter(|other| own.is_like(other)).collect();
        let mean = |k: usize| {
            let there: Vec<f64> =
                repeats.iter().map(|run| &run.nodes[k]).filter(|n| !n.lifted).map(|n| n.force_n).collect();
            there.iter().sum::<f64>() / there.len().max(1) as f64
        };
        let deepest_mm = own.nodes.iter().map(|n| n.depth_mm).fold(f64::MIN_POSITIVE, f64::max);
        let shapes = DMatrix::from_fn(own.nodes.len(), 3 * SHAPES, |k, j| {
            let node = &own.nodes[k];
            let (branch, power) = (j / SHAPES, (j % SHAPES) as i32);
            let along = match node.branch {
                Branch::Hold => node.held_s.max(0.0).ln_1p(),
                Branch::Loading | Branch::Unloading => node.depth_mm.max(0.0) / deepest_mm,
            };
            let counts = !node.lifted && node.branch as usize == branch;
            if counts { predicted_n[k] * along.powi(power) } else { 0.0 }
        });
        let measured = DVector::from_fn(own.nodes.len(), |k, _| mean(k));
        let shares = shapes.clone().svd(true, true).solve(&measured, SAME_SHAPE * shapes.norm());
        shares.map_or_else(|_| predicted_n.to_vec(), |shares| (&shapes * shares).iter().map(|f| f.max(0.0)).collect())
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
        if self.series.is_empty() {
            return self.sizes_of_coupons();
        }
        Sizes {
            force_n: self.largest_n(),
            radius_mm: of(&|g| g.ball_mm),
            height_mm: of(&|g| g.specimen.height_mm),
            rate_mm_per_s: self.rates_mm_per_s.last().copied().unwrap_or(1.0),
            run_s: self.series.iter().flat_map(|s| &s.nodes).map(|n| n.time_s).fold(0.0, f64::max),
        }
    }

    /// The same where nothing but coupons was compressed: their height stands for every length.
    fn sizes_of_coupons(&self) -> Sizes {
        let coupons = || self.checks.iter().filter_map(Check::coupon);
        let most = |of: &dyn Fn(&Node) -> f64| coupons().flat_map(|c| c.nodes()).map(of).fold(0.0, f64::max);
        let height_mm = coupons().map(Coupon::height_mm).fold(0.0, f64::max);
        let speed = |n: &Node| if n.branch == Branch::Loading { n.depth_mm / n.time_s.max(1e-6) } else { 0.0 };
        Sizes {
            force_n: most(&|n| n.force_n),
            radius_mm: height_mm,
            height_mm,
            rate_mm_per_s: most(&speed).max(1e-6),
            run_s: most(&|n| n.time_s),
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
            place_mm: run.place_mm,
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
