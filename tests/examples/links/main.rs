//! Hidden effects of the display's links, and whether what naming them gains is what is printed:
//! `cargo run --release -p tests --example links -- --cases 2 --seed 97000`.
//!
//! Twelve kinds, each at three sizes (half, once and twice what a full plan should see), `--cases` times. The printed gain is
//! the fall of the error over repeats that no fit has seen; the true one that over presses of a new session that no fit has seen.

use palpate::diagnose::display::channel::Channel;
use palpate::diagnose::display::design::{Design, Explained};
use palpate::diagnose::display::fit::Problem;
use palpate::diagnose::display::law::Law;
use palpate::diagnose::display::whiten::Whitening;
use palpate::diagnose::display::{self, ChannelDiagnosis};
use palpate::experiment::Experiment;
use palpate::extended::display::DisplayModel;
use tests::arguments::cases_and_seed;
use tests::display::{Case, HIDDEN, LEVELS, Outcome, Plan, Scored};
use tests::score::rate::bounded;

/// A printed gain is right within this part of the true one.
const RIGHT: f64 = 0.1;
/// New sessions that the true gain is taken over: gains scatter from run to run.
const DAYS: u64 = 4;
/// Heights of their presses over those of the diagnosed ones.
const LESS: f64 = 0.93;

/// Gain, as the part of the error that is gone: printed, and true.
struct Gains {
    printed: f64,
    truth: f64,
}

impl Gains {
    /// Within a tenth of the error that was there before: ten points of the gain.
    fn is_near(&self) -> bool {
        (self.printed - self.truth).abs() <= RIGHT
    }

    fn is_right(&self) -> bool {
        (self.printed - self.truth).abs() <= RIGHT * self.truth.abs()
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (count, first) = cases_and_seed(std::env::args().skip(1), (2, 97_000))?;
    let (mut scored, mut gains): (Vec<Scored>, Vec<Gains>) = (Vec::new(), Vec::new());
    for (i, kind) in HIDDEN.iter().enumerate() {
        for level in 1..LEVELS {
            for repeat in 0..count {
                let seed = first + (i * LEVELS * count + level * count + repeat) as u64;
                let case = Case::clean(Plan::Full, seed).hiding(&[kind], level);
                let found =
                    display::diagnose(&case.spec(true).experiment(), &|_, _, _| {}).ok_or("no run of a display")?;
                let one = Scored::judged(&case, &found);
                let own: Vec<Gains> = match DisplayModel::of(&found) {
                    Some(model) => {
                        let gain = |channel: &ChannelDiagnosis| gains_of(channel, &model, &case);
                        found.channels.iter().filter_map(gain).collect()
                    }
                    None => Vec::new(),
                };
                let told: Vec<String> = own
                    .iter()
                    .map(|g| format!("gain {:.0} % printed, {:.0} % true", 100.0 * g.printed, 100.0 * g.truth))
                    .collect();
                println!("{} {}", one.line(), told.join("; "));
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
    println!(
        "gain within {:.0} % of the true one: {}",
        100.0 * RIGHT,
        bounded(gains.iter().filter(|g| g.is_right()).count(), gains.len())
    );
    println!(
        "gain within {:.0} % of the error before: {}",
        100.0 * RIGHT,
        bounded(gains.iter().filter(|g| g.is_near()).count(), gains.len())
    );
    let larger = gains.iter().filter(|g| g.printed > g.truth + RIGHT).count();
    println!("printed larger than that: {}", bounded(larger, gains.len()));
    Ok(())
}

/// The same display on another day: the same kinds of presses, a little less far, with new noise and new gains of every run.
fn fresh(case: &Case, day: u64, of: Channel) -> Experiment {
    let mut spec = case.spec(true);
    // a diagnosis explains the current that the flux is compared at; here it is read without noise instead
    if of == Channel::Flux {
        spec.noise.current_a = 0.0;
    }
    spec.seed = case.seed + (day + 1) * 1_000_000;
    for run in &mut spec.runs {
        run.values.iter_mut().for_each(|value| *value *= LESS);
    }
    spec.experiment()
}

/// Of a channel of which something is named.
fn gains_of(channel: &ChannelDiagnosis, model: &DisplayModel, case: &Case) -> Option<Gains> {
    let evidence = channel.evidence.as_deref()?;
    let (before, after) = evidence.held_out.as_ref()?.gain();
    let own = model.channels.iter().find(|own| own.channel == channel.channel)?;
    let square = |law: &Law| -> Option<f64> {
        let each = (0..DAYS).map(|day| {
            let design = Design::of(&fresh(case, day, channel.channel), channel.channel, &Explained::new()).ok()?;
            let used = vec![true; design.series.len()];
            let problem = Problem { design: &design, whitening: Whitening::none(design.samples()), used };
            Some(problem.plain(law).norm_squared())
        });
        each.sum()
    };
    let truth = 1.0 - (square(&own.law())? / square(&evidence.base.fit.law)?).sqrt();
    Some(Gains { printed: 1.0 - after / before, truth })
}
