//! Least squares of whitened residuals over the parameters of the base law and of effects.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::channel::Reading;
use super::design::{Design, Series};
use super::effect::Effect;
use super::law::{Law, Setting};
use super::whiten::Whitening;
use crate::diagnose::evidence;
use crate::infer::descent::{Region, Residuals, Rule, minimise};
use crate::infer::evidence::{Linearised, Prior};
use crate::infer::quantity::Coordinate;
use crate::infer::sets::Fitted;

/// Data with their whitening.
#[derive(Debug, Clone)]
pub struct Problem<'a> {
    /// Data.
    pub design: &'a Design,
    /// Noise.
    pub whitening: Whitening,
    /// Runs that are fitted; the others are 0 in every residual, and [`Whitening::for_runs`] takes them for none.
    pub used: Vec<bool>,
}

/// A fit.
#[derive(Debug, Clone)]
pub struct Fit {
    /// Law with its parameters.
    pub law: Law,
    /// Its effects.
    pub effects: Vec<&'static Effect>,
    /// What was searched.
    pub coordinates: Vec<Coordinate>,
    /// Where it ended.
    pub x: DVector<f64>,
    /// Whitened measured less predicted.
    pub residual: DVector<f64>,
    /// Derivative of the prediction, whitened.
    pub jacobian: DMatrix<f64>,
    /// Sum of squares.
    pub square: f64,
    /// An effect's parameter ended at a bound that is not its null, and the data want it beyond.
    pub at_bound: bool,
}

