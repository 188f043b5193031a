//! The critical step of central differences.

use faer::{Mat, Side};

use super::Body;
use crate::solid::contact::{EdgeStiffness, Sum};
use crate::solid::element::{DOFS, Matter, Stiffness};
use crate::solid::solve::Step;

/// Largest stable step (s) at the current positions `x` (mm); `step` holds material, history and depth.
///
/// Central differences are stable up to `2 / omega` of the highest frequency, whatever the mass-proportional
/// damping (which Eq. 63 takes at the middle of the step). No frequency of the mesh exceeds the highest of its
/// elements taken alone (Irons and Treharne 1971; Hughes, The Finite Element Method, 2000, sec. 9.2), each with
/// its tangent stiffness, the contact on its top, and its lumped mass. Eq. 68 of the thesis, the travel time
/// of a wave between nodes, estimates the same number without the geometry of the element.
///
/// # Errors
/// The index of the first element that is turned inside out.
pub fn critical_step_s(body: &Body, step: &Step, x: &[[f64; 2]]) -> Result<f64, usize> {
    let mut highest = 0.0_f64;
    for index in 0..body.elements.len() {
        highest = highest.max(highest_square(body, step, x, index).ok_or(index)?);
    }
    Ok(2.0 / highest.sqrt())
}

/// Square of the highest frequency (1/s^2) of one element.
fn highest_square(body: &Body, step: &Step, x: &[[f64; 2]], index: usize) -> Option<f64> {
    let solid = &body.solids[index];
    let u: [f64; DOFS] = std::array::from_fn(|i| {
        let node = solid.nodes[i / 2];
        x[node][i % 2] - body.reference[node][i % 2]
    });
    let mut k = [[0.0; DOFS]; DOFS];
    let matter = Matter { material: step.material, step: &step.relaxation };
    let old = &step.old.matter[body.remembered(step, index)];
    solid.stiffness(&matter, old, &u, &mut [0.0; DOFS], &mut k, false)?;
    if let Some(edge) = body.edge_of[index] {
        add_contact(body, step, x, edge, &mut k);
    }
    let root = body.element_mass[index].map(f64::sqrt);
    // friction and unlike relaxation make the tangent unsymmetric: its symmetric part sets the frequency
    let matrix = Mat::from_fn(DOFS, DOFS, |i, j| 0.5 * (k[i][j] + k[j][i]) / (root[i / 2] * root[j / 2]));
    let values = matrix.self_adjoint_eigenvalues(Side::Lower).ok()?;
    values.last().copied().filter(|v| v.is_finite())
}

/// Adds the stiffness of the contact on top of an element: inner, middle and outer node of the edge are the
/// element's fourth, seventh and third.
fn add_contact(body: &Body, step: &Step, x: &[[f64; 2]], edge: usize, k: &mut Stiffness) {
    let mut stiffness = EdgeStiffness::default();
    let u = body.edge_displacement(&body.surface.edges()[edge], x);
    let (centre, old) = (body.centre_mm(step.depth_mm), &step.old.grips[body.grips(edge)]);
    body.surface.edge(edge, centre, &u, old, None, &mut [0.0; 6], Some(&mut stiffness), &mut Sum::default());
    let dof = |i: usize| 2 * [3, 6, 2][i / 2] + i % 2;
    for (i, row) in stiffness.whole.iter().enumerate() {
        for (j, value) in row.iter().enumerate() {
            k[dof(i)][dof(j)] += value;
        }
    }
}
