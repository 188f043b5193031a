//! The coil: how hot it is believed to be, and what its loop tells.

use super::*;
use crate::fast::{FAST_STEPS, FastLoop};
use protocol::fault::Fault;

/// An amplifier that reads too little hides no heat: the duty says what the coil takes.
#[test]
fn a_coil_heats_in_the_model_by_its_duty_whatever_is_read_and_wanted() {
    let after = |spoil: fn(&mut Inputs)| {
        let mut bench = Bench::new();
        bench.spoil = spoil;
        bench.ticks(250);
        bench.board.machine.coil_c
    };
    // 0.6 of 15 V in 6.3 ohm are 12.8 W, less 2.8 W to the surroundings: 1.5 K/s for 5 s.
    assert!(after(|i| i.coil_duty = 0.6) > 84.0);
    assert!(after(|_| {}) < 80.0);
}

/// A switch that does not open is told in every state, also at rest.
#[test]
fn a_current_that_nobody_asked_for_is_a_fault_of_a_board_at_rest() {
    let mut bench = Bench::new();
    bench.tick();
    let c = BoardConfig::default();
    let mut fast = FastLoop::new(&c.circuit, &c.shunt, c.safety.coil_a);
    for _ in 0..FAST_STEPS {
        fast.step(&RawSamples { coil_current: coil_ratio(1.0, &c.shunt), ..bench.board.machine.raw });
    }
    let inputs = Inputs::from_fast(&fast.take(), false, 400);
    bench.board.tick(&inputs);
    assert_eq!(bench.faults(), [Fault::CoilUncommanded]);
}

#[test]
fn a_tick_hears_all_that_the_fast_loop_tells() {
    let trip = Some(Fault::CoilOpen);
    let averaged = Averaged { count: 1, coil_trip: trip, coil_duty: 0.4, ..Averaged::default() };
    let inputs = Inputs::from_fast(&averaged, true, 300);
    assert_eq!(
        inputs,
        Inputs { fresh: true, adc_overrun: true, coil_trip: trip, coil_duty: 0.4, tick_us: 300, ..inputs }
    );
    assert!(!Inputs::from_fast(&Averaged { count: 0, ..averaged }, false, 300).fresh);
}
