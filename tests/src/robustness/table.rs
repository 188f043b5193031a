//! Look-up tables.

use firmware::flash::BANK_LEN;
use firmware::link::LinkId;
use firmware::press::Press;
use firmware::search::Search;
use protocol::frame::CRC32;
use protocol::lut::{HEADER_LEN, MAGIC, Table, VERSION};
use protocol::message::{Mode, ModeRequest, Request};

use super::Held;
use super::board::{board, check_outputs, inputs, reports};

/// `bytes` with magic, version, lengths and CRCs of a table, so that its contents are looked at; too few bytes are filled up with zeros.
pub fn sealed(bytes: &[u8]) -> Vec<u8> {
    let mut table = bytes.to_vec();
    table.resize(bytes.len().max(HEADER_LEN), 0);
    let mut put = |at: usize, field: &[u8]| table[at..at + field.len()].copy_from_slice(field);
    put(0, &MAGIC);
    put(8, &VERSION.to_le_bytes());
    put(10, &(HEADER_LEN as u16).to_le_bytes());
    put(12, &(bytes.len().max(HEADER_LEN) as u32).to_le_bytes());
    put(20, &[0; 4]);
    let payload = CRC32.checksum(&table[HEADER_LEN..]);
    table[16..20].copy_from_slice(&payload.to_le_bytes());
    let header = CRC32.checksum(&table[..HEADER_LEN]);
    table[20..24].copy_from_slice(&header.to_le_bytes());
    table
}

/// Bytes as a table, as they are and [`sealed`]: refused by name, or every access to the table succeeds with finite numbers, every method of
/// identification ends with a result of finite numbers or a named outcome, and a board that starts with it keeps its outputs within their
/// limits.
///
/// # Errors
/// What does not hold.
pub fn table(bytes: &[u8]) -> Held {
    for candidate in [bytes.to_vec(), sealed(bytes)] {
        match Table::parse(&candidate) {
            Err(error) if error.to_string().is_empty() => return Err(format!("{error:?} says nothing")),
            Err(_) => {}
            Ok(table) => {
                read(&table)?;
                identify(&table)?;
                run(&candidate, &table)?;
            }
        }
    }
    Ok(())
}

/// Every number of the table.
fn read(table: &Table<'_>) -> Held {
    let finite = |what: &str, x: f32| if x.is_finite() { Ok(()) } else { Err(format!("{what} is {x}")) };
    for axis in table.axes() {
        for value in axis.values() {
            finite(axis.name, value)?;
        }
    }
    let depths = [0.5, 1.0, 1.5, table.rows() as f32].map(|row| row * table.depth_step_mm());
    for position in depths.into_iter().filter_map(|depth_mm| table.locate(depth_mm)) {
        for column in 0..table.columns() {
            finite("a force", table.force_n(position, column))?;
        }
        let side_by_side = table.forces_n(position, 0..table.columns()).count();
        if side_by_side != table.columns() {
            return Err(format!("{side_by_side} forces side by side, of {} columns", table.columns()));
        }
        for material in table.materials() {
            finite("a material's force", material.force_n(position))?;
        }
    }
    for material in table.materials() {
        finite("a peak force", material.peak_force_n())?;
        for force_n in [0.0, 0.5, 1e9] {
            finite("a shaft position", material.shaft_mm(force_n))?;
            if let Some(current) = material.current(force_n)
                && !(0.0..=protocol::lut::CURRENT_MAX_A).contains(&current.a)
            {
                return Err(format!("a coil current is {}", current.a));
            }
        }
    }
    match table.checked().open(table.bytes()) {
        Some(again) if again.hash() == table.hash() => Ok(()),
        _ => Err("a checked table does not open again".into()),
    }
}

/// A press into something like the middle column.
fn identify(table: &Table<'_>) -> Held {
    let step_mm = table.depth_max_mm() / 40.0;
    let column = table.columns() / 2;
    let samples: Vec<(f32, f32)> = (-4..44)
        .map(|i| {
            let depth_mm = i as f32 * step_mm;
            (depth_mm, table.locate(depth_mm).map_or(0.0, |at| 1.1 * table.force_n(at, column)))
        })
        .collect();
    let height_mm = table.axis(protocol::lut::axis_name::HEIGHT).map_or(10.0, |axis| axis.value(0));
    let rate_mm_s = table.axis(protocol::lut::axis_name::RATE).map_or(2.0, |axis| axis.value(0));
    let press = Press { height_mm, rate_mm_s, samples: &samples, noise_n: 0.002 };
    let mut search = Box::new(Search::new());
    if let Ok(found) = press.by_variance(table, &mut search)
        && ![found.error_n, found.runner_up_error_n, found.margin].iter().all(|x| x.is_finite())
    {
        return Err(format!("the search found {found:?}"));
    }
    if let Ok(fitted) = press.by_rows(table)
        && ![fitted.mu_mpa, fitted.alpha, fitted.rms_n].iter().all(|x| x.is_finite())
    {
        return Err(format!("the fast search found {fitted:?}"));
    }
    if let Ok(estimator) = press.by_filter(table, 1)
        && !estimator.filter.state.iter().all(|x| x.is_finite())
    {
        return Err(format!("the filter found {:?}", estimator.filter.state));
    }
    Ok(())
}

/// A board that starts with this table, displays its first material and presses the ball in.
fn run(bytes: &[u8], table: &Table<'_>) -> Held {
    let mut bank = vec![0xff; BANK_LEN];
    let Some(room) = bank.get_mut(..bytes.len()) else {
        return Ok(());
    };
    room.copy_from_slice(bytes);
    let mut board = board(bank);
    let mut tick = |mode: Option<Mode>, force_n: f32, probe_mm: f32| {
        if let Some(mode) = mode {
            let mut out = [0; protocol::frame::MAX_FRAME];
            board.receive(
                LinkId::Usb,
                protocol::frame::encode_request(&Request::SetMode(ModeRequest { mode, lease_ms: 1000 }), 0, &mut out)
                    .map_err(|e| e.to_string())?,
            );
        }
        check_outputs(&board.tick(&inputs(force_n, probe_mm, 1.0)))?;
        reports(&mut board).map(drop)
    };
    tick(None, 0.0, 30.0)?;
    tick(Some(Mode::Display { material: 0 }), 0.0, 30.0)?;
    tick(None, 0.0, 30.0)?;
    tick(Some(Mode::Idle), 0.0, 30.0)?;
    let height_mm = table.axis(protocol::lut::axis_name::HEIGHT).map_or(10.0, |axis| axis.value(0)).clamp(1.0, 50.0);
    tick(Some(Mode::Palpate { rate_mm_s: 2.0, depth_mm: 0.8 * table.depth_max_mm().min(2.0) }), 0.0, height_mm + 1.0)?;
    // 25 samples in the air, as many in contact, and the analysis while the arm returns.
    for i in 0..90 {
        let depth_mm = 0.04 * (i - 25) as f32;
        let force_n = table.locate(depth_mm).map_or(0.0, |at| table.force_n(at, table.columns() / 2)).clamp(0.0, 5.0);
        tick(None, force_n, height_mm - depth_mm)?;
    }
    Ok(())
}
