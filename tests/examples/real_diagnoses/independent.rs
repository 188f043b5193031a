//! Relaxation of a recording without a contact model, finite elements or a theory of noise: a power law of the
//! depth with a fading memory, fitted to the samples by trying all places of a grid.

use palpate::experiment::{Experiment, Recording};
use tests::document::table;

/// Exponents of the power law, depths of its beginning (mm before the deepest point's tenths), and times (s).
const EXPONENTS: (f64, f64, usize) = (1.0, 6.0, 21);
const BEGINNINGS: (f64, f64, usize) = (-8.0, 1.0, 37);
const TIMES: (f64, f64, usize) = (0.1, 30.0, 33);
/// A hold ends where the indenter has left its deepest point by this, mm.
const LEFT_MM: f64 = 0.02;

/// One recording's fit.
struct Fitted {
    /// Part that relaxes.
    part: f64,
    /// Its time, s.
    tau_s: f64,
    /// Root mean square of what is left, N, and of what the power law without memory leaves.
    left_n: (f64, f64),
    /// Fall of the force in the hold, as a part of its peak.
    fall: f64,
}

/// Places of a range, evenly.
fn even((low, high, count): (f64, f64, usize)) -> impl Iterator<Item = f64> + Clone {
    (0..count).map(move |at| low + (high - low) * at as f64 / (count - 1) as f64)
}

/// `F = (1 - g) e(t) + g int exp(-(t - s) / tau) de(s)`, `e` the power law of the depth: two amounts, in which it is linear,
/// at every place of the grid.
fn fitted(recording: &Recording) -> Option<Fitted> {
    let deepest = recording.depth_mm.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let last = recording.depth_mm.iter().rposition(|d| *d > deepest - LEFT_MM)?;
    let (t, d) = (&recording.time_s[..=last], &recording.depth_mm[..=last]);
    let force = &recording.force_n[..=last];
    let peak = force.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let whole = dot(force, force);
    let (mut best, mut elastic): (Option<(f64, f64, f64)>, f64) = (None, f64::INFINITY);
    for (n, from) in even(EXPONENTS).flat_map(|n| even(BEGINNINGS).map(move |from| (n, from))) {
        let law: Vec<f64> = d.iter().map(|d| (d - from).max(0.0).powf(n)).collect();
        let (ee, ef) = (dot(&law, &law), dot(&law, force));
        elastic = elastic.min(whole - ef * ef / ee);
        for ln_tau in even((TIMES.0.ln(), TIMES.1.ln(), TIMES.2)) {
            let memory = memory(t, &law, ln_tau.exp());
            let (eh, hh, hf) = (dot(&law, &memory), dot(&memory, &memory), dot(&memory, force));
            let determinant = ee * hh - eh * eh;
            let (long, fading) = ((ef * hh - hf * eh) / determinant, (hf * ee - ef * eh) / determinant);
            // both parts carry
            if !(long >= 0.0 && fading >= 0.0) {
                continue;
            }
            let left = whole - long * ef - fading * hf;
            if best.is_none_or(|best| left < best.0) {
                best = Some((left, fading / (long + fading), ln_tau.exp()));
            }
        }
    }
    let (left, part, tau_s) = best?;
    let rms = |square: f64| (square.max(0.0) / force.len() as f64).sqrt();
    Some(Fitted { part, tau_s, left_n: (rms(left), rms(elastic)), fall: 1.0 - force[last] / peak })
}

/// The fading part: what every step of the law has left of itself.
fn memory(time_s: &[f64], law: &[f64], tau_s: f64) -> Vec<f64> {
    let mut now = 0.0;
    let steps = time_s.windows(2).zip(law.windows(2));
    let later = steps.map(|(t, e)| {
        let dt = t[1] - t[0];
        now = now * (-dt / tau_s).exp() + (e[1] - e[0]) * (-0.5 * dt / tau_s).exp();
        now
    });
    std::iter::once(0.0).chain(later).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// One row a material: ranges over its recordings.
pub fn section(experiment: &Experiment) -> String {
    let mut rows = Vec::new();
    for material in palpate::identify::materials(experiment) {
        let own = experiment
            .runs
            .iter()
            .filter(|run| run.specimen.is_some_and(|at| experiment.specimens[at].material == material));
        let fits: Vec<Fitted> = own.filter_map(|run| fitted(&run.recording)).collect();
        let range = |of: &dyn Fn(&Fitted) -> f64, digits: usize| {
            let each = fits.iter().map(of);
            let (low, high) = each.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
            format!("{low:.digits$} to {high:.digits$}")
        };
        rows.push(vec![
            material,
            fits.len().to_string(),
            range(&|f| 100.0 * f.fall, 0),
            range(&|f| f.part, 2),
            range(&|f| f.tau_s, 1),
            range(&|f| 1e3 * f.left_n.1, 0),
            range(&|f| 1e3 * f.left_n.0, 0),
        ]);
    }
    let head = [
        "an independent fit",
        "runs",
        "force falls in the hold, %",
        "part that relaxes",
        "its time, s",
        "left without memory, mN rms",
        "left with it",
    ];
    table(&head, &rows)
}
