//! Two links, two hosts, one machine.

use super::*;
use protocol::fault::Fault;
use protocol::message::{HelloRequest, Holder, Status};
use protocol::{PROTOCOL_VERSION, message};

const SHOW: Mode = Mode::Display { material: 0 };

/// Asks over a link and returns what comes back there.
fn ask(bench: &mut Bench, link: LinkId, request: &Request) -> Report {
    let mut buffer = [0; MAX_FRAME];
    bench.board.receive(link, encode_request(request, 7, &mut buffer).unwrap());
    reports(bench, link).pop().expect("an answer on the link that asked")
}

fn reports(bench: &mut Bench, link: LinkId) -> Vec<Report> {
    let (mut out, mut decoder, mut reports) = ([0; crate::link::QUEUE_LEN], Decoder::new(), vec![]);
    let count = bench.board.take_transmit(link, &mut out);
    for byte in &out[..count] {
        if let Some(Ok(frame)) = decoder.push(*byte) {
            reports.push(Report::decode(frame.kind, frame.body).unwrap());
        }
    }
    reports
}

fn status(bench: &mut Bench, link: LinkId) -> Status {
    match ask(bench, link, &Request::Status(Empty {})) {
        Report::Status(status) => status,
        other => panic!("{other:?}"),
    }
}

fn is_refused(report: &Report, because: Refusal) -> bool {
    matches!(report, Report::Refused(Refused { reason, .. }) if *reason == because)
}

/// Displays over USB.
fn displaying() -> Bench {
    let mut bench = Bench::new();
    assert!(matches!(ask(&mut bench, LinkId::Usb, &set_mode(SHOW)), Report::Accepted(_)));
    bench
}

#[test]
fn a_poller_on_one_link_keeps_nothing_alive_for_another() {
    let mut bench = displaying();
    for tick in 0..60 {
        assert_eq!(bench.board.state(), if tick > 50 { State::Fault } else { State::Display }, "tick {tick}");
        status(&mut bench, LinkId::Uart);
        bench.tick();
    }
    assert_eq!(bench.faults(), [Fault::LinkLost]);
}

#[test]
fn what_one_link_states_of_a_surface_is_nothing_to_the_other_nor_to_a_later_mode() {
    let state = Request::ExpectSurface(message::Surface { height_mm: 16.0 });
    let press = set_mode(Mode::Palpate { rate_mm_s: 4.0, depth_mm: 3.5 });
    let lowest_mm = |before: &[(LinkId, &Request)]| {
        let mut bench = Bench::new();
        bench.probe_mm = 17.0;
        for (link, request) in before {
            ask(&mut bench, *link, request);
        }
        assert!(matches!(ask(&mut bench, LinkId::Usb, &press), Report::Accepted(_)));
        bench.run_until(1000, |b| b.board.state() == State::Retract);
        bench.board.measured().probe_mm
    };
    let stated_mm = lowest_mm(&[(LinkId::Usb, &state)]);
    assert!((14.8..=15.0).contains(&stated_mm), "{stated_mm} mm");
    let idle = set_mode(Mode::Idle);
    for before in [vec![(LinkId::Uart, &state)], vec![(LinkId::Usb, &state), (LinkId::Usb, &idle)]] {
        let lowest_mm = lowest_mm(&before);
        assert!(lowest_mm < 11.0, "{lowest_mm} mm");
    }
}

#[test]
fn who_holds_the_motion_is_told_and_only_the_holder_changes_it() {
    let mut bench = displaying();
    assert_eq!(status(&mut bench, LinkId::Usb).holder, Holder::You);
    assert_eq!(status(&mut bench, LinkId::Uart).holder, Holder::Another);
    let other = set_mode(Mode::Display { material: 1 });
    assert!(is_refused(&ask(&mut bench, LinkId::Uart, &other), Refusal::Held));
    let gains = Request::SetGains(crate::pid::DEFAULT_GAINS);
    assert!(is_refused(&ask(&mut bench, LinkId::Uart, &gains), Refusal::Held));
    assert!(matches!(ask(&mut bench, LinkId::Usb, &other), Report::Accepted(_)));
    // Anyone may stop it, and the next one may have it.
    assert!(matches!(ask(&mut bench, LinkId::Uart, &set_mode(Mode::Idle)), Report::Accepted(_)));
    bench.tick();
    assert_eq!((bench.outputs, status(&mut bench, LinkId::Usb).holder), (Outputs::default(), Holder::Nobody));
    assert!(matches!(ask(&mut bench, LinkId::Uart, &other), Report::Accepted(_)));
    assert_eq!(status(&mut bench, LinkId::Uart).holder, Holder::You);
}

