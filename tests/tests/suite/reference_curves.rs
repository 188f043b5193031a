//! Forces of the default solver against curves of independent codes in `../shared/reference`.
//!
//! At every depth from 0.5 mm on the force must lie within 0.2 % of the curve's peak (the
//! product's promise) plus the uncertainty that the curve's own header states. The figures
//! are in docs/verification.md; `cargo run --release -p tests --example verification` makes them again.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use lut_gen::solid::solve::Base;
use tests::reference::{Comparison, Reference, curves, folder, table};

#[test]
fn forces_match_independent_codes() {
    let folder = folder();
    let Some(references) = curves(&folder).unwrap_or_else(|e| panic!("{e}")) else {
        println!("SKIPPED: {} not found; no force was compared", folder.display());
        return;
    };
    assert!(references.len() >= 12, "only {} curves in {}", references.len(), folder.display());
    let mut missed = Vec::new();
    let mut done = Vec::new();
    for reference in references {
        match Comparison::of(reference) {
            Ok(c) => done.push(c),
            Err(e) => missed.push(e.to_string()),
        }
    }
    println!("{}", table(&done));
    for c in &done {
        let (name, t) = (&c.reference.name, c.tightest());
        if !c.met() {
            missed.push(format!(
                "{name} at {} mm: {:+.3} % of the peak, allowed {:.3} %",
                t.depth_mm, t.error_percent, t.allowed_percent
            ));
        }
        // contact force and base reaction agree to what Newton's method leaves
        if c.stats.imbalance > 1e-3 {
            missed.push(format!("{name}: contact and base differ by {:.1e}", c.stats.imbalance));
        }
        // the mesh's own error, stated relative to the local force from 0.5 mm on, may be twice the promise for the peak
        if c.discretisation > 4e-3 {
            missed.push(format!("{name}: states {:.2} % for its own mesh", 100.0 * c.discretisation));
        }
    }
    assert!(missed.is_empty(), "missed:\n{}", missed.join("\n"));
}

const INDEPENDENT: &str = "\
# Hyperfoam, axisymmetric, analytic rigid ball; independent implicit code
# mu=0.15, alpha=8, nu=0.1, mu2=0.05, alpha2=-4, R=5, h=20, sliding=1, mu_f=0.3  [mu MPa, R and h mm; block radius 30 mm; base sliding; free side and top]
# meshes 56x34 and 90x54, Richardson value listed; uncertainty from 0.5 mm on: 0.12 % (below 0.5 mm larger)
depth_mm,force_N
0.00,0.000000
0.50,0.100000
3.00,1.000000
";

const CALCULIX: &str = "\
# case: ccx_X
# indenter_R_mm: 6
# block: radius_mm=25 height_mm=19.05 base=stuck (u_z=0, u_r=0) side=free top=free outside contact
# material: hyperfoam W=sum 2mu/alpha^2*(l1^a+l2^a+l3^a-3+(J^(-a b)-1)/b), b=nu/(1-2nu), terms (mu_MPa, alpha, nu) = [[0.193, 12.711, 0.1], [0.05, -4, 0.0]]
# friction: mu_c=0.3
# mesh C: fine size 0.24 mm, 40 increments, ended ok; F(1,2 mm) = 1.000 2.000 N
# mesh M: fine size 0.16 mm, 20 increments, ended EARLY; F(1,2 mm) = 0.5 nan N
# mesh F: fine size 0.107 mm, 40 increments, ended ok; F(1,2 mm) = 1.001 2.006 N
depth_mm,force_N
0,0
0.5,0.3
2,2.0
";

#[test]
fn both_header_forms_are_read() {
    let r = Reference::parse("x", INDEPENDENT).unwrap();
    let terms: Vec<_> = r.law.terms().iter().map(|t| [t.mu_mpa, t.alpha, t.nu]).collect();
    assert_eq!(terms, [[0.15, 8.0, 0.1], [0.05, -4.0, 0.1]]);
    assert_eq!((r.ball.radius_mm, r.specimen.height_mm, r.specimen.radius_mm), (5.0, 20.0, 30.0));
    assert_eq!((r.specimen.base, r.friction, r.uncertainty_percent), (Base::Sliding, 0.3, 0.12));
    assert_eq!((r.depth_mm(), r.peak_n()), (3.0, 1.0));

    let r = Reference::parse("y", CALCULIX).unwrap();
    let terms: Vec<_> = r.law.terms().iter().map(|t| [t.mu_mpa, t.alpha, t.nu]).collect();
    assert_eq!(terms, [[0.193, 12.711, 0.1], [0.05, -4.0, 0.0]]);
    assert_eq!((r.ball.radius_mm, r.specimen.height_mm, r.specimen.radius_mm), (6.0, 19.05, 25.0));
    assert_eq!((r.specimen.base, r.friction), (Base::Bonded, 0.3));
    // the two meshes that ended well differ most at 2 mm
    assert!((r.uncertainty_percent - 0.3).abs() < 1e-9, "{}", r.uncertainty_percent);
    // with a single mesh the substitute stands in
    let single = CALCULIX.replacen("ended ok", "ended EARLY", 1);
    assert_eq!(Reference::parse("y", &single).unwrap().uncertainty_percent, 0.25);
}

