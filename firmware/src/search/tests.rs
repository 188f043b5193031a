#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
use super::*;
use crate::testbed::{Chance, LIBRARY, alphas, expanded_table, factored_table, mus, shape_mm2};

fn all_sums(search: &Search, slice: &Slice) -> Vec<f32> {
    let mut sums = vec![];
    search.each_line(slice, 0..usize::MAX, |number, line| {
        assert_eq!(number * slice.inner(), sums.len());
        sums.extend_from_slice(line);
    });
    sums
}

fn searched(table: &Table<'_>, slice: &Slice, force: impl Fn(f64) -> f64) -> Search {
    let mut search = Search::new();
    for i in 1..=50 {
        let depth = 0.08 * f64::from(i);
        search.step(table, slice, depth as f32, force(depth) as f32);
    }
    search
}

#[test]
fn a_column_of_the_grid_finds_itself_in_both_forms() {
    let (i, j, height) = (12, 20, 12.7);
    let force = |d: f64| mus()[j] * shape_mm2(alphas()[i], height, d);
    for bytes in [factored_table(), expanded_table(height)] {
        let table = Table::parse(&bytes).unwrap();
        let slice = Slice::nearest(&table, height as f32, 2.0).unwrap();
        assert_eq!(slice.len(), 900);
        let mut search = searched(&table, &slice, force);
        let found = search.found(&slice).unwrap();
        assert_eq!(found.index, i * 30 + j);
        let (mu, alpha) = slice.parameters(&table, found.index);
        assert!((f64::from(mu) - mus()[j]).abs() < 1e-6 && (f64::from(alpha) - alphas()[i]).abs() < 1e-5);
        // Interpolation between rows of 0.02 mm and rounding to 1/65535 of the peak.
        assert!(found.error_n < 1e-4 * force(4.0) as f32, "{}", found.error_n);
        assert_eq!(found.error_n, search.error_n(&slice));
        assert!(found.margin > 0.5 && !found.at_edge);
    }
}

#[test]
fn sums_are_equation_17_over_all_columns() {
    let bytes = factored_table();
    let table = Table::parse(&bytes).unwrap();
    let slice = Slice::nearest(&table, 19.05, 2.0).unwrap();
    let search = searched(&table, &slice, |d| LIBRARY[1].force_n(d));
    for (index, sum) in all_sums(&search, &slice).iter().enumerate().step_by(37) {
        let direct: f64 = (1..=50)
            .map(|k| 0.08 * f64::from(k))
            .map(|d| (mus()[index % 30] * shape_mm2(alphas()[index / 30], 19.05, d) - LIBRARY[1].force_n(d)).abs())
            .sum();
        // Quantisation of the table, 8e-6 of a column's peak a row, and f32 sums over 50 samples.
        let peak = mus()[index % 30] * shape_mm2(alphas()[index / 30], 19.05, 4.0);
        assert!((f64::from(*sum) - direct).abs() < 50.0 * 5e-5 * (peak + 5.0), "{index}: {sum} {direct}");
    }
}

/// Against the plain sum of every column in f64, over presses with noise, with forces below zero, far above every column and exactly on one.
#[test]
fn brackets_give_the_sums_of_every_column_and_the_same_column() {
    let bytes = factored_table();
    let table = Table::parse(&bytes).unwrap();
    let slice = Slice::nearest(&table, 12.7, 2.0).unwrap();
    let mus: Vec<f32> = table.factor().unwrap().values().collect();
    let mut chance = Chance(5);
    let mut same = 0;
    for trial in 0..200 {
        let (mu, alpha) = (0.6 * chance.even().powi(2), 0.5 + 25.0 * chance.even());
        let noise_n = [0.0, 0.005, 0.2][trial % 3];
        let mut search = Search::new();
        let (mut direct, mut total) = (vec![0f64; 900], 0.0);
        for i in 1..=100 {
            let depth = 0.04 * f64::from(i);
            let mut force = (mu * shape_mm2(alpha, 12.7, depth) + noise_n * chance.normal()) as f32;
            let position = table.locate(depth as f32).unwrap();
            if trial % 10 == 0 {
                force = mus[trial / 10] * table.forces_n(position, slice.columns()).nth(trial % 30).unwrap();
            }
            search.step(&table, &slice, depth as f32, force);
            if i % 7 == 0 {
                assert_eq!(search.error_n(&slice), search.found(&slice).unwrap().error_n);
            }
            for (row, f) in table.forces_n(position, slice.columns()).enumerate() {
                for (j, mu) in mus.iter().enumerate() {
                    direct[30 * row + j] += (f64::from(*mu) * f64::from(f) - f64::from(force)).abs();
                }
            }
            total += f64::from(force.abs());
        }
        let sums = all_sums(&search, &slice);
        for (sum, direct) in sums.iter().zip(&direct) {
            // A hundred f32 additions, each rounded by up to 6e-8 of the sum so far: of the differences and of the forces they are taken of.
            assert!((f64::from(*sum) - direct).abs() < 6e-6 * (direct + total), "{sum} {direct} {total}");
        }
        let found = search.found(&slice).unwrap();
        let (best, least) = direct.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1)).unwrap();
        assert!(direct[found.index] - least < 6e-6 * (least + total));
        same += usize::from(found.index == best);
        let (slow, fast) = (found.index / 30, found.index % 30);
        let other = |i: &usize| (i / 30).abs_diff(slow) > 1 || (i % 30).abs_diff(fast) > 1;
        let runner_up = (0..900).filter(other).map(|i| direct[i]).fold(f64::INFINITY, f64::min);
        assert!((f64::from(found.runner_up_error_n) * 100.0 - runner_up).abs() < 6e-6 * (runner_up + total));
    }
    // Columns closer than rounding would be a fault of the test's foams.
    assert_eq!(same, 200);
}

#[test]
fn forces_too_large_to_be_summed_find_nothing() {
    let bytes = factored_table();
    let table = Table::parse(&bytes).unwrap();
    let slice = Slice::nearest(&table, 12.7, 2.0).unwrap();
    let mut search = Search::new();
    for _ in 0..3 {
        search.step(&table, &slice, 1.0, f32::MAX);
    }
    assert_eq!((search.samples(), search.found(&slice), search.error_n(&slice).is_finite()), (3, None, false));
}

#[test]
fn runner_up_is_no_neighbour_and_the_edge_is_seen() {
    let bytes = factored_table();
    let table = Table::parse(&bytes).unwrap();
    let slice = Slice::nearest(&table, 25.0, 2.0).unwrap();
    assert!((slice.height_mm - 25.4).abs() < 1e-5);
    let search = searched(&table, &slice, |d| mus()[29] * shape_mm2(alphas()[0], 25.4, d));
    let found = search.found(&slice).unwrap();
    assert_eq!(found.index, 29);
    assert!(found.at_edge && found.runner_up_error_n > found.error_n);
}

#[test]
fn depths_outside_the_table_and_strange_forces_add_nothing() {
    let bytes = factored_table();
    let table = Table::parse(&bytes).unwrap();
    let slice = Slice::nearest(&table, 12.7, 2.0).unwrap();
    let mut search = Search::new();
    for (depth, force) in [(0.0, 1.0), (-1.0, 1.0), (4.5, 1.0), (f32::NAN, 1.0), (1.0, f32::NAN), (1.0, f32::INFINITY)]
    {
        search.step(&table, &slice, depth, force);
    }
    assert_eq!(search.samples(), 0);
    assert_eq!(search.found(&slice), None);
}
