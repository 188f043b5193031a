//! What the palpations are simulated with, in numbers.

use std::fmt::Write as _;

use tests::palpations::{B1_RELAXATION, Conditions, DEPTH_MM, SAMPLES_HZ, THRESHOLD_SIGMAS};

pub fn table(conditions: &Conditions) -> String {
    let c = conditions;
    let lines = [
        (
            "depth, sampling",
            format!(
                "{DEPTH_MM} mm past contact; {SAMPLES_HZ} Hz; approach of 3 to 4 mm, its phase against sampling random"
            ),
        ),
        ("force noise", format!("white, {} mN a sample", 1e3 * c.noise_n)),
        ("zero of the load cell", format!("{} mN, new for every press", 1e3 * c.zero_n)),
        ("gain", format!("{} %, new for every press", 100.0 * c.gain)),
        ("height of the surface", format!("{} mm, new for every press", c.contact_mm)),
        (
            "B1 softens",
            format!(
                "by {} % of its fresh modulus, 63 % of that within {} presses; the library's B1 is the mean of a session of 50, which starts {:.1} % above and ends {:.1} % below it",
                100.0 * c.softening.loss,
                c.softening.presses,
                100.0 * (c.softening.factor(1) - 1.0),
                100.0 * (1.0 - c.softening.factor(50)),
            ),
        ),
        (
            "B1 relaxes",
            format!(
                "one Maxwell element, g = k = {}, tau = {} s; instantaneous modulus such that 4 mm at 1 mm/s take the force of the identified 0.188 MPa",
                B1_RELAXATION.g, B1_RELAXATION.tau_s
            ),
        ),
        (
            "contact of the thesis' way",
            format!("first sample {THRESHOLD_SIGMAS} deviations of the noise above the zero of the approach"),
        ),
    ];
    let mut out = String::from("| what | value (standard deviation where random) |\n|---|---|\n");
    for (what, value) in lines {
        let _ = writeln!(out, "| {what} | {value} |");
    }
    out
}
