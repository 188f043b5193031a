//! `palpate tune`.

mod files;
mod told;

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use miette::{IntoDiagnostic, miette};
use protocol::message::Refusal;

use super::gains;
use super::progress::Progress;
use crate::actuator::flaws::Flaws;
use crate::actuator::plant::Plant;
use crate::actuator::uncertain::Uncertain;
use crate::actuator::{Actuator, Form, Known};
use crate::link::{Address, Link};
use crate::session::{Patience, Session, SessionError};
use crate::tune::limits::{Limits, Rule};
use crate::tune::sampled::Sampling;
use crate::tune::setting::Setting;
use crate::tune::study::Study;
use crate::tune::windup::Windup;
use crate::tune::{Asked, Gains, Way};

/// Folder of files where none is asked for.
const DEFAULT_FOLDER: &str = "out/tune";

/// Which loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Loop {
    /// The thesis' (section 5.5): a continuous controller
    Continuous,
    /// Sampled, the command acts at once
    Sampled,
    /// Sampled, the command acts a tick later: what runs on the board
    Delayed,
}

impl Loop {
    const fn name(self) -> &'static str {
        match self {
            Self::Continuous => "continuous",
            Self::Sampled => "sampled",
            Self::Delayed => "delayed",
        }
    }
}

/// Gains of the display's position loop with the least error after a step.
#[derive(Debug, Args)]
#[command(
    after_help = "Least is the integral of the absolute error over 100 s (thesis Eqs. 53 and 54), while command, overshoot and undershoot \
keep their limits.\n`palpate tune` alone tunes the thesis' actuator on the loop that runs: 50 Hz, a held command, one tick of delay.\n\
An actuator of your own: --actuator FILE (docs/tuning.md), or --numerator and --denominator."
)]
pub struct Arguments {
    /// The actuator: an actuator.toml, `thesis` or `voice-coil`
    #[arg(long, value_name = "FILE", default_value = "thesis")]
    actuator: PathBuf,
    /// Numerator of the plant instead of a file, the highest power of s first: mm/V
    #[arg(
        long,
        value_name = "LIST",
        value_delimiter = ',',
        allow_hyphen_values = true,
        requires = "denominator",
        conflicts_with = "actuator"
    )]
    numerator: Vec<f64>,
    /// Denominator of the plant, the highest power of s first
    #[arg(long, value_name = "LIST", value_delimiter = ',', allow_hyphen_values = true, requires = "numerator")]
    denominator: Vec<f64>,
    /// Dead time of the plant, s, instead of the file's
    #[arg(long, value_name = "S")]
    delay: Option<f64>,
    /// Take the transfer function alone: no limit of speed, no friction, no backlash
    #[arg(long)]
    ideal: bool,
    /// The loop that the gains are for
    #[arg(long = "loop", value_enum, default_value = "delayed", value_name = "LOOP")]
    way: Loop,
    /// Period of a sampled loop, s
    #[arg(long, value_name = "S", default_value_t = f64::from(protocol::TICK_S))]
    tick: f64,
    /// Largest command, V; without it the file's, 5 of the thesis
    #[arg(long, value_name = "V")]
    u_max: Option<f64>,
    /// Largest overshoot, part of the step
    #[arg(long, value_name = "PART", default_value_t = 0.05)]
    overshoot: f64,
    /// Largest undershoot after the target was reached, part of the step
    #[arg(long, value_name = "PART", default_value_t = 0.05)]
    undershoot: f64,
    /// Largest peak sensitivity
    #[arg(long, value_name = "NUMBER")]
    sensitivity: Option<f64>,
    /// Least phase margin, degrees
    #[arg(long, value_name = "DEG")]
    phase: Option<f64>,
    /// Step of the target, mm
    #[arg(long, value_name = "MM", default_value_t = 1.0)]
    step: f64,
    /// The command is cut at its limit, as on the board, instead of keeping below it by itself
    #[arg(long)]
    cut: bool,
    /// Tune as Appendix E of the thesis programs it: 10 s, 1001 samples, overshoot and undershoot that are at their limits
    #[arg(long, conflicts_with_all = ["sensitivity", "phase", "robust", "cut"])]
    appendix_e: bool,
    /// Least for the worst corner of the box, with limits that hold for every corner
    #[arg(long)]
    robust: bool,
    /// Every coefficient of the plant within so many percent; without it the file's intervals, or 10
    #[arg(long = "box", value_name = "PERCENT")]
    percent: Option<f64>,
    /// Search nothing, look at these gains
    #[arg(long, value_name = "KP,KI,KD,N", value_parser = gains::given, conflicts_with_all = ["robust", "appendix_e"])]
    gains: Option<Gains>,
    /// Random plants of the box that the certificate is compared with
    #[arg(long, value_name = "NUMBER", default_value_t = 100_000)]
    samples: usize,
    /// Set the gains on the board, and how far and fast its targets may go for this actuator
    #[arg(long)]
    send: bool,
    /// The board for --send: sim, auto (the one on USB), tcp:HOST:PORT or serial:PATH
    #[arg(long, default_value = "auto")]
    board: Address,
    /// Folder for the page and its pictures
    #[arg(long, value_name = "DIR", default_value = DEFAULT_FOLDER)]
    out: PathBuf,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

