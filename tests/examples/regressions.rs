//! Hidden cases that each led to a rule: `cargo run --release -p tests --example regressions`; some minutes. Exits with 1 where one is lost.

use std::error::Error;
use std::process::ExitCode;

use palpate::diagnose::Models;
use palpate::simulate::Solver;
use tests::regressions::all;
use tests::score::Scored;

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let (solver, models) = (Solver::new(), Models::kept());
    let all = all();
    let mut lost = 0;
    for one in &all {
        let scored = Scored::of(&one.case, &solver, &models)?;
        if one.right.contains(&scored.outcome) {
            println!("ok   {}", scored.line());
        } else {
            lost += 1;
            println!("LOST {}\n     {}", scored.line(), one.why);
        }
    }
    println!("{} of {} hold", all.len() - lost, all.len());
    Ok(if lost == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
