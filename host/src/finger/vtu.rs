//! A state of a press for ParaView.

use lut_gen::pad::state::State;
use lut_gen::vtk;

use super::press::Pressed;

/// The deformed mesh of both bodies with displacement (mm), Mises stress (MPa) and layer (0 skin, 1 tissue, 2 block).
pub fn vtu(pressed: &Pressed, state: &State) -> String {
    let mut body = String::new();
    vtk::points(&mut body, state.nodes.iter().copied());
    let cells: Vec<&[usize]> = pressed.elements.iter().map(<[usize; 8]>::as_slice).collect();
    vtk::cells(&mut body, &cells, vtk::QUADRATIC_QUAD);
    body.push_str("<PointData>\n");
    vtk::array(&mut body, "mises_MPa", 1, state.mises_mpa.iter());
    let moved = state.nodes.iter().zip(&pressed.nodes).flat_map(|(now, was)| [now[0] - was[0], now[1] - was[1], 0.0]);
    vtk::array(&mut body, "displacement_mm", 3, moved);
    body.push_str("</PointData>\n<CellData>\n");
    vtk::array(&mut body, "layer", 1, pressed.layer.iter());
    body.push_str("</CellData>\n");
    let global = [("travel_mm", state.travel_mm), ("force_N", state.force_n)];
    vtk::document(&global, pressed.nodes.len(), pressed.elements.len(), &body)
}
