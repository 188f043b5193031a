//! Bodies whose yield stress follows a programme.

use lut_gen::pad::body::Body;
use lut_gen::pad::body::block::Block;
use lut_gen::pad::body::finger::Finger;
use lut_gen::pad::body::section::Section;
use lut_gen::pad::contact::rigid::{Rigid, Shape};
use lut_gen::pad::law::material::Material;
use lut_gen::pad::law::plastic::Plastic;
use lut_gen::pad::press::{Now, Press, Side};

use super::{reference, timed};

/// A cylinder of radius 20 mm and height 25.4 mm between slippery plates, whose yield stress is a
/// cubic of the travel.
fn homogeneous(name: &str, cubic: [f64; 4]) {
    let Some(rows) = reference(name) else { return };
    let block = Block {
        height_mm: 25.4,
        radius_mm: 20.0,
        top_mm: 0.0,
        bonded: false,
        material: Material::Plastic(Plastic::new(0.1, 0.3).unwrap()),
        edge_mm: 12.0,
        fine_mm: 20.0,
    };
    let plate = Rigid { shape: Shape::Plate, tip_mm: 0.0 };
    let mut press = Press::new(Section::Ring, Side::Rigid(plate), Side::Soft(block.body().unwrap()));
    let yields = |now: Now| {
        let u = now.travel_mm;
        cubic[0] + u * (cubic[1] + u * (cubic[2] + u * cubic[3]))
    };
    press.yields = &yields;
    // stress over penetration: 1e-7 mm at 0.004 MPa
    press.penalty_mpa_per_mm = Some(4e4);
    let travels: Vec<f64> = rows.iter().map(|r| r[0]).collect();
    let states = timed(&press, &travels);
    let mut worst: f64 = 0.0;
    for (row, state) in rows.iter().zip(&states) {
        worst = worst.max((state.force_n / row[3] - 1.0).abs());
    }
    println!("{name}: {worst:.1e}");
    assert!(worst < 1e-4, "{name}: {worst}");
}

#[test]
fn yielding_cylinders_give_their_curve_back() {
    homogeneous("plastic_H1_const.csv", [0.004, 0.0, 0.0, 0.0]);
    homogeneous("plastic_H2_poly.csv", [1e-3, 2e-4, 5e-5, 1e-5]);
}

#[test]
fn ball_into_a_plastic_cylinder() {
    let Some(rows) = reference("plastic_sphere_P2.csv") else { return };
    let block = Block {
        height_mm: 10.0,
        radius_mm: 18.0,
        top_mm: 0.0,
        bonded: true,
        material: Material::Plastic(Plastic::new(0.1, 0.3).unwrap()),
        edge_mm: 0.2,
        fine_mm: 6.0,
    };
    let ball = Rigid { shape: Shape::Ball { radius_mm: 6.0 }, tip_mm: 0.0 };
    let mut press = Press::new(Section::Ring, Side::Rigid(ball), Side::Soft(block.body().unwrap()));
    press.yields = &|_| 0.004;
    press.step_mm = 0.1;
    let travels: Vec<f64> = rows.iter().map(|r| r[0]).collect();
    for (row, state) in rows.iter().zip(timed(&press, &travels)) {
        let force = state.force_n / row[1] - 1.0;
        println!("{:.1} mm: force {:+.3} %, plastic strain {:.3}", row[0], 100.0 * force, state.plastic_strain);
        // single points of the reference's two meshes differ by up to 1.6 %
        assert!(force.abs() < 2e-2, "{row:?}: {}", state.force_n);
    }
}

fn yielding(top_mm: f64, edge_mm: f64) -> Body {
    let block = Block {
        height_mm: 25.4,
        radius_mm: 25.0,
        top_mm,
        bonded: false,
        material: Material::Plastic(Plastic::new(0.1, 0.3).unwrap()),
        edge_mm,
        fine_mm: 7.0,
    };
    block.body().unwrap()
}

/// A control curve that rises. Two meshes differ by 1 %; below the yield stress the block is
/// elastic to the bit.
#[test]
fn finger_on_a_yielding_block() {
    let finger = Finger { edge_mm: 0.3, ..Finger::round().unwrap() };
    let block = yielding(-finger.height_mm, 0.4);
    let mut press = Press::new(Section::Ring, Side::Soft(finger.body().unwrap()), Side::Soft(block));
    press.yields = &|_| 1.0;
    let never = timed(&press, &[0.4]);
    press.yields = &|_| f64::INFINITY;
    assert_eq!(never[0].force_n, press.solve(&[0.4]).unwrap()[0].force_n);
    press.yields = &|now| 0.001 + 0.0004 * now.travel_mm + 0.0001 * now.travel_mm.powi(2);
    let states = timed(&press, &[0.8, 1.6, 2.4]);
    for (state, finer) in states.iter().zip([0.10110, 0.29720, 0.57771]) {
        println!("{:.1} mm: {:.5} N, plastic strain {:.3}", state.travel_mm, state.force_n, state.plastic_strain);
        assert!((state.force_n / finer - 1.0).abs() < 2e-2, "{} {}", state.travel_mm, state.force_n);
    }
}

/// Pressed and let go: an elastic block gives every force back, one that yields keeps a dent.
#[test]
fn a_block_that_yielded_keeps_a_dent() {
    let finger = Finger { edge_mm: 0.4, ..Finger::round().unwrap() };
    let block = yielding(-finger.height_mm, 0.5);
    let mut press = Press::new(Section::Ring, Side::Soft(finger.body().unwrap()), Side::Soft(block));
    let motion = [[1.0, 1.0], [1.5, 1.5], [2.0, 1.0], [3.0, 0.0]];
    let motion = motion.map(|[time_s, travel_mm]| Now { time_s, travel_mm, force_n: 0.0 });
    for yields in [false, true] {
        press.yields = if yields { &|_| 0.003 } else { &|_| f64::INFINITY };
        let states = press.follow(&motion).unwrap();
        let forces: Vec<f64> = states.iter().map(|s| s.force_n).collect();
        let dent = states[3].depression_mm;
        println!("{forces:.6?} N, dent {dent:.4} mm, plastic strain {:.3}", states[3].plastic_strain);
        let block = &states[1].mises_mpa[states[1].lower..];
        let largest = block.iter().copied().fold(0.0, f64::max);
        // rounding of a touch without penetration
        assert!(forces[3] < 1e-15, "{forces:?}");
        if yields {
            assert!(forces[2] < 0.8 * forces[0] && dent > 0.1 && largest <= 0.003);
        } else {
            assert!((forces[2] / forces[0] - 1.0).abs() < 1e-5 && dent.abs() < 1e-6 && largest > 0.003);
        }
    }
}
