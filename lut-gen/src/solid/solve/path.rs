//! The path through a motion, step by step, each started along the tangent.

use super::newton::{Configuration, Control, Problem, Workspace};
use super::pace::Pace;
use super::stepping::Stepping;
use super::{History, Motion, Newton, Segment, SolveError, State, Step, System, Target};
use crate::solid::law::{Material, Strained};

/// One equilibrium on the path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Station {
    /// Time since the motion's start (s).
    pub time_s: f64,
    /// Depth of the ball (mm).
    pub depth_mm: f64,
    /// Force on the ball from the contact, with the penalty's softness in it (N).
    pub force_n: f64,
    /// Reaction of the base (N).
    pub base_force_n: f64,
    /// `dF/dd` at fixed time (N/mm), by the tangent that was last factorised on the way here.
    pub slope: f64,
    /// Energy stored in the penalty (N mm).
    pub penalty_energy: f64,
    /// Largest radius in contact (mm).
    pub contact_radius_mm: f64,
    /// Surface points in contact.
    pub active: usize,
    /// Of these, sliding ones; 0 without friction.
    pub sliding: usize,
    /// Index of the motion's segment.
    pub segment: usize,
    /// True while the segment holds what it prescribes.
    pub held: bool,
    /// True where the force is prescribed and the depth follows.
    pub by_force: bool,
    /// True when the last tangent was positive definite: a stable equilibrium of a conservative problem.
    pub stable: bool,
    /// True when no equilibrium led here: an adhesive contact snapped in or off since the station before.
    pub jumped: bool,
}

/// A solved path.
#[derive(Debug, Clone, PartialEq)]
pub struct Path {
    /// Equilibria in order of time, without the one at the motion's start; of planned steps their ends.
    pub stations: Vec<Station>,
    /// True when material or contact remember: at one depth the force is another on the way back.
    pub remembers: bool,
    /// Corrections, failed steps included.
    pub iterations: usize,
    /// Factorisations, failed steps included.
    pub factorisations: usize,
    /// Steps that were given up and retried shorter.
    pub cuts: usize,
}

/// An accepted equilibrium, for those who watch.
pub struct Accepted<'a> {
    /// The equations.
    pub system: &'a System,
    /// The step that led here, with the history at its start.
    pub step: &'a Step<'a>,
    /// Duration of the step (s).
    pub dt_s: f64,
    /// Displacement of the free dofs (mm).
    pub u: &'a [f64],
    /// State at `u`.
    pub state: &'a State,
    /// The equilibrium in numbers.
    pub station: Station,
    /// True inside a planned step that was taken in pieces: one to pass through, no station of the path.
    pub between: bool,
}

/// Follows a path and takes what it needs from every equilibrium.
pub trait Observer {
    /// Called once for every accepted equilibrium, in order.
    ///
    /// # Errors
    /// Ends the path.
    fn accepted(&mut self, at: &Accepted) -> Result<(), SolveError>;
}

impl Observer for () {
    fn accepted(&mut self, _: &Accepted) -> Result<(), SolveError> {
        Ok(())
    }
}

/// An adhesive contact is let jump when its steps, as part of the segment, fall below this many of
/// the smallest.
const JUMPING: f64 = 100.0;

/// What is followed.
#[derive(Debug, Clone, Copy)]
pub struct Course<'a> {
    /// The equations.
    pub system: &'a System,
    /// The material.
    pub material: &'a Material,
    /// The motion of the ball.
    pub motion: &'a Motion,
    /// Newton's method.
    pub newton: Newton,
    /// Control of the steps.
    pub stepping: Stepping,
    /// Hertz's factor `F / d^1.5` (N/mm^1.5): a first guess of the depth under a prescribed force.
    pub hertz: f64,
    /// Names the case in errors.
    pub label: &'a str,
}

/// What kind of step is taken.
#[derive(Debug, Clone, Copy)]
struct Kind {
    /// What is prescribed stays.
    held: bool,
    /// An adhesive contact may jump.
    jumps: bool,
    /// A piece of a planned step, not its last.
    between: bool,
}

/// Where the path stands.
struct Here {
    time_s: f64,
    at: Configuration,
    force_n: f64,
    /// What the last segment ended at.
    target: Option<Target>,
    history: History,
}

/// True when a material or a contact remembers.
pub(crate) fn remembers<T: Strained>(system: &System<T>, material: &Material<T>) -> bool {
    !material.is_elastic() || system.surface().has_friction()
}

/// Most equilibria of a path.
const MOST_STATIONS: usize = 100_000;

