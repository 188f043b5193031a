//! Runs without the specimen: in air, under a known mass, on a stiff block. They show sensor and machine alone.
//!
//! In air and under a mass the force on the sensor is known. On a block that does not give way it is not, but it stands still while the ball does, so that what
//! the reading does then is the sensor's; on the way back it is what it was at the same depth on the way down; and what the depth grows by as the force does is the
//! machine's.

use lut_gen::chain::Model;
use nalgebra::DMatrix;

use crate::experiment::{Recording, Run};

use super::super::design::windows::{Branch, Node, even, growing, node};
use super::super::scatter::{Jitter, SensorNoise};
use super::super::variable::Variable;

/// What is on the sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Touched {
    /// Nothing.
    Nothing,
    /// A known load.
    Load,
    /// A ball on a stiff block.
    Block,
}

/// What such a run shows.
#[derive(Debug, Clone, PartialEq)]
pub struct Alone {
    /// What is on the sensor.
    pub touched: Touched,
    /// Force (N) on the sensor over time (s); on a block the reading stands for it.
    path: Vec<(f64, f64)>,
    /// Places of the path that are the way down to a block.
    down: usize,
    /// Readings that are compared.
    nodes: Vec<Node>,
    /// Place of each in the path.
    at: Vec<usize>,
    /// Depths that are compared.
    depths: Vec<Depth>,
    /// Radius of the ball, mm; of no matter without a block.
    ball_mm: f64,
}

/// A recorded depth on a block.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Depth {
    depth_mm: f64,
    /// Reading there, N.
    force_n: f64,
    /// Standard deviation, mm.
    sigma_mm: f64,
}

/// Windows of a run in air, of a standing force, and of the ways to a block and back.
const WINDOWS: (usize, usize, usize) = (3, 14, 12);
/// A load is known to this part of itself.
const KNOWN: f64 = 0.002;
/// The force on a block is known to this part of itself: its reading stands for it.
const LEVEL: f64 = 0.05;
/// Places of depth and force in one row of a recording differ by less than this, mm.
const BESIDE_MM: f64 = 0.003;
/// Where the surface of a block is: unknown to this, mm.
const SURFACE_MM: f64 = 0.5;
/// Reduced modulus of a block that gives way as far as a stiff one does, MPa.
const BLOCK_MPA: f64 = 1000.0;
/// Resolution of a recorded depth, mm.
const RESOLUTION_MM: f64 = 0.003;
/// A ball stands where it is deeper than all but this part of the range.
const STANDING: f64 = 0.02;
/// Least samples of a standing force, and of a way down that a way back is compared with.
const LEAST: (usize, usize) = (8, 6);
/// A sensor is loaded above this part of the largest force.
const LOADED: f64 = 0.02;

impl Alone {
    fn new(touched: Touched) -> Self {
        let (path, nodes, at, depths) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Self { touched, path, down: 0, nodes, at, depths, ball_mm: 1.0 }
    }

    /// A load (N) that stands for a time (s), recorded at a rate (Hz), for a plan: its readings are to come.
    pub fn planned(touched: Touched, (load_n, hold_s): (f64, f64), sample_hz: f64) -> Self {
        let count = (hold_s * sample_hz) as usize + 1;
        let time_s: Vec<f64> = (0..count).map(|k| k as f64 / sample_hz).collect();
        let recording = Recording::from_samples(time_s, vec![0.0; count], vec![load_n; count]);
        let mut check = Self::new(touched);
        check.stand(&recording, 0..count, |_| load_n);
        if touched == Touched::Block {
            let place = |force_n: f64| Depth { depth_mm: 0.0, force_n, sigma_mm: RESOLUTION_MM };
            check.depths = vec![place(0.0), place(load_n)];
        }
        check
    }

    /// Number of rows: readings (N), then depths (mm).
    pub fn rows(&self) -> usize {
        self.nodes.len() + self.depths.len()
    }

