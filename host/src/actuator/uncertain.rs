//! A plant whose coefficients are known within bounds: a box.

use super::plant::Plant;
use super::polynomial::Polynomial;
use super::{Actuator, Form, Known, Pole};

/// A coefficient of the plant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Coefficient {
    /// Of `s^i` in the numerator.
    Numerator(usize),
    /// Of `s^i` in the denominator; the leading one is 1.
    Denominator(usize),
    /// Dead time.
    Delay,
}

impl Coefficient {
    /// Its name in reports: `b0`, `a1`, `delay`.
    pub fn name(self) -> String {
        match self {
            Self::Numerator(i) => format!("b{i}"),
            Self::Denominator(i) => format!("a{i}"),
            Self::Delay => "delay".to_owned(),
        }
    }
}

/// Coefficients that are not known exactly, each with its bounds; the others are the plant's.
#[derive(Debug, Clone, PartialEq)]
pub struct Uncertain {
    /// In the middle of the box, or where its values were found.
    pub plant: Plant,
    /// Which, and their bounds, the lower first.
    pub bounds: Vec<(Coefficient, f64, f64)>,
}

impl Uncertain {
    /// Every coefficient within a part of its value, as thesis section 5.6; a dead time is one of them.
    pub fn within(plant: &Plant, part: f64) -> Self {
        let around = |value: f64| (value - part * value.abs(), value + part * value.abs());
        let named = |name: fn(usize) -> Coefficient, list: &[f64]| {
            let own = list.iter().enumerate().filter(|(_, value)| **value != 0.0);
            own.map(|(i, value)| (name(i), around(*value).0, around(*value).1)).collect::<Vec<_>>()
        };
        let mut bounds = named(Coefficient::Numerator, plant.numerator.coefficients());
        bounds.extend(named(Coefficient::Denominator, &plant.denominator.coefficients()[..plant.order()]));
        if plant.delay_s > 0.0 {
            let (low, high) = around(plant.delay_s);
            bounds.push((Coefficient::Delay, low, high));
        }
        bounds.retain(|(_, low, high)| high > low);
        Self { plant: plant.clone(), bounds }
    }

    /// The plant with values for its uncertain coefficients, in their order.
    pub fn at(&self, values: &[f64]) -> Plant {
        let mut numerator = self.plant.numerator.coefficients().to_vec();
        let mut denominator = self.plant.denominator.coefficients().to_vec();
        let mut delay_s = self.plant.delay_s;
        for ((which, _, _), value) in self.bounds.iter().zip(values) {
            match *which {
                Coefficient::Numerator(i) => numerator[i] = *value,
                Coefficient::Denominator(i) => denominator[i] = *value,
                Coefficient::Delay => delay_s = *value,
            }
        }
        Plant { numerator: Polynomial::new(numerator), denominator: Polynomial::new(denominator), delay_s }
    }

    /// The plant's own values of the uncertain coefficients.
    pub fn values(&self) -> Vec<f64> {
        let value = |which: Coefficient| match which {
            Coefficient::Numerator(i) => self.plant.numerator.at(i),
            Coefficient::Denominator(i) => self.plant.denominator.at(i),
            Coefficient::Delay => self.plant.delay_s,
        };
        self.bounds.iter().map(|(which, _, _)| value(*which)).collect()
    }

    /// Values of all corners of the box.
    pub fn corners(&self) -> Vec<Vec<f64>> {
        let corner = |bits: usize| {
            let one =
                |(i, (_, low, high)): (usize, &(Coefficient, f64, f64))| if bits >> i & 1 == 0 { *low } else { *high };
            self.bounds.iter().enumerate().map(one).collect()
        };
        (0..1 << self.bounds.len()).map(corner).collect()
    }
}

/// Polynomial of `gain / (s^m prod(1 - s/p))`, written with a monic denominator.
pub(super) fn expanded(gain: f64, poles: &[Pole], delay_s: f64) -> Plant {
    let mut denominator = Polynomial::new(vec![1.0]);
    let mut numerator = gain;
    for pole in poles {
        let factor = match pole {
            Pole::Real(real) => Polynomial::new(vec![-real.value, 1.0]),
            Pole::Pair(real, imaginary) => {
                Polynomial::new(vec![real.value.powi(2) + imaginary.value.powi(2), -2.0 * real.value, 1.0])
            }
        };
        if factor.at(0) != 0.0 {
            numerator *= factor.at(0);
        }
        denominator = &denominator * &factor;
    }
    Plant { numerator: Polynomial::new(vec![numerator]), denominator, delay_s }
}

