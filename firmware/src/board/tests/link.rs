use super::*;
use crate::flash::PowerCut;
use proptest::prelude::*;
use protocol::message::{HelloRequest, SCHEMA_HASH, TableBegin, TableChunk, TelemetryRate};
use protocol::{PROTOCOL_VERSION, frame, rescue};

fn hello(schema_hash: u64) -> Request {
    Request::Hello(HelloRequest { protocol_version: PROTOCOL_VERSION, schema_hash })
}

#[test]
fn hello_says_who_the_board_is() {
    let mut bench = Bench::new();
    let Report::Hello(hello) = bench.ask(&hello(SCHEMA_HASH)) else { panic!() };
    assert_eq!((hello.schema_hash, hello.unique_id), (SCHEMA_HASH, *b"unit test 01"));
    assert_eq!((hello.slot_len, hello.reset_cause, hello.simulated), (512 * 1024, ResetCause::PowerOn, false));
}

#[test]
fn after_a_hello_from_another_schema_everything_but_hello_and_rescue_is_refused() {
    let mut bench = Bench::new();
    assert!(matches!(bench.ask(&hello(SCHEMA_HASH ^ 1)), Report::Hello(_)));
    assert_eq!(bench.refusal(&Request::Status(Empty {})), Refusal::SchemaMismatch);
    assert_eq!(bench.refusal(&set_mode(PALPATE)), Refusal::SchemaMismatch);
    assert!(rescued(&mut bench));
    assert!(matches!(bench.ask(&hello(SCHEMA_HASH)), Report::Hello(_)));
    assert!(matches!(bench.ask(&Request::Status(Empty {})), Report::Status(_)));
}

/// Sends the rescue question; true if the answer comes.
fn rescued(bench: &mut Bench) -> bool {
    let fill = |body: &mut [u8]| {
        body[..rescue::QUESTION.len()].copy_from_slice(&rescue::QUESTION);
        Some(rescue::QUESTION.len())
    };
    let mut buffer = [0; MAX_FRAME];
    bench.board.receive(LinkId::Usb, frame::encode(rescue::KIND, 9, fill, &mut buffer).unwrap());
    let mut out = [0; 512];
    let count = bench.board.take_transmit(LinkId::Usb, &mut out);
    let mut decoder = Decoder::new();
    out[..count].iter().any(|byte| match decoder.push(*byte) {
        Some(Ok(frame)) => frame.kind == rescue::KIND && rescue::Answer::from_bytes(frame.body).is_some(),
        _ => false,
    })
}

#[test]
fn every_bit_flip_in_a_frame_is_rejected_and_counted() {
    let mut buffer = [0; MAX_FRAME];
    let good = encode_request(&set_mode(PALPATE), 0, &mut buffer).unwrap().to_vec();
    for bit in 0..(good.len() - 1) * 8 {
        let mut bench = Bench::new();
        let mut bad = good.clone();
        bad[bit / 8] ^= 1 << (bit % 8);
        bench.board.receive(LinkId::Usb, &bad);
        assert_eq!(bench.board.state(), State::Idle, "bit {bit}");
        assert!(bench.board.talks[0].rejected() >= 1, "bit {bit}");
        // In step again with the next frame.
        bench.mode(PALPATE);
    }
}

#[test]
fn unknown_and_malformed_messages_are_refused_by_name() {
    let mut bench = Bench::new();
    for (kind, body, reason) in
        [(0x7f, &[][..], Refusal::Unknown), (0x85, &[], Refusal::Unknown), (0x03, &[9, 9], Refusal::Malformed)]
    {
        let fill = |b: &mut [u8]| {
            b[..body.len()].copy_from_slice(body);
            Some(body.len())
        };
        let mut buffer = [0; MAX_FRAME];
        bench.board.receive(LinkId::Usb, frame::encode(kind, 5, fill, &mut buffer).unwrap());
        bench.collect();
        assert_eq!(bench.reports.pop(), Some(Report::Refused(Refused { of: kind, seq: 5, reason })));
    }
    assert_eq!(bench.board.talks[0].rejected(), 3);
}

