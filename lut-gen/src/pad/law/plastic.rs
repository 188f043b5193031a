//! A body whose yield stress follows a programme: what a magnetic fluid under a control curve is
//! taken for.

use super::gradient::{Gradient, IDENTITY, Principal, Stretched};
use crate::fem::operator::Response;
use crate::pad::error::{PadError, demand};

/// Perfect J2 plasticity at finite strain whose yield stress may change with time, on Hencky's
/// elasticity:
///
/// ```text
/// F = Fe Fp,   tau = 2 G dev(ln Ve) + K tr(ln Ve) 1,   |dev tau| sqrt(3/2) <= J sigma_y(t)
/// ```
///
/// The flow keeps the volume (exponential map; Weber and Anand 1990,
/// doi:10.1016/0045-7825(90)90131-5), the return is radial in logarithmic strains. `sigma_y` is a
/// Cauchy stress; its factor `J` is that of the last pass over the step, so that a pass minimises
/// `W(ln Ve) + J sigma_y dp` over the step's plastic strain `dp` and has a symmetric tangent;
/// passes are repeated until `J` stays.
///
/// A point remembers `Fp^-1 - 1` (5 numbers), the plastic strain, and `ln J`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plastic {
    shear_mpa: f64,
    bulk_mpa: f64,
}

/// Numbers that a point remembers.
pub(super) const STATES: usize = 7;
/// Where the plastic strain and `ln J` stand among them.
pub(crate) const PLASTIC_STRAIN: usize = 5;
pub(crate) const LOG_VOLUME: usize = 6;

impl Plastic {
    /// Of Young's modulus (MPa) and Poisson's ratio.
    ///
    /// # Errors
    /// [`PadError::Value`] when the modulus is not positive or the ratio is outside (-1, 0.5).
    pub fn new(young_mpa: f64, nu: f64) -> Result<Self, PadError> {
        demand(young_mpa > 0.0 && young_mpa.is_finite(), "Young's modulus (MPa)", young_mpa, "more than 0")?;
        demand(nu > -1.0 && nu < 0.5, "Poisson's ratio", nu, "a number between -1 and 0.5")?;
        Ok(Self { shear_mpa: young_mpa / (2.0 * (1.0 + nu)), bulk_mpa: young_mpa / (3.0 * (1.0 - 2.0 * nu)) })
    }

    /// Shear modulus (MPa).
    #[must_use]
    pub fn shear_mpa(&self) -> f64 {
        self.shear_mpa
    }

    /// Answer of the trial strain `ln`, with the plastic strain of the step; `limit` is `J sigma_y`
    /// (MPa).
    ///
    /// Beyond the limit `dev tau = sqrt(2/3) limit n` with `n` along the trial deviator `e`, so
    /// that `d dev tau / d ln = sqrt(2/3) limit / |e| (dev - n n)`.
    fn principal(&self, ln: [f64; 3], limit: f64) -> (Principal, f64) {
        let (g, k) = (self.shear_mpa, self.bulk_mpa);
        let volume = ln[0] + ln[1] + ln[2];
        let e = ln.map(|x| x - volume / 3.0);
        let size = (e[0] * e[0] + e[1] * e[1] + e[2] * e[2]).sqrt();
        let radius = (2.0_f64 / 3.0).sqrt() * limit;
        let flows = 2.0 * g * size > radius;
        // secant modulus of the deviator
        let secant = if flows { radius / size } else { 2.0 * g };
        let step = if flows { (2.0_f64 / 3.0).sqrt() * (size - radius / (2.0 * g)) } else { 0.0 };
        let elastic = if flows { radius / (2.0 * g) } else { size };
        let energy = 0.5 * k * volume * volume + g * elastic * elastic + if flows { limit * step } else { 0.0 };
        let along = if flows { secant / (size * size) } else { 0.0 };
        let slope = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let deviator = f64::from(u8::from(i == j)) - 1.0 / 3.0;
                k + secant * deviator - along * e[i] * e[j]
            })
        });
        (Principal { energy, kirchhoff: e.map(|e| k * volume + secant * e), slope }, step)
    }

    /// Answer to a gradient from what the point remembers, with the yield stress (MPa) of now; what
    /// it will remember goes to `new`. `None` where the gradient turns the point over.
    pub(super) fn flux(
        &self,
        yield_mpa: f64,
        f: &Gradient,
        old: &[f64],
        new: Option<&mut [f64]>,
    ) -> Option<(f64, Gradient)> {
        let (trial, inverse) = trial(f, old)?;
        let (u, step) = self.principal(trial.logarithms(), yield_mpa * old[LOG_VOLUME].exp());
        if let Some(new) = new {
            let volume: f64 = trial.logarithms().iter().sum();
            // elastic part after the return: the deviator shrinks along itself
            let ln = u.kirchhoff.map(|tau| {
                let mean = self.bulk_mpa * volume;
                (tau - mean) / (2.0 * self.shear_mpa) + volume / 3.0
            });
            let elastic = trial.back(ln.map(f64::exp));
            let det = f[0] * f[3] - f[1] * f[2];
            let back = [f[3] / det, -f[1] / det, -f[2] / det, f[0] / det, 1.0 / f[4]];
            let after = if step > 0.0 { product(&back, &elastic) } else { inverse };
            (0..5).for_each(|i| new[i] = after[i] - IDENTITY[i]);
            new[PLASTIC_STRAIN] = old[PLASTIC_STRAIN] + step;
            new[LOG_VOLUME] = volume;
        }
        Some((u.energy, pulled(&trial.stress(u.kirchhoff), &inverse)))
    }

    /// As [`Plastic::flux`], with the tangent.
    pub(super) fn response(&self, yield_mpa: f64, f: &Gradient, old: &[f64]) -> Option<Response<5>> {
        let (trial, inverse) = trial(f, old)?;
        let (u, _) = self.principal(trial.logarithms(), yield_mpa * old[LOG_VOLUME].exp());
        let r = trial.respond(&u);
        // rows, then columns, back from the elastic to the whole gradient
        let half: [Gradient; 5] = r.tangent.map(|row| pulled(&row, &inverse));
        let mut tangent = [[0.0; 5]; 5];
        for j in 0..5 {
            let column = pulled(&std::array::from_fn(|i| half[i][j]), &inverse);
            (0..5).for_each(|i| tangent[i][j] = column[i]);
        }
        Some(Response { energy: r.energy, flux: pulled(&r.flux, &inverse), tangent })
    }
}

/// Elastic trial gradient `F Fp^-1`, and `Fp^-1`.
fn trial(f: &Gradient, old: &[f64]) -> Option<(Stretched, Gradient)> {
    let inverse: Gradient = std::array::from_fn(|i| IDENTITY[i] + old[i]);
    Some((Stretched::of(&product(f, &inverse))?, inverse))
}

fn product(a: &Gradient, b: &Gradient) -> Gradient {
    [
        a[0] * b[0] + a[1] * b[2],
        a[0] * b[1] + a[1] * b[3],
        a[2] * b[0] + a[3] * b[2],
        a[2] * b[1] + a[3] * b[3],
        a[4] * b[4],
    ]
}

/// `P G'`: the stress by `F` of a stress by `F G`.
fn pulled(p: &Gradient, g: &Gradient) -> Gradient {
    product(p, &[g[0], g[2], g[1], g[3], g[4]])
}
