//! Where a fluid under a finger bears all that its yield stress lets it.

use crate::finger::round;

/// A finger goes down that is deeper than a time before by more than a place's noise, and that goes on within a tick: 0.15 mm/s.
const BEFORE_S: f64 = 0.0599;
const AFTER_S: f64 = 0.0199;
const DEEPER_MM: f64 = 0.005;
const ON_MM: f64 = 0.003;
/// Where it slows down within a tick by more than half and this, mm, nobody knows the speed that a viscous fluid answers to.
const SLOWER_MM: f64 = 0.02;
/// Part of a way through a pulp by which it is longer for another finger.
const OTHER: f64 = 0.5;

/// Where a fluid bears all that its yield stress lets it: a finger goes down, deeper than it has been, and, where the stress has
/// risen, has gone down until its pulp bears that as well. Else the pulp alone tells.
pub(super) fn is_borne(time_s: &[f64], place_mm: &[f64], yield_kpa: &[f64]) -> Vec<bool> {
    // one reading that is wrong is no depth
    let place_mm: Vec<f64> = (0..place_mm.len()).map(|k| middle(place_mm, k)).collect();
    let (mut deepest_mm, mut dent_mm) = (f64::NEG_INFINITY, 0.0_f64);
    // where the pulp began to bear less than the fluid, and from where it surely bears as much
    let (mut left_mm, mut from_mm) = (None, f64::NEG_INFINITY);
    let each = place_mm.iter().zip(yield_kpa).enumerate().map(|(k, (mm, kpa))| {
        let before = time_s.partition_point(|t| *t <= time_s[k] - BEFORE_S).checked_sub(1);
        let after = time_s.partition_point(|t| *t < time_s[k] + AFTER_S);
        let tick_before = time_s.partition_point(|t| *t <= time_s[k] - AFTER_S).saturating_sub(1);
        let on_mm = (0.5 * (mm - place_mm[tick_before]) - SLOWER_MM).max(ON_MM);
        let goes_down = before.is_some_and(|before| *mm > place_mm[before] + DEEPER_MM)
            && place_mm.get(after).is_some_and(|after_mm| *after_mm > mm + on_mm);
        let is_deeper = *mm > deepest_mm - DEEPER_MM;
        deepest_mm = deepest_mm.max(*mm);
        let most_n = round::fluid_n(*mm, *kpa);
        if round::pulp_n(mm - dent_mm) < most_n {
            left_mm.get_or_insert(*mm);
            return false;
        }
        dent_mm = dent_mm.max(mm - round::pulp_mm(most_n));
        if let Some(left) = left_mm.take() {
            from_mm = mm + OTHER * (mm - left);
        }
        goes_down && is_deeper && *mm >= from_mm
    });
    each.collect()
}

/// The middle one of a sample and its neighbours.
fn middle(values: &[f64], k: usize) -> f64 {
    let [a, b, c] = [k.saturating_sub(1), k, (k + 1).min(values.len() - 1)].map(|at| values[at]);
    a.min(b).max(a.max(b).min(c))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 10 and 1.5 mm/s down to 3 mm, then at rest: compared on the way, and not in the last sample of the fast one, whose speed is
    /// none of both.
    #[test]
    fn a_corner_is_compared_only_where_the_speed_does_not_matter() {
        for (mm_s, from_s, last) in [(10.0, 0.08, 14), (1.5, 0.4, 99)] {
            let time_s: Vec<f64> = (0..130).map(|k| 0.02 * f64::from(k)).collect();
            // the corner lies a little behind the last sample on the way
            let place_mm: Vec<f64> = time_s.iter().map(|t| (mm_s * t - 0.008 * mm_s / 10.0).min(3.0 - 1e-9)).collect();
            let compared = is_borne(&time_s, &place_mm, &[1.5; 130]);
            let on_the_way = time_s.iter().zip(&compared).filter(|(t, _)| **t > from_s && **t < 3.0 / mm_s - 0.03);
            assert!(on_the_way.clone().count() > 5 && on_the_way.clone().all(|(_, compared)| *compared), "{mm_s}");
            assert!(compared[last + 1..].iter().all(|compared| !compared), "{mm_s}: {compared:?}");
        }
    }
}
