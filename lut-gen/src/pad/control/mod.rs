//! Control curves: the yield stress over travel with which a block that yields feels like a foam.
//!
//! A finger on the foam has a force and a contact area at every travel. A finger on a block whose
//! yield stress follows a curve has others; the curve is chosen so that both are met as well as can
//! be, by least squares (thesis section 4.3, Figs. 57 and 58). Beside it stand the averages of the
//! foam's own Mises stress, which need no search.

pub mod curve;
pub mod felt;
pub mod latch;
pub mod search;
