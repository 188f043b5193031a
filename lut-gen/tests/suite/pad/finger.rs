//! The finger on a plate and on foam.

use lut_gen::fem::sparse::HELD;
use lut_gen::pad::body::block::Block;
use lut_gen::pad::body::finger::Finger;
use lut_gen::pad::body::section::Section;
use lut_gen::pad::contact::friction::Friction;
use lut_gen::pad::contact::rigid::{Rigid, Shape};
use lut_gen::pad::error::PadError;
use lut_gen::pad::law::foam::Foam;
use lut_gen::pad::law::material::Material;
use lut_gen::pad::law::ogden::{BULK_OF_0475, Ogden};
use lut_gen::pad::law::relaxing::{Elastic, Relaxing};
use lut_gen::pad::model::Moment;
use lut_gen::pad::press::{Now, Press, Side};
use lut_gen::pad::state::State;

use super::{foam, reference, timed};

fn on_plate(section: Section, edge_mm: f64, penalty: Option<f64>, travels: &[f64]) -> Vec<State> {
    let finger = Finger { edge_mm, ..Finger::round().unwrap() };
    let plate = Rigid { shape: Shape::Plate, tip_mm: -finger.height_mm };
    let mut press = Press::new(section, Side::Soft(finger.body().unwrap()), Side::Rigid(plate));
    press.penalty_mpa_per_mm = penalty;
    let start = std::time::Instant::now();
    let states = press.solve(travels).unwrap();
    println!(
        "{section:?} edge {edge_mm}: {} unknowns, {} steps, {:.2} s",
        press.model().unwrap().unknowns(),
        states.iter().map(|s| s.steps).sum::<usize>(),
        start.elapsed().as_secs_f64()
    );
    states
}

/// Forces and half widths on the plate. Force: 0.5 % from 0.8 mm on; the references differ from
/// each other by 0.1 to 0.3 %. Half width: 0.05 mm, of which 0.03 are the reference's.
fn finger_on_plate(section: Section, name: &str, penalty: Option<f64>) {
    let Some(rows) = reference(name) else { return };
    let travels: Vec<f64> = rows.iter().map(|r| r[0]).collect();
    for (row, state) in rows.iter().zip(on_plate(section, 0.125, penalty, &travels)) {
        let (force, half) = (state.force_n / row[1] - 1.0, state.half_width_mm - row[2]);
        println!("{:.1} mm: force {:+.3} %, half width {half:+.4} mm", row[0], 100.0 * force);
        assert!(row[0] < 0.75 || force.abs() < 5e-3, "{row:?}: {}", state.force_n);
        assert!(half.abs() < 0.05, "{row:?}: {}", state.half_width_mm);
    }
}

#[test]
fn finger_on_a_plate_in_the_plane() {
    finger_on_plate(Section::Plane, "finger_F1_ps.csv", Some(100.0));
    finger_on_plate(Section::Plane, "finger_F1_ps.csv", None);
}

#[test]
fn finger_on_a_plate_about_an_axis() {
    finger_on_plate(Section::Ring, "finger_F1_axi.csv", None);
}

