//! A control curve for another magnet or fluid: the finger and the yield stress over its force stay.

use super::compose::{Current, Links, Uncomposed, last_made};
use super::curve::{ControlCurve, MOST_ROWS, Row};

/// Parts of a stretch between two rows where a current is compared with the straight line.
const BETWEEN: [f64; 3] = [0.25, 0.5, 0.75];

impl ControlCurve {
    /// The same curve with the flux density and the current that another magnet and fluid want. Nothing is pressed again:
    /// the yield stress over force is the fluid's whatever magnet makes it.
    ///
    /// # Errors
    /// [`Uncomposed::Nowhere`] where no row is within what the magnet makes.
    pub fn for_magnet(&self, links: &Links) -> Result<Self, Uncomposed> {
        let made = |row: &Row| matches!(links.current(row.yield_kpa), Current::Made(..));
        let from = self.rows.iter().position(made).ok_or(Uncomposed::Nowhere)?;
        let last = from + self.rows[from..].iter().take_while(|row| made(row)).count() - 1;
        let mut rows: Vec<Row> = self.rows.iter().map(|row| with_current(row, links)).collect();
        let mut reachable_n = (rows[from].force_n, rows[last].force_n);
        if last + 1 < rows.len() {
            let edge = edge(&self.rows[last], &self.rows[last + 1], links);
            // the magnet ends between two rows: a row of its own there, where a table has room for it
            if edge.force_n > rows[last].force_n && rows.len() < MOST_ROWS {
                reachable_n.1 = edge.force_n;
                rows.insert(last + 1, with_current(&edge, links));
            }
        }
        let bound_a = self.bound(&rows, links, reachable_n).min(links.most_a);
        let (magnet, fluid) = (links.magnet.clone(), links.fluid.clone());
        let provenance = format!("{}; magnet and fluid exchanged afterwards", self.provenance);
        Ok(ControlCurve { magnet, fluid, bound_a, reachable_n, provenance, rows, ..self.clone() })
    }

    /// Largest error of a current between these forces, A. What this curve's own current may be off by is what its yield
    /// stress may be off by, and so it becomes an error of the other current.
    fn bound(&self, rows: &[Row], links: &Links, (from, to): (f64, f64)) -> f64 {
        let mut bound: f64 = 0.0;
        for w in rows.windows(2).filter(|w| w[0].force_n >= from && w[1].force_n <= to) {
            let rise = (w[1].current_a - w[0].current_a).abs();
            let at = |part: f64| between(&w[0], &w[1], part);
            let bent = BETWEEN.map(|part| {
                let line = w[0].current_a + part * (w[1].current_a - w[0].current_a);
                (with_current(&at(part), links).current_a - line).abs()
            });
            let per_t = rise / (w[1].flux_t - w[0].flux_t).abs().max(f64::MIN_POSITIVE);
            let magnet = if rise > 0.0 { links.flux.bound_t() * per_t } else { 0.0 };
            let was = (self.current_at(w[1].force_n) - self.current_at(w[0].force_n)).abs();
            let own = if was > 0.0 { self.bound_a * rise / was } else { 0.0 };
            bound = bound.max(bent.into_iter().fold(0.0, f64::max) + magnet + own);
        }
        bound
    }

    /// Largest shear yield stress that the curve asks for, kPa.
    pub fn most_kpa(&self) -> f64 {
        self.rows.iter().map(|row| row.yield_kpa).fold(0.0, f64::max)
    }
}

fn with_current(row: &Row, links: &Links) -> Row {
    let (flux_t, current_a) = links.made(row.yield_kpa);
    Row { flux_t, current_a, ..*row }
}

