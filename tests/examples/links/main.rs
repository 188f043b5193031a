//! Hidden effects of the display's links, what becomes of them when the proposed runs are made, and whether what naming them
//! gains is what is printed: `cargo run --release -p tests --example links -- --cases 2 --seed 97000`.
//!
//! Eighteen kinds, each at three sizes (half, once and twice what a full plan should see), `--cases` times. The printed gain is
//! the fall of the error over repeats that no fit has seen; the true one that over presses of a new session that no fit has seen.
//! `--only gap,creep` runs those kinds alone, with the seeds that they have among all; `--names` leaves gains out;
//! `--outside` hides what no catalogue has, where "unknown" is right.

use palpate::diagnose::Verdict;
use palpate::diagnose::display::{self, ChannelDiagnosis};
use palpate::extended::display::DisplayModel;
use tests::arguments::cases_and_seed;
use tests::display::{Case, Followed, Gains, LEVELS, MOST_COMMANDS, Outcome, Plan, RIGHT, Scored, Validated, is_right};
use tests::score::rate::bounded;

/// New sessions that the true gain is taken over.
const DAYS: u64 = 256;

/// A case with all that is judged.
struct One {
    scored: Scored,
    verdicts: String,
    followed: Option<Followed>,
    gains: Vec<(Gains, Validated)>,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut words: Vec<String> = std::env::args().skip(1).collect();
    let only = only(&mut words)?;
    let mut flag = |name: &str| words.iter().position(|word| word == name).map(|at| words.remove(at));
    let (names, outside) = (flag("--names"), flag("--outside"));
    let (count, first) = cases_and_seed(words.into_iter(), (2, 97_000))?;
    let hidden: fn(Plan) -> &'static [&'static str] = if outside.is_some() { Plan::outside } else { Plan::hidden };
    let kinds =
        [Plan::Full, Plan::Finger].into_iter().flat_map(|plan| hidden(plan).iter().map(move |kind| (plan, kind)));
    let mut all: Vec<One> = Vec::new();
    for (i, (plan, kind)) in kinds.enumerate() {
        if only.as_ref().is_some_and(|only| !only.contains(kind)) {
            continue;
        }
        for level in 1..LEVELS {
            for repeat in 0..count {
                let seed = first + (i * LEVELS * count + level * count + repeat) as u64;
                let one = One::of(&Case::clean(plan, seed).hiding(&[kind], level), names.is_none())?;
                println!("{}", one.line());
                all.push(one);
            }
        }
    }
    name_rates(&all);
    gain_rates(&all.into_iter().flat_map(|one| one.gains).collect::<Vec<_>>());
    Ok(())
}

/// Kinds behind `--only`, which is taken out; `None` for all.
fn only(words: &mut Vec<String>) -> Result<Option<Vec<&'static str>>, String> {
    let Some(at) = words.iter().position(|word| word == "--only") else { return Ok(None) };
    let value = words.get(at + 1).ok_or("--only needs a value")?;
    let all = || [Plan::Full, Plan::Finger].into_iter().flat_map(|plan| plan.hidden().iter().chain(plan.outside()));
    let known = |own: &str| all().copied().find(|kind| *kind == own).ok_or(format!("--only {own}: no such kind"));
    let kinds = value.split(',').map(known).collect::<Result<Vec<_>, _>>()?;
    words.drain(at..=at + 1);
    Ok(Some(kinds))
}

impl One {
    fn of(case: &Case, with_gains: bool) -> Result<Self, String> {
        let found = display::diagnose(&case.spec(true).experiment(), &|_, _, _| {}).ok_or("no run of a display")?;
        let scored = Scored::judged(case, &found);
        let gain = |model: &DisplayModel, channel: &ChannelDiagnosis| {
            let validated = Validated::of(channel.channel, model, case)?;
            Some((Gains::of(channel, model, case, DAYS)?, validated))
        };
        let gains = match DisplayModel::of(&found).filter(|_| with_gains) {
            Some(model) => found.channels.iter().filter_map(|channel| gain(&model, channel)).collect(),
            None => Vec::new(),
        };
        let not_clean = found.channels.iter().filter(|c| c.verdict != Verdict::Clean);
        let told = |c: &ChannelDiagnosis| {
            let order = if c.shows_in.contains(&"no order") { ", in no order" } else { "" };
            format!("{} {}{order}", c.channel.word(), c.verdict.word())
        };
        let verdicts: Vec<String> = not_clean.map(told).collect();
        let followed = Followed::of(case, &found, &scored);
        Ok(Self { verdicts: verdicts.join(", "), followed, scored, gains })
    }

