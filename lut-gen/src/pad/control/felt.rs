//! What a finger feels, how far that is from what is wanted, and averages of a foam's stress.

use super::curve::along;
use crate::pad::body::section::Section;
use crate::pad::state::State;

/// What a finger feels: force and area at some travels.
#[derive(Debug, Clone, PartialEq)]
pub struct Felt {
    /// Travels (mm), rising.
    pub travel_mm: Vec<f64>,
    /// Force (N).
    pub force_n: Vec<f64>,
    /// Area of the contact as its print shows it, flat (mm2; in the plane its width, mm).
    pub area_mm2: Vec<f64>,
}

/// How far what is felt is from what is wanted: root mean square over that of what is wanted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Error {
    /// Of the force.
    pub force: f64,
    /// Of the area.
    pub area: f64,
}

/// Averages of Mises' stress over the nodes of the lower body (MPa).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Averages {
    /// Arithmetic mean.
    pub mean: f64,
    /// Median.
    pub median: f64,
    /// Geometric mean over the nodes that bear stress.
    pub geometric: f64,
}

impl Felt {
    /// Of the states of a press in the plane or of a ring.
    #[must_use]
    pub fn of(section: Section, states: &[State]) -> Self {
        let each = |value: fn(&State) -> f64| -> Vec<f64> { states.iter().map(value).collect() };
        let area_mm2 = states.iter().map(|s| section.print_mm2(s.half_width_mm)).collect();
        Self { travel_mm: each(|s| s.travel_mm), force_n: each(|s| s.force_n), area_mm2 }
    }

    /// How far it is from what is wanted at the same travels.
    #[must_use]
    pub fn error(&self, wanted: &Felt) -> Error {
        Error { force: part(&self.force_n, &wanted.force_n), area: part(&self.area_mm2, &wanted.area_mm2) }
    }

    /// Places at which the force is more than at the one before, from the first on.
    #[must_use]
    pub fn rising(&self) -> usize {
        let before = std::iter::once(&0.0).chain(&self.force_n);
        before.zip(&self.force_n).take_while(|(before, force)| before < force).count()
    }

    /// How far the area is from what is wanted *at the same force*: a finger feels force and area together, and no travel.
    /// Over the wanted forces that it reaches while its force rises; `None` where that is none.
    #[must_use]
    pub fn area_at_force(&self, wanted: &Felt) -> Option<f64> {
        let both = self.force_n.iter().copied().zip(self.area_mm2.iter().copied());
        let knots: Vec<(f64, f64)> = both.take(self.rising()).collect();
        let (most_n, _) = *knots.last()?;
        let reached = wanted.force_n.iter().zip(&wanted.area_mm2).filter(|(force_n, _)| **force_n <= most_n);
        let (own, wanted): (Vec<f64>, Vec<f64>) =
            reached.map(|(force_n, area)| (along(&knots, *force_n), *area)).unzip();
        (!wanted.is_empty()).then(|| part(&own, &wanted))
    }

    /// Differences to what is wanted, in parts of it; the area counts `area_weight` as much as the force.
    pub(super) fn left(&self, wanted: &Felt, area_weight: f64) -> Vec<f64> {
        let each = |own: &[f64], wanted: &[f64], weight: f64| -> Vec<f64> {
            let size = wanted.iter().map(|b| b * b).sum::<f64>().sqrt();
            own.iter().zip(wanted).map(|(a, b)| weight.sqrt() * (b - a) / size).collect()
        };
        let mut left = each(&self.force_n, &wanted.force_n, 1.0);
        left.extend(each(&self.area_mm2, &wanted.area_mm2, area_weight));
        left
    }
}

/// Root mean square of what differs over that of what is wanted.
fn part(own: &[f64], wanted: &[f64]) -> f64 {
    let square: f64 = own.iter().zip(wanted).map(|(a, b)| (a - b).powi(2)).sum();
    (square / wanted.iter().map(|b| b * b).sum::<f64>()).sqrt()
}

impl Error {
    /// Both together, alike.
    #[must_use]
    pub fn combined(&self) -> f64 {
        self.weighed(1.0)
    }

    /// Both together, the area with a weight beside the force's 1 (0: the force alone).
    #[must_use]
    pub fn weighed(&self, area_weight: f64) -> f64 {
        ((self.force * self.force + area_weight * self.area * self.area) / (1.0 + area_weight)).sqrt()
    }
}

impl Averages {
    /// Over the nodes of a state's lower body; `None` where that is rigid.
    #[must_use]
    pub fn of(state: &State) -> Option<Self> {
        let mut stresses: Vec<f64> = state.mises_mpa.get(state.lower..)?.to_vec();
        stresses.sort_by(f64::total_cmp);
        let count = stresses.len();
        let median = 0.5 * (stresses.get(count.checked_sub(1)? / 2)? + stresses.get(count / 2)?);
        let bearing: Vec<f64> = stresses.iter().copied().filter(|s| *s > 0.0).collect();
        let logarithm = bearing.iter().map(|s| s.ln()).sum::<f64>() / bearing.len().max(1) as f64;
        let geometric = if bearing.is_empty() { 0.0 } else { logarithm.exp() };
        Some(Self { mean: stresses.iter().sum::<f64>() / count as f64, median, geometric })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_is_a_part_of_what_is_wanted() {
        let felt = |f: f64| Felt { travel_mm: vec![1.0, 2.0], force_n: vec![f, 2.0 * f], area_mm2: vec![5.0, 8.0] };
        let error = felt(1.1).error(&felt(1.0));
        assert!((error.force - 0.1).abs() < 1e-12 && error.area == 0.0);
        assert!((error.combined() - 0.1 / 2_f64.sqrt()).abs() < 1e-12);
        assert_eq!(error.weighed(0.0), error.force);
    }

    #[test]
    fn an_area_at_the_same_force_does_not_ask_for_the_travel() {
        let felt = |travel_mm: &[f64], scale: f64| Felt {
            travel_mm: travel_mm.to_vec(),
            force_n: travel_mm.to_vec(),
            area_mm2: travel_mm.iter().map(|u| scale * u).collect(),
        };
        let wanted = felt(&[1.0, 2.0, 3.0], 5.0);
        assert!(felt(&[0.7, 2.2, 4.0], 5.0).area_at_force(&wanted).is_some_and(|off| off < 1e-12));
        assert!((felt(&[0.7, 2.2, 4.0], 6.0).area_at_force(&wanted).unwrap_or(0.0) - 0.2).abs() < 1e-12);
        // of two of three forces
        assert!((felt(&[1.0, 2.5], 4.0).area_at_force(&wanted).unwrap_or(0.0) - 0.2).abs() < 1e-12);
        // a force that falls is not followed
        let falls = Felt { force_n: vec![1.0, 0.5, 9.0], ..felt(&[1.0, 2.0, 3.0], 5.0) };
        assert_eq!(falls.area_at_force(&wanted), Some(0.0));
        assert_eq!(felt(&[0.5], 5.0).area_at_force(&wanted), None);
    }
}
