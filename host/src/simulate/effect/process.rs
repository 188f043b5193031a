//! Rests as smooth random processes.
//!
//! A rest is a Gaussian process of mean 0 and variance 1 over one variable of the experiment, or
//! over two of them, times a share of the force. It is drawn by random Fourier features (Rahimi and
//! Recht 2007): waves whose frequencies are those of the kernel's spectrum, with normal weights, so
//! that at given frequencies it is Gaussian however few the waves are.

use rand::Rng;
use rand_distr::StandardNormal;

use super::Effect;
use super::range::Range;
use super::rest::{Along, Rest, ShareOf};
use crate::simulate::chance::{Purpose, stream};
use crate::simulate::spec::Spec;

/// Waves of a process: enough for a covariance within a tenth at every distance.
const WAVES: usize = 64;
/// Part of the largest depth within which a share of the peak grows in, and part of the way back
/// within which one of it does.
const GROWN: f64 = 0.15;

/// One function that was drawn.
#[derive(Debug, Clone)]
struct Process(Vec<Wave>);

#[derive(Debug, Clone, Copy)]
struct Wave {
    along: f64,
    by: f64,
    cosine: f64,
    sine: f64,
}

impl Process {
    /// Of a seed, and of a spot where each has its own (0 else).
    fn drawn(rest: &Rest, seed: u64, spot: u64) -> Self {
        let mut chance = stream(seed, Purpose::Rest, (u64::from(rest.draw) << 32) | spot);
        let size = (1.0 / WAVES as f64).sqrt();
        let wave = |_| {
            let along = rest.kernel.frequency(&mut chance) / rest.length;
            let by = rest.kernel.frequency(&mut chance) / rest.length;
            let (cosine, sine): (f64, f64) = (chance.sample(StandardNormal), chance.sample(StandardNormal));
            Wave { along, by, cosine: size * cosine, sine: size * sine }
        };
        Self((0..WAVES).map(wave).collect())
    }

    fn at(&self, along: f64, by: f64) -> f64 {
        let one = |wave: &Wave| {
            let (sine, cosine) = (wave.along * along + wave.by * by).sin_cos();
            wave.cosine * cosine + wave.sine * sine
        };
        self.0.iter().map(one).sum()
    }
}

/// Ranges of the variables within an experiment.
#[derive(Debug, Clone)]
pub(crate) struct Span {
    deepest_mm: f64,
    contact_mm: f64,
    longest_s: f64,
    step_s: f64,
    rate_mm_s: Range,
    radius_mm: Range,
    height_mm: Range,
    cycles: usize,
    runs: usize,
}

impl Span {
    /// Of a specification whose presses go to these depths (mm) under balls of these radii (mm),
    /// last so long (s), and are so many runs.
    pub fn of(spec: &Spec, presses: &[(f64, f64, f64)], runs: usize) -> Self {
        let most = |values: &mut dyn Iterator<Item = f64>| values.fold(f64::MIN_POSITIVE, f64::max);
        Self {
            deepest_mm: most(&mut presses.iter().map(|p| p.0)),
            contact_mm: most(&mut presses.iter().map(|p| (p.0 * p.1).max(0.0).sqrt())),
            longest_s: most(&mut presses.iter().map(|p| p.2)),
            step_s: 1.0 / spec.sample_hz,
            rate_mm_s: Range::of(spec.runs.iter().filter(|run| run.indenter.is_some()).map(|run| run.rate_mm_s)),
            radius_mm: Range::of(spec.indenters.iter().map(|one| one.radius_mm)),
            height_mm: Range::of(spec.specimens.iter().map(|one| one.height_mm)),
            cycles: spec.runs.iter().map(|run| run.cycles).max().unwrap_or(1),
            runs,
        }
    }
}

/// What stays as it is in a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Press {
    pub rate_mm_s: f64,
    pub radius_mm: f64,
    pub height_mm: f64,
    /// From 1.
    pub cycle: usize,
    /// From 1.
    pub order: usize,
    /// One number a spot of the experiment.
    pub spot: u64,
    /// Largest recorded depth, mm.
    pub depth_mm: f64,
    /// Largest force, N.
    pub peak_n: f64,
}

