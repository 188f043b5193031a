//! A command that arrives late.

use super::{Effect, Quantity, Stage};
use crate::diagnose::display::channel::Channel;

/// Dead time between the logged command and the drive.
pub const EFFECT: Effect = Effect {
    code: "delay",
    form: "dead-time",
    channel: Channel::Position,
    stage: Stage::Link,
    assumption: "the drive acts in the tick in which the command is logged",
    signature: "right after every change of the command, in proportion to the speed, the same at every amplitude",
    twins: &["rate-limit", "stiction"],
    separated_by: "steps of several heights, and a fast sine: a delay alone shifts every motion by one time",
    quantities: &[Quantity {
        name: "delay_s",
        null: Some(0.0),
        bounds: (0.0, 0.5),
        plausible: 0.02,
        starts: &[0.01, 0.04, 0.1],
        logarithmic: false,
    }],
};

/// Mean command (mm) over the time from `from_s` to `to_s`, the logged command holding from its time stamp to the next.
///
/// `from_s` < `to_s`. Before the first stamp the first command holds. `hint` is where the search begins, and ends.
#[must_use]
pub fn held(time_s: &[f64], command_mm: &[f64], (from_s, to_s): (f64, f64), hint: &mut usize) -> f64 {
    let last = time_s.len().saturating_sub(1);
    let mut at = (*hint).min(last);
    while at > 0 && time_s[at] > from_s {
        at -= 1;
    }
    while at < last && time_s[at + 1] <= from_s {
        at += 1;
    }
    *hint = at;
    let (mut sum, mut now_s) = (0.0, from_s);
    while now_s < to_s {
        let until_s = if at < last { time_s[at + 1].min(to_s) } else { to_s };
        // two rows with one stamp hold for no time
        sum += command_mm[at] * (until_s - now_s).max(0.0);
        now_s = until_s.max(now_s);
        if at == last || until_s >= to_s {
            break;
        }
        at += 1;
    }
    sum / (to_s - from_s)
}
