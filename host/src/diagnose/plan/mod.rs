//! Which run to make next: the feasible one that puts the rivals farthest apart, all their parameters free.

mod bench;
mod coupon;
mod motion;

use lut_gen::chain::{Model, Setting};
use lut_gen::effect::{Quantity, Spread};
use rayon::prelude::*;

use crate::experiment::Experiment;

use super::check::{Check, Touched};
use super::design::{Branch, Design, LEAST_SAMPLES, Node, Series};
use super::fit::Fit;
use super::search::Search;
use super::sets::Weighed;
use crate::infer::covariance::Factor;
use crate::infer::product::inner;
use bench::{Bench, Forecast, distance};
pub use motion::{On, Plan};
use motion::{SAMPLE_HZ, significant};

/// A run that could be made.
#[derive(Debug, Clone, PartialEq)]
pub struct Proposal {
    /// What to do, in words.
    pub what: String,
    /// Codes it would decide between, or show.
    pub decides: Vec<&'static str>,
    /// Distance between the rivals that it leaves closest, in standard deviations of everything that is not known; for blind spots the
    /// reading that a plausible amount of the best seen one would make.
    pub distance: f64,
    /// The motion.
    pub motion: Plan,
}

/// Spots that a planned run is made on; coupons.
const SPOTS: usize = 2;
/// Time that a load stands on the sensor, s.
const STANDING_S: f64 = 60.0;
/// Nodes of loading, hold and way back.
const NODES: (usize, usize, usize) = (30, 12, 20);
/// Proposals that are told.
const TOLD: usize = 5;
/// Rivals that are told apart.
const RIVALS: usize = 5;
/// Distance from which on rivals count as decided: a likelihood ratio of 100 is 3.03 standard deviations.
const DECIDED: f64 = 3.03;

/// Runs that laboratories can make with what they have: other rates, a hold, a way back, cycles, another ball, another height; coupons, whose size is such that none of
/// the models, the base and its rivals, leaves the range of the sensor.
fn feasible(design: &Design, models: &[&Model]) -> Vec<Plan> {
    let mut list = Vec::new();
    let deepest = |s: &Series| s.nodes.iter().map(|n| n.depth_mm).fold(0.0, f64::max);
    let mut seen: Vec<(usize, usize)> = Vec::new();
    let slowest = design.rates_mm_per_s.first().copied().unwrap_or(1.0);
    let fastest = design.rates_mm_per_s.last().copied().unwrap_or(1.0);
    for series in &design.series {
        if seen.contains(&(series.specimen, series.indenter)) {
            continue;
        }
        seen.push((series.specimen, series.indenter));
        let usual = Plan {
            on: On::Specimen,
            specimen: series.specimen,
            height: 1.0,
            indenter: series.indenter,
            radius: 1.0,
            rate_mm_per_s: design.rates_mm_per_s[series.rate],
            depth_mm: deepest(series),
            hold_s: 0.0,
            unload: false,
            cycles: 1,
        };
        for rate_mm_per_s in [0.25 * slowest, slowest, (slowest * fastest).sqrt(), fastest, 4.0 * fastest] {
            let plan = Plan { rate_mm_per_s, ..usual };
            list.push(plan);
            list.push(Plan { hold_s: 10.0, unload: true, ..plan });
        }
        list.push(Plan { hold_s: 60.0, ..usual });
        list.push(Plan { unload: true, ..usual });
        list.push(Plan { unload: true, cycles: 3, ..usual });
        list.push(Plan { height: 2.0, ..usual });
        list.push(Plan { height: 2.0, hold_s: 10.0, unload: true, ..usual });
        for radius in [0.7, 1.5] {
            let depth_mm = usual.depth_mm * f64::min(radius, 1.0);
            list.push(Plan { radius, depth_mm, ..usual });
            list.push(Plan { radius, depth_mm, hold_s: 10.0, unload: true, ..usual });
        }
        if seen.len() == 1 {
            // machine and sensor alone, whatever the ball
            let load_n = design.largest_n();
            let alone = Plan { hold_s: STANDING_S, ..usual };
            list.extend([On::Block(load_n), On::Mass(load_n), On::Air].map(|on| Plan { on, ..alone }));
            let geometry = &design.geometries[series.geometry];
            // of what hardly changes its volume a coupon is not compared
            if geometry.nu == 0.0 {
                let middle = Plan { rate_mm_per_s: (slowest * fastest).sqrt(), ..usual };
                list.push(coupon::in_ring(middle, geometry.specimen.height_mm, (models, load_n)));
            }
        }
    }
    // a ramp of too few samples would not be used
    list.retain(|plan| {
        plan.on != On::Specimen || plan.depth_mm / plan.rate_mm_per_s * SAMPLE_HZ >= 2.0 * LEAST_SAMPLES as f64
    });
    list
}

