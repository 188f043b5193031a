//! Whether intervals hold the truth where a cause is there that stays silent.
//!
//! `cargo run --release -p tests --example silent -- [--first SEED] [--count N] [--clean] [--rig] [--identify]` draws experiments with one hidden cause each
//! (`tests::silent` says from which ranges) and prints how often the 95 % intervals of mu and alpha hold the truth: by `diagnose`, and by `identify`; all that are drawn, and
//! those in which the diagnosis is silent. `--rig` puts the usual errors of a rig beside each cause. A line an experiment, a table at the end.

use std::error::Error;

use lut_gen::solid::contact::Ball;
use lut_gen::solid::model::{ForceModel, ModelSpec, Specimen};
use palpate::diagnose::{self, Models};
use palpate::experiment::Experiment;
use palpate::identify::identify_from;
use palpate::identify::newton::condition::{Condition, Source};
use palpate::identify::newton::setup::ALPHA;
use palpate::identify::spec::FitSpec;
use palpate::simulate::{Solver, simulate};
use palpate::unseen;
use tests::hidden::Design;
use tests::silent::{CAUSES, Silent};

/// An interval, and that of noise alone.
type Spans = [[(f64, f64); 2]; 2];

/// What one experiment said.
struct Told {
    code: &'static str,
    verdict: &'static str,
    /// By diagnose, if it said anything.
    diagnosed: Option<Spans>,
    identified: Option<Spans>,
    truth: [f64; 2],
}

/// Forces of the two balls of the designs, for all fits of `identify`.
fn forces() -> Result<Vec<ForceModel>, Box<dyn Error>> {
    let one = |radius_mm: f64| {
        let specimen = Specimen { radius_mm: 25.0, ..Specimen::of_height(12.7) };
        let mut spec = ModelSpec::new(specimen, Ball { radius_mm }, 3.95);
        (spec.alpha, spec.alpha_nodes) = (ALPHA, 14);
        ForceModel::build(&spec, &|_, _| {})
    };
    Ok(vec![one(4.0)?, one(6.0)?])
}

fn identified(
    experiment: &Experiment,
    forces: &[ForceModel],
    models: &Models,
) -> Result<Option<Spans>, Box<dyn Error>> {
    let source = |condition: &Condition| {
        let at = usize::from(condition.grip.ball_mm() > 5.0);
        Source::Model(Box::new(forces[at].clone()))
    };
    let mut found = identify_from(experiment, material(experiment), &FitSpec::default(), &source)?;
    unseen::widen(experiment, &mut found, models, &|_, _| {})?;
    let Some(fit) = &found.fit else { return Ok(None) };
    let of = |name: &str| fit.parameters.iter().find(|p| p.name == name);
    let spans = |p: &palpate::identify::fit::Parameter| {
        let noise = p.unseen.as_ref().map_or(p.interval95, |u| u.noise);
        [(p.interval95.low, p.interval95.high), (noise.low, noise.high)]
    };
    Ok(of("mu_MPa").zip(of("alpha")).map(|(mu, alpha)| {
        let (mu, alpha) = (spans(mu), spans(alpha));
        [[mu[0], alpha[0]], [mu[1], alpha[1]]]
    }))
}

/// Name of the only material.
fn material(experiment: &Experiment) -> &str {
    experiment.specimens.first().map_or("", |one| one.material.as_str())
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let has = |flag: &str| arguments.iter().any(|a| a == flag);
    let number = |flag: &str, without: u64| {
        let at = arguments.iter().position(|a| a == flag);
        at.and_then(|at| arguments.get(at + 1)).map_or(Ok(without), |text| text.parse::<u64>())
    };
    let (first, count) = (number("--first", 900_000)?, number("--count", 500)?);
    let (solver, models) = (Solver::new(), Models::kept());
    let forces = if has("--identify") { forces()? } else { Vec::new() };
    let mut all: Vec<Told> = Vec::new();
    for seed in first..first + count {
        let code = (!has("--clean")).then(|| CAUSES[(seed % CAUSES.len() as u64) as usize]);
        let design = if (seed / CAUSES.len() as u64).is_multiple_of(2) { Design::D6 } else { Design::D18 };
        let mut case = Silent::new(design, seed, code);
        if has("--rig") {
            case = case.on_a_rig();
        }
        let experiment = match simulate(&case.spec, &solver, &|_, _, _| {}) {
            Ok(made) => made.experiment(),
            Err(cause) => {
                println!("{seed} {cause}");
                continue;
            }
        };
        let (verdict, diagnosed) = answered(&experiment, &models)?;
        let identified = if has("--identify") { identified(&experiment, &forces, &models)? } else { None };
        let told = Told { code: code.unwrap_or("nothing"), verdict, diagnosed, identified, truth: case.truth };
        println!("{seed} {} {} {verdict} {}", design.name(), told.code, words(&told));
        all.push(told);
        if all.len().is_multiple_of(50) {
            table(&all);
        }
    }
    table(&all);
    Ok(())
}