    fn line(&self) -> String {
        let mut told = vec![format!("{} {}", self.scored.line(), self.verdicts)];
        for (g, v) in &self.gains {
            let all = [g.printed, g.interval.0, g.interval.1, g.truth, g.less_far, v.gain.part()];
            let [printed, low, high, truth, less, part] = all.map(|part| 100.0 * part);
            let sure = if v.is_close() { "close" } else { "not close" };
            let runs = v.runs();
            told.push(format!(
                "gain {printed:.1} % ({low:.1} to {high:.1}) printed, {truth:.1} % true, {less:.1} % less far, \
                 {part:.1} % validated by {runs} runs, {sure}"
            ));
        }
        if let Some(Followed { commands, scored }) = &self.followed {
            told.push(format!("after {}: {} {:?}", commands.join(" and "), scored.outcome.word(), scored.named));
        }
        told.join("; ")
    }

    /// The answer after the runs that were proposed.
    fn last(&self) -> &Scored {
        self.followed.as_ref().map_or(&self.scored, |followed| &followed.scored)
    }
}

fn name_rates(all: &[One]) {
    let rate = |of: &dyn Fn(&One) -> &Scored, outcomes: &[Outcome], visible: bool| {
        let own: Vec<&One> = all.iter().filter(|one| !visible || one.scored.visible()).collect();
        bounded(own.iter().filter(|one| outcomes.contains(&of(one).outcome)).count(), own.len())
    };
    const NAMED: &[Outcome] = &[Outcome::Exact, Outcome::InSet];
    println!("unknown: {}", rate(&|one| &one.scored, &[Outcome::Unknown], false));
    println!("named or in a set, of all: {}", rate(&|one| &one.scored, NAMED, false));
    println!("named or in a set, of visible: {}", rate(&|one| &one.scored, NAMED, true));
    println!("wrong: {}", rate(&|one| &one.scored, &[Outcome::Wrong], false));
    println!("the same after the runs that are proposed, {MOST_COMMANDS} commands at most:");
    println!("named or in a set, of all: {}", rate(&One::last, NAMED, false));
    println!("named or in a set, of visible: {}", rate(&One::last, NAMED, true));
    println!("its name alone, of all: {}", rate(&One::last, &[Outcome::Exact], false));
    println!("wrong: {}", rate(&One::last, &[Outcome::Wrong], false));
}

fn gain_rates(gains: &[(Gains, Validated)]) {
    let percent = 100.0 * RIGHT;
    let counted = |is: &dyn Fn(&Gains) -> bool| bounded(gains.iter().filter(|(g, _)| is(g)).count(), gains.len());
    println!("gain within {percent:.0} % of the true one: {}", counted(&Gains::is_right));
    println!("gain within {percent:.0} % of the error before: {}", counted(&Gains::is_near));
    println!("gain in its 95 % interval: {}", counted(&|g| g.interval.0 <= g.truth && g.truth <= g.interval.1));
    println!("printed larger than that: {}", counted(&|g| g.printed > g.truth + RIGHT));
    let is_near_less_far = |g: &Gains| (g.printed - g.less_far).abs() <= RIGHT;
    println!("within {percent:.0} % of the error before, less far: {}", counted(&is_near_less_far));
    let validated = |of: &dyn Fn(&Validated) -> bool| {
        let own: Vec<_> = gains.iter().filter(|(_, v)| of(v)).collect();
        bounded(own.iter().filter(|(g, v)| is_right(v.gain.part(), g.truth)).count(), own.len())
    };
    println!("validated gain within {percent:.0} % of the true one: {}", validated(&|_| true));
    println!("the same where it is said to be close: {}", validated(&Validated::is_close));
    let close = gains.iter().filter(|(_, v)| v.is_close()).count();
    println!("said to be close: {}", bounded(close, gains.len()));
    let mut runs: Vec<usize> = gains.iter().filter(|(_, v)| v.is_close()).map(|(_, v)| v.runs()).collect();
    runs.sort_unstable();
    println!("runs that it takes, by quarters: {:?}", [1, 2, 3].map(|q| runs.get(q * runs.len() / 4)));
}
