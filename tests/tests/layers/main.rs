//! What the sources may import, and that inference is written once.
#![allow(clippy::unwrap_used, clippy::panic)]

mod imports;

use std::fs;
use std::path::{Path, PathBuf};

use imports::Crate;

/// Every source file of the host below a folder, without its test modules: path from `host/src`, and text.
fn sources(below: &str) -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../host/src");
    let mut files = Vec::new();
    collect(&root.join(below), &mut files);
    assert!(!files.is_empty(), "{below}");
    let read = |file: PathBuf| {
        let text = fs::read_to_string(&file).unwrap();
        let name = file.strip_prefix(&root).unwrap().to_string_lossy().replace('\\', "/");
        // tests may compare with anything, and stand last
        let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
        (name, code.lines().filter(|line| !line.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n"))
    };
    files.into_iter().filter(|file| !file.ends_with("tests.rs")).map(read).collect()
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            collect(&path, files);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            files.push(path);
        }
    }
}

/// Code without white space, so that a line break hides nothing.
fn plain(code: &str) -> String {
    code.chars().filter(|c| !c.is_whitespace()).collect()
}

/// Modules of the crate that code names: what follows `crate::`, also in braces.
fn named(code: &str) -> Vec<String> {
    let code = plain(code);
    let mut all = Vec::new();
    for rest in code.split("crate::").skip(1) {
        let list = rest.strip_prefix('{').map_or(rest, |inner| inner);
        let several = list.len() < rest.len();
        let mut depth = 0_i32;
        let mut word = String::new();
        let mut fresh = true;
        for c in list.chars() {
            match c {
                '{' => depth += 1,
                '}' if depth == 0 => break,
                '}' => depth -= 1,
                ',' if depth == 0 && several => {
                    all.push(std::mem::take(&mut word));
                    fresh = true;
                }
                c if depth == 0 && fresh && (c.is_alphanumeric() || c == '_') => word.push(c),
                _ if depth == 0 && !several => break,
                _ if depth == 0 => fresh = false,
                _ => {}
            }
        }
        all.push(word);
    }
    all
}

#[test]
fn imports_are_found_in_all_their_forms() {
    let code = "use crate::{experiment::Run,\n identify::{self, Outcome}};\nlet x = crate::report::number(1.0);";
    assert_eq!(named(code), ["experiment", "identify", "report"]);
}

/// Inference knows no physics and none of its users; neither of the generator and the diagnosis knows the other, nor does what identifies know what diagnoses.
#[test]
fn layers_import_what_is_below_them_only() {
    let wrong = |below: &str, forbidden: &dyn Fn(&str) -> bool| -> Vec<String> {
        let of = |(file, code): &(String, String)| {
            named(code)
                .into_iter()
                .filter(|name| forbidden(name))
                .map(|name| format!("{file}: {name}"))
                .collect::<Vec<_>>()
        };
        sources(below).iter().flat_map(of).collect()
    };
    assert_eq!(wrong("infer", &|name| name != "infer"), [""; 0]);
    assert_eq!(wrong("diagnose", &|name| name == "simulate"), [""; 0]);
    assert_eq!(wrong("simulate", &|name| name == "diagnose"), [""; 0]);
    assert_eq!(wrong("identify", &|name| name == "diagnose"), [""; 0]);
    let physics =
        sources("infer").into_iter().filter(|(_, code)| code.contains("lut_gen") || code.contains("super::super"));
    assert_eq!(physics.map(|(file, _)| file).collect::<Vec<_>>(), [""; 0]);
    // what effects are called is nothing that inference asks
    let named = sources("infer").into_iter().filter(|(_, code)| code.contains(".code"));
    assert_eq!(named.map(|(file, _)| file).collect::<Vec<_>>(), [""; 0]);
    // a table and a display know nothing of each other, nor of the specimen
    let others = |own: &str, other: &'static [&'static str]| {
        let asks = move |code: &str| other.iter().any(|other| code.contains(other));
        sources(own).into_iter().filter(move |(_, code)| asks(code)).map(|(file, _)| file).collect::<Vec<_>>()
    };
    assert_eq!(others("diagnose/table", &["display::", "lut_gen", "compression::", "search::"]), [""; 0]);
    assert_eq!(others("diagnose/display", &["table::", "lut_gen", "compression::", "search::"]), [""; 0]);
    assert_eq!(others("diagnose/compression", &["table::", "display::"]), [""; 0]);
}