impl Plan {
    /// In words.
    #[must_use]
    pub fn words(&self, experiment: &Experiment) -> String {
        let ball = &experiment.indenters[self.indenter];
        let twice = match self.on {
            On::Specimen => None,
            On::Block(load_n) => Some(format!(
                "press ball {} onto a stiff block to {:.2} N at {} mm/s, hold for {} s, twice",
                ball.name,
                load_n,
                significant(self.rate_mm_per_s),
                self.hold_s
            )),
            On::Mass(load_n) => {
                Some(format!("put a known load of {load_n:.2} N on the sensor for {} s, twice", self.hold_s))
            }
            On::Air => Some(format!("record {} s in air at the end of the session, twice", self.hold_s)),
            On::Confined(diameter_mm) => Some(coupon::words(self, experiment, diameter_mm)),
        };
        if let Some(text) = twice {
            return text;
        }
        let specimen = &experiment.specimens[self.specimen];
        let ball = match ball.radius_mm.known() {
            Some(mm) if self.radius != 1.0 => format!("another ball of {:.1} mm", self.radius * mm),
            Some(_) | None => format!("ball {}", ball.name),
        };
        let block = match specimen.height_mm.known() {
            Some(mm) if self.height != 1.0 => {
                format!("a specimen of {:.1} mm instead of {}", self.height * mm, specimen.name)
            }
            Some(_) | None => format!("specimen {}", specimen.name),
        };
        let mut text =
            format!("press {ball} into {block} to {:.2} mm at {} mm/s", self.depth_mm, significant(self.rate_mm_per_s));
        if self.hold_s > 0.0 {
            text.push_str(&format!(", hold for {} s", self.hold_s));
        }
        if self.unload {
            text.push_str(", record the way back");
        }
        if self.cycles > 1 {
            text.push_str(&format!(", {} times on each spot", self.cycles));
        }
        text.push_str(", on two fresh spots");
        text
    }

    /// The runs without a ball on the specimen, with readings to be filled in; of coupons, those of `base`. None where these would show nothing.
    fn checks(&self, like: &Design, base: &Model) -> Option<Vec<Check>> {
        let end_s = like.series.iter().map(|s| s.start_s).try_fold(0.0, |end: f64, start| Some(end.max(start?)));
        let beside = (end_s, like.largest_n());
        let standing = |touched, load_n| Check::planned(touched, (load_n, self.hold_s), SAMPLE_HZ, beside);
        let one = match self.on {
            On::Specimen => return Some(Vec::new()),
            On::Block(load_n) => standing(Touched::Block, load_n),
            On::Mass(load_n) => standing(Touched::Load, load_n),
            On::Air => standing(Touched::Nothing, 0.0),
            On::Confined(diameter_mm) => coupon::check(self, diameter_mm, like, (base, beside))?,
        };
        Some(vec![one; SPOTS])
    }

