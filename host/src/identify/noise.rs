//! How noisy the forces are, from the best source there is.

/// Where the noise level was taken from, best first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoiseSource {
    /// Differences between runs that repeat each other.
    Replicates,
    /// `noise_N` in the experiment.
    Stated,
    /// What the fit left over, systematic misfit included.
    Residual,
}

impl NoiseSource {
    /// How it is told to the user.
    pub fn sentence(self) -> &'static str {
        match self {
            NoiseSource::Replicates => "noise from the differences between replicates",
            NoiseSource::Stated => "noise as stated under [sensor]; there are no replicates",
            NoiseSource::Residual => {
                "no replicates and no stated noise: the rms of the residual stands for it, widened for the residual's autocorrelation"
            }
        }
    }
}

/// Noise of the forces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Source of the level.
    pub source: NoiseSource,
    /// Standard deviation of one sample, N.
    pub sigma_n: f64,
    /// Samples that carry the information of one: 1 for white noise.
    pub correlated_samples: f64,
}

/// One run's residual over depth below its contact point.
#[derive(Debug, Clone, PartialEq)]
pub struct Residual {
    /// Depth below contact, mm, rising.
    pub depth_mm: Vec<f64>,
    /// Measured minus modelled force, N.
    pub residual_n: Vec<f64>,
}

impl Residual {
    fn at(&self, depth_mm: f64) -> Option<f64> {
        let above = self.depth_mm.partition_point(|d| *d < depth_mm);
        if above == 0 || above == self.depth_mm.len() {
            return None;
        }
        let (a, b) = (self.depth_mm[above - 1], self.depth_mm[above]);
        let share = if b > a { (depth_mm - a) / (b - a) } else { 0.0 };
        Some(self.residual_n[above - 1] * (1.0 - share) + self.residual_n[above] * share)
    }
}

/// Estimates the noise. `groups` lists indices into `residuals` of runs that repeat each other.
pub fn estimate(residuals: &[Residual], groups: &[Vec<usize>], stated_n: Option<f64>) -> Noise {
    let deviations: Vec<Vec<f64>> = groups
        .iter()
        .filter(|group| group.len() > 1)
        .flat_map(|group| deviations(residuals, group))
        .filter(|series| series.len() > 4)
        .collect();
    if !deviations.is_empty() {
        return Noise {
            source: NoiseSource::Replicates,
            sigma_n: rms(&deviations),
            correlated_samples: correlated_samples(&deviations, independent(groups)),
        };
    }
    if let Some(sigma_n) = stated_n {
        return Noise { source: NoiseSource::Stated, sigma_n, correlated_samples: 1.0 };
    }
    let series: Vec<Vec<f64>> = residuals.iter().map(|r| r.residual_n.clone()).collect();
    Noise { source: NoiseSource::Residual, sigma_n: rms(&series), correlated_samples: correlated_samples(&series, 1.0) }
}

/// What each replicate differs from the mean of its group, scaled for the degree of freedom that
/// the mean costs. The model's misfit is common to all and drops out.
fn deviations(residuals: &[Residual], group: &[usize]) -> Vec<Vec<f64>> {
    let scale = (group.len() as f64 / (group.len() as f64 - 1.0)).sqrt();
    let mut series = vec![Vec::new(); group.len()];
    for &depth in &residuals[group[0]].depth_mm {
        let values: Option<Vec<f64>> = group.iter().map(|&at| residuals[at].at(depth)).collect();
        let Some(values) = values else { continue };
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        for (series, value) in series.iter_mut().zip(values) {
            series.push(scale * (value - mean));
        }
    }
    series
}

/// Share of deviations from their group's mean that are independent: one in each group follows from the others.
fn independent(groups: &[Vec<usize>]) -> f64 {
    let repeated = || groups.iter().filter(|group| group.len() > 1);
    let all: usize = repeated().map(Vec::len).sum();
    (all - repeated().count()) as f64 / all.max(1) as f64
}

/// Root mean square over all series.
pub fn rms(series: &[Vec<f64>]) -> f64 {
    let count: usize = series.iter().map(Vec::len).sum();
    let sum: f64 = series.iter().flatten().map(|value| value * value).sum();
    (sum / count.max(1) as f64).sqrt()
}

