//! Is it quasi-static?

use std::fmt;

use super::Pressed;

/// Largest share of kinetic in strain energy, and of inertia in force, that passes for quasi-static: the usual 5 %
/// (Abaqus Analysis User's Guide, "Explicit dynamic analysis": kinetic energy a small fraction, 5 % to 10 %, of
/// internal energy through most of the process).
pub const LIMIT: f64 = 0.05;

/// Share of the largest depth that is left out: at first touch any moving block has more kinetic than strain energy.
const START: f64 = 0.2;

/// How far inertia acts on an explicit run, beyond the first fifth of the depth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inertia {
    /// Largest kinetic over strain energy.
    pub kinetic: f64,
    /// Root mean square of (force on the ball - force on the base), over that of the force on the ball.
    pub force: f64,
    /// Largest energy imbalance over the largest external work.
    pub balance: f64,
    /// From which depth these were taken (mm).
    pub from_mm: f64,
    /// Rate of the run (mm/s).
    pub rate_mm_s: f64,
    /// Mass scaling of the run.
    pub mass_scaling: f64,
}

impl Inertia {
    /// Judges a run.
    #[must_use]
    pub fn of(run: &Pressed) -> Self {
        let from_mm = START * run.moments.last().map_or(0.0, |m| m.depth_mm);
        let late = || run.moments.iter().filter(|m| m.depth_mm >= from_mm);
        let kinetic = late().map(|m| m.kinetic / m.strain.max(f64::MIN_POSITIVE)).fold(0.0, f64::max);
        let square = |x: f64| x * x;
        let missing: f64 = late().map(|m| square(m.force_n - m.base_force_n)).sum();
        let whole: f64 = late().map(|m| square(m.force_n)).sum();
        Self {
            kinetic,
            force: (missing / whole.max(f64::MIN_POSITIVE)).sqrt(),
            balance: run.balance_error(),
            from_mm,
            rate_mm_s: run.rate_mm_s,
            mass_scaling: run.mass_scaling,
        }
    }

    /// Both shares are below [`LIMIT`].
    #[must_use]
    pub fn quasi_static(&self) -> bool {
        self.kinetic <= LIMIT && self.force <= LIMIT
    }

    /// Factor on the rate that brings both shares to [`LIMIT`] or below, at most 1: kinetic energy goes with the
    /// square of the rate, waves with the rate itself.
    #[must_use]
    pub fn slower(&self) -> f64 {
        let part = |share: f64| if share > LIMIT { LIMIT / share } else { 1.0 };
        part(self.kinetic).sqrt().min(part(self.force))
    }
}

impl fmt::Display for Inertia {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}: beyond {:.3} mm kinetic energy reaches {:.2} % of strain energy, and {:.2} % of the force on the ball is \
             inertia or damping (limit {:.0} % each); energy is balanced to {:.2} %",
            if self.quasi_static() { "quasi-static" } else { "not quasi-static" },
            self.from_mm,
            100.0 * self.kinetic,
            100.0 * self.force,
            100.0 * LIMIT,
            100.0 * self.balance
        )?;
        if self.quasi_static() {
            return Ok(());
        }
        // the same product of rate and root of mass, reached by either
        let slower = self.slower();
        write!(
            f,
            "; press at {:.3} mm/s or slower, or scale the mass by {:.3} or less",
            self.rate_mm_s * slower,
            self.mass_scaling * slower * slower
        )
    }
}
