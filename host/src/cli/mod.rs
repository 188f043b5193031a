//! The commands of `palpate`.

pub mod actuator;
mod answer;
pub mod board;
mod calibrate;
pub mod control_curve;
pub mod demo;
pub mod diagnose;
pub mod displacement;
pub mod feel;
pub mod field;
mod file;
pub mod finger;
pub mod flash;
pub mod gain;
mod gains;
pub mod identify;
pub mod init;
mod keep;
mod last_run;
pub mod log;
pub mod lut;
pub mod magnet;
mod many;
mod mode;
pub mod monitor;
pub mod plan;
pub mod press;
pub mod progress;
mod range;
pub mod selftest;
mod series;
pub mod simulate;
pub mod study;
pub mod sweep;
mod together;
mod tour;
pub mod track;
pub mod trial;
pub mod tune;

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use miette::{Context, IntoDiagnostic};

/// Identify soft materials by touch, and display their softness to a finger.
#[derive(Debug, Parser)]
#[command(version, about, propagate_version = true, max_term_width = 100)]
#[command(after_help = "Results go to standard output, progress and messages to standard error.\n\
Exit status: 0 also for \"nothing found\", 2 for bad input.")]
pub struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run the whole chain on the simulated board: table, upload, palpations, report
    Demo(demo::Arguments),
    /// Listen to a board: live in the terminal, to CSV and to MCAP
    Log(log::Arguments),
    /// Watch a board and control it by keys, in the terminal
    Monitor(monitor::Arguments),
    /// Ask a board, set it up, send it a table; or run the simulated one over TCP
    Board(board::Arguments),
    /// Make one palpation on a board and print what was touched
    Press(press::Arguments),
    /// Write firmware and table through a debug probe
    Flash(flash::Arguments),
    /// Test a bare NUCLEO with three wires: chip, converter, flash, interlock, watchdog, links
    Selftest(selftest::Arguments),
    /// Look at recordings and write the experiment.toml that reads them
    Init(init::Arguments),
    /// Find a material's parameters in indentation recordings
    Identify(identify::Arguments),
    /// Find what the simulation of an experiment gets wrong, and name the cause
    Diagnose(diagnose::Arguments),
    /// Rank the runs that are worth making next, by what they would decide
    Plan(plan::Arguments),
    /// Measure what an extended model gains on a board: recognition and parameters, before and after
    Gain(gain::Arguments),
    /// Write an experiment folder from a model with hidden effects and realistic noise
    Simulate(simulate::Arguments),
    /// Repeat a study of the thesis on your recordings or on a simulated foam, with pictures
    Study(study::Arguments),
    /// Compute a look-up table by finite elements, sweep more parameters, or explain a table
    Lut(lut::Arguments),
    /// Compute a magnet's field by finite elements: flux density, inductance, heat, maps
    Magnet(magnet::Arguments),
    /// Find what coil and actuator must do so that a material is felt: control curves by finite elements
    ControlCurve(control_curve::Arguments),
    /// Press a display, simulated or real, and tell how near it comes to the materials that it shows
    Feel(feel::Arguments),
    /// Go round a bench in a random order, and tell its foams and tissues apart
    Tour(tour::Arguments),
    /// Make displacement tables of the actuator from recorded compressions
    Displacement(displacement::Arguments),
    /// Search the gains of the display's position loop, with margins and a certified worst case
    Tune(tune::Arguments),
    /// Identify the linear actuator of a display from recordings
    Actuator(actuator::Arguments),
    /// Test with blind subjects what a display is taken for, and analyse the answers
    Trial(trial::Arguments),
    /// Press a finger on a plate or a foam by finite elements: force, contact, pressure, Mises stress
    Finger(finger::Arguments),
    /// Follow a finger or probe tip through recorded frames: sub-pixel positions with their uncertainty
    Track(track::Arguments),
    /// Look inside a specimen under the ball: stretch, stress and pressure for ParaView, and a picture
    Field(field::Arguments),
}

/// Exit status for bad input.
pub const BAD_INPUT: u8 = 2;

/// Parses the command line, runs the command and prints its error, if any, to standard error.
pub fn main() -> ExitCode {
    let cli = Cli::parse();
    let mut status = 0;
    let done = match cli.command {
        Command::Demo(arguments) => demo::run(&arguments),
        Command::Log(arguments) => log::run(&arguments),
        Command::Monitor(arguments) => monitor::run(&arguments),
        Command::Board(arguments) => board::run(&arguments),
        Command::Press(arguments) => press::run(&arguments).map(|told| status = told),
        Command::Flash(arguments) => flash::run(&arguments),
        Command::Selftest(arguments) => selftest::run(&arguments).map(|told| status = told),
        Command::Init(arguments) => init::run(&arguments),
        Command::Identify(arguments) => identify::run(&arguments),
        Command::Diagnose(arguments) => diagnose::run(&arguments),
        Command::Plan(arguments) => plan::run(&arguments),
        Command::Gain(arguments) => gain::run(&arguments),
        Command::Simulate(arguments) => simulate::run(&arguments),
        Command::Study(arguments) => study::run(&arguments),
        Command::Lut(arguments) => lut::run(&arguments),
        Command::Magnet(arguments) => magnet::run(&arguments),
        Command::ControlCurve(arguments) => control_curve::run(&arguments),
        Command::Feel(arguments) => feel::run(&arguments),
        Command::Tour(arguments) => tour::run(&arguments),
        Command::Displacement(arguments) => displacement::run(&arguments),
        Command::Tune(arguments) => tune::run(&arguments),
        Command::Actuator(arguments) => actuator::run(&arguments),
        Command::Trial(arguments) => trial::run(&arguments),
        Command::Finger(arguments) => finger::run(&arguments),
        Command::Track(arguments) => track::run(&arguments),
        Command::Field(arguments) => field::run(&arguments),
    };
    let printed = crate::print::finish().into_diagnostic().wrap_err("standard output");
    match done.and(printed) {
        Ok(()) => ExitCode::from(status),
        Err(error) => {
            errln!("{error:?}");
            ExitCode::from(BAD_INPUT)
        }
    }
}
