//! Structures that travel, and a fingerprint of their shape.
//!
//! postcard carries no field names or types, so two builds that disagree about a structure would
//! exchange nonsense with a valid CRC. Every structure is therefore declared inside [`wire!`], which
//! folds its field names and types into [`crate::message::SCHEMA_HASH`]; `hello` compares the hashes.

/// FNV-1a offset basis, 64 bit (Fowler, Noll, Vo; draft-eastlake-fnv).
pub(crate) const FNV_BASIS: u64 = 0xcbf2_9ce4_8422_2325;

/// Folds `text` into the FNV-1a hash `hash`.
pub(crate) const fn fold(mut hash: u64, text: &str) -> u64 {
    let bytes = text.as_bytes();
    let mut i = 0;
    while i < bytes.len() {
        hash = (hash ^ bytes[i] as u64).wrapping_mul(0x0000_0100_0000_01b3);
        i += 1;
    }
    hash
}

/// Shape of a type on the wire, as text, for the schema hash.
pub(crate) trait Wire {
    /// Fields or variants in order, with their types.
    const SHAPE: &'static str;
}

/// Declares a structure or enumeration that travels in a frame.
macro_rules! wire {
    ($($(#[$outer:meta])* pub struct $name:ident { $($(#[$doc:meta])* pub $field:ident : $ty:ty,)* })*) => {$(
        $(#[$outer])*
        #[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        pub struct $name { $($(#[$doc])* pub $field: $ty,)* }

        impl crate::wire::Wire for $name {
            const SHAPE: &'static str = concat!($(stringify!($field), ":", stringify!($ty), ";",)*);
        }
    )*};
    ($($(#[$outer:meta])* pub enum $name:ident { $($(#[$doc:meta])* $variant:ident $({ $($(#[$fdoc:meta])* $field:ident : $ty:ty,)* })?,)* })*) => {$(
        $(#[$outer])*
        #[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        pub enum $name { $($(#[$doc])* $variant $({ $($(#[$fdoc])* $field: $ty,)* })?,)* }

        impl crate::wire::Wire for $name {
            const SHAPE: &'static str = concat!($(stringify!($variant), $("{", $(stringify!($field), ":", stringify!($ty), ";",)* "}",)? "|",)*);
        }
    )*};
}
pub(crate) use wire;
