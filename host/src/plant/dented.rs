//! A yielding fluid under a finger: the force that it bears, and the dent that stays.

use super::Pulp;

/// Largest force of a finger on a fluid over travel and shear yield stress, from finite elements.
#[derive(Debug, Clone, PartialEq)]
pub struct FluidForce {
    /// Shear yield stresses, kPa, rising from more than 0, each with force (N) at even travels from the first step on.
    curves: Vec<(f64, Vec<f64>)>,
    step_mm: f64,
}

/// A fluid with the dent that a finger has left.
#[derive(Debug, Clone, PartialEq)]
pub struct Dented {
    force: FluidForce,
    dent_mm: f64,
}

impl FluidForce {
    /// From yield stresses (kPa) with forces (N) at `step_mm, 2 step_mm, ...`. `None` unless stresses rise from more than 0,
    /// every curve has two forces or more, and all are numbers above 0.
    pub fn new(step_mm: f64, curves: Vec<(f64, Vec<f64>)>) -> Option<Self> {
        let positive = |v: &f64| *v > 0.0 && v.is_finite();
        let rises = curves.windows(2).all(|w| w[0].0 < w[1].0);
        let sound = curves.iter().all(|(kpa, force)| positive(kpa) && force.len() >= 2 && force.iter().all(positive));
        (step_mm > 0.0 && !curves.is_empty() && rises && sound).then_some(FluidForce { curves, step_mm })
    }

    /// Reads `yield_kPa,travel_mm,force_N` with even travels; `None` for what is no such table.
    pub fn parse(text: &str) -> Option<Self> {
        let mut curves = Vec::<(f64, Vec<f64>)>::new();
        let mut step_mm = None;
        for line in text.lines().filter(|line| !line.starts_with('#') && !line.starts_with("yield")) {
            let cells: Vec<f64> = line.split(',').map(|cell| cell.trim().parse()).collect::<Result<_, _>>().ok()?;
            let [kpa, travel_mm, force_n] = cells.as_slice() else { return None };
            step_mm.get_or_insert(*travel_mm);
            match curves.last_mut().filter(|(own, _)| own == kpa) {
                Some((_, force)) => force.push(*force_n),
                None => curves.push((*kpa, vec![*force_n])),
            }
        }
        FluidForce::new(step_mm?, curves)
    }

    /// Of a finger whose pulp gives way `softness` times as far under the same force: one that is larger by that, of tissue that is
    /// softer by its square.
    #[must_use]
    pub fn of_a_finger(mut self, softness: f64) -> Self {
        self.step_mm *= softness;
        self.curves.iter_mut().for_each(|(kpa, _)| *kpa /= softness * softness);
        self
    }

    /// Largest force at a travel (mm) and a shear yield stress (kPa), N: in proportion to the stress below the least of the
    /// table, straight lines in travel, and a power of the stress between two of them.
    pub fn at(&self, travel_mm: f64, yield_kpa: f64) -> f64 {
        if travel_mm <= 0.0 || yield_kpa <= 0.0 {
            return 0.0;
        }
        let along = |force: &[f64]| {
            let at = travel_mm / self.step_mm;
            let i = (at.ceil() as usize).clamp(1, force.len());
            let before = if i >= 2 { force[i - 2] } else { 0.0 };
            before + (force[i - 1] - before) * (at - (i - 1) as f64)
        };
        let next = self.curves.partition_point(|(kpa, _)| *kpa < yield_kpa);
        match (next.checked_sub(1).and_then(|i| self.curves.get(i)), self.curves.get(next)) {
            (None, Some((kpa, force))) => along(force) * yield_kpa / kpa,
            (Some((low, below)), Some((high, above))) => {
                let part = (yield_kpa / low).ln() / (high / low).ln();
                (along(below).max(f64::MIN_POSITIVE).ln() * (1.0 - part)
                    + along(above).max(f64::MIN_POSITIVE).ln() * part)
                    .exp()
            }
            (Some((low, below)), None) => along(below) * yield_kpa / low,
            (None, None) => 0.0,
        }
    }
}

impl Dented {
    /// A level fluid.
    pub fn new(force: FluidForce) -> Self {
        Dented { force, dent_mm: 0.0 }
    }

    /// The fluid levels out, as it does between two presses without current.
    pub fn level(&mut self) {
        self.dent_mm = 0.0;
    }

    /// Where the dent's ground is, mm below the surface, under a bone and a pulp: it gives way where it bears no more.
    pub fn under(&mut self, bone_mm: f64, yield_kpa: f64, pulp: &Pulp) -> f64 {
        let most_n = self.force.at(bone_mm, yield_kpa);
        if pulp.force_n(bone_mm - self.dent_mm) > most_n {
            self.dent_mm = self.dent_mm.max(bone_mm - pulp.compression_mm(most_n));
        }
        self.dent_mm
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::plant::{Curve, PulpLaw};

    fn table() -> FluidForce {
        FluidForce::parse("yield_kPa,travel_mm,force_N\n1,1,0.1\n1,2,0.3\n4,1,0.4\n4,2,1.2\n").unwrap()
    }

    #[test]
    fn the_table_is_read_back_between_and_beyond_its_points() {
        let force = table();
        for (u, kpa, n) in [
            (1.0, 1.0, 0.1),
            (1.5, 1.0, 0.2),
            (0.5, 4.0, 0.2),
            (2.0, 2.0, 0.6),
            (3.0, 4.0, 2.0),
            (2.0, 0.1, 0.03),
            (1.0, 8.0, 0.8),
        ] {
            assert!((force.at(u, kpa) - n).abs() < 1e-12, "{u} mm, {kpa} kPa: {}", force.at(u, kpa));
        }
        assert_eq!((force.at(-1.0, 1.0), force.at(1.0, 0.0)), (0.0, 0.0));
        assert!(FluidForce::parse("1,1,x\n").is_none() && FluidForce::parse("").is_none());
    }

    #[test]
    fn a_larger_finger_of_softer_tissue_bears_as_much_farther_down() {
        let (round, soft) = (table(), table().of_a_finger(2.0));
        assert!((soft.at(3.0, 1.0) - round.at(1.5, 4.0)).abs() < 1e-12);
    }

    #[test]
    fn a_dent_stays_when_the_finger_lifts() {
        let slow = Curve::new(0.1, &(1..=60).map(|i| 0.1 * f64::from(i)).collect::<Vec<_>>()).unwrap();
        let pulp = Pulp::new(PulpLaw { slow, relaxing: (0.0, 1.0) });
        let mut dented = Dented::new(table());
        // 0.3 N are borne at 2 mm, and the pulp gives way by 0.3 mm under them
        assert!((dented.under(2.0, 1.0, &pulp) - 1.7).abs() < 1e-6);
        assert!((dented.under(1.8, 1.0, &pulp) - 1.7).abs() < 1e-6, "it stays");
        assert!((dented.under(2.0, 4.0, &pulp) - 1.7).abs() < 1e-6, "a stiffer fluid does not rise");
        dented.level();
        assert!(dented.under(0.0, 1.0, &pulp) < 1e-6);
    }
}
