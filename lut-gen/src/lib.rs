//! Finite elements of spherical indentation and the look-up tables made from them.
//!
//! A rigid ball is pressed into a soft cylindrical block; the question is the
//! force over depth. Units are mm, N, MPa throughout.
//!
//! A walk through the folders, from the material to the table:
//!
//! | folder | holds |
//! |---|---|
//! | [`scalar`] | numbers that carry a derivative: the same code gives sensitivities |
//! | [`fem`] | finite elements without a physics: meshes, shape functions, elements over a point's energy, equations, sparse factors, the least of an energy |
//! | [`solid`] | mechanics of the specimen: materials, contact, indentation and compression with sensitivities, the force model |
//! | [`magnet`] | magnetostatics in the plane and about an axis: saturating cores, the fluid, coils, permanent magnets |
//! | [`pad`] | the finger pad pressed on plates, foams and yielding bodies: layers, contact of two soft bodies |
//! | [`effect`], [`chain`] | departures from the base model, and the stages a run passes through |
//! | [`table`] | the thesis' grid and the bytes the board reads |
//! | [`sweep`] | grids over any number of parameters, in shards, resumable |
//! | [`vtk`] | files for ParaView |
//!
//! A physics imports [`fem`] and no other physics.
//!
//! Assumptions: quasi-static, homogeneous isotropic block with free sides. Verification and
//! measured errors: `docs/physics.md` and `docs/verification.md`.
//!
//! ```
//! use lut_gen::solid::contact::Ball;
//! use lut_gen::solid::law::Hyperfoam;
//! use lut_gen::solid::model::{Indentation, Resolution, Specimen};
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
//! # Ok::<(), lut_gen::solid::solve::SolveError>(())
//! ```

pub mod chain;
pub mod effect;
pub mod fem;
pub mod magnet;
pub mod pad;
pub mod scalar;
pub mod solid;
pub mod sweep;
pub mod table;
pub mod vtk;
