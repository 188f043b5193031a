//! VTK's XML format of unstructured grids, for ParaView (VTK user's guide, section "XML file formats"). Values are text in
//! their shortest exact form.

use std::fmt::{Display, Write};

/// A line of two points.
pub const LINE: u8 = 3;
/// A triangle.
pub const TRIANGLE: u8 = 5;
/// Corners, then the middles of its sides.
pub const QUADRATIC_TRIANGLE: u8 = 22;
/// Corners, then nodes on its sides, then those inside.
pub const LAGRANGE_TRIANGLE: u8 = 69;
/// Corners, then the middles of its sides.
pub const QUADRATIC_QUAD: u8 = 23;

/// A whole document of one piece; `global` are numbers of the whole.
pub fn document(global: &[(&str, f64)], points: usize, cells: usize, body: &str) -> String {
    let mut out = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n<UnstructuredGrid>\n",
    );
    if !global.is_empty() {
        out.push_str("<FieldData>\n");
        for (name, value) in global {
            let _ = writeln!(
                out,
                "<DataArray type=\"Float64\" Name=\"{name}\" NumberOfTuples=\"1\" format=\"ascii\">{value}</DataArray>"
            );
        }
        out.push_str("</FieldData>\n");
    }
    let _ = writeln!(out, "<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">");
    out.push_str(body);
    out.push_str("</Piece>\n</UnstructuredGrid>\n</VTKFile>\n");
    out
}

/// Positions in the plane, mm.
pub fn points(out: &mut String, at: impl Iterator<Item = [f64; 2]>) {
    out.push_str("<Points>\n");
    array(out, "position_mm", 3, at.flat_map(|[r, z]| [r, z, 0.0]));
    out.push_str("</Points>\n");
}

/// Cells of one kind.
pub fn cells(out: &mut String, list: &[&[usize]], kind: u8) {
    let ends = list.iter().scan(0, |end, cell| {
        *end += cell.len();
        Some(*end)
    });
    out.push_str("<Cells>\n");
    values(out, "Int64", "connectivity", 1, list.iter().flat_map(|cell| cell.iter()));
    values(out, "Int64", "offsets", 1, ends);
    values(out, "UInt8", "types", 1, list.iter().map(|_| kind));
    out.push_str("</Cells>\n");
}

/// An array of numbers with so many components a tuple.
pub fn array(out: &mut String, name: &str, components: usize, data: impl Iterator<Item = impl Display>) {
    values(out, "Float64", name, components, data);
}

fn values(out: &mut String, kind: &str, name: &str, components: usize, data: impl Iterator<Item = impl Display>) {
    let _ = writeln!(
        out,
        "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"ascii\">"
    );
    for (i, value) in data.enumerate() {
        let _ = write!(out, "{value}{}", if i % 12 == 11 { '\n' } else { ' ' });
    }
    out.push_str("\n</DataArray>\n");
}
