//! Fields inside the block: closed form, balance with the force, and the files for ParaView.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::BTreeMap;

use lut_gen::fem::quadrature::gauss;
use lut_gen::fem::shape::line3;
use lut_gen::solid::contact::{Adhesion, Ball, Interface, Penalty, Surface};
use lut_gen::solid::field::{Field, FieldError, Step, vtu};
use lut_gen::solid::law::{Hyperfoam, PronyTerm, Term, first_piola, relaxed};
use lut_gen::solid::mesh::BlockMesh;
use lut_gen::solid::model::{Indentation, Resolution, Simulation, Specimen};
use lut_gen::solid::solve::Motion;

fn homogeneous(law: &Hyperfoam, radial: f64, axial: f64) -> Result<Field, FieldError> {
    let mesh = BlockMesh::from_lines(&[0.0, 1.0, 2.5], &[0.0, 1.5, 2.0]);
    let surface = Surface::new(
        Ball { radius_mm: 1.0 },
        Interface::default(),
        &mesh.nodes,
        &mesh.top,
        2.0,
        4,
        Penalty::linear(1.0),
    );
    let u = mesh.nodes.iter().map(|x| [(radial - 1.0) * x[0], (axial - 1.0) * x[1]]).collect();
    let stress = |_, f: &_| first_piola(law, f).map(|(_, p)| p);
    Field::new(&mesh, u, stress, &surface, Step { time_s: 0.0, depth_mm: -1.0, force_n: 0.0 })
}

#[test]
fn uniaxial_compression_has_the_stress_of_its_closed_form() {
    let law = Hyperfoam::one_term(0.22, 10.526).unwrap();
    for l in [0.4, 0.8, 1.1] {
        let field = homogeneous(&law, 1.0, l).unwrap();
        // nu = 0: the sides do not move, so that nominal and Cauchy stress are the same
        let exact = law.uniaxial_stress_mpa(l);
        for state in &field.state {
            // rounding of the extrapolation from the quadrature points to the nodes
            assert!((state.cauchy_mpa[1] - exact).abs() < 1e-12 * exact.abs(), "{state:?}");
            assert!((state.mises_mpa() - exact.abs()).abs() < 1e-12 * exact.abs());
            assert!((state.volume_ratio() - l).abs() < 1e-13);
        }
    }
}

#[test]
fn stretches_and_stress_of_a_biaxial_state_with_poissons_ratio() {
    let law = Hyperfoam::new(vec![Term { mu_mpa: 0.1, alpha: 4.0, nu: 0.3 }]).unwrap();
    let field = homogeneous(&law, 1.2, 0.7).unwrap();
    // Eq. 1 by hand: sigma_k = 2 mu / (alpha J) (l_k^alpha - J^(-alpha beta)), beta = nu / (1 - 2 nu)
    let j: f64 = 1.2 * 1.2 * 0.7;
    let sigma = |l: f64| 2.0 * 0.1 / (4.0 * j) * (l.powi(4) - j.powf(-4.0 * 0.3 / 0.4));
    for state in &field.state {
        for (found, exact) in state.stretch.iter().zip([1.2, 0.7, 1.2]) {
            assert!((found - exact).abs() < 1e-13);
        }
        for (found, exact) in state.cauchy_mpa.iter().zip([sigma(1.2), sigma(0.7), sigma(1.2), 0.0]) {
            assert!((found - exact).abs() < 1e-13);
        }
        assert!((state.mises_mpa() - (sigma(1.2) - sigma(0.7)).abs()).abs() < 1e-13);
    }
}

#[test]
fn what_cannot_be_a_field_is_refused_by_name() {
    let law = Hyperfoam::one_term(0.1, 2.0).unwrap();
    let inverted = homogeneous(&law, 1.0, -0.1).unwrap_err();
    assert_eq!(inverted.to_string(), "element 0 is turned inside out at depth -1 mm");
    let wrong = eva(2.0).fields_at(&[1.0, 2.5]).unwrap_err();
    assert_eq!(wrong.to_string(), "depth_mm = 2.5 must not exceed the largest depth, 2 mm");
    let zero = eva(2.0).fields_at(&[0.0]).unwrap_err();
    assert_eq!(zero.to_string(), "depth_mm = 0 must be positive");
}

/// On a mesh fine enough for stresses: the standard one is made for forces.
fn eva(depth_mm: f64) -> Indentation {
    Indentation {
        law: Hyperfoam::one_term(0.22, 10.526).unwrap(),
        specimen: Specimen::of_height(12.7),
        ball: Ball { radius_mm: 4.0 },
        depth_mm,
        resolution: Resolution::Refined(1.6),
    }
}