#[test]
fn what_a_header_does_not_make_clear_is_refused_by_name() {
    let say = |text: &str, from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        Reference::parse("x", &text.replace(from, to)).unwrap_err().to_string()
    };
    let cases = [
        (INDEPENDENT, "R=5, ", "", "reference curve x: the line of parameters states no R="),
        (INDEPENDENT, "mu2=0.05, alpha2=-4", "mu2=0.05", "reference curve x: the line of parameters states no alpha2="),
        (
            INDEPENDENT,
            "mu=0.15, ",
            "",
            "reference curve x: the header has neither a line with mu= nor a line material:",
        ),
        (INDEPENDENT, "alpha=8", "alpha=eight", "reference curve x: alpha = \"eight\" is not a finite number"),
        (
            INDEPENDENT,
            "mu_f=0.3",
            "tau=0.3",
            "reference curve x: the line of parameters has tau=0.3, which is not understood",
        ),
        (
            INDEPENDENT,
            "sliding=1",
            "sliding=0",
            "reference curve x: its base is Bonded by the parameters, but Sliding by the remark",
        ),
        (INDEPENDENT, "uncertainty", "error", "reference curve x: the header states no uncertainty"),
        (INDEPENDENT, "mu_f=0.3", "mu_f=-0.3", "reference curve x: friction = -0.3 must not be negative"),
        (
            INDEPENDENT,
            "3.00,1",
            "0.40,1",
            "reference curve x: line 7: depth = 0.4 mm must exceed that of the row before",
        ),
        (INDEPENDENT, "3.00,1.000000", "3.00,nan", "reference curve x: line 7: force = \"nan\" is not a finite number"),
        (INDEPENDENT, "0.50,0.100000\n3.00,1.0", "0.20,0.1", "reference curve x: it ends at 0.2 mm, before 0.5 mm"),
        (INDEPENDENT, "nu=0.1", "nu=0.5", "reference curve x: hyperfoam term 1: nu = 0.5 must lie in (-1, 0.5)"),
        (CALCULIX, "hyperfoam W", "ogden W", "reference curve x: material \"ogden\" is not a hyperfoam"),
        (
            CALCULIX,
            ", 0.1], [",
            "], [",
            "reference curve x: the term [0.193, 12.711] has not the three values mu, alpha, nu",
        ),
        (
            CALCULIX,
            "base=stuck",
            "base=elastic",
            "reference curve x: base \"elastic\" is neither bonded (stuck, fixed) nor sliding (roller)",
        ),
        (
            CALCULIX,
            "side=free",
            "side=held",
            "reference curve x: the line block: has side=held, which is not understood",
        ),
        (CALCULIX, "# indenter_R_mm: 6\n", "", "reference curve x: the header has no line indenter_R_mm:"),
    ];
    for (text, from, to, expected) in cases {
        assert_eq!(say(text, from, to), expected);
    }
    // cut anywhere, a file is an error or a curve, never a panic
    for text in [INDEPENDENT, CALCULIX] {
        for end in 0..text.len() {
            let _ = Reference::parse("cut", &text[..end]);
        }
    }
    let absent = Reference::read(std::path::Path::new("no/such/curve.csv")).unwrap_err().to_string();
    assert!(absent.starts_with("reference curve no/such/curve.csv: cannot be read: "), "{absent}");
}

/// A comparison must be able to fail: forces 1 % higher are refused.
#[test]
fn a_wrong_curve_is_missed() {
    let text = "\
# mu=0.1, alpha=4, R=4, h=12.7, sliding=0  [base bonded]
# uncertainty from 0.5 mm on: 0.05 %
0.5,1.0
1.0,2.0
";
    let c = Comparison::of(Reference::parse("wrong", text).unwrap()).unwrap();
    assert!(!c.met());
    let right: Vec<f64> =
        c.rows.iter().zip(&c.reference.rows).map(|(r, f)| f.1 + r.error_percent / 100.0 * 2.0).collect();
    for (factor, met) in [(1.0, true), (1.01, false)] {
        let mut reference = c.reference.clone();
        for (row, force) in reference.rows.iter_mut().zip(&right) {
            row.1 = force * factor;
        }
        assert_eq!(Comparison::of(reference).unwrap().met(), met, "{factor}");
    }
    // friction is solved with, and only where the solver has it
    let rough = Comparison::of(Reference { friction: 0.3, ..c.reference.clone() }).unwrap();
    assert!(rough.rows.iter().zip(&c.rows).all(|(rough, smooth)| rough.error_percent > smooth.error_percent));
    let absurd = Comparison::of(Reference { friction: 3.0, ..c.reference }).unwrap_err().to_string();
    assert_eq!(absurd, "reference curve wrong: friction = 3 must lie in 0..2");
}
