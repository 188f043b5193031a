//! The magnets of the references as drawings, by the definitions in their folder's README.

use lut_gen::magnet::bh::{Between, Law, LawError, MU_0, Table};
use lut_gen::magnet::design::{Coil, Design, Edge, Region};
use lut_gen::magnet::field::Geometry;
use lut_gen::magnet::shape::Shape;
use lut_gen::magnet::winding::{Winding, awg_mm};

/// Turns of every coil.
const TURNS: f64 = 770.0;

/// Rows of a CSV file as numbers; comments and the head are skipped.
#[must_use]
pub fn rows(text: &str) -> Vec<Vec<f64>> {
    let numbers = |line: &str| line.split(',').map(|field| field.trim().parse::<f64>()).collect::<Result<Vec<_>, _>>();
    text.lines().filter_map(|line| numbers(line).ok()).filter(|row| row.len() > 1).collect()
}

/// A law from a table of B (T) and H (A/m) with the references' straight lines between its points.
///
/// # Errors
/// A table that is no law.
pub fn law(text: &str) -> Result<Law, LawError> {
    let points: Vec<(f64, f64)> = rows(text).iter().map(|row| (row[0], row[1])).collect();
    Table::new(&points, Between::Straight).map(Law::Table)
}

fn region(name: &str, shapes: Vec<Shape>, law: Law, size_mm: f64) -> Region {
    Region {
        name: name.into(),
        shapes,
        without: Vec::new(),
        law,
        coercive: [0.0; 2],
        coil: None,
        size_mm: Some(size_mm),
    }
}

fn rectangle([x0, y0, x1, y1]: [f64; 4]) -> Shape {
    Shape::Rectangle([x0, y0], [x1, y1])
}

fn coil(turn_mm: f64) -> Vec<Coil> {
    let wire_mm = awg_mm(28.0);
    let winding = Winding {
        turns: TURNS,
        wire_mm,
        insulated_mm: 1.12 * wire_mm,
        turn_mm,
        room_c: 25.0,
        limit_c: 130.0,
        cooling_w_k: 0.0,
    };
    vec![Coil { name: "winding".into(), winding, share: 1.0 }]
}

/// The ring electromagnet with a gap, in its container; the core with the size of its triangles. A probe of 1 mm by 4 mm at the middle is air.
fn ring_of(gap_mm: f64, core: (Law, f64), fluid: Law, probe: bool, size_mm: f64) -> Design {
    let ring = |radii: [f64; 2], degrees: [f64; 2]| Shape::Ring { centre: [0.0; 2], radii, degrees };
    let half = 0.5 * gap_mm;
    let mut steel = region("core", vec![ring([14.0, 20.0], [0.0, 360.0])], core.0, core.1);
    steel.without = vec![rectangle([-half, 0.0, half, 30.0])];
    let wound = |name: &str, radii, sense| Region {
        coil: Some((0, sense)),
        ..region(name, vec![ring(radii, [115.0, 425.0])], Law::Linear(1.0), 2.0 * size_mm)
    };
    let container = rectangle([-half - 2.0, 12.0, half + 2.0, 22.0]);
    let mut regions = vec![
        region("fluid", vec![container], fluid, size_mm),
        steel,
        wound("inner", [12.0, 14.0], 1.0),
        wound("outer", [20.0, 21.6], -1.0),
    ];
    if probe {
        let tip = rectangle([-0.5, 15.0, 0.5, 19.0]);
        regions.push(region("probe", vec![tip], Law::Linear(1.0), 0.5_f64.min(size_mm)));
    }
    Design {
        geometry: Geometry::Plane,
        depth_mm: 1000.0,
        out_of_plane: None,
        mirror: None,
        edge: Edge::Round { radius: 150.0 },
        regions,
        coils: coil(31.2),
    }
}

/// `ring_A`, with the probe and without.
#[must_use]
pub fn ring_a(steel: Law, probe: bool) -> Design {
    ring_of(10.0, (steel, 0.5), Law::Fluid(0.22), probe, 0.5)
}

/// The linear C-core: permeability 1000, air in a gap of so many mm.
#[must_use]
pub fn c_core(gap_mm: f64) -> Design {
    ring_of(gap_mm, (Law::Linear(1000.0), 1.0), Law::Linear(1.0), false, (gap_mm / 4.0).min(0.5))
}