    /// What was recorded, a row each.
    pub fn measured(&self) -> Vec<f64> {
        self.nodes.iter().map(|n| n.force_n).chain(self.depths.iter().map(|d| d.depth_mm)).collect()
    }

    /// What a model makes of it.
    pub fn predicted(&self, model: &Model, start_s: Option<f64>) -> Vec<f64> {
        let (time_s, known): (Vec<f64>, Vec<f64>) = self.path.iter().copied().unzip();
        let mut force_n = known.clone();
        if self.touched == Touched::Block {
            model.remember(&time_s, &mut force_n);
            // the reading on the way down stands for the force: what the sensor adds there is in it already
            let mut there: Vec<(f64, f64)> =
                (0..self.down).map(|k| (self.path[k].1, force_n[k] - self.path[k].1)).collect();
            there.sort_by(|a, b| a.0.total_cmp(&b.0));
            force_n.iter_mut().zip(&known).for_each(|(f, own)| *f -= between(&there, *own));
        } else {
            model.read(&time_s, start_s.unwrap_or(0.0), &mut force_n);
        }
        let readings = self.at.iter().map(|at| force_n[*at]);
        readings.chain(self.depths.iter().map(|d| model.yielded_mm(d.force_n))).collect()
    }

    /// Lower triangular factor of the covariance of its rows; none where that is not positive definite.
    pub fn factor(&self, noise: &SensorNoise) -> Option<DMatrix<f64>> {
        let force_n: Vec<f64> = self.at.iter().map(|at| self.path[*at].1).collect();
        let own = noise.factor(&self.nodes, &force_n)?.lower();
        let mut factor = DMatrix::zeros(self.rows(), self.rows());
        factor.view_mut((0, 0), own.shape()).copy_from(&own);
        for (k, depth) in self.depths.iter().enumerate() {
            factor[(self.nodes.len() + k, self.nodes.len() + k)] = depth.sigma_mm;
        }
        Some(factor)
    }

    /// What its rows may be off by together, a column of unit variance each.
    pub fn freedom(&self, jitter: &Jitter) -> DMatrix<f64> {
        let readings = self.nodes.len();
        let known = |k: usize| self.path[self.at[k]].1;
        let reading = |of: &dyn Fn(usize) -> f64| -> Vec<f64> {
            (0..self.rows()).map(|k| if k < readings { of(k) } else { 0.0 }).collect()
        };
        let depth = |of: &dyn Fn(&Depth) -> f64| -> Vec<f64> {
            let own = |k: usize| if k < readings { 0.0 } else { of(&self.depths[k - readings]) };
            (0..self.rows()).map(own).collect()
        };
        let mut columns = vec![reading(&|_| jitter.zero_n)];
        match self.touched {
            Touched::Nothing => {}
            Touched::Load => columns.push(reading(&|k| KNOWN * known(k))),
            Touched::Block => {
                columns.push(reading(&|k| LEVEL * known(k)));
                columns.push(reading(&|k| match self.nodes[k].branch {
                    Branch::Unloading => BESIDE_MM * self.stiffness(known(k)),
                    Branch::Loading | Branch::Hold => 0.0,
                }));
                columns.push(depth(&|_| SURFACE_MM));
                columns.push(depth(&|d| dent_mm(d.force_n, self.ball_mm)));
            }
        }
        DMatrix::from_fn(self.rows(), columns.len(), |i, j| columns[j][i])
    }

    /// Slope (N/mm) of the way down to a block at a force (N).
    fn stiffness(&self, force_n: f64) -> f64 {
        let pairs = || self.depths.windows(2).map(|w| (&w[0], &w[1]));
        let slope = |(a, b): (&Depth, &Depth)| (b.force_n - a.force_n) / (b.depth_mm - a.depth_mm).max(RESOLUTION_MM);
        pairs().find(|(_, b)| b.force_n >= force_n).or(pairs().next_back()).map_or(0.0, slope)
    }

    /// Number of rows that are readings of the force, the first ones: the zero of the session is in them, and in no depth.
    pub fn readings(&self) -> usize {
        self.nodes.len()
    }

