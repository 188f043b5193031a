//! Explicit updated-Lagrangian dynamics: the thesis' own method (appendix B), and an independent check of the implicit one.
//!
//! `M a + C v = R - F` (Eq. 62) with a lumped mass, `C = alpha M`, central differences (Eqs. 63-64) and a
//! step below the critical one. Mesh, material and contact are those of [`crate::solid::model::Simulation`]; the
//! internal force is written anew, in the current configuration ([`UpdatedElement`]).
//!
//! Relaxation, softening, friction and adhesion act as in the implicit solver. For a material without rate only the product of rate and root of density counts: scaling the
//! mass by `s` at rate `V` is the same problem as the true mass at `V sqrt(s)`, in other units of time.
//! [`Inertia`] says whether the answer may be taken for quasi-static.
//!
//! ```
//! use lut_gen::solid::contact::{Ball, Interface};
//! use lut_gen::solid::dynamics::{Explicit, Press};
//! use lut_gen::solid::law::Hyperfoam;
//! use lut_gen::solid::model::{Resolution, Simulation, Specimen};
//! use lut_gen::solid::solve::Motion;
//!
//! let simulation = Simulation {
//!     material: Hyperfoam::one_term(0.22, 4.0)?.into(),
//!     specimen: Specimen { height_mm: 5.0, radius_mm: 8.0, ..Specimen::of_height(5.0) },
//!     ball: Ball { radius_mm: 4.0 },
//!     interface: Interface::default(),
//!     motion: Motion::ramp(0.5, 40_000.0),
//!     resolution: Resolution::Refined(0.3),
//! };
//! // a foam of 100 kg/m^3 at 40 m/s: far from quasi-static, and told so
//! let press = Press { simulation, smooth: 0.2, explicit: Explicit::of_density(100.0) };
//! let impact = press.solve()?;
//! assert!(!impact.inertia().quasi_static());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod body;
mod critical;
mod element;
mod error;
mod inertia;
mod integrator;
mod mass;
mod press;
mod pressed;
mod ramp;
mod run;

pub use body::{Body, Forces};
pub use critical::critical_step_s;
pub use element::UpdatedElement;
pub use error::DynamicsError;
pub use inertia::{Inertia, LIMIT};
pub use integrator::CentralDifference;
pub use mass::lumped_mass;
pub use press::{Explicit, Press};
pub use pressed::{Moment, Pressed};
pub use ramp::Ramp;
