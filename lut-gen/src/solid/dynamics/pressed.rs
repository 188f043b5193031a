//! What an explicit run gives.

use super::Inertia;

/// One moment of a run; energies in N mm.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Moment {
    /// Time (s).
    pub time_s: f64,
    /// Depth of the ball (mm).
    pub depth_mm: f64,
    /// Force on the ball (N).
    pub force_n: f64,
    /// Force of the block on its base (N); the difference to `force_n` is inertia and damping.
    pub base_force_n: f64,
    /// Strain energy; of a material that relaxes or softens, the work done on it.
    pub strain: f64,
    /// Energy of penalty and adhesion; with friction, the work done on the contact.
    pub contact: f64,
    /// Kinetic energy.
    pub kinetic: f64,
    /// Energy lost to damping so far.
    pub damping: f64,
    /// Work of the ball so far.
    pub external: f64,
}

impl Moment {
    /// Strain, contact, kinetic and damping energy less external work (N mm); 0 for exact time integration.
    #[must_use]
    pub fn imbalance(&self) -> f64 {
        self.strain + self.contact + self.kinetic + self.damping - self.external
    }
}

/// A finished run.
#[derive(Debug, Clone, PartialEq)]
pub struct Pressed {
    /// Moments in order, evenly in depth as far as the steps allow; the last at the largest depth.
    pub moments: Vec<Moment>,
    /// Steps taken.
    pub steps: usize,
    /// Smallest step (s).
    pub smallest_step_s: f64,
    /// Rate (mm/s).
    pub rate_mm_s: f64,
    /// Mass scaling.
    pub mass_scaling: f64,
}

impl Pressed {
    /// Force (N) at a depth (mm), linear between moments; 0 before the first, the last one's beyond it.
    #[must_use]
    pub fn force_at(&self, depth_mm: f64) -> f64 {
        let next = self.moments.partition_point(|m| m.depth_mm < depth_mm);
        match (next.checked_sub(1).map(|i| self.moments[i]), self.moments.get(next)) {
            (Some(a), Some(b)) => {
                let t = (depth_mm - a.depth_mm) / (b.depth_mm - a.depth_mm);
                a.force_n + t * (b.force_n - a.force_n)
            }
            (Some(last), None) => last.force_n,
            (None, _) => 0.0,
        }
    }

    /// Largest energy imbalance over the largest external work.
    #[must_use]
    pub fn balance_error(&self) -> f64 {
        let work = self.moments.iter().map(|m| m.external).fold(f64::MIN_POSITIVE, f64::max);
        self.moments.iter().map(|m| m.imbalance().abs() / work).fold(0.0, f64::max)
    }

    /// Whether this may be taken for quasi-static.
    #[must_use]
    pub fn inertia(&self) -> Inertia {
        Inertia::of(self)
    }
}
