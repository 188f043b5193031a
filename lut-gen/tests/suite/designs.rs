//! Magnets as drawings: scaling laws, energies, and any geometry.
#![allow(clippy::expect_used, clippy::unwrap_used)]

use lut_gen::fem::triangle::Order;
use lut_gen::magnet::bh::{Between, Law};
use lut_gen::magnet::design::{Coil, Design, Edge, Mirror, Region};
use lut_gen::magnet::field::Geometry;
use lut_gen::magnet::material;
use lut_gen::magnet::shape::Shape;
use lut_gen::magnet::study::{State, Wanted};
use lut_gen::magnet::winding::Winding;
use proptest::prelude::*;

fn winding(turns: f64) -> Winding {
    Winding { turns, wire_mm: 0.32, insulated_mm: 0.36, turn_mm: 30.0, room_c: 25.0, limit_c: 130.0, cooling_w_k: 0.05 }
}

fn region(name: &str, shape: Shape, law: Law) -> Region {
    Region {
        name: name.into(),
        shapes: vec![shape],
        without: Vec::new(),
        law,
        coercive: [0.0; 2],
        coil: None,
        size_mm: None,
    }
}

fn steel() -> Law {
    material::named("1018 steel", Between::Monotone).unwrap().unwrap()
}

fn fluid() -> Law {
    material::named("MRF-122EG", Between::Monotone).unwrap().unwrap()
}

/// A C of steel with a gap and a coil around its back, everything `scale` times as large, moved and turned at will.
fn c_core(scale: f64, gap: f64, law: Law) -> Design {
    let mut core = region(
        "core",
        Shape::Ring { centre: [0.0; 2], radii: [10.0, 14.0].map(|r| scale * r), degrees: [0.0, 360.0] },
        law,
    );
    core.without = vec![Shape::Rectangle([-0.5 * gap * scale, 0.0], [0.5 * gap * scale, 20.0 * scale])];
    let wound = |name: &str, radii: [f64; 2], sense: f64| {
        let shape = Shape::Ring { centre: [0.0; 2], radii: radii.map(|r| scale * r), degrees: [180.0, 360.0] };
        Region { coil: Some((0, sense)), ..region(name, shape, Law::Linear(1.0)) }
    };
    Design {
        geometry: Geometry::Plane,
        depth_mm: 6.0 * scale,
        out_of_plane: None,
        mirror: None,
        edge: Edge::Round { radius: 80.0 * scale },
        regions: vec![core, wound("in", [8.0, 10.0], 1.0), wound("out", [14.0, 15.5], -1.0)],
        coils: vec![Coil { name: "winding".into(), winding: winding(500.0), share: 1.0 }],
    }
}

fn solved(design: &Design, at: [f64; 2], currents: &[f64]) -> Vec<State> {
    let wanted = Wanted { points: vec![at], coarser: 1.5, ..Wanted::default() };
    design.study(&wanted, currents, &mut |_| {}).unwrap().states
}

#[test]
fn a_magnet_of_twice_the_size_with_twice_the_ampere_turns_has_the_same_field() {
    let one = solved(&c_core(1.0, 3.0, steel()), [0.0, 12.0], &[2.0]);
    let two = solved(&c_core(2.0, 3.0, steel()), [0.0, 24.0], &[4.0]);
    assert!((two[0].points[0].size_t() / one[0].points[0].size_t() - 1.0).abs() < 1e-6);
    // Linkage is flux density times area.
    assert!((two[0].linkage_wb[0].value / (4.0 * one[0].linkage_wb[0].value) - 1.0).abs() < 1e-6);
    let mut wound = c_core(1.0, 3.0, steel());
    wound.coils[0].winding.turns = 1000.0;
    let same = solved(&wound, [0.0, 12.0], &[1.0]);
    assert!((same[0].points[0].size_t() / one[0].points[0].size_t() - 1.0).abs() < 1e-6);
    assert!((same[0].linkage_wb[0].value / (2.0 * one[0].linkage_wb[0].value) - 1.0).abs() < 1e-6);
}

/// A boundary at 80 mm in closed form, and one that triangles reach because something without effect lies before it.
#[test]
fn the_field_beyond_the_mesh_is_that_of_triangles() {
    let closed = c_core(1.0, 3.0, steel());
    let mut meshed = closed.clone();
    let air = Shape::Ring { centre: [0.0; 2], radii: [20.0, 76.0], degrees: [0.0, 360.0] };
    meshed.regions.insert(0, Region { size_mm: Some(3.0), ..region("air", air, Law::Linear(1.0)) });
    assert!(closed.around().is_some() && meshed.around().is_none());
    let inside = [[0.0, 12.0], [0.0, -12.0], [17.0, 3.0]];
    let beyond = [[30.0, 10.0], [-5.0, 60.0]];
    let wanted = Wanted { points: inside.into_iter().chain(beyond).collect(), ..Wanted::default() };
    let of = |design: &Design| design.study(&wanted, &[0.3, 2.0], &mut |_| {}).unwrap().states;
    for (a, b) in of(&closed).iter().zip(&of(&meshed)) {
        for (i, (a, b)) in a.points.iter().zip(&b.points).enumerate() {
            let off = (a.b_t[0] - b.b_t[0]).hypot(a.b_t[1] - b.b_t[1]);
            assert!(off < 1e-3 * b.size_t(), "point {i}: {:?} {:?}", a.b_t, b.b_t);
        }
        assert!((a.energy_j.value / b.energy_j.value - 1.0).abs() < 3e-4);
        assert!((a.linkage_wb[0].value / b.linkage_wb[0].value - 1.0).abs() < 3e-4);
    }
}

