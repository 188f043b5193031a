//! What elements leave of the force.

use lut_gen::pad::body::finger::Finger;
use lut_gen::pad::body::section::{Rule, Section};
use lut_gen::pad::contact::rigid::{Rigid, Shape};
use lut_gen::pad::law::material::Material;
use lut_gen::pad::law::ogden::{BULK_OF_0475, Ogden};
use lut_gen::pad::press::{Press, Side};

use super::timed;

/// Force (N/mm) of the round finger of a bulk over shear modulus at 1 mm on the plate.
fn force_at_1_mm(bulk: f64, rule: Rule, edge_mm: f64) -> f64 {
    let neo = |mu: f64| Material::Ogden(Ogden::neo_hooke(mu, bulk * mu).unwrap());
    let finger = Finger { edge_mm, skin: neo(0.08), tissue: neo(0.012), ..Finger::round().unwrap() };
    let plate = Rigid { shape: Shape::Plate, tip_mm: -finger.height_mm };
    let mut press = Press::new(Section::Plane, Side::Soft(finger.body().unwrap()), Side::Rigid(plate));
    press.rule = rule;
    timed(&press, &[1.0])[0].force_n
}

/// Poisson's ratio 0.4999: four points leave 0.5 % between elements of 0.4 and 0.2 mm, nine err by
/// 8 %. That is why elements have four points (as in the indentation, and in one of the
/// references).
#[test]
fn tissue_that_hardly_changes_its_volume_does_not_lock() {
    let [coarse, fine] = [0.4, 0.2].map(|edge| force_at_1_mm(5000.0, Rule::Reduced, edge));
    let full = force_at_1_mm(5000.0, Rule::Full, 0.4);
    println!("{coarse} {fine} {full}");
    assert!((coarse / fine - 1.0).abs() < 1e-2 && full / fine - 1.0 > 5e-2);
}

/// Errors against elements of 0.1 mm (0.091481 N/mm): halved elements have less than half of it,
/// until the edge of the contact inside an element is all that is left (1e-4).
#[test]
fn the_force_converges_with_the_mesh() {
    let errors = [0.8, 0.4, 0.2].map(|edge| (force_at_1_mm(BULK_OF_0475, Rule::Reduced, edge) / 0.091481 - 1.0).abs());
    println!("{errors:?}");
    assert!(errors[0] < 5e-3 && errors[1] < 0.7 * errors[0] && errors[2] < 3e-4);
}
