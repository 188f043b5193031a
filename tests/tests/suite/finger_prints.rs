//! Prints of another solver's finger, read as an experiment: the moduli that a wrong finger lacks are found.

#![allow(clippy::unwrap_used)]

use std::path::{Path, PathBuf};

/// Force (N) and radius of the contact (mm) of the finger that NGSolve pressed on a plate; `None` where it is absent.
fn reference() -> Option<Vec<(f64, f64)>> {
    let file = tests::shared_or_skipped("reference/display/finger_F1_axi.csv")?;
    let text = std::fs::read_to_string(file).unwrap();
    let rows = text.lines().filter(|line| !line.starts_with('#')).skip(1);
    let numbers = |line: &str| line.split(',').map(|cell| cell.parse().unwrap()).collect::<Vec<f64>>();
    Some(rows.map(numbers).map(|row| (row[1], row[2])).collect())
}

fn experiment(folder: &Path, columns: &str, rows: &str) {
    std::fs::write(folder.join("prints.csv"), format!("{columns}\n{rows}")).unwrap();
    let text = "[[run]]\nfile = \"prints.csv\"\ntest = \"print\"\n";
    std::fs::write(folder.join("experiment.toml"), text).unwrap();
}

/// The round finger with all moduli divided.
fn softer(folder: &Path, by: f64) -> PathBuf {
    let text = palpate::finger::text_of("round").unwrap().1;
    let text = text.replace("mu_MPa = 0.08", &format!("mu_MPa = {}", 0.08 / by));
    let text = text.replace("mu_MPa = 0.012", &format!("mu_MPa = {}", 0.012 / by));
    let file = folder.join("softer.toml");
    std::fs::write(&file, text).unwrap();
    file
}

fn found(folder: &Path, finger: &Path, free: &str) -> palpate::finger::prints::Fit {
    use palpate::finger::prints::{Free, fit, of};
    let prints = of(&palpate::experiment::read(folder).unwrap()).unwrap();
    let free: Vec<Free> = Free::ALL.into_iter().filter(|own| free.contains(own.name())).collect();
    let text = std::fs::read_to_string(finger).unwrap();
    fit((finger, &text), &prints, &free, &|_| {}).unwrap()
}

#[test]
fn the_moduli_of_another_solvers_finger_lie_in_the_interval() {
    let Some(reference) = reference() else { return };
    let folder = tempfile::tempdir().unwrap();
    for (by, as_area) in [(2.0, false), (0.6, true)] {
        let row = |(n, a): &(f64, f64)| match as_area {
            true => format!("{n},{}\n", std::f64::consts::PI * a * a),
            false => format!("{n},{a},{a}\n"),
        };
        let columns = if as_area { "force_N,area_mm2" } else { "force_N,a_mm,b_mm" };
        experiment(folder.path(), columns, &reference.iter().map(row).collect::<String>());
        let finger = softer(folder.path(), by);
        let one = found(folder.path(), &finger, "stiffness");
        let (low, high) = one.fitted[0].interval;
        assert!(low < by && by < high && one.fitted[0].is_told, "{by}: {low} to {high}");
        // 0.1 mm of edge is 3 % of the mean radius and 6 % of the area; the force of one area goes with its power of 1.6
        assert!((one.fitted[0].factor / by - 1.0).abs() < 0.1, "{by}: {}", one.fitted[0].factor);
        // what was wrong shows, and what is left is where an edge is read: 0.03 mm by the other solver's word
        assert!(one.after_mm < 0.05 && one.before_mm > 10.0 * one.after_mm, "{} {}", one.before_mm, one.after_mm);
        let all = found(folder.path(), &finger, "stiffness size skin");
        // the skin beside a free size is never called told
        assert!(all.fitted[..2].iter().any(|own| own.is_told) && !all.fitted[2].is_told);
        for (own, truth) in all.fitted.iter().zip([by, 1.0]) {
            let (low, high) = own.interval;
            assert!(low < truth && truth < high, "{by}, {:?}: {low} to {high}", own.of);
        }
    }
}

#[test]
fn mistakes_in_prints_are_told_with_file_line_and_what_was_expected() {
    let folder = tempfile::tempdir().unwrap();
    let told = |columns: &str, rows: &str| -> String {
        experiment(folder.path(), columns, rows);
        let experiment = match palpate::experiment::read(folder.path()) {
            Ok(experiment) => experiment,
            Err(error) => return format!("{error:?}"),
        };
        match palpate::finger::prints::of(&experiment) {
            Err(error) => error.to_string(),
            Ok(prints) => {
                let text = palpate::finger::text_of("round").unwrap().1;
                let free = [palpate::finger::prints::Free::Stiffness];
                let fitted = palpate::finger::prints::fit((Path::new("round"), &text), &prints, &free, &|_| {});
                fitted.unwrap_err().to_string()
            }
        }
    };
    assert!(told("force_N,spot", "1,2\n").contains("no columns area_mm2, or a_mm and b_mm"), "no area");
    assert!(told("area_mm2,x", "1,2\n").contains("force_N"), "no force");
    assert!(
        told("force_N,area_mm2", "1,20\n2,-3\n").contains("line 3, column area_mm2: -3; expected a number above 0")
    );
    assert!(told("force_N,area_mm2,a_mm,b_mm", "1,20,3,3\n").contains("expected the area or the radii"));
    assert!(told("force_N,area_mm2", "1,20\n1.001,21\n").contains("2 prints at 1 different forces for 1 free numbers"));
}
