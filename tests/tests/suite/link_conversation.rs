//! Conversations over every link that needs no hardware: what is lost, what is refused, and what is said about it.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use palpate::link::{Address, Disturbance, Disturbed, InProcess, Link, LinkError, Pace, Tcp};
use palpate::plant::Jitter;
use palpate::session::{Event, Patience, Session, SessionError};
use palpate::simulated_board::{SimulatedBoard, serve};
use protocol::frame::{self, Decoder, MAX_FRAME};
use protocol::lut::Table;
use protocol::message::{Mode, Slot, State};
use protocol::rescue;
use tests::samples::small_table;

fn board() -> InProcess {
    InProcess::new(SimulatedBoard::new(1, Jitter::NONE), Pace::Free)
}

/// A table long enough for an upload of many pieces.
fn long_table() -> Vec<u8> {
    let mut spec = small_table();
    spec.provenance = "a sentence that makes the table long enough for an upload of many pieces; ".repeat(300);
    spec.to_bytes().unwrap()
}

#[test]
fn a_clean_line_loses_nothing() {
    let (mut session, hello) = Session::open(board(), Patience::default()).unwrap();
    assert!(hello.simulated);
    let until_s = session.link().now_s() + 10.0;
    let mut ticks = Vec::new();
    while let Some(event) = session.poll(until_s).unwrap() {
        if let Event::Telemetry(t) = event {
            ticks.push(t.tick);
        }
    }
    // 10 s at 50 Hz, one record a tick.
    assert_eq!(ticks.len(), 500);
    assert!(ticks.windows(2).all(|w| w[1] == w[0] + 1));
    let traffic = session.traffic();
    assert_eq!((traffic.frames_lost, traffic.telemetry_lost, traffic.frames_damaged), (0, 0, 0));
    assert_eq!(session.status().unwrap().state, State::Idle);
}

#[test]
fn damaged_frames_are_counted_and_requests_repeated_until_they_get_through() {
    // Three bytes in 1000 damaged: one exchange in five fails, four in a row in one of 600.
    let line = Disturbed::new(board(), Disturbance::default(), 7);
    let (mut session, _) = Session::open(line, Patience::default()).unwrap();
    session.link_mut().set_disturbance(Disturbance { flip: 0.003, ..Disturbance::default() });
    let patience_beaten = (0..50).filter(|_| session.status().is_err()).count();
    assert_eq!(patience_beaten, 0, "{:?}", session.traffic());
    let until_s = session.link().now_s() + 10.0;
    let mut received = 0;
    while let Some(event) = session.poll(until_s).unwrap() {
        received += u64::from(matches!(event, Event::Telemetry(_)));
    }
    let traffic = session.traffic();
    assert!(traffic.frames_damaged > 50, "{traffic:?}");
    assert!(traffic.requests_repeated > 0, "{traffic:?}");
    assert!(traffic.telemetry_lost > 50 && received > 100, "{traffic:?}");
    // Nothing is lost unnoticed: every tick of the ten seconds is either here or counted.
    session.link_mut().set_disturbance(Disturbance::default());
    session.poll(session.link().now_s() + 0.1).unwrap();
    let traffic = session.traffic();
    let last = loop {
        match session.poll(session.link().now_s() + 0.1).unwrap() {
            Some(Event::Telemetry(t)) => break t.tick,
            Some(_) => {}
            None => panic!("telemetry stopped"),
        }
    };
    let traffic_after = session.traffic();
    assert!(traffic_after.telemetry_received >= traffic.telemetry_received);
    // The board's first record came in its first tick after the greeting.
    let first_missing = u64::from(last) - traffic_after.telemetry_received - traffic_after.telemetry_lost;
    assert!(first_missing <= 2, "{first_missing} records neither received nor counted: {traffic_after:?}");
}

#[test]
fn a_silent_board_is_reported_with_time_and_request() {
    let dead = Disturbance { dead_after_s: Some(0.0), ..Disturbance::default() };
    let line = Disturbed::new(board(), Disturbance::default(), 1);
    let (mut session, _) = Session::open(line, Patience::default()).unwrap();
    session.link_mut().set_disturbance(dead);
    let error = session.set_mode(Mode::Idle).unwrap_err();
    assert_eq!(
        error.to_string(),
        "no answer from the simulated board within 1040 ms to SetMode (4 attempts, 0 damaged frames meanwhile): \
         is the board powered, and is nothing else using the link?"
    );
    // Back on the line the conversation goes on: nothing is stuck.
    session.link_mut().set_disturbance(Disturbance::default());
    session.set_mode(Mode::Idle).unwrap();

    let silent = Disturbed::new(board(), dead, 1);
    let error = Session::open(silent, Patience::default()).unwrap_err();
    assert!(error.to_string().starts_with("no answer from the simulated board within "), "{error}");
    assert!(error.to_string().contains(" to Hello (4 attempts"), "{error}");
}

