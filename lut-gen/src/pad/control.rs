//! Control curves: the yield stress over travel with which a block that yields feels like a foam.
//!
//! A finger on the foam has a force and a contact area at every travel. A finger on a block whose
//! yield stress follows a curve has others; the curve is chosen so that both are met as well as can
//! be, by least squares (thesis section 4.3, Figs. 57 and 58). Beside it stand the averages of the
//! foam's own Mises stress, which need no search.

use faer::Mat;
use faer::linalg::solvers::SolveLstsq;
use rayon::prelude::*;

use super::body::Body;
use super::body::section::Section;
use super::error::{PadError, demand};
use super::press::{Now, Press, Side};
use super::state::State;

/// What a finger feels: force and area at some travels.
#[derive(Debug, Clone, PartialEq)]
pub struct Felt {
    /// Travels (mm), rising.
    pub travel_mm: Vec<f64>,
    /// Force (N).
    pub force_n: Vec<f64>,
    /// Area of the contact as its print shows it, flat (mm2; in the plane its width, mm).
    pub area_mm2: Vec<f64>,
}

/// Averages of Mises' stress over the nodes of the lower body (MPa).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Averages {
    /// Arithmetic mean.
    pub mean: f64,
    /// Median.
    pub median: f64,
    /// Geometric mean over the nodes that bear stress.
    pub geometric: f64,
}

/// A yield stress over travel.
#[derive(Debug, Clone, PartialEq)]
pub enum Curve {
    /// `a u + b u^2 + c u^3` (MPa, travel u in mm): the thesis' three coefficients.
    Cubic([f64; 3]),
    /// Straight lines between knots (mm, MPa), from (0, 0) on.
    Knots(Vec<(f64, f64)>),
}

/// How far what is felt is from what is wanted: root mean square over that of what is wanted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Error {
    /// Of the force.
    pub force: f64,
    /// Of the area.
    pub area: f64,
}

/// A block that yields under a finger.
pub struct Display {
    /// Plane or ring.
    pub section: Section,
    /// The finger.
    pub finger: Body,
    /// The block; its material is plastic.
    pub block: Body,
    /// Yield stress that a curve does not fall below (MPa): of nothing there is no equilibrium.
    pub least_mpa: f64,
    /// Longest step of a press (mm).
    pub step_mm: f64,
}

/// A curve that was searched.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// The curve.
    pub curve: Curve,
    /// What it feels like.
    pub felt: Felt,
    /// How far that is from what was wanted.
    pub error: Error,
    /// Rounds of the search.
    pub rounds: usize,
    /// The last round changed the error by less than [`SETTLED`].
    pub settled: bool,
}

/// Most rounds of a search.
const ROUNDS: usize = 12;
/// Relative change of the combined error that ends a search.
pub const SETTLED: f64 = 2e-3;
/// Step of a derivative, as a part of the yield stress at the end of the travel: contact edges that pass nodes make what is
/// felt a little uneven.
const NUDGE: f64 = 0.1;
/// Damping over the largest column: what no press feels stays where it is.
const DAMPING: f64 = 1e-3;

impl Felt {
    /// Of the states of a press in the plane or of a ring.
    #[must_use]
    pub fn of(section: Section, states: &[State]) -> Self {
        let each = |value: fn(&State) -> f64| -> Vec<f64> { states.iter().map(value).collect() };
        let print = |radius: f64| match section {
            Section::Plane => 2.0 * radius,
            Section::Ring => std::f64::consts::PI * radius * radius,
        };
        let area_mm2 = each(|s| s.half_width_mm).into_iter().map(print).collect();
        Self { travel_mm: each(|s| s.travel_mm), force_n: each(|s| s.force_n), area_mm2 }
    }

    /// How far it is from what is wanted at the same travels.
    #[must_use]
    pub fn error(&self, wanted: &Felt) -> Error {
        let part = |own: &[f64], wanted: &[f64]| {
            let square: f64 = own.iter().zip(wanted).map(|(a, b)| (a - b).powi(2)).sum();
            (square / wanted.iter().map(|b| b * b).sum::<f64>()).sqrt()
        };
        Error { force: part(&self.force_n, &wanted.force_n), area: part(&self.area_mm2, &wanted.area_mm2) }
    }

    /// Differences to what is wanted, both kinds alike in size.
    fn left(&self, wanted: &Felt) -> Vec<f64> {
        let each = |own: &[f64], wanted: &[f64]| -> Vec<f64> {
            let size = wanted.iter().map(|b| b * b).sum::<f64>().sqrt();
            own.iter().zip(wanted).map(|(a, b)| (b - a) / size).collect()
        };
        let mut left = each(&self.force_n, &wanted.force_n);
        left.extend(each(&self.area_mm2, &wanted.area_mm2));
        left
    }
}