    /// Directions that a discrepancy may lie in: variable, label, and a weight a row.
    pub fn directions(&self) -> Vec<(Variable, String, Vec<f64>)> {
        let readings = self.nodes.len();
        let of = |weight: &dyn Fn(usize) -> f64| (0..self.rows()).map(weight).collect::<Vec<f64>>();
        let late = |k: usize| (2 * k + 1) as f64 / readings as f64 - 1.0;
        let level = of(&|k| f64::from(u8::from(k < readings)));
        let trend = of(&|k| if k < readings { late(k) } else { 0.0 });
        match self.touched {
            Touched::Nothing => vec![(Variable::Air, "zero in air".to_owned(), level)],
            Touched::Load => vec![
                (Variable::Mass, "reading of a mass".to_owned(), level),
                (Variable::Mass, "reading of a mass over time".to_owned(), trend),
            ],
            Touched::Block => {
                let yielding = of(&|k| if k < readings { 0.0 } else { self.depths[k - readings].force_n });
                vec![
                    (Variable::Block, "reading on a standing block over time".to_owned(), trend),
                    (Variable::Block, "depth over force on a block".to_owned(), yielding),
                ]
            }
        }
    }

    /// Readings of samples in which the force stands, in windows that grow, with the force that is known there (N).
    fn stand(&mut self, recording: &Recording, samples: std::ops::Range<usize>, known: impl Fn(&Node) -> f64) {
        let start_s = recording.time_s[0];
        let held_from_s = recording.time_s[samples.start];
        let mut windows = Vec::new();
        if self.touched == Touched::Nothing {
            even(&mut windows, samples, WINDOWS.0, Branch::Hold);
        } else {
            // a load that comes at once begins with the first sample
            self.path.push((held_from_s - start_s, known(&first(recording, samples.start))));
            growing(&mut windows, recording, samples, WINDOWS.1);
        }
        for (window, branch) in windows {
            self.push(node(recording, &window, branch, start_s, held_from_s, 0.0), &known);
        }
    }

    fn push(&mut self, node: Node, known: impl Fn(&Node) -> f64) {
        self.at.push(self.path.len());
        self.path.push((node.time_s, known(&node)));
        self.nodes.push(node);
    }
}

impl Alone {
    /// A force that is known and stands.
    pub fn standing(run: &Run, touched: Touched, load_n: f64) -> Result<Self, String> {
        let recording = &run.recording;
        if recording.len() < LEAST.0 {
            return Err(format!("{} samples, of at least {}", recording.len(), LEAST.0));
        }
        let mut check = Self::new(touched);
        check.stand(recording, 0..recording.len(), |_| load_n);
        Ok(check)
    }

    /// A ball that is pressed onto a block, stands there, and may go back.
    pub fn on_block(run: &Run, ball_mm: f64) -> Result<Self, String> {
        let recording = &run.recording;
        let (depth, force) = (&recording.depth_mm, &recording.force_n);
        let largest_n = force.iter().copied().fold(0.0, f64::max);
        let loaded = |i: &usize| force[*i] > LOADED * largest_n;
        let Some(begin) = (0..force.len()).find(loaded).filter(|_| largest_n > 0.0) else {
            return Err("the stiff block was not touched".to_owned());
        };
        let deepest = depth.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let tolerance = RESOLUTION_MM.max(STANDING * (deepest - depth[begin]));
        let stands = |i: &usize| depth[*i] >= deepest - tolerance && force[*i] > 0.5 * largest_n;
        let start = (begin..force.len()).find(stands).unwrap_or(begin);
        let end = (start..force.len()).find(|i| !stands(i)).unwrap_or(force.len());
        if end - start < LEAST.0 {
            return Err(format!(
                "the ball stands on the stiff block for {} samples, of at least {}",
                end - start,
                LEAST.0
            ));
        }
        let mut check = Self { ball_mm, ..Self::new(Touched::Block) };
        check.go_down(recording, begin, start);
        let level_n = force[start];
        let whole = node(recording, &(start..end), Branch::Hold, 0.0, 0.0, 0.0);
        check.depths.push(Depth { depth_mm: whole.depth_mm, force_n: whole.force_n, sigma_mm: RESOLUTION_MM });
        check.stand(recording, start..end, |_| level_n);
        // the first sample that stands belongs to the way down
        check.down += 1;
        check.go_back(recording, end);
        Ok(check)
    }

