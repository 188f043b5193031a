//! What the board makes of a press, and what the thesis' way would have made of it.

use firmware::contact::Sample;
use firmware::palpation::{Motion, Palpation, PalpationConfig};
use firmware::search::{Search, Slice};
use protocol::lut::Table;
use protocol::message::{Outcome, Verdict};

use super::{Conditions, DEPTH_MM, Filtered};

/// Pieces of an analysis at most: coarse and fine lines, the record in pieces, offsets of the library.
const PIECES: usize = 2000;

/// Verdict of a press.
#[derive(Debug, Clone, PartialEq)]
pub struct Judged {
    /// What the board would send.
    pub verdict: Verdict,
    /// Place of the named material in the library; none if nothing was near enough.
    pub named: Option<usize>,
    /// The Kalman filter's estimate and what it recognises.
    pub filtered: Option<Filtered>,
}

/// Runs the board's palpation on the samples, one a tick, until the depth is reached and the verdict is ready.
pub fn judge(table: &Table<'_>, samples: &[Sample], rate_mm_s: f64) -> Judged {
    let config = PalpationConfig::default();
    let mut palpation = Palpation::new();
    palpation.start(rate_mm_s as f32);
    let mut ended = Outcome::NoContact;
    for sample in samples {
        if let Some(refused) = palpation.step(&config, table, *sample).refused() {
            ended = refused;
            break;
        }
        if palpation.has_contact() && palpation.depth_mm(sample.probe_mm) >= DEPTH_MM as f32 {
            ended = Outcome::Identified;
            break;
        }
    }
    for _ in 0..PIECES {
        if palpation.analyse(&config, table) {
            break;
        }
    }
    let motion = Motion { number: 1, rate_mm_s: rate_mm_s as f32, tick_max_us: 0, tick_mean_us: 0.0 };
    let verdict = palpation.verdict(&config, Some(table), ended, motion);
    let index = usize::from(verdict.material.index);
    let estimate = palpation.estimate(&config, motion.number);
    let filtered = estimate.and_then(|e| Filtered::of(table, e, rate_mm_s));
    Judged { named: (index < table.material_count()).then_some(index), verdict, filtered }
}

/// What the thesis' way finds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThesisWay {
    /// Modulus of the best of the 900 columns (MPa).
    pub mu_mpa: f64,
    /// Its exponent.
    pub alpha: f64,
    /// The nearest curve of the library, however far.
    pub nearest: usize,
}

/// Force above its zero at which the thesis' way takes the ball to touch, in standard deviations of the noise. The thesis prints no
/// threshold; below five, noise alone would be a contact once in some thousand approaches.
pub const THRESHOLD_SIGMAS: f64 = 5.0;

/// Samples from which the zero is taken: less than the shortest approach.
const ZERO_SAMPLES: usize = 30;

/// The thesis' way (sections 3.2.1 and 3.3): the first sample above a threshold is depth zero; the best of the 900 columns by Eq. 17, and
/// the nearest curve of the library by the same sum. `noise_n` is the noise of the force, N. None without contact.
pub fn by_threshold(table: &Table<'_>, samples: &[Sample], height_mm: f64, noise_n: f64) -> Option<ThesisWay> {
    let before = samples.get(..ZERO_SAMPLES)?;
    let zero_n = before.iter().map(|s| s.force_n).sum::<f32>() / ZERO_SAMPLES as f32;
    let threshold_n = (THRESHOLD_SIGMAS * noise_n) as f32;
    let touch = samples.iter().position(|s| s.force_n - zero_n > threshold_n)?;
    let top_mm = samples.get(touch)?.probe_mm;
    let slice = Slice::nearest(table, height_mm as f32, 0.0)?;
    let mut search = Search::new();
    let mut errors_n = vec![0.0_f32; table.material_count()];
    for s in samples.get(touch + 1..)? {
        let (depth_mm, force_n) = (top_mm - s.probe_mm, s.force_n - zero_n);
        search.step(table, &slice, depth_mm, force_n);
        if let Some(position) = table.locate(depth_mm) {
            for (error_n, material) in errors_n.iter_mut().zip(table.materials()) {
                *error_n += (force_n - material.force_n(position)).abs();
            }
        }
    }
    let (mu_mpa, alpha) = slice.parameters(table, search.found(&slice)?.index);
    let nearest = errors_n.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1))?.0;
    Some(ThesisWay { mu_mpa: f64::from(mu_mpa), alpha: f64::from(alpha), nearest })
}

impl Conditions {
    /// Noise of the force on a foam of a peak force, N.
    pub fn noise_n(&self, peak_n: f64) -> f64 {
        self.noise_n.hypot(self.noise_of_peak * peak_n)
    }
}
