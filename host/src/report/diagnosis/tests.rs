#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
//! Pages of diagnoses that were made by hand.

use lut_gen::chain::{Geometry, Model, Setting};
use lut_gen::effect;
use lut_gen::solid::model::Specimen as Block;
use nalgebra::{DMatrix, DVector};

use super::*;
use crate::diagnose::coordinate::{Candidate, Coordinate};
use crate::diagnose::design::{Branch, Design, Node, Series};
use crate::diagnose::evidence::Adequacy;
use crate::diagnose::fault::Fault;
use crate::diagnose::fit::Fit;
use crate::diagnose::held_out::HeldOut;
use crate::diagnose::jitter::Posterior;
use crate::diagnose::margin::{Margin, Variable};
use crate::diagnose::noise::{Curve, Jitter, Noise, SensorNoise, Source};
use crate::diagnose::plain::Plain;
use crate::diagnose::sets::{Belief, Judged, Weighed};
use crate::diagnose::{Evidence, Finding, Stand};
use crate::experiment::{Base, BaseLaw, Indenter, Length, Sensor, Specimen};
use crate::infer::evidence::Evidence as Weight;
use crate::infer::sets::{Outcome, Wider};

fn experiment() -> Experiment {
    let indenter = |name: &str, radius_mm| Indenter { name: name.to_owned(), radius_mm: Length::Known(radius_mm) };
    Experiment {
        name: "by <hand>".to_owned(),
        folder: std::path::PathBuf::new(),
        specimens: vec![Specimen {
            name: "eva".to_owned(),
            material: "eva".to_owned(),
            base_law: BaseLaw::Hyperfoam,
            terms: 1,
            height_mm: Length::Known(12.7),
            radius_mm: Length::Known(25.0),
            base: Base::Bonded,
        }],
        indenters: vec![indenter("r4", 4.0), indenter("r6", 6.0)],
        sensor: Sensor::default(),
        runs: Vec::new(),
    }
}

fn diagnosis(verdict: Verdict) -> Diagnosis {
    Diagnosis {
        material: "eva".to_owned(),
        verdict,
        findings: Vec::new(),
        shows_in: Vec::new(),
        blind_to: Vec::new(),
        proposals: Vec::new(),
        cancelling: Vec::new(),
        faults: Vec::new(),
        refusal: None,
        evidence: None,
        messages: Vec::new(),
        seconds: 1.0,
    }
}

fn finding(code: &'static str, ambiguous_with: Vec<&'static str>) -> Finding {
    Finding {
        code,
        form: "one-term",
        owner: 0,
        of: Vec::new(),
        parameters: vec![("g1", 0.2, (0.18, 0.22))],
        ambiguous_with,
        kind: effect::find(code, None).unwrap().kind,
        probability: 0.999,
        explains: Some(0.9),
    }
}

/// Entries of the hand-made data: two runs of a loading and a hold.
const NODES: usize = 9;

fn series(run: usize) -> Series {
    let node = |k: usize| {
        let held = k.saturating_sub(5) as f64;
        let depth_mm = 0.5 * k.min(5) as f64;
        Node {
            time_s: k as f64,
            length_s: 1.0,
            samples: 50,
            depth_mm,
            force_n: depth_mm.powf(1.5) * (1.0 - 0.05 * held),
            branch: if k > 5 { Branch::Hold } else { Branch::Loading },
            held_s: held,
            lifted: false,
        }
    };
    Series {
        run,
        specimen: 0,
        indenter: run,
        geometry: 0,
        rate: 0,
        cycle: 1,
        start_s: None,
        place_mm: None,
        spot: run,
        condition: run,
        group: run,
        hold_out: false,
        pressed_before_mm: 0.0,
        nodes: (0..NODES).map(node).collect(),
        path: Vec::new(),
        at: Vec::new(),
    }
}

