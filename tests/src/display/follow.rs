//! What becomes of an answer that is not sure when the runs are made that it proposes.

use palpate::diagnose::Verdict;
use palpate::diagnose::display::channel::Channel;
use palpate::diagnose::display::command::Command;
use palpate::diagnose::display::plan::Proposal;
use palpate::diagnose::display::{self, Diagnosis};
use palpate::finger::round;
use palpate::simulate::display::{DisplayRun, DisplaySpec, Subject};

use super::{Case, Scored};

/// Commands that are given one after the other, and how often each.
pub const MOST_COMMANDS: usize = 2;
const TIMES: usize = 3;

/// How following the proposals ended.
#[derive(Debug, Clone)]
pub struct Followed {
    /// What was proposed and done.
    pub commands: Vec<String>,
    /// The last answer; visible as before.
    pub scored: Scored,
}

impl Followed {
    /// Gives the command that an unknown or ambiguous channel proposes first, diagnoses all runs again, and once more while it is
    /// not sure. None where nothing is proposed.
    #[must_use]
    pub fn of(case: &Case, found: &Diagnosis, first: &Scored) -> Option<Self> {
        let mut spec = case.spec(true);
        let mut next = proposed(found);
        let mut followed: Option<Self> = None;
        let mut commands = Vec::new();
        while let Some((channel, Proposal { what, command, .. })) = next.take() {
            spec.runs.push(run(channel, &command, &spec));
            commands.push(format!("{}: {what}", channel.word()));
            let found = display::diagnose(&spec.experiment(), &|_, _, _| {})?;
            if commands.len() < MOST_COMMANDS {
                next = proposed(&found);
            }
            let scored = Scored { strength: first.strength, ..Scored::judged(case, &found) };
            followed = Some(Self { commands: commands.clone(), scored });
        }
        followed
    }
}

/// The next command: that which tells most of a channel which is not sure.
fn proposed(found: &Diagnosis) -> Option<(Channel, Proposal)> {
    let open = found.channels.iter().filter(|c| matches!(c.verdict, Verdict::Unknown | Verdict::Ambiguous));
    let first = open.filter_map(|c| Some((c.channel, c.proposals.first()?.clone())));
    first.max_by(|a, b| a.1.distance.total_cmp(&b.1.distance))
}

/// A proposed command as it is given, three times.
fn run(channel: Channel, command: &Command, spec: &DisplaySpec) -> DisplayRun {
    let subject = match channel {
        Channel::Position => Subject::Position,
        Channel::Force => Subject::Force,
        Channel::Current | Channel::Flux => Subject::Coil,
        Channel::Pulp => Subject::Pulp,
        Channel::Fluid => Subject::Fluid,
    };
    let mut run = DisplayRun::new(subject, command.values.clone(), command.hold_s).ramped(command.ramp_s).times(TIMES);
    if let Some(gap_mm) = command.gap_mm {
        run.gap_mm = gap_mm;
    }
    if channel == Channel::Fluid {
        let all = spec.runs.iter().flat_map(|run| run.current_a.iter().copied());
        let most_a = all.fold(0.0_f64, f64::max);
        let parts = if command.yield_parts.is_empty() { &[1.0][..] } else { &command.yield_parts };
        run.current_a = parts.iter().map(|part| current_a(*part, most_a)).collect();
    }
    run
}

/// Current, A, for a part of the yield stress of the largest, by the magnet's measured line (thesis Table 6) and the fluid's law.
fn current_a(part: f64, most_a: f64) -> f64 {
    let yield_kpa = |a: f64| round::yield_kpa(0.0256 * a + 0.0206 * (a / 0.4).tanh());
    let wanted_kpa = part * yield_kpa(most_a);
    let (mut low, mut high) = (0.0, most_a);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if yield_kpa(middle) < wanted_kpa { low = middle } else { high = middle }
    }
    if part > 0.0 { high } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_current_for_a_part_of_the_yield_stress() {
        assert_eq!(current_a(0.0, 2.5), 0.0);
        assert!((current_a(1.0, 2.5) - 2.5).abs() < 1e-9);
        let tenth = current_a(0.1, 2.5);
        assert!(tenth > 0.05 && tenth < 0.6, "{tenth}");
    }
}
