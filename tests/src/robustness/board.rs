//! The board that the bytes are given to, and how it is looked at.

use firmware::board::{Board, Identity, Inputs, Outputs};
use firmware::config::BoardConfig;
use firmware::flash::RamFlash;
use firmware::link::LinkId;
use firmware::sensor::{RawSamples, coil_ratio, fsr_ratio, load_cell_ratio, potentiometer_ratio, probe_ratio};
use protocol::frame::{Decoder, MAX_FRAME, encode_request};
use protocol::message::{Build, Empty, LastRun, Report, Request, ResetCause};
use protocol::rescue;

use super::Held;

/// A board with this content of flash bank 2, just started. With too few bytes it has no room for a table.
pub fn board(bank: Vec<u8>) -> Board<RamFlash<Vec<u8>>> {
    let identity = Identity {
        unique_id: *b"robustness 1",
        reset_cause: ResetCause::PowerOn,
        build: Build::UNKNOWN,
        last_run: LastRun::NONE,
    };
    Board::new(BoardConfig::default(), RamFlash::new(bank), identity)
}

/// A board without room for a table: cheap to make.
pub fn blank_board() -> Board<RamFlash<Vec<u8>>> {
    board(Vec::new())
}

/// Readings of a sound bench.
///
/// `force_n` is on the load cell with the ball at `probe_mm`, `finger_n` on the display; shaft and coil are at rest.
pub fn inputs(force_n: f32, probe_mm: f32, finger_n: f32) -> Inputs {
    let config = BoardConfig::default();
    let raw = RawSamples {
        load_cell: load_cell_ratio(force_n, &config.calibration.load_cell),
        fsr: fsr_ratio(finger_n, &config.calibration.fsr),
        potentiometer: potentiometer_ratio(1.0, &config.calibration.potentiometer),
        probe_position: probe_ratio(probe_mm, &config.calibration.probe),
        coil_current: coil_ratio(0.0, &config.shunt),
    };
    Inputs { raw, fresh: true, tick_us: 400, ..Inputs::default() }
}

/// Outputs are numbers within the limits that no message can widen.
///
/// # Errors
/// The output that is not.
pub fn check_outputs(outputs: &Outputs) -> Held {
    let config = BoardConfig::default();
    let limits = [
        ("actuator_v", outputs.actuator_v, -config.u_max_v, config.u_max_v),
        ("coil_target_a", outputs.coil_target_a, 0.0, config.safety.coil_a),
        ("coil_duty", outputs.coil_duty, 0.0, 1.0),
        ("arm_rate_mm_s", outputs.arm_rate_mm_s, 0.0, 4.0),
    ];
    for (name, value, low, high) in limits {
        if !(low..=high).contains(&value) {
            return Err(format!("output {name} is {value}, expected {low} to {high}"));
        }
    }
    Ok(())
}

/// Everything the board says; each frame must be sound, and a report of the table.
///
/// # Errors
/// The frame that is not.
pub fn reports(board: &mut Board<RamFlash<Vec<u8>>>) -> Result<Vec<Report>, String> {
    let (mut decoder, mut buffer, mut reports) = (Decoder::new(), [0; 512], Vec::new());
    loop {
        let count = board.take_transmit(LinkId::Usb, &mut buffer);
        if count == 0 {
            return Ok(reports);
        }
        for byte in &buffer[..count] {
            match decoder.push(*byte) {
                None => {}
                Some(Err(error)) => return Err(format!("the board sent a broken frame: {error}")),
                Some(Ok(frame)) if frame.kind == rescue::KIND => {
                    rescue::Answer::from_bytes(frame.body)
                        .ok_or("the board's answer to the rescue question is short")?;
                }
                Some(Ok(frame)) => {
                    let report = Report::decode(frame.kind, frame.body)
                        .map_err(|error| format!("the board sent what is no report: {error}"))?;
                    reports.push(report);
                }
            }
        }
    }
}

/// What a board says of itself, without its count of rejected frames and its clock: alike before and after bytes that changed nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct Portrait(Vec<Report>);

impl Portrait {
    /// Ends what came before with a zero and drops what the board said to it, then asks for status, calibration and tables.
    ///
    /// # Errors
    /// A broken or unknown frame of the board, or fewer answers than requests.
    pub fn of(board: &mut Board<RamFlash<Vec<u8>>>) -> Result<Self, String> {
        board.receive(LinkId::Usb, &[0]);
        reports(board)?;
        let asked = [Request::Status(Empty {}), Request::GetCalibration(Empty {}), Request::TableQuery(Empty {})];
        for request in &asked {
            let mut buffer = [0; MAX_FRAME];
            board.receive(LinkId::Usb, encode_request(request, 0, &mut buffer).map_err(|e| e.to_string())?);
        }
        let mut said = reports(board)?;
        if said.len() != asked.len() {
            return Err(format!("{} answers to {} requests: not in step after a zero", said.len(), asked.len()));
        }
        for report in &mut said {
            if let Report::Status(status) = report {
                (status.frames_rejected, status.uptime_ms) = (0, 0);
            }
        }
        Ok(Portrait(said))
    }
}
