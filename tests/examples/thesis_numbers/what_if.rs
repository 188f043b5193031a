//! Recognition under other assumptions than the stated ones.

use std::fmt::Write as _;
use std::path::Path;

use palpate::report::figure::{Axis, Figure, Series, Stroke};
use tests::palpations::{Conditions, RATES_MM_S, Softening};

use super::{Bench, bar, save};

/// Sessions of 150 for each rate: 450 palpations.
const SESSIONS: usize = 3;

/// Losses of B1's modulus.
const LOSSES: [f64; 7] = [0.0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3];

/// Recognition with each assumption changed for itself, and the picture over B1's softening.
pub fn table(bench: &Bench, docs: &Path) -> Result<String, Box<dyn std::error::Error>> {
    let base = Conditions::default();
    let mut cases: Vec<(String, Conditions)> = LOSSES
        .iter()
        .map(|&loss| {
            let softening = Softening { loss, ..base.softening };
            (format!("B1 softens by {:.0} %", 100.0 * loss), Conditions { softening, ..base })
        })
        .collect();
    cases.push(("noise 20 mN".into(), Conditions { noise_n: 0.02, ..base }));
    cases.push(("noise 1 % of the foam's own peak".into(), Conditions { noise_of_peak: 0.01, ..base }));
    cases.push(("gain 3 %".into(), Conditions { gain: 0.03, ..base }));
    cases.push(("surface 0.1 mm".into(), Conditions { contact_mm: 0.1, ..base }));
    let bar = bar("other assumptions", cases.len() * SESSIONS * RATES_MM_S.len());
    let mut out = String::from(
        "| changed | board: 1 mm/s | 2 mm/s | 4 mm/s | thesis' way: 1 mm/s | 2 mm/s | 4 mm/s |\n|---|---|---|---|---|---|---|\n",
    );
    let mut lines = vec![Vec::new(); 2 * RATES_MM_S.len()];
    for (i, (name, conditions)) in cases.iter().enumerate() {
        let studies = bench.studies(SESSIONS, conditions, &bar)?;
        let board = studies.iter().map(|s| s.recognised(&bench.foams, None).percent());
        let thesis = studies.iter().map(|s| s.recognised_by_threshold(&bench.foams, None).percent());
        let percent: Vec<f64> = board.chain(thesis).collect();
        let _ = write!(out, "| {name} |");
        for (line, p) in lines.iter_mut().zip(&percent) {
            let _ = write!(out, " {p:.1} % |");
            if let Some(loss) = LOSSES.get(i) {
                line.push((100.0 * loss, *p));
            }
        }
        out.push('\n');
    }
    bar.finish_and_clear();
    let mut figure = Figure::new(
        "Recognised, as B1 softens more over a session",
        Axis::new("loss of B1's modulus (%)"),
        Axis::new("recognised (%)").over(90.0, 100.5),
    );
    for (i, points) in lines.into_iter().enumerate() {
        let rate = RATES_MM_S[i % RATES_MM_S.len()];
        let (way, stroke) =
            if i < RATES_MM_S.len() { ("board", Stroke::Solid) } else { ("thesis' way", Stroke::Dashed) };
        figure = figure.with(Series::new(&format!("{way}, {rate} mm/s"), points, stroke, i % RATES_MM_S.len()));
    }
    save(docs, "thesis-softening.svg", &figure.svg())?;
    Ok(out)
}
