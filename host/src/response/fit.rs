//! Output-error fit of a law to a recording: the whole motion is simulated from the command, and what the sensor read is compared with it.

use nalgebra::{DMatrix, DVector};

use super::law::{Law, Parameter, Structure};
use super::motion::follow;
use super::noise::Coloured;
use crate::infer::descent::{Region, Residuals, Rule, minimise};

/// A recording of command and position.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Record {
    /// Stamps, s, rising.
    pub time_s: Vec<f64>,
    /// Command from each stamp to the next, V.
    pub command_v: Vec<f64>,
    /// Position of the shaft as read, mm.
    pub position_mm: Vec<f64>,
}

impl Record {
    /// Usual distance of two stamps, s.
    #[must_use]
    pub fn step_s(&self) -> f64 {
        let mut steps: Vec<f64> = self.time_s.windows(2).map(|w| w[1] - w[0]).collect();
        steps.sort_by(f64::total_cmp);
        steps.get(steps.len() / 2).copied().unwrap_or(1.0)
    }

    /// Largest less smallest position, mm.
    #[must_use]
    pub fn travel_mm(&self) -> f64 {
        let (low, high) = ends(&self.position_mm);
        high - low
    }

    /// Largest speed over a few samples, mm/s.
    #[must_use]
    pub fn speed_mm_s(&self) -> f64 {
        const OVER: usize = 4;
        let ends = self.time_s.iter().zip(&self.position_mm);
        let later = self.time_s.iter().zip(&self.position_mm).skip(OVER);
        ends.zip(later).map(|((t, x), (t1, x1))| ((x1 - x) / (t1 - t)).abs()).fold(0.0, f64::max)
    }
}

/// Smallest and largest number.
pub(super) fn ends(values: &[f64]) -> (f64, f64) {
    values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(*v), high.max(*v)))
}

/// What is searched: the free parameters of a law, the others as they stand in it.
#[derive(Debug, Clone)]
pub struct Problem<'a> {
    /// The recording.
    pub record: &'a Record,
    /// Values of what is not searched.
    pub base: Law,
    /// What is searched.
    pub free: Vec<Parameter>,
    /// Noise that residuals are whitened by.
    pub noise: Coloured,
}

/// Where a search ended.
#[derive(Debug, Clone)]
pub struct Fitted {
    /// The law.
    pub law: Law,
    /// What was searched.
    pub free: Vec<Parameter>,
    /// Position less prediction, mm.
    pub residual_mm: Vec<f64>,
    /// The same without what their past tells.
    pub white_mm: DVector<f64>,
    /// Derivative of the whitened prediction by every coordinate (logarithms where the parameter is searched so).
    pub slopes: DMatrix<f64>,
    /// Noise that the fit believed in.
    pub noise: Coloured,
}

impl Fitted {
    /// Sum of the squared whitened residuals, mm^2.
    #[must_use]
    pub fn misfit(&self) -> f64 {
        self.white_mm.norm_squared()
    }

    /// Bayesian information criterion of the whitened residuals.
    #[must_use]
    pub fn bic(&self) -> f64 {
        let n = self.white_mm.len() as f64;
        let parameters = (self.free.len() + self.noise.coefficients.len()) as f64;
        n * (self.misfit() / n).max(f64::MIN_POSITIVE).ln() + parameters * n.ln()
    }
}

/// Parameters of a structure; the rate limit is not among them.
#[must_use]
pub fn parameters(structure: Structure) -> Vec<Parameter> {
    use Parameter::{Damping, Delay, DriveLag, Frequency, Friction, Gain, Offset, Play, Start, StartShare};
    let own: &[Parameter] = match structure {
        Structure::Spindle => &[],
        Structure::Lag | Structure::SpindleLag => &[Frequency],
        Structure::Mass => &[Frequency, Damping],
        Structure::MassLag => &[Frequency, Damping, DriveLag],
    };
    let first = [Gain, Offset].iter().chain(own);
    first.chain(&[Delay, Friction, Play, Start, StartShare]).copied().collect()
}

/// Coordinate of a value: its logarithm where it is searched so.
#[must_use]
pub fn coordinate(parameter: Parameter, value: f64) -> f64 {
    if parameter.is_logarithmic() { value.ln() } else { value }
}

/// Value at a coordinate.
#[must_use]
pub fn value(parameter: Parameter, coordinate: f64) -> f64 {
    if parameter.is_logarithmic() { coordinate.exp() } else { coordinate }
}

