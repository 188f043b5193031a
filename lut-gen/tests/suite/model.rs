//! The continuous force model and the tables made from the same solves.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::sync::atomic::{AtomicUsize, Ordering};

use lut_gen::solid::contact::{Ball, Interface};
use lut_gen::solid::law::{Hyperfoam, Material, PronyTerm, Term};
use lut_gen::solid::model::{Axis, ForceModel, Indentation, ModelSpec, Resolution, Scale, Simulation, Specimen};
use lut_gen::solid::solve::Motion;
use lut_gen::table::{
    ForceGrid, Form, GridSpec, SecondTerm, UsedSpot, display_displacement_mm, foams, library, lut, write,
};
use protocol::lut::{Role, Table, axis_name};

const BALL: Ball = Ball { radius_mm: 4.0 };

/// A coarse mesh: these tests are about interpolation, not about the elements.
const COARSE: Resolution = Resolution::Refined(0.5);

fn spec() -> ModelSpec {
    ModelSpec { resolution: COARSE, ..ModelSpec::new(Specimen::of_height(12.7), BALL, 4.0) }
}

#[test]
fn model_reproduces_solves_within_its_bound() {
    let last = AtomicUsize::new(0);
    let model = ForceModel::build(&spec(), &|done, total| {
        assert!(done >= 1 && done <= total);
        last.fetch_max(done, Ordering::Relaxed);
    })
    .unwrap();
    assert_eq!((last.into_inner(), model.solves()), (16, 16));
    // ten nodes resolve the exponent to better than the coarse mesh resolves the ball
    assert!(model.error().interpolation < 0.002, "{:?}", model.error());
    assert!(model.error().discretisation > 0.0);
    let (mu, alpha) = (0.22, 13.37);
    let curve = Indentation {
        law: Hyperfoam::one_term(mu, alpha).unwrap(),
        specimen: Specimen::of_height(12.7),
        ball: BALL,
        depth_mm: 4.0,
        resolution: COARSE,
    }
    .solve()
    .unwrap();
    let peak = curve.force_n[199];
    for (d, f) in curve.depth_mm.iter().zip(&curve.force_n) {
        // an exponent the bound was not made from: twice the bound
        let miss = (model.force_n(mu, alpha, *d) - f).abs() / peak;
        assert!(miss <= 2.0 * model.error().interpolation, "{d} {miss}");
    }
    check_gradient(&model);
    // the order of parallel solves leaves no trace
    assert_eq!(model, ForceModel::build(&spec(), &|_, _| {}).unwrap());
}

/// Derivatives against central differences: truncation h^2 f''' and rounding 1e-16 / h,
/// both below 1e-6 of the force for h = 1e-4.
fn check_gradient(model: &ForceModel) {
    let h = 1e-4;
    for (alpha, d) in [(1.5, 0.02), (3.0, 0.7), (10.5, 2.2), (23.0, 3.9)] {
        let g = model.gradient(0.2, alpha, d);
        let quotient = |f: &dyn Fn(f64) -> f64| (f(h) - f(-h)) / (2.0 * h);
        let by_alpha = quotient(&|e| model.force_n(0.2, alpha + e, d));
        let by_depth = quotient(&|e| model.force_n(0.2, alpha, d + e));
        assert!((g.d_alpha - by_alpha).abs() < 1e-6 * g.force_n, "{alpha} {d}");
        assert!((g.d_depth - by_depth).abs() < 1e-4 * by_depth, "{alpha} {d} {} {by_depth}", g.d_depth);
        assert!((g.d_mu * 0.2 - g.force_n).abs() < 1e-12);
    }
    assert_eq!(model.force_n(0.2, 10.0, 0.0), 0.0);
    assert_eq!(model.force_n(0.2, 10.0, -1.0), 0.0);
    // C1 at the end of the range: the linear continuation meets value and slope
    let (end, over) = (model.gradient(0.2, 10.0, 4.0), model.gradient(0.2, 10.0, 4.0 + 1e-7));
    assert!((over.force_n - end.force_n - 1e-7 * end.d_depth).abs() < 1e-12);
}