/// `pot_A`.
#[must_use]
pub fn pot_a(steel: Law) -> Design {
    let core = [[0.0, -20.0, 14.0, -16.0], [0.0, -16.0, 6.0, 0.0], [11.0, -16.0, 14.0, 0.0]];
    let winding = Region {
        coil: Some((0, 1.0)),
        ..region("winding", vec![rectangle([6.5, -15.5, 10.5, -0.5])], Law::Linear(1.0), 0.6)
    };
    Design {
        geometry: Geometry::Axisymmetric,
        depth_mm: 0.0,
        out_of_plane: None,
        mirror: None,
        edge: Edge::Box { half: 90.0 },
        regions: vec![
            region("core", core.map(rectangle).to_vec(), steel, 0.5),
            winding,
            region("fluid", vec![rectangle([0.0, 0.0, 16.0, 5.0])], Law::Fluid(0.22), 0.3),
        ],
        coils: coil(std::f64::consts::TAU * 8.5),
    }
}

/// The uniformly magnetised cylinder, 1 T along its axis, in a box of 240 mm.
#[must_use]
pub fn cylinder() -> Design {
    let magnet = Region {
        coercive: [0.0, 1.0 / MU_0],
        ..region("magnet", vec![rectangle([0.0, -3.0, 4.0, 3.0])], Law::Linear(1.0), 0.15)
    };
    // A second, larger region of air keeps the mesh fine where the field is read.
    let near = region("near", vec![rectangle([0.0, -10.0, 10.0, 10.0])], Law::Linear(1.0), 0.4);
    Design {
        geometry: Geometry::Axisymmetric,
        depth_mm: 0.0,
        out_of_plane: None,
        mirror: None,
        edge: Edge::Box { half: 240.0 },
        regions: vec![near, magnet],
        coils: Vec::new(),
    }
}

/// Rectangles of a list in a reference's head, which is JSON.
fn rectangles(list: &serde_json::Value) -> Vec<[f64; 4]> {
    let numbers =
        |v: &serde_json::Value| v.as_array().map(|a| a.iter().filter_map(serde_json::Value::as_f64).collect());
    let four = |v: &serde_json::Value| numbers(v).and_then(|n: Vec<f64>| n.try_into().ok());
    list.as_array().map(|list| list.iter().filter_map(four).collect()).unwrap_or_default()
}

/// One of the four arrangements of permanent magnets, by its file's first line; `None` if that is another.
#[must_use]
pub fn arrangement(text: &str, alnico: &Law, steel: &Law) -> Option<Design> {
    /// Coercive field strength of Alnico 5, A/mm.
    const COERCIVE: f64 = 50.963;
    let head = text.lines().next()?;
    let json: serde_json::Value = serde_json::from_str(&head[head.find('{')?..=head.find("};")?]).ok()?;
    let mut regions = Vec::new();
    for (i, magnet) in json["mag"].as_array()?.iter().enumerate() {
        let place: Vec<f64> = magnet[0].as_array()?.iter().filter_map(serde_json::Value::as_f64).collect();
        let along: Vec<f64> = magnet[1].as_array()?.iter().filter_map(serde_json::Value::as_f64).collect();
        regions.push(Region {
            coercive: [COERCIVE * along[0], COERCIVE * along[1]],
            ..region(&format!("magnet {i}"), vec![rectangle(place.try_into().ok()?)], alnico.clone(), 0.6)
        });
    }
    let fluid: Vec<Shape> = rectangles(&json["mrf"]).into_iter().map(rectangle).collect();
    regions.push(region("fluid", fluid, Law::Fluid(0.22), 0.4));
    let core: Vec<Shape> = rectangles(&json["core"]).into_iter().map(rectangle).collect();
    if !core.is_empty() {
        regions.push(region("core", core, steel.clone(), 0.8));
    }
    Some(Design {
        geometry: Geometry::Plane,
        depth_mm: 1000.0,
        out_of_plane: None,
        mirror: None,
        edge: Edge::Round { radius: 120.0 },
        regions,
        coils: Vec::new(),
    })
}