/// The answer of a whole diagnosis.
fn answered(experiment: &Experiment, models: &Models) -> Result<(&'static str, Option<Spans>), Box<dyn Error>> {
    let found = diagnose::diagnose(experiment, models, &|_, _, _| {})?;
    let Some(one) = found.first() else { return Ok(("nothing", None)) };
    let Some(evidence) = &one.evidence else { return Ok((one.verdict.word(), None)) };
    let spans = if one.is_named() {
        evidence.extended().zip(evidence.extended_of_noise())
    } else {
        Some((evidence.before.parameters, evidence.before.of_noise))
    };
    Ok((one.verdict.word(), spans.map(|(wide, noise)| [wide.map(|p| p.1), noise.map(|p| p.1)])))
}

fn holds((low, high): (f64, f64), truth: f64) -> bool {
    (low..=high).contains(&truth)
}

fn words(told: &Told) -> String {
    let one = |spans: &Spans| {
        let each = (0..2).map(|at| {
            let [wide, noise] = [spans[0][at], spans[1][at]];
            let truth = told.truth[at];
            format!(
                "{:+.2}..{:+.2} ({:+.2}..{:+.2}) %{}",
                100.0 * (wide.0 / truth - 1.0),
                100.0 * (wide.1 / truth - 1.0),
                100.0 * (noise.0 / truth - 1.0),
                100.0 * (noise.1 / truth - 1.0),
                if holds(wide, truth) { "" } else { " MISSED" }
            )
        });
        each.collect::<Vec<_>>().join(", ")
    };
    let of = |spans: &Option<Spans>| spans.as_ref().map_or_else(|| "-".to_owned(), one);
    format!("diagnose {}; identify {}", of(&told.diagnosed), of(&told.identified))
}

/// Share of intervals that hold, of both parameters, with the number of experiments.
fn coverage<'a>(list: impl Iterator<Item = (&'a Spans, [f64; 2])>) -> String {
    let list: Vec<_> = list.collect();
    if list.is_empty() {
        return "-".to_owned();
    }
    let share = |kind: usize, at: usize| {
        let held = list.iter().filter(|(spans, truth)| holds(spans[kind][at], truth[at])).count();
        100.0 * held as f64 / list.len() as f64
    };
    let mut times: Vec<f64> = list
        .iter()
        .flat_map(|(spans, _)| {
            (0..2).map(|at| (spans[0][at].1 / spans[0][at].0).ln() / (spans[1][at].1 / spans[1][at].0).ln())
        })
        .collect();
    times.sort_by(f64::total_cmp);
    format!(
        "mu {:.1} %, alpha {:.1} % of {}; noise alone {:.1} and {:.1} %; {:.2} times as wide",
        share(0, 0),
        share(0, 1),
        list.len(),
        share(1, 0),
        share(1, 1),
        times[times.len() / 2]
    )
}

fn table(all: &[Told]) {
    println!("\n| experiments | by | intervals that hold the truth |\n|---|---|---|");
    let row = |name: &str, of: &dyn Fn(&Told) -> bool| {
        let own: Vec<&Told> = all.iter().filter(|t| of(t)).collect();
        let by = |which: fn(&Told) -> &Option<Spans>| {
            coverage(own.iter().filter_map(|t| Some((which(t).as_ref()?, t.truth))))
        };
        println!("| {name} | diagnose | {} |", by(|t| &t.diagnosed));
        println!("| {name} | identify | {} |", by(|t| &t.identified));
    };
    row("all", &|_| true);
    for verdict in ["clean", "unknown", "named", "ambiguous"] {
        row(verdict, &|t| t.verdict == verdict);
    }
    for code in CAUSES {
        row(&format!("{code}, clean"), &|t| t.code == code && t.verdict == "clean");
    }
    println!();
}
