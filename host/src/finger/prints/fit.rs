//! What prints say of a pad: moduli and size that make a finger's prints those that were measured.

use std::path::Path;

use lut_gen::pad::body::section::Section;
use lut_gen::pad::error::PadError;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::super::parse;
use super::Print;
use super::curve::Family;
use super::scaled::Scale;
use crate::calibration::distribution::{student_critical, student_two_sided};
use crate::experiment::ExperimentError;

/// A number of the finger that is free.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Free {
    /// Moduli of skin and tissue together.
    Stiffness,
    /// All lengths.
    Size,
    /// Moduli of the skin beside those of the tissue.
    Skin,
}

impl Free {
    /// All of them, in the order of their numbers.
    pub const ALL: [Free; 3] = [Free::Stiffness, Free::Size, Free::Skin];

    /// What it is called.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Free::Stiffness => "stiffness",
            Free::Size => "size",
            Free::Skin => "skin",
        }
    }
}

/// Elements of the coarser mesh over those of the file: what they change is the discretisation's part of an interval.
const COARSER: f64 = 2.0;

/// A factor that was fitted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fitted {
    /// Of what.
    pub of: Free,
    /// Over the file's number.
    pub factor: f64,
    /// 95 % interval: where the squares rise by Student's t squared while the other numbers follow (profile likelihood), with
    /// errors that all edges share; wider by what elements twice as long change.
    pub interval: (f64, f64),
    /// The prints tell it: its interval is within a factor of two of the value, and it stands at no bound. Never of the skin
    /// beside a free size.
    pub is_told: bool,
}

/// Prints with the finger that fits them.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// The free numbers.
    pub fitted: Vec<Fitted>,
    /// All factors.
    pub scale: Scale,
    /// Root mean square of measured less simulated radius, mm, of circles of the prints' areas: of the finger as it is.
    pub before_mm: f64,
    /// Of the fitted finger less the shift of all edges, over the prints less the free numbers.
    pub after_mm: f64,
    /// How far all edges are read farther out than the fitted finger's, mm.
    pub shift_mm: f64,
    /// Simulated area of the fitted finger at every print, mm2.
    pub area_mm2: Vec<f64>,
    /// Of the finger as it is.
    pub area_before_mm2: Vec<f64>,
    /// How the misfit goes with the logarithm of the force, mm, and the probability of as much by chance.
    pub trend: (f64, f64),
    /// Prints beyond what the finger could be pressed to: their area is extrapolated.
    pub beyond: usize,
}

/// Why no finger was found.
#[derive(Debug, thiserror::Error)]
pub enum Unfitted {
    /// The finger's file.
    #[error(transparent)]
    File(#[from] ExperimentError),
    /// No equilibrium.
    #[error("the finger's press on a plate: {0}")]
    Press(PadError),
    /// Too little to interpolate.
    #[error("the finger's print does not grow with its force; expected one that does")]
    NoCurve,
    /// A finger in the plane has no print.
    #[error("the finger is a section in the plane, whose print has no area; expected section = \"ring\"")]
    Plane,
    /// Fewer prints than numbers.
    #[error("{prints} prints at {forces} different forces for {free} free numbers; expected at least {} forces", free + 1)]
    Few {
        /// Prints.
        prints: usize,
        /// Different forces.
        forces: usize,
        /// Free numbers.
        free: usize,
    },
}

/// An interval within this factor of its value tells something.
const TOLD: f64 = 2.0;
/// Most rounds, and the step that ends them.
const ROUNDS: usize = 200;
const SETTLED: f64 = 1e-10;
/// First step outwards from the best of a number, in logarithms, and halvings of the last.
const FIRST_STEP: f64 = 0.02;
const HALVINGS: usize = 20;
/// Step of a derivative, in logarithms.
const STEP: f64 = 1e-4;
/// Size and stiffness stay within this factor of the file's, in logarithms.
const WIDEST: f64 = 4.6;
/// How far all edges of prints may be read too far out or in, mm (one standard deviation, assumed): ink spreads.
pub const EDGE_MM: f64 = 0.1;
/// How far the simulated edge may be off in a way that changes with the force over a factor of e, mm: a quarter of an element.
const DRIFT_MM: f64 = 0.05;
/// Least scatter of an edge from print to print, mm: the simulated one goes from element to element, and other people's
/// solvers state as much for theirs.
const FINEST_MM: f64 = 0.03;
/// Forces closer than this part of one another are the same.
const SAME: f64 = 0.01;

/// Fits the finger of a file to prints: least squares of the radius of circles of their areas, for what ink tells is where
/// the edge of a print is, and the force is known well. `told` hears of every press done.
///
/// # Errors
/// [`Unfitted`].
pub fn fit(
    (file, text): (&Path, &str),
    prints: &[Print],
    free: &[Free],
    told: &(dyn Fn(usize) + Sync),
) -> Result<Fit, Unfitted> {
    if parse(file, text)?.section == Section::Plane {
        return Err(Unfitted::Plane);
    }
    enough(prints, free)?;
    let skins = free.contains(&Free::Skin);
    let press = |coarser: f64| Family::pressed((file, text), skins, coarser, told);
    let (family, coarse) = rayon::join(|| press(1.0), || press(COARSER));
    let (family, coarse) = (family?, coarse?);
    let both = fitted(&family, prints, free).zip(fitted(&coarse, prints, free));
    let (mut own, coarse) = both.ok_or(Unfitted::NoCurve)?;
    for (own, coarse) in own.fitted.iter_mut().zip(&coarse.fitted) {
        let apart = (coarse.factor / own.factor).max(own.factor / coarse.factor);
        own.interval = (own.interval.0 / apart, own.interval.1 * apart);
        own.is_told &= own.interval.1 < TOLD * own.factor;
    }
    Ok(own)
}

fn enough(prints: &[Print], free: &[Free]) -> Result<(), Unfitted> {
    let mut forces: Vec<f64> = prints.iter().map(|print| print.force_n).collect();
    forces.sort_by(f64::total_cmp);
    forces.dedup_by(|a, b| *a <= *b * (1.0 + SAME));
    if forces.len() > free.len() {
        return Ok(());
    }
    Err(Unfitted::Few { prints: prints.len(), forces: forces.len(), free: free.len() })
}

/// Prints beside a family of fingers; unknowns are the logarithms of the free factors.
struct Problem<'a> {
    family: &'a Family,
    prints: &'a [Print],
    free: &'a [Free],
    /// Lower triangle of the covariance of what is read, mm2.
    errors: Cholesky<f64, Dyn>,
}

