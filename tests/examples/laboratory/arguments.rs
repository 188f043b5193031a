//! What is asked for.

use std::path::PathBuf;

use tests::arguments::number;
use tests::hidden::Design;
use tests::laboratory::DESIGNS;

/// What is asked for.
#[derive(Debug, PartialEq)]
pub struct Arguments {
    /// Number of seeds.
    pub cases: usize,
    /// The first of them.
    pub first_seed: u64,
    /// The one design, else every seed draws its own.
    pub design: Option<Design>,
    /// A line a world.
    pub verbose: bool,
    /// Where every world is written.
    pub json: Option<PathBuf>,
    /// Where every world is written as an experiment.
    pub folders: Option<PathBuf>,
    /// Whether the document is rewritten.
    pub write: bool,
}

impl Arguments {
    /// Reads a command line.
    ///
    /// # Errors
    /// A word that is not known, or a value that is missing or none.
    pub fn parse(mut words: impl Iterator<Item = String>) -> Result<Self, String> {
        let mut asked =
            Self { cases: 24, first_seed: 1, design: None, verbose: false, json: None, folders: None, write: false };
        while let Some(word) = words.next() {
            let mut value = || words.next().ok_or_else(|| format!("{word} needs a value"));
            match word.as_str() {
                "--cases" => asked.cases = number(&word, &value()?)?,
                "--seed" => asked.first_seed = number(&word, &value()?)?,
                "--design" => asked.design = Some(design(&value()?)?),
                "--json" => asked.json = Some(PathBuf::from(value()?)),
                "--folders" => asked.folders = Some(PathBuf::from(value()?)),
                "--verbose" => asked.verbose = true,
                "--write" => asked.write = true,
                _ => {
                    return Err(format!(
                        "{word}: expected --cases, --seed, --design, --json, --folders, --verbose or --write"
                    ));
                }
            }
        }
        Ok(asked)
    }
}

fn design(name: &str) -> Result<Design, String> {
    let found = Design::named(name).filter(|design| DESIGNS.contains(design));
    found.ok_or_else(|| format!("--design {name}: expected D18, D36, D60 or own"))
}
