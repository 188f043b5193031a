//! The experiment of thesis chapter 2 on force models, and its identification.

use lut_gen::chain::{Chain, Geometry, Library, Model, Need, Passage, Setting};
use lut_gen::solid::model::Specimen;
use lut_gen::solid::solve::Base;

use super::super::Outcome;
use super::cause::{Cause, Foam, Pair, SESSION};

/// Stroke of thesis section 2.6 at 1 mm/s and 50 Hz.
pub const DEPTH_MM: f64 = 4.0;
pub const SAMPLES: usize = 200;
pub const BALLS_MM: [f64; 2] = [4.0, 6.0];
/// Beyond the stroke: a contact found late, and what compliance adds.
pub const MARGIN_MM: f64 = 0.5;

/// Force curves of a foam under both balls.
pub struct Bench {
    chain: Chain,
    depths: Vec<f64>,
    /// Exponents, and the curves of unit modulus at each.
    units: Vec<(f64, [Vec<f64>; 2])>,
}

/// Exponents of the force models, and how many curves an identification chooses from: 0.7 % of the exponent apart.
pub const LOW: f64 = 1.8;
pub const HIGH: f64 = 26.0;
pub const UNITS: usize = 400;
/// First look at every so many of them.
pub const COARSE: usize = 16;

impl Bench {
    pub fn of(foam: &Foam) -> Outcome<Self> {
        let specimen = Specimen { height_mm: foam.height_mm, radius_mm: 36.0, base: Base::Bonded };
        let one = |ball_mm| Geometry { specimen, ball_mm, depth_mm: DEPTH_MM + MARGIN_MM, nu: 0.0 };
        let library = Library::build(&BALLS_MM.map(one), Need { effects: true }, &|_, _| {})?;
        let depths: Vec<f64> = (0..=SAMPLES).map(|k| DEPTH_MM * k as f64 / SAMPLES as f64).collect();
        let passage = |at: usize| Passage {
            time_s: depths.clone(),
            depth_mm: depths.clone(),
            geometry: at,
            indenter: at,
            ..Passage::default()
        };
        let chain = Chain { library, passages: vec![passage(0), passage(1)] };
        let mut bench = Self { chain, depths, units: Vec::new() };
        let alpha = |k: usize| (LOW.ln() + (HIGH / LOW).ln() * k as f64 / (UNITS - 1) as f64).exp();
        bench.units = (0..UNITS).map(|k| (alpha(k), bench.with((1.0, alpha(k)), None))).collect();
        Ok(bench)
    }

    pub fn with(&self, (mu_mpa, alpha): Pair, setting: Option<Setting>) -> [Vec<f64>; 2] {
        let mut model = Model::base(mu_mpa, alpha);
        model.settings.extend(setting);
        let mut both = self.chain.predict(&model, &[0.0, 0.0]).into_iter();
        [both.next().unwrap_or_default(), both.next().unwrap_or_default()]
    }

    /// Recordings of a material with an amount of a cause.
    pub fn pressed(&self, truth: Pair, cause: &Cause, amount: f64) -> [Vec<f64>; 2] {
        let mut curves = self.with(truth, cause.setting(amount));
        if cause.code == SESSION {
            curves[1].iter_mut().for_each(|force| *force *= 1.0 + amount);
        }
        curves
    }

    /// Eq. 14 with the best modulus at one exponent, over the curves that are asked for and up to a depth: for a sum of absolute
    /// differences that is a weighted median of force ratios.
    fn eq14(&self, data: &[Vec<f64>; 2], asked: [bool; 2], unit: usize, depth_mm: f64) -> (f64, f64) {
        let mut ratios: Vec<(f64, f64, f64)> = Vec::new();
        for ball in (0..2).filter(|ball| asked[*ball]) {
            let samples = self.depths.iter().zip(&self.units[unit].1[ball]).zip(&data[ball]);
            ratios
                .extend(samples.filter(|((d, f), _)| **d <= depth_mm && **f > 0.0).map(|((_, f), y)| (y / f, *f, *y)));
        }
        ratios.sort_by(|a, b| a.0.total_cmp(&b.0));
        let half = 0.5 * ratios.iter().map(|r| r.1).sum::<f64>();
        let mut sum = 0.0;
        let middle = ratios.iter().find(|r| {
            sum += r.1;
            sum >= half
        });
        let mu = middle.map_or(f64::NAN, |r| r.0);
        (ratios.iter().map(|(_, f, y)| (mu * f - y).abs()).sum(), mu)
    }

    /// The thesis' identification: the least of Eq. 14.
    pub fn identify(&self, data: &[Vec<f64>; 2], asked: [bool; 2], depth_mm: f64) -> Pair {
        let value = |unit: usize| self.eq14(data, asked, unit, depth_mm).0;
        let least = |units: &mut dyn Iterator<Item = usize>| {
            units.map(|unit| (unit, value(unit))).min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |best| best.0)
        };
        let near = least(&mut (0..UNITS).step_by(COARSE));
        let best = least(&mut (near.saturating_sub(COARSE)..(near + COARSE + 1).min(UNITS)));
        (self.eq14(data, asked, best, depth_mm).1, self.units[best].0)
    }

    /// From the ball of 4 mm, from that of 6 mm, from both.
    pub fn table_1(&self, data: &[Vec<f64>; 2]) -> [Pair; 3] {
        [[true, false], [false, true], [true, true]].map(|asked| self.identify(data, asked, DEPTH_MM))
    }
}

/// Root mean square of the difference of two sets of curves, percent of each peak.
pub fn distance(a: &[Vec<f64>; 2], b: &[Vec<f64>; 2]) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for (x, y) in a.iter().zip(b) {
        let peak = y.iter().copied().fold(0.0, f64::max);
        sum += x.iter().zip(y).map(|(x, y)| ((x - y) / peak).powi(2)).sum::<f64>();
        count += x.len() as f64;
    }
    100.0 * (sum / count).sqrt()
}

/// Root mean square of the relative differences of pairs, percent.
pub fn apart(found: &[Pair], printed: &[Pair]) -> f64 {
    let square = |a: f64, b: f64| (a / b).ln().powi(2);
    let each = found.iter().zip(printed).map(|(f, p)| square(f.0, p.0) + square(f.1, p.1));
    100.0 * (each.sum::<f64>() / (2 * found.len()) as f64).sqrt()
}
