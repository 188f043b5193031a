//! MultiStart and Gauss-Newton on the six parameters of simulated livers (thesis section 2.11):
//!
//! ```text
//! cargo run --release -p tests --example liver_multistart -- [SEEDS] [SOLVES]
//! ```
#![allow(clippy::print_stdout)]

use palpate::identify::identify;
use palpate::identify::spec::{FitSpec, Method};
use tests::tissue::{LIVER, Pressed, six};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1).map(|text| text.parse::<usize>());
    let seeds = arguments.next().transpose()?.unwrap_or(1);
    let most_solves = arguments.next().transpose()?.unwrap_or(400);
    for seed in (1..).take(seeds) {
        let experiment = Pressed::default().record(&LIVER, seed)?;
        for method in [Method::Simplex, Method::GaussNewton] {
            let spec = FitSpec { method, most_solves, ..six() };
            let found = identify(&experiment, &spec, &|_, _, _| {})?.swap_remove(0);
            println!(
                "seed {seed}, {method:?}: {} in {} solves, {:.0} s",
                found.outcome.word(),
                found.fe_solves,
                found.seconds
            );
            let Some(fit) = &found.fit else { continue };
            println!("  Eq. 14 {:.4} N, {:.5} N rms", fit.objective_n, fit.rmse_n);
            for (name, truth) in LIVER.named() {
                let Some(p) = fit.parameters.iter().find(|p| p.name == name) else { continue };
                let (low, high) = (p.interval95.low, p.interval95.high);
                println!("  {name:8} {:.4e}  95 % {low:.4e} to {high:.4e}, truth {truth:.4e}", p.value);
            }
            for start in fit.search.iter().flat_map(|search| &search.starts) {
                let rest = if start.at_rest { "at rest" } else { "not at rest" };
                println!("  an end at {:.4} N, {rest}", start.descent.value);
            }
            found.messages.iter().for_each(|message| println!("  {message}"));
        }
    }
    Ok(())
}