#[test]
fn height_is_an_axis_when_wanted() {
    let spec = ModelSpec { alpha: (6.0, 12.0), alpha_nodes: 3, heights_mm: Some((8.0, 25.4, 3)), ..spec() };
    let model = ForceModel::build(&spec, &|_, _| {}).unwrap();
    // three nodes each way on a smooth function
    assert!(model.error().interpolation < 0.01, "{:?}", model.error());
    let at = |h: f64| model.gradient_at(0.1, 9.0, 3.0, h);
    assert!(at(8.0).force_n > at(12.0).force_n && at(12.0).force_n > at(25.0).force_n);
    let quotient = (at(12.001).force_n - at(11.999).force_n) / 0.002;
    assert!((at(12.0).d_height - quotient).abs() < 1e-6);
}

#[test]
fn chebyshev_interpolates_its_nodes() {
    for scale in [Scale::Linear, Scale::Log, Scale::Reciprocal] {
        let axis = Axis { low: 2.0, high: 9.0, nodes: 5, scale };
        let f = |v: f64| v.ln() * v;
        let c = axis.coefficients(&(0..5).map(|k| f(axis.node(k))).collect::<Vec<_>>());
        for k in 0..5 {
            let (x, _) = axis.local(axis.node(k));
            let sum: f64 = c.iter().enumerate().map(|(j, c)| c * (j as f64 * x.acos()).cos()).sum();
            assert!((sum - f(axis.node(k))).abs() < 1e-12);
        }
        assert!((axis.local(9.0).0.abs() - 1.0).abs() < 1e-12 && axis.local(10.0).1 == 0.0);
    }
}

#[test]
fn senseless_specs_are_refused_by_name() {
    let say = |s: ModelSpec| ForceModel::build(&s, &|_, _| {}).unwrap_err().to_string();
    assert_eq!(
        say(ModelSpec { alpha: (3.0, 2.0), ..spec() }),
        "alpha = 3 must be positive and below the upper end of its range"
    );
    assert_eq!(say(ModelSpec { alpha_nodes: 1, ..spec() }), "alpha_nodes = 1 must lie in 2..=24");
    let slopes = ModelSpec { alpha_nodes: 13, alpha_slopes: true, ..spec() };
    assert_eq!(say(slopes), "alpha_nodes = 13 must not exceed 12 with slopes");
    let grid = GridSpec { alpha: vec![4.0, 3.0], ..GridSpec::thesis(Specimen::of_height(12.7), BALL) };
    let text = ForceGrid::build(&grid, &|_, _| {}).unwrap_err().to_string();
    assert_eq!(text, "alpha = 3 must be a rising list of positive values");
}

fn small_spec(height: f64) -> GridSpec {
    let thesis = GridSpec::thesis(Specimen::of_height(height), BALL);
    GridSpec {
        alpha: vec![4.0, 10.0, 16.0],
        mu_mpa: vec![0.01, 0.1, 0.3],
        depth_mm: (1..=20).map(|i| 0.1 * f64::from(i)).collect(),
        resolution: COARSE,
        ..thesis
    }
}

fn small_grid(height: f64) -> ForceGrid {
    ForceGrid::build(&small_spec(height), &|_, _| {}).unwrap()
}

/// A grid of relaxing foams under a ball that rubs is still proportional to mu: one solve an
/// exponent, and every column is the force of a simulation of its own.
#[test]
fn a_grid_may_relax_and_rub() {
    let relaxation = vec![PronyTerm { g: 0.4, k: 0.2, tau_s: 0.5 }];
    let rough = GridSpec { friction: 0.2, relaxation: relaxation.clone(), rate_mm_s: 2.0, ..small_spec(12.7) };
    let grid = ForceGrid::build(&rough, &|_, _| {}).unwrap();
    assert_eq!(grid.solves, 6);
    let case = Simulation {
        material: Material::from(Hyperfoam::one_term(0.3, 10.0).unwrap()).relaxing(relaxation).unwrap(),
        specimen: Specimen::of_height(12.7),
        ball: BALL,
        interface: Interface { friction: 0.2, adhesion: None },
        motion: Motion::ramp(2.0, 2.0),
        resolution: COARSE,
    };
    let curve = case.curve(&rough.depth_mm).unwrap();
    for (per_mpa, force) in grid.force_per_mpa[1].iter().zip(&curve.force_n) {
        // to Newton's tolerance
        assert!((0.3 * per_mpa / force - 1.0).abs() < 1e-5);
    }
    let text = "hyperfoam N=1 nu=0, g 0.4 k 0.2 tau 0.5 s at 2 mm/s; ball R 4 mm, block W 25 h 12.7 mm, base bonded, friction 0.2";
    assert!(grid.provenance.contains(text), "{}", grid.provenance);
}

