//! Scores the diagnosis on hidden cases: `cargo run --release -p tests --example hidden -- [CASES A DESIGN] [DESIGN ...]`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::time::Instant;

use palpate::diagnose::{self, Models};
use palpate::simulate::Solver;
use rayon::prelude::*;
use tests::hidden::{Case, Design, NoiseKind, What};

fn main() {
    let mut words = std::env::args().skip(1);
    let cases: u64 = words.next().map_or(5, |w| w.parse().expect("a number of cases"));
    let named: Vec<String> = words.collect();
    let code = named.iter().find(|w| !w.starts_with('D')).cloned();
    let designs: Vec<Design> = Design::ALL
        .into_iter()
        .filter(|d| named.iter().all(|w| !w.starts_with('D')) || named.contains(&d.name()))
        .collect();
    let (solver, models) = (Solver::new(), Models::default());
    for design in designs {
        let list: Vec<Case> = (0..cases)
            .map(|seed| {
                let case = Case::new(design, seed);
                match &code {
                    Some(code) if code == "clean" => case.hiding(What::Clean),
                    Some(code) if code == "matched" => case.hiding(What::Clean).in_noise(NoiseKind::Matched),
                    Some(code) if code == "pairs" => {
                        case.hiding(What::Pair(tests::hidden::PAIRS[seed as usize % 10], 3 + (seed as usize / 10) % 2))
                    }
                    Some(code) => match tests::hidden::CATALOGUE.iter().find(|c| *c == code) {
                        Some(found) => case.hiding(What::Catalogue(found, (seed % 5) as usize)),
                        None => {
                            let found = tests::hidden::OUTSIDE.iter().find(|c| *c == code).expect("a code");
                            case.hiding(What::Outside(found, (seed % 5) as usize))
                        }
                    },
                    None => case,
                }
            })
            .collect();
        list.par_iter().for_each(|case| {
            let start = Instant::now();
            let truth = case.truth();
            let made = match case.make(&solver) {
                Ok(made) => made,
                Err(error) => {
                    println!("{} {}: NOT MADE {error}", design.name(), case.seed);
                    return;
                }
            };
            let made_s = start.elapsed().as_secs_f64();
            let found = match diagnose::diagnose(&made.experiment(), &models, &|_, _, _| {}) {
                Ok(found) => found,
                Err(error) => {
                    println!("{} {}: FAILED {error}", design.name(), case.seed);
                    return;
                }
            };
            let found = &found[0];
            let names: Vec<String> = found
                .findings
                .iter()
                .map(|f| {
                    let p: Vec<String> = f.parameters.iter().map(|(n, v, _)| format!("{n}={v:.3}")).collect();
                    format!("{}({}){}", f.code, p.join(" "), if f.ambiguous_with.is_empty() { String::new() } else { format!("|{}", f.ambiguous_with.join("|")) })
                })
                .collect();
            let e = found.evidence.as_ref();
            let worst = e.map_or(0.0, |e| e.adequacy.worst());
            let top: Vec<String> = e.map_or(Vec::new(), |e| {
                e.singles.iter().take(4).map(|s| format!("{}:{:.0}/{:.2}{}{}{}{}", s.fit.candidates[0].effect.code, e.base.square - s.fit.square, s.adequacy.worst(), if s.beats_noise {"n"} else {"-"}, if s.predicts {"p"} else {"-"}, if s.beats_placebo {"b"} else {"-"}, if s.fit.at_bound {"B"} else {""})).collect()
            });
            let (noise, base) = e.map_or((String::new(), String::new()), |e| (format!("s{:.4}/{:.4} j{:.3}/{:.3} g{:.4}/{:.4} tc{:.2}/{:.2} w{:.1} r{:.3}", e.noise.sensor.sigma_n, case.spec().noise.sensor_n, e.noise.jitter.contact_mm, case.spec().noise.contact_jitter_mm, e.noise.jitter.gain, case.spec().noise.gain_jitter, e.noise.sensor.correlation_s, case.spec().noise.correlation_s, e.noise.sensor.white, e.noise.sensor.relative), format!("mu {:.4}/{:.4} a {:.2}/{:.2} chi2 {:.0}/{}", e.base.model.mu_mpa, truth.foam.mu_mpa, e.base.model.alpha, truth.foam.alpha, e.base.square, e.base.residual.len())));
            println!("{} {} {:?} {:?} -> {} {} in {:?} worst {worst:.2} | {} | {noise} | {base} | made {made_s:.1} s, diagnosed {:.1} s", design.name(), case.seed, truth.what, truth.effects.iter().map(|e| e.to_toml().replace('\n', " ").replace("[[effect]] code = ", "")).collect::<Vec<_>>(), found.verdict.word().to_uppercase(), names.join(" + "), found.shows_in, top.join(" "), found.seconds);
        });
    }
}
