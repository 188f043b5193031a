//! `palpate board`.

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand, ValueEnum};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use miette::{Context, IntoDiagnostic};
use protocol::fault::Fault;
use protocol::message::{Calibration, CalibrationState, Fitted, Gains, Hello, State, Status};
use serde_json::json;

use super::mode::ModeChoice;
use crate::demo::bench_foams;
use crate::link::{Address, IDLE_TOUCH, Link};
use crate::plant::{Jitter, Noise, Source};
use crate::session::{Patience, Session};
use crate::simulated_board::{SimulatedBoard, serve};

/// Which board, and what to do with it.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The board: sim, tcp:HOST:PORT or serial:PATH
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
    /// Show the calibration, take the load cell's zero, or load a calibration
    Calibrate {
        /// Take the load cell's present reading as zero
        #[arg(long)]
        tare: bool,
        /// Load a calibration from a TOML file, in the form that this command prints
        #[arg(long, value_name = "FILE")]
        load: Option<PathBuf>,
    },
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
        Action::Calibrate { tare, load } => calibrate(&mut session, *tare, load.as_deref())?,
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

/// An answer for programs and for people.
pub(super) type Answer = (serde_json::Value, String);

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
        table_hash,
        calibration,
        fitted,
    } = session.status().into_diagnostic()?;
    let hex = |bytes: &[u8]| bytes.iter().map(|b| format!("{b:02x}")).collect::<String>();
    let [major, minor, patch] = hello.firmware_version;
    let kind = if hello.simulated { "simulated board" } else { "board" };
    let table = if table_hash == [0; 16] { "none".to_owned() } else { hex(&table_hash) };
    let latched: Vec<Fault> = faults.iter().collect();
    let mut text = format!(
        "{kind} {} with firmware {major}.{minor}.{patch}, protocol {}, last start: {:?}\n\
         state      {state:?}, mode {mode:?}, up {:.1} s\n\
         table      {table}\n\
         setup      {}; fitted: {}\n\
         link       {frames_rejected} damaged frames received, {frames_dropped} records not sent\n\
         control    longest tick {tick_max_us} us, {deadlines_missed} deadlines missed",
        hex(&hello.unique_id),
        hello.protocol_version,
        hello.reset_cause,
        f64::from(uptime_ms) / 1e3,
        calibration_text(calibration),
        fitted_text(&fitted),
    );
    if latched.is_empty() {
        text.push_str("\nfaults     none");
    }
    for fault in &latched {
        text.push_str(&format!("\nfault      {}: {}; {}", fault.code(), fault.describe(), fault.advice()));
    }
    let value = json!({
        "simulated": hello.simulated, "firmware": hello.firmware_version, "protocol": hello.protocol_version,
        "unique_id": hex(&hello.unique_id), "uptime_ms": uptime_ms, "state": state, "mode": mode, "table": table,
        "faults": latched.iter().map(|f| f.code()).collect::<Vec<_>>(), "frames_rejected": frames_rejected,
        "frames_dropped": frames_dropped, "tick_max_us": tick_max_us, "deadlines_missed": deadlines_missed,
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

fn calibrate<L: Link>(session: &mut Session<L>, tare: bool, load: Option<&Path>) -> miette::Result<Answer> {
    if let Some(path) = load {
        let text = std::fs::read_to_string(path).into_diagnostic().wrap_err_with(|| path.display().to_string())?;
        let calibration: Calibration =
            toml::from_str(&text).into_diagnostic().wrap_err_with(|| path.display().to_string())?;
        session.set_calibration(calibration).into_diagnostic()?;
    }
    if tare {
        // The mean of the readings before the request is taken, so there must be some.
        let until_s = session.link().now_s() + 0.1;
        while session.poll(until_s).into_diagnostic()?.is_some() {}
        session.tare().into_diagnostic()?;
    }
    let calibration = session.calibration().into_diagnostic()?;
    let text = toml::to_string(&calibration).into_diagnostic()?;
    Ok((json!({ "calibration": calibration }), text.trim_end().to_owned()))
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
