//! Relaxation of the material: Prony terms (thesis Eqs. 10 to 13), the same part of shear and bulk.

use super::{Effect, FormError, Kind, Owner, Quantity, Share, Stage, fading};

const TIMES: &[f64] = &[0.05, 0.3, 1.5, 8.0, 40.0];

/// Largest part that relaxes, of one term or of both together: with all of it nothing holds the material together in the end.
pub const MOST: f64 = 0.9;

/// One Prony term.
pub const ONE: Effect = Effect {
    code: "relaxation",
    form: "one-term",
    stage: Stage::Material,
    kind: Kind::Memory,
    assumption: "the force follows from the depth alone, whatever the time",
    signature: "decay in a hold, a fan over the rates, a loop that grows with the rate",
    twins: &["sensor-creep", "lag"],
    separated_by: "a hold on a stiff block",
    prior: "foams that are called elastic lose about a twentieth of their force in a hold; those that lose more show it (docs/real-data.md)",
    quantities: &[
        Quantity::amplitude("g1", 0.0, (0.0, MOST), 0.1, &[0.15]).about(0.05),
        Quantity::shape("tau1_s", (0.01, 500.0), 1.0, TIMES),
    ],
    owner: Owner::All,
    form_error: FormError::of(Share::Rough, Share::Solved),
};

/// Longest runs that the longer of two times may be. In a tenth of itself a time shows as a trend, its part and its length not apart; one time and a trend look like a spectrum.
const RUNS: f64 = 10.0;

/// Two Prony terms.
pub const TWO: Effect = Effect {
    form: "two-term",
    quantities: &[
        Quantity::amplitude("g1", 0.0, (0.0, MOST), 0.1, &[0.15]).about(0.05),
        Quantity::shape("tau1_s", (0.01, 500.0), 0.3, &[0.1, 0.5]).at_most(RUNS),
        Quantity::amplitude("g2", 0.0, (0.0, MOST), 0.1, &[0.1]).about(0.05),
        Quantity::shape("tau2_s", (0.01, 500.0), 5.0, &[3.0, 20.0]).at_most(RUNS),
    ],
    ..ONE
};

/// Relaxation in a whole spectrum of times, as a power law of time has: what a few terms must do better than. It is in no catalogue and no answer.
pub const SPECTRUM: Effect = Effect {
    form: "spectrum",
    quantities: &[
        Quantity::amplitude("g", 0.0, (0.0, MOST), 0.1, &[0.15]).about(0.05),
        Quantity::shape("shortest_s", (0.003, 50.0), 0.1, &[0.02, 0.2, 2.0]),
    ],
    ..ONE
};

/// How a relaxing material carries its memory along, in units of what finite elements say of a Prony series ([`relaxed`]): nothing for a force that relaxes by itself. What is
/// named beside a relaxation must do better than that. It is in no catalogue and no answer.
pub const MEMORY: Effect = Effect {
    code: "memory",
    form: "carried",
    quantities: &[Quantity::amplitude("carried", 1.0, (-1.0, 3.0), 0.0, &[0.0])],
    ..ONE
};

/// Times of a spectrum, each [`APART`] times the one before; their parts fall as its power of the time. Three and a half decades are more than any run sees.
const SPECTRAL: i32 = 6;
const APART: f64 = 5.0;
/// Foams, gels and tissues relax as powers of time between 0.1 and 0.5.
const POWER: f64 = 0.3;

/// Prony terms (part, time in s) of a spectrum that has a part `g` in all and begins at a time (s).
#[must_use]
pub fn spectrum(g: f64, shortest_s: f64) -> Vec<(f64, f64)> {
    let part = |k: i32| APART.powf(-POWER * f64::from(k));
    let whole: f64 = (0..SPECTRAL).map(part).sum();
    (0..SPECTRAL).map(|k| (g * part(k) / whole, shortest_s * APART.powi(k))).collect()
}

/// How far a memory that pulls rounds the end of a contact off, see [`relaxed`]: measured on finite elements at
/// exponents 4 to 18, balls of 4 and 9 mm, `V tau` of 1 to 4 mm.
const LIFTING: f64 = 0.42;