#[test]
fn thesis_grid_has_the_thesis_size() {
    let spec = GridSpec::thesis(Specimen::of_height(12.7), BALL);
    assert_eq!((spec.mu_mpa.len(), spec.alpha.len(), spec.depth_mm.len()), (30, 30, 200));
    assert_eq!((spec.mu_mpa[0], spec.alpha[29], spec.depth_mm[199]), (0.0005, 24.0, 4.0));
    assert!((spec.depth_mm[0] - 0.02).abs() < 1e-15);
}

#[test]
fn both_forms_read_back_what_was_solved() {
    let grids = [small_grid(12.7), small_grid(19.05)];
    let list = library(&foams()[..2], &grids[0].spec).unwrap();
    for form in [Form::Factored, Form::Expanded] {
        let bytes = write(&grids, form, list.clone()).unwrap();
        let table = Table::parse(&bytes).unwrap();
        let columns = if form == Form::Factored { 6 } else { 18 };
        assert_eq!((table.rows(), table.columns(), table.material_count()), (20, columns, 2));
        assert_eq!(table.factor().is_some(), form == Form::Factored);
        let bound = table.error_bound();
        assert!(bound.quantisation > 0.0 && bound.quantisation < 2e-5);
        assert!(f64::from(bound.discretisation) >= grids[0].error.discretisation as f32 as f64);
        assert!(table.provenance().starts_with("lut-gen "));
        for column in 0..columns {
            let alpha = f64::from(table.column_value(column, axis_name::ALPHA).unwrap());
            let height = f64::from(table.column_value(column, axis_name::HEIGHT).unwrap());
            let mu = if form == Form::Factored {
                1.0
            } else {
                f64::from(table.column_value(column, axis_name::MU).unwrap())
            };
            let grid = grids.iter().find(|g| (g.spec.specimen.height_mm - height).abs() < 1e-5).unwrap();
            let row = grid.spec.alpha.iter().position(|a| (a - alpha).abs() < 1e-5).unwrap();
            for (k, d) in grid.spec.depth_mm.iter().enumerate() {
                let read = f64::from(table.force_n(table.locate(*d as f32).unwrap(), column));
                let peak = mu * grid.force_per_mpa[row][19];
                // half a count, and f32 arithmetic of a few steps
                assert!((read - mu * grid.force_per_mpa[row][k]).abs() < 2e-5 * peak, "{form:?} {column} {d}");
            }
        }
    }
    let spec = lut(&grids[..1], Form::Expanded, vec![]).unwrap();
    assert!(spec.axes.iter().skip(1).all(|a| a.role == Role::Column));
    // One height is an axis as well: the board refuses specimens the table is not for.
    assert!(spec.axes[1].name == axis_name::HEIGHT && spec.axes[1].values == [12.7]);
}

#[test]
fn grids_that_do_not_fit_are_refused() {
    let (a, b) = (small_grid(12.7), small_grid(19.05));
    let say = |g: &[ForceGrid]| lut(g, Form::Factored, vec![]).unwrap_err().to_string();
    assert_eq!(say(&[]), "a table needs at least one grid");
    assert_eq!(say(&[b.clone(), a.clone()]), "grids must be sorted by height, but 12.7 mm follows 19.05 mm");
    let mut other = b;
    other.spec.mu_mpa[0] = 0.02;
    assert_eq!(say(&[a, other]), "grid of height 19.05 mm has another mu axis or ball than the first grid");
}

/// `P = 2 mu/alpha (1/l - l^(alpha - 1))` over a cap of 5 mm radius.
#[test]
fn display_curve_inverts_uniaxial_compression() {
    let (mu, alpha, h) = (0.22_f64, 10.53_f64, 12.7_f64);
    for l in [0.95_f64, 0.7, 0.3] {
        let force = 25.0 * std::f64::consts::PI * 2.0 * mu / alpha * (1.0 / l - l.powf(alpha - 1.0));
        let d = display_displacement_mm(mu, alpha, h, force).unwrap();
        // bisection of 60 halvings
        assert!((d - h * (1.0 - l)).abs() < 1e-9);
    }
    assert_eq!(display_displacement_mm(mu, alpha, h, -1.0).unwrap(), 0.0);
    assert!(display_displacement_mm(0.0, alpha, h, 1.0).is_err());
}

