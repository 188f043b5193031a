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

/// Folds a number into the hash `hash`.
pub(crate) const fn fold_number(mut hash: u64, number: u64) -> u64 {
    let bytes = number.to_le_bytes();
    let mut i = 0;
    while i < bytes.len() {
        hash = (hash ^ bytes[i] as u64).wrapping_mul(0x0000_0100_0000_01b3);
        i += 1;
    }
    hash
}

/// Shape of a type on the wire. Every field of a message needs it: a type without one does not compile.
pub(crate) trait Wire {
    /// Hash over name, fields and the shapes of the fields.
    const SHAPE: u64;
}

macro_rules! plain {
    ($($ty:ty),*) => {$(
        impl Wire for $ty {
            const SHAPE: u64 = fold(FNV_BASIS, stringify!($ty));
        }
    )*};
}
plain!(bool, u8, u16, u32, u64, f32);

impl<T: Wire, const N: usize> Wire for [T; N] {
    const SHAPE: u64 = fold_number(fold_number(fold(FNV_BASIS, "array"), T::SHAPE), N as u64);
}

impl<T: Wire, const N: usize> Wire for heapless::Vec<T, N> {
    const SHAPE: u64 = fold_number(fold_number(fold(FNV_BASIS, "up to"), T::SHAPE), N as u64);
}

impl<T: Wire> Wire for Option<T> {
    const SHAPE: u64 = fold_number(fold(FNV_BASIS, "option"), T::SHAPE);
}

/// Declares a structure or enumeration that travels in a frame.
macro_rules! wire {
    ($($(#[$outer:meta])* pub struct $name:ident { $($(#[$doc:meta])* pub $field:ident : $ty:ty,)* })*) => {$(
        $(#[$outer])*
        #[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        pub struct $name { $($(#[$doc])* pub $field: $ty,)* }

        impl crate::wire::Wire for $name {
            const SHAPE: u64 = {
                #[allow(unused_mut)]
                let mut hash = crate::wire::fold(crate::wire::FNV_BASIS, stringify!($name));
                $(
                    hash = crate::wire::fold(hash, stringify!($field));
                    hash = crate::wire::fold_number(hash, <$ty as crate::wire::Wire>::SHAPE);
                )*
                hash
            };
        }
    )*};
    ($($(#[$outer:meta])* pub enum $name:ident { $($(#[$doc:meta])* $variant:ident $({ $($(#[$fdoc:meta])* $field:ident : $fty:ty,)* })?,)* })*) => {$(
        $(#[$outer])*
        #[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        pub enum $name { $($(#[$doc])* $variant $({ $($(#[$fdoc])* $field: $fty,)* })?,)* }

        impl crate::wire::Wire for $name {
            const SHAPE: u64 = {
                let mut hash = crate::wire::fold(crate::wire::FNV_BASIS, stringify!($name));
                $(
                    hash = crate::wire::fold(hash, stringify!($variant));
                    $($(
                        hash = crate::wire::fold(hash, stringify!($field));
                        hash = crate::wire::fold_number(hash, <$fty as crate::wire::Wire>::SHAPE);
                    )*)?
                )*
                hash
            };
        }
    )*};
}
pub(crate) use wire;

/// Declares the table: the enumeration, its numbers, encoding, decoding and the schema hash.
macro_rules! messages {
    ($hash:ident; $($(#[$outer:meta])* pub enum $set:ident { $($(#[$doc:meta])* $kind:literal $name:ident($body:ty),)* })*) => {
        $(
            $(#[$outer])*
            #[derive(Debug, Clone, PartialEq)]
            pub enum $set { $($(#[$doc])* $name($body),)* }

            impl $set {
                /// Number and name of every message of this direction.
                pub const TABLE: &'static [(u8, &'static str)] = &[$(($kind, stringify!($name)),)*];

                /// Number of this message's kind.
                pub const fn kind(&self) -> u8 {
                    match self { $(Self::$name(_) => $kind,)* }
                }

                /// Writes the body into `buffer`; returns the used part.
                ///
                /// # Errors
                /// `SerializeBufferFull` when `buffer` is too short.
                pub fn encode<'b>(&self, buffer: &'b mut [u8]) -> Result<&'b mut [u8], postcard::Error> {
                    match self { $(Self::$name(body) => postcard::to_slice(body, buffer),)* }
                }

                /// Reads a message of kind `kind` from `body`. Bytes left over are an error.
                ///
                /// # Errors
                /// [`DecodeError::Unknown`] for a number not in the table of this direction,
                /// [`DecodeError::Malformed`] for a body that is not one of this kind.
                pub fn decode(kind: u8, body: &[u8]) -> Result<Self, DecodeError> {
                    match kind {
                        $($kind => match postcard::take_from_bytes::<$body>(body) {
                            Ok((value, [])) => Ok(Self::$name(value)),
                            _ => Err(DecodeError::Malformed { kind }),
                        },)*
                        _ => Err(DecodeError::Unknown { kind }),
                    }
                }
            }
        )*

        /// Fingerprint of the whole table: numbers, names, the shape of every body with all types inside, and the longest body.
        pub const $hash: u64 = {
            let mut hash = FNV_BASIS;
            $($(
                hash = fold(hash, stringify!($kind));
                hash = fold(hash, stringify!($name));
                hash = fold_number(hash, <$body as Wire>::SHAPE);
            )*)*
            // A longer body would be refused by the other side's frames.
            hash = fold_number(hash, crate::frame::MAX_BODY as u64);
            hash
        };
    };
}
pub(crate) use messages;

#[cfg(test)]
mod tests {
    use super::*;

    /// A message of one field, whose type has a name of its own.
    macro_rules! message_of {
        ($module:ident, $inner:ty) => {
            mod $module {
                wire! {
                    /// Inside.
                    pub struct Inner {
                        /// Changes.
                        pub field: $inner,
                    }
                    /// Outside.
                    pub struct Message {
                        /// Stays.
                        pub inner: Inner,
                    }
                }
            }
        };
    }
    message_of!(narrow, u32);
    message_of!(wide, u64);
    message_of!(long, heapless::Vec<u8, 192>);
    message_of!(short, heapless::Vec<u8, 128>);
    message_of!(array, [u8; 3]);
    message_of!(maybe, Option<u32>);

    /// A type that changes inside a message changes the message's shape, though no name changes.
    #[test]
    fn a_change_of_an_inner_type_or_of_a_length_changes_the_shape() {
        let shapes = [
            narrow::Message::SHAPE,
            wide::Message::SHAPE,
            long::Message::SHAPE,
            short::Message::SHAPE,
            array::Message::SHAPE,
            maybe::Message::SHAPE,
        ];
        for (i, shape) in shapes.iter().enumerate() {
            assert!(!shapes[..i].contains(shape), "shape {i}");
        }
    }

    /// The set's bits and the codes of the faults are part of what both sides must agree on.
    #[test]
    fn the_set_of_faults_is_folded_with_its_number_and_its_codes() {
        let mut hash = fold_number(FNV_BASIS, <u32 as Wire>::SHAPE);
        for fault in crate::fault::Fault::ALL {
            hash = fold(hash, fault.code());
        }
        assert_eq!(crate::fault::FaultSet::SHAPE, hash);
        assert_ne!(<u32 as Wire>::SHAPE, <u64 as Wire>::SHAPE);
    }
}
