//! What a force model covers, and the solves it is made from and checked with.

use serde::{Deserialize, Serialize};

use super::profile::MAX_TERMS;
use super::{Axis, Resolution, Scale, Specimen};
use crate::solid::contact::Ball;
use crate::solid::law::Parameter;
use crate::solid::solve::SolveError;

/// What a force model covers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModelSpec {
    /// The block; its height is the only one unless `heights_mm` is given.
    pub specimen: Specimen,
    /// The ball.
    pub ball: Ball,
    /// Poisson's ratio of the one-term law; the only one unless `nus` is given.
    pub nu: f64,
    /// Range of Poisson's ratios and number of nodes. Measured with six nodes from 0 to 0.45 (alpha to
    /// 23, h/R above 3, d = R): 0.07 % of the force. A thin block confines the foam, whose force then
    /// spans decades: read the bound.
    pub nus: Option<(f64, f64, usize)>,
    /// Range of the exponent, within [1, 24] tested.
    pub alpha: (f64, f64),
    /// Chebyshev nodes over the exponent.
    pub alpha_nodes: usize,
    /// Whether every solve also tells what the exponent does to its force, a tenth of the time more: so many nodes are then as good
    /// as twice as many (docs/physics.md).
    pub alpha_slopes: bool,
    /// The same of Poisson's ratio, where that is an axis: how its slope depends on the exponent is told by the exponents' nodes alone.
    pub nu_slopes: bool,
    /// Range of heights (mm) and number of nodes, for specimens of unknown height.
    pub heights_mm: Option<(f64, f64, usize)>,
    /// Largest depth (mm).
    pub depth_mm: f64,
    /// Mesh of every solve.
    pub resolution: Resolution,
    /// Whether solves that are no nodes measure the model's error. Without them [`super::ErrorBound`] is unknown (NaN),
    /// and the model is made in half the time.
    pub checked: bool,
}

impl ModelSpec {
    /// One known height, `nu = 0`, alpha 1 to 24, standard mesh.
    #[must_use]
    pub fn new(specimen: Specimen, ball: Ball, depth_mm: f64) -> Self {
        Self {
            specimen,
            ball,
            nu: 0.0,
            nus: None,
            alpha: (1.0, 24.0),
            alpha_nodes: 10,
            alpha_slopes: false,
            nu_slopes: false,
            heights_mm: None,
            depth_mm,
            resolution: Resolution::Standard,
            checked: true,
        }
    }
}

/// A solve of the plan: Poisson's ratio, height, exponent, mesh.
pub(super) type Job = ([f64; 3], Resolution);

impl ModelSpec {
    /// Parameters whose slopes are told, with the places of their axes.
    pub(super) fn sloped(&self) -> Vec<(usize, Parameter)> {
        let nu = (self.nu_slopes && self.nus.is_some()).then_some((0, Parameter::Nu(0)));
        let alpha = self.alpha_slopes.then_some((2, Parameter::Alpha(0)));
        nu.into_iter().chain(alpha).collect()
    }

    /// Poisson's ratio, height, exponent.
    pub(super) fn axes(&self) -> [Axis; 3] {
        let axis = |(low, high, nodes), scale| Axis { low, high, nodes, scale };
        let height_mm = self.specimen.height_mm;
        [
            axis(self.nus.unwrap_or((self.nu, self.nu, 1)), Scale::Poisson),
            axis(self.heights_mm.unwrap_or((height_mm, height_mm, 1)), Scale::Reciprocal),
            axis((self.alpha.0, self.alpha.1, self.alpha_nodes), Scale::Log),
        ]
    }
}

/// # Errors
/// [`SolveError::Parameter`] for a range or a number of nodes that makes no sense.
pub(super) fn check(spec: &ModelSpec, [nu, height, alpha]: &[Axis; 3]) -> Result<(), SolveError> {
    let bad = |parameter, value, expected: &str| {
        Err(SolveError::Parameter { parameter, value, expected: expected.to_owned() })
    };
    if !(alpha.low > 0.0 && alpha.high > alpha.low) {
        return bad("alpha", alpha.low, "must be positive and below the upper end of its range");
    }
    if !(2..=MAX_TERMS).contains(&alpha.nodes) {
        return bad("alpha_nodes", alpha.nodes as f64, "must lie in 2..=24");
    }
    if spec.alpha_slopes && 2 * alpha.nodes > MAX_TERMS {
        return bad("alpha_nodes", alpha.nodes as f64, &format!("must not exceed {} with slopes", MAX_TERMS / 2));
    }
    if !(1..=MAX_TERMS).contains(&height.nodes) {
        return bad("height nodes", height.nodes as f64, "must lie in 1..=24");
    }
    if height.nodes > 1 && !(height.low > 0.0 && height.high > height.low) {
        return bad("heights_mm", height.low, "must be positive and below the upper end of its range");
    }
    if !(1..=MAX_TERMS).contains(&nu.nodes) {
        return bad("nu nodes", nu.nodes as f64, "must lie in 1..=24");
    }
    if spec.nu_slopes && 2 * nu.nodes > MAX_TERMS {
        return bad("nu nodes", nu.nodes as f64, &format!("must not exceed {} with slopes", MAX_TERMS / 2));
    }
    if nu.nodes > 1 && !(nu.low >= 0.0 && nu.high > nu.low && nu.high < 0.5) {
        return bad("nus", nu.low, "must not be negative and lie below the upper end of its range, that below 0.5");
    }
    Ok(())
}

/// Solves that are not nodes: three exponents between nodes (on two heights and two of Poisson's
/// ratios where these are axes), each on the model's mesh and on a refined one.
pub(super) fn checks([nu, height, alpha]: &[Axis; 3], resolution: Resolution) -> Vec<Job> {
    let two = |axis: &Axis, at: [f64; 2]| match axis.nodes {
        1 => vec![axis.low],
        _ => at.map(|x| axis.value(x)).to_vec(),
    };
    let mut plan = Vec::new();
    // the extrema of the first neglected polynomial, near the ends and the middle
    let n = alpha.nodes as f64;
    for k in [1.0, (n / 2.0).floor(), n - 1.0] {
        let a = alpha.value((std::f64::consts::PI * k / n).cos());
        for h in two(height, [-0.6, 0.6]) {
            plan.extend(two(nu, [-0.6, 0.9]).into_iter().map(|v| ([v, h, a], resolution)));
        }
    }
    let twins: Vec<Job> = plan.iter().map(|&(at, _)| (at, resolution.finer())).collect();
    plan.extend(twins);
    plan
}