impl Error {
    /// Both together.
    #[must_use]
    pub fn combined(&self) -> f64 {
        (0.5 * (self.force * self.force + self.area * self.area)).sqrt()
    }
}

impl Averages {
    /// Over the nodes of a state's lower body; `None` where that is rigid.
    #[must_use]
    pub fn of(state: &State) -> Option<Self> {
        let mut stresses: Vec<f64> = state.mises_mpa.get(state.lower..)?.to_vec();
        stresses.sort_by(f64::total_cmp);
        let count = stresses.len();
        let median = 0.5 * (stresses.get(count.checked_sub(1)? / 2)? + stresses.get(count / 2)?);
        let bearing: Vec<f64> = stresses.iter().copied().filter(|s| *s > 0.0).collect();
        let logarithm = bearing.iter().map(|s| s.ln()).sum::<f64>() / bearing.len().max(1) as f64;
        let geometric = if bearing.is_empty() { 0.0 } else { logarithm.exp() };
        Some(Self { mean: stresses.iter().sum::<f64>() / count as f64, median, geometric })
    }
}

impl Curve {
    /// Yield stress at a travel (MPa).
    #[must_use]
    pub fn at(&self, u: f64) -> f64 {
        match self {
            Curve::Cubic([a, b, c]) => u * (a + u * (b + u * c)),
            Curve::Knots(knots) => {
                let (mut from, mut last) = ((0.0, 0.0), (0.0, 0.0));
                for &to in knots {
                    if u <= to.0 {
                        let part = if to.0 > from.0 { (u - from.0) / (to.0 - from.0) } else { 1.0 };
                        return from.1 + part * (to.1 - from.1);
                    }
                    (last, from) = (from, to);
                }
                // beyond the last knot the last line goes on
                let slope = if from.0 > last.0 { (from.1 - last.1) / (from.0 - last.0) } else { 0.0 };
                from.1 + slope * (u - from.0)
            }
        }
    }

    /// Its coefficients.
    fn coefficients(&self) -> Vec<f64> {
        match self {
            Curve::Cubic(list) => list.to_vec(),
            Curve::Knots(knots) => knots.iter().map(|knot| knot.1).collect(),
        }
    }

    /// The same with other coefficients.
    fn with(&self, coefficients: &[f64]) -> Self {
        match self {
            Curve::Cubic(_) => Curve::Cubic(std::array::from_fn(|i| coefficients[i])),
            Curve::Knots(knots) => Curve::Knots(knots.iter().zip(coefficients).map(|(k, c)| (k.0, *c)).collect()),
        }
    }

    /// What a coefficient of it counts in MPa at the end of the travel.
    fn sizes(&self, most_mm: f64) -> Vec<f64> {
        match self {
            Curve::Cubic(_) => (1..=3).map(|power| most_mm.powi(power)).collect(),
            Curve::Knots(knots) => vec![1.0; knots.len()],
        }
    }

    /// The cubic nearest to stresses (MPa) at travels (mm), by least squares.
    ///
    /// # Errors
    /// [`PadError::Value`] for fewer than three.
    pub fn cubic_through(travel_mm: &[f64], stress_mpa: &[f64]) -> Result<Self, PadError> {
        let count = travel_mm.len().min(stress_mpa.len());
        demand(count >= 3, "the number of travels of a cubic", count as f64, "3 or more")?;
        let powers: Vec<Vec<f64>> =
            (1..=3).map(|power| travel_mm[..count].iter().map(|u| u.powi(power)).collect()).collect();
        let solved = least_squares(&powers, &stress_mpa[..count], 0.0);
        Ok(Curve::Cubic(std::array::from_fn(|k| solved[k])))
    }
}

impl Display {
    /// What a curve feels like.
    ///
    /// # Errors
    /// [`PadError`].
    pub fn felt(&self, curve: &Curve, travel_mm: &[f64]) -> Result<Felt, PadError> {
        let yields = |now: Now| curve.at(now.travel_mm).max(self.least_mpa);
        let mut press = Press::new(self.section, Side::Soft(self.finger.clone()), Side::Soft(self.block.clone()));
        press.yields = &yields;
        press.step_mm = self.step_mm;
        Ok(Felt::of(self.section, &press.solve(travel_mm)?))
    }

