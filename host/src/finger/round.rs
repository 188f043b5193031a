//! The round finger of the control curves on a plate and on a fluid that yields: tables by finite elements of this program.

use std::sync::LazyLock;

use lut_gen::magnet::curve::Rising;
use lut_gen::magnet::fluid::{Fluid, Oil};

/// Force over compression on a rigid plate.
const PULP: &str = include_str!("../../plants/pulp.csv");
/// Largest force over travel on fluids of constant shear yield stress.
const FLUID: &str = include_str!("../../plants/fluid-force.csv");
/// Volume fraction of iron of MRF-122.
const IRON: f64 = 0.22;
/// Half of the step of a difference quotient, mm.
const HALF_MM: f64 = 0.05;

/// Force over a travel: a curve that rises, straight on beyond its last point.
struct Force {
    curve: Rising,
    x: Vec<f64>,
    last: (f64, f64),
    slope: f64,
}

/// Forces on a fluid of one shear yield stress.
struct OnFluid {
    kpa: f64,
    ln_kpa: f64,
    force: Force,
}

struct Tables {
    pulp: Force,
    /// Stresses rise.
    fluid: Vec<OnFluid>,
    yields: Fluid,
}

/// The tables are part of the program, and a test reads them: none is ever missing.
static TABLES: LazyLock<Option<Tables>> = LazyLock::new(|| {
    let mut fluid: Vec<(f64, Vec<(f64, f64)>)> = Vec::new();
    for row in rows(FLUID) {
        let &[kpa, mm, n] = row.as_slice() else { return None };
        match fluid.last_mut().filter(|(own, _)| *own == kpa) {
            Some((_, points)) => points.push((mm, n)),
            None => fluid.push((kpa, vec![(mm, n)])),
        }
    }
    let fluid =
        fluid.into_iter().map(|(kpa, points)| Some(OnFluid { kpa, ln_kpa: kpa.ln(), force: Force::of(points)? }));
    let pulp = rows(PULP).filter_map(|row| Some((*row.first()?, *row.get(1)?)));
    Some(Tables {
        pulp: Force::of(pulp.collect())?,
        fluid: fluid.collect::<Option<_>>()?,
        yields: Fluid::carlson(IRON, Oil::Hydrocarbon).ok()?,
    })
});

/// Numbers of the lines that hold nothing else.
fn rows(text: &str) -> impl Iterator<Item = Vec<f64>> {
    text.lines().filter_map(|line| line.split(',').map(|cell| cell.trim().parse().ok()).collect())
}

impl Force {
    fn of(mut points: Vec<(f64, f64)>) -> Option<Self> {
        points.insert(0, (0.0, 0.0));
        let &[.., before, last] = points.as_slice() else { return None };
        let (x, y): (Vec<f64>, Vec<f64>) = points.into_iter().unzip();
        let slope = (last.1 - before.1) / (last.0 - before.0);
        Some(Self { curve: Rising::new(x.clone(), y).ok()?, x, last, slope })
    }

    /// Straight lines between the points, less the curve: what a table leaves open between them.
    fn open(&self, mm: f64) -> f64 {
        let next = self.x.partition_point(|own| *own <= mm);
        let (Some(low), Some(high)) = (next.checked_sub(1).map(|at| self.x[at]), self.x.get(next)) else { return 0.0 };
        let part = (mm - low) / (high - low);
        (1.0 - part) * self.curve.at(low) + part * self.curve.at(*high) - self.curve.at(mm)
    }

    fn at(&self, mm: f64) -> f64 {
        self.curve.at(mm) + self.slope * (mm - self.last.0).max(0.0)
    }

    fn inverse(&self, n: f64) -> f64 {
        match self.curve.inverse(n.max(0.0)) {
            Some(mm) => mm,
            None => self.last.0 + (n - self.last.1) / self.slope,
        }
    }
}

/// Force on a plate at a compression (mm), N.
#[must_use]
pub fn pulp_n(mm: f64) -> f64 {
    TABLES.as_ref().map_or(0.0, |tables| tables.pulp.at(mm))
}