/// A moment of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Instant {
    pub time_s: f64,
    pub depth_mm: f64,
    /// The recorded depth is on its way back.
    pub back: bool,
    pub force_n: f64,
}

/// The rests of a run.
pub(crate) struct Rests<'a> {
    span: &'a Span,
    press: Press,
    each: Vec<(Rest, Process)>,
}

impl<'a> Rests<'a> {
    pub fn of(effects: &[Effect], seed: u64, span: &'a Span, press: Press) -> Self {
        let one = |effect: &Effect| match effect {
            Effect::Rest(rest) if rest.amplitude != 0.0 => {
                let apart = rest.along == Along::Spot || rest.by == Some(Along::Spot);
                Some((*rest, Process::drawn(rest, seed, if apart { press.spot } else { 0 })))
            }
            _ => None,
        };
        Self { span, press, each: effects.iter().filter_map(one).collect() }
    }

    /// What they add to a reading, N.
    pub fn added_n(&self, at: &Instant) -> f64 {
        let one = |(rest, process): &(Rest, Process)| {
            let by = rest.by.map_or(0.0, |by| self.part(by, at));
            let back = rest.along == Along::Back || rest.by == Some(Along::Back);
            let grown = if back { grown(self.part(Along::Back, at)) } else { 1.0 };
            let of = match rest.of {
                ShareOf::Force => at.force_n,
                ShareOf::Peak => self.press.peak_n * self::grown(at.depth_mm / self.press.depth_mm),
            };
            rest.amplitude * grown * of * process.at(self.part(rest.along, at), by)
        };
        self.each.iter().map(one).sum()
    }

    /// A variable as a part of its range.
    fn part(&self, along: Along, at: &Instant) -> f64 {
        let (span, press) = (self.span, &self.press);
        let nth = |at: usize, of: usize| at.saturating_sub(1) as f64 / of.saturating_sub(1).max(1) as f64;
        let depth_mm = at.depth_mm.max(0.0);
        match along {
            Along::Depth => depth_mm / span.deepest_mm,
            Along::Contact => (depth_mm * press.radius_mm).sqrt() / span.contact_mm,
            Along::Time => (at.time_s / span.step_s).ln_1p() / (span.longest_s / span.step_s).ln_1p(),
            Along::Back if at.back => (1.0 - at.depth_mm / press.depth_mm).clamp(0.0, 1.0),
            Along::Back | Along::Spot => 0.0,
            Along::Rate => span.rate_mm_s.part(press.rate_mm_s),
            Along::Ball => span.radius_mm.part(press.radius_mm),
            Along::Height => span.height_mm.part(press.height_mm),
            Along::Cycle => nth(press.cycle, span.cycles),
            Along::Order => nth(press.order, span.runs),
        }
    }
}

