#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::BTreeMap;
use std::sync::LazyLock;

use palpate::diagnose::Models;
use palpate::simulate::Solver;

use super::*;

static SOLVER: LazyLock<Solver> = LazyLock::new(Solver::new);
static MODELS: LazyLock<Models> = LazyLock::new(Models::default);

fn yardstick() -> Yardstick<'static> {
    Yardstick { solver: &SOLVER, models: &MODELS }
}

/// The first seed of a kind of world that is one.
fn first(what: What) -> (World, Made) {
    (0..)
        .map(|seed| World { seed, design: Design::D18 })
        .filter(|world| world.what() == what)
        .find_map(|world| Some((world, world.make(&yardstick()).unwrap()?)))
        .unwrap()
}

#[test]
fn a_seed_says_it_all() {
    let (world, made) = first(What::Catalogue);
    let again = world.make(&yardstick()).unwrap().unwrap();
    assert_eq!((&made.spec, &made.truth), (&again.spec, &again.truth));
    assert_eq!(made.experiment.runs, again.experiment.runs);
    assert_eq!(made.spec.name, format!("laboratory D18-{}", world.seed));
}

/// Of 4,000 seeds the kinds come up as often as they should, within four standard deviations (31
/// each at most); every design does.
#[test]
fn worlds_are_of_all_kinds() {
    let mut kinds: BTreeMap<What, usize> = BTreeMap::new();
    let mut designs: BTreeMap<Design, usize> = BTreeMap::new();
    for seed in 0..4000 {
        let world = World::drawn(seed);
        *kinds.entry(world.what()).or_default() += 1;
        *designs.entry(world.design).or_default() += 1;
    }
    let expected = [(What::Clean, 400), (What::Catalogue, 2200), (What::Outside, 800), (What::Two, 600)];
    assert!(expected.iter().all(|(what, count)| kinds[what].abs_diff(*count) < 126), "{kinds:?}");
    assert!(DESIGNS.iter().all(|design| designs[design].abs_diff(1000) < 110), "{designs:?}");
}

/// What should dominate does, by fits of the noise-free forces with and without it, made once more
/// here; rests are as large as they say.
#[test]
fn what_dominates_has_its_share() {
    for what in [What::Catalogue, What::Outside, What::Two] {
        let (world, Made { spec, truth, .. }) = first(what);
        let base = rig::bare(&world);
        let bare = yardstick().made(&base).unwrap();
        let misfits = yardstick().misfits(&bare).unwrap().unwrap();
        let with = |effects: &[Effect]| {
            let spec = Spec { effects: effects.to_vec(), ..base.clone() };
            misfits.left(&misfits.shift(&yardstick().made(&spec).unwrap()))
        };
        let share = 1.0 - with(&spec.effects[truth.dominating.len()..]) / with(&spec.effects);
        assert!(share >= DOMINATES && (share - truth.share).abs() < 1e-9, "{share} {truth:?}");
        let scales = Scales::of(&base, &bare);
        let balance =
            balance::Balance { yardstick: &yardstick(), base: &base, bare: &bare, misfits: &misfits, scales: &scales };
        let rms = balance.rms(&truth.rests).unwrap();
        assert!((rms / truth.rests_rms - 1.0).abs() < 0.01 && (0.0029..0.021).contains(&rms), "{rms} {truth:?}");
        assert!(truth.minors.iter().all(|minor| Kind::of(minor) != truth.kind()), "{truth:?}");
    }
}

/// A clean world has rests and no effect, and without the size of its rests it is one without any.
#[test]
fn rests_of_no_size_are_none() {
    let (_, Made { spec, truth, experiment }) = first(What::Clean);
    assert!(truth.dominating.is_empty() && truth.minors.is_empty() && !truth.rests.is_empty());
    let plain = yardstick().made(&Spec { effects: Vec::new(), ..spec.clone() }).unwrap();
    assert_ne!(plain.runs, experiment.runs);
    let nothing = truth.rests.iter().map(|rest| Effect::Rest(Rest { amplitude: 0.0, ..*rest })).collect();
    let none = yardstick().made(&Spec { effects: nothing, ..spec }).unwrap();
    assert_eq!(plain.runs, none.runs);
}

/// An amount that grows and shrinks back is the same, and every code can be drawn.
#[test]
fn effects_grow_and_shrink() {
    let base = rig::bare(&World { seed: 1, design: Design::D36 });
    let bare = yardstick().made(&base).unwrap();
    let scales = Scales::of(&base, &bare);
    let mut chance = rig::chance(1, rig::Question::Effects);
    for code in catalogue().into_iter().chain(OUTSIDE) {
        for minor in [false, true] {
            let effect = ingredient::drawn(code, minor, &scales, &mut chance).unwrap();
            assert_eq!(effect.code(), code);
            let Some(half) = ingredient::scaled(&effect, 0.5, &scales) else {
                assert_eq!(effect, Effect::SlidingBase);
                continue;
            };
            assert_ne!(half, effect);
            let whole = ingredient::scaled(&half, 2.0, &scales).unwrap();
            for ((name, a), (_, b)) in whole.parameters().into_iter().zip(effect.parameters()) {
                match (a, b) {
                    (palpate::simulate::effect::Setting::Number(a), palpate::simulate::effect::Setting::Number(b)) => {
                        assert!((a - b).abs() <= 1e-9 * b.abs(), "{code} {name}: {a} {b}");
                    }
                    (a, b) => assert_eq!(a, b),
                }
            }
        }
    }
}
