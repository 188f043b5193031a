//! The true display and hand that `--plant` asks for.

use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use miette::miette;

use crate::plant::Constants;

/// Words that `--plant` takes beside files.
const WORDS: &str = "frozen, drawn:SEED, voice-coil or drawn-voice-coil:SEED";

/// The word behind `--plant`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Plant {
    /// The spindle, as its file has it.
    Frozen,
    /// The same, its constants drawn by a seed.
    Drawn(u64),
    /// The voice coil, as its file has it.
    VoiceCoil,
    /// The same, its constants drawn by a seed.
    DrawnVoiceCoil(u64),
    /// A file of constants.
    File(PathBuf),
}

impl Plant {
    /// Its constants.
    ///
    /// # Errors
    /// A file that is not there, or has a mistake.
    pub fn constants(&self) -> miette::Result<Constants> {
        Ok(match self {
            Self::Frozen => Constants::frozen()?,
            Self::Drawn(seed) => Constants::drawn(*seed)?,
            Self::VoiceCoil => Constants::voice_coil()?,
            Self::DrawnVoiceCoil(seed) => Constants::voice_coil_drawn(*seed)?,
            Self::File(file) if file.is_file() => Constants::read(file)?,
            Self::File(file) => {
                return Err(miette!(
                    "--plant is {}: no such file; expected {WORDS}, or a file of constants",
                    file.display()
                ));
            }
        })
    }

    /// The file that comes with the program.
    ///
    /// # Errors
    /// None comes with it for this word.
    pub fn text(&self) -> miette::Result<&'static str> {
        match self {
            Self::Frozen => Ok(Constants::FROZEN),
            Self::VoiceCoil => Ok(Constants::VOICE_COIL),
            _ => Err(miette!(
                "--copy with --plant {self}; expected frozen or voice-coil, whose files come with the program"
            )),
        }
    }

    /// True for the plants of the program whose shaft a voice coil moves: the board is set for it unasked.
    pub const fn has_voice_coil(&self) -> bool {
        matches!(self, Self::VoiceCoil | Self::DrawnVoiceCoil(_))
    }
}

impl FromStr for Plant {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let seeded = |word: &str, seed: &str, plant: fn(u64) -> Self| {
            seed.parse().map(plant).map_err(|_| format!("expected {word}: with a whole number from 0, or {WORDS}"))
        };
        match text.split_once(':') {
            Some((word @ "drawn", seed)) => seeded(word, seed, Self::Drawn),
            Some((word @ "drawn-voice-coil", seed)) => seeded(word, seed, Self::DrawnVoiceCoil),
            _ if text == "frozen" => Ok(Self::Frozen),
            _ if text == "voice-coil" => Ok(Self::VoiceCoil),
            _ => Ok(Self::File(Path::new(text).to_owned())),
        }
    }
}

impl fmt::Display for Plant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Frozen => write!(f, "frozen"),
            Self::Drawn(seed) => write!(f, "drawn:{seed}"),
            Self::VoiceCoil => write!(f, "voice-coil"),
            Self::DrawnVoiceCoil(seed) => write!(f, "drawn-voice-coil:{seed}"),
            Self::File(file) => write!(f, "{}", file.display()),
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn every_word_is_told_as_it_was_asked_for() {
        for word in ["frozen", "drawn:7", "voice-coil", "drawn-voice-coil:0", "lab/plant.toml", "C:/plant.toml"] {
            assert_eq!(word.parse::<Plant>().unwrap().to_string(), word);
        }
    }

    #[test]
    fn a_seed_that_is_none_is_told() {
        for (word, expected) in [
            ("drawn:", "expected drawn: with a whole number"),
            ("drawn:x", "expected drawn: with a whole number"),
            ("drawn-voice-coil:x", "expected drawn-voice-coil: with a whole number"),
            ("drawn-voice-coil:-1", "expected drawn-voice-coil: with a whole number"),
        ] {
            let text = word.parse::<Plant>().unwrap_err();
            assert!(text.contains(expected), "{word}: {text}");
        }
    }

    #[test]
    fn only_voice_coils_set_the_board_for_one() {
        let own = |word: &str| word.parse::<Plant>().unwrap();
        assert!(own("voice-coil").has_voice_coil() && own("drawn-voice-coil:3").has_voice_coil());
        assert!(!own("frozen").has_voice_coil() && !own("drawn:3").has_voice_coil());
        assert_ne!(own("voice-coil").constants().unwrap(), own("frozen").constants().unwrap());
        assert_ne!(own("drawn:3").constants().unwrap(), own("drawn:4").constants().unwrap());
    }
}
