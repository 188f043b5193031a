//! Tables of relaxing foams at several rates.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use lut_gen::solid::contact::Ball;
use lut_gen::solid::law::PronyTerm;
use lut_gen::solid::model::{Resolution, Specimen};
use lut_gen::table::{ForceGrid, Form, GridSpec, LutError, foams, library, write};
use protocol::lut::{Table, axis_name};

fn grid(rate_mm_s: f64, height_mm: f64) -> ForceGrid {
    let spec = GridSpec {
        relaxation: vec![PronyTerm { g: 0.4, k: 0.4, tau_s: 0.5 }],
        rate_mm_s,
        mu_mpa: vec![0.1, 0.2],
        alpha: vec![2.0, 10.0],
        depth_mm: (1..=10).map(|i| 0.2 * f64::from(i)).collect(),
        resolution: Resolution::Refined(0.5),
        ..GridSpec::thesis(Specimen::of_height(height_mm), Ball { radius_mm: 4.0 })
    };
    ForceGrid::build(&spec, &|_, _| {}).unwrap()
}

#[test]
fn a_table_has_a_section_for_every_rate_and_a_library_for_each() {
    let grids = [grid(1.0, 12.7), grid(1.0, 19.05), grid(4.0, 12.7), grid(4.0, 19.05)];
    let mut entries = vec![];
    for grid in [&grids[0], &grids[2]] {
        entries.extend(library(&foams()[..2], &grid.spec).unwrap());
    }
    for (form, columns) in [(Form::Factored, 8), (Form::Expanded, 16)] {
        let bytes = write(&grids, form, entries.clone()).unwrap();
        let table = Table::parse(&bytes).unwrap();
        let names: Vec<&str> = table.axes().map(|a| a.name).collect();
        assert_eq!(names, [axis_name::DEPTH, axis_name::RATE, axis_name::HEIGHT, axis_name::ALPHA, axis_name::MU]);
        assert_eq!(table.columns(), columns);
        let width = columns / 4;
        let peak = |rate, height| table.row_force_n(9, table.slice(rate, height).start + width - 1);
        let stored = |grid: &ForceGrid| {
            let mu = if form == Form::Factored { 1.0 } else { 0.2 };
            (mu * grid.force_per_mpa[1][9]) as f32
        };
        for (i, grid) in grids.iter().enumerate() {
            // Rounding to counts.
            assert!((peak(i / 2, i % 2) / stored(grid) - 1.0).abs() < 1e-5);
        }
        // A relaxing foam is stiffer when pressed faster: by less than the whole relaxing part, 1 / (1 - 0.4).
        let stiffer = peak(1, 0) / peak(0, 0);
        assert!((1.02..1.6).contains(&stiffer), "{stiffer}");
        let rates: Vec<f32> = table.materials().map(|m| m.rate_mm_s).collect();
        assert_eq!(rates, [1.0, 1.0, 4.0, 4.0]);
        let material = table.material(2).unwrap();
        assert!(material.serves(4.0) && !material.serves(1.0) && material.serves(0.0));
    }
    let refusal = |grids: &[ForceGrid]| write(grids, Form::Factored, vec![]).unwrap_err();
    let [a, b, c, d] = grids;
    assert!(matches!(refusal(&[c.clone(), a.clone()]), LutError::Rates { rate_mm_s: 1.0, .. }));
    let odd = refusal(&[a.clone(), b, d]);
    assert!(odd.to_string().contains("4 mm/s and 19.05 mm is out of place"), "{odd}");
    let mut elastic = c;
    elastic.spec.relaxation.clear();
    assert!(matches!(refusal(&[a, elastic]), LutError::Mismatch { axis: "relaxation", .. }));
}
