//! Host and real image of different versions: the frozen rescue message gets through, and each side says what to do.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use emulator::board::EmulatedBoard;
use emulator::link::EmulatedUart;
use firmware::board::FIRMWARE_VERSION;
use palpate::link::{Link, LinkError};
use palpate::session::{Patience, Session};
use protocol::frame::{Decoder, MAX_FRAME, encode, encode_report, encode_request};
use protocol::message::{
    EARLIER, Empty, Hello, HelloRequest, Mode, ModeRequest, Refusal, Report, Request, SCHEMA_HASH,
};
use protocol::{PROTOCOL_VERSION, rescue};

use crate::common;

type Frame = (u8, Vec<u8>);

/// Frames that the board sends within 100 ms of these bytes.
fn answers(board: &mut EmulatedBoard, bytes: &[u8]) -> Vec<Frame> {
    board.receive(bytes);
    board.run_s(0.1).unwrap();
    let mut decoder = Decoder::new();
    let sent = board.take_transmit();
    sent.iter().filter_map(|byte| decoder.push(*byte)?.ok().map(|frame| (frame.kind, frame.body.to_vec()))).collect()
}

fn asked(board: &mut EmulatedBoard, request: &Request) -> Report {
    let mut out = [0; MAX_FRAME];
    let frames = answers(board, encode_request(request, 1, &mut out).unwrap());
    let (kind, body) = frames.first().expect("an answer");
    Report::decode(*kind, body).unwrap()
}

fn rescue_question() -> Vec<u8> {
    let mut out = [0; MAX_FRAME];
    let fill = |room: &mut [u8]| {
        room[..rescue::QUESTION.len()].copy_from_slice(&rescue::QUESTION);
        Some(rescue::QUESTION.len())
    };
    encode(rescue::KIND, 1, fill, &mut out).unwrap().to_vec()
}

/// The 14 bytes that every host there ever was can read.
fn rescue_answer() -> Vec<u8> {
    let mut bytes = b"PALP!".to_vec();
    bytes.extend(PROTOCOL_VERSION.to_le_bytes());
    bytes.extend(FIRMWARE_VERSION);
    bytes.extend(&SCHEMA_HASH.to_le_bytes()[..4]);
    bytes
}

#[test]
fn an_old_host_is_told_who_the_board_is_and_can_do_nothing_else() {
    for old in [
        HelloRequest { protocol_version: PROTOCOL_VERSION - 1, schema_hash: SCHEMA_HASH },
        HelloRequest { protocol_version: PROTOCOL_VERSION, schema_hash: SCHEMA_HASH ^ 1 << 40 },
    ] {
        let mut board = common::board();
        board.run_to_tick(5.0).unwrap();
        assert!(
            matches!(asked(&mut board, &Request::Hello(old)), Report::Hello(hello) if hello.schema_hash == SCHEMA_HASH)
        );
        let palpate =
            Request::SetMode(ModeRequest { mode: Mode::Palpate { rate_mm_s: 2.0, depth_mm: 4.0 }, lease_ms: 1000 });
        for request in [Request::Status(Empty {}), palpate, Request::ClearFaults(Empty {})] {
            let refused = asked(&mut board, &request);
            assert!(matches!(refused, Report::Refused(ref r) if r.reason == Refusal::SchemaMismatch), "{refused:?}");
        }
        assert_eq!(answers(&mut board, &rescue_question()), [(rescue::KIND, rescue_answer())]);
        assert!(board.pins().off());
    }
}

/// A host that does not even know these messages: what it sends is refused by number, and the rescue question is answered.
#[test]
fn a_host_of_another_kind_is_refused_and_rescued() {
    let mut board = common::board();
    board.run_to_tick(5.0).unwrap();
    let mut out = [0; MAX_FRAME];
    let unknown = encode(0x6e, 7, |_| Some(20), &mut out).unwrap().to_vec();
    let frames = answers(&mut board, &unknown);
    let (kind, body) = frames.first().expect("an answer");
    let Ok(Report::Refused(refused)) = Report::decode(*kind, body) else { panic!("{frames:?}") };
    assert_eq!((refused.of, refused.seq, refused.reason), (0x6e, 7, Refusal::Unknown));
    assert_eq!(answers(&mut board, &rescue_question()), [(rescue::KIND, rescue_answer())]);
}

