//! The finite element models behind an identification.

use std::fmt;
use std::sync::atomic::{AtomicUsize, Ordering};

use lut_gen::solid::contact::Ball;
use lut_gen::solid::law::{Hyperfoam, Term};
use lut_gen::solid::model::{ForceModel, Indentation, ModelSpec, Resolution, Specimen as Block};
use lut_gen::solid::solve::{Base as Support, SolveError};

use crate::experiment::{Base, Experiment, Length};

use super::data::{Height, Pairing, Selection};
use super::model::{ForwardModel, Shape, UnitCurve};

/// Radius of a block written `"unknown"`, in ball radii: bounds of the free parameter. Force is
/// so insensitive to it that it is set to the upper bound and what the lower one would do is told.
pub const UNKNOWN_RADIUS_IN_BALLS: (f64, f64) = (3.0, 6.0);
/// Chebyshev nodes over the height for a height to be found, and for several known heights.
const FREE_HEIGHT_NODES: usize = 5;
const KNOWN_HEIGHT_NODES: usize = 3;
/// From this many known heights on, one model over the height is cheaper than one a height.
const HEIGHTS_WORTH_AN_AXIS: usize = 4;
/// Samples of a unit curve; the cubic between them is then exact to 1e-5 of the largest force.
const SAMPLES: usize = 240;

/// Progress of the solves: what is being built, how many are done, how many there are.
pub type Progress<'a> = dyn Fn(&str, usize, usize) + Send + Sync + 'a;

/// Why no model could be built.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum ModelError {
    /// A ball of unknown radius.
    #[error(
        "the radius of indenter \"{0}\" is unknown: force goes like mu sqrt(R), so that a loading curve cannot tell the radius from mu; measure the ball and write radius_mm"
    )]
    UnknownBall(String),
    /// More terms than can be told apart.
    #[error(
        "{terms} terms of the {law} and {relaxation} of the relaxation are asked for; identification fits at most 2 of each"
    )]
    TooManyTerms {
        /// Law.
        law: &'static str,
        /// Its terms.
        terms: usize,
        /// Prony terms.
        relaxation: usize,
    },
    /// A solve failed.
    #[error("the finite element model of {what} failed")]
    Solve {
        /// Specimen and ball.
        what: String,
        /// The solver's own words.
        #[source]
        cause: SolveError,
    },
}

/// One force model a pairing, shared where pairings differ in height only.
pub struct FeModel {
    models: Vec<ForceModel>,
    /// Index into `models` for every pairing.
    of_pairing: Vec<usize>,
    blocks: Vec<Block>,
    balls: Vec<Ball>,
    messages: Vec<String>,
    checks: AtomicUsize,
}

impl fmt::Debug for FeModel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "FeModel of {} pairings in {} tables", self.of_pairing.len(), self.models.len())
    }
}

/// Pairings that one table covers.
struct Group {
    pairings: Vec<usize>,
    spec: ModelSpec,
    what: String,
}

impl FeModel {
    /// Solves what the selection needs, in parallel.
    ///
    /// # Errors
    /// A failing solve, named by specimen and ball.
    pub fn build(experiment: &Experiment, selection: &Selection, progress: &Progress<'_>) -> Result<Self, ModelError> {
        let blocks: Vec<Block> = selection.pairings.iter().map(|p| block(experiment, selection, p)).collect();
        let balls: Vec<Ball> = selection.pairings.iter().map(|p| ball(p.grip.ball_mm())).collect();
        let groups = groups(experiment, selection, &blocks, &balls);
        let mut models = Vec::new();
        let mut messages = Vec::new();
        let mut of_pairing = vec![0; selection.pairings.len()];
        for group in groups {
            let what = group.what.as_str();
            let report = |done: usize, total: usize| progress(what, done, total);
            let model = solved(&group, &report, &mut messages)?;
            for pairing in group.pairings {
                of_pairing[pairing] = models.len();
            }
            models.push(model);
        }
        Ok(Self { models, of_pairing, blocks, balls, messages, checks: AtomicUsize::new(0) })
    }

    /// What the reader should know about the model.
    pub fn messages(&self) -> &[String] {
        &self.messages
    }

    /// The continuous model of a pairing.
    pub fn force_model(&self, pairing: usize) -> &ForceModel {
        &self.models[self.of_pairing[pairing]]
    }

