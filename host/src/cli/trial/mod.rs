//! `palpate trial`.

mod analyse;
mod arguments;
mod present;
mod session;
mod told;

use clap::{Args, Subcommand};
use miette::miette;

use arguments::{Analyse, Run};

use super::range::within;
use crate::trial::journal::{MOST_REPEATS, MOST_STIMULI};

/// Subject tests of a softness display.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    /// Present materials blindly in random order and take the answers; goes on where a session ended
    Run(Run),
    /// Confusion table with exact intervals, d', information, Weber fraction, sample size
    Analyse(Analyse),
}

/// Names and library entries of the materials.
fn materials(texts: &[String]) -> miette::Result<Vec<(String, Option<u8>)>> {
    if texts.len() > MOST_STIMULI {
        return Err(miette!("--materials names {} materials; expected 2 to {MOST_STIMULI}", texts.len()));
    }
    let mut all: Vec<(String, Option<u8>)> = Vec::new();
    for text in texts {
        let (name, entry) = match text.split_once('=') {
            None => (text.trim(), None),
            Some((name, entry)) => {
                let number = entry.trim().parse::<u8>();
                let number =
                    number.map_err(|_| miette!("--materials {text}: expected NAME=ENTRY with a number of 0 to 255"))?;
                (name.trim(), Some(number))
            }
        };
        if name.is_empty() || all.iter().any(|(known, _)| known == name) {
            return Err(miette!("--materials {text}: expected a name that is not empty and differs from the others"));
        }
        all.push((name.to_owned(), entry));
    }
    Ok(all)
}

/// Runs the command.
///
/// # Errors
/// A file with a mistake, an option out of range, a board that refuses, a file that cannot be written.
pub fn run(arguments: &Arguments) -> miette::Result<()> {
    match &arguments.what {
        What::Run(asked) => {
            if !(1..=MOST_REPEATS).contains(&asked.repeats) {
                return Err(miette!("--repeats is {}; expected 1 to {MOST_REPEATS}", asked.repeats));
            }
            if let Some(weber) = asked.simulate {
                within("--simulate", weber, 0.001..=10.0, "")?;
            }
            session::run(asked, &materials(&asked.materials)?)
        }
        What::Analyse(asked) => {
            within("--weber", asked.weber, 0.001..=10.0, "")?;
            within("--half-width", asked.half_width, 0.01..=0.5, "")?;
            within("--power", asked.power, 0.5..=0.999, "")?;
            if let Some(right) = asked.right {
                within("--right", right, 0.0..=1.0, "")?;
            }
            analyse::run(asked)
        }
    }
}