#[test]
fn a_palpation_is_held_until_its_probe_is_back() {
    let mut bench = Bench::new();
    assert!(matches!(ask(&mut bench, LinkId::Uart, &set_mode(PALPATE)), Report::Accepted(_)));
    bench.ticks(40);
    assert!(matches!(ask(&mut bench, LinkId::Uart, &set_mode(Mode::Idle)), Report::Accepted(_)));
    assert_eq!(bench.board.state(), State::Retract);
    for _ in 0..3 {
        assert!(is_refused(&ask(&mut bench, LinkId::Usb, &set_mode(SHOW)), Refusal::Held));
        bench.tick();
    }
    bench.ticks(200);
    assert_eq!(bench.board.state(), State::Idle);
    // Both hosts learn how it ended, whoever asked for it.
    assert!(reports(&mut bench, LinkId::Uart).iter().any(|r| matches!(r, Report::Verdict(_))));
    assert!(bench.verdict().is_some());
}

#[test]
fn a_lease_ends_when_it_says_and_may_not_be_longer_than_the_board_allows() {
    for (lease_ms, ticks) in [(100, 6), (500, 26), (1000, 51)] {
        let mut bench = Bench::new();
        bench.accept(&Request::SetMode(ModeRequest { mode: SHOW, lease_ms }));
        let lost = (1..100).find(|_| {
            bench.tick();
            bench.faults() == [Fault::LinkLost]
        });
        assert_eq!(lost, Some(ticks), "{lease_ms} ms");
    }
    for lease_ms in [0, 99, 1001, u16::MAX] {
        let mut bench = Bench::new();
        assert_eq!(bench.refusal(&Request::SetMode(ModeRequest { mode: SHOW, lease_ms })), Refusal::OutOfRange);
        bench.accept(&Request::SetMode(ModeRequest { mode: Mode::Idle, lease_ms }));
    }
}

#[test]
fn an_old_tool_and_noise_on_one_link_change_nothing_on_the_other() {
    let mut bench = displaying();
    let strange =
        Request::Hello(HelloRequest { protocol_version: PROTOCOL_VERSION, schema_hash: message::SCHEMA_HASH ^ 1 });
    assert!(matches!(ask(&mut bench, LinkId::Uart, &strange), Report::Hello(_)));
    let refused = ask(&mut bench, LinkId::Uart, &set_mode(Mode::Idle));
    assert!(is_refused(&refused, Refusal::SchemaMismatch));
    // A frame of the one, cut in two by a modem probe and half a frame on the other.
    let mut buffer = [0; MAX_FRAME];
    let frame = encode_request(&Request::Status(Empty {}), 9, &mut buffer).unwrap().to_vec();
    let (begin, end) = frame.split_at(frame.len() / 2);
    bench.board.receive(LinkId::Usb, begin);
    bench.board.receive(LinkId::Uart, b"AT\r\0");
    bench.board.receive(LinkId::Uart, begin);
    bench.board.receive(LinkId::Usb, end);
    assert!(matches!(reports(&mut bench, LinkId::Usb)[..], [Report::Status(_)]));
    assert!(reports(&mut bench, LinkId::Uart).is_empty());
    assert_eq!(status(&mut bench, LinkId::Usb).frames_rejected, 0);
    assert_eq!(bench.board.state(), State::Display);
}

/// An erase takes seconds; its end is the answer to the link that asked, and to nobody else.
#[test]
fn the_end_of_an_erase_is_told_to_the_link_that_asked() {
    let mut bench = Bench::new();
    let mut buffer = [0; MAX_FRAME];
    let begin = Request::TableBegin(message::TableBegin { length: 1000, crc: 0 });
    bench.board.receive(LinkId::Uart, encode_request(&begin, 7, &mut buffer).unwrap());
    bench.ticks(3);
    assert!(matches!(reports(&mut bench, LinkId::Uart)[..], [Report::TableState(_)]));
    assert!(bench.reports.is_empty());
}
