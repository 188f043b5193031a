//! A computed force-depth curve.

use super::DepthProfile;

/// What a solve cost.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Stats {
    /// Unknowns of the finest mesh.
    pub unknowns: usize,
    /// Newton iterations of all meshes.
    pub iterations: usize,
    /// Depth steps of all meshes.
    pub steps: usize,
    /// Steps that had to be cut.
    pub cuts: usize,
    /// Wall time (s).
    pub seconds: f64,
    /// Largest relative difference of contact force and base reaction.
    pub imbalance: f64,
}

/// Force of the ball over depth.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Depths (mm).
    pub depth_mm: Vec<f64>,
    /// Force at each depth (N).
    pub force_n: Vec<f64>,
    /// The curve as a function of depth.
    pub profile: DepthProfile,
    /// Estimated relative discretisation error of the force, from 1/8 of the
    /// largest depth on: scatter of the stations about the smooth profile and,
    /// with two meshes, half their difference.
    pub discretisation: f64,
    /// What it cost.
    pub stats: Stats,
}