/// A ring with its gap on the mirror, and two coils side by side: half of it, and all of it.
#[test]
fn half_a_magnet_beside_a_mirror_is_the_whole() {
    let all_points = [[0.0, 12.0], [4.0, 12.0], [-4.0, 13.0], [25.0, 9.0], [-30.0, 5.0]];
    let of = |design: &Design| {
        let wanted = Wanted { points: all_points.to_vec(), is_single: true, ..Wanted::default() };
        design.study(&wanted, &[0.4, 2.0], &mut |_| {}).unwrap().states
    };
    let ring = |edge| Design { edge, ..c_core(1.0, 3.0, steel()) };
    let block = |x: f64, sense| {
        let shape = Shape::Rectangle([x - 1.0, -4.0], [x + 1.0, 4.0]);
        Region { coil: Some((0, sense)), ..region(if sense > 0.0 { "out" } else { "in" }, shape, Law::Linear(1.0)) }
    };
    let pair = |edge| {
        let core = Region { law: steel(), ..region("core", Shape::Rectangle([-2.0, -6.0], [2.0, 6.0]), steel()) };
        // short sides where the field is read
        let near = region("near", Shape::Rectangle([-14.0, -14.0], [14.0, 14.0]), Law::Linear(1.0));
        let near = Region { size_mm: Some(1.0), ..near };
        Design { edge, regions: vec![near, core, block(4.0, 1.0), block(-4.0, -1.0)], ..c_core(1.0, 3.0, steel()) }
    };
    for edge in [Edge::Open, Edge::Round { radius: 90.0 }, Edge::Box { half: 32.0 }] {
        for (whole, mirror) in [(ring(edge), Mirror::Across), (pair(edge), Mirror::Along)] {
            let half = Design { mirror: Some(mirror), ..whole.clone() };
            for (a, b) in of(&half).iter().zip(&of(&whole)) {
                // both meshes are coarse far from the magnet
                let most = b.points.iter().map(|flux| flux.size_t()).fold(0.0, f64::max);
                for (i, (a, b)) in a.points.iter().zip(&b.points).enumerate() {
                    let off = (a.b_t[0] - b.b_t[0]).hypot(a.b_t[1] - b.b_t[1]);
                    assert!(off < 1e-3 * b.size_t() + 2e-3 * most, "{edge:?} {mirror:?} {i}: {:?} {:?}", a.b_t, b.b_t);
                }
                assert!((a.linkage_wb[0].value / b.linkage_wb[0].value - 1.0).abs() < 1e-3, "{edge:?} {mirror:?}");
                assert!((a.coenergy_j.value / b.coenergy_j.value - 1.0).abs() < 1e-3, "{edge:?} {mirror:?}");
            }
        }
    }
}

/// What a boundary changes falls with the square of its distance: an open one is one that is very far away.
#[test]
fn an_open_boundary_is_one_far_away() {
    let at = |edge: Edge| solved(&Design { edge, ..c_core(1.0, 3.0, steel()) }, [0.0, 12.0], &[2.0])[0].clone();
    let open = at(Edge::Open);
    let off = |radius: f64| (at(Edge::Round { radius }).linkage_wb[0].value / open.linkage_wb[0].value - 1.0).abs();
    let (near, far) = (off(60.0), off(120.0));
    assert!(near > 1e-5 && (3.0..6.0).contains(&(near / far)), "{near:.2e} {far:.2e}");
    // (60 / 10,000)^2 of what it is at 60 mm
    assert!(off(1e4) < 1e-4 * near);
    let mut half = c_core(1.0, 3.0, steel());
    half.regions.pop();
    half.edge = Edge::Open;
    let text = half.study(&Wanted::default(), &[1.0], &mut |_| {}).err().unwrap().to_string();
    assert!(text.contains("500 ampere turns more") && text.contains("boundary"), "{text}");
}