/// Searches, shows and, if asked to, sends the gains.
///
/// # Errors
/// A file with a mistake, an option out of range, limits that no gains keep, a file that cannot be written, a board that refuses.
pub fn run(arguments: &Arguments) -> miette::Result<()> {
    check(arguments)?;
    let actuator = actuator(arguments)?;
    let asked = asked(arguments, &actuator)?;
    let progress = Progress::new();
    progress.set("gains and their worst case", 0, 0);
    let part = 0.01 * arguments.percent.unwrap_or(10.0);
    let study = Study::of(asked, arguments.gains, part, arguments.samples);
    progress.end();
    let study = study?;
    let files = files::write(&arguments.out, &actuator, arguments.way.name(), &study)?;
    let sent = if arguments.send { Some(send(arguments, &actuator, &study.judged.gains)?) } else { None };
    if arguments.json {
        outln!("{}", told::summary(&actuator, arguments.way.name(), &study, &files, sent.as_deref()));
        return Ok(());
    }
    for line in told::lines(&actuator, arguments.way.name(), &study) {
        outln!("{line}");
    }
    if let Some(sent) = sent {
        outln!("sent        {sent}");
    }
    super::file::told(&files);
    Ok(())
}

fn check(arguments: &Arguments) -> miette::Result<()> {
    let within = |name: &str, value: Option<f64>, (least, most): (f64, f64), unit: &str| {
        value.map_or(Ok(()), |value| super::range::within(&format!("--{name}"), value, least..=most, unit))
    };
    within("delay", arguments.delay, (0.0, 1.0), "s")?;
    within("tick", Some(arguments.tick), (1e-4, 1.0), "s")?;
    within("u-max", arguments.u_max, (1e-3, 1000.0), "V")?;
    within("overshoot", Some(arguments.overshoot), (0.0, 1.0), "of the step")?;
    within("undershoot", Some(arguments.undershoot), (0.0, 1.0), "of the step")?;
    within("sensitivity", arguments.sensitivity, (1.05, 10.0), "")?;
    within("phase", arguments.phase, (1.0, 90.0), "degrees")?;
    within("step", Some(arguments.step), (1e-3, 100.0), "mm")?;
    within("box", arguments.percent, (0.0, 50.0), "%")?;
    if arguments.samples > 10_000_000 {
        return Err(miette!("--samples is {}; expected at most 10000000", arguments.samples));
    }
    if arguments.send && arguments.way != Loop::Delayed {
        return Err(miette!(
            help = "gains of another loop lose their margin on the board: docs/tuning.md",
            "--send with --loop {}; expected --loop delayed, which is what runs on the board",
            arguments.way.name()
        ));
    }
    if arguments.send && (arguments.tick - f64::from(protocol::TICK_S)).abs() > 1e-9 {
        return Err(miette!("--send with --tick {}; expected {}, the board's own", arguments.tick, protocol::TICK_S));
    }
    Ok(())
}