impl Uncertain {
    /// The box of an actuator's intervals: none of a number without one. Of gain and poles it is the smallest box of coefficients
    /// that holds every combination, which also holds others.
    pub fn known(actuator: &Actuator) -> Self {
        let plant = actuator.plant();
        let mut bounds = match &actuator.form {
            Form::Coefficients { numerator, denominator } => of_coefficients(numerator, denominator),
            Form::Poles { gain, poles } => of_poles(gain, poles),
        };
        if let Some((low, high)) = actuator.delay_s.interval95 {
            bounds.push((Coefficient::Delay, low, high));
        }
        bounds.retain(|(_, low, high)| high > low);
        Self { plant, bounds }
    }
}

/// Bounds of monic coefficients: an uncertain leading one widens the others.
fn of_coefficients(numerator: &[Known], denominator: &[Known]) -> Vec<(Coefficient, f64, f64)> {
    let ends = |known: &Known| known.interval95.unwrap_or((known.value, known.value));
    let lead = ends(&denominator[0]);
    let over = |(low, high): (f64, f64)| {
        let all = [low / lead.0, low / lead.1, high / lead.0, high / lead.1];
        (all.into_iter().fold(f64::INFINITY, f64::min), all.into_iter().fold(f64::NEG_INFINITY, f64::max))
    };
    let mut bounds = Vec::new();
    for (i, known) in numerator.iter().rev().enumerate() {
        let (low, high) = over(ends(known));
        bounds.push((Coefficient::Numerator(i), low, high));
    }
    for (i, known) in denominator[1..].iter().rev().enumerate() {
        let (low, high) = over(ends(known));
        bounds.push((Coefficient::Denominator(i), low, high));
    }
    bounds
}

/// Bounds of the coefficients over all corners of gain and poles. Every coefficient is linear in the gain and in each real pole, and
/// falls with the real part of a pair as long as all poles are on the left, so that none is beyond its corners.
fn of_poles(gain: &Known, poles: &[Pole]) -> Vec<(Coefficient, f64, f64)> {
    let ends = |known: &Known| known.interval95.map_or_else(|| vec![known.value], |(low, high)| vec![low, high]);
    let exactly = Known::exactly;
    let mut cases: Vec<(f64, Vec<Pole>)> = ends(gain).into_iter().map(|gain| (gain, Vec::new())).collect();
    for pole in poles {
        let choices: Vec<Pole> = match pole {
            // A pole at 0 stays there: the plant integrates.
            Pole::Real(real) if real.value == 0.0 => vec![Pole::Real(exactly(0.0))],
            Pole::Real(real) => ends(real).into_iter().map(|value| Pole::Real(exactly(value))).collect(),
            Pole::Pair(real, imaginary) => {
                let pairs = ends(real).into_iter().flat_map(|r| ends(imaginary).into_iter().map(move |i| (r, i)));
                pairs.map(|(r, i)| Pole::Pair(exactly(r), exactly(i))).collect()
            }
        };
        let with = |(gain, list): &(f64, Vec<Pole>)| {
            let (gain, list) = (*gain, list.clone());
            choices.iter().map(move |pole| (gain, list.iter().copied().chain([*pole]).collect())).collect::<Vec<_>>()
        };
        cases = cases.iter().flat_map(with).collect();
    }
    let plants: Vec<Plant> = cases.iter().map(|(gain, poles)| expanded(*gain, poles, 0.0)).collect();
    let over = |of: &dyn Fn(&Plant) -> f64| {
        let values = plants.iter().map(of);
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
    };
    let order = plants.first().map_or(0, Plant::order);
    let numerator = over(&|plant| plant.numerator.at(0));
    let mut bounds = vec![(Coefficient::Numerator(0), numerator.0, numerator.1)];
    for i in 0..order {
        let (low, high) = over(&|plant| plant.denominator.at(i));
        bounds.push((Coefficient::Denominator(i), low, high));
    }
    bounds
}
