//! Hidden effects of the display's links, and whether what naming them gains is what is printed:
//! `cargo run --release -p tests --example links -- --cases 2 --seed 97000`.
//!
//! Eighteen kinds, each at three sizes (half, once and twice what a full plan should see), `--cases` times. The printed gain is
//! the fall of the error over repeats that no fit has seen; the true one that over presses of a new session that no fit has seen.
//! `--only gap,creep` runs those kinds alone, with the seeds that they have among all.

use palpate::diagnose::Verdict;
use palpate::diagnose::display::{self, ChannelDiagnosis};
use palpate::extended::display::DisplayModel;
use tests::arguments::cases_and_seed;
use tests::display::{Case, Gains, LEVELS, Outcome, Plan, RIGHT, Scored, Validated, is_right};
use tests::score::rate::bounded;

/// New sessions that the true gain is taken over.
const DAYS: u64 = 64;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (only, rest) = only(std::env::args().skip(1).collect())?;
    let (count, first) = cases_and_seed(rest.into_iter(), (2, 97_000))?;
    let mut scored: Vec<Scored> = Vec::new();
    let mut gains: Vec<(Gains, Validated)> = Vec::new();
    let kinds =
        [Plan::Full, Plan::Finger].into_iter().flat_map(|plan| plan.hidden().iter().map(move |kind| (plan, kind)));
    for (i, (plan, kind)) in kinds.enumerate().filter(|(_, (_, kind))| only.as_ref().is_none_or(|o| o.contains(*kind)))
    {
        for level in 1..LEVELS {
            for repeat in 0..count {
                let seed = first + (i * LEVELS * count + level * count + repeat) as u64;
                let case = Case::clean(plan, seed).hiding(&[kind], level);
                let found =
                    display::diagnose(&case.spec(true).experiment(), &|_, _, _| {}).ok_or("no run of a display")?;
                let one = Scored::judged(&case, &found);
                let own: Vec<(Gains, Validated)> = match DisplayModel::of(&found) {
                    Some(model) => {
                        let gain = |channel: &ChannelDiagnosis| {
                            let validated = Validated::of(channel.channel, &model, &case)?;
                            Some((Gains::of(channel, &model, &case, DAYS)?, validated))
                        };
                        found.channels.iter().filter_map(gain).collect()
                    }
                    None => Vec::new(),
                };
                let told: Vec<String> = own
                    .iter()
                    .map(|(g, v)| {
                        let all = [g.printed, g.interval.0, g.interval.1, g.truth, g.less_far, v.gain.part()];
                        let [printed, low, high, truth, less, part] = all.map(|part| 100.0 * part);
                        let sure = if v.is_close() { "close" } else { "not close" };
                        let runs = v.runs();
                        format!(
                            "gain {printed:.1} % ({low:.1} to {high:.1}) printed, {truth:.1} % true, {less:.1} % less far, \
                             {part:.1} % validated by {runs} runs, {sure}"
                        )
                    })
                    .collect();
                let not_clean = found.channels.iter().filter(|c| c.verdict != Verdict::Clean);
                let verdicts: Vec<String> =
                    not_clean.map(|c| format!("{} {}", c.channel.word(), c.verdict.word())).collect();
                println!("{} {} {}", one.line(), verdicts.join(", "), told.join("; "));
                gains.extend(own);
                scored.push(one);
            }
        }
    }
    let of = |outcomes: &[Outcome]| scored.iter().filter(|one| outcomes.contains(&one.outcome)).count();
    let visible: Vec<&Scored> = scored.iter().filter(|one| one.visible()).collect();
    let named = visible.iter().filter(|one| [Outcome::Exact, Outcome::InSet].contains(&one.outcome)).count();
    println!("named or in a set, of all: {}", bounded(of(&[Outcome::Exact, Outcome::InSet]), scored.len()));
    println!("named or in a set, of visible: {}", bounded(named, visible.len()));
    println!("wrong: {}", bounded(of(&[Outcome::Wrong]), scored.len()));
    let counted = |is: &dyn Fn(&Gains) -> bool| bounded(gains.iter().filter(|(g, _)| is(g)).count(), gains.len());
    println!("gain within {:.0} % of the true one: {}", 100.0 * RIGHT, counted(&Gains::is_right));
    println!("gain within {:.0} % of the error before: {}", 100.0 * RIGHT, counted(&Gains::is_near));
    println!("gain in its 95 % interval: {}", counted(&|g| g.interval.0 <= g.truth && g.truth <= g.interval.1));
    println!("printed larger than that: {}", counted(&|g| g.printed > g.truth + RIGHT));
    println!(
        "within {:.0} % of the error before, less far: {}",
        100.0 * RIGHT,
        counted(&|g| (g.printed - g.less_far).abs() <= RIGHT)
    );
    let validated = |is: &dyn Fn(&Gains, &Validated) -> bool, of: &dyn Fn(&Validated) -> bool| {
        let own: Vec<_> = gains.iter().filter(|(_, v)| of(v)).collect();
        bounded(own.iter().filter(|(g, v)| is(g, v)).count(), own.len())
    };
    let right = |g: &Gains, v: &Validated| is_right(v.gain.part(), g.truth);
    println!("validated gain within {:.0} % of the true one: {}", 100.0 * RIGHT, validated(&right, &|_| true));
    println!("the same where it is said to be close: {}", validated(&right, &Validated::is_close));
    let close = gains.iter().filter(|(_, v)| v.is_close()).count();
    println!("said to be close: {}", bounded(close, gains.len()));
    let mut runs: Vec<usize> = gains.iter().filter(|(_, v)| v.is_close()).map(|(_, v)| v.runs()).collect();
    runs.sort_unstable();
    println!("runs that it takes, by quarters: {:?}", [1, 2, 3].map(|q| runs.get(q * runs.len() / 4)));
    Ok(())
}

/// Kinds behind `--only`, `None` for all, and the other words.
fn only(mut words: Vec<String>) -> Result<(Option<Vec<&'static str>>, Vec<String>), String> {
    let Some(at) = words.iter().position(|word| word == "--only") else { return Ok((None, words)) };
    let value = words.get(at + 1).ok_or("--only needs a value")?;
    let all = || [Plan::Full, Plan::Finger].into_iter().flat_map(|plan| plan.hidden());
    let known = |own: &str| all().copied().find(|kind| *kind == own).ok_or(format!("--only {own}: no such kind"));
    let kinds = value.split(',').map(known).collect::<Result<Vec<_>, _>>()?;
    words.drain(at..=at + 1);
    Ok((Some(kinds), words))
}