fn fit(candidates: Vec<Candidate>, square: f64) -> Fit {
    let mut coordinates = vec![Coordinate::LnMu, Coordinate::LnAlpha];
    let mut model = Model::base(0.22, 10.5);
    for (at, candidate) in candidates.iter().enumerate() {
        coordinates.extend(candidate.effect.quantities.iter().map(|q| Coordinate::Of(at, *q)));
        let values = candidate.effect.quantities.iter().map(|q| q.plausible).collect();
        model.settings.push(Setting { effect: candidate.effect, owner: 0, values });
    }
    let values = [0.22, 10.5].into_iter().chain(model.settings.iter().flat_map(|s| s.values.iter().copied()));
    let x: Vec<f64> = coordinates.iter().zip(values).map(|(c, v)| c.of(v)).collect();
    let jacobian = DMatrix::from_fn(2 * NODES, x.len(), |i, j| if i == j { 50.0 } else { 0.0 });
    let residual = DVector::from_element(2 * NODES, (square / (2.0 * NODES as f64)).sqrt());
    let information = jacobian.tr_mul(&jacobian);
    Fit {
        candidates,
        reach: vec![1.96; coordinates.len()],
        coordinates,
        x: DVector::from_vec(x),
        model,
        square,
        discounted: square,
        price: 0.0,
        information,
        residual,
        jacobian,
        at_bound: false,
        settled: false,
        unseen: None,
    }
}

fn weighed(codes: &[&str], log: f64) -> Weighed {
    let of = |code: &&str| Candidate { effect: effect::find(code, None).unwrap(), owner: 0 };
    let fit = fit(codes.iter().map(of).collect(), 18.0);
    let (x, deviations) = (fit.x.as_slice().to_vec(), vec![0.1; fit.x.len()]);
    let evidence = Weight { log, alone: log - 1.0, sizes: vec![0.0, 0.012], x, deviations };
    Weighed { fit, known: DMatrix::zeros(2 * NODES, 0), evidence, log }
}

/// Relaxation for certain, creep of the sensor perhaps.
fn judged(outcome: Outcome) -> Judged {
    let belief = |name, probability, explains| Belief { name, probability, explains };
    Judged {
        outcome,
        findings: Vec::new(),
        beliefs: vec![
            belief("relaxation", 0.9991, Some(0.86)),
            belief("sensor-creep", 0.3, Some(-0.02)),
            belief("friction", 0.001, None),
        ],
        partly: Vec::new(),
        explains: Some(0.86),
        explained: Some(0.1),
        intervals: [(0.21, 0.23), (10.0, 11.0)].map(|(low, high): (f64, f64)| (low.ln(), high.ln())).to_vec(),
        nothing: 0.0,
        remainder: Some(0.012),
        shows_in: vec!["hold"],
        groups: vec![Some("depth"), Some("hold")],
        sets: vec![0.7, 0.2991, 0.0009],
        members: vec![vec!["relaxation"], vec!["relaxation", "sensor-creep"], vec!["sensor-creep"]],
        wider: Wider { outcome, findings: Vec::new(), is_same: true },
    }
}

fn stand(curves: Vec<Curve>) -> Stand {
    let parameters = [(0.22, (0.21, 0.23)), (10.5, (10.0, 11.0))];
    let plain = Plain { model: Model::base(0.22, 10.5), contacts_mm: vec![0.0; 2], rmse_n: 0.1 };
    Stand { plain, parameters, of_noise: parameters, unseen: None, curves }
}

