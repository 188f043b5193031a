//! What a design's runs are made of: balls, heights, rates, motion.

use palpate::simulate::{RunTemplate, SAMPLE_HZ, Spec};
use rand::Rng;
use rand::seq::{IndexedRandom, SliceRandom};
use rand_pcg::Pcg64;

use super::Design;
use super::draw::Foam;

/// Heights of specimens of the four designs, mm.
const THIN_MM: f64 = 12.7;
const THICK_MM: f64 = 25.4;
/// Rates of the four designs, mm/s.
const RATES_MM_S: [f64; 3] = [0.5, 2.0, 8.0];
/// Their largest recorded depth, mm.
const PEAK_MM: f64 = 3.0;
const HOLD_S: f64 = 5.0;
/// Time between the cycles of a spot, s.
const REST_S: f64 = 30.0;

/// Balls that laboratories have, mm.
const BALLS_MM: [f64; 9] = [2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.5];
/// Heights of slabs, mm.
const HEIGHTS_MM: [f64; 7] = [10.0, 12.7, 15.0, 20.0, 25.0, 30.0, 50.0];
const OWN_RATES_MM_S: [f64; 7] = [0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0];
const HOLDS_S: [f64; 4] = [0.0, 2.0, 10.0, 30.0];
const SAMPLES_HZ: [f64; 4] = [20.0, 50.0, 100.0, 200.0];
/// Deepest part of a slab, and of the smallest ball's radius.
const DEEPEST: [f64; 2] = [0.25, 0.75];
/// A slab reaches so many heights from the middle of its upper face, and 25 mm at least.
const SLAB: f64 = 1.5;
/// A longer experiment is not made.
const MOST_RUNS: usize = 60;

/// Where a ball of one radius is pressed into one height at these rates.
#[derive(Debug, Clone, PartialEq)]
struct Block {
    height_mm: f64,
    radius_mm: f64,
    rates_mm_s: Vec<f64>,
}

/// The runs of a design.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Layout {
    blocks: Vec<Block>,
    pub(super) peak_mm: f64,
    pub(super) hold_s: f64,
    pub(super) unload: bool,
    pub(super) cycles: usize,
    pub(super) replicates: usize,
    pub(super) sample_hz: f64,
}

impl Layout {
    /// Of a design; what a laboratory would choose is drawn.
    pub(super) fn of(design: Design, chance: &mut Pcg64) -> Self {
        let block = |height_mm, radius_mm, rates: &[f64]| Block { height_mm, radius_mm, rates_mm_s: rates.to_vec() };
        let fixed = |blocks: Vec<Block>, cycles, replicates| Self {
            blocks,
            peak_mm: PEAK_MM,
            hold_s: if cycles > 1 { HOLD_S } else { 0.0 },
            unload: cycles > 1,
            cycles,
            replicates,
            sample_hz: SAMPLE_HZ,
        };
        let two = |rates: &[f64]| vec![block(THIN_MM, 4.0, rates), block(THIN_MM, 6.0, rates)];
        match design {
            Design::D6 => fixed(two(&[2.0]), 1, 3),
            Design::D18 => fixed(two(&RATES_MM_S), 1, 3),
            Design::D36 => fixed(two(&RATES_MM_S), 3, 2),
            Design::D60 => {
                let mut blocks = two(&RATES_MM_S);
                for (height_mm, radius_mm) in [(THICK_MM, 4.0), (THICK_MM, 6.0), (THIN_MM, 9.0), (THICK_MM, 9.0)] {
                    blocks.push(block(height_mm, radius_mm, &[2.0]));
                }
                fixed(blocks, 3, 2)
            }
            Design::Own => Self::own(chance),
        }
    }

