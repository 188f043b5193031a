//! From the evidence of sets of effects to the probability of each effect.

/// A model: which effects it has, and how well it explains the data.
#[derive(Debug, Clone, PartialEq)]
pub struct Set {
    /// Its effects, by number.
    pub members: Vec<usize>,
    /// Logarithm of its evidence times its prior odds.
    pub log: f64,
}

/// What is believed of all sets.
#[derive(Debug, Clone, PartialEq)]
pub struct Beliefs {
    /// Probability of each set.
    pub sets: Vec<f64>,
    /// Probability of each effect: the sum over sets that hold it.
    pub members: Vec<f64>,
}

impl Beliefs {
    /// Of sets whose members are numbered below `count`. Sets that are no number have no part.
    #[must_use]
    pub fn of(sets: &[Set], count: usize) -> Self {
        let largest = sets.iter().map(|set| set.log).filter(|log| log.is_finite()).fold(f64::NEG_INFINITY, f64::max);
        let weights: Vec<f64> =
            sets.iter().map(|set| if set.log.is_finite() { (set.log - largest).exp() } else { 0.0 }).collect();
        let whole: f64 = weights.iter().sum::<f64>().max(f64::MIN_POSITIVE);
        let of_sets: Vec<f64> = weights.iter().map(|weight| weight / whole).collect();
        let mut members = vec![0.0; count];
        for (set, probability) in sets.iter().zip(&of_sets) {
            for &member in set.members.iter().filter(|member| **member < count) {
                members[member] += probability;
            }
        }
        Self { sets: of_sets, members }
    }

    /// Probability that at least one of some effects is there.
    #[must_use]
    pub fn any(&self, sets: &[Set], of: &[usize]) -> f64 {
        let holds = |set: &Set| set.members.iter().any(|member| of.contains(member));
        sets.iter().zip(&self.sets).filter(|(set, _)| holds(set)).map(|(_, p)| p).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probabilities_add_up_over_sets() {
        let set = |members: &[usize], odds: f64| Set { members: members.to_vec(), log: odds.ln() - 700.0 };
        let mut sets = vec![set(&[], 1.0), set(&[0], 2.0), set(&[1], 3.0), set(&[0, 1], 4.0)];
        sets.push(Set { members: vec![2], log: f64::NAN });
        let beliefs = Beliefs::of(&sets, 3);
        assert!((beliefs.members[0] - 0.6).abs() < 1e-12 && (beliefs.members[1] - 0.7).abs() < 1e-12);
        assert_eq!(beliefs.members[2], 0.0);
        assert!((beliefs.any(&sets, &[0, 1]) - 0.9).abs() < 1e-12);
    }
}
