//! A magnet's coil as a circuit: what its winding and the flux linkage over current make of a
//! voltage.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, LazyLock};

use lut_gen::magnet::bh::LawError;
use lut_gen::magnet::curve::Rising;
use lut_gen::magnet::study::Wanted;
use lut_gen::magnet::winding::Winding;

use super::simulated::Unsimulated;
use super::{Magnet, parse};

/// The ring's file.
const RING: &str = include_str!("../../magnets/ring.toml");

/// Flux linkage of the ring over current, by finite elements: `palpate magnet ring --current
/// 0:3:0.125`, and 3.5, 4, 5 and 6 A. Solving takes 4 s, too long for the start of a simulation;
/// `tests/tests/suite/winding.rs` solves again and compares.
const RING_LINKAGE: &str = include_str!("../../magnets/ring-linkage.csv");

/// Places of the current over linkage, evenly: straight lines between them are within 1e-4 of the
/// ring's curve.
const PLACES: usize = 512;

/// A coil on a core that saturates.
#[derive(Debug, Clone, PartialEq)]
pub struct Circuit {
    /// Its wire: resistance, heat, surroundings.
    pub winding: Winding,
    /// The largest linkage that is known, Wb.
    most_wb: f64,
    /// Current, A, at linkages from 0 to the largest, evenly.
    current_a: Vec<f64>,
}