#[test]
fn a_host_that_does_not_listen_loses_telemetry_but_no_answer() {
    let mut bench = Bench::new();
    bench.accept(&Request::SetTelemetry(TelemetryRate { divider: 1 }));
    for _ in 0..200 {
        bench.board.tick(&Inputs { tick_us: 1, ..Inputs::default() });
    }
    let dropped = bench.board.talks[0].dropped();
    assert!(dropped > 100, "{dropped}");
    let Report::Status(status) = bench.ask(&Request::Status(Empty {})) else { panic!() };
    assert_eq!(status.frames_dropped, dropped);
}

#[test]
fn dropped_telemetry_shows_as_a_gap_in_the_sequence_numbers() {
    let mut bench = Bench::new();
    bench.accept(&Request::SetTelemetry(TelemetryRate { divider: 1 }));
    let mut loss = frame::LossCounter::default();
    let mut decoder = Decoder::new();
    for pause in [1, 200, 1] {
        for _ in 0..pause {
            bench.board.tick(&Inputs { tick_us: 1, ..Inputs::default() });
        }
        let mut out = [0; crate::link::QUEUE_LEN];
        let count = bench.board.take_transmit(LinkId::Usb, &mut out);
        for byte in &out[..count] {
            if let Some(Ok(frame)) = decoder.push(*byte) {
                loss.see(frame.seq);
            }
        }
    }
    assert_eq!(loss.lost, u64::from(bench.board.talks[0].dropped()));
    assert!(loss.lost > 100);
}

#[test]
fn a_table_comes_over_the_link_and_is_used() {
    let mut bench = Bench::blank();
    let table = factored_table();
    let begin = TableBegin { length: table.len() as u32, crc: frame::CRC32.checksum(&table) };
    bench.send(&Request::TableBegin(begin));
    bench.run_until(20, |b| b.reports.iter().any(|r| matches!(r, Report::TableState(_))));
    for (i, piece) in table.chunks(protocol::message::CHUNK_LEN).enumerate() {
        let offset = (i * protocol::message::CHUNK_LEN) as u32;
        let chunk = TableChunk { offset, data: heapless::Vec::from_slice(piece).unwrap() };
        let Report::TableState(state) = bench.ask(&Request::TableChunk(chunk)) else { panic!() };
        assert_eq!(state.next_offset as usize, offset as usize + piece.len());
    }
    let Report::TableState(state) = bench.ask(&Request::TableCommit(Empty {})) else { panic!() };
    assert_eq!(state.active, protocol::message::Slot::A);
    assert_eq!(bench.board.table().unwrap().hash(), state.hash);
    bench.mode(PALPATE);
}

/// Bank 1 is not written while bank 2 is erased; and an erase that fails is told as the refusal of the request that began it.
#[test]
fn while_flash_is_erased_no_setup_is_stored_and_a_failure_is_told_by_name() {
    let mut bench = Bench::blank();
    bench.board.store_mut().set_power(PowerCut::After(1));
    let begin = Request::TableBegin(TableBegin { length: 100_000, crc: 0 });
    let seq = bench.seq;
    bench.send(&begin);
    assert!(bench.reports.is_empty());
    let calibration = Request::SetCalibration(crate::sensor::DEFAULT_CALIBRATION);
    assert_eq!(bench.refusal(&calibration), Refusal::Busy);
    bench.tick();
    let refused = Refused { of: begin.kind(), seq, reason: Refusal::FlashFailed };
    assert_eq!(bench.reports, [Report::Refused(refused)]);
    bench.board.store_mut().set_power(PowerCut::Never);
    bench.accept(&calibration);
}

