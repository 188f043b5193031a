//! `palpate board`.

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand, ValueEnum};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use miette::{Context, IntoDiagnostic};
use protocol::fault::Fault;
use protocol::message::{CalibrationState, Fitted, Gains, Hello, Holder, State, Status};
use serde_json::json;

use super::answer::Answer;
use super::mode::ModeChoice;
use crate::demo::bench_foams;
use crate::link::{Address, IDLE_TOUCH, Link};
use crate::plant::{Jitter, Noise, Source};
use crate::session::{Patience, Session, commit_text};
use crate::simulated_board::{SimulatedBoard, serve};

/// Which board, and what to do with it.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The board: sim, auto (the one on USB), tcp:HOST:PORT or serial:PATH
    #[arg(long, default_value = "sim", global = true)]
    board: Address,
    /// Print one JSON object on standard output
    #[arg(long, global = true)]
    json: bool,
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, Subcommand)]
enum Action {
    /// Who the board is and what it is doing
    Status,
    /// Show the calibration, take the load cell's zero, fit a sensor to known points, or load a calibration
    Calibrate(super::calibrate::Choice),
    /// Say which parts are wired to the board: all, or some of palpator, actuator, coil. The others are neither checked nor driven
    Fit {
        /// The parts; the FSR belongs to actuator and coil
        #[arg(required = true, value_enum)]
        parts: Vec<Part>,
    },
    /// Set what the board does, and stay until it is done
    #[command(subcommand)]
    Mode(ModeChoice),
    /// Set the gains of the display's position loop
    Gains {
        /// Proportional gain, V/mm
        #[arg(long)]
        kp: f32,
        /// Integral gain, V/(mm s)
        #[arg(long)]
        ki: f32,
        /// Derivative gain, V s/mm
        #[arg(long)]
        kd: f32,
        /// Corner of the derivative filter, rad/s
        #[arg(long)]
        n: f32,
    },
    /// Send a table and activate it
    Upload {
        /// The table, as `palpate lut` writes it
        table: PathBuf,
    },
    /// Clear latched faults whose cause is gone
    ClearFaults,
    /// Run the simulated board in real time over TCP
    Serve {
        /// Where to listen; port 0 takes a free one and prints it
        #[arg(long, default_value = "127.0.0.1:4750", value_name = "HOST:PORT")]
        listen: String,
        /// Seed of everything random
        #[arg(long, default_value_t = 1)]
        seed: u64,
        /// Lay the demo's foams under the probe in random order (computed first, some seconds)
        #[arg(long)]
        foams: bool,
    },
}

/// What can be wired to a board.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Part {
    /// Arm with load cell and position transducer
    Palpator,
    /// Actuator of the display with potentiometer and FSR
    Actuator,
    /// Coil of the display with its current amplifier
    Coil,
    /// Everything
    All,
}

/// Does what was asked for.
///
/// # Errors
/// A board that cannot be reached, does not answer, or refuses.
pub fn run(arguments: &Arguments) -> miette::Result<()> {
    if let Action::Serve { listen, seed, foams } = &arguments.action {
        return run_server(listen, *seed, *foams);
    }
    let link = crate::link::open(&arguments.board).into_diagnostic()?;
    let (mut session, hello) = Session::open(link, Patience::default()).into_diagnostic()?;
    let answer = match &arguments.action {
        Action::Status => status(&mut session, &hello)?,
        Action::Calibrate(choice) => super::calibrate::run(&mut session, choice)?,
        Action::Fit { parts } => fit(&mut session, parts)?,
        Action::Mode(choice) => super::mode::run(&mut session, choice)?,
        Action::Gains { kp, ki, kd, n } => {
            let gains = Gains { kp: *kp, ki: *ki, kd: *kd, n: *n };
            session.set_gains(gains.clone()).into_diagnostic()?;
            (json!({"gains": gains}), format!("gains set: kp {kp} V/mm, ki {ki} V/(mm s), kd {kd} V s/mm, n {n} rad/s"))
        }
        Action::Upload { table } => upload(&mut session, table)?,
        Action::ClearFaults => {
            session.clear_faults().into_diagnostic()?;
            (json!({"faults": []}), "no fault is latched any more".to_owned())
        }
        Action::Serve { .. } => return Ok(()),
    };
    if arguments.json {
        outln!("{}", answer.0);
    } else {
        outln!("{}", answer.1);
    }
    Ok(())
}

/// Who holds the motion, in words.
const fn holder_text(holder: Holder) -> &'static str {
    match holder {
        Holder::Nobody => "held by nobody",
        Holder::You => "held by this link",
        Holder::Another => "held by the board's other link",
    }
}

