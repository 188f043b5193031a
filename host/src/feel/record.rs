//! Presses of the simulated hand as an experiment: what a laboratory's instruments beside the display would have read.

use std::fmt::Write as _;

use super::session::run_at;
use super::{Asked, Display, Felt, Pace, Sample, Unfelt};
use crate::ownership::file_name;
use crate::plant::{Noise, Source};

/// Presses of each material: a diagnosis asks for repeats.
const PACES: [Pace; 6] = [Pace::Slow, Pace::Slow, Pace::Slow, Pace::Fast, Pace::Fast, Pace::Fast];
/// Noise of one reading: a load cell under the display, N; a camera, mm (`palpate track` against an encoder: 0.016 mm); a
/// potentiometer, mm; a gauss meter, T.
const CELL_N: f64 = 0.003;
const CAMERA_MM: f64 = 0.01;
const SHAFT_MM: f64 = 0.005;
const GAUSS_T: f64 = 1e-4;

/// A file of the experiment: its name and text.
pub type File = (String, String);

/// Presses of one material.
pub const PRESSES: usize = PACES.len();

/// Presses all materials three times slowly and three times fast on a display; `told` hears of every press done. The last file is
/// `experiment.toml`.
///
/// # Errors
/// [`Unfelt`].
pub fn presses(asked: &Asked, display: Display, told: &mut dyn FnMut(usize)) -> Result<Vec<File>, Unfelt> {
    let all = run_at(asked, display, &PACES, told)?;
    let mut noise = Noise::new(asked.seed, Source::Instruments);
    let mut files = Vec::new();
    let mut toml =
        "# Simulated presses of a display, as instruments beside it would have read them.\nname = \"presses\"\n"
            .to_owned();
    for (index, felt) in all.iter().enumerate() {
        for (number, press) in felt.presses.iter().enumerate() {
            let material = file_name(&felt.curve.material);
            let file = format!("{}-{material}-{}-{}.csv", index + 1, press.pace.name(), number + 1);
            let _ = write!(toml, "\n[[run]]\nfile = \"{file}\"\ntest = \"display\"\norder = {}\n", files.len() + 1);
            files.push((file, csv(felt, &press.samples, &mut noise)));
        }
    }
    files.push(("experiment.toml".to_owned(), toml));
    Ok(files)
}

/// A press: the finger's place and force, and what is under it. The shaft's own command is that of a closed loop, which the law of
/// [`crate::diagnose::display`] does not have, and stays away.
fn csv(felt: &Felt, samples: &[Sample], noise: &mut Noise) -> String {
    let under = if felt.display.is_fluid() { "flux_T" } else { "position_mm" };
    let mut out = format!("time_s,finger_mm,{under},reference_N,force_N\n");
    // a record of the board is of the beginning of its tick, the truth beside it of the end
    for (s, next) in samples.iter().zip(samples.iter().skip(1)) {
        let place_mm = s.bone_mm + CAMERA_MM * noise.normal();
        let below = if felt.display.is_fluid() {
            s.flux_t + GAUSS_T * noise.normal()
        } else {
            s.shaft_mm + SHAFT_MM * noise.normal()
        };
        let force_n = s.force_n + CELL_N * noise.normal();
        let _ = writeln!(out, "{:.3},{place_mm:.4},{below:.5},{force_n:.4},{:.4}", s.time_s, next.read_n);
    }
    out
}
