//! A tour of the bench: specimens at their places are pressed in a random order, and told apart (thesis section 3.3).
//!
//! ```text
//! stops      specimens, their places and how often each is visited: a file
//! specimen   force of the ball on each, by finite elements at the rate of the tour
//! press      presses on a board, simulated or real
//! filter     what a Kalman filter makes of each press, by a bounding of choice
//! ```

mod filter;
mod press;
mod specimen;
mod stops;

use crate::plant::{Noise, Source};

pub use filter::{BOUNDINGS, Filtered, bounding, filtered, recognised};
pub use press::{Pressed, Surroundings, TourError, walk};
pub use specimen::Specimens;
pub use stops::{Law, Stop, Tour};

impl Tour {
    /// Stops by number in the order in which they are visited: every one as often as it says, shuffled from a seed.
    /// The same seed gives the same order at every rate, as in the thesis.
    #[must_use]
    pub fn order(&self, seed: u64) -> Vec<usize> {
        let visits = self.stops.iter().enumerate().flat_map(|(at, stop)| std::iter::repeat_n(at, stop.visits));
        let mut order: Vec<usize> = visits.collect();
        Noise::new(seed, Source::Choice).shuffle(&mut order);
        order
    }

    /// The same with about so many visits in all, in proportion: each stop's are rounded, to one at least.
    #[must_use]
    pub fn of_visits(mut self, total: usize) -> Self {
        let all: usize = self.stops.iter().map(|stop| stop.visits).sum();
        for stop in &mut self.stops {
            stop.visits = ((stop.visits * total) as f64 / all.max(1) as f64).round().max(1.0) as usize;
        }
        self
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn every_stop_is_visited_as_often_as_it_says() {
        let tour = Tour::thesis().unwrap();
        let order = tour.order(5);
        for (at, stop) in tour.stops.iter().enumerate() {
            assert_eq!(order.iter().filter(|visited| **visited == at).count(), stop.visits, "{}", stop.name);
        }
        assert!(order == tour.order(5) && order != tour.order(6));
        let few = tour.of_visits(18);
        assert!(few.stops.iter().all(|stop| stop.visits >= 1));
        assert!((few.order(1).len() as f64 - 18.0).abs() <= 3.0);
    }
}