/// A parameter with its 95 % interval.
pub type Estimate = (&'static str, f64, (f64, f64));

/// Standard deviations from which data want a parameter beyond its bound. Without such a pull the bound is what they say
/// nothing against, as a time constant far beyond the longest run.
const PULL: f64 = 2.0;

/// A parameter's column less what the others take up of it.
pub(super) fn alone(jacobian: &DMatrix<f64>, at: usize) -> DVector<f64> {
    let others = evidence::basis(&jacobian.clone().remove_column(at));
    let own = jacobian.column(at).into_owned();
    &own - &others * others.tr_mul(&own)
}

/// True where the data want a parameter, `range` wide, beyond where it is: more than noise does, and by more than it could
/// gain on a way as long as its range.
fn pulls(jacobian: &DMatrix<f64>, residual: &DVector<f64>, at: usize, range: f64) -> bool {
    let own = alone(jacobian, at);
    let pull = own.dot(residual).abs();
    pull > PULL * own.norm() && pull * range > PULL * PULL
}

/// When a fit has ended: its sum of squares is that of a chi-square.
const RULE: Rule = Rule { most_steps: 25, settled: 1e-4, settled_share: 1e-7, rival: None };

/// What a parameter of the base is known by beforehand, as a part of its range: it counts where the commands do not
/// tell of it.
const UNTOLD: f64 = 0.05;

/// Coordinates of a law.
#[must_use]
pub fn coordinates(law: &Law) -> Vec<Coordinate> {
    let base = law.channel.base().iter().map(|p| {
        let of = |value: f64| if p.logarithmic { value.ln() } else { value };
        let ends = (of(p.bounds.0), of(p.bounds.1));
        // what a command of one level does not tell is known to a part of its range
        let prior = Prior::Normal { mean: of(p.nominal), deviation: UNTOLD * (ends.1 - ends.0) };
        let step = if p.logarithmic { 1e-4 } else { 1e-5 * (p.bounds.1 - p.bounds.0).min(1.0) };
        Coordinate { name: p.name, ends, logarithmic: p.logarithmic, prior, null: None, step }
    });
    let effects = law.settings.iter().flat_map(|s| s.effect.quantities).map(|q| {
        let step = if q.logarithmic { 1e-3 } else { 0.01 * (q.plausible - q.null.unwrap_or(0.0)).abs() };
        Coordinate::of_quantity(q, step)
    });
    base.chain(effects).collect()
}

fn point(law: &Law, list: &[Coordinate]) -> DVector<f64> {
    let values = law.base.iter().chain(law.settings.iter().flat_map(|s| &s.values));
    DVector::from_iterator(list.len(), values.zip(list).map(|(value, c)| c.of(*value)))
}

/// A law with its parameters at a point.
pub(super) fn at(law: &Law, list: &[Coordinate], x: &DVector<f64>) -> Law {
    let mut out = law.clone();
    let slots = out.base.iter_mut().chain(out.settings.iter_mut().flat_map(|s| &mut s.values));
    for ((slot, c), x) in slots.zip(list).zip(x.iter()) {
        *slot = c.value(*x);
    }
    out
}

impl<'a> Problem<'a> {
    /// Measured less predicted in the channel's unit, 0 where nothing is compared or fitted.
    #[must_use]
    pub fn plain(&self, law: &Law) -> DVector<f64> {
        self.gathered(|series| law.predict(series), |measured, predicted| measured - predicted)
    }

    /// What a function of all runs gives at every sample, from what was measured and what `each`
    /// has of a run, 0 where nothing is compared or fitted. Runs that were told the same are asked
    /// once.
    fn gathered(&self, each: impl Fn(&Series) -> Vec<f64>, of: impl Fn(f64, f64) -> f64) -> DVector<f64> {
        let mut out = DVector::zeros(self.design.samples());
        let mut known: Vec<Option<Vec<f64>>> = vec![None; self.design.series.len()];
        let mut first = 0;
        for (s, series) in self.design.series.iter().enumerate() {
            if self.used[s] {
                let own = known[self.design.first_alike[s]].get_or_insert_with(|| each(series));
                for (k, y) in own.iter().enumerate().filter(|(k, _)| series.compared[*k]) {
                    out[first + k] = of(series.output[k], *y);
                }
            }
            first += series.time_s.len();
        }
        out
    }

    /// All runs of a design, every sample alike: errors in the channel's unit.
    #[must_use]
    pub fn unweighted(design: &'a Design) -> Self {
        Self { design, whitening: Whitening::none(design.samples()), used: vec![true; design.series.len()] }
    }

    /// The same data of which some runs count only.
    #[must_use]
    pub fn for_runs(&self, used: Vec<bool>) -> Self {
        Self { whitening: self.whitening.for_runs(&used), used, ..self.clone() }
    }

    /// The same, whitened.
    #[must_use]
    pub fn residual(&self, law: &Law) -> DVector<f64> {
        let mut out = self.plain(law);
        self.whitening.apply(&mut out);
        out
    }

    /// Derivative of the prediction, whitened: of gain and zero as they are, else by central differences.
    pub(super) fn jacobian(&self, law: &Law, list: &[Coordinate], x: &DVector<f64>) -> DMatrix<f64> {
        let Reading { gain, zero } = self.design.channel.reading();
        let columns: Vec<DVector<f64>> = (0..list.len())
            .into_par_iter()
            .map(|j| {
                let mut column = if gain == Some(j) {
                    let here = at(law, list, x);
                    self.gathered(|series| here.happens(series), |_, happened| happened)
                } else if zero == j {
                    self.gathered(|series| vec![1.0; series.time_s.len()], |_, one| one)
                } else {
                    self.difference(law, list, x, j)
                };
                self.whitening.apply(&mut column);
                column
            })
            .collect();
        DMatrix::from_columns(&columns)
    }

    /// Central difference of the prediction over a parameter.
    fn difference(&self, law: &Law, list: &[Coordinate], x: &DVector<f64>, j: usize) -> DVector<f64> {
        let (low, high) = list[j].ends;
        let (mut up, mut down) = (x.clone(), x.clone());
        up[j] = (x[j] + list[j].step).min(high);
        down[j] = (x[j] - list[j].step).max(low);
        let span = (up[j] - down[j]).max(f64::MIN_POSITIVE);
        (self.plain(&at(law, list, &down)) - self.plain(&at(law, list, &up))) / span
    }

    /// Fits all parameters of a law, beginning where they are (Levenberg and Marquardt, inside the bounds).
    #[must_use]
    pub fn fit(&self, from: &Law) -> Fit {
        self.fit_of(from, coordinates(from))
    }

    /// The same of the base's parameters only, those of effects where they are.
    #[must_use]
    pub fn fit_base(&self, from: &Law) -> Fit {
        let mut list = coordinates(from);
        list.truncate(from.base.len());
        self.fit_of(from, list)
    }

    /// Fits some of a law's first parameters.
    fn fit_of(&self, from: &Law, list: Vec<Coordinate>) -> Fit {
        self.fit_by(&RULE, from, list)
    }

    fn fit_by(&self, rule: &Rule, from: &Law, list: Vec<Coordinate>) -> Fit {
        let objective = Residuals {
            residual: |x: &[f64]| self.residual(&at(from, &list, &DVector::from_column_slice(x))),
            jacobian: |x: &[f64], _: &DVector<f64>| self.jacobian(from, &list, &DVector::from_column_slice(x)),
        };
        let region = Region::of(list.iter().map(|c| c.ends));
        let end = minimise(&objective, &region, point(from, &list).as_slice(), rule);
        let (x, (residual, jacobian)) = (DVector::from_vec(end.x), end.kept.into_parts());
        let ended = (from.base.len()..list.len()).filter(|at| list[*at].is_at_bound(x[*at]));
        let at_bound = ended.into_iter().any(|at| pulls(&jacobian, &residual, at, list[at].ends.1 - list[at].ends.0));
        Fit {
            law: at(from, &list, &x),
            effects: from.settings.iter().map(|s: &Setting| s.effect).collect(),
            square: residual.norm_squared(),
            coordinates: list,
            x,
            residual,
            jacobian,
            at_bound,
        }
    }

    /// The base law as whoever has no diagnosis fits it: without effects, every sample alike
    /// (`docs/decisions/0002-plain-fits.md`), the better one of searches from a law and from the nominal one.
    #[must_use]
    pub fn plain_base(design: &Design, used: Vec<bool>, from: &Law) -> Law {
        let rule = Rule { settled: 0.0, ..RULE };
        let problem = Problem { used, ..Problem::unweighted(design) };
        let fit = |law: &Law| problem.fit_by(&rule, law, coordinates(law));
        let nominal = fit(&Law::nominal(design.channel));
        let own = fit(&Law { settings: Vec::new(), ..from.clone() });
        if own.square < nominal.square { own.law } else { nominal.law }
    }

    /// A law where it stands, as if it were a fit.
    #[must_use]
    pub fn standing(&self, law: &Law) -> Fit {
        let list = coordinates(law);
        let x = point(law, &list);
        let residual = self.residual(law);
        Fit {
            law: law.clone(),
            effects: law.settings.iter().map(|s: &Setting| s.effect).collect(),
            square: residual.norm_squared(),
            jacobian: self.jacobian(law, &list, &x),
            coordinates: list,
            x,
            residual,
            at_bound: false,
        }
    }
}

impl Fit {
    /// Sentences about parameters of the base that ended at what they may be.
    pub(super) fn at_ends(&self) -> impl Iterator<Item = String> {
        let base = self.coordinates.iter().zip(self.x.iter()).take(self.law.base.len());
        let ended = base.filter(|(c, x)| (*x - c.ends.0).min(c.ends.1 - *x) < 1e-3 * (c.ends.1 - c.ends.0));
        ended.map(|(c, x)| {
            let (low, high) = (c.value(c.ends.0), c.value(c.ends.1));
            format!(
                "{} ended at {:.3}; expected between {low} and {high}: a zero or a unit may be wrong",
                c.name,
                c.value(*x)
            )
        })
    }
}

impl Fitted for Fit {
    type Effect = &'static Effect;

    fn effects(&self) -> &[&'static Effect] {
        &self.effects
    }

    fn linearised<'a>(&'a self, known: &'a DMatrix<f64>) -> Linearised<'a> {
        let own = self.coordinates.iter().zip(self.x.iter());
        let parameters = own.map(|(c, x)| c.at(*x));
        Linearised { residual: &self.residual, jacobian: &self.jacobian, parameters: parameters.collect(), known }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::display::channel::Channel;
    use crate::diagnose::display::design::first_alike;
    use crate::diagnose::display::effect::{coil_heating, delay, gap, pulp_size, sensor_creep};

    fn steps(channel: Channel, height: f64) -> Series {
        let time_s: Vec<f64> = (0..150).map(|k| 0.02 * f64::from(k)).collect();
        let input: Vec<f64> = time_s.iter().map(|t| if t % 1.0 < 0.1 { 0.4 } else { height }).collect();
        Series {
            file: String::new(),
            channel,
            output: input.iter().map(|x| 1.1 * x).collect(),
            compared: time_s.iter().map(|t| *t > 0.3).collect(),
            time_s,
            input,
            yield_kpa: Vec::new(),
            is_answered: false,
            left: [Vec::new(), Vec::new()],
            gap_ratio: 1.5,
            gap_mm: 3.0,
            condition: 0,
            hold_out: false,
        }
    }

    /// At a place that is no optimum; the second run repeats the first one, the third one is another.
    #[test]
    fn gain_and_zero_have_the_derivatives_that_differences_give() {
        let setting = |effect, values: &[f64]| Setting { effect, values: values.to_vec() };
        for (channel, settings) in [
            (Channel::Position, vec![setting(&delay::EFFECT, &[0.03])]),
            (Channel::Force, vec![setting(&sensor_creep::LOGARITHMIC, &[0.05])]),
            (Channel::Current, vec![setting(&coil_heating::EFFECT, &[0.2, 5.0])]),
            (Channel::Flux, vec![setting(&gap::EFFECT, &[0.1])]),
            (Channel::Pulp, vec![setting(&pulp_size::EFFECT, &[1.1])]),
        ] {
            let series = vec![steps(channel, 1.9), steps(channel, 1.9), steps(channel, 1.2)];
            let first_alike = first_alike(&series);
            assert_eq!(first_alike, [0, 0, 2]);
            let design =
                Design { channel, series, first_alike, conditions: Vec::new(), span: 1.0, messages: Vec::new() };
            let law = Law { settings, ..Law::nominal(channel) };
            let (list, problem) = (coordinates(&law), Problem::unweighted(&design));
            let x = point(&law, &list);
            let jacobian = problem.jacobian(&law, &list, &x);
            for j in 0..list.len() {
                let difference = problem.difference(&law, &list, &x, j);
                let far = (jacobian.column(j) - &difference).norm();
                // a central difference of a line has the rounding of 1e-16 over twice 1e-5, of some hundred samples
                assert!(far <= 1e-9 * difference.norm().max(1.0), "{channel:?} {}: {far}", list[j].name);
            }
            let plain = problem.plain(&law);
            let alone = |s: usize| law.predict(&design.series[s]);
            for (s, k) in [(0, 40), (1, 40), (2, 77)] {
                let own = design.series[s].output[k] - alone(s)[k];
                assert_eq!(plain[design.first(s) + k], own, "{channel:?} {s} {k}");
            }
            assert_eq!(plain[design.first(1)], 0.0);
        }
    }
}
