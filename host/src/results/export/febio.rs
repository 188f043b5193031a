//! The law as FEBio reads it.

use std::fmt::Write;

use lut_gen::solid::law::{Elastic, Hyperfoam, Material, Ogden, PronyTerm};

use super::{Header, NoCounterpart, alike, field, name};

/// An elastic block: type, and parameters in their order.
struct Block {
    kind: &'static str,
    values: Vec<(String, String)>,
    /// Its bulk never relaxes: the `uncoupled viscoelastic` of FEBio.
    uncoupled: bool,
}

/// A `<Material>` section, as a file that a model may include.
///
/// Hyperfoam with `nu = 0` is "Ogden unconstrained" (FEBio User's Manual 3.4, section 4.1.3.19) with `cp = 0`,
/// `c_i = 2 mu_i`, `m_i = alpha_i`; the program has no counterpart of another Poisson's ratio:
///
/// ```text
/// W   = cp (J - 1)^2 / 2 + sum_i c_i / m_i^2 [ l1^m_i + l2^m_i + l3^m_i - 3 - m_i ln J ]
/// T_k = cp (J - 1) + 1/J sum_i c_i / m_i [ l_k^m_i - 1 ]                (Cauchy stress)
/// ```
///
/// Ogden is "Ogden" (section 4.1.2.9), uncoupled, with `c_i = 2 mu_i`, `k = 2 / D_1` and the volumetric energy
/// `k (J - 1)^2 / 2` that it calls Abaqus' (`pressure_model` 2). A relaxation is "viscoelastic" or "uncoupled
/// viscoelastic": `S(t) = g0 S_e + sum_i g_i int exp(-(t-s)/t_i) dS_e`, `g0 = 1 - sum g_i` for instantaneous moduli.
/// The first relaxes shear and bulk alike, the second shear alone.
///
/// # Errors
/// [`NoCounterpart`].
pub fn febio(material: &Material, header: &Header) -> Result<String, NoCounterpart> {
    let block = match &material.elastic {
        Elastic::Hyperfoam(law) => hyperfoam(law)?,
        Elastic::Ogden(law) => ogden(law),
        Elastic::Hencky(_) => return Err(NoCounterpart::Law),
    };
    let mut out = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<febio_spec version=\"4.0\">\n");
    out.push_str("\t<!-- Material for FEBio. Units: N, mm, MPa, s.\n");
    for line in &header.lines {
        // two dashes would end the comment
        let _ = writeln!(out, "\t     {}", line.replace("--", "- -"));
    }
    out.push_str("\t-->\n\t<Material>\n");
    let named = format!("id=\"1\" name=\"{}\"", name(&header.name));
    let prony = &material.prony;
    let exact = if block.uncoupled { prony.iter().all(|term| term.k == 0.0) } else { alike(prony) };
    if prony.is_empty() || !exact {
        elastic(&mut out, "material", &named, &block);
        if !exact {
            not_active(&mut out, &block, prony);
        }
    } else {
        let kind = if block.uncoupled { "uncoupled viscoelastic" } else { "viscoelastic" };
        let _ = writeln!(out, "\t\t<material {named} type=\"{kind}\">");
        let left = 1.0 - prony.iter().map(|term| term.g).sum::<f64>();
        let _ = writeln!(out, "\t\t\t<g0>{}</g0>", field(left));
        for (at, term) in prony.iter().enumerate() {
            let (n, g, t) = (at + 1, field(term.g), field(term.tau_s));
            let _ = writeln!(out, "\t\t\t<g{n}>{g}</g{n}>\n\t\t\t<t{n}>{t}</t{n}>");
        }
        elastic(&mut out, "elastic", "", &block);
        out.push_str("\t\t</material>\n");
    }
    out.push_str("\t</Material>\n</febio_spec>\n");
    Ok(out)
}

fn elastic(out: &mut String, element: &str, named: &str, block: &Block) {
    let gap = if named.is_empty() { "" } else { " " };
    let _ = writeln!(out, "\t\t<{element} {named}{gap}type=\"{}\">", block.kind);
    for (key, value) in &block.values {
        let _ = writeln!(out, "\t\t\t<{key}>{value}</{key}>");
    }
    let _ = writeln!(out, "\t\t</{element}>");
}

/// Says what is left out, and why.
fn not_active(out: &mut String, block: &Block, prony: &[PronyTerm]) {
    let (kind, how) = if block.uncoupled {
        ("uncoupled viscoelastic", "in shear alone")
    } else {
        ("viscoelastic", "alike in shear and bulk")
    };
    let _ = writeln!(out, "\t\t<!-- NOT ACTIVE: FEBio's {kind} relaxes {how}, and the fitted law does not.");
    out.push_str("\t\t     The block above is the instantaneous law. Fitted g, k, tau in s:\n");
    for term in prony {
        let _ = writeln!(out, "\t\t     {}, {}, {}", field(term.g), field(term.k), field(term.tau_s));
    }
    out.push_str("\t\t-->\n");
}

fn hyperfoam(law: &Hyperfoam) -> Result<Block, NoCounterpart> {
    if law.terms().iter().any(|term| term.nu != 0.0) {
        return Err(NoCounterpart::PoissonInFebio);
    }
    let mut values = Vec::new();
    for (at, term) in law.terms().iter().enumerate() {
        values.push((format!("c{}", at + 1), field(2.0 * term.mu_mpa)));
        values.push((format!("m{}", at + 1), field(term.alpha)));
    }
    values.push(("cp".to_owned(), "0".to_owned()));
    Ok(Block { kind: "Ogden unconstrained", values, uncoupled: false })
}