    /// The way down from the last sample that is not loaded to the first that stands.
    fn go_down(&mut self, recording: &Recording, begin: usize, start: usize) {
        let start_s = recording.time_s[0];
        let mut windows = Vec::new();
        even(&mut windows, begin..start, WINDOWS.2, Branch::Loading);
        if let Some(before) = begin.checked_sub(1) {
            // the surface is somewhere on the way to the next sample
            let step_mm = (recording.depth_mm[begin] - recording.depth_mm[before]).abs();
            let sigma_mm = RESOLUTION_MM.hypot(step_mm / 12.0_f64.sqrt());
            self.depths.push(Depth { depth_mm: recording.depth_mm[before], force_n: 0.0, sigma_mm });
        }
        for (window, branch) in windows {
            let n = node(recording, &window, branch, start_s, 0.0, 0.0);
            self.depths.push(Depth { depth_mm: n.depth_mm, force_n: n.force_n, sigma_mm: RESOLUTION_MM });
            self.path.push((n.time_s, n.force_n));
        }
        self.down = self.path.len();
    }

    /// The way back, where there was a way down to compare it with.
    fn go_back(&mut self, recording: &Recording, end: usize) {
        if self.down < LEAST.1 {
            return;
        }
        let mut on_way: Vec<(f64, f64)> = self.depths.iter().map(|d| (d.depth_mm, d.force_n)).collect();
        on_way.sort_by(|a, b| a.0.total_cmp(&b.0));
        let start_s = recording.time_s[0];
        let shallow = on_way[0].0;
        let last = (end..recording.len()).find(|i| recording.depth_mm[*i] <= shallow).unwrap_or(recording.len());
        let mut windows = Vec::new();
        even(&mut windows, end..last, WINDOWS.2, Branch::Unloading);
        for (window, branch) in windows {
            let n = node(recording, &window, branch, start_s, 0.0, 0.0);
            self.push(n, |n| between(&on_way, n.depth_mm));
        }
    }
}

fn first(recording: &Recording, at: usize) -> Node {
    node(recording, &(at..at + 1), Branch::Hold, recording.time_s[0], recording.time_s[at], 0.0)
}

/// Hertz' depth (mm) of a dent in a block under a force (N).
fn dent_mm(force_n: f64, ball_mm: f64) -> f64 {
    (0.75 * force_n.max(0.0) / (BLOCK_MPA * ball_mm.sqrt())).powf(2.0 / 3.0)
}

