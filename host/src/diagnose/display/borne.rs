//! What a finger bears: its pulp on the cap, and the fluid under it.

use super::design::Series;
use super::effect::{fluid_response, fluid_rest, fluid_viscosity, late, pulp_relaxation, pulp_size, yield_law};
use super::law::Law;
use crate::finger::round;

impl Law {
    /// Force of the pulp on the cap.
    pub(super) fn pulp_n(&self, series: &Series) -> Vec<f64> {
        let [stiffness, touch_mm] = [0, 1].map(|i| self.base[i]);
        let ratio = self.one(&pulp_size::EFFECT).unwrap_or(1.0);
        let force = |mm: &f64| stiffness * round::pulp_n((mm - touch_mm) / ratio);
        let mut force_n: Vec<f64> = series.input.iter().map(force).collect();
        if let Some(parts) = self.two(&pulp_relaxation::EFFECT) {
            force_n = pulp_relaxation::relaxing(&series.time_s, &force_n, parts);
        }
        force_n
    }

    /// Yield stress, kPa, at rest where the nominal law has another.
    #[must_use]
    pub fn yields_kpa(&self, nominal_kpa: f64) -> f64 {
        let rest_kpa = self.one(&fluid_rest::EFFECT).unwrap_or(0.0);
        let powered_kpa = yield_law::powered(nominal_kpa, self.one(&yield_law::POWER).unwrap_or(1.0));
        let bend_per_kpa = self.one(&yield_law::SATURATING).unwrap_or(0.0);
        self.base[0] * yield_law::saturating(powered_kpa, bend_per_kpa) + rest_kpa
    }

    /// Force of the fluid on a finger that goes down: what it bears at its yield stress.
    pub(super) fn fluid_n(&self, series: &Series) -> Vec<f64> {
        let [stiffness, size, touch_mm] = [1, 2, 3].map(|i| self.base[i]);
        // one of the same tissue and another size bears in proportion to its area: this is the stiffness of a stretched curve
        let modulus = stiffness / (size * size);
        let mut yield_kpa: Vec<f64> = series.yield_kpa.iter().map(|kpa| self.yields_kpa(*kpa)).collect();
        if let Some(tau_s) = self.one(&fluid_response::EFFECT) {
            yield_kpa = late::followed(&series.time_s, &yield_kpa, tau_s);
        }
        if let Some(viscous) = self.one(&fluid_viscosity::EFFECT) {
            let down = fluid_viscosity::down_mm_s(&series.time_s, &series.input);
            yield_kpa.iter_mut().zip(down).for_each(|(kpa, down)| *kpa += viscous * down);
        }
        // of stiffer tissue it bears as much as the round one on a fluid that is weaker
        let borne = |mm: f64, kpa: f64| stiffness * round::fluid_n(mm / size, kpa / modulus);
        let force = |(mm, kpa): (&f64, f64)| borne(mm - touch_mm, kpa);
        series.input.iter().zip(yield_kpa).map(force).collect()
    }
}
