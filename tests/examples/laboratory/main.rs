//! Scores the diagnosis on laboratory worlds: `cargo run --release -p tests --example laboratory --
//! --cases 100`.
//!
//! A seed draws its design, unless `--design D18` (D36, D60, own) names one; `--cases` is the
//! number of seeds (24 unless stated), `--seed` the first of them. `--verbose` tells every world on
//! a line, `--json FILE` writes every one, `--folders FOLDER` their experiments,
//! `--write` puts the tables into docs/hidden-effects.md.

mod arguments;

use std::path::Path;
use std::time::Instant;

use arguments::Arguments;
use palpate::diagnose::Models;
use palpate::simulate::{Effect, Solver};
use serde_json::{Value, json};
use tests::document::replace_section;
use tests::laboratory::World;
use tests::laboratory::score::Scored;
use tests::laboratory::table::Score;
use tests::score::ScoreError;
use tests::score::cores::on_all_cores;
use tests::score::share::Yardstick;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments = Arguments::parse(std::env::args().skip(1))?;
    let start = Instant::now();
    let seeds = arguments.first_seed..arguments.first_seed + arguments.cases as u64;
    let world = |seed: u64| arguments.design.map_or_else(|| World::drawn(seed), |design| World { seed, design });
    let worlds: Vec<World> = seeds.map(world).collect();
    let (solver, models) = (Solver::new(), Models::default());
    let yardstick = Yardstick { solver: &solver, models: &models };
    let (mut scored, mut discarded, mut failures) = (Vec::new(), 0, Vec::new());
    for (world, result) in score_all(&worlds, &yardstick, &arguments) {
        match result {
            Ok(Some(one)) => scored.push(one),
            Ok(None) => discarded += 1,
            Err(error) => failures.push(format!("{} {}: {error}", world.design.name(), world.seed)),
        }
    }
    failures.iter().for_each(|line| eprintln!("{line}"));
    scored.sort_by_key(|one| one.world.seed);
    let mut text = Score { list: &scored, discarded }.markdown();
    text.push_str(&format!(
        "\n{} worlds of {} seeds from {} in {:.0} min on {} threads; {} could not be scored.\n",
        scored.len(),
        arguments.cases,
        arguments.first_seed,
        start.elapsed().as_secs_f64() / 60.0,
        rayon::current_num_threads(),
        failures.len(),
    ));
    println!("{text}");
    if let Some(path) = &arguments.json {
        let records: Vec<Value> = scored.iter().map(record).collect();
        std::fs::write(path, serde_json::to_string_pretty(&records)?)?;
    }
    if arguments.write {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/hidden-effects.md");
        let document = std::fs::read_to_string(&path)?;
        std::fs::write(&path, replace_section(&document, "laboratory", &text)?)?;
    }
    if failures.is_empty() { Ok(()) } else { Err(format!("{} worlds could not be scored", failures.len()).into()) }
}

/// Scores worlds, several at a time.
fn score_all<'a>(
    worlds: &'a [World],
    yardstick: &Yardstick<'_>,
    arguments: &Arguments,
) -> Vec<(&'a World, Result<Option<Scored>, ScoreError>)> {
    let scored = |world: &World| match world.make(yardstick)? {
        Some(made) => {
            if let Some(folder) = &arguments.folders {
                made.experiment.write(&folder.join(format!("{}-{}", world.design.name(), world.seed)))?;
            }
            Scored::of(world, &made, yardstick).map(Some)
        }
        None => Ok(None),
    };
    let told = |world: &World| {
        let begin = Instant::now();
        let result = scored(world);
        if arguments.verbose {
            let line = match &result {
                Ok(Some(one)) => one.line(),
                Ok(None) => format!("{} {} {} is no world", world.design.name(), world.seed, world.what().word()),
                Err(error) => format!("{} {}: {error}", world.design.name(), world.seed),
            };
            println!("{line} | {:.0} s", begin.elapsed().as_secs_f64());
        }
        result
    };
    on_all_cores(worlds, told).into_iter().map(|(at, result)| (&worlds[at], result)).collect()
}

fn record(s: &Scored) -> Value {
    let truth = &s.truth;
    let dominating: Vec<Value> = truth
        .dominating
        .iter()
        .map(|one| json!({ "effect": one.effect.to_toml(), "share": one.share, "strength": one.strength }))
        .collect();
    let findings: Vec<Value> = s
        .answer
        .findings
        .iter()
        .map(|f| json!({ "code": f.code, "form": f.form, "ambiguous_with": f.ambiguous_with }))
        .collect();
    let hits: Vec<Value> =
        s.hits.iter().map(|h| json!({ "parameter": h.name, "held": h.held, "deviation": h.deviation })).collect();
    json!({
        "design": s.world.design.name(),
        "seed": s.world.seed,
        "hidden": truth.what.word(),
        "kind": truth.kind().map(tests::laboratory::Kind::word),
        "codes": truth.codes(),
        "dominating": dominating,
        "share": truth.share,
        "visible": truth.visible(),
        "minors": truth.minors.iter().map(Effect::to_toml).collect::<Vec<_>>(),
        "rests": truth.rests.iter().map(|rest| Effect::Rest(*rest).to_toml()).collect::<Vec<_>>(),
        "rests_rms": truth.rests_rms,
        "mu_MPa": truth.foam.mu_mpa,
        "alpha": truth.foam.alpha,
        "verdict": s.answer.verdict.word(),
        "reason": s.answer.reason,
        "findings": findings,
        "shows_in": s.answer.shows_in,
        "mark": s.mark.word(),
        "told": s.told,
        "intervals": hits,
        "seconds": s.answer.seconds,
    })
}