/// The row at a part of the way from one to the next.
fn between(a: &Row, b: &Row, part: f64) -> Row {
    let mix = |a: f64, b: f64| a + part * (b - a);
    Row {
        force_n: mix(a.force_n, b.force_n),
        travel_mm: mix(a.travel_mm, b.travel_mm),
        area_mm2: mix(a.area_mm2, b.area_mm2),
        shaft_mm: mix(a.shaft_mm, b.shaft_mm),
        yield_kpa: mix(a.yield_kpa, b.yield_kpa),
        flux_t: mix(a.flux_t, b.flux_t),
        current_a: mix(a.current_a, b.current_a),
        loop_gain: mix(a.loop_gain, b.loop_gain),
    }
}

/// The last row that the magnet reaches, between one that it does and one that it does not.
fn edge(within: &Row, beyond: &Row, links: &Links) -> Row {
    let made = |part: f64| matches!(links.current(between(within, beyond, part).yield_kpa), Current::Made(..));
    between(within, beyond, last_made(0.0, 1.0, made))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use lut_gen::magnet::curve::{Built, FluxCurve};
    use lut_gen::magnet::fluid::{Fluid, Oil};

    use super::*;

    /// A magnet of so many tesla at 2.5 A, in proportion to the current.
    fn straight(tesla: f64) -> Links {
        let points: Vec<(f64, f64)> = (0..=10).map(|i| 0.25 * f64::from(i)).map(|a| (a, tesla * a / 2.5)).collect();
        Links {
            magnet: "straight".to_owned(),
            flux: FluxCurve::new(&points, 1e-6, Built::default()).unwrap(),
            fluid: "MRF-122EG".to_owned(),
            law: Fluid::carlson(0.22, Oil::Hydrocarbon).unwrap(),
            most_a: 2.5,
        }
    }

    fn built_in(material: &str) -> ControlCurve {
        ControlCurve::built_in(material).unwrap()
    }

    #[test]
    fn a_stronger_magnet_wants_less_current_for_the_same_yield_stress() {
        let (own, links) = (built_in("EVA"), straight(0.6));
        let other = own.for_magnet(&links).unwrap();
        assert_eq!((other.magnet.as_str(), other.rows.len()), ("straight", own.rows.len()));
        for (row, was) in other.rows.iter().zip(&own.rows) {
            assert_eq!((row.force_n, row.yield_kpa, row.shaft_mm), (was.force_n, was.yield_kpa, was.shaft_mm));
            // the fluid is the same: so is the flux density that the yield stress wants
            assert!((row.flux_t - was.flux_t).abs() < 1e-9, "{row:?}");
            assert!((row.current_a - 2.5 * row.flux_t / 0.6).abs() < 1e-9, "{row:?}");
        }
        assert!(ControlCurve::parse(std::path::Path::new("c.csv"), &other.to_csv().unwrap()).is_ok());
    }

    #[test]
    fn the_bound_holds_what_the_old_bound_was() {
        let (own, half, whole) = (built_in("B1"), straight(0.3), straight(0.6));
        let (half, whole) = (own.for_magnet(&half).unwrap(), own.for_magnet(&whole).unwrap());
        // twice the current for the same yield stress, with twice the error
        assert!((half.bound_a / whole.bound_a - 2.0).abs() < 0.02, "{} {}", half.bound_a, whole.bound_a);
        assert!(whole.bound_a > 0.0);
    }

    #[test]
    fn what_a_weak_magnet_cannot_make_ends_the_curve_where_its_yield_stress_ends() {
        let (own, links) = (built_in("EVA"), straight(0.05));
        let other = own.for_magnet(&links).unwrap();
        let (from, to) = other.reachable_n;
        assert!(from == 0.0 && to > 0.0 && to < own.reachable_n.1, "{to}");
        let end = other.rows.iter().find(|row| row.force_n == to).unwrap();
        assert!((end.yield_kpa / links.most_kpa() - 1.0).abs() < 1e-6);
        let weakest = straight(1e-7);
        assert_eq!(
            ControlCurve { rows: own.rows[1..].to_vec(), ..own }.for_magnet(&weakest).unwrap_err(),
            Uncomposed::Nowhere
        );
    }
}
