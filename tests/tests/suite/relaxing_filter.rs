//! The filter of six hyper-viscoelastic parameters against finite elements that its surface has not seen.
//!
//! `tests/golden/liver-filter.sweep` and `liver-left-out.sweep` are what `palpate lut sweep` and `merge` make of the descriptions of the same names in
//! `bench/sweeps` (243 and 16 simulations, 5 minutes on one core).
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use firmware::kalman::relaxing::Relaxing;
use firmware::kalman::{Bounding, Estimator, Model, identify::identify};
use lut_gen::sweep::SweepTable;
use nalgebra::Vector6;
use tests::golden;

struct Surface {
    values: [[f32; 3]; 5],
    times_s: Vec<f32>,
    logarithms: Vec<f32>,
}

fn sweep(name: &str) -> SweepTable {
    SweepTable::parse(&std::fs::read(golden::path(name)).unwrap()).unwrap()
}

fn surface(table: &SweepTable) -> Surface {
    let motion = &table.spec.motion;
    let rate = motion.rates_mm_s[0];
    let ramp = motion.depths_mm.iter().map(|d| (d / rate) as f32);
    let holds = motion.holds_s.iter().map(|t| (motion.depth_mm() / rate + t) as f32);
    let values: Vec<[f32; 3]> = table
        .spec
        .axes
        .iter()
        .filter(|a| !a.factor)
        .map(|a| [a.values[0] as f32, a.values[1] as f32, a.values[2] as f32])
        .collect();
    let samples = motion.samples();
    let logarithms =
        (0..samples).flat_map(|t| table.points.iter().map(move |p| p.as_ref().unwrap()[0][t].ln() as f32)).collect();
    Surface { values: values.try_into().unwrap(), times_s: ramp.chain(holds).collect(), logarithms }
}

/// Parameters (alpha, D mu, g, k, tau) and force per MPa of the curves left out.
fn left_out() -> Vec<([f32; 5], Vec<f32>)> {
    let table = sweep("liver-left-out.sweep");
    let axes: Vec<_> = table.spec.axes.iter().filter(|a| !a.factor).collect();
    let curve = |(number, forces): (usize, &Option<Vec<Vec<f64>>>)| {
        let (mut rest, mut at) = (number, [0.0; 5]);
        for (slot, axis) in at.iter_mut().zip(&axes).rev() {
            *slot = axis.values[rest % axis.values.len()] as f32;
            rest /= axis.values.len();
        }
        (at, forces.as_ref().unwrap()[0].iter().map(|f| *f as f32).collect())
    };
    table.points.iter().enumerate().map(curve).collect()
}

const MU: f32 = 5.329e-4;

fn state(at: &[f32; 5]) -> Vector6<f32> {
    Vector6::new(MU, at[0], at[1] / MU, at[2], at[3], at[4])
}

#[test]
fn the_surface_follows_solves_left_out() {
    let numbers = surface(&sweep("liver-filter.sweep"));
    let model = Relaxing::new(&numbers.values, &numbers.times_s, &numbers.logarithms).unwrap();
    let (mut worst, mut squares, mut count) = (0.0_f32, 0.0, 0.0);
    for (at, curve) in left_out() {
        let peak = MU * curve.iter().fold(0.0_f32, |a, b| a.max(*b));
        let mut here = 0.0_f32;
        for (time_s, force) in numbers.times_s.iter().zip(&curve) {
            let off = (model.predict(&state(&at), *time_s).unwrap().value - MU * force).abs() / peak;
            here = here.max(off);
            squares += off * off;
            count += 1.0;
        }
        println!("{at:?}: {here:.1e} of the peak");
        worst = worst.max(here);
    }
    println!("worst {worst:.1e}, root mean square {:.1e}", (squares / count).sqrt());
    // Measured 1.1e-2 and 3.8e-3: three values of tau over a factor of four are what limits it.
    assert!(worst < 0.015, "{worst}");
}

#[test]
fn derivatives_are_those_of_the_surface() {
    let numbers = surface(&sweep("liver-filter.sweep"));
    let model = Relaxing::new(&numbers.values, &numbers.times_s, &numbers.logarithms).unwrap();
    for (at, _) in left_out() {
        let x = state(&at);
        for time_s in [0.37, 1.9, 3.99, 4.1, 7.7, 13.9] {
            let here = model.predict(&x, time_s).unwrap();
            for i in 0..6 {
                let h = 4e-3 * x[i];
                let mut moved = [x, x];
                moved[0][i] -= h;
                moved[1][i] += h;
                let [low, high] = moved.map(|x| model.predict(&x, time_s).unwrap().value);
                let difference = (high - low) / (2.0 * h);
                // f32 rounding of the difference, 1e-6 of the force over 8e-3 of the parameter, and its curvature.
                let scale = here.value / x[i];
                assert!(
                    (here.gradient[i] - difference).abs() < 2e-3 * scale,
                    "{i} at {time_s}: {} {difference}",
                    here.gradient[i]
                );
            }
        }
    }
}

