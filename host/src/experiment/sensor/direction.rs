//! Which way the columns count.

use crate::experiment::Recording;
use crate::experiment::error::Problem;
use crate::experiment::signal::extent;

/// An excursion to one side is this many times that to the other where it says which way a column counts.
const CLEAR: f64 = 3.0;
/// Readings at the beginning that stand for what a column reads at rest.
const FIRST: usize = 3;

/// Which way a column goes from its beginning.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Way {
    Rises,
    Falls,
    Unclear,
}

/// True where both columns count compression negative, so that both are to be turned.
///
/// # Errors
/// Where one of them alone does.
pub(super) fn turns(recording: &Recording) -> Result<bool, Problem> {
    let (depth, force) = (recording.depth_mm.as_slice(), recording.force_n.as_slice());
    let (down, push) = (way(depth), way(force));
    if depth.len() != force.len() || down == Way::Unclear || push == Way::Unclear {
        return Ok(false);
    }
    let together = moves_together(depth, force);
    let ((shallowest, deepest), (lowest, highest)) = (extent(depth.iter().copied()), extent(force.iter().copied()));
    // A way back alone falls as well, from a push to nothing.
    let pulls = -lowest > CLEAR * highest.max(0.0);
    match (down, push) {
        (Way::Falls, Way::Falls) if together > 0.0 && pulls => Ok(true),
        (Way::Rises, Way::Falls) if together < 0.0 && pulls => Err(Problem::Contradiction(format!(
            "the force falls to {lowest:.3} N while the ball goes in, to {deepest:.3} mm: pushing must be positive; \
                 write force_N = {{ name = \"...\", sign = -1 }} in [columns]"
        ))),
        (Way::Falls, Way::Rises) if together < 0.0 => Err(Problem::Contradiction(format!(
            "the depth falls to {shallowest:.3} mm while the force rises to {highest:.3} N: going in must be positive; \
                 write depth_mm = {{ name = \"...\", sign = -1 }} in [columns]"
        ))),
        _ => Ok(false),
    }
}

fn way(values: &[f64]) -> Way {
    let first = values.iter().take(FIRST).sum::<f64>() / values.len().clamp(1, FIRST) as f64;
    let (low, high) = extent(values.iter().copied());
    let (up, down) = (high - first, first - low);
    if up > CLEAR * down {
        Way::Rises
    } else if down > CLEAR * up {
        Way::Falls
    } else {
        Way::Unclear
    }
}

/// Covariance of both columns, mm N.
fn moves_together(depth: &[f64], force: &[f64]) -> f64 {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
    let (d, f) = (mean(depth), mean(force));
    depth.iter().zip(force).map(|(a, b)| (a - d) * (b - f)).sum()
}