impl Problem<'_> {
    /// The law at a point.
    fn law(&self, x: &[f64]) -> Law {
        let mut law = self.base;
        for (parameter, x) in self.free.iter().zip(x) {
            parameter.set(&mut law, value(*parameter, *x));
        }
        law
    }

    fn residual(&self, x: &[f64]) -> Vec<f64> {
        let predicted = follow(&self.law(x), &self.record.time_s, &self.record.command_v);
        self.record.position_mm.iter().zip(predicted).map(|(y, p)| y - p).collect()
    }

    /// Bounds of a parameter.
    fn range(&self, parameter: Parameter) -> (f64, f64) {
        let record = self.record;
        let step_s = record.step_s();
        let whole_s = record.time_s.last().unwrap_or(&1.0) - record.time_s.first().unwrap_or(&0.0);
        let (low_v, high_v) = ends(&record.command_v);
        let (swing_v, travel) = ((high_v - low_v).max(1e-9), record.travel_mm().max(1e-9));
        let largest_v = low_v.abs().max(high_v.abs());
        match parameter {
            Parameter::Gain => (1e-4 * travel / swing_v / whole_s.max(1.0), 1e3 * travel / swing_v / step_s.min(1.0)),
            Parameter::Offset if self.base.structure.integrates() => (-2.0 * largest_v, 2.0 * largest_v),
            Parameter::Offset => (-1e4 * travel, 1e4 * travel),
            Parameter::Frequency => (0.1 / whole_s, 6.0 / step_s),
            Parameter::Damping => (0.01, 10.0),
            Parameter::DriveLag => (0.02 * step_s, whole_s),
            Parameter::Delay => (0.0, (0.2 * whole_s).min(1.0)),
            Parameter::Rate => (0.02 * record.speed_mm_s().max(1e-9), 20.0 * record.speed_mm_s().max(1e-9)),
            Parameter::Friction => (0.0, swing_v),
            Parameter::Play => (0.0, travel),
            Parameter::Start => (-1e4 * travel, 1e4 * travel),
            Parameter::StartShare => (-0.5, 0.5),
        }
    }

    fn region(&self) -> Region {
        Region::of(self.free.iter().map(|p| {
            let (low, high) = self.range(*p);
            (coordinate(*p, low), coordinate(*p, high))
        }))
    }

    /// Length over which a slope is taken: far above rounding, far below what the noise lets one see.
    fn reach(&self, parameter: Parameter) -> f64 {
        let travel = self.record.travel_mm();
        match parameter {
            p if p.is_logarithmic() => 1e-4,
            Parameter::Delay => 1e-3 * self.record.step_s(),
            Parameter::Friction => {
                let (low, high) = ends(&self.record.command_v);
                1e-5 * (high - low)
            }
            Parameter::StartShare => 1e-3,
            Parameter::Offset if self.base.structure.integrates() => {
                let (low, high) = ends(&self.record.command_v);
                1e-5 * (high - low)
            }
            _ => 1e-5 * travel,
        }
    }

    /// Slopes by central differences, one-sided at an end: the motion is exact, so their error is that of the third derivative.
    fn slopes(&self, x: &[f64], region: &Region) -> DMatrix<f64> {
        let columns: Vec<DVector<f64>> = (0..x.len())
            .map(|i| {
                let reach = self.reach(self.free[i]);
                let (mut low, mut high) = (x.to_vec(), x.to_vec());
                low[i] = (x[i] - reach).max(region.low[i]);
                high[i] = (x[i] + reach).min(region.high[i]);
                let between = high[i] - low[i];
                let (low, high) = (self.residual(&low), self.residual(&high));
                let slope: Vec<f64> = low.iter().zip(&high).map(|(l, h)| (l - h) / between).collect();
                self.noise.whitened(&slope)
            })
            .collect();
        DMatrix::from_columns(&columns)
    }

    /// Searches from the base, in at most `steps` steps, with a parameter held if it is named.
    #[must_use]
    pub fn search(&self, steps: usize, held: Option<Parameter>) -> Fitted {
        let mut region = self.region();
        region.held = held.and_then(|held| self.free.iter().position(|p| *p == held));
        let start: Vec<f64> = self.free.iter().map(|p| coordinate(*p, p.of(&self.base))).collect();
        let objective = Residuals {
            residual: |x: &[f64]| self.noise.whitened(&self.residual(x)),
            jacobian: |x: &[f64], _: &DVector<f64>| self.slopes(x, &region),
        };
        let rule = Rule { most_steps: steps, settled_share: 1e-8, ..Rule::default() };
        let end = minimise(&objective, &region, &start, &rule);
        let (white_mm, slopes) = end.kept.into_parts();
        Fitted {
            law: self.law(&end.x),
            free: self.free.clone(),
            residual_mm: self.residual(&end.x),
            white_mm,
            slopes,
            noise: self.noise.clone(),
        }
    }
}
