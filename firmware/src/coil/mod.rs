//! From the coil's current to the duty of its switch.
//!
//! Which current a material asks for stands in the table ([`protocol::lut::Material::current`]); it is
//! limited by the winding's temperature ([`thermal`]) and regulated by the duty ([`regulator`]). What
//! the winding is stands in [`winding`]; what current its duties must have made in [`expected`].

pub mod expected;
pub mod regulator;
pub mod thermal;
pub mod winding;