/// Force: 1 % beyond the first half millimetre, where the reference's own meshes differ by 0.4 %;
/// but 2 % at 1.2 mm, where the reference lies 0.8 % below the cubic through its neighbours (ours
/// 0.2 %) and ours do not move with mesh, penalty or side (0.0853 to 0.0854 N). Radius: the 0.3 mm
/// of the reference, whose edge is read at nodes, up to 3.6 mm; at 4 mm our edge is 0.39 mm further
/// out at a pressure of half that in the middle.
#[test]
fn finger_on_foam() {
    let Some(rows) = reference("finger_F1_on_ICF.csv") else { return };
    let travels: Vec<f64> = rows.iter().map(|r| r[0]).collect();
    let finger = Finger { edge_mm: 0.2, ..Finger::round().unwrap() };
    let press = Press::new(Section::Ring, Side::Soft(finger.body().unwrap()), Side::Soft(foam(-finger.height_mm, 0.3)));
    for (row, state) in rows.iter().zip(timed(&press, &travels)) {
        let (force, a) = (state.force_n / row[1] - 1.0, state.half_width_mm - row[2]);
        println!(
            "{:.1} mm: force {:+.3} %, a {a:+.3} mm, cap {:+.3} mm, area {:+.1} %, pressed in {:+.4} mm",
            row[0],
            100.0 * force,
            state.cap_mm - row[3],
            100.0 * (state.area_mm2 / row[4] - 1.0),
            state.depression_mm - row[5],
        );
        let within = if (row[0] - 1.2).abs() < 0.1 { 2e-2 } else { 1e-2 };
        assert!(row[0] < 0.5 || force.abs() < within, "{row:?}: {}", state.force_n);
        assert!(row[0] > 3.7 || a.abs() < 0.3, "{row:?}: {}", state.half_width_mm);
    }
}

/// The layers of the thesis' Table 5 in its stable reading, skin and tissue; bulk moduli of
/// Poisson's ratio 0.475.
fn table_5() -> [Material; 2] {
    let skin = [(6.37e-3, 1.3416), (1.88e-4, 25.0), (-3.77e-3, -7.85), (1.84e-3, -10.89)];
    let tissue = [(2.35e-2, -2.06), (4.54e-5, 25.0), (-4.08e-2, -3.47), (1.93e-2, -4.48)];
    [skin, tissue].map(|terms| {
        let sum: f64 = terms.iter().map(|t| t.0).sum();
        Material::Ogden(Ogden::new(&terms, BULK_OF_0475 * sum).unwrap())
    })
}

/// Indicative, against one coarse mesh: within 3 % from 0.6 mm on, and its contact's edge within
/// its elements of 0.4 mm.
#[test]
fn four_ogden_terms_on_a_plate() {
    let Some(rows) = reference("finger_F3_axi_ogden_table5.csv") else { return };
    let rows: Vec<_> = rows.into_iter().skip(3).step_by(4).collect();
    let [skin, tissue] = table_5();
    let travels: Vec<f64> = rows.iter().map(|r| r[0]).collect();
    let finger = Finger { skin, tissue, edge_mm: 0.2, ..Finger::round().unwrap() };
    let plate = Rigid { shape: Shape::Plate, tip_mm: -finger.height_mm };
    let press = Press::new(Section::Ring, Side::Soft(finger.body().unwrap()), Side::Rigid(plate));
    for (row, state) in rows.iter().zip(timed(&press, &travels)) {
        let (force, half) = (state.force_n / row[1] - 1.0, state.half_width_mm - row[2]);
        println!("{:.2} mm: force {:+.3} %, half width {half:+.3} mm", row[0], 100.0 * force);
        assert!(row[0] < 0.55 || force.abs() < 3e-2, "{row:?}: {}", state.force_n);
        assert!(half.abs() < 0.2, "{row:?}: {}", state.half_width_mm);
    }
}

/// The same layers on the softest foam.
#[test]
fn four_ogden_terms_on_foam() {
    let [skin, tissue] = table_5();
    let finger = Finger { skin, tissue, edge_mm: 0.3, ..Finger::round().unwrap() };
    let foam = foam(-finger.height_mm, 0.4);
    let press = Press::new(Section::Ring, Side::Soft(finger.body().unwrap()), Side::Soft(foam));
    let states = timed(&press, &[1.0, 2.0, 3.0, 4.0]);
    for s in &states {
        println!("{} {} {}", s.travel_mm, s.force_n, s.half_width_mm);
    }
    assert!(states.windows(2).all(|w| w[1].force_n > w[0].force_n && w[1].half_width_mm > w[0].half_width_mm));
}

