//! Where the steps of one segment end.
//!
//! What remembers its path has an error of its steps in it. Steps that follow how hard each equilibrium was would
//! let that error jump between neighbouring materials; planned ones let it move smoothly with every parameter.

use super::stepping::Stepping;

/// Steps of a segment, in parts of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pace {
    /// What is tried next.
    step: f64,
    /// The planned step that is under way; `None` where steps follow the effort alone.
    plan: Option<Plan>,
}

/// A step whose end is met whatever it takes.
#[derive(Debug, Clone, Copy)]
struct Plan {
    length: f64,
    goal: f64,
}

/// Length and end of a step on the way to a goal: of a length, or all of the rest; two equal steps rather than a full
/// one and a sliver.
fn toward(goal: f64, done: f64, length: f64) -> (f64, f64) {
    let rest = goal - done;
    let take = if length >= rest { rest } else { length.min(0.5 * rest) };
    (take, if take == rest { goal } else { done + take })
}

impl Pace {
    /// Begins with a step; `planned` steps end where no effort moves them.
    pub(super) fn new(first: f64, planned: bool) -> Self {
        let plan = Plan { length: first, goal: 0.0 };
        Self { step: first, plan: planned.then_some(plan) }
    }

    /// Length and end of the next step, of which `longest` is allowed at `done`.
    pub(super) fn next(&mut self, done: f64, longest: f64) -> (f64, f64) {
        let Some(plan) = &mut self.plan else {
            self.step = f64::min(self.step, longest);
            return toward(1.0, done, self.step);
        };
        if done >= plan.goal {
            (plan.length, plan.goal) = toward(1.0, done, plan.length.min(longest));
        }
        toward(plan.goal, done, self.step)
    }

    /// True where a planned step goes on beyond a place.
    pub(super) fn is_between(&self, to: f64) -> bool {
        self.plan.is_some_and(|plan| to < plan.goal)
    }

    /// After a step that was taken, to `done`, with so many factorisations.
    pub(super) fn taken(&mut self, take: f64, done: f64, used: usize, stepping: &Stepping) {
        match &mut self.plan {
            // Where it took pieces the next is tried as a whole all the same: what one hard place asks for ends with it.
            Some(plan) if done >= plan.goal => {
                plan.length *= stepping.growth;
                self.step = f64::INFINITY;
            }
            _ => self.step = take * stepping.stretch(used),
        }
    }

    /// After one that has to be shorter; its new length.
    pub(super) fn cut(&mut self, take: f64) -> f64 {
        self.step = 0.4 * take;
        self.step
    }

    /// Goes on with a given step, if the effort decides.
    pub(super) fn set(&mut self, step: f64) {
        self.step = step;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ends of the steps of a segment of which some fail until they are short enough.
    fn ends(planned: bool, most: impl Fn(f64) -> f64) -> Vec<f64> {
        let stepping = Stepping::of_ball(1.0);
        let (mut pace, mut done, mut all) = (Pace::new(0.01, planned), 0.0, Vec::new());
        while done < 1.0 {
            let (take, to) = pace.next(done, 0.1);
            assert!(take > 0.0 && to <= 1.0, "{done} {take} {to}");
            if take <= most(done) {
                // The harder half takes more factorisations.
                pace.taken(take, to, if done < 0.5 { 1 } else { 7 }, &stepping);
                done = to;
                all.push(done);
            } else {
                assert!(pace.cut(take) < take);
            }
        }
        all
    }

    #[test]
    fn planned_steps_end_where_they_end_without_a_hard_place() {
        let easy = ends(true, |_| 1.0);
        let hard = ends(true, |done| if (0.3..0.4).contains(&done) { 0.02 } else { 1.0 });
        assert!(hard.len() > easy.len() && easy.iter().all(|end| hard.contains(end)), "{easy:?} {hard:?}");
        let by_effort = ends(false, |_| 1.0);
        assert_ne!(by_effort, easy);
        assert_eq!((easy.last(), hard.last(), by_effort.last()), (Some(&1.0), Some(&1.0), Some(&1.0)));
    }
}
