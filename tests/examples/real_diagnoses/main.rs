//! Diagnoses the public recordings and the thesis' own tables, and rewrites docs/real-diagnoses.md with its pictures:
//! `cargo run --release -p tests --example real_diagnoses [-- CASE..]`; all cases if none is named.
//!
//! The recordings are not part of this repository; the section of a case whose recordings are not there stays as it is.

mod asked;
mod damper;
mod ecoflex;
mod foam;
mod indented;
mod independent;
mod recorded;
mod tables;
mod two_balls;
mod velostat;

use std::path::Path;

use palpate::report::figure::Figure;
use tests::document::replace_section;

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

/// One case: the section's name, and what makes it; `None` where its recordings are absent.
type Case = (&'static str, fn(&Path) -> Outcome<Option<String>>);

const CASES: [Case; 9] = [
    ("two balls", two_balls::section),
    ("flux density", tables::flux_density),
    ("force sensor", tables::force_sensor),
    ("beef", indented::beef),
    ("silicone", indented::silicone),
    ("velostat", velostat::section),
    ("damper", damper::section),
    ("ecoflex", ecoflex::section),
    ("foam", foam::section),
];

fn main() -> Outcome<()> {
    let wanted: Vec<String> = std::env::args().skip(1).collect();
    if let Some(unknown) = wanted.iter().find(|name| CASES.iter().all(|(known, _)| known != name)) {
        let known: Vec<&str> = CASES.iter().map(|(name, _)| *name).collect();
        return Err(format!("no case \"{unknown}\"; there are {}", known.join(", ")).into());
    }
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    let page = docs.join("real-diagnoses.md");
    for (name, make) in CASES.iter().filter(|(name, _)| wanted.is_empty() || wanted.iter().any(|w| w == name)) {
        if let Some(section) = make(&docs.join("figures"))? {
            let text = replace_section(&std::fs::read_to_string(&page)?, name, &section)?;
            std::fs::write(&page, text)?;
            println!("{name}: written");
        }
    }
    Ok(())
}

/// Writes figures below each other as one picture, and returns the line that shows it.
fn picture(figures: &Path, file: &str, what: &str, parts: &[Figure]) -> Outcome<String> {
    let width = parts.iter().map(|part| part.size.0).fold(0.0, f64::max);
    let mut height = 0.0;
    let mut inside = String::new();
    for part in parts {
        inside += &format!("<g transform=\"translate(0,{height})\">{}</g>\n", part.svg());
        height += part.size.1;
    }
    let svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n{inside}</svg>\n"
    );
    std::fs::write(figures.join(file), svg)?;
    Ok(format!("![{what}](figures/{file})\n"))
}