    /// One direct solve of a pairing, compared with the interpolating model: the largest
    /// difference over depth, relative to the largest force.
    ///
    /// # Errors
    /// If the solve fails.
    pub fn direct_check(&self, pairing: usize, shape: Shape) -> Result<f64, ModelError> {
        let block = Block { height_mm: shape.height_mm, ..self.blocks[pairing] };
        let (depths, direct) = self.direct(pairing, shape, block)?;
        let model = &self.models[self.of_pairing[pairing]];
        let largest = direct.last().copied().unwrap_or(1.0).max(f64::MIN_POSITIVE);
        let differences = depths.iter().zip(&direct).map(|(depth, force)| {
            let modelled = model.gradient_at(1.0, shape.alpha, *depth, shape.height_mm).force_n;
            (modelled - force).abs() / largest
        });
        Ok(differences.fold(0.0, f64::max))
    }

    /// Relative change of the largest force when the block's radius is that instead.
    ///
    /// # Errors
    /// If the solve fails.
    pub fn other_radius(&self, pairing: usize, shape: Shape, radius_mm: f64) -> Result<f64, ModelError> {
        let block = Block { height_mm: shape.height_mm, radius_mm, ..self.blocks[pairing] };
        let (depths, direct) = self.direct(pairing, shape, block)?;
        let model = &self.models[self.of_pairing[pairing]];
        let depth = depths.last().copied().unwrap_or(0.0);
        let usual = model.gradient_at(1.0, shape.alpha, depth, shape.height_mm).force_n;
        Ok(direct.last().copied().unwrap_or(usual) / usual - 1.0)
    }

    fn direct(&self, pairing: usize, shape: Shape, specimen: Block) -> Result<(Vec<f64>, Vec<f64>), ModelError> {
        let spec = self.models[self.of_pairing[pairing]].spec();
        let failed = |cause: SolveError| ModelError::Solve { what: "the fitted material".to_owned(), cause };
        let term = Term { mu_mpa: 1.0, alpha: shape.alpha, nu: spec.nu };
        let problem = Indentation {
            law: Hyperfoam::new(vec![term]).map_err(|cause| failed(cause.into()))?,
            specimen,
            ball: self.balls[pairing],
            depth_mm: spec.depth_mm,
            resolution: Resolution::Standard,
        };
        let depths: Vec<f64> = (1..=20).map(|i| spec.depth_mm * f64::from(i) / 20.0).collect();
        self.checks.fetch_add(1, Ordering::Relaxed);
        let curve = problem.solve_at(&depths).map_err(failed)?;
        Ok((depths, curve.force_n))
    }
}

impl ForwardModel for FeModel {
    fn curve(&self, pairing: usize, shape: Shape) -> UnitCurve {
        let model = &self.models[self.of_pairing[pairing]];
        UnitCurve::sampled(model.spec().depth_mm, SAMPLES, |depth| {
            model.gradient_at(1.0, shape.alpha, depth, shape.height_mm).force_n
        })
    }

    fn alpha_bounds(&self) -> (f64, f64) {
        let ranges = self.models.iter().map(|model| model.spec().alpha);
        ranges.fold((0.0, f64::INFINITY), |(low, high), (l, h)| (f64::max(low, l), f64::min(high, h)))
    }

    fn relative_error(&self) -> f64 {
        self.models.iter().map(|model| model.error().total()).fold(0.0, f64::max)
    }

    fn solves(&self) -> usize {
        let built: usize = self.models.iter().map(ForceModel::solves).sum();
        built + self.checks.load(Ordering::Relaxed)
    }
}

/// Factors of the ends of alpha's range, tried when a corner of the wanted one has no solution:
/// a deep ball in a thin block is hard to solve at either end.
const SMALLER_RANGES: [(f64, f64); 2] = [(1.5, 0.85), (2.5, 0.65)];

