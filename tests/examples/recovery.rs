//! Blind recovery of foams: `cargo run --release -p tests --example recovery [-- CASES [direct]]`.
//!
//! With `direct` every fit solves for itself; otherwise all fits share one force model a ball.

use palpate::identify::spec::FitSpec;
use rayon::prelude::*;
use tests::recovery::{Recovered, cases, models, recover, statistics};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let count = arguments.next().map_or(Ok(1000), |text| text.parse())?;
    let direct = arguments.next().is_some_and(|word| word == "direct");
    let spec = FitSpec::default();
    let (cases, failed) = cases(1, count);
    println!("{} cases made, {failed} without a solve", cases.len());
    let models = if direct { Vec::new() } else { models()? };
    for model in &models {
        println!("force model within {:.3} % of the peak", 100.0 * model.error().total());
    }
    let one = |case| recover(case, &models, &spec);
    // Timed one by one, each fit with all cores.
    let all: Result<Vec<Recovered>, _> =
        if direct { cases.iter().map(one).collect() } else { cases.par_iter().map(one).collect() };
    let all = all?;
    for r in all.iter().take(if count <= 30 { 30 } else { 0 }) {
        println!(
            "mu {:.5} {:+.1} % (bound {:.1} %), alpha {:.2} {:+.1} % (bound {:.1} %) [{:.2}, {:.2}] {} {} solves {:.2} s",
            r.truth[0],
            100.0 * (r.value[0] / r.truth[0] - 1.0),
            100.0 * r.bound[0],
            r.truth[1],
            100.0 * (r.value[1] / r.truth[1] - 1.0),
            100.0 * r.bound[1],
            r.interval[1].0,
            r.interval[1].1,
            r.outcome,
            r.solves,
            r.seconds
        );
    }
    println!("{:#?}", statistics(&all));
    Ok(())
}
