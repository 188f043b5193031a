//! Forces of the default solver against curves of independent codes in `../shared/reference`.
//!
//! Every curve there is frictionless. At 1, 2, 3 and 4 mm the force must lie within
//! 0.5 % (the product's promise) plus the uncertainty the curve's own header states.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::path::{Path, PathBuf};

use lut_gen::contact::Ball;
use lut_gen::law::{Hyperfoam, Term};
use lut_gen::model::{Indentation, Resolution, Specimen};
use lut_gen::solve::Base;

/// The promised accuracy, percent.
const PROMISE: f64 = 0.5;
/// Depths compared, mm.
const DEPTHS: [f64; 4] = [1.0, 2.0, 3.0, 4.0];

struct Reference {
    name: String,
    problem: Indentation,
    /// Uncertainty the header states, percent.
    uncertainty: f64,
    rows: Vec<(f64, f64)>,
}

fn folder() -> PathBuf {
    std::env::var_os("PALPATE_SHARED")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared"), PathBuf::from)
        .join("reference")
}

/// Value after `key=` (up to a blank or a comma) in the header.
fn value<'a>(header: &'a str, key: &str) -> Option<&'a str> {
    header
        .split([' ', ',', ';', '\n'])
        .filter_map(|word| word.split_once('='))
        .find(|(name, _)| *name == key)
        .map(|(_, v)| v)
}

fn number(header: &str, key: &str) -> Option<f64> {
    value(header, key).and_then(|v| v.parse().ok())
}

/// Terms of either header form: `mu=.. alpha=.. nu=..` or `terms (..) = [[mu, alpha, nu], ..]`.
fn terms(header: &str) -> Vec<Term> {
    if let Some(at) = header.find("[[") {
        let list = &header[at + 2..at + header[at..].find("]]").unwrap()];
        return list
            .split("],")
            .map(|t| {
                let v: Vec<f64> = t.trim_matches([' ', '[']).split(',').map(|x| x.trim().parse().unwrap()).collect();
                Term { mu_mpa: v[0], alpha: v[1], nu: v[2] }
            })
            .collect();
    }
    let nu = number(header, "nu").unwrap_or(0.0);
    let first = Term { mu_mpa: number(header, "mu").unwrap(), alpha: number(header, "alpha").unwrap(), nu };
    let second = number(header, "mu2").map(|mu_mpa| Term { mu_mpa, alpha: number(header, "alpha2").unwrap(), nu });
    std::iter::once(first).chain(second).collect()
}

/// The stated uncertainty, or for CalculiX the spread of its meshes: the range of the
/// meshes that reached each depth, relative to the lowest, worst over 1..4 mm.
/// Where only one mesh got through (ICF), the larger of the uncertainties that the
/// headers of the other two state from 0.5 mm on (EVA: 0.23 %), rounded up, stands in.
fn uncertainty(header: &str) -> f64 {
    let Some(at) = header.find("mesh C:") else {
        let text = &header[header.find("uncertainty").unwrap()..];
        let percent = text[text.find("on: ").unwrap() + 4..].split('%').next().unwrap();
        return percent.trim().parse().unwrap();
    };
    let meshes: Vec<Vec<f64>> = header[at..]
        .lines()
        .filter(|l| l.contains("ended ok"))
        .map(|l| {
            let list = l.rsplit("mm) = ").next().unwrap().trim_end_matches(" N");
            list.split_whitespace().map(|x| x.parse().unwrap()).collect()
        })
        .collect();
    if meshes.len() < 2 {
        return 0.25;
    }
    (0..DEPTHS.len())
        .map(|k| {
            let all = meshes.iter().map(|m| m[k]);
            let (low, high) = (all.clone().fold(f64::INFINITY, f64::min), all.fold(0.0, f64::max));
            100.0 * (high - low) / low
        })
        .fold(0.0, f64::max)
}

fn read(path: &Path) -> Reference {
    let text = std::fs::read_to_string(path).unwrap();
    let header: String = text.lines().filter_map(|l| l.strip_prefix('#')).map(|l| format!("{l}\n")).collect();
    let rows = text.lines().filter(|l| !l.starts_with('#')).filter_map(|l| {
        let (d, f) = l.split_once(',')?;
        Some((d.parse().ok()?, f.parse().ok()?))
    });
    let height = number(&header, "h").or_else(|| number(&header, "height_mm")).unwrap();
    let ball = number(&header, "R").or_else(|| {
        let at = header.find("indenter_R_mm:")?;
        header[at..].split_whitespace().nth(1)?.parse().ok()
    });
    let sliding = number(&header, "sliding") == Some(1.0) || value(&header, "base") == Some("roller");
    Reference {
        name: path.file_stem().unwrap().to_string_lossy().into_owned(),
        problem: Indentation {
            law: Hyperfoam::new(terms(&header)).unwrap(),
            specimen: Specimen {
                height_mm: height,
                radius_mm: 25.0,
                base: if sliding { Base::Sliding } else { Base::Bonded },
            },
            ball: Ball { radius_mm: ball.unwrap() },
            depth_mm: 4.0,
            resolution: Resolution::Standard,
        },
        uncertainty: uncertainty(&header),
        rows: rows.collect(),
    }
}

#[test]
fn forces_match_independent_codes() {
    let folder = folder();
    if !folder.is_dir() {
        println!("SKIPPED: ../shared/reference not found; no force was compared");
        return;
    }
    let mut files: Vec<PathBuf> = std::fs::read_dir(&folder).unwrap().map(|e| e.unwrap().path()).collect();
    files.retain(|p| p.extension().is_some_and(|e| e == "csv"));
    files.sort();
    assert!(files.len() >= 12, "only {} curves in {}", files.len(), folder.display());
    println!(
        "{:<15} {:>6} {:>5} {:>7}  error at 0.5 | 1, 2, 3, 4 mm [%]   allowed",
        "curve", "dofs", "iter", "seconds"
    );
    let mut missed = Vec::new();
    for reference in files.iter().map(|p| read(p)) {
        let curve = reference.problem.solve().unwrap();
        let error = |d: f64| {
            let (_, force) = reference.rows.iter().find(|r| (r.0 - d).abs() < 1e-9).unwrap();
            100.0 * (curve.profile.force_n(d) / force - 1.0)
        };
        let allowed = PROMISE + reference.uncertainty;
        let s = &curve.stats;
        print!(
            "{:<15} {:>6} {:>5} {:>7.2} {:>+7.2} |",
            reference.name,
            s.unknowns,
            s.iterations,
            s.seconds,
            error(0.5)
        );
        for d in DEPTHS {
            print!(" {:+.2}", error(d));
            if error(d).abs() > allowed {
                missed.push(format!("{} at {d} mm: {:+.2} %, allowed {allowed:.2} %", reference.name, error(d)));
            }
        }
        println!("   {allowed:.2}");
        // contact force and base reaction agree, and the mesh's own error is in the promise
        assert!(s.imbalance < 1e-3, "{}: contact and base differ by {}", reference.name, s.imbalance);
        assert!(100.0 * curve.discretisation < PROMISE, "{}: {}", reference.name, curve.discretisation);
    }
    assert!(missed.is_empty(), "missed:\n{}", missed.join("\n"));
}
