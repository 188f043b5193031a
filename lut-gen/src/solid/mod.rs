//! Mechanics of a soft solid: a rigid ball or a platen on a cylindrical block, quasi-static or explicit.
//!
//! It imports the finite elements of [`crate::fem`] and no other physics. Units are mm, N, MPa, s.
//!
//! | folder | holds |
//! |---|---|
//! | [`law`] | elastic energies in principal stretches (Hyperfoam, Ogden, linear), stress and exact tangent for an axisymmetric deformation gradient; relaxation (Prony) and softening (Ogden-Roxburgh) on top |
//! | [`mesh`] | the block's structured quadratic mesh, graded towards the ball |
//! | [`element`] | eight-node ring element, total Lagrangian |
//! | [`contact`] | analytic ball with shank, penalty integrated over the surface, Coulomb friction, adhesion |
//! | [`solve`] | tangent, Newton's method, adaptive path through a motion of depth or force |
//! | [`model`] | a ball of any motion on a specimen of any material ([`model::Simulation`]) with sensitivities, a cylinder between platens ([`model::Compression`]), the elastic indentation ([`model::Indentation`]) and the continuous [`model::ForceModel`] over exponent, depth and height |
//! | [`homogeneous`] | stress of a material in uniaxial, confined, equibiaxial and planar tests and in simple shear, over time, with derivatives |
//! | [`field`] | stretches, stresses and contact pressure at one equilibrium, and their files for ParaView |
//! | [`dynamics`] | the thesis' explicit method (appendix B), lumped mass and central differences, with an inertia report |
//! | [`verify`] | closed forms and difference quotients |

pub mod contact;
pub mod dynamics;
pub mod element;
pub mod field;
pub mod homogeneous;
pub mod law;
pub mod mesh;
pub mod model;
pub mod solve;
pub mod verify;
