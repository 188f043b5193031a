//! The law as Abaqus and CalculiX read it.

use std::fmt::Write;

use lut_gen::solid::law::{Elastic, Hyperfoam, Material, Ogden, PronyTerm};

use super::{Header, NoCounterpart, alike, field, name};

/// Values on a line of these programs.
const ON_A_LINE: usize = 8;
/// Compressibility of an Ogden term whose volumetric part is left out, in those of the first: as good as none.
const NO_VOLUME: f64 = 1e20;

/// A `*MATERIAL` block.
///
/// Hyperfoam is their `*HYPERFOAM` (Abaqus Analysis User's Guide, "Hyperelastic behavior in elastomeric foams";
/// CalculiX User's Manual, `*HYPERFOAM`), with the same coefficients as the project's law:
///
/// ```text
/// U = sum_i 2 mu_i / a_i^2 [ l1^a_i + l2^a_i + l3^a_i - 3 + (J^(-a_i b_i) - 1) / b_i ],  b_i = nu_i / (1 - 2 nu_i)
/// data line: mu_1, a_1, ..., mu_N, a_N, nu_1, ..., nu_N
/// ```
///
/// One term is written as two halves: CalculiX 2.20 computes no stress for `N=1`. Ogden is `*HYPERELASTIC, OGDEN`
/// (Abaqus, "Hyperelastic behavior of rubberlike materials"; CalculiX, `*HYPERELASTIC`), on deviatoric stretches:
///
/// ```text
/// U = sum_i 2 mu_i / a_i^2 [ m1^a_i + m2^a_i + m3^a_i - 3 ] + sum_i (J - 1)^(2 i) / D_i
/// data line: mu_1, a_1, ..., mu_N, a_N, D_1, ..., D_N
/// ```
///
/// A relaxation is `*VISCOELASTIC, TIME=PRONY` with lines `g_i, k_i, tau_i` of instantaneous moduli (Abaqus, "Time
/// domain viscoelasticity"). A hyperfoam must relax alike in shear and bulk there; CalculiX has no such keyword.
///
/// # Errors
/// [`NoCounterpart::Law`] for Hencky's law.
pub fn abaqus(material: &Material, header: &Header) -> Result<String, NoCounterpart> {
    let (keyword, values) = match &material.elastic {
        Elastic::Hyperfoam(law) => hyperfoam(law),
        Elastic::Ogden(law) => ogden(law),
        Elastic::Hencky(_) => return Err(NoCounterpart::Law),
    };
    let mut out = String::from("** Material for Abaqus and CalculiX. Units: N, mm, MPa, s.\n");
    for line in &header.lines {
        let _ = writeln!(out, "** {line}");
    }
    let moduli = if material.prony.is_empty() { "" } else { ", MODULI=INSTANTANEOUS" };
    let _ = writeln!(out, "*MATERIAL, NAME={}\n{keyword}{moduli}", name(&header.name));
    for line in values.chunks(ON_A_LINE) {
        let _ = writeln!(out, "{}", line.iter().map(|value| field(*value)).collect::<Vec<_>>().join(", "));
    }
    let together = matches!(material.elastic, Elastic::Hyperfoam(_)) && !alike(&material.prony);
    relaxation(&mut out, &material.prony, together);
    Ok(out)
}

fn hyperfoam(law: &Hyperfoam) -> (String, Vec<f64>) {
    let halves = if law.terms().len() == 1 { 2 } else { 1 };
    let terms: Vec<_> = law.terms().iter().flat_map(|term| vec![(term, halves as f64); halves]).collect();
    let mut values: Vec<f64> = terms.iter().flat_map(|(term, parts)| [term.mu_mpa / parts, term.alpha]).collect();
    values.extend(terms.iter().map(|(term, _)| term.nu));
    (format!("*HYPERFOAM, N={}", terms.len()), values)
}

fn ogden(law: &Ogden) -> (String, Vec<f64>) {
    let first = law.terms().first().map_or(1.0, |term| term.d_per_mpa);
    let volume = |d: f64| if d > 0.0 { d } else { NO_VOLUME * first };
    let mut values: Vec<f64> = law.terms().iter().flat_map(|term| [term.mu_mpa, term.alpha]).collect();
    values.extend(law.terms().iter().map(|term| volume(term.d_per_mpa)));
    (format!("*HYPERELASTIC, OGDEN, N={}", law.terms().len()), values)
}

/// The Prony series; as a comment where the law there would relax otherwise than the fitted one.
fn relaxation(out: &mut String, prony: &[PronyTerm], otherwise: bool) {
    if prony.is_empty() {
        return;
    }
    let comment = if otherwise {
        out.push_str(
            "** NOT ACTIVE: shear and bulk relax apart in the fit, and a hyperfoam of Abaqus relaxes alike in both.\n\
             ** The block above is the instantaneous law. Fitted g, k, tau:\n",
        );
        "** "
    } else {
        out.push_str("** CalculiX has no *VISCOELASTIC: leave the rest out there.\n");
        ""
    };
    let _ = writeln!(out, "{comment}*VISCOELASTIC, TIME=PRONY");
    for term in prony {
        let _ = writeln!(out, "{comment}{}, {}, {}", field(term.g), field(term.k), field(term.tau_s));
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used)]
mod tests {
    use lut_gen::solid::law::{Hencky, Law, OgdenTerm, Term};

    use super::*;

    /// Values of the data lines after a keyword.
    fn values(text: &str, keyword: &str) -> Vec<f64> {
        let lines = text.lines().skip_while(|line| !line.starts_with(keyword)).skip(1);
        let data = lines.take_while(|line| !line.starts_with('*'));
        data.flat_map(|line| line.split(',')).map(|value| value.trim().parse().unwrap()).collect()
    }