/// A finger whose skin and tissue relax on a plate: pressed at once it is the elastic one, held for
/// long it is the one with what is left of the shear moduli, whatever it went through.
#[test]
fn a_held_finger_relaxes() {
    let neo = |mu: f64, left: f64| Ogden::neo_hooke(left * mu, BULK_OF_0475 * mu).unwrap();
    let finger = |of: &dyn Fn(f64) -> Material| {
        let finger = Finger { edge_mm: 0.4, skin: of(0.08), tissue: of(0.012), ..Finger::round().unwrap() };
        let plate = Rigid { shape: Shape::Plate, tip_mm: -finger.height_mm };
        let mut press = Press::new(Section::Ring, Side::Soft(finger.body().unwrap()), Side::Rigid(plate));
        // its default follows the shear modulus at once
        press.penalty_mpa_per_mm = Some(200.0);
        press
    };
    let relaxing = |mu: f64| Relaxing::new(Elastic::Ogden(neo(mu, 1.0)), &[(0.3, 0.5), (0.2, 8.0)]).unwrap();
    let at = |time_s: f64| Now { time_s, travel_mm: 1.0, force_n: 0.0 };
    let mut soft = finger(&|mu| Material::Relaxing(relaxing(mu)));
    // longer steps for the slow end
    let quick = soft.follow(&[at(0.0), at(0.25), at(0.5), at(2.0)]).unwrap();
    soft.step_s = 10.0;
    let long = soft.follow(&[at(0.0), at(200.0)]).unwrap();
    let elastic = |left: f64| finger(&|mu| Material::Ogden(neo(mu, left))).solve(&[1.0]).unwrap()[0].force_n;
    let (instant, left) = (elastic(1.0), elastic(0.5));
    println!("{:?}, {} for {left}", quick.iter().map(|s| s.force_n).collect::<Vec<_>>(), long[1].force_n);
    // to the residual that ends a solve
    assert!((quick[0].force_n / instant - 1.0).abs() < 1e-5 && (long[1].force_n / left - 1.0).abs() < 1e-5);
    // between, the volume does not relax with the shape: the force follows the series to 4 %
    for state in &quick {
        let part = 0.5 + 0.3 * f64::exp(-state.time_s / 0.5) + 0.2 * f64::exp(-state.time_s / 8.0);
        assert!((state.force_n / instant / part - 1.0).abs() < 0.04, "{}: {}", state.time_s, state.force_n);
    }
}

/// Where tissue would have to vanish there is no equilibrium, and the press says how far it came.
#[test]
fn a_press_through_the_bone_gets_stuck() {
    let finger = Finger { edge_mm: 0.8, ..Finger::round().unwrap() };
    let plate = Rigid { shape: Shape::Plate, tip_mm: -8.0 };
    let press = Press::new(Section::Plane, Side::Soft(finger.body().unwrap()), Side::Rigid(plate));
    let error = press.solve(&[5.5]).unwrap_err();
    println!("{error}");
    assert!(matches!(error, PadError::Stuck { reached_mm, .. } if reached_mm > 4.0 && reached_mm < 5.5));
}

/// Values from outside that make no press.
#[test]
fn presses_that_cannot_be_made_are_named() {
    let finger = Side::Soft(Finger::round().unwrap().body().unwrap());
    let plate = Rigid { shape: Shape::Plate, tip_mm: -8.0 };
    let mut press = Press::new(Section::Plane, finger, Side::Rigid(plate));
    let text = press.solve(&[0.5, 0.2]).unwrap_err().to_string();
    assert_eq!(text, "a travel (mm) is 0.2: expected numbers that rise from 0");
    press.penalty_mpa_per_mm = Some(-1.0);
    let text = press.solve(&[0.5]).unwrap_err().to_string();
    assert_eq!(text, "the penalty (MPa/mm) is -1: expected more than 0");
    let nothing = Press::new(Section::Plane, Side::Rigid(plate), Side::Rigid(plate));
    let text = nothing.solve(&[0.5]).unwrap_err().to_string();
    assert_eq!(text, "the number of soft bodies is 0: expected 1 or 2");
}

