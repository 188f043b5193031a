//! Hidden cases that each led to a rule: `cargo run --release -p tests --example regressions`; some minutes. Exits with 1 where one is lost.

use std::error::Error;
use std::process::ExitCode;

use palpate::diagnose::Models;
use palpate::simulate::Solver;
use tests::regressions::all;

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let (solver, models) = (Solver::new(), Models::kept());
    let all = all();
    let mut lost = 0;
    for one in &all {
        let judged = one.judge(&solver, &models)?;
        let word = if judged.holds { "ok  " } else { "LOST" };
        println!("{word} {}", judged.scored.line());
        if !judged.holds {
            lost += 1;
            println!("     {}", one.why);
        }
    }
    println!("{} of {} hold", all.len() - lost, all.len());
    Ok(if lost == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
