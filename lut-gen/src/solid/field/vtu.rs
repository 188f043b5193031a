//! VTK's XML format of unstructured grids, for ParaView.
//!
//! Values are written as text in their shortest exact form: the files are small, the same on every
//! machine, and readable by eye. Points are in the *deformed* position, so that block and ball fit
//! together when a file is opened; the array `displacement_mm` leads back (warp by -1). The r-z plane
//! is x-y, the axis is x = 0. Format: VTK user's guide, section "XML file formats"; cell types 23
//! (quadratic quadrilateral, corners then middles of sides, as the mesh has them) and 3 (line).

use std::fmt::Write;

use super::{Field, PointState};
use crate::vtk::{LINE, QUADRATIC_QUAD, array, cells, document, points};

/// Points on the quarter circle of the ball's outline.
const ARC: usize = 48;

/// The block as a `.vtu` document.
///
/// Point data: `displacement_mm`; `stretch` (two in the r-z plane, hoop); `volume_ratio`;
/// `cauchy_MPa` in VTK's order of a symmetric tensor (XX YY ZZ XY YZ XZ, here rr zz tt rz 0 0);
/// `mises_MPa`; `contact_pressure_MPa` per current area.
#[must_use]
pub fn block(field: &Field) -> String {
    let mut body = String::new();
    let nodes = 0..field.nodes.len();
    points(&mut body, nodes.clone().map(|n| field.position_mm(n)));
    let list: Vec<&[usize]> = field.elements.iter().map(<[usize; 8]>::as_slice).collect();
    cells(&mut body, &list, QUADRATIC_QUAD);
    body.push_str("<PointData Scalars=\"mises_MPa\" Vectors=\"displacement_mm\" Tensors=\"cauchy_MPa\">\n");
    let zero = [0.0];
    array(&mut body, "displacement_mm", 3, field.displacement_mm.iter().flat_map(|u| u.iter().chain(&zero)));
    array(&mut body, "stretch", 3, field.state.iter().flat_map(|s| s.stretch));
    array(&mut body, "volume_ratio", 1, field.state.iter().map(PointState::volume_ratio));
    let tensor = |s: &PointState| {
        let [rr, zz, tt, rz] = s.cauchy_mpa;
        [rr, zz, tt, rz, 0.0, 0.0]
    };
    array(&mut body, "cauchy_MPa", 6, field.state.iter().flat_map(tensor));
    array(&mut body, "mises_MPa", 1, field.state.iter().map(PointState::mises_mpa));
    array(&mut body, "contact_pressure_MPa", 1, field.pressure_mpa.iter());
    body.push_str("</PointData>\n");
    let global = [("depth_mm", field.step.depth_mm), ("force_N", field.step.force_n)];
    document(&global, field.nodes.len(), field.elements.len(), &body)
}

/// The ball's outline with its shank, from the lowest point outward and up, as a `.vtu` document.
#[must_use]
pub fn ball(field: &Field) -> String {
    let (radius, centre) = (field.ball.radius_mm, field.centre_mm());
    let quarter = (0..=ARC).map(|i| {
        let angle = std::f64::consts::FRAC_PI_2 * i as f64 / ARC as f64;
        [radius * angle.sin(), centre - radius * angle.cos()]
    });
    let top = field.height_mm.max(centre) + radius;
    let outline: Vec<[f64; 2]> = quarter.chain([[radius, top]]).collect();
    let mut body = String::new();
    points(&mut body, outline.iter().copied());
    let order: Vec<usize> = (0..outline.len()).collect();
    let lines: Vec<&[usize]> = order.windows(2).collect();
    cells(&mut body, &lines, LINE);
    document(&[], outline.len(), lines.len(), &body)
}

/// A `.pvd` collection: for each step its depth (mm, ParaView's time) and the files of block and ball.
#[must_use]
pub fn collection(steps: &[(f64, String, String)]) -> String {
    let mut out =
        String::from("<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n");
    for (depth_mm, block, ball) in steps {
        for (part, (name, file)) in [("block", block), ("ball", ball)].into_iter().enumerate() {
            let file = attribute(file);
            let _ = writeln!(out, "<DataSet timestep=\"{depth_mm}\" part=\"{part}\" name=\"{name}\" file=\"{file}\"/>");
        }
    }
    out.push_str("</Collection>\n</VTKFile>\n");
    out
}

fn attribute(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}
