//! Force models as bytes, to be kept between two calls of a program.

use std::hash::{DefaultHasher, Hash, Hasher};

use crc::{CRC_32_ISO_HDLC, Crc};

use super::library::Family;
use super::{Geometry, Library};

/// Of the sources that made a model: another version may make another one.
const FINGERPRINT: &str = env!("LUT_GEN_FINGERPRINT");

const CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

impl Library {
    /// A name for the file of a geometry's models, another one for every geometry and every version of the code that makes them.
    #[must_use]
    pub fn file_name(geometry: &Geometry) -> String {
        let mut hasher = DefaultHasher::new();
        postcard::to_allocvec(geometry).unwrap_or_default().hash(&mut hasher);
        format!("{FINGERPRINT}-{:016x}.force", hasher.finish())
    }

    /// The models of one geometry as bytes with a checksum; none where it is not in the library, or lacks something: what failed may not fail next time.
    #[must_use]
    pub fn to_bytes(&self, geometry: &Geometry) -> Option<Vec<u8>> {
        let family = self.families.iter().find(|family| family.geometry == *geometry && family.is_complete())?;
        postcard::to_allocvec_crc32(&(FINGERPRINT, family), CRC.digest()).ok()
    }

    /// A library of one geometry, from [`Library::to_bytes`]; none where the bytes are damaged, or are those of another geometry or another version.
    #[must_use]
    pub fn from_bytes(bytes: &[u8], geometry: &Geometry) -> Option<Self> {
        let (version, family): (String, Family) = postcard::from_bytes_crc32(bytes, CRC.digest()).ok()?;
        (version == FINGERPRINT && family.geometry == *geometry).then(|| Self { families: vec![family] })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::super::Need;
    use super::*;
    use crate::solid::model::Specimen;

    #[test]
    fn what_is_read_back_is_what_was_kept_and_damage_is_seen() {
        let geometry = Geometry { specimen: Specimen::of_height(12.7), ball_mm: 4.0, depth_mm: 0.5, nu: 0.0 };
        let other = Geometry { depth_mm: 0.75, ..geometry };
        let library = Library::build(&[geometry], Need::default(), &|_, _| {}).unwrap();
        assert_eq!(library.to_bytes(&other), None);
        assert_ne!(Library::file_name(&geometry), Library::file_name(&other));
        let bytes = library.to_bytes(&geometry).unwrap();
        let read = Library::from_bytes(&bytes, &geometry).unwrap();
        assert_eq!(read.to_bytes(&geometry).unwrap(), bytes);
        assert_eq!(read.solves(), library.solves());
        let slice = |l: &Library| l.families[0].slice(7.3, 0.0, 12.7, 0.0);
        assert_eq!(slice(&read), slice(&library));
        assert!(Library::from_bytes(&bytes, &other).is_none());
        for at in 0..bytes.len() {
            let mut damaged = bytes.clone();
            damaged[at] ^= 0x10;
            assert!(Library::from_bytes(&damaged, &geometry).is_none(), "byte {at}");
            assert!(Library::from_bytes(&bytes[..at], &geometry).is_none(), "{at} bytes");
        }
    }
}