impl<'a> Problem<'a> {
    /// With edges that scatter by `scatter_mm` from print to print, and are read wrong together.
    fn new(family: &'a Family, prints: &'a [Print], free: &'a [Free], scatter_mm: f64) -> Option<Self> {
        let covariance = |i: usize, j: usize| {
            let apart = prints[i].force_n.ln() - prints[j].force_n.ln();
            let own = if i == j { scatter_mm.max(FINEST_MM).powi(2) } else { 0.0 };
            own + EDGE_MM.powi(2) + DRIFT_MM.powi(2) * (-0.5 * apart * apart).exp()
        };
        let errors = DMatrix::from_fn(prints.len(), prints.len(), covariance).cholesky()?;
        Some(Problem { family, prints, free, errors })
    }

    fn logs(&self, unknowns: &DVector<f64>) -> [f64; 3] {
        let mut logs = [0.0; 3];
        self.free.iter().zip(unknowns.iter()).for_each(|(own, log)| logs[*own as usize] = *log);
        logs
    }

    fn area_mm2(&self, print: &Print, logs: [f64; 3]) -> f64 {
        self.family.at(print.force_n.ln(), logs).exp()
    }

    /// Measured less simulated radius of every print, mm.
    fn misfit(&self, unknowns: &DVector<f64>) -> DVector<f64> {
        let logs = self.logs(unknowns);
        let one = |print: &Print| radius_mm(print.area_mm2) - radius_mm(self.area_mm2(print, logs));
        DVector::from_iterator(self.prints.len(), self.prints.iter().map(one))
    }

    /// The misfit in standard deviations that know nothing of each other.
    fn residuals(&self, unknowns: &DVector<f64>) -> DVector<f64> {
        let misfit = self.misfit(unknowns);
        self.errors.l().solve_lower_triangular(&misfit).unwrap_or(misfit)
    }

    fn jacobian(&self, unknowns: &DVector<f64>) -> DMatrix<f64> {
        let column = |at: usize| {
            let moved = |by: f64| {
                let mut there = unknowns.clone();
                there[at] += by;
                self.residuals(&there)
            };
            (moved(STEP) - moved(-STEP)) / (2.0 * STEP)
        };
        DMatrix::from_columns(&(0..unknowns.len()).map(column).collect::<Vec<_>>())
    }

