#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
use super::*;
use crate::testbed::{Chance, expanded_table, factored_table, shape_mm2};

fn with_surface(bytes: &[u8], height_mm: f32, then: impl FnOnce(&Surface<'_>)) {
    let table = Table::parse(bytes).unwrap();
    let slice = Slice::nearest(&table, height_mm, 1.0).unwrap();
    then(&Surface::new(&table, &slice).unwrap());
}

#[test]
fn it_follows_the_curves_between_rows_and_columns_in_both_forms() {
    for bytes in [factored_table(), expanded_table(19.05)] {
        with_surface(&bytes, 19.05, |surface| {
            let mut chance = Chance(5);
            for _ in 0..2000 {
                let (mu, alpha, depth) = (0.001 + 0.3 * chance.even(), 1.0 + 23.0 * chance.even(), 4.0 * chance.even());
                let force = surface.at(mu as f32, alpha as f32, depth as f32).unwrap();
                let exact = |d: f64| mu * shape_mm2(alpha, 19.05, d);
                // The made-up family bends most at the low end of alpha, more than foams do: 2e-4 between 1 and 1.8.
                let off = (f64::from(force.force_n) - exact(depth)).abs() / exact(4.0);
                assert!(off < 3e-4, "{alpha} {depth}: {off}");
                assert!((f64::from(force.by_mu) - exact(depth) / mu).abs() < 3e-4 * exact(4.0) / mu);
            }
        });
    }
}

/// Central differences of the interpolant itself, in f32: their own error is about 1e-7 of the force over the step.
#[test]
fn derivatives_are_those_of_the_interpolant() {
    with_surface(&factored_table(), 12.7, |surface| {
        let mut chance = Chance(6);
        for _ in 0..500 {
            let (mu, alpha, depth) = (0.1, 1.1 + 22.8 * chance.even() as f32, 0.02 + 3.9 * chance.even() as f32);
            let at = |alpha, depth| surface.at(mu, alpha, depth).unwrap();
            let (f, step) = (at(alpha, depth), 4e-3);
            let by_alpha = (at(alpha + step, depth).force_n - at(alpha - step, depth).force_n) / (2.0 * step);
            let by_depth = (at(alpha, depth + step).force_n - at(alpha, depth - step).force_n) / (2.0 * step);
            let scale = at(alpha, 4.0).force_n;
            assert!((f.by_alpha - by_alpha).abs() < 2e-4 * scale, "{alpha} {depth}: {} {by_alpha}", f.by_alpha);
            // Pieces are 0.02 mm long and rounded to counts, so the slope itself changes by some thousandths over the step.
            assert!((f.by_depth - by_depth).abs() < 4e-3 * scale, "{alpha} {depth}: {} {by_depth}", f.by_depth);
        }
    });
}

#[test]
fn value_and_derivatives_are_continuous_across_nodes_and_at_the_surface() {
    with_surface(&factored_table(), 12.7, |surface| {
        let near = |a: Force, b: Force, scale: f32, what: &str| {
            for (x, y) in [(a.force_n, b.force_n), (a.by_alpha, b.by_alpha), (a.by_depth, b.by_depth)] {
                assert!((x - y).abs() < 2e-3 * scale, "{what}: {x} {y}");
            }
        };
        let scale = surface.at(0.1, 5.0, 4.0).unwrap().force_n;
        for i in 1..29 {
            let alpha = surface.alphas()[i];
            let (below, above) = (alpha * (1.0 - 1e-6), alpha * (1.0 + 1e-6));
            near(surface.at(0.1, below, 2.511).unwrap(), surface.at(0.1, above, 2.511).unwrap(), scale, "alpha");
        }
        for row in 0..200 {
            let depth = 0.02 * row as f32;
            near(
                surface.at(0.1, 7.3, depth - 1e-5).unwrap(),
                surface.at(0.1, 7.3, depth + 1e-5).unwrap(),
                scale,
                "depth",
            );
        }
        assert_eq!(surface.at(0.1, 7.3, 0.0), Some(Force::default()));
        assert_eq!(surface.at(0.1, 7.3, -1.0), Some(Force::default()));
    });
}

#[test]
fn nothing_is_said_outside_the_grid() {
    with_surface(&factored_table(), 12.7, |surface| {
        assert_eq!(surface.alpha_range(), (1.0, 24.0));
        assert!(surface.at(0.1, 1.0, 4.0).is_some() && surface.at(0.1, 24.0, 4.0).is_some());
        for (mu, alpha, depth) in [
            (0.1, 0.99, 1.0),
            (0.1, 24.1, 1.0),
            (0.1, 5.0, 4.01),
            (f32::NAN, 5.0, 1.0),
            (0.1, f32::NAN, 1.0),
            (0.1, 5.0, f32::NAN),
        ] {
            assert_eq!(surface.at(mu, alpha, depth), None, "{mu} {alpha} {depth}");
        }
    });
}

#[test]
fn the_curve_of_an_exponent_is_the_surface_and_goes_straight_on_beyond_it() {
    for bytes in [factored_table(), expanded_table(12.7)] {
        with_surface(&bytes, 12.7, |surface| {
            let mut chance = Chance(8);
            for _ in 0..500 {
                let (alpha, depth) = (1.0 + 23.0 * chance.even() as f32, 4.0 * chance.even() as f32);
                let (force, slope) = surface.curve(alpha).unwrap().at(depth);
                let whole = surface.at(1.0, alpha, depth).unwrap();
                // The same sums in another order.
                assert!((force - whole.force_n).abs() <= 1e-5 * whole.force_n, "{force} {whole:?}");
                assert!((slope - whole.by_depth).abs() <= 1e-4 * whole.by_depth.abs() + 1e-4, "{slope} {whole:?}");
            }
            let curve = surface.curve(7.0).unwrap();
            let (force, slope) = curve.at(4.0);
            let (beyond, same) = curve.at(4.2);
            assert!(slope > 0.0 && same == slope && (beyond - force - 0.2 * slope).abs() < 1e-5 * force);
            assert_eq!([curve.at(0.0), curve.at(-1.0), curve.at(f32::NAN)], [(0.0, 0.0); 3]);
            assert!(surface.curve(0.9).is_none() && surface.curve(f32::NAN).is_none());
        });
    }
}
