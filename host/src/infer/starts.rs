//! Where searches begin: a space-filling design of a box, and the best of many searches.

use rayon::prelude::*;

use super::descent::{Descent, Objective, Region, Rule, minimise};

/// Points of a box that fill it evenly: Sobol's sequence with the direction numbers of Joe and Kuo 2008 (doi:10.1137/070709359), the corner 0 left out.
///
/// A larger design continues a smaller one. Past its table's ten dimensions a coordinate goes by multiples of a surd.
#[must_use]
pub fn filling(region: &Region, count: usize) -> Vec<Vec<f64>> {
    let axes: Vec<Vec<f64>> = (0..region.low.len()).map(|axis| along(axis, count)).collect();
    let place = |k: usize| -> Vec<f64> {
        axes.iter().enumerate().map(|(i, x)| region.low[i] + x[k] * (region.high[i] - region.low[i])).collect()
    };
    (0..count).map(place).collect()
}

/// Primitive polynomials and first direction numbers of every dimension but the first: degree, coefficients, numbers.
const SOBOL: [(u32, u32, &[u32]); 9] = [
    (1, 0, &[1]),
    (2, 1, &[1, 3]),
    (3, 1, &[1, 3, 1]),
    (3, 2, &[1, 1, 1]),
    (4, 1, &[1, 1, 3, 3]),
    (4, 4, &[1, 3, 5, 13]),
    (5, 2, &[1, 1, 5, 5, 17]),
    (5, 4, &[1, 1, 5, 5, 5]),
    (5, 7, &[1, 1, 7, 11, 19]),
];
const BITS: u32 = 32;

/// The first shares of a range, in (0, 1).
fn along(axis: usize, count: usize) -> Vec<f64> {
    let Some(directions) = directions(axis) else {
        let surd = (axis as f64 + 2.0).sqrt() * std::f64::consts::SQRT_2;
        return (1..=count).map(|k| (k as f64 * surd).fract()).collect();
    };
    let mut state = 0_u32;
    let mut next = |k: u32| {
        // Gray code: one digit changes at a time
        state ^= directions[k.trailing_ones() as usize % directions.len()];
        f64::from(state) / 2.0_f64.powi(32)
    };
    (0..u32::try_from(count).unwrap_or(u32::MAX)).map(&mut next).collect()
}

/// Direction numbers of a dimension; none past the table.
fn directions(axis: usize) -> Option<Vec<u32>> {
    let Some(row) = axis.checked_sub(1) else { return Some((0..BITS).map(|k| 1 << (BITS - 1 - k)).collect()) };
    let (degree, coefficients, first) = *SOBOL.get(row)?;
    let mut v: Vec<u32> = first.iter().zip(0..).map(|(m, k)| m << (BITS - 1 - k)).collect();
    let s = degree as usize;
    for k in s..BITS as usize {
        let mut new = v[k - s] ^ (v[k - s] >> degree);
        for i in 1..s {
            if coefficients >> (s - 1 - i) & 1 == 1 {
                new ^= v[k - i];
            }
        }
        v.push(new);
    }
    Some(v)
}

/// Ends of searches from many starts, the best first; equal ends in the order of their starts.
#[must_use]
pub fn descend_from<O: Objective + Sync>(
    objective: &O,
    region: &Region,
    starts: &[Vec<f64>],
    rule: &Rule,
) -> Vec<Descent<O::Kept>>
where
    O::Kept: Send,
{
    let mut ends: Vec<_> = starts.par_iter().map(|start| minimise(objective, region, start, rule)).collect();
    ends.sort_by(|a, b| a.value.total_cmp(&b.value));
    ends
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every half of every coordinate gets half of 2^k points, and every quarter of every pair of the first six a quarter, give or take the corner left out.
    #[test]
    fn every_half_of_the_box_gets_half_of_the_points() {
        let region = Region { low: vec![-1.0; 10], high: vec![3.0; 10], held: None };
        let points = filling(&region, 64);
        assert_eq!(points[..20], filling(&region, 20)[..]);
        let low = |p: &Vec<f64>, i: usize| p[i] < 1.0;
        for i in 0..10 {
            assert!(points.iter().filter(|p| low(p, i)).count().abs_diff(32) <= 1, "{i}");
            assert!(points.iter().all(|p| -1.0 < p[i] && p[i] < 3.0));
            for j in (0..i).filter(|_| i < 6) {
                let both = points.iter().filter(|p| low(p, i) && low(p, j)).count();
                assert!(both.abs_diff(16) <= 1, "{i} {j} {both}");
            }
        }
    }

    /// More dimensions than the table has are filled as well.
    #[test]
    fn many_dimensions_are_filled() {
        let region = Region { low: vec![0.0; 14], high: vec![1.0; 14], held: None };
        let points = filling(&region, 64);
        // Multiples of a surd: a half of 64 within a sixth.
        (10..14).for_each(|i| assert!(points.iter().filter(|p| p[i] < 0.5).count().abs_diff(32) <= 5));
    }
}
