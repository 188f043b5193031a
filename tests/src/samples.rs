//! One sample of every message, with a different value in every field, and a small table.

use palpate::control::{ControlCurve, Row};
use protocol::fault::{Fault, FaultSet};
use protocol::lut::{AxisSpec, CoilSpec, DisplaySpec, MaterialSpec, Role, Scale, TableSpec, axis_name};
use protocol::message::*;

/// Every request of the table, in its order.
pub fn requests() -> Vec<Request> {
    let data = (0..5).collect();
    vec![
        Request::Hello(HelloRequest { protocol_version: 1, schema_hash: 0x0123_4567_89ab_cdef }),
        Request::Status(Empty {}),
        Request::SetMode(ModeRequest { mode: Mode::Palpate { rate_mm_s: 2.0, depth_mm: 4.0 }, lease_ms: 750 }),
        Request::SetGains(Gains { kp: 1.5, ki: 2.5, kd: 0.25, n: 7.5 }),
        Request::GetCalibration(Empty {}),
        Request::SetCalibration(calibration()),
        Request::Tare(Empty {}),
        Request::ClearFaults(Empty {}),
        Request::SetTelemetry(TelemetryRate { divider: 2 }),
        Request::ExpectSurface(Surface { height_mm: 25.5 }),
        Request::SetFitted(Fitted { palpator: true, actuator: false, coil: true }),
        Request::SetPalpation(PalpationRequest {
            palpation: PalpationMode::Press { rate_mm_s: 4.0, depth_mm: 3.5, surface_mm: Some(24.5) },
            lease_ms: 800,
        }),
        Request::SetDisplay(DisplayRequest {
            display: DisplayMode::Follow { parts: Parts::Coil, by: Rule::Between },
            lease_ms: 850,
        }),
        Request::GetHalves(Empty {}),
        Request::SetActuator(Actuator { reach_mm: 17.5, rate_mm_s: 150.0, holds_v_per_n: 0.125 }),
        Request::TableBegin(TableBegin { length: 36_000, crc: 0xcbf4_3926 }),
        Request::TableChunk(TableChunk { offset: 192, data }),
        Request::TableCommit(Empty {}),
        Request::TableQuery(Empty {}),
        Request::GetLastRun(Empty {}),
    ]
}

/// Every report of the table, in its order.
pub fn reports() -> Vec<Report> {
    let mut faults = FaultSet::NONE;
    faults.insert(Fault::CoilHot);
    vec![
        Report::Hello(Hello {
            protocol_version: 1,
            schema_hash: 0x0123_4567_89ab_cdef,
            firmware_version: [0, 1, 0],
            unique_id: [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12],
            build: Build { commit: *b"0123abcd", modified: true, image_crc: 0x89ab_cdef },
            simulated: true,
            slot_len: 524_288,
            reset_cause: ResetCause::Watchdog,
        }),
        Report::Status(Status {
            uptime_ms: 123_456,
            mode: Mode::Display { material: 3 },
            state: State::Display,
            faults,
            frames_rejected: 1,
            frames_dropped: 2,
            deadlines_missed: 3,
            tick_max_us: 456,
            ticks_late: 4,
            period_max_us: 20_123,
            holder: Holder::Another,
            table_hash: [7; 16],
            calibration: CalibrationState::Unreadable,
            fitted: Fitted { palpator: false, actuator: true, coil: false },
        }),
        Report::Accepted(Accepted { of: 3, seq: 77 }),
        Report::Refused(Refused { of: 16, seq: 78, reason: Refusal::TooLarge }),
        Report::Telemetry(telemetry(faults)),
        Report::Verdict(verdict()),
        Report::Fault(FaultReport { tick: 51, fault: Fault::ForceLimit as u8, value: 21.0, limit: 20.0 }),
        Report::TableState(TableState { active: Slot::B, hash: [9; 16], next_offset: 384, length: 36_000 }),
        Report::Calibration(calibration()),
        Report::Estimate(estimate()),
        Report::LastRun(LastRun {
            known: true,
            end: RunEnd::HardFault { pc: 0x0800_1234, lr: 0x0800_4321, cfsr: 1 << 9 },
            file: b"image/mod.rs".iter().copied().collect(),
            changes: [(20, State::Idle), (70_000, State::Display)]
                .into_iter()
                .map(|(time_ms, state)| StateChange { time_ms, state })
                .collect(),
        }),
        Report::Halves(Halves {
            tick: 52,
            palpation: State::Contact,
            display: DisplayState::On,
            parts: Parts::Actuator,
            curve: Curve { low: 1, high: 4, weight: 0.375 },
            share: 0.75,
            of_palpation: 19,
            departs: 0.0625,
            outside: true,
            bound_a: 0.3125,
        }),
    ]
}

