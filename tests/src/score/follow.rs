//! What becomes of an ambiguous answer when the runs are made that it proposes.

use palpate::diagnose::plan::{On, Plan};
use palpate::diagnose::{self, Diagnosis, Models, Verdict};
use palpate::experiment::{Experiment, Test};
use palpate::simulate::{Effect, RunTemplate, SimulatedExperiment, Solver, TrueLaw, TrueSpecimen, simulate};

use crate::hidden::Case;

use super::outcome::Outcome;
use super::{Answer, ScoreError, known_models, strength};

/// Most runs that are made, one after the other.
pub const MOST_RUNS: usize = 2;
/// Spots that a planned run is made on, as the plan says.
const SPOTS: usize = 2;
/// Time between the cycles of a planned run, and after the session until it is made, s.
const REST_S: f64 = 60.0;
/// Reduced modulus of a stiff block, MPa: a hard plastic.
const BLOCK_MPA: f64 = 3000.0;

/// How following the plan ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Followed {
    /// What was proposed and made.
    pub runs: Vec<Plan>,
    /// Answers before the last, one after each run.
    pub before: Vec<Answer>,
    /// The last answer.
    pub answer: Answer,
    /// How good it is.
    pub outcome: Outcome,
    /// Every name is single and right, and none is missing of what could be seen before.
    pub resolved: bool,
}

impl Followed {
    /// Makes what an ambiguous diagnosis proposes first, diagnoses again, and once more if there is still no single name. None where nothing is
    /// proposed.
    ///
    /// # Errors
    /// [`ScoreError`]: when a solve fails.
    pub fn of(
        case: &Case,
        experiment: &Experiment,
        diagnosis: &Diagnosis,
        strength: Option<&[f64]>,
        (solver, models): (&Solver, &Models),
    ) -> Result<Option<Self>, ScoreError> {
        let truth = case.truth();
        let mut all = experiment.clone();
        let mut next = diagnosis.proposals.first().map(|p| p.motion);
        let mut followed: Option<Self> = None;
        let mut runs = Vec::new();
        while let Some(plan) = next.take() {
            runs.push(plan);
            let more = planned(case, &all, &plan, runs.len(), solver)?;
            append(&mut all, &more.experiment());
            known_models(&all, models)?;
            let found = diagnose::diagnose(&all, models, &|_, _, _| {})?;
            let [one] = found.as_slice() else { return Err(ScoreError::Answers(found.len())) };
            let answer = Answer::of(one);
            if matches!(answer.verdict, Verdict::Ambiguous | Verdict::Unknown) && runs.len() < MOST_RUNS {
                next = one.proposals.first().map(|p| p.motion);
            }
            let outcome = Outcome::of(&truth, strength, &answer);
            let resolved = is_resolved(&truth.codes(), strength, &answer);
            let before = followed.map_or_else(Vec::new, |f| f.before.into_iter().chain([f.answer]).collect());
            followed = Some(Self { runs: runs.clone(), before, answer, outcome, resolved });
        }
        Ok(followed)
    }
}

/// True when every name is single and that of an effect which is there, and every effect that could be seen before has one.
fn is_resolved(codes: &[&str], strength: Option<&[f64]>, answer: &Answer) -> bool {
    let names: Vec<&str> = answer.findings.iter().map(|f| f.code).collect();
    let seen = |at: usize| strength.is_none_or(|s| s.get(at).is_none_or(|s| *s > strength::SEEN));
    answer.verdict == Verdict::Named
        && names.iter().all(|name| codes.contains(name))
        && codes.iter().enumerate().all(|(at, code)| !seen(at) || names.contains(code))
}

