//! A small nonlinear programme for `slsqp` and `cobyla`: the largest of some costs is least while some limits hold.
//!
//! Several costs become one by a variable that is at least as large as each of them; so a worst case keeps its slopes where
//! the worst changes.

use std::cell::RefCell;

/// What a point is worth.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Values {
    /// The largest of them is to be least; at least one.
    pub costs: Vec<f64>,
    /// Each is to be at most 0.
    pub limits: Vec<f64>,
}

impl Values {
    /// The largest cost.
    pub fn cost(&self) -> f64 {
        self.costs.iter().copied().fold(f64::NEG_INFINITY, f64::max)
    }

    /// By how much the worst limit is broken; 0 if none is.
    pub fn broken(&self) -> f64 {
        self.limits.iter().copied().fold(0.0, f64::max)
    }

    /// True if this is to be preferred: fewer broken limits beyond `slack` first, then the cost.
    pub fn better(&self, other: &Self, slack: f64) -> bool {
        let (own, others) = (self.broken().max(slack), other.broken().max(slack));
        if own == others { self.cost() < other.cost() } else { own < others }
    }
}

/// Variables of about unit size, with bounds.
pub(super) struct Programme<'a> {
    /// Costs and limits of a point; finite wherever the point is within its bounds.
    pub of: &'a dyn Fn(&[f64]) -> Values,
    /// Bounds of the variables.
    pub bounds: &'a [(f64, f64)],
    /// Step of the difference quotients.
    pub quotient: f64,
    /// Tolerance of the limits, which are searched with as much to spare.
    pub spare: f64,
    /// A point at which a limit is broken by less counts as good.
    pub slack: f64,
    best: RefCell<Option<(Vec<f64>, Values)>>,
    seen: RefCell<Option<Slopes>>,
    calls: std::cell::Cell<usize>,
}

/// Values at a point and their slopes, a row each: costs, then limits.
#[derive(Clone)]
struct Slopes {
    at: Vec<f64>,
    rows: Vec<Vec<f64>>,
}

/// Relative change of the cost at which a search ends.
const TOLERANCE: f64 = 1e-8;
/// Change of every variable at which a search ends.
const STILL: f64 = 1e-7;

impl<'a> Programme<'a> {
    /// A programme; `quotient` is the step of the difference quotients.
    pub fn new(of: &'a dyn Fn(&[f64]) -> Values, bounds: &'a [(f64, f64)], quotient: f64, spare: f64) -> Self {
        Self {
            of,
            bounds,
            quotient,
            spare,
            slack: 0.0,
            best: RefCell::new(None),
            seen: RefCell::new(None),
            calls: std::cell::Cell::new(0),
        }
    }

    /// Values at a point; the best one seen is kept.
    pub fn values(&self, x: &[f64]) -> Values {
        self.calls.set(self.calls.get() + 1);
        let x: Vec<f64> = x.iter().zip(self.bounds).map(|(x, (low, high))| x.clamp(*low, *high)).collect();
        let values = (self.of)(&x);
        let mut best = self.best.borrow_mut();
        if best.as_ref().is_none_or(|(_, known)| values.better(known, self.slack)) {
            *best = Some((x, values.clone()));
        }
        values
    }

    /// The best point so far, with its values.
    pub fn best(&self) -> Option<(Vec<f64>, Values)> {
        self.best.borrow().clone()
    }

    /// Forgets the best point.
    pub fn forget(&self) {
        *self.best.borrow_mut() = None;
    }

    /// How often a point was valued.
    pub fn calls(&self) -> usize {
        self.calls.get()
    }

    fn slopes(&self, x: &[f64]) -> Slopes {
        if let Some(seen) = self.seen.borrow().as_ref().filter(|seen| seen.at == x) {
            return seen.clone();
        }
        let lists = |values: Values| values.costs.into_iter().chain(values.limits).collect::<Vec<f64>>();
        let columns: Vec<Vec<f64>> = (0..x.len())
            .map(|i| {
                let (low, high) = self.bounds[i];
                let at = |value: f64| {
                    let mut moved = x.to_vec();
                    moved[i] = value.clamp(low, high);
                    (moved[i], lists(self.values(&moved)))
                };
                let ((a, below), (b, above)) = (at(x[i] - self.quotient), at(x[i] + self.quotient));
                below.iter().zip(&above).map(|(p, q)| (q - p) / (b - a)).collect()
            })
            .collect();
        let rows = (0..columns.first().map_or(0, Vec::len)).map(|j| columns.iter().map(|c| c[j]).collect()).collect();
        let slopes = Slopes { at: x.to_vec(), rows };
        *self.seen.borrow_mut() = Some(slopes.clone());
        slopes
    }