    /// Abaqus' nominal stress of a hyperfoam: `2 mu / (a l_k) [ l_k^a - J^(-a b) ]`, summed.
    fn hyperfoam_stress(data: &[f64], l: [f64; 3]) -> [f64; 3] {
        let terms = data.len() / 3;
        let j: f64 = l.iter().product();
        std::array::from_fn(|k| {
            (0..terms)
                .map(|i| {
                    let (mu, a, nu) = (data[2 * i], data[2 * i + 1], data[2 * terms + i]);
                    2.0 * mu / (a * l[k]) * (l[k].powf(a) - j.powf(-a * nu / (1.0 - 2.0 * nu)))
                })
                .sum()
        })
    }

    /// Abaqus' nominal stress of Ogden's law, by its energy of deviatoric stretches and of the volume.
    fn ogden_stress(data: &[f64], l: [f64; 3]) -> [f64; 3] {
        let terms = data.len() / 3;
        let j: f64 = l.iter().product();
        let m = l.map(|x| x * j.powf(-1.0 / 3.0));
        std::array::from_fn(|k| {
            let each = (0..terms).map(|i| {
                let (mu, a, d) = (data[2 * i], data[2 * i + 1], data[2 * terms + i]);
                let mean = m.iter().map(|x| x.powf(a)).sum::<f64>() / 3.0;
                let order = 2.0 * (i + 1) as f64;
                2.0 * mu / a * (m[k].powf(a) - mean) + j * order * (j - 1.0).powf(order - 1.0) / d
            });
            each.sum::<f64>() / l[k]
        })
    }

    fn close(ours: [f64; 3], theirs: [f64; 3], scale: f64) {
        for (a, b) in ours.iter().zip(theirs) {
            // twelve digits are written; alpha multiplies their error by its own size
            assert!((a - b).abs() < 1e-9 * scale, "{ours:?} {theirs:?}");
        }
    }

    #[test]
    fn a_foam_in_uniaxial_compression_has_the_same_stress() {
        for (mu_mpa, alpha, nu) in [(0.22, 10.526_315_789, 0.0), (0.012_3, 14.8, 0.123_456), (1.0 / 3.0, 2.0, 0.3)] {
            let law = Hyperfoam::new(vec![Term { mu_mpa, alpha, nu }]).unwrap();
            let text = abaqus(&law.clone().into(), &Header::default()).unwrap();
            let data = values(&text, "*HYPERFOAM, N=2");
            for l in [0.4_f64, 0.7, 0.95, 1.2] {
                // the sides are free of stress at l^-nu
                let stretches = [l, l.powf(-nu), l.powf(-nu)];
                let ours = law.stress(stretches).1;
                close(ours, hyperfoam_stress(&data, stretches), ours[0].abs());
                assert!(hyperfoam_stress(&data, stretches)[1].abs() < 1e-9 * ours[0].abs());
            }
        }
    }

    #[test]
    fn two_terms_and_ogden_have_the_same_stress() {
        let terms = vec![Term { mu_mpa: 0.1, alpha: 3.0, nu: 0.1 }, Term { mu_mpa: 0.02, alpha: 20.0, nu: 0.1 }];
        let law = Hyperfoam::new(terms).unwrap();
        let data = values(&abaqus(&law.clone().into(), &Header::default()).unwrap(), "*HYPERFOAM, N=2");
        let l: [f64; 3] = [0.6, 1.05, 1.02];
        close(law.stress(l).1, hyperfoam_stress(&data, l), 0.1);
        let terms = vec![
            OgdenTerm { mu_mpa: 0.004, alpha: 8.0, d_per_mpa: 3.0 },
            OgdenTerm { mu_mpa: 0.001, alpha: 3.0, d_per_mpa: 0.0 },
        ];
        let law = Ogden::new(terms).unwrap();
        let data = values(&abaqus(&law.clone().into(), &Header::default()).unwrap(), "*HYPERELASTIC, OGDEN, N=2");
        close(law.stress(l).1, ogden_stress(&data, l), 0.005);
    }

    #[test]
    fn a_relaxation_is_active_only_where_it_means_the_same() {
        let header = Header { name: "liver 1".to_owned(), lines: vec!["mu_MPa 0.004".to_owned()] };
        let prony = vec![PronyTerm { g: 0.5, k: 0.1, tau_s: 1.5 }];
        let ogden = Material::from(Ogden::one_term(0.004, 8.0, 3.0).unwrap()).relaxing(prony.clone()).unwrap();
        let text = abaqus(&ogden, &header).unwrap();
        assert!(text.contains("NAME=liver-1\n*HYPERELASTIC, OGDEN, N=1, MODULI=INSTANTANEOUS\n"), "{text}");
        assert!(text.contains("\n*VISCOELASTIC, TIME=PRONY\n0.5, 0.1, 1.5\n") && text.contains("** mu_MPa 0.004"));
        let foam = Material::from(Hyperfoam::one_term(0.2, 8.0).unwrap());
        let apart = abaqus(&foam.clone().relaxing(prony).unwrap(), &header).unwrap();
        assert!(apart.contains("NOT ACTIVE") && apart.contains("\n** *VISCOELASTIC"), "{apart}");
        let alike = foam.relaxing(vec![PronyTerm::alike(0.3, 2.0)]).unwrap();
        assert!(abaqus(&alike, &header).unwrap().contains("\n*VISCOELASTIC"));
        let hencky = Material::from(Hencky::new(0.1, 0.2).unwrap());
        assert_eq!(abaqus(&hencky, &header), Err(NoCounterpart::Law));
    }
}