#[test]
fn refusals_say_why() {
    let (mut session, _) = Session::open(board(), Patience::default()).unwrap();
    let error = session.set_mode(Mode::Palpate { rate_mm_s: 2.0, depth_mm: 4.0 }).unwrap_err();
    assert_eq!(error.to_string(), "the simulated board refused SetMode: the board holds no valid table: upload one");
    session.upload(&small_table().to_bytes().unwrap(), |_| {}).unwrap();
    let error = session.set_mode(Mode::Palpate { rate_mm_s: 9.0, depth_mm: 0.5 }).unwrap_err();
    assert_eq!(error.to_string(), "the simulated board refused SetMode: a value is outside the board's own limits");
}

#[test]
fn an_upload_survives_a_bad_line() {
    let table = long_table();
    let hash = Table::parse(&table).unwrap().hash();
    let line = Disturbed::new(board(), Disturbance::default(), 3);
    let (mut session, _) = Session::open(line, Patience::default()).unwrap();
    session.link_mut().set_disturbance(Disturbance { flip: 0.0005, lose: 0.0002, dead_after_s: None });
    let mut seen = Vec::new();
    let state = session.upload(&table, |p| seen.push(p.sent)).unwrap();
    assert_eq!((state.hash, state.active), (hash, Slot::A));
    assert!(session.traffic().requests_repeated > 0, "{:?}", session.traffic());
    assert!(seen.windows(2).all(|w| w[1] >= w[0]) && *seen.last().unwrap() as usize == table.len());
}

/// A cable that is pulled after some requests.
struct Pulled {
    inner: InProcess,
    sends_left: u32,
}

impl Link for Pulled {
    fn name(&self) -> &str {
        self.inner.name()
    }
    fn now_s(&self) -> f64 {
        self.inner.now_s()
    }
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        if self.sends_left == 0 {
            return Ok(());
        }
        self.sends_left -= 1;
        self.inner.send(bytes)
    }
    fn receive(&mut self, into: &mut Vec<u8>, deadline_s: f64) -> Result<(), LinkError> {
        self.inner.receive(into, deadline_s)
    }
}

#[test]
fn an_upload_goes_on_where_a_pulled_cable_stopped_it() {
    let table = long_table();
    let (mut session, _) = Session::open(Pulled { inner: board(), sends_left: u32::MAX }, Patience::default()).unwrap();
    session.link_mut().sends_left = 40;
    let mut sent = 0;
    let error = session.upload(&table, |p| sent = p.sent).unwrap_err().to_string();
    assert!(error.starts_with("no answer from the simulated board within "), "{error}");
    assert!(sent > 30 * 192 && (sent as usize) < table.len(), "stopped at {sent} of {}", table.len());

    session.link_mut().sends_left = u32::MAX;
    let mut first = None;
    let state = session
        .upload(&table, |p| {
            first.get_or_insert(p.sent);
        })
        .unwrap();
    assert!(first.unwrap() >= sent, "went on at {first:?}, had stopped at {sent}");
    assert_eq!(state.hash, Table::parse(&table).unwrap().hash());

    // An unfinished upload of another table of the same length does not get mixed in.
    let other = {
        let mut spec = small_table();
        spec.provenance = "A sentence that makes the table long enough for an upload of many pieces; ".repeat(300);
        spec.to_bytes().unwrap()
    };
    assert_eq!(other.len(), table.len());
    session.link_mut().sends_left = 40;
    assert!(session.upload(&other, |_| {}).is_err());
    session.link_mut().sends_left = u32::MAX;
    let state = session.upload(&table, |_| {}).unwrap();
    assert_eq!(state.hash, Table::parse(&table).unwrap().hash());
}

#[test]
fn bad_tables_are_refused_before_anything_is_sent_and_by_the_board() {
    let table = long_table();
    let (mut session, _) = Session::open(board(), Patience::default()).unwrap();
    let sent = |session: &Session<InProcess>| session.traffic().frames_received;
    let before = sent(&session);

    let error = session.upload(&table[..table.len() / 2], |_| {}).unwrap_err();
    let expected = format!("table not sent: table truncated: {} bytes of {}", table.len() / 2, table.len());
    assert_eq!(error.to_string(), expected);

    let mut newer = table.clone();
    newer[8] = 3;
    let error = session.upload(&newer, |_| {}).unwrap_err();
    assert_eq!(
        error.to_string(),
        "table not sent: table layout version 3, this build reads versions 1 to 2: make the table again with `palpate lut`"
    );

    let mut damaged = table.clone();
    *damaged.last_mut().unwrap() ^= 1;
    let error = session.upload(&damaged, |_| {}).unwrap_err();
    assert_eq!(error.to_string(), "table not sent: table payload fails its CRC-32");
    assert_eq!(sent(&session), before, "a bad table must not reach the line");

    // The board does not trust the host: a wrong-version table that is sent all the same is rejected at the end, and the old
    // table stays in use.
    session.upload(&table, |_| {}).unwrap();
    let active = session.status().unwrap().table_hash;
    let error = session.upload_unchecked(&newer).unwrap_err();
    assert_eq!(error.to_string(), "the simulated board refused TableCommit: the table did not pass the board's checks");
    assert_eq!(session.status().unwrap().table_hash, active);
    let cut = &table[..table.len() / 2];
    let error = session.upload_unchecked(cut).unwrap_err();
    assert!(matches!(error, SessionError::Refused { .. }), "{error}");
    assert_eq!(session.status().unwrap().table_hash, active);
}

