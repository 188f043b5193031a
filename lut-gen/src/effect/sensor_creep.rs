//! A force sensor that creeps, or has a loop of its own.

use super::{Effect, FormError, Kind, Owner, Quantity, Share, Stage, fading};

/// A part of the reading follows the force late.
pub const CREEP: Effect = Effect {
    code: "sensor-creep",
    form: "creep",
    stage: Stage::Sensor,
    kind: Kind::Sensor,
    assumption: "the reading follows the force at once",
    signature: "the same on every material",
    twins: &["relaxation"],
    separated_by: "a hold on a stiff block",
    prior: "strain-gauge cells creep by 0.1 % and less, resistive and polymer sensors by up to 5 % a decade of time (Interlink 400 series): 1 % lies between",
    quantities: &[
        Quantity::amplitude("amplitude", 0.0, (0.0, 1.0), 0.03, &[0.03]).about(0.01),
        // what follows within a tenth of a second is lag to a run: force and depth late by the same time look alike
        Quantity::shape("tau_s", (0.1, 500.0), 1.5, &[0.3, 1.5, 8.0, 40.0]),
    ],
    owner: Owner::All,
    form_error: FormError::of(Share::Outside, Share::Elastic),
};

/// The reading stays behind by a share of the largest force when its direction turns.
pub const HYSTERESIS: Effect = Effect {
    code: "sensor-creep",
    form: "hysteresis",
    stage: Stage::Sensor,
    kind: Kind::Sensor,
    assumption: "loading and unloading read the same",
    signature: "a loop that no rate changes",
    twins: &["friction"],
    separated_by: "a loop on a stiff block",
    prior: "a play of 1 % of the largest force: strain-gauge cells have 0.1 % and less, resistive ones up to 10 % (Interlink 400 series)",
    quantities: &[Quantity::amplitude("width", 0.0, (0.0, 0.5), 0.03, &[0.03]).about(0.01)],
    owner: Owner::All,
    form_error: FormError::of(Share::Outside, Share::Elastic),
};

/// Adds `a` times what a low-pass filter of that time makes of the force, exact where the force moves straight.
pub fn creep(time_s: &[f64], force_n: &mut [f64], (amplitude, tau_s): (f64, f64)) {
    let (mut late, mut before) = (0.0, 0.0);
    for i in 0..force_n.len() {
        let dt = if i == 0 { 0.0 } else { (time_s[i] - time_s[i - 1]).max(0.0) };
        let now = force_n[i];
        let (kept, share) = fading(dt / tau_s);
        // response of a first-order filter to a straight piece
        late = late * kept + before * (share - kept) + now * (1.0 - share);
        before = now;
        force_n[i] = now + amplitude * late;
    }
}

/// A play operator: the reading follows the force through a gap of `width` times the largest force, so it stays behind: less on the way up,
/// more on the way back.
pub fn hysteresis(force_n: &mut [f64], width: f64) {
    let gap = 0.5 * width * force_n.iter().copied().fold(0.0, f64::max);
    let mut seat = 0.0_f64;
    for force in force_n.iter_mut() {
        // a force that is no number moves nothing
        seat = seat.max(*force - gap).min(*force + gap);
        *force = seat;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A gap of a tenth of the largest force: half of it is missing on the way up, and the way back begins with a stand.
    #[test]
    fn a_play_stays_behind() {
        let mut force = vec![0.0, 0.02, 0.5, 1.0, 0.95, 0.5, 0.0];
        hysteresis(&mut force, 0.1);
        let expected = [0.0, 0.0, 0.45, 0.95, 0.95, 0.55, 0.05];
        assert!(force.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{force:?}");
    }
}