/// The linkage over current has the co-energy as its integral: Simpson's rule over five currents.
#[test]
fn energy_and_linkage_belong_together() {
    let currents = [0.0, 1.0, 2.0, 3.0, 4.0];
    let states = solved(&c_core(1.0, 2.0, steel()), [0.0, 12.0], &currents);
    let linked: Vec<f64> = states.iter().map(|s| s.linkage_wb[0].value).collect();
    let integral = (linked[0] + 4.0 * linked[1] + 2.0 * linked[2] + 4.0 * linked[3] + linked[4]) / 3.0;
    let grown = states[4].coenergy_j.value - states[0].coenergy_j.value;
    assert!((integral / grown - 1.0).abs() < 1e-3, "{integral} J of linkage, {grown} J of co-energy");
    // And the work of the current is stored energy and co-energy.
    let work = 4.0 * linked[4];
    assert!(((states[4].energy_j.value + states[4].coenergy_j.value) / work - 1.0).abs() < 1e-9);
}

/// Any shape a user may draw, sensible or not.
fn any_shape() -> impl Strategy<Value = Shape> {
    let number = || -12.0..12.0_f64;
    prop_oneof![
        (number(), number(), -1.0..9.0_f64, 0.0..9.0_f64)
            .prop_map(|(x, y, w, h)| Shape::Rectangle([x, y], [x + w, y + h])),
        (number(), number(), 0.05..6.0_f64).prop_map(|(x, y, r)| Shape::Disc([x, y], r)),
        (number(), number(), 0.2..6.0_f64, 0.1..4.0_f64, 0.0..360.0_f64, 20.0..380.0_f64).prop_map(
            |(x, y, r, more, from, turn)| Shape::Ring {
                centre: [x, y],
                radii: [r, r + more],
                degrees: [from, from + turn]
            }
        ),
        prop::collection::vec((number(), number()), 2..6)
            .prop_map(|c| Shape::Polygon(c.into_iter().map(|(x, y)| [x, y]).collect())),
    ]
}

fn any_law() -> impl Strategy<Value = Law> {
    prop_oneof![Just(steel()), Just(fluid()), (0.5..2000.0_f64).prop_map(Law::Linear)]
}

/// How many drawings are tried: `PALPATE_DRAWS`, or as many as every run has time for.
fn drawings() -> u32 {
    std::env::var("PALPATE_DRAWS").map_or(60, |text| text.parse().expect("PALPATE_DRAWS is a number"))
}

fn any_design() -> impl Strategy<Value = Design> {
    let part = (any_shape(), any_law(), -1..=1_i32, prop::bool::weighted(0.2), 0.0..std::f64::consts::TAU);
    (prop::collection::vec(part, 1..5), any::<bool>(), any::<bool>()).prop_map(|(parts, round, axial)| {
        let regions = parts.into_iter().enumerate().map(|(i, (shape, law, sense, magnet, angle))| Region {
            coil: (sense != 0).then_some((0, f64::from(sense))),
            coercive: if magnet { [40.0 * angle.cos(), 40.0 * angle.sin()] } else { [0.0; 2] },
            ..region(&format!("part {i}"), shape, law)
        });
        let regions: Vec<Region> = regions.collect();
        let coiled = regions.iter().any(|r| r.coil.is_some());
        Design {
            geometry: if axial { Geometry::Axisymmetric } else { Geometry::Plane },
            depth_mm: 6.0,
            out_of_plane: None,
            mirror: None,
            edge: if round { Edge::Round { radius: 40.0 } } else { Edge::Box { half: 40.0 } },
            coils: if coiled {
                vec![Coil { name: "winding".into(), winding: winding(300.0), share: 1.0 }]
            } else {
                Vec::new()
            },
            regions,
        }
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: drawings(), ..ProptestConfig::default() })]

    /// Every drawing solves, with energies that belong to its work, or ends in an error that names region and reason.
    #[test]
    fn any_drawing_is_solved_or_refused_with_region_and_reason(design in any_design()) {
        let wanted = Wanted { points: vec![[1.0, 0.5]], order: Order::Second, coarser: 3.0, ..Wanted::default() };
        // Simpson's rule needs currents between which a saturating linkage is a parabola.
        match design.study(&wanted, &[0.9, 0.95, 1.0], &mut |_| {}) {
            Ok(study) => {
                let [low, middle, high] = [0, 1, 2].map(|i| &study.states[i]);
                prop_assert!(study.states.iter().all(|s| s.points[0].size_t().is_finite()));
                if let Some(linked) = high.linkage_wb.first() {
                    let (low_wb, middle_wb) = (low.linkage_wb[0].value, middle.linkage_wb[0].value);
                    let work = 0.1 * (low_wb + 4.0 * middle_wb + linked.value) / 6.0;
                    let grown = high.coenergy_j.value - low.coenergy_j.value;
                    // Linkage and current of a magnet's field may go against each other: then both are small.
                    let size = 0.1 * linked.value.abs().max(low_wb.abs());
                    prop_assert!((work - grown).abs() <= 1e-3 * size, "{work} J of {grown} J, {size} J");
                }
            }
            Err(error) => {
                let text = error.to_string();
                prop_assert!(text.contains("region \"part") || text.contains("coil \"winding\""), "{text}");
            }
        }
    }
}