#[test]
fn no_table_is_written_while_outputs_are_on() {
    let mut bench = Bench::new();
    bench.send(&Request::TableBegin(TableBegin { length: 1000, crc: 0 }));
    bench.ticks(2);
    bench.mode(PALPATE);
    let chunk = TableChunk { offset: 0, data: heapless::Vec::from_slice(&[1; 100]).unwrap() };
    assert_eq!(bench.refusal(&Request::TableChunk(chunk)), Refusal::Busy);
    assert_eq!(bench.refusal(&Request::TableCommit(Empty {})), Refusal::Busy);
}

#[test]
fn a_hello_starts_telemetry() {
    let mut bench = Bench::new();
    bench.ticks(2);
    assert!(bench.reports.is_empty());
    bench.ask(&hello(SCHEMA_HASH));
    bench.ticks(2);
    assert!(matches!(bench.reports[..], [Report::Telemetry(_), Report::Telemetry(_)]));
}

#[test]
fn gains_are_checked() {
    let mut bench = Bench::new();
    bench.accept(&Request::SetGains(crate::pid::DEFAULT_GAINS));
    let mut bad = crate::pid::DEFAULT_GAINS;
    bad.kd = f32::NAN;
    assert_eq!(bench.refusal(&Request::SetGains(bad)), Refusal::OutOfRange);
}

#[test]
fn an_actuator_is_checked_and_not_exchanged_in_motion() {
    let mut bench = Bench::new();
    let own = protocol::message::Actuator { reach_mm: 18.0, rate_mm_s: 150.0, holds_v_per_n: 0.1 };
    bench.accept(&Request::SetActuator(own.clone()));
    let far = protocol::message::Actuator { reach_mm: 25.0, ..own.clone() };
    assert_eq!(bench.refusal(&Request::SetActuator(far)), Refusal::OutOfRange);
    bench.mode(Mode::Display { material: 2 });
    assert_eq!(bench.refusal(&Request::SetActuator(own)), Refusal::Busy);
}

proptest! {
    /// Bytes from a broken line never panic, and never turn an output on.
    #[test]
    fn random_bytes_change_no_output(bytes in proptest::collection::vec(any::<u8>(), 0..2000)) {
        let mut bench = Bench::new();
        bench.board.receive(LinkId::Usb, &bytes);
        bench.ticks(3);
        prop_assert_eq!(bench.outputs, Outputs::default());
        prop_assert_eq!(bench.board.state(), State::Idle);
    }

    /// Nor do inputs of any value, in any mode.
    #[test]
    fn random_inputs_never_panic_and_outputs_stay_finite(
        healthy in proptest::collection::vec((0.1f32..0.8, 0.02f32..0.9, 0.4f32..0.6, 0.3f32..0.9, 0.05f32..0.8), 2..60),
        spoilt in proptest::option::of((1usize..60, 0usize..5, prop_oneof![Just(f32::NAN), Just(f32::INFINITY), -2.0f32..2.0])),
        mode in 0u8..3,
        fresh in any::<bool>(),
    ) {
        let mut bench = Bench::new();
        match mode {
            0 => {}
            1 => bench.mode(PALPATE),
            _ => bench.mode(Mode::Display { material: 0 }),
        }
        for (tick, (a, b, c, d, e)) in healthy.into_iter().enumerate() {
            let mut channels = [a, b, c, d, e];
            if let Some((at, channel, value)) = spoilt && at <= tick {
                channels[channel] = value;
            }
            let inputs = Inputs { raw: RawSamples::from_channels(channels), fresh, tick_us: 100, ..Inputs::default() };
            let out = bench.board.tick(&inputs);
            prop_assert!(machine::outputs_are_finite(&out));
            prop_assert!(out.actuator_v.abs() <= 5.0 && (0.0..=2.5).contains(&out.coil_target_a));
            if !bench.board.machine.safety.latched().is_empty() {
                prop_assert_eq!(out, Outputs::default());
            }
            // The first tick has healthy readings: an output must be on, or the rest of this test says nothing.
            if tick == 0 && fresh && mode == 1 {
                prop_assert!(out.arm_run || !bench.board.machine.safety.latched().is_empty());
            }
        }
    }
}