    /// The curve of this kind that feels nearest to what is wanted, from one that is near: Gauss and Newton's method with
    /// difference quotients, shortened while the error rises. `told` hears of every round its error.
    ///
    /// # Errors
    /// [`PadError`] of the first press.
    pub fn search(&self, begin: &Curve, wanted: &Felt, told: &mut dyn FnMut(&Error)) -> Result<Found, PadError> {
        let travels = &wanted.travel_mm;
        let most_mm = travels.last().copied().unwrap_or(0.0);
        let sizes = begin.sizes(most_mm);
        let mut curve = begin.clone();
        let mut felt = self.felt(&curve, travels)?;
        let mut found = felt.error(wanted);
        told(&found);
        let (mut rounds, mut settled) = (0, false);
        while rounds < ROUNDS && !settled {
            rounds += 1;
            let own = curve.coefficients();
            let level = curve.at(most_mm).abs().max(self.least_mpa);
            let column = |k: usize| {
                let mut moved = own.clone();
                let step = NUDGE * level / sizes[k];
                moved[k] += step;
                let there = self.felt(&curve.with(&moved), travels)?;
                // in parts of what the coefficient counts, so that all columns are alike
                let pairs = felt.left(wanted).into_iter().zip(there.left(wanted));
                Ok::<_, PadError>(pairs.map(|(now, there)| (now - there) / NUDGE).collect())
            };
            let columns: Vec<Vec<f64>> = (0..own.len()).into_par_iter().map(column).collect::<Result<_, _>>()?;
            let change = least_squares(&columns, &felt.left(wanted), DAMPING);
            let mut part = 1.0;
            let before = found.combined();
            loop {
                let moved: Vec<f64> = (0..own.len()).map(|k| own[k] + part * change[k] * level / sizes[k]).collect();
                let there = curve.with(&moved);
                // a curve that cannot be pressed is too far
                if let Ok(next) = self.felt(&there, travels) {
                    let error = next.error(wanted);
                    if error.combined() < before {
                        (curve, felt, found) = (there, next, error);
                        break;
                    }
                }
                part *= 0.4;
                if part < 0.02 {
                    break;
                }
            }
            told(&found);
            settled = before - found.combined() < SETTLED * before;
        }
        Ok(Found { curve, felt, error: found, rounds, settled })
    }
}

/// Least squares over columns, damped by a part of the longest of them.
fn least_squares(columns: &[Vec<f64>], of: &[f64], damping: f64) -> Vec<f64> {
    let length = |column: &Vec<f64>| column.iter().map(|v| v * v).sum::<f64>().sqrt();
    let damping = damping * columns.iter().map(length).fold(0.0, f64::max);
    let (rows, count) = (of.len(), columns.len());
    let matrix = Mat::from_fn(rows + count, count, |i, k| match i.checked_sub(rows) {
        None => columns[k][i],
        Some(j) if j == k => damping,
        Some(_) => 0.0,
    });
    let side = Mat::from_fn(rows + count, 1, |i, _| of.get(i).copied().unwrap_or(0.0));
    let solved = matrix.col_piv_qr().solve_lstsq(&side);
    (0..count).map(|k| solved[(k, 0)]).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_cubic_goes_through_its_own_values() {
        let travels = [0.5, 1.0, 2.0, 3.0];
        let cubic = Curve::Cubic([1e-3, -2e-4, 3e-4]);
        let stresses: Vec<f64> = travels.iter().map(|u| cubic.at(*u)).collect();
        let Curve::Cubic(found) = Curve::cubic_through(&travels, &stresses).unwrap() else { return };
        for (a, b) in found.iter().zip([1e-3, -2e-4, 3e-4]) {
            assert!((a - b).abs() < 1e-12, "{found:?}");
        }
        assert!(Curve::cubic_through(&travels[..2], &stresses).unwrap_err().to_string().contains("3 or more"));
    }

    #[test]
    fn knots_are_joined_by_lines_and_the_last_goes_on() {
        let knots = Curve::Knots(vec![(1.0, 2.0), (3.0, 3.0)]);
        for (u, mpa) in [(0.0, 0.0), (0.5, 1.0), (1.0, 2.0), (2.0, 2.5), (5.0, 4.0)] {
            assert!((knots.at(u) - mpa).abs() < 1e-12, "{u}");
        }
    }

    #[test]
    fn an_error_is_a_part_of_what_is_wanted() {
        let felt = |f: f64| Felt { travel_mm: vec![1.0, 2.0], force_n: vec![f, 2.0 * f], area_mm2: vec![5.0, 8.0] };
        let error = felt(1.1).error(&felt(1.0));
        assert!((error.force - 0.1).abs() < 1e-12 && error.area == 0.0);
        assert!((error.combined() - 0.1 / 2_f64.sqrt()).abs() < 1e-12);
    }
}
