//! How stiff materials are under a finger.

use crate::control::ControlCurve;

/// Stiffness of a material.
#[derive(Debug, Clone, PartialEq)]
pub struct Stiffness {
    /// N/mm, or the unit of whoever gave it.
    pub value: f64,
    /// Where it comes from.
    pub source: String,
}

/// Largest force that a stiffness is taken at, N: that of a finger that feels.
pub const FELT_N: f64 = 1.0;

/// A Plexiglas block under a cap of 5 mm radius, 19 mm high, 3 GPa (assumed; rigid for a finger): E A / h, N/mm.
const PLEXIGLAS_N_MM: f64 = 12_400.0;

/// Stiffnesses of materials by name: those that are given, then the control curves that come with the program, as force over what the shaft
/// gives way, at the largest force up to [`FELT_N`] that all curves reach. None where nothing is known of a material. Given values and
/// curves do not mix unless the given ones are in N/mm.
#[must_use]
pub fn of(names: &[String], given: &[(String, f64)], curves: &[ControlCurve]) -> Vec<Option<Stiffness>> {
    let curve = |name: &str| {
        let known = foam(name);
        let own = curves.iter().find(|curve| curve.material.eq_ignore_ascii_case(&known)).cloned();
        own.or_else(|| ControlCurve::built_in(&known))
    };
    let told = |name: &str| given.iter().find(|(of, _)| of.eq_ignore_ascii_case(name)).map(|(_, value)| *value);
    let used: Vec<ControlCurve> =
        names.iter().filter(|name| told(name).is_none()).filter_map(|name| curve(name)).collect();
    let force_n = used.iter().map(ControlCurve::most_n).fold(FELT_N, f64::min);
    let each = |name: &String| {
        if let Some(value) = told(name) {
            return Some(Stiffness { value, source: "given".to_owned() });
        }
        if let Some(curve) = curve(name) {
            let shaft_mm = shaft_mm(&curve, force_n)?;
            return (shaft_mm > 0.0).then(|| Stiffness {
                value: force_n / shaft_mm,
                source: format!("control curve of {} at {force_n:.2} N", curve.material),
            });
        }
        foam(name)
            .eq_ignore_ascii_case("Plexiglas")
            .then(|| Stiffness { value: PLEXIGLAS_N_MM, source: "assumed: 3 GPa under the cap".to_owned() })
    };
    names.iter().map(each).collect()
}

/// The name of a foam of the thesis in what it is called there: `ICF-400` is ICF.
fn foam(name: &str) -> String {
    name.trim_end_matches("-400").to_owned()
}

/// What the shaft gives way at a force, on the line between two rows.
fn shaft_mm(curve: &ControlCurve, force_n: f64) -> Option<f64> {
    let pair = curve.rows.windows(2).find(|w| w[0].force_n <= force_n && force_n <= w[1].force_n)?;
    let share = (force_n - pair[0].force_n) / (pair[1].force_n - pair[0].force_n);
    Some(pair[0].shaft_mm + share * (pair[1].shaft_mm - pair[0].shaft_mm))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn the_thesis_foams_rise_in_the_order_of_their_stiffness() {
        let names = ["ICF-400", "A2", "B1", "Plexiglas", "A2-FR"].map(str::to_owned);
        let found = of(&names, &[], &[]);
        let value = |i: usize| found[i].as_ref().unwrap().value;
        assert!(value(0) < value(1) && value(1) < value(2) && value(2) < value(3), "{found:?}");
        assert!(found[4].is_none(), "the thesis prints nothing of A2-FR");
        // All at one force, that of the softest.
        assert!(found[1].as_ref().unwrap().source.ends_with("0.42 N"), "{found:?}");
        let given = of(&names[..2], &[("a2".to_owned(), 3.0)], &[]);
        assert_eq!(given[1].as_ref().unwrap().value, 3.0);
    }
}
