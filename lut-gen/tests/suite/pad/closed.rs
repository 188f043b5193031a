//! Closed forms of the print and of the fingertip as a sphere, and the stretched finger.

use lut_gen::pad::body::finger::Finger;
use lut_gen::pad::body::section::Section;
use lut_gen::pad::contact::rigid::{Rigid, Shape};
use lut_gen::pad::ellipse::cap_area_mm2;
use lut_gen::pad::hertz::{Elastic, FINGERTIP, RIGID};
use lut_gen::pad::press::{Press, Side};

use super::reference;

/// Thesis Eqs. 36 and 37 as corrected; the reference prints nine digits of a quadrature that is
/// right to 1e-8.
#[test]
fn caps_of_ellipsoids_have_the_areas_of_the_reference() {
    let Some(rows) = reference("ellipsoid_cap.csv") else { return };
    assert!(!rows.is_empty());
    for row in rows {
        let area = cap_area_mm2([row[0], row[1], row[2]], row[3]).unwrap();
        assert!((area / row[4] - 1.0).abs() < 1e-6, "{row:?}: {area}");
    }
}

/// Thesis Eqs. 50 to 52 to the eight digits of the reference.
#[test]
fn the_fingertip_as_a_sphere() {
    let Some(rows) = reference("hertz_fingertip.csv") else { return };
    assert!(!rows.is_empty());
    for row in rows {
        let foam = Elastic { young_mpa: row[1], nu: 0.0 };
        let own = [
            FINGERTIP.radius_mm(RIGID, row[0]),
            FINGERTIP.travel_mm(RIGID, row[0]),
            FINGERTIP.radius_mm(foam, row[0]),
            FINGERTIP.travel_mm(foam, row[0]),
        ];
        for (own, theirs) in own.iter().zip(&row[2..6]) {
            assert!((own / theirs - 1.0).abs() < 1e-7, "{row:?}: {own}");
        }
        assert!((FINGERTIP.force_n(foam, own[3]) / row[0] - 1.0).abs() < 1e-12);
        assert!((own[3] - own[1] - row[6]).abs() < 1e-7 * row[5], "{row:?}");
    }
}

/// A stretched finger has the same height and layers, and is wider.
#[test]
fn a_stretched_finger_is_stiffer_in_a_ring() {
    let round = Finger { edge_mm: 0.4, ..Finger::round().unwrap() };
    let force = |finger: &Finger| {
        let plate = Rigid { shape: Shape::Plate, tip_mm: -finger.height_mm };
        let press = Press::new(Section::Ring, Side::Soft(finger.body().unwrap()), Side::Rigid(plate));
        press.solve(&[1.0]).unwrap()[0].force_n
    };
    let wide = round.stretched(1.2);
    assert!((wide.half_width_mm, wide.bone_half_width_mm) == (1.2 * 8.0, 1.2 * 3.0) && wide.height_mm == 8.0);
    assert!(force(&wide) > force(&round));
}
