//! Eq. 17 over all values of the factor axis at once: two additions a row and sample instead of one for every value.
//!
//! The columns of one row are multiples of its shape f. Against a measured force F those with `mu_j f < F` miss by `F - mu_j f`, the others by
//! `mu_j f - F`. So all that a sample's differences depend on is the bracket `mu_(k-1) f < F <= mu_k f` it falls into, and the sums of `F - mu_(k-1) f` and of
//! `mu_k f - F` over the samples of a bracket (their total is the gap times the sum of f) give the sums of every column: from one column to the next the samples
//! below add the gap times their f. That is Eq. 17, not an approximation of it; all terms are positive, so nothing cancels.

use super::MAX_FACTORS;

/// Sums over the samples of one bracket, N: of measured force minus that of the lower column, and of that of the upper column minus the measured one.
pub(super) type Bracket = [f32; 2];

/// The factor axis, divided.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Levels {
    /// Ends of the brackets: zero, the values of the axis, twice the last one. Samples beyond the axis are measured from these as well; only the part that is theirs
    /// by right is asked for.
    ends: [f32; MAX_FACTORS + 2],
    /// Width of every bracket, and its reciprocal.
    gaps: [[f32; 2]; MAX_FACTORS + 1],
    /// Values of the axis.
    count: usize,
}

impl Levels {
    /// For a factor axis of rising values above zero; `None` if it is too long.
    pub(super) fn new(factors: impl ExactSizeIterator<Item = f32>) -> Option<Levels> {
        let mut levels =
            Levels { ends: [0.0; MAX_FACTORS + 2], gaps: [[0.0; 2]; MAX_FACTORS + 1], count: factors.len() };
        if levels.count > MAX_FACTORS {
            return None;
        }
        let mut low = 0.0;
        for ((end, gap), factor) in levels.ends.iter_mut().skip(1).zip(&mut levels.gaps).zip(factors) {
            *end = factor;
            *gap = [factor - low, 1.0 / (factor - low)];
            low = factor;
        }
        *levels.ends.get_mut(levels.count + 1)? = 2.0 * low;
        *levels.gaps.get_mut(levels.count)? = [low, 1.0 / low];
        Some(levels)
    }

    /// Brackets of a row.
    pub(super) const fn brackets(&self) -> usize {
        self.count + 1
    }

    /// Adds one sample to every row. `at` holds the bracket of each row's last sample: the next one mostly falls into the same.
    #[inline]
    pub(super) fn add(&self, rows: &mut [Bracket], at: &mut [u8], forces: impl Iterator<Item = f32>, force_n: f32) {
        for ((row, at), f) in rows.chunks_exact_mut(self.count + 1).zip(at).zip(forces) {
            let [mut low_n, mut high_n] = self.forces_n(*at, f);
            if (low_n >= force_n) | (high_n < force_n) {
                *at = self.find(*at, f, force_n);
                [low_n, high_n] = self.forces_n(*at, f);
            }
            if let Some([above, below]) = row.get_mut(usize::from(*at)) {
                *above += force_n - low_n;
                *below += high_n - force_n;
            }
        }
    }

    /// Forces at the ends of bracket `k` for shape `f`.
    #[inline]
    fn forces_n(&self, k: u8, f: f32) -> [f32; 2] {
        let end = |i: usize| self.ends.get(i).copied().unwrap_or(0.0) * f;
        [end(usize::from(k)), end(usize::from(k) + 1)]
    }

    /// The bracket of a force for shape `f`, sought from bracket `k`.
    fn find(&self, k: u8, f: f32, force_n: f32) -> u8 {
        let mut k = usize::from(k);
        while k < self.count && self.ends.get(k + 1).is_some_and(|end| end * f < force_n) {
            k += 1;
        }
        while k > 0 && self.ends.get(k).is_some_and(|end| end * f >= force_n) {
            k -= 1;
        }
        k as u8
    }

    /// Sums of Eq. 17 of one row, one for each value of the factor axis.
    #[inline]
    pub(super) fn sums<'a>(&self, row: &[Bracket], out: &'a mut [f32; MAX_FACTORS]) -> &'a [f32] {
        let (Some((_, upper)), Some(out)) = (row.split_first(), out.get_mut(..self.count)) else {
            return &[];
        };
        // Samples that the column exceeds, from the first column up.
        let (mut sum_n, mut shape) = (0.0, 0.0);
        for ((slot, [above, below]), [gap, per]) in out.iter_mut().zip(row).zip(&self.gaps) {
            sum_n += gap * shape + below;
            shape += (above + below) * per;
            *slot = sum_n;
        }
        // Samples that exceed the column, from the last column down; the first bracket holds none.
        let gaps = self.gaps.get(1..=self.count).unwrap_or(&[]);
        (sum_n, shape) = (0.0, 0.0);
        let down = out.iter_mut().rev().zip(upper.iter().rev()).zip(gaps.iter().rev());
        for ((slot, [above, below]), [gap, per]) in down {
            sum_n += gap * shape + above;
            shape += (above + below) * per;
            *slot += sum_n;
        }
        out
    }
}
