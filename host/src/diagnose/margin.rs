//! Directions in which a residual may lie: means over branch and depth, hold time, cycle, rate, ball, height and clock.

use nalgebra::DVector;

use super::design::{Branch, Design, Node, Series};
use super::fit::Problem;
use super::scatter::Curve;
pub use super::variable::Variable;

/// One direction.
#[derive(Debug, Clone)]
pub struct Margin {
    /// Its variable.
    pub variable: Variable,
    /// Which part of it.
    pub label: String,
    /// The direction, whitened.
    pub direction: DVector<f64>,
    /// Entries it is over.
    pub entries: Vec<usize>,
}

/// Parts of the depth on the way down, on the way back, and of the hold.
const PARTS: (usize, usize, usize) = (6, 4, 4);

/// All margins of a design that vary in it.
#[must_use]
pub fn margins(problem: &Problem<'_>, curves: &[Curve]) -> Vec<Margin> {
    let design = problem.design;
    let mut list = Builder { problem, curves, margins: Vec::new() };
    let share = |s: &Series, n: &Node| share(s, n);
    for part in 0..PARTS.0 {
        let within = |x: f64| in_part(x, part, PARTS.0);
        list.add(Variable::Depth, format!("loading, {}", part_name(part, PARTS.0)), |s, n| {
            n.branch == Branch::Loading && within(share(s, n))
        });
    }
    for part in 0..PARTS.1 {
        list.add(Variable::Unloading, format!("unloading, {}", part_name(part, PARTS.1)), |s, n| {
            n.branch == Branch::Unloading && in_part(share(s, n), part, PARTS.1)
        });
    }
    for part in 0..PARTS.2 {
        list.add(Variable::HoldTime, format!("hold, {}", part_name(part, PARTS.2)), |s, n| {
            n.branch == Branch::Hold && in_part(held(s, n), part, PARTS.2)
        });
    }
    list.cycles(design);
    list.rates(design);
    list.balls(design);
    list.heights(design);
    list.clock(design);
    list.checks(design);
    list.margins
}

fn deepest(series: &Series) -> f64 {
    series.nodes.iter().map(|n| n.depth_mm).fold(0.0, f64::max)
}

fn share(series: &Series, node: &Node) -> f64 {
    (node.depth_mm / deepest(series)).clamp(0.0, 0.999_999)
}

/// Place in the hold, 0 to 1 over its last two decades.
fn held(series: &Series, node: &Node) -> f64 {
    let whole = series.nodes.iter().map(|n| n.held_s).fold(0.0, f64::max);
    (1.0 + (node.held_s / whole).ln() / 100.0_f64.ln()).clamp(0.0, 0.999_999)
}

fn in_part(x: f64, part: usize, parts: usize) -> bool {
    (x * parts as f64) as usize == part
}

fn part_name(part: usize, parts: usize) -> String {
    format!("{} to {} %", 100 * part / parts, 100 * (part + 1) / parts)
}

struct Builder<'a, 'b> {
    problem: &'a Problem<'b>,
    curves: &'a [Curve],
    margins: Vec<Margin>,
}

impl Builder<'_, '_> {
    /// A direction in proportion to the force where the condition holds.
    fn add(&mut self, variable: Variable, label: String, within: impl Fn(&Series, &Node) -> bool) {
        self.weigh(variable, label, |s, n, (force_n, _)| if within(s, n) { force_n } else { 0.0 });
    }

    /// A direction of a weight at every node; of force (N) and slope (N/mm) there.
    fn weigh(&mut self, variable: Variable, label: String, weight: impl Fn(&Series, &Node, (f64, f64)) -> f64) {
        let problem = self.problem;
        let mut direction = DVector::zeros(problem.whitening.residuals());
        let mut entries = Vec::new();
        for (s, (series, curve)) in problem.design.series.iter().zip(self.curves).enumerate() {
            for (k, node) in series.nodes.iter().enumerate() {
                let at = problem.whitening.first(s) + k;
                if problem.used[at] {
                    direction[at] = weight(series, node, (curve.force_n[k], curve.slope_n_per_mm[k]));
                    if direction[at] != 0.0 {
                        entries.push(at);
                    }
                }
            }
        }
        if entries.len() > 2 {
            problem.whitening.apply(&mut direction);
            self.margins.push(Margin { variable, label, direction, entries });
        }
    }