/// Compression on a plate at a force (N), mm.
#[must_use]
pub fn pulp_mm(n: f64) -> f64 {
    TABLES.as_ref().map_or(0.0, |tables| tables.pulp.inverse(n))
}

/// Largest force at a travel (mm) on a fluid of a shear yield stress (kPa), N: a power of the stress between two of the table's, in
/// proportion to it below them, and the plate's above them.
#[must_use]
pub fn fluid_n(mm: f64, kpa: f64) -> f64 {
    let Some(tables) = TABLES.as_ref() else { return 0.0 };
    if mm <= 0.0 || kpa <= 0.0 {
        return 0.0;
    }
    let next = tables.fluid.partition_point(|own| own.kpa < kpa);
    match (next.checked_sub(1).map(|at| &tables.fluid[at]), tables.fluid.get(next)) {
        (Some(low), Some(high)) => {
            let (below, above) = (low.force.at(mm), high.force.at(mm));
            let part = (kpa.ln() - low.ln_kpa) / (high.ln_kpa - low.ln_kpa);
            if below == 0.0 { 0.0 } else { below * (above / below).powf(part) }
        }
        (None, Some(first)) => first.force.at(mm) * kpa / first.kpa,
        (Some(last), None) => last.force.at(mm),
        (None, None) => 0.0,
    }
}

/// What the table leaves open between its travels, of the force of the nearest stress above, N.
#[must_use]
pub fn fluid_open_n(mm: f64, kpa: f64) -> f64 {
    let above =
        |tables: &Tables| tables.fluid.iter().find(|own| own.kpa >= kpa).map(|own| own.force.open(mm) * kpa / own.kpa);
    TABLES.as_ref().and_then(above).unwrap_or(0.0)
}

/// Shear yield stress of the fluid at a flux density (T), kPa.
#[must_use]
pub fn yield_kpa(flux_t: f64) -> f64 {
    TABLES.as_ref().map_or(0.0, |tables| tables.yields.yield_at_flux(flux_t.abs()))
}

/// Derivative of the force on a fluid over its shear yield stress (kPa), N/kPa.
#[must_use]
pub fn fluid_over_yield(mm: f64, kpa: f64) -> f64 {
    let half = 0.01 * kpa;
    if half > 0.0 { (fluid_n(mm, kpa + half) - fluid_n(mm, kpa - half)) / (2.0 * half) } else { 0.0 }
}

/// Derivative of the force on a plate over its compression, N/mm.
#[must_use]
pub fn pulp_slope(mm: f64) -> f64 {
    (pulp_n(mm + HALF_MM) - pulp_n(mm - HALF_MM)) / (2.0 * HALF_MM)
}

/// Derivative of the force on a fluid of a shear yield stress (kPa) over the travel, N/mm.
#[must_use]
pub fn fluid_slope(mm: f64, kpa: f64) -> f64 {
    (fluid_n(mm + HALF_MM, kpa) - fluid_n(mm - HALF_MM, kpa)) / (2.0 * HALF_MM)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tables_are_read_and_a_stiff_fluid_is_nearly_a_plate() {
        // two other solvers' finger: 0.361 N at 1 mm, 1.443 N at 2 mm
        assert!((pulp_n(1.0) - 0.361).abs() < 0.01 && (pulp_n(2.0) - 1.443).abs() < 0.03, "{}", pulp_n(2.0));
        for mm in [0.3, 1.1, 2.7, 5.0] {
            assert!((pulp_mm(pulp_n(mm)) - mm).abs() < 1e-9, "{mm}");
            let forces = [0.1, 0.5, 2.0, 8.0, 25.0, 100.0].map(|kpa| fluid_n(mm, kpa));
            assert!(forces.windows(2).all(|pair| pair[0] < pair[1]), "{forces:?}");
        }
        assert!((fluid_n(1.0, 25.6) / pulp_n(1.0) - 1.0).abs() < 0.05, "{}", fluid_n(1.0, 25.6));
        assert_eq!((pulp_n(-1.0), fluid_n(-1.0, 3.0), fluid_n(1.0, 0.0), yield_kpa(0.0)), (0.0, 0.0, 0.0, 0.0));
    }
}