/// Fingers of other measures and layers on foams from the softest to the stiffest of the thesis,
/// with and without friction, in the plane and about an axis: all find their way to 2 mm, and
/// forces rise. Every eleventh by default; all with `--include-ignored` (a minute).
fn every_finger_on_every_foam(each: usize) {
    let [skin, tissue] = table_5();
    let round = || Finger { edge_mm: 0.4, ..Finger::round().unwrap() };
    let oval = Finger {
        half_width_mm: 9.0,
        height_mm: 7.0,
        nail_deg: 30.0,
        bone_above_mm: 1.0,
        bone_half_width_mm: 4.0,
        bone_half_height_mm: 2.5,
        ..round()
    };
    let fingers = [round(), oval, Finger { skin, tissue, ..round() }];
    let foams = [(0.0137, 14.8), (0.22, 10.53), (0.188, 11.16), (0.05, 6.0), (0.003, 2.0)];
    for case in (0..60).step_by(each) {
        let (finger, foam) = (&fingers[case % 3], foams[case / 3 % 5]);
        let section = [Section::Plane, Section::Ring][case / 15 % 2];
        let coefficient = [0.0, 0.5][case / 30];
        let block = Block {
            height_mm: 19.05,
            radius_mm: 25.0,
            top_mm: -finger.height_mm,
            bonded: true,
            material: Material::Foam(Foam::one_term(foam.0, foam.1, 0.0).unwrap()),
            edge_mm: 0.5,
            fine_mm: 7.0,
        };
        let mut press = Press::new(section, Side::Soft(finger.body().unwrap()), Side::Soft(block.body().unwrap()));
        press.friction = Some(Friction { coefficient, creep_mm: 1e-4 });
        let states = timed(&press, &[0.5, 1.0, 2.0]);
        let forces: Vec<f64> = states.iter().map(|s| s.force_n).collect();
        println!("finger {}, foam {foam:?}, {section:?}, friction {coefficient}: {forces:.4?}", case % 3);
        assert!(forces[0] > 0.0 && forces.windows(2).all(|w| w[1] > 1.5 * w[0]), "{case}");
    }
}

#[test]
fn some_fingers_on_some_foams() {
    every_finger_on_every_foam(11);
}

#[test]
#[ignore = "a minute"]
fn all_fingers_on_all_foams() {
    every_finger_on_every_foam(1);
}

/// The bone and the nail bear what the contact gives.
#[test]
fn the_bone_bears_the_force_of_the_contact() {
    let finger = Finger { edge_mm: 0.4, ..Finger::round().unwrap() };
    let plate = Rigid { shape: Shape::Plate, tip_mm: -finger.height_mm };
    let press = Press::new(Section::Ring, Side::Soft(finger.body().unwrap()), Side::Rigid(plate));
    let travel_mm = 1.0;
    let state = &press.solve(&[travel_mm]).unwrap()[0];
    let model = press.model().unwrap();
    // in the finger's own frame
    let own = |(now, was): (&[f64; 2], &[f64; 2])| [now[0] - was[0], now[1] - was[1] + travel_mm];
    let u: Vec<f64> = state.nodes.iter().zip(&model.nodes).flat_map(own).collect();
    let moment = Moment { travel_mm, yield_mpa: 0.0, step_s: 0.0, old: &[] };
    let laws: Vec<_> = (0..model.materials.len()).map(|m| model.matter(m, &moment)).collect();
    let mut bone = 0.0;
    let held = |dofs: &[usize; 16], force: &[f64; 16]| {
        bone -= (0..8).filter(|a| dofs[2 * a + 1] == HELD).map(|a| force[2 * a + 1]).sum::<f64>();
    };
    model.domain.forces(|e| Some(&laws[model.of[e]]), &[], None, &model.values(&u), held).unwrap();
    println!("{bone} N on the bone, {} N on the plate", state.force_n);
    // the residual that ends a solve is 1e-6 of the force, in every direction
    assert!((bone / state.force_n - 1.0).abs() < 1e-5);
}