/// Integral over the deformed top, between the nodes with their own shape functions: of the pressure's vertical part.
fn pressure_force(field: &Field) -> f64 {
    let mut sum = 0.0;
    for edge in &field.top {
        for (x, w) in gauss(4) {
            let (shape, slope) = line3(x);
            let (mut at, mut along, mut p) = ([0.0; 2], [0.0; 2], 0.0);
            for (i, &node) in edge.iter().enumerate() {
                let x = field.position_mm(node);
                for k in 0..2 {
                    at[k] += shape[i] * x[k];
                    along[k] += slope[i] * x[k];
                }
                p += shape[i] * field.pressure_mpa[node];
            }
            // vertical part of the current area is its projection
            sum += p * std::f64::consts::TAU * at[0] * along[0] * w;
        }
    }
    sum
}

#[test]
fn pressure_and_stress_carry_the_force() {
    let fields = eva(4.0).fields_at(&[1.0, 4.0]).unwrap();
    for field in &fields {
        let pressed = pressure_force(field) / field.step.force_n - 1.0;
        // Axial stress over the bonded base, whose area does not change: trapezoids between the nodes.
        let mut base: Vec<(f64, f64)> = (field.nodes.iter().zip(&field.state))
            .filter(|(x, _)| x[1].abs() < 1e-9)
            .map(|(x, s)| (x[0], -s.cauchy_mpa[1]))
            .collect();
        base.sort_by(|a, b| a.0.total_cmp(&b.0));
        let area = |r: f64| std::f64::consts::PI * r * r;
        let carried: f64 = base.windows(2).map(|w| 0.5 * (w[0].1 + w[1].1) * (area(w[1].0) - area(w[0].0))).sum();
        let carried = carried / field.step.force_n - 1.0;
        println!("depth {} mm: pressure {pressed:+.4}, base {carried:+.4}", field.step.depth_mm);
        assert!(pressed.abs() < 0.02 && carried.abs() < 0.02, "{pressed} {carried}");
    }
    assert!(fields[1].largest_mises_mpa() > fields[0].largest_mises_mpa());
    // depth 0.5 % below the ball's surface at most: the penalty's penetration
    for field in &fields {
        let axis = field.position_mm(field.top[0][0])[1];
        let lowest = field.height_mm - field.step.depth_mm;
        assert!((axis - lowest).abs() < 0.02 * field.step.depth_mm, "{axis} {lowest}");
    }
}

/// While the ball is held on a material whose shear and bulk relax alike, stretches stay and every stress
/// relaxes like the modulus.
#[test]
fn stress_of_a_relaxing_material_falls_at_fixed_stretch() {
    let series = vec![PronyTerm { g: 0.5, k: 0.5, tau_s: 1.0 }];
    let material = lut_gen::solid::law::Material::from(Hyperfoam::one_term(0.1, 6.0).unwrap()).relaxing(series.clone());
    let simulation = Simulation {
        material: material.unwrap(),
        motion: Motion::ramp(2.0, 1e4).hold(3.0),
        ..Indentation { resolution: Resolution::Refined(0.4), ..eva(2.0) }.simulation()
    };
    let fields = simulation.fields().unwrap();
    let held: Vec<&Field> = fields.iter().filter(|f| f.step.depth_mm > 2.0 - 1e-9).collect();
    let (first, last) = (held[0], held[held.len() - 1]);
    let expected = relaxed(&series, last.step.time_s) / relaxed(&series, first.step.time_s);
    let ratio = last.largest_mises_mpa() / first.largest_mises_mpa();
    // the ramp takes 2e-4 of the relaxation time; the penalty, which does not relax, is left
    assert!(held.len() > 5 && expected < 0.6 && (ratio / expected - 1.0).abs() < 5e-3, "{ratio} {expected}");
    for (a, b) in first.state.iter().zip(&last.state) {
        assert!((a.volume_ratio() - b.volume_ratio()).abs() < 5e-3);
    }
}

#[test]
fn adhesion_pulls_around_the_contact() {
    let adhesion = Some(Adhesion { work_n_per_mm: 2e-3, range_mm: 0.05 });
    let simple = Indentation { resolution: Resolution::Refined(0.6), ..eva(1.0) }.simulation();
    let sticky = Simulation { interface: Interface { friction: 0.0, adhesion }, ..simple.clone() };
    let least = |s: &Simulation| {
        let fields = s.fields().unwrap();
        fields.last().unwrap().pressure_mpa.iter().copied().fold(f64::INFINITY, f64::min)
    };
    assert_eq!(least(&simple), 0.0);
    assert!(least(&sticky) < -1e-3, "{}", least(&sticky));
}