/// Force of a relaxing specimen from the elastic one, both in N, at times (s).
///
/// An element keeps the memory of stress in the material, which the deformation carries along; the force it makes is that
/// stress times what the present shape gives it. So not the force is convolved but `S = F_e / A`, `A = exp(-carried d / R)` (depths in
/// `shape`): `F = (1 - g) F_e + g A q`, `q' = S' - q / tau`, exact where `S` moves straight between nodes. With `carried = 0` this
/// is the linear theory of Lee and Radok (1960, doi:10.1115/1.3644020), which misses finite elements of a foam by 1.8 % of
/// the peak at g = 0.3; `carried` is measured on one solve ([`crate::chain::Library`]) and leaves 0.2 %.
///
/// On the way back a memory that pulls lifts the edge of the contact first (Ting 1966, doi:10.1115/1.3625192): the force
/// ends smoothly and never pulls.
pub fn relaxed(time_s: &[f64], shape: &[f64], terms: &[(f64, f64)], force_n: &mut [f64]) {
    remember(time_s, shape, terms, force_n, |straight, memory| {
        let pull = LIFTING * memory.min(0.0);
        if pull == 0.0 { straight.max(0.0) } else { 0.5 * (straight + (straight * straight + pull * pull).sqrt()) }
    });
}

/// Force of a relaxing specimen in which every point deforms alike, from the elastic one, both in N, at times (s): the second Piola-Kirchhoff stress, force over
/// `stretches`, is what is convolved (thesis Eqs. 10 to 13), exactly where it moves straight between nodes.
pub fn convolved(time_s: &[f64], stretches: &[f64], terms: &[(f64, f64)], force_n: &mut [f64]) {
    remember(time_s, stretches, terms, force_n, |straight, _| straight);
}

/// Times between nodes that differ by less than this share are one.
const EVEN: f64 = 1e-9;

/// Convolves the stress `F / A`, `A` in `shape`; `ends` makes the force of what the linear theory says and the part of it that is memory.
fn remember(time_s: &[f64], shape: &[f64], terms: &[(f64, f64)], force_n: &mut [f64], ends: impl Fn(f64, f64) -> f64) {
    let part: f64 = terms.iter().map(|(g, _)| g).sum();
    let fade = |step_s: f64| terms.iter().map(|(_, tau_s)| fading(step_s / tau_s)).collect::<Vec<_>>();
    let (mut step_s, mut faded) = (0.0, fade(0.0));
    let mut kept = vec![0.0; terms.len()];
    let mut before = 0.0;
    for i in 0..force_n.len() {
        let dt = if i == 0 { 0.0 } else { (time_s[i] - time_s[i - 1]).max(0.0) };
        // most steps of a run are one but for rounding
        if (dt - step_s).abs() > EVEN * step_s {
            (step_s, faded) = (dt, fade(dt));
        }
        let stress = force_n[i] / shape[i];
        let mut memory = 0.0;
        for ((q, (g, _)), (left, share)) in kept.iter_mut().zip(terms).zip(&faded) {
            *q = *q * left + (stress - before) * share;
            memory += g * *q * shape[i];
        }
        before = stress;
        force_n[i] = ends((1.0 - part) * force_n[i] + memory, memory);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Half way along its times a spectrum relaxes as the power of time that it is made of, and all its parts are the whole.
    #[test]
    fn a_spectrum_relaxes_as_a_power_of_time() {
        let terms = spectrum(0.4, 0.1);
        assert!((terms.iter().map(|(g, _)| g).sum::<f64>() - 0.4).abs() < 1e-15);
        let left = |t: f64| terms.iter().map(|(g, tau_s)| g * (-t / tau_s).exp()).sum::<f64>();
        // what is left of a power law that ends at the longest time, less that of the end
        let slope = (left(10.0) / left(1.0)).log10();
        let power = |t: f64| (t / 0.1_f64).powf(-POWER) - (3.0 * 312.5 / 0.1_f64).powf(-POWER);
        let expected = (power(10.0) / power(1.0)).log10();
        assert!((slope - expected).abs() < 0.06, "{slope} {expected}");
    }
}