/// Why a magnet is no circuit.
#[derive(Debug, thiserror::Error)]
pub enum NoCircuit {
    /// Its field.
    #[error(transparent)]
    Field(#[from] Unsimulated),
    /// Its linkage over current.
    #[error("the flux linkage over current: {0}")]
    Linkage(#[from] LawError),
    /// There is no coil, or there are several.
    #[error("a circuit has one coil; the magnet has {0}")]
    Coils(usize),
    /// A row of a table.
    #[error("line {0} is no current and linkage: expected two numbers with a comma")]
    Row(usize),
}

impl Circuit {
    /// From currents (A) and linkages (Wb), both rising from zero.
    ///
    /// # Errors
    /// [`NoCircuit::Linkage`].
    pub fn new(winding: Winding, linkage: &[(f64, f64)]) -> Result<Self, NoCircuit> {
        let (current, linked): (Vec<f64>, Vec<f64>) = linkage.iter().copied().unzip();
        let curve = Rising::new(linked, current)?;
        let (most_wb, _) = curve.last();
        let current_a = (0..PLACES).map(|i| curve.at(most_wb * i as f64 / (PLACES - 1) as f64)).collect();
        Ok(Circuit { winding, most_wb, current_a })
    }

    /// By finite elements at currents that rise from above zero, A: a second or more.
    ///
    /// # Errors
    /// [`NoCircuit`].
    pub fn solved(magnet: &Magnet, currents: &[f64]) -> Result<Self, NoCircuit> {
        let (winding, mut linkage) = linkage(magnet, currents)?;
        linkage.insert(0, (0.0, 0.0));
        Circuit::new(winding, &linkage)
    }

    /// The display's ring: its file, and the table of its linkage. Reading both takes a
    /// millisecond.
    ///
    /// # Errors
    /// [`NoCircuit`].
    pub fn read_ring() -> Result<Self, NoCircuit> {
        let magnet = parse(Path::new("ring.toml"), RING, &BTreeMap::new()).map_err(Unsimulated::from)?;
        let [coil] = magnet.design.coils.as_slice() else { return Err(NoCircuit::Coils(magnet.design.coils.len())) };
        Circuit::new(coil.winding, &ring_linkage()?)
    }

    /// The display's ring, read once.
    pub fn ring() -> Arc<Self> {
        static READ: LazyLock<Arc<Circuit>> = LazyLock::new(|| {
            #[expect(clippy::expect_used, reason = "both files are part of the program, and a test reads them")]
            Arc::new(Circuit::read_ring().expect("the ring that comes with the program"))
        });
        READ.clone()
    }

    /// Current at a linkage, A; the ends go on as straight lines.
    pub fn current_a(&self, linkage_wb: f64) -> f64 {
        let (place, slope) = self.place(linkage_wb);
        self.current_a[place] + slope * (linkage_wb - self.step_wb() * place as f64)
    }

    /// Inductance that a change of current meets at a linkage, H.
    pub fn inductance_h(&self, linkage_wb: f64) -> f64 {
        1.0 / self.place(linkage_wb).1
    }

    /// Linkage (Wb) after a time under a voltage (V) over a resistance (Ohm): `d linkage / dt = V -
    /// R i` with the inductance as it is now. Exact for a coil that does not saturate, of second
    /// order for one that does, and stable for any time (Rosenbrock-Euler). A freewheeling diode
    /// keeps the current from reversing.
    pub fn after_wb(&self, linkage_wb: f64, (volt, ohm): (f64, f64), dt_s: f64) -> f64 {
        let time_s = self.inductance_h(linkage_wb) / ohm;
        let reach_s = -time_s * (-dt_s / time_s).exp_m1();
        (linkage_wb + (volt - ohm * self.current_a(linkage_wb)) * reach_s).max(0.0)
    }

    fn step_wb(&self) -> f64 {
        self.most_wb / (PLACES - 1) as f64
    }

    /// The place at or below a linkage, and the slope to the next one, A/Wb.
    fn place(&self, linkage_wb: f64) -> (usize, f64) {
        let place = (linkage_wb / self.step_wb()).clamp(0.0, (PLACES - 2) as f64) as usize;
        (place, (self.current_a[place + 1] - self.current_a[place]) / self.step_wb())
    }
}

/// Winding of a magnet with one coil, and its linkage (Wb) at these currents (A) by finite
/// elements.
///
/// # Errors
/// [`NoCircuit`].
pub fn linkage(magnet: &Magnet, currents: &[f64]) -> Result<(Winding, Vec<(f64, f64)>), NoCircuit> {
    let [coil] = magnet.design.coils.as_slice() else { return Err(NoCircuit::Coils(magnet.design.coils.len())) };
    let wanted = Wanted { coarser: 1.0, is_single: true, ..Wanted::default() };
    let study = magnet.design.study(&wanted, currents, &mut |_| {}).map_err(Unsimulated::from)?;
    let linked = study.states.iter().map(|state| (coil.share * state.ampere, state.linkage_wb[0].value));
    Ok((coil.winding, linked.collect()))
}

/// Currents (A) and linkages (Wb) of the ring's table.
///
/// # Errors
/// [`NoCircuit::Row`].
pub fn ring_linkage() -> Result<Vec<(f64, f64)>, NoCircuit> {
    let row = |(i, line): (usize, &str)| {
        let (current, linked) = line.split_once(',').ok_or(NoCircuit::Row(i + 1))?;
        let number = |text: &str| text.trim().parse::<f64>().map_err(|_| NoCircuit::Row(i + 1));
        Ok((number(current)?, number(linked)?))
    };
    RING_LINKAGE.lines().enumerate().skip(1).map(row).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn the_ring_is_read_and_its_current_is_that_of_its_table() {
        let ring = Circuit::read_ring().unwrap();
        for (ampere, linkage_wb) in ring_linkage().unwrap() {
            // Straight lines between 512 places.
            let read = ring.current_a(linkage_wb);
            assert!((read - ampere).abs() < 1e-4 * ampere.max(1.0), "{ampere}: {read}");
        }
        // Computed: 40 mH at rest, 5 mH at 2.5 A, less than 2 mH at 5 A (two digits).
        let henry = |ampere: f64| {
            let table = ring_linkage().unwrap();
            ring.inductance_h(table.iter().find(|(a, _)| *a == ampere).unwrap().1)
        };
        assert!((henry(0.0) / 0.0397 - 1.0).abs() < 0.02, "{}", henry(0.0));
        assert!((henry(2.5) / 0.0047 - 1.0).abs() < 0.05, "{}", henry(2.5));
        assert!(henry(5.0) < 2e-3 && ring.current_a(0.06) > 6.0 && ring.current_a(-1e-3) < 0.0);
    }

    #[test]
    fn what_is_no_circuit_is_named() {
        let winding = Circuit::ring().winding;
        let falls = Circuit::new(winding, &[(0.0, 0.0), (1.0, 0.03), (2.0, 0.02)]).unwrap_err();
        assert!(falls.to_string().starts_with("the flux linkage over current: "), "{falls}");
    }
}
