//! The chain's coupon against the homogeneous solve, which shares the law of a material point with it and nothing else.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use lut_gen::chain::{Model, Setting, Shortening, Sides};
use lut_gen::effect::{
    Effect, compliance, contact_offset, find, lag, poisson, relaxation, second_term, softening, thickness,
};
use lut_gen::solid::homogeneous::{Coupon, Programme};
use lut_gen::solid::law::{Hyperfoam, Material, OgdenRoxburgh, PronyTerm, Term};

const HEIGHT_MM: f64 = 12.7;
const AREA_MM2: f64 = 700.0;
const MU_MPA: f64 = 0.2;
const ALPHA: f64 = 10.0;

/// Down to half the height in three seconds, standing for two, and back to a fifth: at places as a diagnosis thins them.
fn run(sides: Sides) -> Shortening {
    let time_s: Vec<f64> = (0..=360).map(|k| 0.02 * f64::from(k)).collect();
    let way = |t: f64| (t / 3.0).min(1.0).min(1.0 - (t - 5.0) / 3.0).max(0.2 * f64::from(u8::from(t > 5.0)));
    let depth_mm = time_s.iter().map(|t| 0.5 * HEIGHT_MM * way(*t)).collect();
    Shortening {
        sides,
        height_mm: HEIGHT_MM,
        area_mm2: AREA_MM2,
        specimen: 1,
        nu: None,
        rubbing: None,
        time_s,
        depth_mm,
        start_s: 0.0,
        before_mm: 0.0,
    }
}