/// The actuator that the options name.
fn actuator(arguments: &Arguments) -> miette::Result<Actuator> {
    let mut actuator = if !arguments.numerator.is_empty() {
        let (numerator, denominator) = (&arguments.numerator, &arguments.denominator);
        let wrong = numerator.iter().chain(denominator).any(|c| !c.is_finite());
        let order = denominator.len().saturating_sub(1);
        if wrong || !(1..=6).contains(&order) || denominator[0] == 0.0 || numerator.len() > order || numerator[0] == 0.0
        {
            return Err(miette!(
                "--numerator has {} numbers and --denominator {}; expected an order of 1 to 6, a numerator of lower order, the first \
                 number of both not 0",
                numerator.len(),
                denominator.len()
            ));
        }
        let exact = |list: &[f64]| list.iter().map(|value| Known::exactly(*value)).collect();
        let form = Form::Coefficients { numerator: exact(numerator), denominator: exact(denominator) };
        Actuator { title: "the plant of the options".to_owned(), source: String::new(), form, ..Actuator::thesis() }
    } else {
        Actuator::named(&arguments.actuator)?
    };
    if let Some(delay_s) = arguments.delay {
        actuator.delay_s = Known::exactly(delay_s);
    }
    Ok(actuator)
}

fn asked(arguments: &Arguments, actuator: &Actuator) -> miette::Result<Asked> {
    let uncertain: Uncertain = match arguments.percent {
        Some(percent) => Uncertain::within(&actuator.plant(), 0.01 * percent),
        None => actuator.uncertain(0.1),
    };
    let sampling = |ticks_late| Sampling { tick_s: arguments.tick, ticks_late, limit_v: None, windup: Windup::Board };
    let way = match arguments.way {
        Loop::Continuous => Way::Continuous,
        Loop::Sampled => Way::Sampled(sampling(0)),
        Loop::Delayed => Way::Sampled(sampling(1)),
    };
    if !finite(&uncertain.plant) {
        return Err(miette!(
            "the plant's coefficients are beyond all numbers; expected poles and gains of a real actuator"
        ));
    }
    Ok(Asked {
        uncertain,
        flaws: if arguments.ideal { Flaws::NONE } else { actuator.flaws() },
        way,
        limits: Limits {
            command_v: arguments.u_max.unwrap_or(actuator.command_limit_v),
            overshoot: arguments.overshoot,
            undershoot: arguments.undershoot,
            sensitivity: arguments.sensitivity,
            phase_deg: arguments.phase,
            step_mm: arguments.step,
            cut: arguments.cut,
        },
        rule: if arguments.appendix_e { Rule::AppendixE } else { Rule::Text },
        robust: arguments.robust,
    })
}

fn finite(plant: &Plant) -> bool {
    plant.numerator.coefficients().iter().chain(plant.denominator.coefficients()).all(|c| c.is_finite())
}

/// Sets the gains and the actuator on the board, and says so.
fn send(arguments: &Arguments, actuator: &Actuator, gains: &Gains) -> miette::Result<String> {
    let sent = gains.sent();
    if !firmware::pid::gains_are_usable(&sent) {
        return Err(miette!("the board would refuse these gains: {sent:?}"));
    }
    let setting = Setting::of(actuator, Some(sent))?;
    let link = crate::link::open(&arguments.board).into_diagnostic()?;
    let (mut session, hello) = Session::open(link, Patience::default()).into_diagnostic()?;
    let taken = set(&mut session, setting)?;
    let version = crate::session::commit_text(&hello.build);
    Ok(format!("to the board at {} (firmware {version}), until its next reset; {taken}", arguments.board))
}

/// Sets a board for an actuator, and says what it took: the actuator first, so that one that is refused leaves the gains.
pub(super) fn set<L: Link>(session: &mut Session<L>, setting: Setting) -> miette::Result<String> {
    let reach = format!("targets to {:.1} mm at {:.0} mm/s", setting.actuator.reach_mm, setting.actuator.rate_mm_s);
    let taken = match session.set_actuator(setting.actuator) {
        Ok(()) => reach,
        Err(SessionError::Refused { reason: Refusal::Unknown, .. }) => {
            "gains alone, for its firmware is older than settings of an actuator".to_owned()
        }
        Err(error) => return Err(error).into_diagnostic(),
    };
    session.set_gains(setting.gains).into_diagnostic()?;
    Ok(taken)
}

#[cfg(test)]
mod tests;
