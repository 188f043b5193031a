//! Finite elements of spherical indentation and the look-up tables made from them.
//!
//! A rigid ball is pressed into a soft cylindrical block; the question is the
//! force over depth. Units are mm, N, MPa throughout.
//!
//! A walk through the folders, from the material to the table:
//!
//! | folder | holds |
//! |---|---|
//! | [`law`] | elastic energies in principal stretches (Hyperfoam, Ogden, linear), stress and exact tangent for an axisymmetric deformation gradient; relaxation (Prony) and softening (Ogden-Roxburgh) on top |
//! | [`scalar`] | numbers that carry a derivative: the same code gives sensitivities |
//! | [`fem`] | finite elements without a physics: drawings, graded triangle meshes, shape functions, sparse factors |
//! | [`magnet`] | magnetostatics in the plane and about an axis: saturating cores, the fluid, coils, permanent magnets |
//! | [`mesh`] | structured quadratic mesh of the block, graded towards the ball |
//! | [`element`] | eight-node ring element, total Lagrangian |
//! | [`contact`] | analytic ball with shank, penalty integrated over the surface, Coulomb friction, adhesion |
//! | [`solve`] | sparse tangent, Newton's method, adaptive path through a motion of depth or force |
//! | [`model`] | a ball of any motion on a specimen of any material ([`model::Simulation`]) with sensitivities, a cylinder between platens ([`model::Compression`]), the elastic indentation ([`model::Indentation`]) and the continuous [`model::ForceModel`] over exponent, depth and height |
//! | [`homogeneous`] | stress of a material in uniaxial, confined, equibiaxial and planar tests and in simple shear, over time, with derivatives |
//! | [`field`] | stretches, stresses and contact pressure at one equilibrium, and their files for ParaView |
//! | [`dynamics`] | the thesis' explicit method (appendix B), lumped mass and central differences, with an inertia report |
//! | [`table`] | the thesis' grid and the bytes the board reads |
//! | [`sweep`] | grids over any number of parameters, in shards, resumable |
//! | [`vtk`] | files for ParaView |
//! | [`verify`] | closed forms and difference quotients |
//!
//! Assumptions: quasi-static, homogeneous isotropic block with free sides. Verification and
//! measured errors: `docs/physics.md` and `docs/verification.md`.
//!
//! ```
//! use lut_gen::contact::Ball;
//! use lut_gen::law::Hyperfoam;
//! use lut_gen::model::{Indentation, Resolution, Specimen};
//!
//! let curve = Indentation {
//!     law: Hyperfoam::one_term(0.22, 10.526)?,
//!     specimen: Specimen::of_height(12.7),
//!     ball: Ball { radius_mm: 4.0 },
//!     depth_mm: 4.0,
//!     resolution: Resolution::Standard,
//! }
//! .solve_at(&[1.0, 4.0])?;
//! assert!((curve.force_n[1] - 6.15).abs() < 0.02);
//! # Ok::<(), lut_gen::solve::SolveError>(())
//! ```

pub mod chain;
pub mod contact;
pub mod dynamics;
pub mod effect;
pub mod element;
pub mod fem;
pub mod field;
pub mod homogeneous;
pub mod law;
pub mod magnet;
pub mod mesh;
pub mod model;
pub mod scalar;
pub mod solve;
pub mod sweep;
pub mod table;
pub mod verify;
pub mod vtk;
