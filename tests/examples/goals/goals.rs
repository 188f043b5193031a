//! The goals, and what counts towards each.

use serde::{Deserialize, Serialize};
use tests::document;
use tests::hidden::What;
use tests::laboratory::score::{Mark, Scored as Judged};
use tests::laboratory::{Truth, What as Hidden};
use tests::score::Scored;
use tests::score::outcome::Outcome;
use tests::score::rate::{bounded, middle_and_worst};

/// What a case counts for; none where a goal is not about it.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Counted {
    /// A cause dominates and shows: named, or in a set of at most three.
    found: Option<bool>,
    /// A name that is wrong.
    wrong: bool,
    /// Nothing is hidden: something is named, or in ideal cases told at all.
    alarm: Option<bool>,
    /// Outside of the catalogue and visible: unknown, or of the right kind.
    outside: Option<bool>,
    /// Two effects, both visible: both found.
    two: Option<bool>,
    /// Whether the intervals of `mu` and of `alpha` hold the truth.
    held: Vec<(String, bool)>,
    /// Priors twice as wide would change the verdict or a name.
    rests_on_priors: bool,
    /// Time of the diagnosis, s; of designs with 36 runs.
    seconds: Option<f64>,
}

/// Of an ideal case.
pub fn of_ideal(s: &Scored) -> Counted {
    let what = &s.truth.what;
    let named = matches!(s.outcome, Outcome::Exact | Outcome::InSet);
    Counted {
        found: (matches!(what, What::Catalogue(..)) && s.any_visible()).then_some(named),
        wrong: s.outcome == Outcome::Wrong,
        alarm: (*what == What::Clean).then_some(s.outcome == Outcome::FalseAlarm),
        outside: (matches!(what, What::Outside(..)) && s.any_visible())
            .then_some(matches!(s.outcome, Outcome::OutsideUnknown | Outcome::OtherForm)),
        two: (matches!(what, What::Pair(..)) && s.all_visible()).then_some(s.outcome == Outcome::Both),
        held: s
            .hits
            .iter()
            .filter(|h| ["mu_MPa", "alpha"].contains(&h.name))
            .map(|h| (h.name.to_owned(), h.held))
            .collect(),
        rests_on_priors: s.answer.rests_on_priors,
        seconds: (s.design.name() == "D36").then_some(s.answer.seconds),
    }
}

/// Of a laboratory world.
pub fn of_world(s: &Judged) -> Counted {
    let of = |what: Hidden, right: &[Mark]| seen(&s.truth, what).then_some(right.contains(&s.mark));
    Counted {
        found: of(Hidden::Catalogue, &[Mark::Right, Mark::InSet]),
        wrong: s.mark == Mark::Wrong,
        alarm: (s.truth.what == Hidden::Clean).then_some(s.mark != Mark::Right),
        outside: of(Hidden::Outside, &[Mark::Unknown, Mark::RightKind]),
        two: of(Hidden::Two, &[Mark::Right, Mark::InSet]),
        held: s.hits.iter().map(|h| (h.name.to_owned(), h.held)).collect(),
        rests_on_priors: s.answer.rests_on_priors,
        seconds: (s.world.design.name() == "D36").then_some(s.answer.seconds),
    }
}

fn seen(truth: &Truth, what: Hidden) -> bool {
    truth.what == what && truth.visible()
}

/// The goals with what was measured, and whether each is met.
pub fn table(ideal: &[Counted], worlds: &[Counted]) -> String {
    let mut rows = Vec::new();
    type Goal = (&'static str, fn(&Counted) -> Option<bool>, std::ops::RangeInclusive<f64>);
    let goals: [Goal; 8] = [
        ("what dominates and shows is named or in a set of three, >= 85 %", |c| c.found, 0.85..=1.0),
        ("wrong names, <= 2 % of all cases", |c| Some(c.wrong), 0.0..=0.02),
        ("nothing hidden: false alarm (ideal) or name (laboratory), <= 5 %", |c| c.alarm, 0.0..=0.05),
        ("outside the catalogue and visible: unknown or right kind, >= 90 %", |c| c.outside, 0.9..=1.0),
        ("two effects, both visible: both found", |c| c.two, 0.0..=1.0),
        ("interval of mu holds, 92 to 97 % of all answers", |c| held(c, "mu_MPa"), 0.92..=0.97),
        ("interval of alpha holds, 92 to 97 % of all answers", |c| held(c, "alpha"), 0.92..=0.97),
        ("priors twice as wide change the verdict, <= 3 % of all", |c| Some(c.rests_on_priors), 0.0..=0.03),
    ];
    for (name, of, range) in goals {
        let cell = |list: &[Counted]| rate(list.iter().filter_map(of), &range);
        rows.push(vec![name.to_owned(), cell(ideal), cell(worlds)]);
    }
    rows.push(vec!["D36, two cases at a time: median s a diagnosis, worst".to_owned(), times(ideal), times(worlds)]);
    document::table(&["goal", "ideal cases", "laboratory worlds"], &rows)
}

fn held(counted: &Counted, name: &str) -> Option<bool> {
    counted.held.iter().find(|(own, _)| *own == name).map(|(_, held)| *held)
}

/// "12 of 15 (80 %, 55 to 93): MISSED".
fn rate(each: impl Iterator<Item = bool>, range: &std::ops::RangeInclusive<f64>) -> String {
    let (hits, cases) = each.fold((0, 0), |(hits, cases), hit| (hits + usize::from(hit), cases + 1));
    // a range of everything is no goal
    let met = match range.contains(&(hits as f64 / cases as f64)) {
        _ if cases == 0 || *range == (0.0..=1.0) => "",
        true => ": met",
        false => ": MISSED",
    };
    bounded(hits, cases) + met
}

fn times(list: &[Counted]) -> String {
    let found = middle_and_worst(list.iter().filter_map(|c| c.seconds));
    found.map_or_else(|| "none".to_owned(), |(middle, worst)| format!("{middle:.1}, {worst:.1}"))
}