fn ogden(law: &Ogden) -> Block {
    let mut values = Vec::new();
    for (at, term) in law.terms().iter().enumerate() {
        values.push((format!("c{}", at + 1), field(2.0 * term.mu_mpa)));
        values.push((format!("m{}", at + 1), field(term.alpha)));
    }
    let first = law.terms().first().map_or(1.0, |term| term.d_per_mpa);
    values.push(("k".to_owned(), field(2.0 / first)));
    values.push(("pressure_model".to_owned(), "2".to_owned()));
    Block { kind: "Ogden", values, uncoupled: true }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used)]
mod tests {
    use lut_gen::solid::law::{Law, OgdenTerm, Term};

    use super::*;

    /// The number inside an element.
    fn value(text: &str, key: &str) -> f64 {
        let inner = text.split_once(&format!("<{key}>")).unwrap().1.split_once('<').unwrap().0;
        inner.parse().unwrap()
    }

    fn pairs(text: &str, terms: usize) -> Vec<(f64, f64)> {
        (1..=terms).map(|n| (value(text, &format!("c{n}")), value(text, &format!("m{n}")))).collect()
    }

    #[test]
    fn a_foam_in_uniaxial_compression_has_the_same_stress() {
        for terms in [vec![(0.22, 10.526_315_789)], vec![(1.0 / 30.0, 3.0), (0.002, 22.0)]] {
            let term = |&(mu_mpa, alpha): &(f64, f64)| Term { mu_mpa, alpha, nu: 0.0 };
            let law = Hyperfoam::new(terms.iter().map(term).collect()).unwrap();
            let text = febio(&law.clone().into(), &Header::default()).unwrap();
            let (pairs, cp) = (pairs(&text, terms.len()), value(&text, "cp"));
            for l in [0.4_f64, 0.7, 0.95, 1.2] {
                // manual, 4.1.3.19; the sides stay where they are, so that J = l, and P = T J / l = T
                let cauchy: f64 =
                    pairs.iter().map(|(c, m)| c / m * (l.powf(*m) - 1.0) / l).sum::<f64>() + cp * (l - 1.0);
                let ours = law.uniaxial_stress_mpa(l);
                // twelve digits are written
                assert!((cauchy - ours).abs() < 1e-9 * ours.abs(), "{l}: {cauchy} {ours}");
                assert_eq!(law.stress([l, 1.0, 1.0]).1[1], 0.0);
            }
        }
    }

    #[test]
    fn ogden_has_the_same_stress() {
        let terms = vec![
            OgdenTerm { mu_mpa: 0.004, alpha: 8.0, d_per_mpa: 3.0 },
            OgdenTerm { mu_mpa: 0.001, alpha: 3.0, d_per_mpa: 0.0 },
        ];
        let law = Ogden::new(terms).unwrap();
        let text = febio(&law.clone().into(), &Header::default()).unwrap();
        let (pairs, bulk) = (pairs(&text, 2), value(&text, "k"));
        let l = [0.6, 1.3, 1.27];
        let j: f64 = l.iter().product();
        let m = l.map(|x: f64| x * j.powf(-1.0 / 3.0));
        for k in 0..3 {
            let deviator: f64 = pairs
                .iter()
                .map(|(c, a)| c / a * (m[k].powf(*a) - m.iter().map(|x| x.powf(*a)).sum::<f64>() / 3.0))
                .sum();
            // nominal stress is J T / l; pressure model 2 is k (J - 1)
            let nominal = (deviator + j * bulk * (j - 1.0)) / l[k];
            let ours = law.stress(l).1[k];
            assert!((nominal - ours).abs() < 1e-9 * 0.005, "{k}: {nominal} {ours}");
        }
    }

    #[test]
    fn what_febio_has_not_is_said() {
        let foam = Hyperfoam::new(vec![Term { mu_mpa: 0.1, alpha: 8.0, nu: 0.2 }]).unwrap();
        assert_eq!(febio(&foam.into(), &Header::default()), Err(NoCounterpart::PoissonInFebio));
        let foam = Material::from(Hyperfoam::one_term(0.2, 8.0).unwrap());
        let header = Header { name: "EVA".to_owned(), lines: vec!["a -- b".to_owned()] };
        let alike = febio(&foam.clone().relaxing(vec![PronyTerm::alike(0.3, 2.0)]).unwrap(), &header).unwrap();
        assert!(alike.contains("type=\"viscoelastic\"") && value(&alike, "g0") == 0.7 && value(&alike, "t1") == 2.0);
        let apart = foam.relaxing(vec![PronyTerm { g: 0.3, k: 0.0, tau_s: 2.0 }]).unwrap();
        let apart = febio(&apart, &header).unwrap();
        assert!(apart.contains("NOT ACTIVE") && !apart.contains("type=\"viscoelastic\""), "{apart}");
        let shear = vec![PronyTerm { g: 0.5, k: 0.0, tau_s: 1.0 }];
        let liver = Material::from(Ogden::one_term(0.004, 8.0, 3.0).unwrap()).relaxing(shear).unwrap();
        assert!(febio(&liver, &header).unwrap().contains("type=\"uncoupled viscoelastic\""));
    }
}
