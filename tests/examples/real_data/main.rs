//! Fits the public recordings and rewrites docs/real-data.md with its pictures:
//! `cargo run --release -p tests --example real_data [-- SET..]`; SETs are foam, ecoflex, beef and silicone, all if none is named.
//!
//! The recordings are not part of this repository; the section of a set that is not there stays as it is.

mod beef;
mod drawing;
mod ecoflex;
mod foam;
mod recorded;
mod silicone;
mod words;

use std::path::Path;

use tests::document::replace_section;

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

/// One set of recordings: the section's name, and what makes it; `None` where its recordings are absent.
type Set = (&'static str, fn(&Path) -> Outcome<Option<String>>);

const SETS: [Set; 4] =
    [("foam", foam::section), ("ecoflex", ecoflex::section), ("beef", beef::section), ("silicone", silicone::section)];

fn main() -> Outcome<()> {
    let wanted: Vec<String> = std::env::args().skip(1).collect();
    if let Some(unknown) = wanted.iter().find(|name| SETS.iter().all(|(known, _)| known != name)) {
        return Err(format!("no set of recordings \"{unknown}\"; there are foam, ecoflex, beef and silicone").into());
    }
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    let page = docs.join("real-data.md");
    for (name, make) in SETS.iter().filter(|(name, _)| wanted.is_empty() || wanted.iter().any(|w| w == name)) {
        if let Some(section) = make(&docs.join("figures"))? {
            let text = replace_section(&std::fs::read_to_string(&page)?, name, &section)?;
            std::fs::write(&page, text)?;
            println!("{name}: written");
        }
    }
    Ok(())
}