fn solved(
    group: &Group,
    report: &(dyn Fn(usize, usize) + Send + Sync),
    messages: &mut Vec<String>,
) -> Result<ForceModel, ModelError> {
    let build = |alpha: (f64, f64)| ForceModel::build(&ModelSpec { alpha, ..group.spec.clone() }, report);
    let (low, high) = group.spec.alpha;
    let mut model = build((low, high));
    for (raise, lower) in SMALLER_RANGES {
        let Err(cause) = &model else { break };
        let (what, alpha) = (&group.what, (raise * low, lower * high));
        let (from, to) = alpha;
        messages
            .push(format!("{what}: alpha is limited to {from:.1} to {to:.1}, because a solve beyond failed ({cause})"));
        model = build(alpha);
    }
    model.map_err(|cause| ModelError::Solve { what: group.what.clone(), cause })
}

fn ball(radius_mm: f64) -> Ball {
    Ball { radius_mm }
}

/// The block under a pairing's ball; a free height is set to the middle of its bounds.
pub(super) fn block(experiment: &Experiment, selection: &Selection, pairing: &Pairing) -> Block {
    let specimen = &experiment.specimens[pairing.specimen];
    let height_mm = match pairing.height {
        Height::Known(mm) => mm,
        Height::Free(at) => {
            let height = &selection.heights[at];
            0.5 * (height.low_mm + height.high_mm)
        }
    };
    let radius_mm = match specimen.radius_mm {
        Length::Known(mm) => mm,
        Length::Unknown => UNKNOWN_RADIUS_IN_BALLS.1 * pairing.grip.ball_mm(),
    };
    let base = match specimen.base {
        Base::Bonded => Support::Bonded,
        Base::Sliding => Support::Sliding,
    };
    Block { height_mm, radius_mm, base }
}

fn groups(experiment: &Experiment, selection: &Selection, blocks: &[Block], balls: &[Ball]) -> Vec<Group> {
    let mut kinds: Vec<Vec<usize>> = Vec::new();
    for (at, pairing) in selection.pairings.iter().enumerate() {
        let kind = kinds.iter_mut().find(|kind| {
            let other = &selection.pairings[kind[0]];
            let known = |p: &Pairing| matches!(p.height, Height::Known(_));
            let (a, b) = (&blocks[at], &blocks[kind[0]]);
            (a.radius_mm, a.base) == (b.radius_mm, b.base)
                && pairing.grip.ball_mm() == other.grip.ball_mm()
                && known(pairing)
                && known(other)
        });
        match kind {
            Some(kind) => kind.push(at),
            None => kinds.push(vec![at]),
        }
    }
    kinds.into_iter().flat_map(|kind| tables(experiment, selection, kind, blocks, balls)).collect()
}

/// One table over the height for many heights or an unknown one, otherwise one a height.
fn tables(
    experiment: &Experiment,
    selection: &Selection,
    kind: Vec<usize>,
    blocks: &[Block],
    balls: &[Ball],
) -> Vec<Group> {
    let deepest = |of: &[usize]| of.iter().map(|&at| selection.pairings[at].depth_mm).fold(0.0, f64::max);
    let name = |at: usize| {
        let pairing = &selection.pairings[at];
        let ball = pairing.grip.indenter().map_or("nothing", |at| experiment.indenters[at].name.as_str());
        format!("{} under {ball}", experiment.specimens[pairing.specimen].name)
    };
    let first = kind[0];
    if let Height::Free(at) = selection.pairings[first].height {
        let height = &selection.heights[at];
        let mut spec = ModelSpec::new(blocks[first], balls[first], deepest(&kind));
        spec.heights_mm = Some((height.low_mm, height.high_mm, FREE_HEIGHT_NODES));
        return vec![Group { what: name(first), pairings: kind, spec }];
    }
    let low = kind.iter().map(|&at| blocks[at].height_mm).fold(f64::INFINITY, f64::min);
    let high = kind.iter().map(|&at| blocks[at].height_mm).fold(0.0, f64::max);
    let depth_mm = deepest(&kind);
    if kind.len() >= HEIGHTS_WORTH_AN_AXIS && depth_mm < 0.85 * low && high > low {
        let mut spec = ModelSpec::new(blocks[first], balls[first], depth_mm);
        spec.heights_mm = Some((low, high, KNOWN_HEIGHT_NODES));
        let what = format!("{} and {} more", name(first), kind.len() - 1);
        return vec![Group { what, pairings: kind, spec }];
    }
    let one = |at: usize| Group {
        what: name(at),
        pairings: vec![at],
        spec: ModelSpec::new(blocks[at], balls[at], selection.pairings[at].depth_mm),
    };
    kind.into_iter().map(one).collect()
}