/// Thirty exponents from ten nodes: every curve within the stated bound of a solve of its own.
#[test]
fn a_grid_of_many_exponents_is_interpolated_within_its_bound() {
    let thesis = GridSpec::thesis(Specimen::of_height(12.7), BALL);
    let spec = GridSpec { resolution: COARSE, ..thesis };
    let grid = ForceGrid::build(&spec, &|_, _| {}).unwrap();
    assert_eq!((grid.solves, grid.force_per_mpa.len()), (16, 30));
    for i in [2, 8, 21] {
        let law = Hyperfoam::one_term(1.0, spec.alpha[i]).unwrap();
        let problem = Indentation { law, specimen: spec.specimen, ball: BALL, depth_mm: 4.0, resolution: COARSE };
        let curve = problem.solve_at(&spec.depth_mm).unwrap();
        let peak = curve.force_n[199];
        let worst = grid.force_per_mpa[i].iter().zip(&curve.force_n).map(|(a, b)| (a - b).abs() / peak);
        let worst = worst.fold(0.0, f64::max);
        println!("alpha {}: {worst:.1e}, stated {:.1e}", spec.alpha[i], grid.error.interpolation);
        assert!(
            worst < 2.0 * grid.error.interpolation && grid.error.interpolation < 2e-3,
            "alpha {}: {worst}",
            spec.alpha[i]
        );
    }
}

/// What a diagnosis may add to a law is in the columns of a grid: Poisson's ratio and a second term as in a simulation of its own, and on
/// a used spot the factor of the chain on the share of the energy.
#[test]
fn a_grid_may_be_of_an_extended_law() {
    let second = SecondTerm { mu_ratio: 0.3, alpha: 4.0 };
    let spec = GridSpec { nu: 0.2, second: Some(second), ..small_spec(12.7) };
    let grid = ForceGrid::build(&spec, &|_, _| {}).unwrap();
    let law = vec![Term { mu_mpa: 0.3, alpha: 10.0, nu: 0.2 }, Term { mu_mpa: 0.09, alpha: 4.0, nu: 0.2 }];
    let case = Simulation {
        material: Hyperfoam::new(law).unwrap().into(),
        specimen: Specimen::of_height(12.7),
        ball: BALL,
        interface: Interface::default(),
        motion: Motion::ramp(2.0, 1.0),
        resolution: COARSE,
    };
    let curve = case.curve(&spec.depth_mm).unwrap();
    for (per_mpa, force) in grid.force_per_mpa[1].iter().zip(&curve.force_n) {
        // to Newton's tolerance
        assert!((0.3 * per_mpa / force - 1.0).abs() < 1e-5);
    }
    assert!(grid.provenance.contains("hyperfoam N=2 nu=0.2 mu2/mu 0.3 alpha2 4;"), "{}", grid.provenance);
    let used = GridSpec { used: Some(UsedSpot { loss: 0.3, scale: 0.5 }), ..spec };
    let worn = ForceGrid::build(&used, &|_, _| {}).unwrap();
    let ratios: Vec<f64> = worn.force_per_mpa[1].iter().zip(&grid.force_per_mpa[1]).map(|(a, b)| a / b).collect();
    // hardly any energy at first, all of it at the end
    assert!((ratios[0] - (1.0 - 0.3 * libm::erf(2.0))).abs() < 1e-3, "{}", ratios[0]);
    assert!((ratios[19] - 1.0).abs() < 1e-12 && ratios.windows(2).all(|w| w[1] > w[0]), "{ratios:?}");
    let said = lut(
        &[grid, ForceGrid { spec: GridSpec { specimen: Specimen::of_height(19.05), ..used }, ..worn }],
        Form::Factored,
        vec![],
    );
    let text = "grid of height 19.05 mm has another law axis or ball than the first grid";
    assert_eq!(said.unwrap_err().to_string(), text);
}
