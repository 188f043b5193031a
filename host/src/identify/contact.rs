//! Where the ball or the faces first touch, guessed from the data; the fit refines it.

use crate::experiment::motion::noise_of;

/// A contact point to start from and the range it is searched in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactGuess {
    /// Depth reading at contact, mm.
    pub contact_mm: f64,
    /// Lowest reading considered.
    pub low_mm: f64,
    /// Highest reading considered.
    pub high_mm: f64,
}

/// Force must rise this many times its noise to be a contact.
const VISIBLE_SIGMA: f64 = 6.0;

/// Guesses the contact point of a loading branch, or `None` if force never rises above its noise.
///
/// Near contact force goes like depth^1.5 whatever the material (Hertz, thesis Eq. 50), so
/// force^(2/3) over depth is straight and its zero is the guess. The search range around it is a
/// fifth of the ball's radius or a tenth of the stroke to either side, whichever is more: the guess
/// is poor where the start is not Hertzian, and recordings that begin at a trigger force begin
/// after contact.
pub fn guess(depth_mm: &[f64], force_n: &[f64], ball_mm: f64) -> Option<ContactGuess> {
    if depth_mm.len() < 4 {
        return None;
    }
    let lowest = force_n.iter().copied().fold(f64::INFINITY, f64::min);
    let highest = force_n.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let noise = noise_of(force_n);
    if highest - lowest.max(0.0) <= VISIBLE_SIGMA * noise || highest <= 0.0 {
        return None;
    }
    let first = depth_mm[0];
    let stroke = depth_mm[depth_mm.len() - 1] - first;
    let (from, to) = ((0.04 * highest).max(3.0 * noise), 0.4 * highest);
    let points: Vec<(f64, f64)> = depth_mm
        .iter()
        .zip(force_n)
        .filter(|(_, force)| (from..=to).contains(*force))
        .map(|(depth, force)| (*depth, force.powf(2.0 / 3.0)))
        .collect();
    let contact_mm = zero_of_line(&points).unwrap_or(first);
    let reach = (0.2 * ball_mm).max(0.1 * stroke);
    // The middle of the rise is certainly past contact, and so is anything a ball's radius above.
    let half = depth_mm
        .iter()
        .zip(force_n)
        .find(|(_, force)| **force > 0.5 * highest)
        .map_or(first + stroke, |(depth, _)| *depth);
    let contact_mm = contact_mm.clamp(first - ball_mm, half);
    Some(ContactGuess { contact_mm, low_mm: contact_mm - reach, high_mm: (contact_mm + reach).min(half) })
}

/// Guesses where two faces begin to press on a specimen or jaws to pull it, or `None` if force never rises above its noise.
///
/// That is the last depth before the force rises through a twelfth of its largest at which it was no more than noise, or a
/// five-hundredth of the largest. The search range is a few percent of the specimen's height to either side, a tenth where noise hides the
/// beginning: a contact point that could move farther would stand in for a law that does not fit.
pub fn guess_of_faces(depth_mm: &[f64], force_n: &[f64], height_mm: f64) -> Option<ContactGuess> {
    let lowest = force_n.iter().copied().fold(f64::INFINITY, f64::min);
    let highest = force_n.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let noise = noise_of(force_n);
    if depth_mm.len() < 4 || highest - lowest.max(0.0) <= VISIBLE_SIGMA * noise || highest <= 0.0 {
        return None;
    }
    let (nothing, something) = ((0.002 * highest).max(2.0 * noise), (0.08 * highest).max(VISIBLE_SIGMA * noise));
    let rise = force_n.iter().position(|force| *force > something)?;
    let touch = force_n[..rise].iter().rposition(|force| *force <= nothing).unwrap_or(0);
    let contact_mm = depth_mm[touch].min(depth_mm[rise]);
    // What noise hides may have begun earlier.
    let before = height_mm * if nothing > 0.005 * highest { 0.1 } else { 0.03 };
    let after = before.max(depth_mm[rise] - contact_mm).min(0.1 * height_mm);
    Some(ContactGuess { contact_mm, low_mm: contact_mm - before, high_mm: contact_mm + after })
}

/// Where the least-squares line through the points crosses zero.
fn zero_of_line(points: &[(f64, f64)]) -> Option<f64> {
    let count = points.len() as f64;
    let (mx, my) = points.iter().fold((0.0, 0.0), |(x, y), p| (x + p.0 / count, y + p.1 / count));
    let sxx: f64 = points.iter().map(|p| (p.0 - mx).powi(2)).sum();
    let sxy: f64 = points.iter().map(|p| (p.0 - mx) * (p.1 - my)).sum();
    let slope = sxy / sxx;
    (points.len() >= 3 && slope.is_finite() && slope > 0.0).then(|| mx - my / slope)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;

    #[test]
    fn a_hertzian_start_is_found_exactly_and_air_is_no_contact() {
        let depth: Vec<f64> = (0..200).map(|i| i as f64 * 0.02).collect();
        let force: Vec<f64> = depth.iter().map(|d| (d - 0.7_f64).max(0.0).powf(1.5)).collect();
        let guess = guess(&depth, &force, 4.0).unwrap();
        assert!((guess.contact_mm - 0.7).abs() < 1e-9, "{guess:?}");
        assert!(guess.low_mm < 0.4 && guess.high_mm > 1.0);

        // A foam's plateau must not hide where the faces met, to a sample's distance.
        let plateau: Vec<f64> = depth.iter().map(|d| 5.0 * (1.0 - (-4.0 * (d - 0.7).max(0.0)).exp())).collect();
        let guess = guess_of_faces(&depth, &plateau, 10.0).unwrap();
        assert!((guess.contact_mm - 0.7).abs() < 0.02, "{guess:?}");
        assert!((guess.high_mm - guess.low_mm - 0.6).abs() < 1e-12, "{guess:?}");

        let noise: Vec<f64> = (0..200).map(|i| f64::from(i * 37 % 11) * 1e-3).collect();
        assert_eq!(super::guess(&depth, &noise, 4.0), None);
        assert_eq!(guess_of_faces(&depth, &noise, 4.0), None);
    }
}