/// Elements of an XML text: name, attributes, text up to the next tag. Fails on tags that do not match.
fn elements(xml: &str) -> Vec<(String, BTreeMap<String, String>, String)> {
    let mut open: Vec<String> = Vec::new();
    let mut found = Vec::new();
    for piece in xml.split('<').skip(1) {
        let (tag, text) = piece.split_once('>').expect("tag is closed");
        if tag.starts_with('?') {
            continue;
        }
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop().as_deref(), Some(name), "closing tag matches");
            continue;
        }
        let (name, rest) = tag.trim_end_matches('/').split_once(' ').unwrap_or((tag, ""));
        let parts: Vec<&str> = rest.split('"').collect();
        let attributes =
            parts.chunks_exact(2).map(|p| (p[0].trim().trim_end_matches('=').to_owned(), p[1].to_owned())).collect();
        found.push((name.to_owned(), attributes, text.to_owned()));
        if !tag.ends_with('/') {
            open.push(name.to_owned());
        }
    }
    assert!(open.is_empty(), "{open:?} left open");
    found
}

fn data(xml: &str, name: &str) -> Vec<f64> {
    let all = elements(xml);
    let (_, _, text) =
        all.iter().find(|(tag, at, _)| tag == "DataArray" && at["Name"] == name).unwrap_or_else(|| panic!("no {name}"));
    text.split_whitespace().map(|word| word.parse().unwrap()).collect()
}

#[test]
fn files_read_back_hold_every_value() {
    let coarse = Indentation { resolution: Resolution::Refined(0.4), ..eva(2.0) };
    let fields = coarse.fields_at(&[1.0, 2.0]).unwrap();
    let field = &fields[1];
    let xml = vtu::block(field);
    let all = elements(&xml);
    let (_, piece, _) = all.iter().find(|e| e.0 == "Piece").unwrap();
    assert_eq!(piece["NumberOfPoints"], field.nodes.len().to_string());
    assert_eq!(piece["NumberOfCells"], field.elements.len().to_string());
    // text is exact: the same numbers come back
    let points: Vec<f64> =
        (0..field.nodes.len()).flat_map(|n| [field.position_mm(n)[0], field.position_mm(n)[1], 0.0]).collect();
    assert_eq!(data(&xml, "position_mm"), points);
    let numbers: Vec<f64> = field.elements.iter().flatten().map(|n| *n as f64).collect();
    assert_eq!(data(&xml, "connectivity"), numbers);
    let offsets: Vec<f64> = (1..=field.elements.len()).map(|i| (8 * i) as f64).collect();
    assert_eq!(data(&xml, "offsets"), offsets);
    assert!(data(&xml, "types").iter().all(|t| *t == 23.0) && data(&xml, "types").len() == field.elements.len());
    let mises: Vec<f64> = field.state.iter().map(|s| s.mises_mpa()).collect();
    assert_eq!(data(&xml, "mises_MPa"), mises);
    assert_eq!(data(&xml, "stretch").len(), 3 * field.nodes.len());
    assert_eq!(data(&xml, "cauchy_MPa").len(), 6 * field.nodes.len());
    assert_eq!(data(&xml, "displacement_mm").len(), 3 * field.nodes.len());
    assert_eq!(data(&xml, "contact_pressure_MPa"), field.pressure_mpa);
    assert_eq!(data(&xml, "depth_mm"), [2.0]);
    assert_eq!(data(&xml, "force_N"), [field.step.force_n]);
    // VTK's order: corners counter-clockwise, then the middle of each side
    let points = data(&xml, "position_mm");
    let cell: Vec<usize> = data(&xml, "connectivity")[..8].iter().map(|n| *n as usize).collect();
    let at = |i: usize| [points[3 * cell[i]], points[3 * cell[i] + 1]];
    let turn: f64 = (0..4).map(|i| at(i)[0] * at((i + 1) % 4)[1] - at((i + 1) % 4)[0] * at(i)[1]).sum();
    assert!(turn > 0.0);
    for i in 0..4 {
        let (a, b, middle) = (at(i), at((i + 1) % 4), at(4 + i));
        // sides bend under the ball, but less than a fifth of their length
        let side = (a[0] - b[0]).hypot(a[1] - b[1]);
        assert!((0..2).all(|k| (0.5 * (a[k] + b[k]) - middle[k]).abs() < 0.2 * side));
    }

    let outline = data(&vtu::ball(field), "position_mm");
    assert_eq!(outline[..3], [0.0, field.height_mm - 2.0, 0.0]);
    let files = [(1.0, "a&b.vtu".to_owned(), "c.vtu".to_owned())];
    let series = elements(&vtu::collection(&files));
    let sets: Vec<_> = series.iter().filter(|e| e.0 == "DataSet").collect();
    assert_eq!(sets.len(), 2);
    assert_eq!((sets[0].1["timestep"].as_str(), sets[0].1["file"].as_str()), ("1", "a&amp;b.vtu"));
    assert_eq!((sets[1].1["part"].as_str(), sets[1].1["file"].as_str()), ("1", "c.vtu"));
}