fn with(settings: &[(&'static Effect, usize, &[f64])]) -> Model {
    let mut model = Model::base(MU_MPA, ALPHA);
    model.settings =
        settings.iter().map(|(effect, owner, v)| Setting { effect, owner: *owner, values: v.to_vec() }).collect();
    model
}

fn foam(nu: f64, more: &[(f64, f64)]) -> Material {
    let terms = [(1.0, ALPHA)].iter().chain(more);
    Hyperfoam::new(terms.map(|(ratio, alpha)| Term { mu_mpa: ratio * MU_MPA, alpha: *alpha, nu }).collect())
        .unwrap()
        .into()
}

/// Largest miss of a model against a material, as a part of the largest force.
fn missed(sides: Sides, model: &Model, material: Material) -> f64 {
    let run = run(sides);
    let coupon = Coupon { material, mode: sides.mode(), area_mm2: AREA_MM2 };
    let stretch = run.depth_mm.iter().map(|d| 1.0 - d / HEIGHT_MM).collect();
    let exact = coupon.follow(&Programme { time_s: run.time_s.clone(), stretch }, &[]).unwrap().force_n(&coupon);
    let found = model.shortened(&run, 0.0);
    let peak = exact.iter().fold(0.0_f64, |m, f| m.max(-f));
    assert!(peak > 10.0, "{peak}");
    exact.iter().zip(&found).fold(0.0, |m, (a, b)| f64::max(m, ((-a).max(0.0) - b).abs() / peak))
}

const BOTH: [Sides; 2] = [Sides::Free, Sides::Held];

/// Elastic: one law, two ways to write it down. What is left is the rounding of a lateral stretch that is found by iteration.
#[test]
fn elastic_foams_are_the_closed_form() {
    for sides in BOTH {
        let model = with(&[(&poisson::EFFECT, 0, &[0.2]), (&second_term::EFFECT, 0, &[0.3, 3.0])]);
        assert!(missed(sides, &model, foam(0.2, &[(0.3, 3.0)])) < 1e-11);
        assert!(missed(sides, &with(&[]), foam(0.0, &[])) < 1e-11);
        // and it is no test that nothing could fail
        assert!(missed(sides, &with(&[]), foam(0.05, &[])) > 0.03);
    }
}

/// Memory: both convolve the same stress; the chain straight between its places of 0.3 % of stretch, the solve in steps as short.
#[test]
fn memory_is_that_of_a_material_point() {
    for sides in BOTH {
        let prony = [PronyTerm { g: 0.3, k: 0.3, tau_s: 0.7 }, PronyTerm { g: 0.2, k: 0.2, tau_s: 5.0 }];
        let material = foam(0.1, &[]).relaxing(prony.to_vec()).unwrap();
        let relaxing = with(&[(&poisson::EFFECT, 0, &[0.1]), (&relaxation::TWO, 0, &[0.3, 0.7, 0.2, 5.0])]);
        assert!(missed(sides, &relaxing, material.clone()) < 1e-4, "{}", missed(sides, &relaxing, material));
        let (r, m, beta) = softening::of_points(0.25, 0.7);
        let soft = foam(0.1, &[]).softening(OgdenRoxburgh::new(r, m * MU_MPA, beta).unwrap());
        let model = with(&[(&poisson::EFFECT, 0, &[0.1]), (&softening::EFFECT, 0, &[0.25, 0.7])]);
        assert!(missed(sides, &model, soft.clone()) < 1e-9, "{}", missed(sides, &model, soft));
        assert!(missed(sides, &model, foam(0.1, &[])) > 0.02);
    }
}

/// A coupon that was compressed before as far is as soft on the way down as it was on the way back.
#[test]
fn a_coupon_remembers_earlier_runs() {
    let model = with(&[(&softening::EFFECT, 0, &[0.25, 0.7])]);
    let (fresh, used) = (run(Sides::Held), Shortening { before_mm: 0.5 * HEIGHT_MM, ..run(Sides::Held) });
    let (a, b) = (model.shortened(&fresh, 0.0), model.shortened(&used, 0.0));
    let (down, back) = (75, 325);
    assert!((fresh.depth_mm[down] - fresh.depth_mm[back]).abs() < 1e-12);
    assert!((b[down] - a[back]).abs() < 1e-9 && a[down] > 1.02 * b[down], "{} {} {}", a[down], b[down], a[back]);
}

/// The machine's share of the depth: with compliance, the force is that of the depth less what it yields.
#[test]
fn a_machine_that_yields_takes_its_share() {
    for sides in BOTH {
        let (rigid, yielding) = (with(&[]), with(&[(&compliance::EFFECT, 0, &[0.05])]));
        let run = run(sides);
        let found = yielding.shortened(&run, 0.0);
        let taken = run.depth_mm.iter().zip(&found).map(|(d, f)| d - 0.05 * f).collect();
        let again = rigid.shortened(&Shortening { depth_mm: taken, ..run.clone() }, 0.0);
        // of forces of some 20 N
        let worst = found.iter().zip(&again).fold(0.0, |m, (a, b)| f64::max(m, (a - b).abs()));
        assert!(worst < 1e-7 && found[150] < 0.98 * rigid.shortened(&run, 0.0)[150], "{worst}");
    }
}

/// Offset, first touch and lag move the depth; an error of the height belongs to the specimen whose it is; ball and contact are not in it.
#[test]
fn everything_acts_where_it_belongs() {
    let run = run(Sides::Held);
    let base = with(&[]).shortened(&run, 0.0);
    let offset = with(&[(&contact_offset::EFFECT, 0, &[0.1])]);
    assert_eq!(offset.shortened(&run, 0.1), base);
    let lagging = with(&[(&lag::FILTER, 0, &[0.1])]).shortened(&run, 0.0);
    assert!(lagging[75] < base[75] && (lagging[249] / base[249] - 1.0).abs() < 1e-6);
    assert_eq!(with(&[(&thickness::HEIGHT, 0, &[1.0])]).shortened(&run, 0.0), base);
    assert!(with(&[(&thickness::HEIGHT, 1, &[1.0])]).shortened(&run, 0.0)[75] < base[75]);
    for (code, values) in [("friction", &[0.4][..]), ("adhesion", &[0.01]), ("radius", &[0.3]), ("numerics", &[0.1])] {
        assert_eq!(with(&[(find(code, None).unwrap(), 0, values)]).shortened(&run, 0.0), base, "{code}");
    }
}

/// Derivatives are smooth: halves of a difference quotient's step agree, for every parameter of the material.
#[test]
fn what_a_parameter_changes_is_proportional_to_its_change() {
    let of = |[mu, alpha, nu, ratio, g]: [f64; 5]| {
        let effects = with(&[
            (&poisson::EFFECT, 0, &[nu]),
            (&second_term::EFFECT, 0, &[ratio, 20.0]),
            (&relaxation::ONE, 0, &[g, 1.0]),
        ]);
        Model { mu_mpa: mu, alpha, ..effects }.shortened(&run(Sides::Free), 0.0)[150]
    };
    let at = [MU_MPA, ALPHA, 0.0, 0.1, 0.2];
    for k in 0..5 {
        let moved = |by: f64| {
            let mut x = at;
            x[k] += by;
            of(x)
        };
        let step = 1e-4;
        let (whole, half) = ((moved(step) - of(at)) / step, (moved(0.5 * step) - of(at)) / (0.5 * step));
        assert!(whole.abs() > 0.1 && (whole / half - 1.0).abs() < 0.01, "{k}: {whole} {half}");
    }
}