fn calibration() -> Calibration {
    Calibration {
        load_cell: LoadCell { zero_ratio: 0.5, n_per_ratio: 40.0 },
        fsr: ResistiveSensor { slope: 0.079, offset: -0.016, divider_kohm: 10.0 },
        potentiometer: ResistiveSensor { slope: -0.080279, offset: 2.5829, divider_kohm: 1.6 },
        probe: ProbePosition { zero_ratio: 0.1, mm_per_ratio: 60.0 },
    }
}

fn telemetry(faults: FaultSet) -> Telemetry {
    Telemetry {
        tick: 50,
        state: State::Contact,
        faults,
        probe_mm: 11.5,
        depth_mm: 1.25,
        load_cell_n: 0.75,
        fsr_n: 0.5,
        shaft_mm: 3.0,
        shaft_target_mm: 3.5,
        actuator_v: -1.0,
        coil_a: 0.25,
        coil_target_a: 0.375,
        coil_duty: 0.125,
        coil_c: 25.0,
        search_error_n: 0.0625,
        tick_us: 90,
        raw: Raw { load_cell: 6_554, fsr: 17, potentiometer: 40_000, probe_position: 30_001, coil_current: 3_277 },
        shown: Shown { unreachable: true, coil_limited: false, shaft_limited: true, actuator_only: false },
    }
}

fn estimate() -> Estimate {
    Estimate {
        palpation: 20,
        mu_mpa: 0.25,
        alpha: 10.5,
        height_mm: 12.75,
        mu_error_mpa: 0.015625,
        alpha_error: 0.5,
        height_error_mm: 0.03125,
        noise_n: 0.0078125,
        samples: 100,
    }
}

fn verdict() -> Verdict {
    Verdict {
        palpation: 20,
        outcome: Outcome::Identified,
        rate_mm_s: 2.0,
        height_mm: 12.75,
        table_height_mm: 12.5,
        mu_mpa: 0.25,
        alpha: 10.5,
        error_n: 0.015625,
        runner_up_error_n: 0.03125,
        margin: 0.5,
        peak_force_n: 6.0,
        samples: 100,
        material: Recognition {
            index: 0,
            error_n: 0.03125,
            runner_up: 4,
            runner_up_error_n: 0.125,
            margin: 0.75,
            limit_n: 0.25,
        },
        tick_max_us: 120,
        tick_mean_us: 80.5,
    }
}

/// A control curve that no finger pad has: 0.9 A a newton, which a magnet makes from 0.2 to 2 N.
pub fn control_curve(material: &str) -> ControlCurve {
    let row = |i: usize| {
        let force_n = 0.1 * i as f64;
        Row {
            force_n,
            travel_mm: 1.25 * force_n,
            area_mm2: 20.0 * force_n,
            shaft_mm: force_n,
            yield_kpa: 2.0 * force_n,
            flux_t: 0.05 * force_n,
            current_a: (0.9 * force_n).min(2.5),
            loop_gain: 0.5,
        }
    };
    ControlCurve {
        material: material.to_owned(),
        magnet: "ring".to_owned(),
        finger: "none".to_owned(),
        fluid: "MRF-122".to_owned(),
        bound_a: 0.05,
        reachable_n: (0.2, 2.0),
        felt_error: None,
        provenance: "made up for tests".to_owned(),
        rows: (0..=40).map(row).collect(),
    }
}

/// A table with every section: two heights, three exponents, four depths, mu as factor, one material.
pub fn small_table() -> TableSpec {
    let axis = |name: &str, unit: &str, role, scale, values: &[f64]| AxisSpec::new(name, unit, role, scale, values);
    let depths = [0.5, 1.0, 1.5, 2.0];
    let columns =
        [10.0, 20.0].iter().flat_map(|h| [1.0, 2.0, 4.0].map(|alpha| depths.map(|d| alpha * d / h).to_vec())).collect();
    TableSpec {
        axes: vec![
            axis(axis_name::DEPTH, "mm", Role::Row, Scale::Linear, &depths),
            axis(axis_name::HEIGHT, "mm", Role::Column, Scale::Listed, &[10.0, 20.0]),
            axis(axis_name::ALPHA, "", Role::Column, Scale::Logarithmic, &[1.0, 2.0, 4.0]),
            axis(axis_name::MU, "MPa", Role::Factor, Scale::Linear, &[0.1, 0.2]),
        ],
        columns,
        library: vec![MaterialSpec {
            name: "foam".into(),
            mu_mpa: 0.2,
            alpha: 2.0,
            height_mm: 10.0,
            acceptance: 0.05,
            rate_mm_s: 0.0,
            force_n: vec![0.1, 0.2, 0.3, 0.4],
            display: DisplaySpec {
                force_n: vec![0.0, 1.0, 2.0, 3.0],
                shaft_mm: vec![0.0, 2.0, 3.0, 3.5],
                coil: Some(CoilSpec { current_a: vec![0.0, 1.0, 1.5, 1.75], reachable_n: (0.5, 2.5), bound_a: 0.125 }),
            },
        }],
        discretisation: 0.002,
        interpolation: 0.001,
        provenance: "force = alpha depth / height, a golden file".into(),
    }
}