/// Least autocorrelation that counts.
const LEAST_RHO: f64 = 0.05;
/// One-sided 95 % of a normal distribution: of white noise, one series in twenty shows more.
const Z_ONE_SIDED: f64 = 1.645;

/// Integrated autocorrelation 1 + 2 sum rho_k, at most the length of the longest series: the number of neighbouring samples that count
/// as one.
///
/// Summed until rho falls below 0.05 or below what white noise of that length shows by chance, whose
/// standard error is `1/sqrt(n)` (Bartlett 1946, doi:10.2307/2983611): without the latter short runs of white noise would always seem
/// correlated, and every interval too wide.
///
/// `independent` is the share of the values that is: replicates minus their mean know of one another.
pub fn correlated_samples(series: &[Vec<f64>], independent: f64) -> f64 {
    let at_lag = |lag: usize| -> f64 {
        series.iter().map(|s| s.iter().zip(s.iter().skip(lag)).map(|(a, b)| a * b).sum::<f64>()).sum()
    };
    let longest = series.iter().map(Vec::len).max().unwrap_or(1);
    let variance = at_lag(0);
    if variance <= 0.0 {
        return 1.0;
    }
    let count: usize = series.iter().map(Vec::len).sum();
    let chance = Z_ONE_SIDED / (independent * count as f64).sqrt();
    let mut sum = 1.0;
    for lag in 1..longest {
        let rho = at_lag(lag) / variance;
        if rho < LEAST_RHO.max(chance) {
            break;
        }
        sum += 2.0 * rho;
    }
    sum.min(longest as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Fixed pseudo-random numbers, uniform with standard deviation 1.
    fn uniform(count: usize, seed: u64) -> Vec<f64> {
        let mut state = seed;
        let mut next = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            ((state >> 33) as f64 / (1_u64 << 31) as f64 - 0.5) * 12.0_f64.sqrt()
        };
        (0..count).map(|_| next()).collect()
    }

    #[test]
    fn white_noise_counts_every_sample_and_a_running_mean_does_not() {
        let white = uniform(4000, 1);
        let tau = correlated_samples(std::slice::from_ref(&white), 1.0);
        assert!((tau - 1.0).abs() < 0.15, "{tau}");
        // A running mean of 5 has rho = 0.8, 0.6, 0.4, 0.2: tau = 5.
        let smooth: Vec<f64> = white.windows(5).map(|w| w.iter().sum::<f64>() / 5.0).collect();
        let tau = correlated_samples(&[smooth], 1.0);
        assert!((tau - 5.0).abs() < 0.7, "{tau}");
    }

    #[test]
    fn short_white_noise_is_seldom_called_correlated() {
        let called = (0..400).filter(|seed| correlated_samples(&[uniform(160, 31 * seed + 7)], 1.0) > 1.0).count();
        // 5 % of 400, within three standard deviations of its own scatter.
        assert!((7..=33).contains(&called), "{called}");
    }

    #[test]
    fn replicates_see_the_noise_and_not_the_misfit() {
        let depth_mm: Vec<f64> = (0..400).map(|i| f64::from(i) * 0.01).collect();
        let run = |seed| Residual {
            residual_n: uniform(400, seed)
                .iter()
                .zip(&depth_mm)
                .map(|(noise, depth)| 0.01 * noise + depth.sin())
                .collect(),
            depth_mm: depth_mm.clone(),
        };
        let runs = [run(1), run(2), run(3)];
        let noise = estimate(&runs, &[vec![0, 1, 2]], Some(5.0));
        assert_eq!(noise.source, NoiseSource::Replicates);
        // 1200 values: the estimate scatters by 2 %.
        assert!((noise.sigma_n / 0.01 - 1.0).abs() < 0.08, "{noise:?}");
        assert_eq!(estimate(&runs, &[vec![0], vec![1]], Some(5.0)).sigma_n, 5.0);
        let blind = estimate(&runs, &[], None);
        assert!(blind.source == NoiseSource::Residual && blind.sigma_n > 0.5);
        assert!(blind.correlated_samples > 20.0, "{blind:?}");
    }
}