    /// The runs as a design of their own, with forces to be filled in.
    fn design(&self, like: &Design, base: &Model, geometry: usize) -> Option<Design> {
        let mut series = Vec::new();
        let spots = if self.on == On::Specimen { SPOTS } else { 0 };
        for spot in 0..spots {
            for cycle in 1..=self.cycles {
                let nodes = self.nodes();
                let path: Vec<(f64, f64)> = nodes.iter().map(|n| (n.time_s, n.depth_mm)).collect();
                series.push(Series {
                    run: 0,
                    specimen: self.specimen,
                    indenter: self.indenter,
                    geometry,
                    rate: 0,
                    cycle: i64::try_from(cycle).unwrap_or(1),
                    start_s: None,
                    place_mm: None,
                    spot,
                    condition: cycle - 1,
                    group: 0,
                    hold_out: false,
                    pressed_before_mm: if cycle > 1 { self.depth_mm } else { 0.0 },
                    at: (0..nodes.len()).collect(),
                    path,
                    nodes,
                });
            }
        }
        Some(Design {
            material: like.material.clone(),
            series,
            checks: self.checks(like, base)?,
            geometries: like.geometries.clone(),
            rates_mm_per_s: vec![self.rate_mm_per_s],
            spots,
            conditions: self.cycles,
            groups: 1,
            zero_is_contact: like.zero_is_contact,
            zero_mm: 0.0,
            messages: Vec::new(),
        })
    }

    fn nodes(&self) -> Vec<Node> {
        let ramp_s = self.depth_mm / self.rate_mm_per_s;
        let mut nodes = Vec::new();
        let mut add = |from_s: f64, to_s: f64, branch: Branch| {
            let time_s = 0.5 * (from_s + to_s);
            let back_s = ramp_s + self.hold_s;
            let depth_mm = match branch {
                Branch::Loading => time_s * self.rate_mm_per_s,
                Branch::Hold => self.depth_mm,
                Branch::Unloading => self.depth_mm - (time_s - back_s) * self.rate_mm_per_s,
            };
            let length_s = to_s - from_s;
            let samples = ((length_s * SAMPLE_HZ) as usize).max(1);
            let held_s = if branch == Branch::Hold { time_s - ramp_s } else { 0.0 };
            nodes.push(Node { time_s, length_s, samples, depth_mm, force_n: 0.0, branch, held_s, lifted: false });
        };
        let part = |k: usize, of: usize, length: f64| length * k as f64 / of as f64;
        for k in 0..NODES.0 {
            add(part(k, NODES.0, ramp_s), part(k + 1, NODES.0, ramp_s), Branch::Loading);
        }
        if self.hold_s > 0.0 {
            let place = |k: usize| {
                let share = (100.0_f64.ln() * (k as f64 / NODES.1 as f64 - 1.0)).exp();
                ramp_s + if k == 0 { 0.0 } else { share * self.hold_s }
            };
            for k in 0..NODES.1 {
                add(place(k), place(k + 1), Branch::Hold);
            }
        }
        if self.unload {
            let from = ramp_s + self.hold_s;
            for k in 0..NODES.2 {
                add(from + part(k, NODES.2, ramp_s), from + part(k + 1, NODES.2, ramp_s), Branch::Unloading);
            }
        }
        nodes
    }
}