    fn cycles(&mut self, design: &Design) {
        let mut cycles: Vec<i64> = design.series.iter().map(|s| s.cycle).collect();
        cycles.sort_unstable();
        cycles.dedup();
        if cycles.len() < 2 {
            return;
        }
        // what a spot keeps of the presses before: its surface lies lower, or its contact comes later
        for later in cycles.windows(2) {
            let (before, cycle) = (later[0], later[1]);
            self.weigh(Variable::Cycle, format!("contact from cycle {cycle} on"), |s, _, (_, slope_n_per_mm)| {
                if s.cycle > before { slope_n_per_mm } else { 0.0 }
            });
        }
        for cycle in cycles {
            for (branch, name) in [(Branch::Loading, "loading"), (Branch::Unloading, "unloading")] {
                self.add(Variable::Cycle, format!("cycle {cycle}, {name}"), |s, n| {
                    s.cycle == cycle && n.branch == branch
                });
            }
        }
    }

    fn rates(&mut self, design: &Design) {
        if design.rates_mm_per_s.len() < 2 {
            return;
        }
        for (rate, value) in design.rates_mm_per_s.iter().enumerate() {
            for (part, name) in ["shallow", "deep"].into_iter().enumerate() {
                self.add(Variable::Rate, format!("{value:.3} mm/s, {name}"), |s, n| {
                    s.rate == rate && n.branch == Branch::Loading && in_part(share(s, n), part, 2)
                });
            }
            for (branch, name) in [(Branch::Hold, "hold"), (Branch::Unloading, "unloading")] {
                self.add(Variable::Rate, format!("{value:.3} mm/s, {name}"), |s, n| {
                    s.rate == rate && n.branch == branch
                });
            }
        }
    }

    fn balls(&mut self, design: &Design) {
        let mut balls: Vec<usize> = design.series.iter().map(|s| s.indenter).collect();
        balls.sort_unstable();
        balls.dedup();
        if balls.len() < 2 {
            return;
        }
        for ball in balls {
            for part in 0..3 {
                self.add(Variable::Radius, format!("ball {ball}, {}", part_name(part, 3)), |s, n| {
                    s.indenter == ball && n.branch == Branch::Loading && in_part(share(s, n), part, 3)
                });
            }
        }
    }

    fn heights(&mut self, design: &Design) {
        let mut specimens: Vec<usize> = design.series.iter().map(|s| s.specimen).collect();
        specimens.sort_unstable();
        specimens.dedup();
        if specimens.len() < 2 {
            return;
        }
        for specimen in specimens {
            for part in 0..3 {
                self.add(Variable::Height, format!("specimen {specimen}, {}", part_name(part, 3)), |s, n| {
                    s.specimen == specimen && n.branch == Branch::Loading && in_part(share(s, n), part, 3)
                });
            }
        }
    }

    /// What runs without a ball on the specimen show.
    fn checks(&mut self, design: &Design) {
        for (at, check) in design.checks.iter().enumerate() {
            let first = self.problem.rows_of_check(at).start;
            for (variable, label, weights) in check.directions() {
                let mut direction = DVector::zeros(self.problem.whitening.residuals());
                direction.rows_mut(first, weights.len()).copy_from_slice(&weights);
                let entries = (0..weights.len()).filter(|k| weights[*k] != 0.0).map(|k| first + k).collect();
                self.problem.whitening.apply(&mut direction);
                self.margins.push(Margin { variable, label, direction, entries });
            }
        }
    }

    /// A zero that moves: constant over a run, by third of the session and in proportion to the clock.
    fn clock(&mut self, design: &Design) {
        let starts: Option<Vec<f64>> = design.series.iter().map(|s| s.start_s).collect();
        let Some(starts) = starts else { return };
        let (low, high) = starts.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), s| (a.min(*s), b.max(*s)));
        if high - low <= 0.0 {
            return;
        }
        let place = |s: &Series| ((s.start_s.unwrap_or(low) - low) / (high - low)).clamp(0.0, 0.999_999);
        // what all runs have alike is no matter of the clock
        let count = design.series.len() as f64;
        let mean = |of: &dyn Fn(&Series) -> f64| design.series.iter().map(of).sum::<f64>() / count;
        let middle = mean(&place);
        self.weigh(Variable::Clock, "trend of the zero".to_owned(), |s, _, _| place(s) - middle);
        for part in 0..3 {
            let name = format!("session, {}", part_name(part, 3));
            let within = |s: &Series| f64::from(u8::from(in_part(place(s), part, 3)));
            let share = mean(&within);
            self.weigh(Variable::Clock, name, |s, _, _| within(s) - share);
        }
    }
}