impl Course<'_> {
    /// Follows the equilibrium through the motion.
    ///
    /// # Errors
    /// [`SolveError::NoConvergence`] and [`SolveError::TooManyIterations`], named by the label;
    /// what the observer returns.
    pub fn follow(&self, observer: &mut impl Observer) -> Result<Path, SolveError> {
        let symmetric = self.material.is_symmetric() && !self.system.surface().has_friction();
        let mut w = Workspace::new(self.system, symmetric)?;
        let start = self.motion.start_mm;
        let mut here = Here {
            time_s: 0.0,
            at: Configuration { u: vec![0.0; self.system.unknowns()], depth_mm: start },
            force_n: 0.0,
            target: None,
            history: self.system.untouched(self.material, start),
        };
        let remembers = remembers(self.system, self.material);
        let mut out = Path { stations: Vec::new(), remembers, iterations: 0, factorisations: 0, cuts: 0 };
        for index in 0..self.motion.segments.len() {
            self.segment(index, &mut here, &mut w, &mut out, observer)?;
        }
        (out.iterations, out.factorisations) = (w.iterations, w.factorisations);
        Ok(out)
    }

    fn segment(
        &self,
        index: usize,
        here: &mut Here,
        w: &mut Workspace,
        out: &mut Path,
        observer: &mut impl Observer,
    ) -> Result<(), SolveError> {
        let segment = self.motion.segments[index];
        // from what was prescribed before, so that a hold is recognised exactly
        let (end, from) = match (segment.end, here.target) {
            (Target::DepthMm(d), Some(Target::DepthMm(before))) => (d, before),
            (Target::DepthMm(d), _) => (d, here.at.depth_mm),
            (Target::ForceN(f), Some(Target::ForceN(before))) => (f, before),
            (Target::ForceN(f), _) => (f, here.force_n),
        };
        here.target = Some(segment.end);
        let start_s = here.time_s;
        let first = self.stepping.first_of(self.material, self.motion, from, end, &segment);
        let (mut done, mut pace) = (0.0, Pace::new(first, self.is_planned(&segment)));
        while done < 1.0 - 1e-12 {
            let longest = self.stepping.longest(self.material, self.motion, from, end, &segment, done);
            let (take, to) = pace.next(done, longest);
            let aim = if to == 1.0 { end } else { from + (end - from) * to };
            let control = match segment.end {
                Target::DepthMm(_) => Control::Depth(aim),
                Target::ForceN(_) => Control::Force(aim),
            };
            let held = from == end;
            let jumps = take < JUMPING * self.stepping.smallest && to < 1.0 && self.adhesion_range_mm().is_some();
            let kind = Kind { held, jumps, between: pace.is_between(to) };
            match self.step(index, kind, control, take * segment.duration_s, here, w, observer, out)? {
                Some(used) => {
                    done = to;
                    here.time_s = start_s + done * segment.duration_s;
                    pace.taken(take, done, used, &self.stepping);
                    if jumps {
                        pace.set(longest);
                    }
                }
                None => {
                    out.cuts += 1;
                    let step = pace.cut(take);
                    if step.is_nan() || step < self.stepping.smallest.min(1e-4 * first) {
                        return Err(self.lost(here, w));
                    }
                }
            }
            if w.factorisations > self.stepping.factorisations || out.stations.len() > MOST_STATIONS {
                return Err(SolveError::TooManyIterations {
                    depth_mm: here.at.depth_mm,
                    wanted_mm: self.motion.deepest_mm(),
                    iterations: w.iterations,
                    case: self.label.to_owned(),
                });
            }
        }
        Ok(())
    }

    /// One step, along the path or by a jump from where it ends; returns the factorisations it
    /// took, or `None` when it must be shorter.
    #[expect(clippy::too_many_arguments, reason = "the state of the path, taken apart for the borrow checker")]
    fn step(
        &self,
        segment: usize,
        Kind { held, jumps, between }: Kind,
        control: Control,
        dt_s: f64,
        here: &mut Here,
        w: &mut Workspace,
        observer: &mut impl Observer,
        out: &mut Path,
    ) -> Result<Option<usize>, SolveError> {
        let problem = Problem { system: self.system, material: self.material, old: &here.history, dt_s, control };
        let found = if jumps { self.fallen(&problem, here, w) } else { self.led(&problem, here, w) };
        let Some((next, used)) = found else {
            w.went_astray();
            return Ok(None);
        };
        let relaxation = self.material.relaxation(dt_s);
        let step = Step { material: self.material, relaxation, old: &here.history, depth_mm: next.depth_mm };
        // Newton's method, too, may find the branch beyond the end of this one
        let jumped = self.adhesion_range_mm().is_some_and(|range| Newton::is_jump(range, &here.at, &next));
        let by_force = problem.by_force();
        let reached = self.station(segment, here.time_s + dt_s, next.depth_mm, w);
        let station = Station { jumped, held, by_force, ..reached };
        observer.accepted(&Accepted {
            system: self.system,
            step: &step,
            dt_s,
            u: &next.u,
            state: &w.state,
            station,
            between,
        })?;
        if !between {
            out.stations.push(station);
        }
        here.force_n = station.force_n;
        here.at = next;
        here.history.clone_from(&w.state.history);
        Ok(Some(used))
    }

    /// The next equilibrium along the path. With adhesion it must be stable: an unstable one is
    /// on a branch that no experiment follows.
    fn led(&self, problem: &Problem, here: &Here, w: &mut Workspace) -> Option<(Configuration, usize)> {
        if w.is_astray() && !self.newton.refactorise(problem, &here.at, w) {
            return None;
        }
        let mut next = self.ahead(problem, here, w)?;
        let used = self.newton.equilibrate(problem, &mut next, w)?;
        let stable = self.adhesion_range_mm().is_none() || self.newton.is_stable(problem, &next, w);
        stable.then_some((next, used))
    }

    /// The equilibrium the block falls to when the path ends at a prescribed depth.
    fn fallen(&self, problem: &Problem, here: &Here, w: &mut Workspace) -> Option<(Configuration, usize)> {
        let Control::Depth(depth_mm) = problem.control else { return None };
        let mut next = Configuration { depth_mm, ..here.at.clone() };
        let used = self.newton.fall(problem, self.adhesion_range_mm()?, &mut next, w)?;
        Some((next, used))
    }

    /// True where steps must not follow the effort: it is asked for, or something remembers them. An adhesive
    /// contact's jumps ask for ever shorter ones, and a prescribed force for those that its depth allows.
    fn is_planned(&self, segment: &Segment) -> bool {
        let by_depth = matches!(segment.end, Target::DepthMm(_));
        let moved = self.stepping.planned || remembers(self.system, self.material);
        by_depth && moved && self.adhesion_range_mm().is_none()
    }

    fn adhesion_range_mm(&self) -> Option<f64> {
        self.system.surface().interface().adhesion.map(|a| a.range_mm)
    }

    /// Where Newton's method starts: along the tangent in depth, which is at the same time its
    /// first correction. A quadratic start was measured to need a fifth more iterations: surface
    /// points entering contact make the second derivative jump. Under a prescribed force that
    /// meets no contact yet, at the depth Hertz gives.
    fn ahead(&self, problem: &Problem, here: &Here, w: &mut Workspace) -> Option<Configuration> {
        let mut next = here.at.clone();
        let climb = match problem.control {
            Control::Depth(depth) => depth - here.at.depth_mm,
            Control::Force(force) if here.force_n > 0.0 => (force - here.force_n) / w.slope(),
            Control::Force(force) => {
                next.depth_mm = (force.max(0.0) / self.hertz).powf(2.0 / 3.0);
                let guess = Problem { control: Control::Depth(next.depth_mm), ..*problem };
                self.newton.equilibrate(&guess, &mut next, w)?;
                return Some(next);
            }
        };
        if climb.is_finite() {
            next.depth_mm += climb;
            for (u, v) in next.u.iter_mut().zip(w.rate()) {
                *u += climb * v;
            }
        }
        Some(next)
    }

    fn station(&self, segment: usize, time_s: f64, depth_mm: f64, w: &mut Workspace) -> Station {
        let slope = w.slope();
        let sum = &w.state.sum;
        Station {
            time_s,
            depth_mm,
            force_n: sum.force_n,
            base_force_n: w.state.base_force_n,
            slope,
            penalty_energy: sum.penalty_energy,
            contact_radius_mm: sum.radius_mm,
            active: sum.active,
            sliding: sum.sliding,
            segment,
            held: false,
            by_force: false,
            stable: w.matrix.is_definite(),
            jumped: false,
        }
    }

    fn lost(&self, here: &Here, w: &Workspace) -> SolveError {
        SolveError::NoConvergence {
            depth_mm: here.at.depth_mm,
            wanted_mm: self.motion.deepest_mm(),
            time_s: here.time_s,
            iterations: w.iterations,
            case: self.label.to_owned(),
        }
    }
}