    /// A row of the programme at `x`: the first costs, then limits, all to be at most 0; `x` has the bound on the costs as its last
    /// element if there are several costs.
    fn row(&self, j: usize, x: &[f64], gradient: Option<&mut [f64]>) -> f64 {
        let n = self.bounds.len();
        let values = self.values(&x[..n]);
        let costs = values.costs.len();
        let several = x.len() > n;
        if let Some(gradient) = gradient {
            let slopes = self.slopes(&x[..n]);
            gradient[..n].copy_from_slice(&slopes.rows[j]);
            if several {
                gradient[n] = if j < costs { -1.0 } else { 0.0 };
            }
        }
        if j < costs {
            values.costs[j] - if several { x[n] } else { 0.0 }
        } else {
            values.limits[j - costs] + self.spare
        }
    }

    /// `slsqp` from a point.
    pub fn sqp(&self, start: &[f64], iterations: usize) {
        let n = self.bounds.len();
        let first = self.values(start);
        let (several, rows) = (first.costs.len() > 1, first.costs.len() + first.limits.len());
        let (point, bounds) = self.with_bound(start, &first);
        let objective = |x: &[f64], gradient: Option<&mut [f64]>, (): &mut ()| {
            if !several {
                return self.row(0, x, gradient);
            }
            if let Some(gradient) = gradient {
                gradient.fill(0.0);
                gradient[n] = 1.0;
            }
            x[n]
        };
        let row = |j: usize| move |x: &[f64], gradient: Option<&mut [f64]>, (): &mut ()| self.row(j, x, gradient);
        let own: Vec<_> = (usize::from(!several)..rows).map(row).collect();
        let limits: Vec<&dyn slsqp::Func<()>> = own.iter().map(|row| row as &dyn slsqp::Func<()>).collect();
        let tolerances =
            slsqp::StopTols { ftol_rel: TOLERANCE, xtol_abs: vec![STILL; point.len()], ..Default::default() };
        // Whatever its state, the best point that was seen counts.
        drop(slsqp::minimize(objective, &point, &bounds, &limits, (), iterations, Some(tolerances)));
    }

    /// `cobyla` from a point, with first steps of `reach`.
    pub fn cobyla(&self, start: &[f64], reach: f64, calls: usize) {
        let n = self.bounds.len();
        let first = self.values(start);
        let (several, rows) = (first.costs.len() > 1, first.costs.len() + first.limits.len());
        let (point, bounds) = self.with_bound(start, &first);
        // Objective and limits of one point are asked for one after the other.
        let last: RefCell<Option<(Vec<f64>, Values)>> = RefCell::new(None);
        let at = |x: &[f64]| {
            let known = last.borrow().as_ref().filter(|(at, _)| at == x).map(|(_, values)| values.clone());
            known.unwrap_or_else(|| {
                let values = self.values(&x[..n]);
                *last.borrow_mut() = Some((x.to_vec(), values.clone()));
                values
            })
        };
        let objective = |x: &[f64], (): &mut ()| if several { x[n] } else { at(x).cost() };
        let row = |j: usize| {
            let at = &at;
            move |x: &[f64], (): &mut ()| {
                let values = at(x);
                let costs = values.costs.len();
                -(if j < costs { values.costs[j] - x[n] } else { values.limits[j - costs] + self.spare })
            }
        };
        let own: Vec<_> = (if several { 0 } else { first.costs.len() }..rows).map(row).collect();
        let limits: Vec<&dyn cobyla::Func<()>> = own.iter().map(|row| row as &dyn cobyla::Func<()>).collect();
        let tolerances =
            cobyla::StopTols { ftol_rel: TOLERANCE, xtol_abs: vec![STILL; point.len()], ..Default::default() };
        let begin = cobyla::RhoBeg::All(reach);
        drop(cobyla::minimize(objective, &point, &bounds, &limits, (), calls, begin, Some(tolerances)));
    }

    /// A start with the bound on the costs, if there are several.
    fn with_bound(&self, start: &[f64], first: &Values) -> (Vec<f64>, Vec<(f64, f64)>) {
        let (mut point, mut bounds) = (start.to_vec(), self.bounds.to_vec());
        if first.costs.len() > 1 {
            point.push(first.cost());
            bounds.push((-1e6, 1e6));
        }
        (point, bounds)
    }
}
