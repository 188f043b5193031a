//! Parameters against the depth they were identified from, for each ball, and where the balls' trends meet (thesis section 2.9, Fig. 11).

use lut_gen::solid::model::ForceModel;

use crate::experiment::{Experiment, motion};
use crate::identify::data::{Height, Selection};
use crate::identify::fe::{FeModel, Progress};
use crate::identify::fit::{Fit, Parameter};
use crate::identify::model::ForwardModel;
use crate::identify::newton::condition::{Condition, Source};
use crate::identify::spec::FitSpec;
use crate::identify::{Identification, identify_from};

use super::trend::{self, Meeting, Sensitivity};
use super::{StudyError, Subject};

mod page;
mod picture;

pub use page::study;

/// Depths, as shares of the least of the balls' largest depths.
const SHARES: [f64; 7] = [0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1.0];
/// A contact point taken this much too early (mm) is one sample and a half at 1 mm/s and 50 Hz.
pub const EARLY_MM: f64 = 0.03;
/// Draws behind the interval of the meeting point.
const DRAWS: usize = 1000;

/// What was identified from the runs of one ball down to one depth.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// Depth past the guessed contact, mm.
    pub depth_mm: f64,
    /// mu in MPa, alpha.
    pub value: [f64; 2],
    /// Their 95 % intervals.
    pub interval: [(f64, f64); 2],
    /// The same with every contact point held [`EARLY_MM`] before its best.
    pub early: [f64; 2],
}

/// All depths of one ball.
#[derive(Debug, Clone, PartialEq)]
pub struct Ball {
    /// "ball of 4 mm".
    pub name: String,
    /// Shallow to deep.
    pub points: Vec<Point>,
}

/// What the study found.
#[derive(Debug, Clone, PartialEq)]
pub struct Depths {
    /// Balls, smallest first.
    pub balls: Vec<Ball>,
    /// Where the trends of the first two meet, if they do.
    pub meeting: Option<Meeting>,
    /// The same with early contact points.
    pub early_meeting: Option<[f64; 2]>,
    /// All balls at their full depths together: mu in MPa and alpha, each with the ends of its 95 % interval.
    pub joint: Option<[(f64, f64, f64); 2]>,
    /// Finite-element solves.
    pub solves: usize,
}

/// The force model of a condition's specimen and ball.
fn model_of<'a>(model: &'a FeModel, selection: &Selection, specimen: usize, indenter: usize) -> Option<&'a ForceModel> {
    let same = |p: &crate::identify::data::Pairing| p.specimen == specimen && p.grip.indenter() == Some(indenter);
    selection.pairings.iter().position(same).map(|at| model.force_model(at))
}

/// Runs of one ball alone, each cut where it passes a depth below its guessed contact.
fn cut(subject: &Subject, selection: &Selection, ball: usize, depth_mm: f64) -> Experiment {
    let mut experiment = subject.experiment.clone();
    let mut runs = Vec::new();
    for curve in
        selection.curves.iter().filter(|c| selection.pairings[c.pairing].grip.indenter() == Some(ball) && !c.hold_out)
    {
        let mut run = experiment.runs[curve.run].clone();
        let end = curve.contact.contact_mm + depth_mm;
        let recording = &run.recording;
        let from = motion::of(recording).map_or(0, |motion| motion.loading.start);
        let past = recording.depth_mm.iter().skip(from).position(|depth| *depth > end);
        let to = past.map_or(recording.depth_mm.len(), |at| from + at);
        let part = |values: &[f64]| values[..to].to_vec();
        run.recording = crate::experiment::Recording::from_samples(
            part(&recording.time_s),
            part(&recording.depth_mm),
            part(&recording.force_n),
        );
        runs.push(run);
    }
    experiment.runs = runs;
    experiment
}

fn parameter<'a>(fit: &'a Fit, name: &str) -> Option<&'a Parameter> {
    fit.parameters.iter().find(|parameter| parameter.name == name)
}

