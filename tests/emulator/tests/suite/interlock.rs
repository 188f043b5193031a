//! The safety argument as a property of the real image: outputs on implies a control tick within 40 ms.
//!
//! `PALPATE_SCENARIOS` sets how many random scenarios are run; 1,000 take about half an hour on two cores.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use emulator::board::{BANK_2, EmulatedBoard, LSI_HZ, LSI_RANGE_HZ, Task};
use emulator::core::Deed;
use emulator::link::EmulatedUart;
use emulator::time::MILLISECOND;
use palpate::plant::{Jitter, Touch};
use palpate::session::{Patience, Session};
use protocol::frame::{self, MAX_FRAME};
use protocol::message::{
    DisplayMode, DisplayRequest, Empty, Mode, ModeRequest, PalpationMode, PalpationRequest, Parts, Request,
};

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;

use crate::common;

/// Life of a permit, and what the observer, who looks once a millisecond, cannot tell from it.
const PERMIT_MS: u64 = 40 + 1;

/// With interrupts masked the watchdog is left: 19 ms at its slowest clock.
const MASKED_MS: u64 = PERMIT_MS + 19;

/// A task that is dead keeps its permit for 100 ms, and that lasts 40 more.
const DEAD_TASK_MS: u64 = 100 + PERMIT_MS;

const SCENARIO_MS: u64 = 2000;

/// What a scenario does once, at a random time.
#[derive(Debug, Clone, Copy)]
enum Harm {
    Nothing,
    Trap(Task, Deed),
    Converter,
}

fn harm(rng: &mut Pcg64) -> Harm {
    let tasks = [Task::Control, Task::Sampling, Task::UartReceive, Task::UsbReceive];
    let task = tasks[rng.random_range(0..tasks.len())];
    match rng.random_range(0..8) {
        0 => Harm::Nothing,
        1 => Harm::Converter,
        2 => Harm::Trap(task, Deed::HangMasked),
        3 => Harm::Trap(task, Deed::Skip),
        4 => Harm::Trap(task, Deed::StackLeft(64)),
        5 => Harm::Trap(task, Deed::Hang),
        _ => Harm::Trap(task, Deed::Hold(rng.random_range(5..150) * MILLISECOND)),
    }
}

/// A host that asks now and then for another mode, keeps alive, or sends noise.
fn host(rng: &mut Pcg64, board: &mut EmulatedBoard) {
    let display = Mode::Display { material: 0 };
    let palpate = Mode::Palpate { rate_mm_s: 2.0, depth_mm: 4.0 };
    let mode = |mode| Request::SetMode(ModeRequest { mode, lease_ms: 300 });
    let half = |on: bool| {
        let press = PalpationMode::Press { rate_mm_s: 2.0, depth_mm: 4.0, surface_mm: None };
        let palpation = if on { press } else { PalpationMode::Idle };
        Request::SetPalpation(PalpationRequest { palpation, lease_ms: 300 })
    };
    let shown = |on: bool| {
        let shown = DisplayMode::Material { parts: Parts::Both, material: 0 };
        let display = if on { shown } else { DisplayMode::Idle };
        Request::SetDisplay(DisplayRequest { display, lease_ms: 300 })
    };
    let request = match rng.random_range(0..11) {
        8 | 9 => half(rng.random_bool(0.7)),
        10 => shown(rng.random_bool(0.7)),
        0 => mode(Mode::Idle),
        1 | 2 => mode(display),
        3 => mode(palpate),
        4 => Request::ClearFaults(Empty {}),
        5 => {
            let noise: Vec<u8> = (0..rng.random_range(1..40)).map(|_| rng.random()).collect();
            return board.receive(&noise);
        }
        _ => Request::Status(Empty {}),
    };
    let mut buffer = [0; MAX_FRAME];
    board.receive(frame::encode_request(&request, 0, &mut buffer).unwrap());
}

/// One scenario; returns for how many milliseconds outputs were on.
fn scenario(seed: u64, touch: Touch) -> u64 {
    let mut rng = Pcg64::seed_from_u64(seed);
    let lsi_hz = [LSI_RANGE_HZ.0, LSI_HZ, LSI_RANGE_HZ.1][rng.random_range(0..3)];
    let mut board = EmulatedBoard::new(common::image(), 1, Jitter::NONE, lsi_hz).unwrap();
    board.core().set_flash(BANK_2, common::table()).unwrap();
    let (mut session, _) = Session::open(EmulatedUart::new(&mut board), Patience::default()).unwrap();
    session.set_mode(Mode::Display { material: 0 }).unwrap();
    drop(session);
    board.touch(Some(touch));
    let (harm, at_ms) = (harm(&mut rng), rng.random_range(100..SCENARIO_MS));
    let begin_s = board.time_s();
    let (mut ticks, mut tick_ms, mut on_ms) = (board.ticks(), 0, 0);
    let mut talk_ms = rng.random_range(10..100);
    for ms in 0..SCENARIO_MS {
        if ms == at_ms {
            match harm {
                Harm::Nothing => {}
                Harm::Converter => board.set_adc_dead(true),
                Harm::Trap(task, deed) => assert!(board.inject(task, deed).unwrap()),
            }
        }
        if ms >= talk_ms {
            host(&mut rng, &mut board);
            talk_ms = ms + rng.random_range(10..250);
        }
        board.step().unwrap();
        if board.ticks() != ticks {
            (ticks, tick_ms) = (board.ticks(), ms);
        }
        if board.pins().off() {
            continue;
        }
        on_ms += 1;
        let told = || format!("scenario {seed}: {harm:?} at {at_ms} ms, outputs on at {ms} ms, {:?}", board.pins());
        let masked = matches!(harm, Harm::Trap(_, Deed::HangMasked | Deed::StackLeft(_)));
        let limit_ms = if masked && ms >= at_ms { MASKED_MS } else { PERMIT_MS };
        assert!(ms - tick_ms <= limit_ms, "{}: last tick {} ms ago", told(), ms - tick_ms);
        // No task may be dead for longer, whatever a host asks for. A reset brings it back.
        let dead = matches!(harm, Harm::Trap(_, Deed::Skip | Deed::Hang));
        let was_reset = board.resets().iter().any(|(at_s, _)| *at_s > begin_s);
        assert!(!dead || was_reset || ms < at_ms + DEAD_TASK_MS + 20, "{}: a task is dead", told());
    }
    on_ms
}

#[test]
fn outputs_on_implies_a_tick_within_the_permit() {
    let scenarios: u64 = std::env::var("PALPATE_SCENARIOS").ok().and_then(|n| n.parse().ok()).unwrap_or(16);
    common::table();
    let touch = Touch { peak_n: 3.0, period_s: 3.0 };
    let workers = std::thread::available_parallelism().map_or(1, usize::from) as u64;
    let on_ms: u64 = std::thread::scope(|scope| {
        let work =
            |first: u64| move || (first..scenarios).step_by(workers as usize).map(|s| scenario(s, touch)).sum::<u64>();
        let threads: Vec<_> = (0..workers).map(|first| scope.spawn(work(first))).collect();
        threads.into_iter().map(|t| t.join().unwrap()).sum()
    });
    println!("{scenarios} scenarios of 2 s: outputs on for {:.0} s, never without a tick", on_ms as f64 / 1e3);
    assert!(on_ms > scenarios * 300, "outputs were hardly ever on: {on_ms} ms");
}
