//! A matrix whose equations keep their numbers while they are eliminated in another order.

use super::sparse::{Factor, HELD, Pattern, Scatter, Stored, elimination_order};

/// A factor of equations that have other numbers than they are eliminated by: to move every value in every factorisation costs more than to
/// have it at its place.
pub struct Ordered {
    factor: Factor,
    /// Place of every equation in the elimination.
    place: Vec<usize>,
    x: Vec<f64>,
}

impl Ordered {
    /// Pattern of `n` equations coupled in groups, as [`Pattern::new`] with [`Stored::Lower`] but in an order of elimination, where each
    /// group's values go in it, and the factor. `None` when memory does not suffice.
    #[must_use]
    pub fn new<'a>(n: usize, groups: impl Iterator<Item = &'a [usize]> + Clone) -> Option<(Pattern, Scatter, Self)> {
        let (unordered, _) = Pattern::new(n, groups.clone(), Stored::Lower);
        let place = elimination_order(&unordered)?;
        let at = |d: &usize| if *d == HELD { HELD } else { place[*d] };
        let placed: Vec<Vec<usize>> = groups.map(|group| group.iter().map(at).collect()).collect();
        let (lower, scatter) = Pattern::new(n, placed.iter().map(Vec::as_slice), Stored::Lower);
        let factor = Factor::new(&lower)?;
        Some((lower, scatter, Self { factor, place, x: vec![0.0; n] }))
    }

    /// Place of every equation in the elimination.
    #[must_use]
    pub fn place(&self) -> &[usize] {
        &self.place
    }

    /// Factorises the matrix of the given values. False when it is not positive definite.
    pub fn factorise(&mut self, pattern: &Pattern, values: &[f64]) -> bool {
        self.factor.factorise(pattern, values)
    }

    /// Solves in place with the last factor.
    pub fn solve(&mut self, x: &mut [f64]) {
        for (value, place) in x.iter().zip(&self.place) {
            self.x[*place] = *value;
        }
        self.factor.solve(&mut self.x);
        for (value, place) in x.iter_mut().zip(&self.place) {
            *value = self.x[*place];
        }
    }
}