    /// One to three balls, one or two heights, one to four rates, with and without holds, ways back and cycles.
    fn own(chance: &mut Pcg64) -> Self {
        let some = |list: &[f64], count: usize, chance: &mut Pcg64| {
            let mut some: Vec<f64> = list.choose_multiple(chance, count).copied().collect();
            some.sort_by(f64::total_cmp);
            some
        };
        let radii = some(&BALLS_MM, chance.random_range(1..=3), chance);
        let heights = some(&HEIGHTS_MM, chance.random_range(1..=2), chance);
        let rates = some(&OWN_RATES_MM_S, chance.random_range(1..=4), chance);
        let least = |list: &[f64]| list.iter().copied().fold(f64::INFINITY, f64::min);
        let deepest = (DEEPEST[0] * least(&heights)).min(DEEPEST[1] * least(&radii));
        let unload = chance.random::<bool>();
        let cycles = if unload { chance.random_range(1..=4) } else { 1 };
        let mut blocks: Vec<Block> = Vec::new();
        for height_mm in &heights {
            for radius_mm in &radii {
                blocks.push(Block { height_mm: *height_mm, radius_mm: *radius_mm, rates_mm_s: rates.clone() });
            }
        }
        let replicates = chance.random_range(2..=4);
        // who has little time leaves out rates of the later balls and heights
        let runs = |blocks: &[Block]| blocks.iter().map(|b| b.rates_mm_s.len()).sum::<usize>() * replicates * cycles;
        for at in (1..blocks.len()).rev() {
            if runs(&blocks) > MOST_RUNS {
                blocks[at].rates_mm_s = vec![rates[rates.len() / 2]];
            }
        }
        while runs(&blocks) > MOST_RUNS {
            match blocks.as_mut_slice() {
                [only] => drop(only.rates_mm_s.pop()),
                _ => drop(blocks.pop()),
            }
        }
        blocks.shuffle(chance);
        Self {
            blocks,
            peak_mm: (deepest * chance.random_range(6.0..10.0)).floor() / 10.0,
            hold_s: HOLDS_S.choose(chance).copied().unwrap_or(0.0),
            unload,
            cycles,
            replicates,
            sample_hz: SAMPLES_HZ.choose(chance).copied().unwrap_or(SAMPLE_HZ),
        }
    }

    /// Radii of the balls, mm.
    pub(super) fn radii_mm(&self) -> Vec<f64> {
        let mut radii: Vec<f64> = self.blocks.iter().map(|b| b.radius_mm).collect();
        radii.sort_by(f64::total_cmp);
        radii.dedup();
        radii
    }

    /// Height of the thinnest slab, mm.
    pub(super) fn thinnest_mm(&self) -> f64 {
        self.blocks.iter().map(|b| b.height_mm).fold(f64::INFINITY, f64::min)
    }

    /// Rates, mm/s.
    pub(super) fn rates_mm_s(&self) -> Vec<f64> {
        let mut rates: Vec<f64> = self.blocks.iter().flat_map(|b| b.rates_mm_s.clone()).collect();
        rates.sort_by(f64::total_cmp);
        rates.dedup();
        rates
    }

    /// Hours from the first run to the last, about.
    pub(super) fn session_h(&self) -> f64 {
        let ways = if self.unload { 2.0 } else { 1.0 };
        let run = |rate: f64| ways * self.peak_mm / rate + self.hold_s + REST_S;
        let once: f64 = self.blocks.iter().flat_map(|b| &b.rates_mm_s).map(|rate| run(*rate)).sum();
        once * (self.replicates * self.cycles) as f64 / 3600.0
    }

    /// Adds specimens, balls and runs to a specification.
    pub(super) fn fill(&self, mut spec: Spec, foam: &Foam) -> Spec {
        spec.sample_hz = self.sample_hz;
        for block in &self.blocks {
            let (slab, tip) = (slab(block.height_mm), ball(block.radius_mm));
            if spec.specimen(&slab).is_none() {
                spec = spec.foam(&slab, foam.mu_mpa, foam.alpha, block.height_mm);
                if let Some(one) = spec.specimens.last_mut() {
                    one.radius_mm = one.radius_mm.max(SLAB * block.height_mm);
                }
            }
            if spec.indenter(&tip).is_none() {
                spec = spec.ball(&tip, block.radius_mm);
            }
            for rate in &block.rates_mm_s {
                spec.runs.push(RunTemplate {
                    replicates: self.replicates,
                    hold_s: self.hold_s,
                    unload: self.unload,
                    cycles: self.cycles,
                    rest_s: REST_S,
                    ..RunTemplate::ramp(&slab, &tip, self.peak_mm, *rate)
                });
            }
        }
        spec
    }
}

/// Name of a ball.
pub(super) fn ball(radius_mm: f64) -> String {
    format!("r{radius_mm}")
}

/// Name of a slab.
fn slab(height_mm: f64) -> String {
    format!("h{height_mm}")
}