/// Finite elements know no physics, and a physics knows them and no other physics; numbers with a derivative and files
/// for ParaView are below all of them.
#[test]
fn every_physics_stands_on_the_finite_elements_alone() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("../lut-gen/src");
    let all = Crate::read(&source);
    assert_eq!(all.leaving("fem", &["scalar"]), [""; 0]);
    assert_eq!(all.leaving("solid", &["fem", "scalar", "vtk"]), [""; 0]);
    assert_eq!(all.leaving("magnet", &["fem", "vtk"]), [""; 0]);
    assert_eq!(all.leaving("pad", &["fem", "scalar"]), [""; 0]);
    // Nothing found at all would be a search that finds nothing.
    for physics in ["solid", "magnet", "pad"] {
        assert!(all.leaving(physics, &[]).iter().any(|place| place.contains(": fem::")), "{physics}");
    }
    let circles = Crate::read(&source.join("fem")).circles();
    assert!(circles.is_empty(), "{circles:?}");
}

/// Worlds that judge a diagnosis are drawn without a look at it; only their score sees its answers.
#[test]
fn laboratory_worlds_know_nothing_of_the_diagnosis() {
    let mut files = Vec::new();
    collect(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src/laboratory"), &mut files);
    let looks = |file: &PathBuf| fs::read_to_string(file).unwrap().contains("diagnose");
    let mut found: Vec<String> = files
        .iter()
        .filter(|file| looks(file))
        .map(|f| f.file_name().unwrap().to_string_lossy().into_owned())
        .collect();
    found.sort();
    // tests make the force models that misfits are measured with
    assert_eq!(found, ["score.rs", "tests.rs"]);
}

/// Marks of a step that is damped on the diagonal of normal equations, of the root of `I + Z Z'`, and of eigenvalues without an end.
#[test]
fn there_is_one_optimiser_of_sums_of_squares_and_one_low_rank_step() {
    let marks = ["(1.0+damping)", "(1.0+lambda)", ".sqrt())/x", "symmetric_eigen()", "SymmetricEigen::new("];
    let mut found = Vec::new();
    for (file, code) in sources("") {
        let code = plain(&code);
        found.extend(marks.iter().filter(|mark| code.contains(**mark)).map(|mark| format!("{file}: {mark}")));
    }
    found.retain(|place| !place.starts_with("infer/"));
    assert_eq!(found, [""; 0]);
    let kept: String = sources("infer").into_iter().map(|(_, code)| plain(&code)).collect();
    // the marks are those of what is there: a search for what nobody writes would find nothing
    assert!(kept.contains(marks[0]) && kept.contains(marks[2]));
}

#[test]
fn an_arrow_leads_to_the_file_that_defines_a_name() {
    let file = |module: &[&str], text: &str| (module.iter().map(ToString::to_string).collect(), text.to_owned());
    let circles = |texts: Vec<(Vec<String>, String)>| Crate::of(texts).circles();
    let face = || file(&[], "mod a; mod b; pub use a::One; pub fn run() { b::go(); }");
    let a = || file(&["a"], "pub struct One; #[cfg(test)] mod tests { use super::super::b::go; }");
    // What the face passes on is not its own, nor are names of tests arrows.
    assert_eq!(circles(vec![face(), a(), file(&["b"], "use crate::One; pub fn go() {}")]), [[""; 0]; 0]);
    assert_eq!(circles(vec![face(), a(), file(&["b"], "pub fn go() { crate::run() }")]), [["", "b"]]);
    let fem = || file(&["fem"], "pub struct One;");
    let other = file(&["solid", "law"], "use super::super::magnet::bh; use crate::fem::One;");
    let all = Crate::of(vec![face(), fem(), other, file(&["magnet", "bh"], "")]);
    assert_eq!(all.leaving("solid", &["fem"]), ["solid::law: magnet::bh"]);
    let b = file(&["b"], "use super::a; pub(in crate::a) fn go() -> a::One { a::One }");
    assert_eq!(circles(vec![face(), file(&["a"], "use crate::b; pub struct One;"), b]), [["a", "b"]]);
}

/// Two files may need each other; a longer circle has no ground floor to begin reading at.
#[test]
fn no_circle_of_imports_holds_more_than_two_files() {
    for folder in ["host/src", "lut-gen/src"] {
        let circles = Crate::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(folder)).circles();
        let longer: Vec<&Vec<String>> = circles.iter().filter(|circle| circle.len() > 2).collect();
        assert!(longer.is_empty(), "{folder}: {longer:?}");
        // Nothing found at all would be a search that finds nothing.
        assert!(!circles.is_empty(), "{folder}");
    }
}
