//! The bytes of protocol version 2 and of table layouts 1 and 2. A released board depends on them.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use protocol::frame::{Decoder, MAX_FRAME, encode, encode_report, encode_request};
use protocol::lut::Table;
use protocol::message::{EARLIER, Report, Request, SCHEMA_HASH};
use tests::{golden, samples};

/// Every message as (name, its frame with sequence number 0x0102).
fn frames() -> Vec<(String, Vec<u8>)> {
    let mut out = [0; MAX_FRAME];
    let named = |table: &[(u8, &str)], kind: u8| {
        table.iter().find(|(k, _)| *k == kind).map(|(k, name)| format!("0x{k:02x} {name}")).unwrap()
    };
    let mut all = vec![];
    for message in samples::requests() {
        let frame = encode_request(&message, 0x0102, &mut out).unwrap().to_vec();
        all.push((named(Request::TABLE, message.kind()), frame));
    }
    for message in samples::reports() {
        let frame = encode_report(&message, 0x0102, &mut out).unwrap().to_vec();
        all.push((named(Report::TABLE, message.kind()), frame));
    }
    let question = |b: &mut [u8]| {
        b[..5].copy_from_slice(&protocol::rescue::QUESTION);
        Some(5)
    };
    all.push(("0x00 Rescue".into(), encode(protocol::rescue::KIND, 0x0102, question, &mut out).unwrap().to_vec()));
    all
}

#[test]
fn every_message_keeps_its_bytes() {
    let frames = frames();
    assert_eq!(frames.len(), Request::TABLE.len() + Report::TABLE.len() + 1, "a message without a sample");
    let mut text: String = frames.iter().map(|(name, bytes)| format!("{name} {}\n", golden::hex(bytes))).collect();
    text += &format!("schema hash {SCHEMA_HASH:016x}\n");
    golden::compare("frames-v2.txt", &text).unwrap();
}

/// Tables of this version that the present one adds to: every message of theirs has the bytes it had.
#[test]
fn messages_of_earlier_tables_keep_their_bytes() {
    let now: Vec<String> = frames().iter().map(|(name, bytes)| format!("{name} {}", golden::hex(bytes))).collect();
    for hash in EARLIER {
        let name = format!("frames-v2-{:08x}.txt", hash >> 32);
        let text = std::fs::read_to_string(golden::path(&name)).unwrap();
        let (messages, last) = text.trim_end().rsplit_once('\n').unwrap();
        assert_eq!(last, format!("schema hash {hash:016x}"));
        for line in messages.lines() {
            assert!(now.iter().any(|message| message == line), "{name}: {line}");
        }
    }
    assert!(!EARLIER.contains(&SCHEMA_HASH), "a table that says it is earlier than itself");
}

#[test]
fn every_message_survives_the_line() {
    let mut decoder = Decoder::new();
    let mut out = [0; MAX_FRAME];
    for (seq, message) in samples::requests().iter().enumerate() {
        let bytes = encode_request(message, seq as u16, &mut out).unwrap().to_vec();
        let (kind, body) = last_frame(&mut decoder, &bytes);
        assert_eq!(Request::decode(kind, &body).as_ref(), Ok(message));
        assert!(Report::decode(kind, &body).is_err(), "a request is no report");
    }
    for message in &samples::reports() {
        let bytes = encode_report(message, 9, &mut out).unwrap().to_vec();
        let (kind, body) = last_frame(&mut decoder, &bytes);
        assert_eq!(Report::decode(kind, &body).as_ref(), Ok(message));
    }
}

fn last_frame(decoder: &mut Decoder, bytes: &[u8]) -> (u8, Vec<u8>) {
    let mut found = None;
    for byte in bytes {
        if let Some(frame) = decoder.push(*byte) {
            let frame = frame.unwrap();
            found = Some((frame.kind, frame.body.to_vec()));
        }
    }
    found.unwrap()
}

/// Each single-bit flip of each golden frame: none may pass as any frame. A flip may make a zero and cut the
/// frame in two, or take away the final zero and join it with what follows: no part may pass either.
#[test]
fn no_flipped_bit_is_accepted() {
    for (name, bytes) in frames() {
        for bit in 0..bytes.len() * 8 {
            let mut broken = bytes.clone();
            broken[bit / 8] ^= 1 << (bit % 8);
            broken.push(0);
            let mut decoder = Decoder::new();
            for byte in &broken {
                if let Some(Ok(frame)) = decoder.push(*byte) {
                    panic!("{name}, bit {bit}: accepted as kind {}", frame.kind);
                }
            }
        }
    }
}

#[test]
fn the_table_keeps_its_bytes() {
    let bytes = samples::small_table().to_bytes().unwrap();
    let text: String = bytes.chunks(32).map(|row| golden::hex(row) + "\n").collect();
    golden::compare("table-v2.txt", &text).unwrap();
    let table = Table::parse(&bytes).unwrap();
    assert_eq!(table.column_value(4, "alpha"), Some(2.0));
}

/// A table of the version before, as it was written then: all that it holds is read, and it has no coil curve.
#[test]
fn a_table_of_version_1_is_read() {
    let text = std::fs::read_to_string(golden::path("table-v1.txt")).unwrap();
    let digits: Vec<u8> = text.bytes().filter(u8::is_ascii_hexdigit).collect();
    let byte = |pair: &[u8]| u8::from_str_radix(std::str::from_utf8(pair).unwrap(), 16).unwrap();
    let bytes: Vec<u8> = digits.chunks(2).map(byte).collect();
    let (old, new) = (Table::parse(&bytes).unwrap(), samples::small_table().to_bytes().unwrap());
    let new = Table::parse(&new).unwrap();
    assert_eq!((old.version(), new.version()), (1, 2));
    assert_eq!(old.material_count(), 1);
    let (foam, same) = (old.material(0).unwrap(), new.material(0).unwrap());
    assert_eq!((foam.name, foam.mu_mpa, foam.alpha, foam.height_mm), ("foam", 0.2, 2.0, 10.0));
    for depth_mm in [0.25, 0.5, 1.3, 2.0] {
        let (at, same_at) = (old.locate(depth_mm).unwrap(), new.locate(depth_mm).unwrap());
        assert_eq!(foam.force_n(at), same.force_n(same_at));
        assert_eq!(old.force_n(at, 4), new.force_n(same_at, 4));
    }
    // The points of version 1 are nodes of version 2, whose forces are rounded to 65,535ths of 3 N.
    for force_n in [0.0, 0.5, 1.0, 2.5, 3.0, 9.0, f32::NAN] {
        let off_mm = (foam.shaft_mm(force_n) - same.shaft_mm(force_n)).abs();
        assert!(off_mm < 1e-4, "{force_n} N: {off_mm} mm");
    }
    assert_eq!((foam.current(1.0), foam.coil()), (None, None), "the actuator alone");
    assert_eq!(foam.display_force_max_n(), 3.0);
    let again = old.checked().open(&bytes).unwrap();
    assert_eq!(again.material(0).unwrap().shaft_mm(2.5), foam.shaft_mm(2.5));
    for bit in 0..bytes.len() * 8 {
        let mut broken = bytes.clone();
        broken[bit / 8] ^= 1 << (bit % 8);
        assert!(Table::parse(&broken).is_err(), "bit {bit}");
    }
}