/// The planned runs alone, with what is hidden, other chance and other spots.
fn planned(
    case: &Case,
    so_far: &Experiment,
    plan: &Plan,
    round: usize,
    solver: &Solver,
) -> Result<SimulatedExperiment, ScoreError> {
    let mut spec = case.spec();
    spec.seed = spec.seed.wrapping_add(1_000_003 * round as u64);
    let mut specimen = so_far.specimens[plan.specimen].name.clone();
    let mut ball = so_far.indenters[plan.indenter].name.clone();
    let height_mm = plan.height * so_far.specimens[plan.specimen].height_mm.known().unwrap_or(1.0);
    if plan.height != 1.0 {
        specimen = format!("{specimen} {height_mm:.1}");
    }
    // every specimen of a case is of one foam, one that an earlier plan asked for as well
    if let Some(like) = spec.specimens.first().cloned().filter(|_| spec.specimens.iter().all(|s| s.name != specimen)) {
        spec.specimens.push(TrueSpecimen { name: specimen.clone(), height_mm, ..like });
    }
    let radius_mm = plan.radius * so_far.indenters[plan.indenter].radius_mm.known().unwrap_or(1.0);
    if plan.radius != 1.0 {
        ball = format!("{ball} {radius_mm:.2}");
    }
    if spec.indenters.iter().all(|i| i.name != ball) {
        spec.indenters.push(palpate::simulate::TrueIndenter { name: ball.clone(), radius_mm });
    }
    let (test, load_n) = match plan.on {
        On::Specimen => (Test::Indentation, 0.0),
        On::Block(load_n) => {
            specimen = "block".to_owned();
            if let Some(like) = spec.specimens.first().cloned() {
                let law = TrueLaw::Rigid { reduced_modulus_mpa: BLOCK_MPA };
                spec.specimens.push(TrueSpecimen { name: specimen.clone(), law, ..like });
            }
            (Test::Indentation, load_n)
        }
        On::Mass(load_n) => (Test::Mass, load_n),
        On::Air => (Test::Air, 0.0),
        On::Confined(diameter_mm) => {
            specimen = format!("coupon {diameter_mm}");
            if let Some(like) = spec.specimens.first().cloned() {
                let name = specimen.clone();
                spec.specimens.push(TrueSpecimen { name, height_mm, radius_mm: 0.5 * diameter_mm, ..like });
            }
            // a coupon is a piece of its own, whose height was measured anew
            spec.effects.retain(|effect| !matches!(effect, Effect::Thickness { .. }));
            (Test::Confined, 0.0)
        }
    };
    let mut run = RunTemplate {
        test,
        load_n,
        hold_s: plan.hold_s,
        unload: plan.unload,
        cycles: plan.cycles,
        rest_s: REST_S,
        replicates: SPOTS,
        ..RunTemplate::ramp(&specimen, &ball, plan.depth_mm, plan.rate_mm_per_s)
    };
    if test != Test::Indentation {
        run.indenter = None;
    }
    if matches!(test, Test::Mass | Test::Air) {
        run.specimen = None;
    }
    spec.runs = vec![run];
    // the session goes on, and so does what drifts with its clock
    spec.session.start_s = end_s(so_far) + REST_S;
    Ok(simulate(&spec, solver, &|_, _, _| {})?)
}

/// End of the last run on the session clock, s.
fn end_s(all: &Experiment) -> f64 {
    let end = |r: &palpate::experiment::Run| Some(r.start_s? + r.recording.time_s.last()?);
    all.runs.iter().filter_map(end).fold(0.0, f64::max)
}

/// Puts runs behind those of an experiment: specimens and balls by name, spots of their own.
fn append(all: &mut Experiment, more: &Experiment) {
    let spots = all.runs.iter().filter_map(|r| r.spot).max().unwrap_or(0);
    let orders = all.runs.iter().filter_map(|r| r.order).max().unwrap_or(0);
    for run in &more.runs {
        let mut run = run.clone();
        run.specimen = run.specimen.map(|at| {
            let own = &more.specimens[at];
            all.specimens.iter().position(|s| s.name == own.name).unwrap_or_else(|| {
                let mut own = own.clone();
                // one foam, whatever the specimen is called
                own.material.clone_from(&all.specimens[0].material);
                all.specimens.push(own);
                all.specimens.len() - 1
            })
        });
        run.indenter = run.indenter.map(|at| {
            let own = &more.indenters[at];
            all.indenters.iter().position(|i| i.name == own.name).unwrap_or_else(|| {
                all.indenters.push(own.clone());
                all.indenters.len() - 1
            })
        });
        run.file = format!("planned {} {}", all.runs.len(), run.file);
        run.spot = run.spot.map(|spot| spot + spots);
        run.order = run.order.map(|order| order + orders);
        all.runs.push(run);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate::diagnose::Finding;

    fn answer(verdict: Verdict, codes: &[&'static str]) -> Answer {
        let finding = |code: &&'static str| Finding {
            code,
            form: "",
            owner: 0,
            of: Vec::new(),
            parameters: Vec::new(),
            ambiguous_with: Vec::new(),
            kind: lut_gen::effect::Kind::Machine,
            probability: 1.0,
            explains: None,
        };
        let findings = codes.iter().map(finding).collect();
        Answer {
            verdict,
            findings,
            shows_in: Vec::new(),
            blind_to: Vec::new(),
            reason: None,
            rests_on_priors: false,
            seconds: 0.0,
        }
    }

    /// What could not be seen before need not be named, what could must be, and a name of something else spoils it.
    #[test]
    fn names_must_be_right_and_complete() {
        let pair = ["thickness", "lag"];
        let seen = [0.7, strength::SEEN + 1.0];
        let resolved = |verdict, codes: &[&'static str]| is_resolved(&pair, Some(&seen), &answer(verdict, codes));
        assert!(resolved(Verdict::Named, &["lag"]) && resolved(Verdict::Named, &["lag", "thickness"]));
        assert!(!resolved(Verdict::Named, &["thickness"]) && !resolved(Verdict::Named, &["lag", "drift"]));
        assert!(!resolved(Verdict::Ambiguous, &["lag"]) && !resolved(Verdict::Clean, &[]));
        // with no strength known everything must be named
        assert!(!is_resolved(&pair, None, &answer(Verdict::Named, &["lag"])));
    }
}
