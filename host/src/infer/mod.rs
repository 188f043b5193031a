//! Inference: from rows that a model predicts to parameters, their errors, and what they rest on. It knows no physics.
//!
//! ```text
//! rows        which rows count; those left out are removed, not set to zero
//! product     products of tall matrices
//! eigen       eigenvalues of a symmetric matrix, with an end
//! covariance  inverse of an information matrix, standard errors, determinants, marginals
//! lowrank     Gaussian errors along a few columns: the one low-rank step
//! descent     Levenberg-Marquardt in a box: the one local optimiser of sums of squares
//! unseen      what amounts that nobody saw add to the errors of parameters
//! presence    effects that are there or not: intervals over their sets
//! mixture     quantiles of mixtures of normal distributions
//! process     shapes of a smooth random function
//! evidence    marginal likelihood of a model, its discrepancy of unknown size integrated
//! quantity    a parameter of an effect, with what is known of it
//! sets        sets of effects, compared by their evidence; from that to names
//! starts      where searches begin: a space-filling design, and a search from many starts
//! ```
//!
//! Users are [`crate::identify`], [`crate::extended`] and [`crate::diagnose`]. Nothing here imports any of them.

pub mod covariance;
pub mod descent;
pub mod eigen;
pub mod evidence;
pub mod lowrank;
pub mod mixture;
pub mod presence;
pub mod process;
pub mod product;
pub mod quantity;
pub mod rows;
pub mod sets;
pub mod starts;
pub mod unseen;