fn evidence(held: Vec<Weighed>) -> Evidence {
    let curve = |s: &Series| Curve {
        force_n: s.nodes.iter().map(|n| n.depth_mm.powf(1.5)).collect(),
        slope_n_per_mm: s.nodes.iter().map(|n| 1.5 * n.depth_mm.sqrt()).collect(),
    };
    let block = Block { height_mm: 12.7, radius_mm: 25.0, base: lut_gen::solid::solve::Base::Bonded };
    let all = vec![series(0), series(1)];
    let curves: Vec<Curve> = all.iter().map(curve).collect();
    let margin = |variable, label: &str| Margin {
        variable,
        label: label.to_owned(),
        direction: DVector::zeros(2 * NODES),
        entries: vec![0],
    };
    let adequacy = Adequacy { readings: vec![-25.0, 1.0], threshold: 3.5, shows_in: vec![Variable::HoldTime] };
    let conditions = vec!["r4-v2.000".to_owned(), "r6-v2.000".to_owned()];
    Evidence {
        design: Design {
            material: "eva".to_owned(),
            series: all,
            checks: Vec::new(),
            geometries: vec![Geometry { specimen: block, ball_mm: 4.0, depth_mm: 3.0, nu: 0.0 }],
            rates_mm_per_s: vec![2.0],
            spots: 2,
            conditions: 2,
            groups: 2,
            zero_is_contact: true,
            zero_mm: 0.0,
            messages: Vec::new(),
        },
        noise: Noise {
            source: Source::Replicates,
            sensor: SensorNoise { sigma_n: 0.01, white: 0.5, correlation_s: 0.1, relative: 0.0 },
            jitter: Jitter { contact_mm: 0.02, gain: 0.01, zero_n: 0.0 },
            posterior: Posterior::stated(Jitter { contact_mm: 0.02, gain: 0.01, zero_n: 0.0 }, 4.0),
            sensor_freedom: 30.0,
        },
        base: fit(Vec::new(), 1018.0),
        contacts_mm: vec![0.01, -0.01],
        after: (!held.is_empty()).then(|| stand(curves.clone())),
        before: stand(curves),
        adequacy,
        margins: vec![margin(Variable::HoldTime, "hold, 0 to 25 %"), margin(Variable::Radius, "ball 1, 0 to 33 %")],
        ripple: None,
        left: (!held.is_empty()).then(|| Adequacy { readings: vec![0.4, -1.1], threshold: 3.5, shows_in: Vec::new() }),
        shown: Some(weighed(&["relaxation"], 0.0)),
        sets: vec![weighed(&["relaxation"], 0.0), weighed(&["relaxation", "sensor-creep"], -0.85), weighed(&[], -7.0)],
        judged: judged(Outcome::Named),
        held_out: (!held.is_empty()).then_some(HeldOut {
            rmse_before_n: 0.1,
            rmse_after_n: 0.02,
            peak_n: 2.0,
            deviance_before: 500.0,
            deviance_after: 20.0,
            conditions,
        }),
        held,
        solves: 12,
    }
}

#[test]
fn every_verdict_is_one_sentence_in_plain_words_with_its_code() {
    let mut list: Vec<(Diagnosis, &str)> = vec![(
        diagnosis(Verdict::Clean),
        "Nothing wrong is visible: the simulation explains eva to within the noise of these data (clean).",
    )];
    let mut one = diagnosis(Verdict::Named);
    one.findings = vec![finding("relaxation", Vec::new())];
    list.push((one, "The simulation of eva is wrong here, and the data say why: relaxation of the material (named)."));
    let mut two = diagnosis(Verdict::Named);
    two.findings = vec![finding("relaxation", Vec::new()), finding("compliance", Vec::new())];
    list.push((two, "The simulation of eva is wrong here, and the data say why: together relaxation of the material, with compliance of the machine (named)."));
    let mut set = diagnosis(Verdict::Ambiguous);
    set.findings = vec![finding("relaxation", vec!["sensor-creep", "lag"])];
    list.push((set, "The simulation of eva is wrong here, and these data leave more than one cause: relaxation of the material, creep or hysteresis of the force sensor or lag or a rate limit of the motion (ambiguous)."));
    let mut either = diagnosis(Verdict::Named);
    either.findings = vec![Finding { of: vec!["r4".to_owned(), "r9".to_owned()], ..finding("radius", Vec::new()) }];
    list.push((
        either,
        "The simulation of eva is wrong here, and the data say why: the radius of a ball (r4 or r9) (named).",
    ));
    let mut unknown = diagnosis(Verdict::Unknown);
    unknown.shows_in = vec!["hold time", "rate"];
    list.push((unknown, "The simulation of eva is wrong here, and no effect in the catalogue explains how; it shows in hold time and rate (unknown)."));
    let mut few = diagnosis(Verdict::TooFewData);
    few.refusal = Some(Refusal::NothingToFit("a.csv: no contact".to_owned()));
    list.push((few, "There are too few data on eva to say anything: no run can be used (too-few-data)."));
    let mut refused = diagnosis(Verdict::Refused);
    refused.refusal = Some(Refusal::Faulty("a.csv: a dead sensor".to_owned()));
    list.push((refused, "No diagnosis of eva is made: a.csv: a dead sensor (refused)."));
    for (found, told) in &list {
        assert_eq!(sentence(found), *told);
        assert!(meaning(found.verdict).starts_with(&format!("{}:", found.verdict.word())));
    }
}

