//! What is read of every state of a press.

use lut_gen::pad::control::felt::Averages;
use lut_gen::pad::ellipse::Print;
use lut_gen::pad::error::PadError;
use lut_gen::pad::state::State;

use super::press::Pressed;

/// Width of a bin of the histogram, MPa: the thesis' 1 kPa (Fig. 56).
pub const BIN_MPA: f64 = 1e-3;
/// Most bins; what is above is in the last one.
const MOST_BINS: usize = 2000;

/// Mises stress of the block at its nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct Stresses {
    /// Averages over the nodes, as the thesis takes them (MPa); they depend on where the mesh has its nodes.
    pub nodes: Averages,
    /// Mean over the block's volume at rest (MPa), which does not.
    pub volume_mean_mpa: f64,
    /// Nodes in bins of 1 kPa, from 0.
    pub bins: Vec<usize>,
}

/// One travel.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// Travel of the bone, mm.
    pub travel_mm: f64,
    /// Force, N; in the plane N/mm.
    pub force_n: f64,
    /// Radius of the contact, in the plane its half width, mm.
    pub radius_mm: f64,
    /// Area of the flat print, mm2; in the plane its width, mm.
    pub print_mm2: f64,
    /// Area of the curved contact, mm2; in the plane its length, mm.
    pub area_mm2: f64,
    /// Height of the cap that dips in, mm.
    pub cap_mm: f64,
    /// How far the block is pressed in on the axis, mm.
    pub depression_mm: f64,
    /// Highest contact pressure of those of [`profile`], MPa.
    pub peak_mpa: f64,
    /// Mean contact pressure over the curved area, MPa.
    pub mean_mpa: f64,
    /// Mises stress of the block; `None` on a plate.
    pub mises: Option<Stresses>,
}

impl Reading {
    /// Of a state of a press.
    pub fn of(pressed: &Pressed, state: &State) -> Self {
        let (mut load, mut area) = (0.0, 0.0);
        for touch in &state.pressure {
            let own = touch.length_mm * pressed.section.depth_mm(touch.at[0]);
            load += touch.pressure_mpa * own;
            area += own;
        }
        Reading {
            travel_mm: state.travel_mm,
            force_n: state.force_n,
            radius_mm: state.half_width_mm,
            print_mm2: pressed.section.print_mm2(state.half_width_mm),
            area_mm2: state.area_mm2,
            cap_mm: state.cap_mm,
            depression_mm: state.depression_mm,
            peak_mpa: profile(pressed, state).iter().map(|part| part[1]).fold(0.0, f64::max),
            mean_mpa: if area > 0.0 { load / area } else { 0.0 },
            mises: Stresses::of(pressed, state),
        }
    }

    /// The contact with two radii whose ratio is `k` (thesis Eqs. 28-38).
    ///
    /// # Errors
    /// A ratio outside 0.2 to 5.
    pub fn print(&self, ratio: f64) -> Result<Print, PadError> {
        Print::of(self.radius_mm, self.area_mm2, self.cap_mm, ratio)
    }
}

impl Stresses {
    fn of(pressed: &Pressed, state: &State) -> Option<Self> {
        let nodes = Averages::of(state)?;
        let stresses = state.mises_mpa.get(pressed.lower..)?;
        let mut bins = Vec::new();
        for stress in stresses {
            let bin = ((stress / BIN_MPA) as usize).min(MOST_BINS - 1);
            if bins.len() <= bin {
                bins.resize(bin + 1, 0);
            }
            bins[bin] += 1;
        }
        let volume_mean_mpa = stresses.iter().zip(&pressed.share).map(|(s, w)| s * w).sum();
        Some(Self { nodes, volume_mean_mpa, bins })
    }
}

/// Elements of the pad that a pressure is averaged over.
const OVER: f64 = 2.0;

/// Pressure (MPa) over the distance from the axis (mm), averaged over about two elements: near the edge of a contact single
/// points swing by as much as the pressure itself, their average does not.
pub fn profile(pressed: &Pressed, state: &State) -> Vec<[f64; 2]> {
    let most = state.half_width_mm;
    let count = (most / (OVER * pressed.edge_mm)).round().max(1.0);
    let mut parts = vec![(0.0, 0.0); count as usize];
    for touch in &state.pressure {
        let at = ((touch.at[0] / most * count) as usize).min(parts.len() - 1);
        parts[at].0 += touch.pressure_mpa * touch.length_mm;
        parts[at].1 += touch.length_mm;
    }
    let width = most / count;
    let of =
        |(i, (load, length)): (usize, &(f64, f64))| (*length > 0.0).then(|| [width * (i as f64 + 0.5), load / length]);
    parts.iter().enumerate().filter_map(of).collect()
}

/// How far a reading is from that on elements of another length: of force and area, as parts of them.
pub fn apart(fine: &Reading, coarse: &Reading) -> [f64; 2] {
    let part = |a: f64, b: f64| if a == 0.0 { 0.0 } else { (b / a - 1.0).abs() };
    [part(fine.force_n, coarse.force_n), part(fine.area_mm2, coarse.area_mm2)]
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::located;
    use super::super::opposite::Opposite;
    use super::super::press::Asked;
    use super::*;

    fn asked(on: &str) -> Asked {
        let mut finger = located("round").unwrap();
        finger.finger.edge_mm = 0.4;
        Asked {
            finger,
            on: Opposite::located(on, None).unwrap(),
            travels_mm: vec![1.0, 2.0],
            speed_mm_s: 2.0,
            friction: 0.0,
            radius_mm: 25.0,
            slides: false,
        }
    }

    /// The pressure over the flat print is the force, all nodes of the block are in a bin, and their shares are the whole.
    #[test]
    fn readings_agree_with_each_other() {
        let mut told = Vec::new();
        let pressed = asked("ICF").press(1.0, &mut |done| told.push(done)).unwrap();
        assert_eq!(told, [1, 2]);
        let readings: Vec<Reading> = pressed.states.iter().map(|s| Reading::of(&pressed, s)).collect();
        for reading in &readings {
            let mises = reading.mises.as_ref().unwrap();
            assert_eq!(mises.bins.iter().sum::<usize>(), pressed.nodes.len() - pressed.lower);
            // steep slopes near the edge of the contact leave 3 % between area and print times pressure
            let force = reading.mean_mpa * reading.print_mm2;
            assert!((force / reading.force_n - 1.0).abs() < 0.05, "{reading:?}");
            assert!(reading.peak_mpa > reading.mean_mpa && reading.area_mm2 > reading.print_mm2);
            let two = reading.print(1.3).unwrap();
            assert!((two.flat_mm2 / reading.print_mm2 - 1.3).abs() < 1e-9);
            assert!(mises.volume_mean_mpa < mises.nodes.mean, "nodes are dense below the finger");
        }
        assert!((pressed.share.iter().sum::<f64>() - 1.0).abs() < 1e-9);
        assert!(readings[1].force_n > readings[0].force_n && readings[1].depression_mm > readings[0].depression_mm);
    }

    #[test]
    fn a_plate_has_no_mises_stress_and_a_flat_cap() {
        let pressed = asked("plate").press(1.0, &mut |_| {}).unwrap();
        let reading = Reading::of(&pressed, &pressed.states[0]);
        assert!(reading.mises.is_none() && reading.cap_mm < 1e-3 && reading.depression_mm == 0.0);
        let coarse = asked("plate").press(2.0, &mut |_| {}).unwrap();
        let [force, area] = apart(&reading, &Reading::of(&coarse, &coarse.states[0]));
        assert!(force > 0.0 && force < 0.05 && area < 0.2, "{force} {area}");
    }
}
