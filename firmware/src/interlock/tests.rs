#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
use super::*;
use crate::testbed::Chance;

/// A board whose tasks all turn every millisecond.
fn polled(interlock: &mut Interlock, turns: &mut [u32; TASKS]) -> Poll {
    turns.iter_mut().for_each(|t| *t += 1);
    interlock.poll(turns)
}

#[test]
fn a_permit_lasts_forty_milliseconds_and_does_not_come_back_without_a_rest() {
    let (mut interlock, mut turns) = (Interlock::new(), [0; TASKS]);
    assert!(polled(&mut interlock, &mut turns).off);
    assert!(interlock.grant());
    let on = (0..100).take_while(|_| !polled(&mut interlock, &mut turns).off).count();
    assert_eq!(on + 1, usize::from(PERMIT_MS));
    assert!(interlock.trip() == Some(Trip::Expired) && !interlock.grant());
    assert!(polled(&mut interlock, &mut turns).off);
    interlock.rest();
    assert!(interlock.trip().is_none() && interlock.grant());
}

#[test]
fn a_rest_is_no_trip_and_ends_the_permit_at_once() {
    let (mut interlock, mut turns) = (Interlock::new(), [0; TASKS]);
    assert!(interlock.grant());
    interlock.rest();
    assert!(polled(&mut interlock, &mut turns).off && interlock.trip().is_none());
}

/// Every watched task by itself ends the feeding, and refuses the next grant.
#[test]
fn a_task_that_does_not_turn_gets_no_permit_and_no_food() {
    for dead in 0..TASKS {
        let (mut interlock, mut turns) = (Interlock::new(), [0u32; TASKS]);
        let mut fed = 0;
        let refused = (1..2000).find(|ms| {
            let still = turns[dead];
            turns.iter_mut().for_each(|t| *t += 1);
            turns[dead] = still;
            fed += u32::from(interlock.poll(&turns).feed);
            ms % 20 == 0 && !interlock.grant()
        });
        // The tick after 100 ms; from then on no permit, so the longer limit of a board at rest would hold.
        assert_eq!((refused, interlock.trip()), (Some(120), Some(Trip::Silent(dead))));
        assert_eq!(fed, 100, "task {dead}");
        let fed = (0..2000).filter(|_| interlock.poll(&turns).feed).count();
        assert_eq!(fed, 880, "task {dead}");
        interlock.unwatch(
            [Task::Control, Task::Sampling, Task::UsbReceive, Task::UsbSend, Task::UartReceive, Task::UartSend][dead],
        );
        interlock.rest();
        turns.iter_mut().enumerate().for_each(|(task, t)| *t += u32::from(task != dead));
        assert!(interlock.poll(&turns).feed && interlock.grant(), "task {dead}");
    }
}

/// The safety argument as a property: outputs on at any moment implies a grant within the last 40 ms, whatever
/// hangs, overruns or starts late, and whatever control asks for.
#[test]
fn outputs_on_implies_a_good_tick_within_the_permit() {
    let mut on_ms = 0;
    for seed in 0..SCENARIOS {
        let mut chance = Chance(seed);
        let mut pick = |n: u32| (chance.even() * f64::from(n)) as u32;
        let (mut interlock, mut turns) = (Interlock::new(), [0u32; TASKS]);
        // Each task may hang once, from and until.
        let hangs: [(u32, u32); TASKS] = core::array::from_fn(|_| {
            let from = pick(4000);
            (from, from + pick(600))
        });
        let hung = |task: usize, ms: u32| ms >= hangs[task].0 && ms < hangs[task].1;
        let (mut on, mut wanted, mut good) = (false, false, None);
        let mut next_tick = pick(20);
        for ms in 0..2000 {
            for (task, turn) in turns.iter_mut().enumerate().skip(1) {
                *turn += u32::from(!hung(task, ms));
            }
            if ms >= next_tick && !hung(0, ms) {
                // Now and then a tick is late; now and then somebody asks for another mode.
                next_tick = ms + 20 + if pick(30) == 0 { pick(60) } else { 0 };
                turns[0] += 1;
                if pick(40) == 0 {
                    wanted = !wanted;
                }
                // A board that hears of a trip latches a fault and rests.
                wanted &= interlock.trip().is_none();
                if wanted {
                    if interlock.grant() {
                        (on, good) = (true, Some(ms));
                    }
                } else {
                    interlock.rest();
                    on = false;
                }
            }
            let poll = interlock.poll(&turns);
            on &= !poll.off;
            on_ms += u64::from(on);
            if on {
                let age = good.map_or(u32::MAX, |at| ms - at);
                assert!(
                    age < u32::from(PERMIT_MS),
                    "scenario {seed}: on {age} ms after the last good tick, at {ms} ms"
                );
            }
            let dead = (0..TASKS).any(|t| hung(t, ms) && ms - hangs[t].0 > u32::from(SILENCE_OFF_MS) + 80);
            assert!(!(poll.feed && dead), "scenario {seed}: fed at {ms} ms");
        }
    }
    assert!(on_ms > SCENARIOS * 200, "outputs were hardly ever on: {on_ms} ms");
}

/// In a plain build a smaller set; 100,000 in a release build take some seconds.
const SCENARIOS: u64 = if cfg!(debug_assertions) { 5_000 } else { 100_000 };
