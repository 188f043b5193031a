//! The chain with finite elements of whole paths against the generator of experiments, which shares neither mesh nor time steps with it.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use lut_gen::chain::{Chain, Model, Setting};
use lut_gen::effect::{self, Effect};
use palpate::diagnose::Models;
use palpate::diagnose::design::{Branch, Design};
use palpate::diagnose::fit;
use palpate::simulate::{self, Noise, Solver, Spec, simulate};
use tests::hidden;

/// Root mean square of what is missed on one branch, as a part of what the effects add there.
fn misses(effects: Vec<simulate::Effect>, settings: &[(&'static Effect, Vec<f64>)]) -> [Vec<(Branch, f64)>; 2] {
    let case = hidden::Case::new(hidden::Design::D36, 1).hiding(hidden::What::Clean);
    let mut spec: Spec = case.spec();
    spec.noise = Noise::default();
    spec.effects = effects;
    let truth = case.truth().foam;
    let made = simulate(&spec, &Solver::new(), &|_, _, _| {}).unwrap();
    let experiment = made.experiment();
    let design = Design::of(&experiment, &experiment.specimens[0].material).unwrap();
    let library = Models::default().of(&design.geometries, &|_, _| {}).unwrap();
    let chain = Chain { library, passages: design.passages() };
    let base = Model::base(truth.mu_mpa, truth.alpha);
    let mut model = base.clone();
    model.settings =
        settings.iter().map(|(effect, values)| Setting { effect, owner: 0, values: values.clone() }).collect();
    let contacts = vec![0.0; design.series.len()];
    let groups: Vec<usize> = design.series.iter().map(|s| s.group).collect();
    let start = std::time::Instant::now();
    let whole = chain.whole(&model, &contacts, &design.windows_s(), &groups).unwrap();
    println!("whole paths in {:.2} s", start.elapsed().as_secs_f64());
    let solved = Model { whole: Some(whole), ..model.clone() };
    let forces = |m: &Model| fit::predicted(&design, &chain, m, &contacts);
    let (bare, rough, exact) = (forces(&base), forces(&model), forces(&solved));
    [rough, exact].map(|predicted| {
        [Branch::Loading, Branch::Hold, Branch::Unloading]
            .into_iter()
            .map(|branch| {
                let (mut missed, mut added) = (0.0, 0.0);
                for (s, series) in design.series.iter().enumerate() {
                    for (k, node) in series.nodes.iter().enumerate().filter(|(_, n)| n.branch == branch && !n.lifted) {
                        missed += (node.force_n - predicted[s][k]).powi(2);
                        added += (predicted[s][k] - bare[s][k]).powi(2);
                    }
                }
                (branch, (missed / added).sqrt())
            })
            .collect()
    })
}

#[test]
fn relaxation() {
    for (g, tau_s) in [(0.2, 0.7), (0.4, 2.7)] {
        let [rough, exact] =
            misses(vec![simulate::Effect::Relaxation(vec![(g, tau_s)])], &[(&effect::relaxation::ONE, vec![g, tau_s])]);
        println!("g {g}, tau {tau_s}: chain {rough:.4?}, with whole paths {exact:.4?}");
    }
}

#[test]
fn second_term() {
    for (ratio, alpha) in [(0.3, 2.0), (0.3, 25.0)] {
        let hidden = simulate::Effect::SecondTerm { mu2_ratio: ratio, alpha2: alpha };
        let [rough, exact] = misses(vec![hidden], &[(&effect::second_term::EFFECT, vec![ratio, alpha])]);
        println!("ratio {ratio}, alpha {alpha}: chain {rough:.4?}, with whole paths {exact:.4?}");
    }
}
#[test]
fn lag() {
    let [rough, exact] = misses(vec![simulate::Effect::Lag { lag_s: 0.08 }], &[(&effect::lag::FILTER, vec![0.08])]);
    println!("lag: chain {rough:.4?}, with whole paths {exact:.4?}");
}
