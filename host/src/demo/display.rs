//! A palpated material, displayed to a finger.

use protocol::lut::{Material, Table};
use protocol::message::{Mode, State, Telemetry};

use super::listening::Listening;
use super::{DemoError, Palpated};
use crate::control::ShownTicks;
use crate::plant::Touch;
use crate::session::Event;

/// How long the finger presses, s.
const DURATION_S: f64 = 6.0;

/// What the hand does: two presses of 3 N in that time.
const TOUCH: Touch = Touch { peak_n: 3.0, period_s: 3.0 };

/// One control tick of the display.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DisplayTrace {
    /// Time since the display began, s.
    pub time_s: f64,
    /// True force of the finger, N.
    pub true_force_n: f64,
    /// FSR as read, N.
    pub sensor_force_n: f64,
    /// Where the controller wants the shaft, mm.
    pub target_mm: f64,
    /// Shaft as read, mm.
    pub sensor_shaft_mm: f64,
    /// True shaft, mm.
    pub true_shaft_mm: f64,
    /// Current the controller wants, A.
    pub target_a: f64,
    /// Coil current as read, A.
    pub sensor_a: f64,
    /// True coil current, A.
    pub true_a: f64,
    /// True flux density in the fluid, T.
    pub true_flux_t: f64,
    /// Where the table wants the shaft under the true force, mm.
    pub material_mm: f64,
    /// A finger touches, and the board holds the current at an end of what it can give this material.
    pub at_limit: bool,
    /// A finger touches, and the table marks its force as unreachable.
    pub marked: bool,
}

/// A displayed material.
#[derive(Debug, Clone, PartialEq)]
pub struct Displayed {
    /// Its name.
    pub material: String,
    /// Tick by tick.
    pub trace: Vec<DisplayTrace>,
    /// What the board says of these ticks.
    pub ticks: ShownTicks,
}

/// Ticks of a display at the coil's limit, against those that the table marks unreachable.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LimitTicks {
    /// Touched ticks at the coil's limit.
    pub at_limit: usize,
    /// Touched ticks whose force the table marks unreachable.
    pub unreachable: usize,
    /// Both at once.
    pub both: usize,
}

impl LimitTicks {
    /// The touched ticks at the coil's limit are those that the table marks unreachable, and no others.
    pub fn agree(&self) -> bool {
        self.at_limit == self.both && self.unreachable == self.both
    }
}

impl std::fmt::Display for LimitTicks {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let LimitTicks { at_limit, unreachable, both } = self;
        write!(f, "{at_limit} touched ticks at the coil's limit, {unreachable} that the table marks unreachable: ")?;
        match self.agree() {
            true => write!(f, "the same"),
            false => write!(f, "only {both} are both"),
        }
    }
}

impl Displayed {
    /// Root mean square of target minus true shaft, mm.
    pub fn tracking_rms_mm(&self) -> f64 {
        let squares: f64 = self.trace.iter().map(|p| (p.target_mm - p.true_shaft_mm).powi(2)).sum();
        (squares / self.trace.len().max(1) as f64).sqrt()
    }

    /// Ticks at the coil's limit.
    pub fn limits(&self) -> LimitTicks {
        let count = |is: fn(&DisplayTrace) -> bool| self.trace.iter().filter(|tick| is(tick)).count();
        LimitTicks {
            at_limit: count(|tick| tick.at_limit),
            unreachable: count(|tick| tick.marked),
            both: count(|tick| tick.at_limit && tick.marked),
        }
    }
}

/// Currents at the least and the largest reachable force of a material, A; none without control
/// curve.
fn current_limits_a(material: &Material<'_>) -> Option<(f32, f32)> {
    let (from_n, to_n) = material.coil()?.reachable_n;
    // Without force there is no current, and no least one.
    let least_a = material.current(from_n).filter(|_| from_n > 0.0).map_or(f32::NEG_INFINITY, |current| current.a);
    Some((least_a, material.current(to_n)?.a))
}

/// Whether the board's record is one of a finger at the coil's limit, and whether the table marks it.
fn at_limit(material: &Material<'_>, record: &Telemetry) -> (bool, bool) {
    let touched = record.state == State::Display && record.fsr_n > 0.0;
    let (Some((least_a, most_a)), Some(wanted), true) =
        (current_limits_a(material), material.current(record.fsr_n), touched)
    else {
        return (false, false);
    };
    let target_a = record.coil_target_a;
    // Held at an end of what can be reached, to the bit: a curve may rise and fall in between. A
    // current that heat cuts is at a limit as well, and the table does not know of it.
    let is_held = [least_a, most_a].contains(&target_a);
    (is_held || target_a < wanted.a, wanted.unreachable)
}

/// Most that the display's shaft can give way, mm (the board's own limit): softer foams are not displayed to this hand.
const STROKE_MM: f32 = 4.5;

/// Of this hand's force what the coil reaches of a material, N; without a control curve none.
fn reached_n(material: &Material<'_>) -> f32 {
    material.coil().map_or(0.0, |coil| coil.reachable_n.1.min(TOUCH.peak_n as f32))
}

/// Which of the recognised materials is displayed: of those whose displacement under this hand the shaft can follow that
/// with the longest part of the touch within the coil's reach, and of several the last. Without one the library's first.
fn chosen(table: &Table<'_>, palpated: &[Palpated]) -> u8 {
    let of = |p: &Palpated| Some((p.verdict.material.index, table.material(usize::from(p.verdict.material.index))?));
    let recognised = palpated.iter().filter(|p| p.recognised()).filter_map(of);
    let within = recognised.filter(|(_, material)| material.shaft_mm(TOUCH.peak_n as f32) <= STROKE_MM);
    let best = within.max_by(|a, b| reached_n(&a.1).total_cmp(&reached_n(&b.1)));
    best.map_or(0, |(index, _)| index)
}

/// Displays one of the materials that were recognised.
pub(super) fn display(
    listening: &mut Listening,
    table: &Table<'_>,
    palpated: &[Palpated],
) -> Result<Displayed, DemoError> {
    let index = chosen(table, palpated);
    let material = table.material(usize::from(index)).ok_or(DemoError::NoLibrary)?;
    listening.session().set_mode(Mode::Display { material: index })?;
    listening.board().touch(Some(TOUCH));
    let began_s = listening.now_s();
    let (mut trace, mut ticks) = (Vec::new(), ShownTicks::default());
    while let Some((event, truth)) = listening.next(began_s + DURATION_S)? {
        let (Event::Telemetry(t), Some(truth)) = (event, truth) else {
            continue;
        };
        if truth.time_s < began_s {
            continue;
        }
        ticks.add(&t);
        let (at_limit, marked) = at_limit(&material, &t);
        trace.push(DisplayTrace {
            time_s: truth.time_s - began_s,
            true_force_n: truth.finger_n,
            sensor_force_n: f64::from(t.fsr_n),
            target_mm: f64::from(t.shaft_target_mm),
            sensor_shaft_mm: f64::from(t.shaft_mm),
            true_shaft_mm: truth.shaft_mm,
            target_a: f64::from(t.coil_target_a),
            sensor_a: f64::from(t.coil_a),
            true_a: truth.coil_a,
            true_flux_t: truth.flux_t,
            material_mm: f64::from(material.shaft_mm(truth.finger_n as f32)),
            at_limit,
            marked,
        });
    }
    listening.board().touch(None);
    listening.session().set_mode(Mode::Idle)?;
    Ok(Displayed { material: material.name.to_owned(), trace, ticks })
}