/// What an old image would say differently.
enum Old {
    /// It was built from another message table.
    Schema(u64),
    /// It knows no message of this version; only the rescue question is answered, with its own version.
    Version(u16),
}

/// The image seen as an older one.
struct Aged {
    inner: EmulatedUart<EmulatedBoard>,
    old: Old,
    decoder: Decoder,
}

impl Aged {
    /// What the old image would have sent in place of a frame.
    fn aged(&self, kind: u8, seq: u16, body: &[u8]) -> Option<Vec<u8>> {
        let mut out = [0; MAX_FRAME];
        let report = (kind != rescue::KIND).then(|| Report::decode(kind, body).unwrap());
        match (&self.old, report) {
            (Old::Schema(hash), Some(Report::Hello(hello))) => {
                let hello = Report::Hello(Hello { schema_hash: *hash, ..hello });
                Some(encode_report(&hello, seq, &mut out).unwrap().to_vec())
            }
            (Old::Version(_), Some(_)) => None,
            (Old::Schema(_), Some(report)) => Some(encode_report(&report, seq, &mut out).unwrap().to_vec()),
            (old, None) => {
                let mut answer = rescue::Answer::from_bytes(body)?;
                match old {
                    Old::Schema(hash) => answer.schema_hash_low = *hash as u32,
                    Old::Version(version) => answer.protocol_version = *version,
                }
                let fill = |room: &mut [u8]| {
                    room[..rescue::ANSWER_LEN].copy_from_slice(&answer.to_bytes());
                    Some(rescue::ANSWER_LEN)
                };
                Some(encode(kind, seq, fill, &mut out).unwrap().to_vec())
            }
        }
    }
}

impl Link for Aged {
    fn name(&self) -> &str {
        "the old board"
    }
    fn now_s(&self) -> f64 {
        self.inner.now_s()
    }
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.inner.send(bytes)
    }
    fn receive(&mut self, into: &mut Vec<u8>, deadline_s: f64) -> Result<(), LinkError> {
        let mut bytes = Vec::new();
        self.inner.receive(&mut bytes, deadline_s)?;
        for byte in bytes {
            let frame = self.decoder.push(byte).and_then(Result::ok).map(|f| (f.kind, f.seq, f.body.to_vec()));
            if let Some((kind, seq, body)) = frame {
                into.extend(self.aged(kind, seq, &body).unwrap_or_default());
            }
        }
        Ok(())
    }
}

#[test]
fn a_new_host_asks_an_old_board_by_the_frozen_message_and_says_what_to_do() {
    let open = |old| {
        let aged = Aged { inner: EmulatedUart::new(common::board()), old, decoder: Decoder::new() };
        Session::open(aged, Patience::default()).err().expect("versions differ").to_string()
    };
    assert_eq!(
        open(Old::Version(0)),
        "the old board runs firmware 0.1.0 with protocol version 0, this tool speaks version 2: write newer firmware with `palpate flash`"
    );
    assert_eq!(
        open(Old::Version(7)),
        "the old board runs firmware 0.1.0 with protocol version 7, this tool speaks version 2: use a newer palpate"
    );
    let schema = open(Old::Schema(0x1234_5678_9abc_def0));
    assert!(
        schema.starts_with("the old board runs firmware 0.1.0, built from another message table (schema 9abcdef0,"),
        "{schema}"
    );
    assert!(schema.ends_with("write the firmware that belongs to this tool with `palpate flash`"), "{schema}");
}

/// A board of a table that this one only adds to: it is greeted as its own tool greets it, and understood.
#[test]
fn a_new_host_talks_to_a_board_of_the_table_before() {
    let aged =
        Aged { inner: EmulatedUart::new(common::board()), old: Old::Schema(EARLIER[0]), decoder: Decoder::new() };
    let (mut session, hello) = Session::open(aged, Patience::default()).unwrap();
    assert_eq!(hello.schema_hash, EARLIER[0]);
    session.set_mode(Mode::Idle).unwrap();
    assert!(session.status().unwrap().faults.is_empty());
}
