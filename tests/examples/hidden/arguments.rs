//! What is asked for.

use std::path::PathBuf;

use tests::arguments::number;
use tests::hidden::Design;
use tests::score::suite::FIRST_SEED;

/// What is asked for.
#[derive(Debug, PartialEq)]
pub struct Arguments {
    /// Cases of each design.
    pub cases: usize,
    /// Cases of each design that are left out at the beginning, to come back to one.
    pub skip: usize,
    /// Seeds of the cases that are scored; all where none is given.
    pub these: Vec<u64>,
    /// Designs.
    pub designs: Vec<Design>,
    /// One code, or several with commas between them; else all.
    pub only: Option<String>,
    /// Seed of the first case of each design.
    pub first_seed: u64,
    /// A line a case.
    pub verbose: bool,
    /// Where every case is written.
    pub json: Option<PathBuf>,
    /// Where the experiments themselves are written, a folder each.
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
        let mut asked = Self {
            cases: 100,
            skip: 0,
            these: Vec::new(),
            designs: Vec::new(),
            only: None,
            first_seed: FIRST_SEED,
            verbose: false,
            json: None,
            folders: None,
            write: false,
        };
        while let Some(word) = words.next() {
            let mut value = || words.next().ok_or_else(|| format!("{word} needs a value"));
            match word.as_str() {
                "--cases" => asked.cases = number(&word, &value()?)?,
                "--skip" => asked.skip = number(&word, &value()?)?,
                "--these" => {
                    asked.these = value()?.split(',').map(|seed| number(&word, seed)).collect::<Result<_, _>>()?;
                }
                "--seed" => asked.first_seed = number(&word, &value()?)?,
                "--design" => asked.designs.push(design(&value()?)?),
                "--only" => asked.only = Some(value()?),
                "--json" => asked.json = Some(PathBuf::from(value()?)),
                "--folders" => asked.folders = Some(PathBuf::from(value()?)),
                "--verbose" => asked.verbose = true,
                "--write" => asked.write = true,
                _ => {
                    return Err(format!(
                        "{word}: expected --cases, --skip, --these, --seed, --design, --only, --json, --folders, --verbose or --write"
                    ));
                }
            }
        }
        if asked.designs.is_empty() {
            asked.designs = Design::ALL.to_vec();
        }
        Ok(asked)
    }
}

fn design(name: &str) -> Result<Design, String> {
    Design::named(name).ok_or_else(|| format!("--design {name}: expected D6, D18, D36, D60 or own"))
}