/// Identifies from every ball and depth.
///
/// # Errors
/// Data that cannot be used, or a failing solve.
pub fn depths(subject: &Subject, seed: u64, progress: &Progress<'_>) -> Result<Depths, StudyError> {
    let selection = subject.foam_selection("depth", false)?;
    let model = FeModel::build(&subject.experiment, &selection, progress)?;
    let balls = subject.balls(&selection);
    let reach = |ball: &usize| {
        let of_ball = selection.curves.iter().filter(|c| selection.pairings[c.pairing].grip.indenter() == Some(*ball));
        let deepest = of_ball.map(|c| c.depth_mm.iter().copied().fold(0.0, f64::max) - c.contact.contact_mm);
        deepest.fold(f64::INFINITY, f64::min)
    };
    let largest_mm = balls.iter().map(reach).fold(f64::INFINITY, f64::min);
    let source = |c: &Condition| match c.grip.indenter().and_then(|ball| model_of(&model, &selection, c.specimen, ball))
    {
        Some(model) => Source::Model(Box::new(model.clone())),
        None => Source::Solves(lut_gen::solid::model::Resolution::Standard),
    };
    let spec = FitSpec { terms: Some(1), ..FitSpec::default() };
    let mut found = Vec::new();
    let mut sensitivities = Vec::new();
    for (at, &ball) in balls.iter().enumerate() {
        let mut points = Vec::new();
        let mut deepest = None;
        for (step, share) in SHARES.into_iter().enumerate() {
            progress("depths", at * SHARES.len() + step, balls.len() * SHARES.len());
            let depth_mm = share * largest_mm;
            let experiment = cut(subject, &selection, ball, depth_mm);
            let identified = identify_from(&experiment, &subject.material, &spec, &source)?;
            if let Some(point) = point(&identified, &model, &selection, ball, depth_mm) {
                points.push(point);
            }
            deepest = Some(identified);
        }
        let name = subject.ball_name(ball);
        sensitivities.push(deepest.and_then(|one| sensitivity(&one, &model, &selection, ball)));
        found.push(Ball { name, points });
    }
    progress("depths", balls.len() * SHARES.len(), balls.len() * SHARES.len());
    let (meeting, early_meeting) = meetings(&found, &sensitivities, seed);
    let together = identify_from(&subject.experiment, &subject.material, &spec, &source)?;
    let shown = |p: &Parameter| (p.value, p.interval95.low, p.interval95.high);
    let both = |fit: &Fit| Some([shown(parameter(fit, "mu_MPa")?), shown(parameter(fit, "alpha")?)]);
    let joint = together.fit.as_ref().and_then(both);
    Ok(Depths { balls: found, meeting, early_meeting, joint, solves: model.solves() })
}

/// Logarithms of alpha and mu of a ball's points.
fn logarithms(ball: &Ball, of: &dyn Fn(&Point) -> [f64; 2]) -> Vec<[f64; 2]> {
    ball.points.iter().map(of).map(|[mu, alpha]| [alpha.ln(), mu.ln()]).collect()
}

fn meetings(balls: &[Ball], sensitivities: &[Option<Sensitivity>], seed: u64) -> (Option<Meeting>, Option<[f64; 2]>) {
    let ([first, second, ..], [Some(of_first), Some(of_second), ..]) = (balls, sensitivities) else {
        return (None, None);
    };
    let depths = |ball: &Ball| ball.points.iter().map(|point| point.depth_mm).collect::<Vec<f64>>();
    let value = |ball: &Ball| logarithms(ball, &|point| point.value);
    let early = |ball: &Ball| logarithms(ball, &|point| point.early);
    let pair = [(value(first), depths(first), of_first), (value(second), depths(second), of_second)];
    let shown = |[alpha, mu]: [f64; 2]| [mu.exp(), alpha.exp()];
    (trend::meeting(&pair, DRAWS, seed), trend::crossing(&early(first), &early(second)).map(shown))
}

fn point(
    identified: &Identification,
    model: &FeModel,
    selection: &Selection,
    ball: usize,
    depth_mm: f64,
) -> Option<Point> {
    let fit = identified.fit.as_ref()?;
    let (mu, alpha) = (parameter(fit, "mu_MPa")?, parameter(fit, "alpha")?);
    let interval = |p: &Parameter| (p.interval95.low, p.interval95.high);
    let start = [mu.value.ln(), alpha.value.ln()];
    let runs = runs_of(identified, model, selection, ball);
    let early = trend::with_contacts_held(&runs, start, -EARLY_MM);
    Some(Point {
        depth_mm,
        value: [mu.value, alpha.value],
        interval: [interval(mu), interval(alpha)],
        early: early.map(f64::exp),
    })
}

/// The fitted runs of an identification with their force models and fitted contact points.
fn runs_of<'a>(
    identified: &'a Identification,
    model: &'a FeModel,
    selection: &Selection,
    ball: usize,
) -> Vec<trend::Run<'a>> {
    let Some(fit) = identified.fit.as_ref() else { return Vec::new() };
    let own = &identified.selection;
    let runs = fit.runs.iter().filter_map(|run| {
        let data = &own.curves[run.curve];
        let pairing = &own.pairings[data.pairing];
        let model = model_of(model, selection, pairing.specimen, ball)?;
        let height_mm = match pairing.height {
            Height::Known(mm) => mm,
            Height::Free(_) => return None,
        };
        let noise = fit.newton.as_ref().map(|newton| newton.noises[run.curve]);
        let sigma_n = noise.map_or(fit.noise.sigma_n, |noise| noise.sigma_n * noise.correlated_samples.sqrt());
        Some(trend::Run { data, model, height_mm, contact_mm: run.contact_mm, sigma_n })
    });
    runs.collect()
}

fn sensitivity(
    identified: &Identification,
    model: &FeModel,
    selection: &Selection,
    ball: usize,
) -> Option<Sensitivity> {
    let fit = identified.fit.as_ref()?;
    let (mu, alpha) = (parameter(fit, "mu_MPa")?.value, parameter(fit, "alpha")?.value);
    Some(Sensitivity::of(&runs_of(identified, model, selection, ball), mu, alpha))
}
