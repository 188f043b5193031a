//! The simplex as appendix C prints it. It is not that of appendix A ([`crate::identify::simplex`]): it has no box, contracts to one side only, evaluates the
//! best vertex again after a shrink, and ends after ten iterations without a gain.

/// Added to each coordinate in turn for the first simplex, whatever its unit.
pub const STEP: f64 = 0.1;
/// A gain below this (N) is none, and iterations without one that end the search. The script writes `10e-6`.
pub const NO_GAIN: f64 = 10e-6;
/// See [`NO_GAIN`].
pub const PATIENCE: usize = 10;
/// Reflection, expansion, contraction (printed as -0.5) and shrink (printed as 0.5).
const REFLECTION: f64 = 1.0;
const EXPANSION: f64 = 2.0;
const CONTRACTION: f64 = -0.5;
const SHRINK: f64 = 0.5;

/// One evaluation.
#[derive(Debug, Clone, PartialEq)]
pub struct Visit {
    /// The point as the simplex has it: its coordinates may be negative, where the script takes their absolute value.
    pub x: Vec<f64>,
    /// Objective there.
    pub value: f64,
}

/// All evaluations in order; at most `most`.
pub fn printed(objective: &mut dyn FnMut(&[f64]) -> f64, start: &[f64], most: usize) -> Vec<Visit> {
    let mut visits: Vec<Visit> = Vec::new();
    let mut evaluate = |x: Vec<f64>, visits: &mut Vec<Visit>| -> Option<Visit> {
        if visits.len() >= most {
            return None;
        }
        let visit = Visit { value: objective(&x), x };
        visits.push(visit.clone());
        Some(visit)
    };
    let mut simplex = Vec::new();
    for axis in 0..=start.len() {
        let mut x = start.to_vec();
        if let Some(moved) = axis.checked_sub(1) {
            x[moved] += STEP;
        }
        match evaluate(x, &mut visits) {
            Some(visit) => simplex.push(visit),
            None => return visits,
        }
    }
    let (mut before, mut idle) = (simplex[0].value, 0);
    loop {
        // as the script's sort: stable
        simplex.sort_by(|a, b| a.value.total_cmp(&b.value));
        if simplex[0].value < before - NO_GAIN {
            (before, idle) = (simplex[0].value, 0);
        } else {
            idle += 1;
        }
        if idle >= PATIENCE || transformed(&mut simplex, &mut |x| evaluate(x, &mut visits)).is_none() {
            return visits;
        }
    }
}

/// One iteration; none where the evaluations are spent.
fn transformed(simplex: &mut Vec<Visit>, evaluate: &mut dyn FnMut(Vec<f64>) -> Option<Visit>) -> Option<()> {
    let last = simplex.len() - 1;
    let worst = simplex[last].clone();
    let centre: Vec<f64> =
        (0..worst.x.len()).map(|i| simplex[..last].iter().map(|v| v.x[i]).sum::<f64>() / last as f64).collect();
    let along = |factor: f64| centre.iter().zip(&worst.x).map(|(c, w)| c + factor * (c - w)).collect::<Vec<f64>>();
    let reflected = evaluate(along(REFLECTION))?;
    if simplex[0].value <= reflected.value && reflected.value < simplex[last - 1].value {
        simplex[last] = reflected;
        return Some(());
    }
    if reflected.value < simplex[0].value {
        let expanded = evaluate(along(EXPANSION))?;
        simplex[last] = if expanded.value < reflected.value { expanded } else { reflected };
        return Some(());
    }
    let contracted = evaluate(along(CONTRACTION))?;
    if contracted.value < worst.value {
        simplex[last] = contracted;
        return Some(());
    }
    let best = simplex[0].x.clone();
    let mut shrunk = Vec::new();
    for vertex in simplex.iter() {
        shrunk.push(evaluate(best.iter().zip(&vertex.x).map(|(b, x)| b + SHRINK * (x - b)).collect())?);
    }
    *simplex = shrunk;
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On a bowl it comes near the bottom and ends by its own rule; evaluations are all there, in order.
    #[test]
    fn the_printed_simplex_finds_a_bowl_and_ends_by_itself() {
        let mut count = 0;
        let mut bowl = |x: &[f64]| {
            count += 1;
            (x[0] - 1.0).powi(2) + 4.0 * (x[1] + 0.5).powi(2)
        };
        let visits = printed(&mut bowl, &[0.0, 0.0], 1000);
        assert_eq!(visits.len(), count);
        assert_eq!(visits[0].x, [0.0, 0.0]);
        assert_eq!((&visits[1].x[..], &visits[2].x[..]), (&[0.1, 0.0][..], &[0.0, 0.1][..]));
        let best = visits.iter().map(|v| v.value).fold(f64::INFINITY, f64::min);
        // It ends ten iterations after the last gain of 1e-5.
        assert!(best < 1e-4 && visits.len() < 300, "{best} {}", visits.len());
    }

    #[test]
    fn it_stops_when_its_evaluations_are_spent() {
        let mut slope = |x: &[f64]| -x[0];
        assert_eq!(printed(&mut slope, &[0.0, 0.0, 0.0], 3).len(), 3);
        assert_eq!(printed(&mut slope, &[0.0, 0.0, 0.0], 20).len(), 20);
    }
}