/// What the filter makes of a press: estimate and standard errors, each over the truth.
fn identified(numbers: &Surface, model: &Relaxing<'_>, truth: &Vector6<f32>, forces: &[f32]) -> [(f32, f32); 6] {
    let region = model.region((1e-4, 2e-3));
    let peak = forces.iter().fold(0.0_f32, |a, b| a.max(*b));
    let samples = numbers.times_s.iter().copied().zip(forces.iter().copied());
    let mut estimator = Estimator::new(region.middle(), region, Bounding::Constrained { linearisations: 3 });
    let noise = 0.005 * peak;
    assert_eq!(identify(&mut estimator, model, samples, noise * noise, 4), 31);
    let (x, s) = (estimator.filter.state, estimator.filter.deviations());
    std::array::from_fn(|i| (x[i] / truth[i], s[i] / truth[i]))
}

/// From the middle of the region, with R of 0.5 % of the peak: on the surface's own curves, and on finite elements it has not seen. mu, alpha, g and tau are
/// found; a ball on nearly incompressible tissue does not show D and k, and the filter says so: their standard errors stay as wide as the region.
#[test]
fn six_parameters_from_a_ramp_and_hold() {
    let numbers = surface(&sweep("liver-filter.sweep"));
    let model = Relaxing::new(&numbers.values, &numbers.times_s, &numbers.logarithms).unwrap();
    for (at, curve) in left_out() {
        let truth = state(&at);
        let own: Vec<f32> = numbers.times_s.iter().map(|t| model.predict(&truth, *t).unwrap().value).collect();
        let solved: Vec<f32> = curve.iter().map(|f| MU * f).collect();
        // Measured within 0.2 % and, where the surface itself is off by up to 1.1 %, within 2.7 % (mu), 0.9 % (alpha), 0.4 % (g), 5.8 % (tau).
        for (forces, within) in [(own, [0.005; 4]), (solved, [0.035, 0.015, 0.007, 0.075])] {
            let found = identified(&numbers, &model, &truth, &forces);
            println!("{at:?}: {found:.3?}");
            for ((name, i), within) in [("mu", 0), ("alpha", 1), ("g", 3), ("tau", 5)].into_iter().zip(within) {
                assert!((found[i].0 - 1.0).abs() < within, "{at:?} {name}: {found:?}");
                assert!(found[i].1 < 0.06, "{at:?} {name}: {found:?}");
            }
            for i in [2, 4] {
                assert!(found[i].1 > 1.0, "{at:?}: {found:?}");
            }
        }
    }
}

#[test]
fn what_is_no_surface_is_refused_and_nothing_is_said_beyond_its_times() {
    let numbers = surface(&sweep("liver-filter.sweep"));
    let Surface { values, times_s, logarithms } = &numbers;
    assert!(Relaxing::new(values, times_s, &logarithms[1..]).is_none());
    assert!(Relaxing::new(values, &times_s[..1], &logarithms[..243]).is_none());
    for (axis, node, value) in [(0, 2, 1.0), (2, 2, 1.0), (1, 0, -1.0), (4, 1, f32::NAN)] {
        let mut odd = *values;
        odd[axis][node] = value;
        assert!(Relaxing::new(&odd, times_s, logarithms).is_none(), "{odd:?}");
    }
    let model = Relaxing::new(values, times_s, logarithms).unwrap();
    let x = state(&left_out()[0].0);
    for time_s in [0.1, 14.1, f32::NAN] {
        assert!(model.predict(&x, time_s).is_none(), "{time_s}");
    }
    for i in 0..6 {
        let mut odd = x;
        odd[i] = f32::NAN;
        assert!(model.predict(&odd, 2.0).is_none(), "{i}");
    }
    // Beyond its values a parameter changes nothing, but for mu.
    let mut beyond = x;
    beyond[3] = 0.99;
    assert_eq!(model.predict(&beyond, 2.0).unwrap().gradient[3], 0.0);
}