    /// Marquardt's damping: rounds end when a step no longer counts. A number that is `held` stays where it begins.
    fn search(&self, begin: DVector<f64>, held: Option<usize>) -> DVector<f64> {
        let (mut at, mut damping) = (begin, 1e-3);
        for _ in 0..ROUNDS {
            let (own, mut slope) = (self.residuals(&at), self.jacobian(&at));
            if let Some(held) = held {
                slope.column_mut(held).fill(0.0);
            }
            let mut normal = slope.transpose() * &slope;
            for i in 0..at.len() {
                normal[(i, i)] += damping * normal[(i, i)].max(1e-12);
            }
            let Some(step) = normal.cholesky().map(|factor| factor.solve(&(-slope.transpose() * &own))) else { break };
            let mut there = &at + step;
            for (i, which) in self.free.iter().enumerate() {
                let (low, high) = bounds(self.family, *which);
                there[i] = there[i].clamp(low, high);
            }
            let moved = (&there - &at).amax();
            if self.residuals(&there).norm_squared() <= own.norm_squared() {
                (at, damping) = (there, (0.3 * damping).max(1e-12));
            } else {
                damping *= 10.0;
            }
            if moved < SETTLED || damping > 1e12 {
                break;
            }
        }
        at
    }

    /// How far a number can go from the best on one side before the squares rise by `allowed`, whatever the others do then:
    /// its logarithm, not beyond its bound.
    fn end(&self, best: &DVector<f64>, at: usize, up: bool, allowed: f64) -> f64 {
        let least = self.residuals(best).norm_squared();
        let (low, high) = bounds(self.family, self.free[at]);
        let bound = if up { high } else { low };
        let (mut within, mut beyond, mut found) = (best[at], bound, best.clone());
        let rises = |log: f64, from: &DVector<f64>| {
            let mut begin = from.clone();
            begin[at] = log;
            let there = self.search(begin, Some(at));
            (self.residuals(&there).norm_squared() - least, there)
        };
        // outwards in steps, so that the others follow
        let mut step = FIRST_STEP * if up { 1.0 } else { -1.0 };
        while (bound - within) * step > 0.0 {
            let next = if up { (within + step).min(bound) } else { (within + step).max(bound) };
            let (rise, there) = rises(next, &found);
            if rise > allowed {
                beyond = next;
                break;
            }
            (within, found, step) = (next, there, 1.5 * step);
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (within + beyond);
            let (rise, there) = rises(middle, &found);
            if rise > allowed { beyond = middle } else { (within, found) = (middle, there) }
        }
        within
    }

    fn freedom(&self) -> f64 {
        self.prints.len().saturating_sub(self.free.len()).max(1) as f64
    }
}

/// Least squares from the file's numbers on: once to learn how edges scatter, once with that scatter. `None` where readings
/// are no numbers.
pub(super) fn fitted(family: &Family, prints: &[Print], free: &[Free]) -> Option<Fit> {
    let first = Problem::new(family, prints, free, EDGE_MM)?;
    let misfit = first.misfit(&first.search(DVector::zeros(free.len()), None));
    let middle = misfit.mean();
    let scatter_mm = (misfit.map(|own| (own - middle).powi(2)).sum() / first.freedom()).sqrt();
    let problem = Problem::new(family, prints, free, scatter_mm)?;
    let at = problem.search(DVector::zeros(free.len()), None);
    let (before, misfit) = (problem.misfit(&DVector::zeros(free.len())), problem.misfit(&at));
    let shift_mm = misfit.mean();
    let after = misfit.map(|own| own - shift_mm);
    let allowed = student_critical(0.05, problem.freedom()).powi(2);
    let one = |(i, own): (usize, &Free)| {
        let (low, high) = bounds(family, *own);
        let (from, to) = (problem.end(&at, i, false, allowed), problem.end(&at, i, true, allowed));
        // Beside a free size the skin hides in it: of another solver's finger its interval missed the truth.
        let hides = *own == Free::Skin && free.contains(&Free::Size);
        let is_told = !hides && (to - at[i]).max(at[i] - from) < TOLD.ln() && from > low && to < high;
        Fitted { of: *own, factor: at[i].exp(), interval: (from.exp(), to.exp()), is_told }
    };
    let logs = problem.logs(&at);
    let area = |logs: [f64; 3]| prints.iter().map(|print| problem.area_mm2(print, logs)).collect();
    Some(Fit {
        fitted: free.iter().enumerate().map(one).collect(),
        scale: Scale { stiffness: logs[0].exp(), size: logs[1].exp(), skin: logs[2].exp() },
        shift_mm,
        before_mm: (before.norm_squared() / prints.len() as f64).sqrt(),
        after_mm: (after.norm_squared() / problem.freedom()).sqrt(),
        area_mm2: area(logs),
        area_before_mm2: area([0.0; 3]),
        trend: trend(prints, &after, free.len()),
        beyond: prints.iter().filter(|print| family.is_beyond(print.force_n.ln(), logs)).count(),
    })
}

/// Radius of a circle of this area.
fn radius_mm(area_mm2: f64) -> f64 {
    (area_mm2 / std::f64::consts::PI).sqrt()
}

fn bounds(family: &Family, own: Free) -> (f64, f64) {
    match own {
        Free::Stiffness | Free::Size => (-WIDEST, WIDEST),
        Free::Skin => family.skins(),
    }
}

