//! One press of the ball, sample by sample.

use firmware::contact::Sample;
use palpate::plant::{Noise, Source};

use super::{DEPTH_MM, PressedFoam, SAMPLES_HZ};

/// Loss of modulus with the number of presses: `m(n) = m_fresh (1 - loss (1 - exp(-(n - 1) / presses)))`.
///
/// The thesis says that B1's modulus falls with the number of indentations (Fig. 31) and prints no figure. A foam of an elastomer
/// loses 36 to 41 % of its force within six cycles of 60 % strain when it is fresh (recordings `shoe_foam`); the
/// thesis' B1 had been pressed before, to 21 % of its height, and recovers between sessions. A quarter of the fresh loss is
/// taken, spread over ten presses. Softening multiplies the force whatever the rate: the thesis' experiment
/// cannot tell it from relaxation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Softening {
    /// Part of the fresh modulus that is lost in the end, in [0, 1).
    pub loss: f64,
    /// Presses after which 63 % of that are lost.
    pub presses: f64,
}

impl Softening {
    /// Presses of B1 in a session (thesis section 3.4).
    const SESSION: usize = 50;

    /// Modulus in the `number`-th press (from 1) over its mean of a session: the library's curve is an average (Fig. 30).
    pub fn factor(&self, number: usize) -> f64 {
        let left = |n: usize| 1.0 + self.loss * (-(n as f64 - 1.0) / self.presses).exp_m1();
        let mean = (1..=Self::SESSION).map(left).sum::<f64>() / Self::SESSION as f64;
        left(number.max(1)) / mean
    }
}

/// How presses differ, standard deviations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conditions {
    /// White noise of the force in a sample of the 50 Hz loop, N.
    ///
    /// 5 mN: 0.05 % of the 10 N cell's capacity, as strain-gauge cells with their amplifiers are specified. Recordings with such cells show
    /// 0.6 mN (500 N cell of a standing test machine at 10 Hz, `beef_ball`, residual of the holds) and 9 mN (rheometer at 244 Hz,
    /// `shoe_foam`, at rest); an arm in motion lies between.
    pub noise_n: f64,
    /// Further white noise, part of the force at full depth: 0, or 0.01 for the harsher noise of the demo.
    pub noise_of_peak: f64,
    /// Gain (mounting, spot on the foam), part of the force: 0.01, issue.
    pub gain: f64,
    /// Height of the surface, mm: 0.02, issue.
    pub contact_mm: f64,
    /// Zero of the load cell, N: 0.02, its weight not quite tared.
    pub zero_n: f64,
    /// Softening of B1.
    pub softening: Softening,
}

impl Default for Conditions {
    fn default() -> Self {
        Conditions {
            noise_n: 0.005,
            noise_of_peak: 0.0,
            gain: 0.01,
            contact_mm: 0.02,
            zero_n: 0.02,
            softening: Softening { loss: 0.1, presses: 10.0 },
        }
    }
}

/// Shortest approach before contact, mm, and the width of its range: the phase of sampling against contact is random.
const APPROACH_MM: (f64, f64) = (3.0, 1.0);

/// Overrun, mm: samples beyond the palpation's depth, because the surface may be believed too low.
const OVERRUN_MM: f64 = 0.75;

/// A press of known foam, in the order in which presses happen.
#[derive(Debug, Clone, PartialEq)]
pub struct Press {
    /// Which of the foams.
    pub foam: usize,
    /// How often this foam was pressed in the session, from 1.
    pub number: usize,
    /// Samples of the approach and of the indentation.
    pub samples: Vec<Sample>,
    /// True height of the surface, mm.
    pub surface_mm: f64,
}

/// A session of random order over the foams, foam `i` pressed `counts[i]` times, at rate number `rate`. The
/// same seed gives the same order, gains and surfaces at every rate, as the thesis repeats its sequence.
pub fn session(foams: &[PressedFoam], counts: &[usize], rate: usize, conditions: &Conditions, seed: u64) -> Vec<Press> {
    let mut order: Vec<usize> = counts.iter().enumerate().flat_map(|(i, n)| std::iter::repeat_n(i, *n)).collect();
    Noise::new(seed, Source::Choice).shuffle(&mut order);
    let mut gains = Noise::new(seed, Source::Gain);
    let mut surfaces = Noise::new(seed, Source::Surface);
    let mut zeros = Noise::new(seed, Source::Converter);
    let mut phases = Noise::new(seed, Source::Tremor);
    let mut forces = Noise::new(seed, Source::Force);
    let mut pressed = vec![0; foams.len()];
    let mut presses = Vec::with_capacity(order.len());
    for foam in order {
        pressed[foam] += 1;
        let (under, number) = (&foams[foam], pressed[foam]);
        let gain = 1.0 + conditions.gain * gains.normal();
        let surface_mm = under.height_mm + conditions.contact_mm * surfaces.normal();
        let zero_n = conditions.zero_n * zeros.normal();
        let start_mm = APPROACH_MM.0 + APPROACH_MM.1 * phases.below(1 << 20) as f64 / f64::from(1 << 20);
        let noise_n = conditions.noise_n.hypot(conditions.noise_of_peak * under.peak_n(rate));
        let step_mm = super::RATES_MM_S[rate] / SAMPLES_HZ;
        let count = ((start_mm + DEPTH_MM + OVERRUN_MM) / step_mm) as usize;
        let sample = |i: usize| {
            let depth_mm = step_mm * i as f64 - start_mm;
            let force_n = gain * under.force_n(rate, depth_mm, number, conditions.softening);
            let read_n = zero_n + force_n + noise_n * forces.normal();
            Sample { probe_mm: (surface_mm - depth_mm) as f32, force_n: read_n as f32 }
        };
        presses.push(Press { foam, number, samples: (0..count).map(sample).collect(), surface_mm });
    }
    presses
}
