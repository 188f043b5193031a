//! Layers that relax.

use super::foam::Foam;
use super::gradient::{Gradient, Principal, Stretched};
use super::ogden::Ogden;
use crate::fem::operator::Response;
use crate::pad::error::{PadError, demand};

/// An elastic law that a relaxing one is made from.
#[derive(Debug, Clone, PartialEq)]
pub enum Elastic {
    /// Its isochoric part relaxes, the volumetric one does not.
    Ogden(Ogden),
    /// The whole of it relaxes.
    Foam(Foam),
}

/// An elastic law with a Prony series on the second Piola-Kirchhoff stress that relaxes (Simo 1987,
/// doi:10.1016/0045-7825(87)90107-1; moduli are the instantaneous ones, as in thesis Eqs. 10 to
/// 13):
///
/// ```text
/// S = S_vol + (1 - sum g_i) S_0 + sum h_i,   h_i(t) = g_i int exp(-(t - s) / tau_i) dS_0(s)
/// ```
///
/// Over a step in which `S_0` changes linearly, `h_i` becomes `exp(-x) h_i + g_i (1 - exp(-x)) / x
/// dS_0` with `x = dt / tau_i`; so a step has the energy `W_vol + a W_0 + H : C / 2` with a history
/// `H` of its start, and a symmetric tangent.
///
/// A point remembers `S_0` and every `h_i`, four numbers each: `[xx, yy, xy, zz]` (MPa).
#[derive(Debug, Clone, PartialEq)]
pub struct Relaxing {
    elastic: Elastic,
    /// Weight and time (s) of every term.
    terms: Vec<(f64, f64)>,
}

/// Components of a second Piola-Kirchhoff stress.
const STRESS: usize = 4;

impl Relaxing {
    /// Of an elastic law and terms `(g_i, tau_i in s)`.
    ///
    /// # Errors
    /// [`PadError::Value`] when there is no term, a weight is negative, a time is not positive, or
    /// the weights reach 1.
    pub fn new(elastic: Elastic, terms: &[(f64, f64)]) -> Result<Self, PadError> {
        demand(!terms.is_empty(), "the number of Prony terms", 0.0, "1 or more")?;
        for &(g, tau) in terms {
            demand(g >= 0.0, "a Prony term's weight", g, "0 or more")?;
            demand(tau > 0.0 && tau.is_finite(), "a Prony term's time (s)", tau, "more than 0")?;
        }
        let sum: f64 = terms.iter().map(|t| t.0).sum();
        demand(sum < 1.0, "the sum of Prony weights", sum, "less than 1")?;
        Ok(Self { elastic, terms: terms.to_vec() })
    }

    /// Instantaneous shear modulus (MPa).
    #[must_use]
    pub fn shear_mpa(&self) -> f64 {
        match &self.elastic {
            Elastic::Ogden(law) => law.shear_mpa(),
            Elastic::Foam(law) => law.shear_mpa(),
        }
    }

    /// Numbers that a point remembers.
    pub(super) fn states(&self) -> usize {
        STRESS * (1 + self.terms.len())
    }

    /// The part that relaxes, `part` of it, with the rest.
    fn principal(&self, ln: [f64; 3], part: f64, rest: f64) -> Principal {
        match &self.elastic {
            Elastic::Ogden(law) => law.parts(ln, part, rest),
            Elastic::Foam(law) => law.principal(ln).times(part),
        }
    }

    /// Weight of `S_0` at the end of a step (s), and the history `H` of its start.
    fn step(&self, step_s: f64, old: &[f64]) -> (f64, [f64; STRESS]) {
        let mut weight = 1.0;
        let mut history = [0.0; STRESS];
        for (i, &(g, tau)) in self.terms.iter().enumerate() {
            let (kept, new) = decay(step_s / tau);
            weight -= g * (1.0 - new);
            for (c, history) in history.iter_mut().enumerate() {
                *history += kept * old[STRESS * (1 + i) + c] - g * new * old[c];
            }
        }
        (weight, history)
    }

    /// Energy and stress after a step, from what the point remembers; what it will remember goes to
    /// `new`.
    pub(super) fn flux(
        &self,
        step_s: f64,
        f: &Gradient,
        old: &[f64],
        new: Option<&mut [f64]>,
    ) -> Option<(f64, Gradient)> {
        let stretched = Stretched::of(f)?;
        let ln = stretched.logarithms();
        let (weight, history) = self.step(step_s, old);
        let u = self.principal(ln, weight, 1.0);
        if let Some(new) = new {
            let now = second(f, &stretched.stress(self.principal(ln, 1.0, 0.0).kirchhoff));
            for (i, &(g, tau)) in self.terms.iter().enumerate() {
                let (kept, share) = decay(step_s / tau);
                for c in 0..STRESS {
                    let at = STRESS * (1 + i) + c;
                    new[at] = kept * old[at] + g * share * (now[c] - old[c]);
                }
            }
            new[..STRESS].copy_from_slice(&now);
        }
        let mut p = stretched.stress(u.kirchhoff);
        let more = pushed(f, &history);
        (0..5).for_each(|i| p[i] += more[i]);
        Some((u.energy + work(f, &history), p))
    }

    /// As [`Relaxing::flux`], with the tangent.
    pub(super) fn response(&self, step_s: f64, f: &Gradient, old: &[f64]) -> Option<Response<5>> {
        let stretched = Stretched::of(f)?;
        let (weight, h) = self.step(step_s, old);
        let mut r = stretched.respond(&self.principal(stretched.logarithms(), weight, 1.0));
        r.energy += work(f, &h);
        let more = pushed(f, &h);
        (0..5).for_each(|i| r.flux[i] += more[i]);
        // of F H by F: rows of the plane are two gradients' worth of H
        for row in [0, 2] {
            r.tangent[row][row] += h[0];
            r.tangent[row][row + 1] += h[2];
            r.tangent[row + 1][row] += h[2];
            r.tangent[row + 1][row + 1] += h[1];
        }
        r.tangent[4][4] += h[3];
        Some(r)
    }
}

/// `exp(-x)` and `(1 - exp(-x)) / x`.
fn decay(x: f64) -> (f64, f64) {
    let gone = -(-x).exp_m1();
    (1.0 - gone, if x > 0.0 { gone / x } else { 1.0 })
}

/// `F^-1 P` as `[xx, yy, xy, zz]`.
fn second(f: &Gradient, p: &Gradient) -> [f64; STRESS] {
    let det = f[0] * f[3] - f[1] * f[2];
    [
        (f[3] * p[0] - f[1] * p[2]) / det,
        (f[0] * p[3] - f[2] * p[1]) / det,
        (f[3] * p[1] - f[1] * p[3]) / det,
        p[4] / f[4],
    ]
}

/// `F S`.
fn pushed(f: &Gradient, s: &[f64; STRESS]) -> Gradient {
    [
        f[0] * s[0] + f[1] * s[2],
        f[0] * s[2] + f[1] * s[1],
        f[2] * s[0] + f[3] * s[2],
        f[2] * s[2] + f[3] * s[1],
        f[4] * s[3],
    ]
}

/// `S : (C - 1) / 2`.
fn work(f: &Gradient, s: &[f64; STRESS]) -> f64 {
    let c = [f[0] * f[0] + f[2] * f[2] - 1.0, f[1] * f[1] + f[3] * f[3] - 1.0, f[0] * f[1] + f[2] * f[3]];
    0.5 * (s[0] * c[0] + s[1] * c[1] + 2.0 * s[2] * c[2] + s[3] * (f[4] * f[4] - 1.0))
}