#[test]
fn the_page_of_a_named_effect_has_every_section_in_order() {
    let mut found = diagnosis(Verdict::Ambiguous);
    found.findings = vec![finding("relaxation", vec!["sensor-creep"])];
    found.shows_in = vec!["hold time"];
    found.blind_to = vec!["poisson"];
    found.evidence = Some(Box::new(evidence(vec![weighed(&["relaxation"], 0.0), weighed(&["sensor-creep"], -1.0)])));
    found.cancelling = vec!["the gain of the sensor is part of mu"];
    let html = page(&experiment(), &[found]).html();
    let heads = [
        "Verdict",
        "Measured against simulated",
        "Before and after, on what no fit has seen",
        "Parameters",
        "What this could be confused with",
        "What this design cannot see",
        "Where the residual is",
        "Every effect",
        "What this could be wrong about",
    ];
    let places: Vec<usize> = heads.iter().map(|head| html.find(&format!("<h2>{head}</h2>")).expect(head)).collect();
    assert!(places.is_sorted(), "{places:?}");
    assert_eq!(html.matches("<svg").count(), html.matches("</svg>").count());
    assert!(!html.contains("NaN") && !html.contains("<script") && !html.contains("src="));
    assert!(html.contains("by &lt;hand&gt;"));
    // probability and share of each effect, what is beside the likeliest set, and what stays
    assert!(html.contains("<td>&gt; 99.9 %</td>") && html.contains("<td>86 %</td>"), "{html}");
    assert!(
        html.contains("<td>hold 1.2</td>")
            && html.contains("About 1.2 % of the force stays without a name, over hold.")
    );
    assert!(html.contains("By kind: memory of the specimen &gt; 99.9 %, sensor 30 %."));
    // the ball's name stands where the margin has its number; the reading is told though its bar is cut
    assert!(html.contains("r6, 0 to 33 %") && html.contains("-25.0"));
    assert!(html.contains("a hold on a stiff block") && html.contains("-80 %"));
    assert!(html.contains("<li>the gain of the sensor is part of mu</li>"));
}

#[test]
fn a_clean_page_shows_no_extension() {
    let mut found = diagnosis(Verdict::Clean);
    found.evidence = Some(Box::new(evidence(Vec::new())));
    let html = page(&experiment(), &[found]).html();
    assert!(html.contains("Nothing was added to the base.") && !html.contains("stays without a name"));
    assert!(!html.contains("stroke-dasharray=\"7 4\""), "a dashed curve is the extended model's");
}

#[test]
fn where_nothing_holds_the_noise_is_told_to_be_that_of_the_base() {
    const BASES: &str = "noise of these data, as the base sees it";
    let of = |held: Vec<Weighed>| {
        let mut found = diagnosis(Verdict::Unknown);
        found.evidence = Some(Box::new(evidence(held)));
        page(&experiment(), &[found]).html()
    };
    assert!(of(Vec::new()).contains(BASES));
    assert!(!of(vec![weighed(&["relaxation"], 0.0)]).contains(BASES));
}

#[test]
fn a_refusal_is_a_page_with_its_reason_and_what_to_measure() {
    let mut found = diagnosis(Verdict::Refused);
    found.refusal = Some(Refusal::NoNoise);
    found.faults = vec![Fault::Restarted { run: "b.csv".to_owned(), event: "stood at 1.2 mm and went on".to_owned() }];
    found.messages =
        vec!["b.csv: stood at 1.2 mm and went on".to_owned(), "c.csv: the ball never went down".to_owned()];
    let html = page(&experiment(), &[found]).html();
    assert!(html.contains("no two runs repeat a condition") && html.contains("What to measure instead"));
    assert!(html.contains("noise_N") && html.contains("(restart)") && html.contains("c.csv: the ball never went down"));
    assert_eq!(html.matches("stood at 1.2 mm").count(), 1, "a fault is told once");
    assert!(!html.contains("Every effect") && !html.contains("What this could be wrong about"));
}

#[test]
fn contact_points_that_the_base_has_moved_are_told() {
    let mut far = evidence(Vec::new());
    let told = "a contact point at 0.2 mm, 10 times the scatter between spots";
    for (contact_mm, expected) in [(0.2, true), (0.07, false)] {
        far.contacts_mm = vec![0.01, -contact_mm];
        let mut found = diagnosis(Verdict::Unknown);
        found.evidence = Some(Box::new(far));
        assert_eq!(page(&experiment(), std::slice::from_ref(&found)).html().contains(told), expected);
        far = *found.evidence.unwrap();
    }
}