/// From 0 at 0 to 1 at [`GROWN`], smoothly.
fn grown(part: f64) -> f64 {
    let x = (part / GROWN).clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::effect::Kernel;

    fn rest(kernel: Kernel, length: f64) -> Rest {
        Rest { along: Along::Depth, by: None, kernel, length, amplitude: 0.01, of: ShareOf::Force, draw: 0 }
    }

    /// Of 4,000 draws a mean square scatters by 0.022 and a mean product of two correlated values
    /// by 0.02: four of these are allowed.
    #[test]
    fn a_process_has_unit_variance_and_the_correlation_of_its_kernel() {
        let (root3, root5) = (3.0_f64.sqrt(), 5.0_f64.sqrt());
        let at_length = [
            (Kernel::SquaredExponential, (-0.5_f64).exp()),
            (Kernel::Matern32, (1.0 + root3) * (-root3).exp()),
            (Kernel::Matern52, (1.0 + root5 + 5.0 / 3.0) * (-root5).exp()),
        ];
        for (kernel, expected) in at_length {
            for length in [0.15, 0.6] {
                let (mut square, mut product, mut mean) = (0.0, 0.0, 0.0);
                for seed in 0..4000 {
                    let process = Process::drawn(&rest(kernel, length), seed, 0);
                    let (here, there) = (process.at(0.2, 0.0), process.at(0.2 + length, 0.0));
                    mean += here / 4000.0;
                    square += here * here / 4000.0;
                    product += here * there / 4000.0;
                }
                assert!(mean.abs() < 0.064 && (square - 1.0).abs() < 0.09, "{kernel:?} {length}: {mean} {square}");
                assert!((product - expected).abs() < 0.08, "{kernel:?} {length}: {product} {expected}");
            }
        }
    }

    fn span() -> Span {
        let mut spec = Spec::new("rests", 1).foam("thin", 0.1, 8.0, 10.0).foam("thick", 0.1, 8.0, 20.0);
        spec = spec.ball("r4", 4.0).ball("r9", 9.0);
        Span::of(&spec, &[(3.0, 4.0, 5.0), (3.0, 9.0, 5.0)], 4)
    }

    const PRESS: Press = Press {
        rate_mm_s: 2.0,
        radius_mm: 9.0,
        height_mm: 20.0,
        cycle: 1,
        order: 4,
        spot: 7,
        depth_mm: 3.0,
        peak_n: 4.0,
    };
    const DOWN: Instant = Instant { time_s: 1.0, depth_mm: 1.5, back: false, force_n: 2.0 };

    #[test]
    fn variables_are_parts_of_their_ranges() {
        let span = span();
        let rests = Rests::of(&[], 1, &span, PRESS);
        let at = |along| rests.part(along, &DOWN);
        assert_eq!((at(Along::Depth), at(Along::Ball), at(Along::Height), at(Along::Order)), (0.5, 1.0, 1.0, 1.0));
        assert!((at(Along::Contact) - 0.5_f64.sqrt()).abs() < 1e-12 && at(Along::Back) == 0.0);
        let back = Instant { back: true, depth_mm: 0.6, ..DOWN };
        assert!((rests.part(Along::Back, &back) - 0.8).abs() < 1e-12);
        let last = Instant { time_s: 5.0, ..DOWN };
        assert!((rests.part(Along::Time, &last) - 1.0).abs() < 1e-12 && at(Along::Time) > 0.5);
    }

    /// A share of the force goes with it, one of the peak goes to nothing at the surface, one of
    /// the way back begins at its turn.
    #[test]
    fn no_rest_shows_without_contact() {
        let span = span();
        let added = |rest: Rest, at: Instant| Rests::of(&[Effect::Rest(rest)], 1, &span, PRESS).added_n(&at);
        let plain = rest(Kernel::Matern52, 0.3);
        let twice = Instant { force_n: 4.0, ..DOWN };
        assert_eq!(2.0 * added(plain, DOWN), added(plain, twice));
        let touch = Instant { depth_mm: 0.0, force_n: 0.0, ..DOWN };
        let peak = Rest { of: ShareOf::Peak, ..plain };
        assert!(added(plain, DOWN) != 0.0 && added(peak, DOWN) == 2.0 * added(plain, DOWN));
        assert_eq!((added(plain, touch), added(peak, touch)), (0.0, 0.0));
        let back = Rest { along: Along::Back, ..plain };
        assert_eq!(added(back, DOWN), 0.0);
        assert_ne!(added(back, Instant { back: true, ..DOWN }), 0.0);
        assert_eq!(added(Rest { amplitude: 0.0, ..plain }, DOWN), 0.0);
    }

    /// Draws differ, and spots only where a rest goes with the spot.
    #[test]
    fn each_draw_is_another_function() {
        let span = span();
        let on =
            |rest: Rest, spot: u64| Rests::of(&[Effect::Rest(rest)], 1, &span, Press { spot, ..PRESS }).added_n(&DOWN);
        let plain = rest(Kernel::SquaredExponential, 0.3);
        assert_ne!(on(plain, 7), on(Rest { draw: 1, ..plain }, 7));
        assert_eq!(on(plain, 7), on(plain, 8));
        let apart = Rest { by: Some(Along::Spot), ..plain };
        assert_ne!(on(apart, 7), on(apart, 8));
    }
}