/// A value between points in rising order, at its ends the nearest; 0 where there are none.
fn between(points: &[(f64, f64)], x: f64) -> f64 {
    let next = points.partition_point(|p| p.0 < x);
    match (next.checked_sub(1).map(|i| points[i]), points.get(next)) {
        (Some((x0, y0)), Some((x1, y1))) if *x1 > x0 => y0 + (y1 - y0) * (x - x0) / (x1 - x0),
        (Some((_, y)), Some(_)) => y,
        (Some((_, y)), None) => y,
        (None, Some((_, y))) => *y,
        (None, None) => 0.0,
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use lut_gen::chain::Setting;
    use lut_gen::effect::{compliance, sensor_creep};

    use super::*;

    const LOAD_N: f64 = 2.0;
    const MM_PER_N: f64 = 0.1;

    /// Down in half a second, standing for ten, and back, on a block in a machine of 0.1 mm/N; `sensed` makes readings of the forces.
    fn pressed(sensed: impl Fn(&[f64], &mut [f64])) -> Alone {
        let time_s: Vec<f64> = (0..=550).map(|k| 0.02 * f64::from(k)).collect();
        let way = |t: f64| (t / 0.5).min((11.0 - t) / 0.5).clamp(0.0, 1.0);
        let mut force_n: Vec<f64> = time_s.iter().map(|t| LOAD_N * way(*t)).collect();
        let depth_mm = force_n.iter().map(|f| MM_PER_N * f).collect();
        sensed(&time_s, &mut force_n);
        let run = Run::indentation("block".to_owned(), 0, 0, Recording::from_samples(time_s, depth_mm, force_n));
        Alone::on_block(&run, 4.0).unwrap()
    }

    fn with(effect: &'static lut_gen::effect::Effect, values: Vec<f64>) -> Model {
        let mut model = Model::base(0.1, 8.0);
        model.settings.push(Setting { effect, owner: 0, values });
        model
    }

    /// Largest difference of readings (N) and of depths (mm), the latter beyond a common surface.
    fn missed(check: &Alone, model: &Model) -> (f64, f64) {
        let differences: Vec<f64> =
            check.measured().into_iter().zip(check.predicted(model, None)).map(|(a, b)| a - b).collect();
        let (readings, depths) = differences.split_at(check.nodes.len());
        let surface = depths.iter().sum::<f64>() / depths.len() as f64;
        let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0_f64, |m, x| m.max(x.abs()));
        (largest(&mut readings.iter().copied()), largest(&mut depths.iter().map(|d| d - surface)))
    }

    #[test]
    fn a_machine_that_yields_moves_the_depth_and_no_reading() {
        let check = pressed(|_, _| ());
        assert!(check.depths.len() > 6 && check.nodes.iter().any(|n| n.branch == Branch::Unloading));
        let (rigid, yielding) = (Model::base(0.1, 8.0), with(&compliance::EFFECT, vec![MM_PER_N]));
        assert!(missed(&check, &rigid).1 > 0.05 && missed(&check, &yielding).1 < 1e-9);
        // means over windows that a corner cuts: a reading and a half
        assert!(missed(&check, &rigid).0 < 0.06 * LOAD_N, "{:?}", missed(&check, &rigid));
    }

    #[test]
    fn a_sensor_that_creeps_moves_the_reading_while_the_ball_stands() {
        let check = pressed(|time_s, force_n| sensor_creep::creep(time_s, force_n, (0.1, 1.5)));
        let held = |model: &Model| {
            let all = check.measured().into_iter().zip(check.predicted(model, None)).zip(&check.nodes);
            let own: Vec<f64> = all.filter(|(_, n)| n.branch == Branch::Hold).map(|((a, b), _)| a - b).collect();
            own[own.len() - 1] - own[0]
        };
        assert!(held(&Model::base(0.1, 8.0)) > 0.08 * LOAD_N);
        // to first order: the creep of the creep is a hundredth
        assert!(held(&with(&sensor_creep::CREEP, vec![0.1, 1.5])).abs() < 0.01 * LOAD_N);
    }

    #[test]
    fn what_does_not_stand_or_touch_is_told() {
        let recording = |force_n: Vec<f64>| {
            let time_s: Vec<f64> = (0..force_n.len()).map(|k| 0.02 * k as f64).collect();
            Run::indentation("x".to_owned(), 0, 0, Recording::from_samples(time_s.clone(), time_s, force_n))
        };
        let why = |run: &Run| Alone::on_block(run, 4.0).unwrap_err();
        assert_eq!(why(&recording(vec![0.0; 50])), "the stiff block was not touched");
        let told = why(&recording((0..50).map(f64::from).collect()));
        assert!(
            told.starts_with("the ball stands on the stiff block for ") && told.ends_with("of at least 8"),
            "{told}"
        );
        let short = Alone::standing(&recording(vec![1.0; 5]), Touched::Load, 1.0).unwrap_err();
        assert_eq!(short, "5 samples, of at least 8");
    }
}
