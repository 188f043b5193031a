//! Tests in which every point of the specimen deforms alike: stress over stretch and time.
//!
//! A [`Coupon`] is a material in one [`Mode`] of deformation, led along a [`Programme`]. The stress is the one the
//! finite elements compute at a material point ([`crate::solid::law::Material::stress`] with its history), so that a
//! material fitted here is the same material there. A free lateral stretch is solved for at every step, and its
//! derivatives follow by implicit differentiation: with `q(s, p) = P : dF/ds = 0`, `ds/dp = -(dq/dp) / (dq/ds)`,
//! histories carried along.
//!
//! ```
//! use lut_gen::solid::homogeneous::{Coupon, Mode, Programme};
//! use lut_gen::solid::law::{Hyperfoam, Parameter};
//!
//! let foam = Hyperfoam::one_term(0.22, 10.526)?;
//! let coupon = Coupon { material: foam.into(), mode: Mode::Uniaxial, area_mm2: 400.0 };
//! let press = Programme { time_s: vec![0.0, 1.0, 2.0], stretch: vec![1.0, 0.8, 0.6] };
//! let response = coupon.follow(&press, &[Parameter::Mu(0)])?;
//! assert!(response.force_n(&coupon)[2] < response.force_n(&coupon)[1]);
//! assert!((response.sensitivities[0].stress_mpa[2] * 0.22 - response.stress_mpa[2]).abs() < 1e-12);
//! # Ok::<(), lut_gen::solid::solve::SolveError>(())
//! ```

mod coupon;
mod mode;
mod programme;

pub use coupon::{Coupon, Response, StressSensitivity};
pub use mode::Mode;
pub use programme::Programme;