/// Proposals, the best first: between rivals where there are several, else those that show what the design is blind to.
#[must_use]
pub fn proposals(
    experiment: &Experiment,
    search: &Search<'_>,
    rivals: &[&Weighed],
    blind: &[&'static str],
) -> Vec<Proposal> {
    let rivals = distinct(rivals);
    let models: Vec<&Model> = std::iter::once(&search.base.model).chain(rivals.iter().map(|fit| &fit.model)).collect();
    let plans = feasible(search.problem.design, &models);
    let mut list: Vec<Proposal> = plans
        .into_par_iter()
        .filter_map(|plan| {
            let bench = Bench::new(search, plan)?;
            let (distance, decides) =
                if rivals.len() > 1 { between(&bench, &rivals) } else { shown(&bench, search, blind) };
            Some(Proposal { what: plan.words(experiment), decides, distance, motion: plan })
        })
        .collect();
    list.sort_by(|a, b| b.decides.len().cmp(&a.decides.len()).then(b.distance.total_cmp(&a.distance)));
    list.retain(|p| !p.decides.is_empty());
    list.truncate(TOLD);
    list
}

/// The best explanation of every set of codes.
fn distinct<'a>(rivals: &[&'a Weighed]) -> Vec<&'a Fit> {
    let mut seen: Vec<Vec<&str>> = Vec::new();
    let mut out = Vec::new();
    for set in rivals {
        let mut codes: Vec<&str> = set.fit.codes().collect();
        codes.sort_unstable();
        if !seen.contains(&codes) {
            seen.push(codes);
            out.push(&set.fit);
        }
    }
    out.truncate(RIVALS);
    out
}

/// Least distance between two rivals, and the codes of those that lie far enough apart.
fn between(bench: &Bench, rivals: &[&Fit]) -> (f64, Vec<&'static str>) {
    let forecasts: Vec<Forecast> = rivals.iter().map(|fit| bench.forecast(fit)).collect();
    let mut least = f64::INFINITY;
    let mut decided: Vec<&'static str> = Vec::new();
    for i in 0..rivals.len() {
        for j in 0..i {
            let there = distance(&forecasts[i], &forecasts[j], rivals[j]);
            let back = distance(&forecasts[j], &forecasts[i], rivals[i]);
            let apart = there.min(back);
            least = least.min(apart);
            if apart > DECIDED {
                let codes = |fit: &Fit| fit.codes().collect::<Vec<_>>();
                let (a, b) = (codes(rivals[i]), codes(rivals[j]));
                let own = a.iter().filter(|c| !b.contains(c)).chain(b.iter().filter(|c| !a.contains(c))).copied();
                for code in own {
                    if !decided.contains(&code) {
                        decided.push(code);
                    }
                }
            }
        }
    }
    (least, decided)
}

/// Blind spots of which a plausible amount would show with the planned run, and how clearly the best of them.
fn shown(bench: &Bench, search: &Search<'_>, blind: &[&'static str]) -> (f64, Vec<&'static str>) {
    /// A direction needs 2.8 to pass alone at one in two hundred; 1.3 more to do so in nine cases of ten.
    const SEEN: f64 = 4.1;
    let base = bench.forecast(&search.base);
    let mut best = 0.0;
    let mut codes = Vec::new();
    for (candidate, old) in search.candidates.iter().zip(&search.signatures) {
        let code = candidate.effect.code;
        if !blind.contains(&code) || codes.contains(&code) {
            continue;
        }
        let sizes = candidate.sizes(search.problem.design);
        let value = |q: &Quantity| match q.spread {
            Spread::Even => q.scaled(q.plausible, &sizes),
            Spread::Logarithmic => q.starts[q.starts.len() / 2],
        };
        let values = candidate.effect.quantities.iter().map(value).collect();
        let mut model = search.base.model.clone();
        model.settings.push(Setting { effect: candidate.effect, owner: candidate.owner, values });
        let new = bench.forces(&model) - &base.force;
        // old and new data together, the base fitted to both
        let middle = old.column(old.ncols() / 2);
        let information = inner(&search.base.jacobian, &search.base.jacobian) + inner(&base.slopes, &base.slopes);
        let right = search.base.jacobian.tr_mul(&middle) + base.slopes.tr_mul(&new);
        // a base that is not told of takes up all
        let Some(known) = Factor::of(&information) else { continue };
        let taken = known.solve(&right).dot(&right);
        let reading = (middle.norm_squared() + new.norm_squared() - taken).max(0.0).sqrt();
        best = f64::max(best, reading);
        if reading > SEEN {
            codes.push(code);
        }
    }
    (best, codes)
}