fn status<L: Link>(session: &mut Session<L>, hello: &Hello) -> miette::Result<Answer> {
    let Status {
        uptime_ms,
        mode,
        state,
        faults,
        frames_rejected,
        frames_dropped,
        deadlines_missed,
        tick_max_us,
        ticks_late,
        period_max_us,
        holder,
        table_hash,
        calibration,
        fitted,
    } = session.status().into_diagnostic()?;
    let last_run = session.last_run().into_diagnostic()?;
    let hex = |bytes: &[u8]| bytes.iter().map(|b| format!("{b:02x}")).collect::<String>();
    let [major, minor, patch] = hello.firmware_version;
    let kind = if hello.simulated { "simulated board" } else { "board" };
    let table = if table_hash == [0; 16] { "none".to_owned() } else { hex(&table_hash) };
    let latched: Vec<Fault> = faults.iter().collect();
    let build = match hello.build.image_crc {
        0 => "no image: the firmware's library runs in this program".to_owned(),
        image_crc => format!("{}, CRC of the image {image_crc:08x}", commit_text(&hello.build)),
    };
    let mut text = format!(
        "{kind} {} with firmware {major}.{minor}.{patch}, protocol {}, last start: {:?}\n\
         build      {build}\n\
         state      {state:?}, mode {mode:?}, up {:.1} s\n\
         table      {table}\n\
         setup      {}; fitted: {}\n\
         link       {frames_rejected} damaged frames received, {frames_dropped} records not sent\n\
         control    longest tick {tick_max_us} us, {deadlines_missed} too long; longest time from tick to tick {:.1} ms, \
         {ticks_late} late\n\
         motion     {}",
        hex(&hello.unique_id),
        hello.protocol_version,
        hello.reset_cause,
        f64::from(uptime_ms) / 1e3,
        f64::from(period_max_us) / 1e3,
        holder_text(holder),
        calibration_text(calibration),
        fitted_text(&fitted),
    );
    text.push_str(&super::last_run::text(&last_run));
    if latched.is_empty() {
        text.push_str("\nfaults     none");
    }
    for fault in &latched {
        text.push_str(&format!("\nfault      {}: {}; {}", fault.code(), fault.describe(), fault.advice()));
    }
    let value = json!({
        "simulated": hello.simulated, "build": hello.build, "firmware": hello.firmware_version, "protocol": hello.protocol_version,
        "unique_id": hex(&hello.unique_id), "uptime_ms": uptime_ms, "state": state, "mode": mode, "table": table,
        "faults": latched.iter().map(|f| f.code()).collect::<Vec<_>>(), "frames_rejected": frames_rejected,
        "frames_dropped": frames_dropped, "tick_max_us": tick_max_us, "deadlines_missed": deadlines_missed,
        "period_max_us": period_max_us, "ticks_late": ticks_late, "holder": holder,
        "last_run": super::last_run::value(&last_run),
        "calibration": calibration, "fitted": fitted,
    });
    Ok((value, text))
}

fn calibration_text(state: CalibrationState) -> &'static str {
    match state {
        CalibrationState::Stored => "calibration stored",
        CalibrationState::Default => "calibration of the firmware, none is stored",
        CalibrationState::Unreadable => "calibration of the firmware, the stored one cannot be read",
    }
}

fn fitted_text(fitted: &Fitted) -> String {
    let parts = [("palpator", fitted.palpator), ("actuator", fitted.actuator), ("coil", fitted.coil)];
    let names: Vec<&str> = parts.iter().filter(|(_, is_fitted)| *is_fitted).map(|(name, _)| *name).collect();
    if names.is_empty() { "nothing".to_owned() } else { names.join(", ") }
}

fn fit<L: Link>(session: &mut Session<L>, parts: &[Part]) -> miette::Result<Answer> {
    let has = |part: Part| parts.contains(&part) || parts.contains(&Part::All);
    let fitted = Fitted { palpator: has(Part::Palpator), actuator: has(Part::Actuator), coil: has(Part::Coil) };
    session.set_fitted(fitted.clone()).into_diagnostic()?;
    let text = format!("fitted: {}; stored on the board", fitted_text(&fitted));
    Ok((json!({ "fitted": fitted }), text))
}

fn upload<L: Link>(session: &mut Session<L>, path: &Path) -> miette::Result<Answer> {
    let bytes = std::fs::read(path).into_diagnostic().wrap_err_with(|| path.display().to_string())?;
    let bar = ProgressBar::with_draw_target(Some(bytes.len() as u64), ProgressDrawTarget::stderr());
    if let Ok(style) = ProgressStyle::with_template("upload [{bar:30}] {bytes}/{total_bytes}, {eta} left") {
        bar.set_style(style.progress_chars("=> "));
    }
    let state = session
        .upload(&bytes, |p| bar.set_position(u64::from(p.sent)))
        .into_diagnostic()
        .wrap_err_with(|| path.display().to_string())?;
    bar.finish_and_clear();
    let hash: String = state.hash.iter().map(|b| format!("{b:02x}")).collect();
    let text = format!("table {hash} of {} bytes is active in slot {:?}", bytes.len(), state.active);
    Ok((json!({"table": hash, "bytes": bytes.len(), "slot": state.active}), text))
}

/// Depth for which the foams of the served bench are computed, mm: that of the thesis' table.
const SERVED_DEPTH_MM: f64 = 4.0;

fn run_server(listen: &str, seed: u64, foams: bool) -> miette::Result<()> {
    let foams = if foams { bench_foams(SERVED_DEPTH_MM, &|_| {})? } else { Vec::new() };
    let mut choice = Noise::new(seed, Source::Choice);
    let mut board = SimulatedBoard::new(seed, Jitter::default());
    board.touch(Some(IDLE_TOUCH));
    let server = serve(listen, board).into_diagnostic().wrap_err_with(|| format!("cannot listen at {listen}"))?;
    let address = server.address().into_diagnostic()?;
    outln!("simulated board at tcp:{address}");
    let mut before = State::Approach;
    server.run(
        |board| {
            let now = board.state();
            // The operator lays the next foam under the probe when the arm is back home.
            if now == State::Idle && before != State::Idle && !foams.is_empty() {
                board.place(foams[choice.below(foams.len())].clone());
            }
            before = now;
        },
        || true,
    );
    Ok(())
}
