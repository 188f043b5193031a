//! An elastic departure without a name: what the catalogue's elastic effects must do better than.

use super::{Effect, Kind, Owner, Quantity, Stage};

/// The elastic force is off by a smooth part of itself, over the depth in units of the ball's radius and over that radius.
///
/// Elastic laws have no end, and skins, gradients and anisotropies beside them: each departs from the base in such a way. It is in no catalogue and no
/// answer; where it explains data as well as an elastic effect does, that effect is one guess among many.
pub const EFFECT: Effect = Effect {
    code: "nameless",
    form: "elastic",
    stage: Stage::Material,
    kind: Kind::ElasticLaw,
    assumption: "the foam's law and shape are the declared ones",
    signature: "any smooth function of depth and radius",
    twins: &[],
    separated_by: "a third ball; a second height; compression of a coupon",
    prior: "none: what has no name has no amount that laboratories know",
    quantities: &[
        Quantity::amplitude("over_ln_depth", 0.0, (-1.0, 1.0), 0.1, &[0.0]),
        Quantity::amplitude("over_depth", 0.0, (-2.0, 2.0), 0.1, &[0.0]),
        Quantity::amplitude("over_depth_squared", 0.0, (-2.0, 2.0), 0.1, &[0.0]),
        Quantity::amplitude("over_ln_radius", 0.0, (-1.0, 1.0), 0.1, &[0.0]),
    ],
    owner: Owner::All,
};

/// Radius at which the last part vanishes, mm; of no consequence, the modulus makes up for another one.
const RADIUS_MM: f64 = 5.0;
/// Depth in units of the radius below which the logarithm stays what it is there: the force is nothing.
const SHALLOW: f64 = 1e-3;

/// Factor on the elastic force at a depth of a ball, both in mm.
#[must_use]
pub fn factor(values: &[f64], depth_mm: f64, radius_mm: f64) -> f64 {
    let x = (depth_mm / radius_mm).max(SHALLOW);
    let shapes = [x.ln(), x, x * x, (radius_mm / RADIUS_MM).ln()];
    1.0 + values.iter().zip(shapes).map(|(value, shape)| value * shape).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nothing where its values are nothing; each part is what it is named after, relative to the force.
    #[test]
    fn each_part_is_a_share_of_the_force() {
        assert_eq!(factor(&[0.0; 4], 2.0, 4.0), 1.0);
        let parts: Vec<f64> = (0..4)
            .map(|at| factor(&std::array::from_fn::<f64, 4, _>(|k| f64::from(u8::from(k == at))), 2.0, 4.0) - 1.0)
            .collect();
        let expected = [0.5_f64.ln(), 0.5, 0.25, (4.0 / RADIUS_MM).ln()];
        assert!(parts.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15), "{parts:?}");
        assert!(factor(&[1.0, 0.0, 0.0, 0.0], 0.0, 4.0).is_finite());
    }
}
