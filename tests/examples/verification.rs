//! Writes the tables of docs/verification.md: `cargo run --release -p tests --example verification`.

use std::fmt::Write as _;
use std::path::Path;

use lut_gen::solid::verify::{Check, closed_forms};
use tests::document::replace_section;
use tests::magnets::{self, Shared};
use tests::reference::{Comparison, curves, folder, table};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/verification.md");
    let mut text = std::fs::read_to_string(&path)?;
    match curves(&folder())? {
        Some(references) => {
            let compared: Result<Vec<Comparison>, _> = references.into_iter().map(Comparison::of).collect();
            let table = table(&compared?);
            println!("{table}");
            text = replace_section(&text, "reference curves", &table)?;
        }
        None => println!("SKIPPED: {} not found; the table of other codes stays as it is", folder().display()),
    }
    if tests::shared_or_skipped("reference/display").is_some() {
        let table = magnets::table(&magnets::all(Shared(&tests::shared()))?);
        println!("{table}");
        text = replace_section(&text, "magnets", &table)?;
    }
    let table = closed_form_table(&closed_forms()?);
    println!("{table}");
    text = replace_section(&text, "closed forms", &table)?;
    std::fs::write(&path, text)?;
    println!("wrote {}", path.display());
    Ok(())
}

fn closed_form_table(checks: &[Check]) -> String {
    let mut out =
        String::from("| check | case | source | difference [%] | allowed [%] | |\n|---|---|---|---|---|---|\n");
    for c in checks {
        let (error, allowed) = (figure(100.0 * c.error), figure(100.0 * c.tolerance).replace("< ", ""));
        let verdict = if c.met() { "met" } else { "MISSED" };
        let _ = writeln!(out, "| {} | {} | {} | {error} | {allowed} | {verdict} |", c.quantity, c.case, c.source);
    }
    out
}

/// Two decimals, and what vanishes in them as a bound, a power of ten: rounding errors differ between machines.
fn figure(percent: f64) -> String {
    if percent < 0.005 {
        format!("< 1e{:.0}", (percent.max(1e-300).log10() - 1e-9).ceil())
    } else {
        format!("{percent:.2}")
    }
}
