//! An extended model on the command line: every command that takes one says what is wrong with it, and where.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

const MODEL: &str =
    "material = \"foam\"\nlaw = \"hyperfoam\"\nmu_MPa = 0.1\nalpha = 8\n\n[[effect]]\ncode = \"relaxation\"\n";

const SPEC: &str = "[specimen.foam]\nheight_mm = 12.7\nmu_MPa = 0.1\nalpha = 8\n[indenter.r4]\nradius_mm = 4\n\
                    [[run]]\nspecimen = \"foam\"\nindenter = \"r4\"\nrate_mm_s = 1\ndepth_mm = 1\n";

const EXPERIMENT: &str = "[specimen.foam]\nbase_law = \"hyperfoam\"\nheight_mm = 12.7\nradius_mm = 25\n\
                          [indenter.r4]\nradius_mm = 4\n\
                          [[run]]\nfile = \"run.csv\"\nspecimen = \"foam\"\nindenter = \"r4\"\n";

fn run(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_palpate")).current_dir(folder).args(arguments).output().unwrap()
}

/// What is wrong, without the blanks and the frame that fold it for people.
fn refusal(folder: &Path, arguments: &[&str]) -> String {
    let output = run(folder, arguments);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {output:?}");
    assert!(output.stdout.is_empty(), "{output:?}");
    let text = String::from_utf8(output.stderr).unwrap();
    text.split(|c: char| c.is_whitespace() || "│×╰─▶".contains(c)).collect()
}

fn assert_says(said: &str, expected: &str) {
    let expected: String = expected.split_whitespace().collect();
    assert!(said.contains(&expected), "{said}\ndoes not say\n{expected}");
}

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("spec.toml", SPEC);
    write("experiment.toml", EXPERIMENT);
    let rows: Vec<String> = (0..60)
        .map(|i| format!("{},{},{}\n", 0.02 * f64::from(i), 0.02 * f64::from(i), 0.01 * f64::from(i).powf(1.5)))
        .collect();
    write("run.csv", &format!("time_s,depth_mm,force_N\n{}", rows.concat()));
    write("good.toml", &format!("{MODEL}g1 = 0.3\ntau1_s = 1.0\n"));
    write("bad.toml", &format!("{MODEL}g1 = 2.0\ntau1_s = 1.0\n"));
    folder
}

#[test]
fn every_command_names_the_mistake_of_a_model_file() {
    let folder = folder();
    let commands: [&[&str]; 5] = [
        &["identify", ".", "--json", "--model", "bad.toml"],
        &["gain", ".", "--json", "--model", "bad.toml"],
        &["lut", "--json", "--model", "bad.toml"],
        &["simulate", "spec.toml", "--out", "out", "--model", "bad.toml"],
        &["demo", "--json", "--model", "bad.toml"],
    ];
    for arguments in commands {
        let said = refusal(folder.path(), arguments);
        assert_says(&said, "bad.toml, line 8, column 6: `g1` is 2.0; expected a number from 0 to 0.9");
    }
    let missing = refusal(folder.path(), &["lut", "--model", "none.toml"]);
    assert_says(&missing, "none.toml: no such file");
}

#[test]
fn what_a_model_has_cannot_be_given_again() {
    let folder = folder();
    let said = refusal(folder.path(), &["lut", "--model", "good.toml", "--relax", "0.1,0.1,2"]);
    assert_says(&said, "relaxation is in the model and given by --relax; expected it in one of them");
    let said = refusal(folder.path(), &["identify", ".", "--model", "good.toml", "--terms", "2"]);
    assert_says(&said, "cannot be used with");
    let said = refusal(folder.path(), &["identify", ".", "--free-effects"]);
    assert_says(&said, "--model");
}

/// A display that answers later than its law, the model that says so, and its gain on runs of which each command comes three times.
#[test]
fn the_model_of_a_display_says_what_it_gains_and_how_sure_that_is() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    let spec = "test = \"display\"\nname = \"late\"\nseed = 3\n\
                [[run]]\nsubject = \"position\"\nvalues = [4.0, 10.0, 4.0]\nhold_s = 0.8\nreplicates = 3\n\
                [[run]]\nsubject = \"position\"\nvalues = [6.0, 8.0, 6.0]\nhold_s = 0.8\nreplicates = 3\n\
                [[effect]]\ncode = \"delay\"\ndelay_s = 0.06\n";
    write("spec.toml", spec);
    let base = "gain = 1\nzero_mm = 0\nspring_per_s2 = 86\ndamper_per_s = 23.4\n";
    let effect = "[[channel.position.effect]]\ncode = \"delay\"\nform = \"dead-time\"\ndelay_s = 0.06\n";
    write("model.toml", &format!("[channel.position]\n{base}[channel.position.alone]\n{base}{effect}"));
    write("short.toml", &format!("[channel.position]\n{base}{effect}"));
    assert!(run(folder.path(), &["simulate", "spec.toml", "--out", "made"]).status.success());
    let told = |model: &str| -> serde_json::Value {
        let done = run(folder.path(), &["gain", "made", "--model", model, "--json", "--report", "page"]);
        assert!(done.status.success(), "{done:?}");
        let whole: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
        let page = fs::read_to_string(folder.path().join(whole["report"].as_str().unwrap())).unwrap();
        assert!(page.contains("of the error is gone"), "{page}");
        whole["channels"][0].clone()
    };
    let own = told("model.toml");
    let number = |own: &serde_json::Value, key: &str| own[key].as_f64().unwrap();
    assert_eq!((&own["base"], &own["runs"], &own["more_runs"]), (&"as diagnosed".into(), &6.into(), &0.into()));
    let fall = 1.0 - number(&own, "rmse_mm_model") / number(&own, "rmse_mm_base");
    assert!((number(&own, "gain") - fall).abs() < 1e-12 && fall > 0.8, "{own}");
    let [low, high] = [0, 1].map(|end| own["gain_interval95"][end].as_f64().unwrap());
    assert!(low < fall && fall < high, "{own}");
    // a base that may bend itself to these runs errs less than the one that others told of
    let short = told("short.toml");
    assert_eq!(short["base"], "fitted to these runs");
    assert_eq!(short["rmse_mm_base"], short["rmse_mm_fitted_base"]);
    assert!(number(&short, "gain") < fall && number(&short, "rmse_mm_base") < number(&own, "rmse_mm_base"));
    let said = refusal(folder.path(), &["gain", "made", "--model", "model.toml", "--truth", "spec.toml"]);
    assert_says(&said, "--truth spec.toml: model.toml is not the model of a material");
}
