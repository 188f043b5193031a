//! Seeded chance, one stream a purpose and number.

use rand::SeedableRng;
use rand_pcg::Pcg64;

/// What is left to chance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u64)]
pub(super) enum Purpose {
    /// Order of the session.
    Order = 11,
    /// Contact point and gain of a spot.
    Spot = 12,
    /// Force noise of a run.
    Sensor = 13,
    /// Wandering zero of the session.
    Drift = 14,
    /// Phase of what is periodic in a run.
    Phase = 15,
    /// Shape of a placebo.
    Placebo = 16,
    /// Waves of a rest.
    Rest = 17,
}

/// The stream of a purpose; the same three numbers give the same stream whatever the threads do.
pub(super) fn stream(seed: u64, purpose: Purpose, number: u64) -> Pcg64 {
    let mixed = mix(mix(seed ^ mix(purpose as u64)).wrapping_add(number));
    Pcg64::seed_from_u64(mixed)
}

/// SplitMix64's finaliser (Steele, Lea and Flood 2014, doi:10.1145/2660193.2660195): seeds and numbers are small and alike.
fn mix(mut z: u64) -> u64 {
    z = z.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