/// A board of another version: answers nothing but the rescue question.
struct Foreign {
    version: u16,
    decoder: Decoder,
    out: Vec<u8>,
    now_s: f64,
}

impl Link for Foreign {
    fn name(&self) -> &str {
        "serial:/dev/ttyACM0"
    }
    fn now_s(&self) -> f64 {
        self.now_s
    }
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        for byte in bytes {
            if let Some(Ok(frame)) = self.decoder.push(*byte)
                && frame.kind == rescue::KIND
                && frame.body == rescue::QUESTION
            {
                let answer = rescue::Answer {
                    protocol_version: self.version,
                    firmware_version: [2, 3, 4],
                    schema_hash_low: 0xabad_cafe,
                };
                let mut buffer = [0; MAX_FRAME];
                let fill = |body: &mut [u8]| {
                    body[..rescue::ANSWER_LEN].copy_from_slice(&answer.to_bytes());
                    Some(rescue::ANSWER_LEN)
                };
                self.out.extend_from_slice(frame::encode(rescue::KIND, 0, fill, &mut buffer).unwrap());
            }
        }
        Ok(())
    }
    fn receive(&mut self, into: &mut Vec<u8>, deadline_s: f64) -> Result<(), LinkError> {
        self.now_s = self.now_s.max(deadline_s);
        into.append(&mut self.out);
        Ok(())
    }
}

#[test]
fn boards_of_other_versions_are_recognised_by_the_rescue_message() {
    let open = |version| {
        let foreign = Foreign { version, decoder: Decoder::new(), out: Vec::new(), now_s: 0.0 };
        Session::open(foreign, Patience::default()).err().unwrap().to_string()
    };
    assert_eq!(
        open(7),
        "serial:/dev/ttyACM0 runs firmware 2.3.4 with protocol version 7, this tool speaks version 2: use a newer palpate"
    );
    assert_eq!(
        open(0),
        "serial:/dev/ttyACM0 runs firmware 2.3.4 with protocol version 0, this tool speaks version 2: \
         write newer firmware with `palpate flash`"
    );
    assert!(
        open(protocol::PROTOCOL_VERSION)
            .starts_with("serial:/dev/ttyACM0 runs firmware 2.3.4, built from another message table (schema abadcafe,"),
        "{}",
        open(protocol::PROTOCOL_VERSION)
    );
}

#[test]
fn over_tcp_the_same_conversation_holds_in_real_time() {
    let server = serve("127.0.0.1:0", SimulatedBoard::new(1, Jitter::NONE)).unwrap();
    let address = server.address().unwrap();
    let stop = Arc::new(AtomicBool::new(false));
    let stopped = Arc::clone(&stop);
    let running = thread::spawn(move || server.run(|_| {}, || !stopped.load(Ordering::Relaxed)));

    let table = long_table();
    let link = Tcp::open(&address.to_string()).unwrap();
    let (mut session, hello) = Session::open(link, Patience::default()).unwrap();
    assert!(hello.simulated);
    session.upload(&table, |_| {}).unwrap();
    assert_eq!(session.status().unwrap().table_hash, Table::parse(&table).unwrap().hash());
    let until_s = session.link().now_s() + 1.0;
    let mut records = 0;
    while let Some(event) = session.poll(until_s).unwrap() {
        records += u32::from(matches!(event, Event::Telemetry(_)));
    }
    // A second at 50 Hz; half of it if the machine is busy with other things.
    assert!(records >= 25, "{records} records in a second");
    assert_eq!(session.traffic().frames_lost, 0);
    drop(session);

    // The board goes on without a host, and takes the next one.
    let link = Tcp::open(&address.to_string()).unwrap();
    let (mut session, _) = Session::open(link, Patience { answer_s: 2.0, ..Patience::default() }).unwrap();
    assert!(session.status().unwrap().uptime_ms > 0);

    stop.store(true, Ordering::Relaxed);
    running.join().unwrap();
    thread::sleep(Duration::from_millis(20));
    let error = loop {
        if let Err(error) = session.status() {
            break error.to_string();
        }
    };
    assert_eq!(error, format!("tcp:{address} closed the connection"));
}

#[test]
fn a_place_where_nobody_listens_is_named() {
    let free = std::net::TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let address: Address = format!("tcp:{free}").parse().unwrap();
    let error = palpate::link::open(&address).err().unwrap().to_string();
    assert!(error.starts_with(&format!("cannot open tcp:{free}: ")), "{error}");
    let port: Address = "serial:/dev/no-such-port".parse().unwrap();
    let error = palpate::link::open(&port).err().unwrap().to_string();
    assert!(error.starts_with("cannot open serial:/dev/no-such-port: "), "{error}");
}
