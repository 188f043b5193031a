//! Control curves as files: whatever is in them, they are read or refused with a reason.
#![allow(clippy::unwrap_used)]

use std::path::Path;

use palpate::control::{ControlCurve, CurveError, Row};
use proptest::prelude::*;
use tests::samples;

fn parse(text: &str) -> Result<ControlCurve, CurveError> {
    ControlCurve::parse(Path::new("curve.csv"), text)
}

/// Numbers of a cell: 0 to a size.
fn cell(most: f64) -> impl Strategy<Value = f64> {
    prop_oneof![Just(0.0), 0.0..=most]
}

prop_compose! {
    /// A row whose force is a step.
    fn row()(
        step_n in 1e-3..2.0_f64, travel_mm in cell(30.0), area_mm2 in cell(400.0), shaft_mm in cell(5.0),
        yield_kpa in cell(30.0), flux_t in cell(1.0), current_a in cell(2.5), loop_gain in -1e3..1e3_f64,
    ) -> Row {
        Row { force_n: step_n, travel_mm, area_mm2, shaft_mm, yield_kpa, flux_t, current_a, loop_gain }
    }
}

prop_compose! {
    fn curve()(
        mut rows in prop::collection::vec(row(), 2..40), ends in (0.0..=1.0_f64, 0.0..=1.0_f64), bound_a in cell(2.5),
        name in "[ -~]{0,20}[!-~]",
    ) -> ControlCurve {
        let mut force_n = -rows[0].force_n;
        for row in &mut rows {
            force_n += row.force_n;
            row.force_n = force_n;
        }
        let most_n = rows[rows.len() - 1].force_n;
        let reachable_n = (ends.0.min(ends.1) * most_n, ends.0.max(ends.1) * most_n);
        let name = name.trim().to_owned();
        ControlCurve {
            material: name.clone(), magnet: name.clone(), finger: name.clone(), fluid: name.clone(), bound_a, reachable_n,
            felt_error: None,
            provenance: name, rows,
        }
    }
}

proptest! {
    /// To the last bit.
    #[test]
    fn every_curve_is_read_back_as_it_was_written(curve in curve()) {
        prop_assert_eq!(parse(&curve.to_csv().unwrap()).unwrap(), curve);
    }

    /// What is read keeps the rules, so that the table's writer takes it.
    #[test]
    fn a_file_with_any_text_in_it_is_read_or_refused(
        at in 0.0..1.0_f64, cut in 0_usize..40,
        text in prop_oneof!["[0-9.,eE+# \n-]{0,12}", "\\PC{0,12}", Just("nan".to_owned()), Just("1e999".to_owned())],
    ) {
        let mut file = samples::control_curve("ICF").to_csv().unwrap();
        let from = (at * file.len() as f64) as usize;
        file.replace_range(from..(from + cut).min(file.len()), &text);
        match parse(&file) {
            Ok(curve) => {
                let forces: Vec<f64> = curve.rows.iter().map(|row| row.force_n).collect();
                prop_assert!(forces[0] == 0.0 && forces.windows(2).all(|pair| pair[0] < pair[1]));
                prop_assert!(curve.rows.iter().all(|row| (0.0..=2.5).contains(&row.current_a)));
                let (from, to) = curve.reachable_n;
                prop_assert!(0.0 <= from && from <= to && to <= curve.most_n());
            }
            Err(error) => prop_assert!(error.to_string().starts_with("curve.csv"), "{}", error),
        }
    }
}
