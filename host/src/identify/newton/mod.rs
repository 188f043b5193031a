//! Identification by Gauss-Newton on finite elements with their sensitivities.
//!
//! ```text
//! coordinate  what is free, its range, the chain rule to the simulation's parameters
//! condition   one forward problem, shared by runs that repeat it; one solve gives force and all slopes
//! coupon      the forward problems without a ball: homogeneous, or barrelling between platens
//! bulk        coordinates in which a bulk that gives way acts smoothly
//! reference   what Hertz's contact says of relaxation
//! kriging     the smoothest function with given values and slopes
//! surrogate   what the solves so far say about the points between them
//! table       solves made before, as a source of forces
//! track       force over depth and hold time from the surrogate's values
//! problem     weighted differences of all runs, contact points eliminated
//! search      solve, minimise on what is known, solve there: until nothing moves
//! elsewhere   searches from around an end and from all over the box, which may better it
//! nested      simpler laws first, whose best a richer one begins from
//! absolute    the kinked objective of Eq. 14 by a simplex on what was solved
//! linear      the fit near its minimum, row by row: what others do to its errors
//! likelihood  profile intervals
//! fit         all of it, for one material
//! valley      the objective around the minimum, for the report
//! verdict     which parameters these runs identify, and which only in combination
//! ```

pub mod absolute;
pub mod bulk;
pub mod condition;
pub mod coordinate;
mod coupon;
pub mod elsewhere;
pub mod fit;
pub mod kriging;
pub mod likelihood;
pub mod linear;
mod nested;
pub mod problem;
pub mod reference;
pub mod search;
pub mod setup;
pub mod surrogate;
pub mod table;
pub mod track;
pub mod valley;
pub mod verdict;
pub mod weight;