/// Slope of the misfit over the logarithm of the force, and the probability of one as large by chance.
fn trend(prints: &[Print], misfit: &DVector<f64>, free: usize) -> (f64, f64) {
    let count = prints.len() as f64;
    let mean = prints.iter().map(|print| print.force_n.ln()).sum::<f64>() / count;
    let width: f64 = prints.iter().map(|print| (print.force_n.ln() - mean).powi(2)).sum();
    let slope = prints.iter().zip(misfit.iter()).map(|(p, r)| (p.force_n.ln() - mean) * r).sum::<f64>() / width;
    let left: f64 = prints.iter().zip(misfit.iter()).map(|(p, r)| (r - slope * (p.force_n.ln() - mean)).powi(2)).sum();
    let freedom = prints.len() as f64 - free as f64 - 1.0;
    if freedom < 1.0 || left <= 0.0 {
        return (slope, 1.0);
    }
    (slope, student_two_sided(slope / (left / freedom / width).sqrt(), freedom))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use rand::SeedableRng;
    use rand_distr::{Distribution, Normal};

    use super::super::curve::Curve;
    use super::*;

    /// A finger whose print grows by a bent power of the force; the skin changes the bend.
    fn family(skins: &[f64]) -> Family {
        let member = |skin: &f64| {
            let points: Vec<(f64, f64)> = (0..40)
                .map(|i| 0.01 * 1.2_f64.powi(i))
                .map(|n| (n, 60.0 * (n / (skin.sqrt() + n)).powf(0.5)))
                .collect();
            (skin.ln(), Curve::new(&points).unwrap())
        };
        Family::of(skins.iter().map(member).collect())
    }

    fn prints([stiffness, size]: [f64; 2], noise: f64, shifted: bool, seed: u64) -> Vec<Print> {
        let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
        let scatter = Normal::new(0.0, noise).unwrap();
        let normal = Normal::new(0.0, 1.0).unwrap();
        let [shift, cos, sin, pitch] = [0; 4].map(|_| if shifted { normal.sample(&mut random) } else { 0.0 });
        // one wave of random pitch: its covariance is the kernel of the drift
        let shared =
            |n: f64| EDGE_MM * shift + DRIFT_MM * (cos * (pitch * n.ln()).cos() + sin * (pitch * n.ln()).sin());
        (0..12)
            .map(|i| 0.2 * 1.35_f64.powi(i))
            .map(|force_n| {
                let base = force_n / (stiffness * size * size);
                let area = size * size * 60.0 * (base / (1.0 + base)).powf(0.5);
                let radius_mm = radius_mm(area) + shared(force_n) + scatter.sample(&mut random);
                Print { force_n, area_mm2: std::f64::consts::PI * radius_mm * radius_mm, radii_mm: None, file: 0 }
            })
            .collect()
    }

    #[test]
    fn true_factors_lie_in_their_intervals_as_often_as_is_said() {
        let family = family(&[1.0]);
        let (mut hits, trials) = ([0; 2], 300);
        for seed in 0..trials {
            let found = fitted(&family, &prints([1.8, 1.2], 0.15, true, seed), &[Free::Stiffness, Free::Size]).unwrap();
            for (hit, (own, truth)) in hits.iter_mut().zip(found.fitted.iter().zip([1.8, 1.2])) {
                *hit += usize::from(own.interval.0 <= truth && truth <= own.interval.1);
            }
        }
        // 95 % of 300: 285, and three standard deviations are 11
        assert!(hits.iter().all(|hit| (274..=296).contains(hit)), "{hits:?}");
    }

    #[test]
    fn one_free_number_where_two_differ_leaves_a_trend() {
        let family = family(&[1.0]);
        let prints = prints([1.8, 1.4], 0.01, false, 7);
        let one = fitted(&family, &prints, &[Free::Stiffness]).unwrap();
        let two = fitted(&family, &prints, &[Free::Stiffness, Free::Size]).unwrap();
        // a tenth of a millimetre may be shared by all edges, so that two numbers need not fit to the noise
        assert!(one.trend.1 < 0.01, "{:?}", one.trend);
        assert!(two.after_mm < 0.5 * one.after_mm, "{} {}", two.after_mm, one.after_mm);
    }

    #[test]
    fn what_the_prints_do_not_tell_is_said() {
        let family = family(&[0.25, 0.5, 1.0, 2.0, 4.0]);
        // small prints alone: a power of the force, in which stiffness and skin are one
        let few: Vec<Print> = prints([1.0, 1.0], 0.05, false, 3).into_iter().take(4).collect();
        let found = fitted(&family, &few, &Free::ALL).unwrap();
        assert!(found.fitted.iter().any(|own| !own.is_told), "{:?}", found.fitted);
    }
}
