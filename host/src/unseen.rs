//! Effects that no fit of `identify` knows of, and what they add to the intervals of its parameters.
//!
//! `identify` fits a law and contact points. What else may be there, and how large it may be, is the catalogue's ([`lut_gen::effect`]); what that would change
//! in the rows of the fit, the chain of `diagnose` says. This module is above both, and moves no point estimate.

use lut_gen::chain::{Chain, Model, Passage, Setting};
use lut_gen::effect::{Effect, contact_offset, friction, poisson, relaxation, second_term};
use nalgebra::{DMatrix, DVector};

use crate::diagnose::coordinate::Candidate;
use crate::diagnose::design::Design;
use crate::diagnose::{DiagnoseError, Models, unseen};
use crate::experiment::Experiment;
use crate::identify::Identification;
use crate::identify::data::Selection;
use crate::identify::fit::Unseen;
use crate::identify::grip::Grip;
use crate::identify::interval::Interval;
use crate::identify::newton::coordinate::{Kind, Values};
use crate::identify::newton::linear::{Linear, LinearRun};
use crate::identify::spec::FittedLaw;
use crate::infer::covariance::Z95;
use crate::infer::unseen::Widening;

/// Widens the intervals of an identification by the effects of the catalogue that its runs do not show. Where that is not possible a message says why.
///
/// # Errors
/// A force model that cannot be made.
pub fn widen(
    experiment: &Experiment,
    found: &mut Identification,
    models: &Models,
    progress: &(dyn Fn(usize, usize) + Send + Sync),
) -> Result<(), DiagnoseError> {
    let linear = found.fit.as_ref().map(|fit| fit.linear.as_ref());
    let Some(linear) = linear else { return Ok(()) };
    let setup = linear.ok_or("the search keeps no rows").and_then(|linear| Setup::of(experiment, found, linear));
    let told = match setup {
        Ok(setup) => {
            let library = models.of(&setup.design.geometries, progress)?;
            let chain = Chain { library, passages: setup.passages.clone() };
            setup.widening(&chain).ok_or("these runs do not determine every parameter")
        }
        Err(why) => Err(why),
    };
    match told {
        Ok(widening) => apply(found, &widening),
        Err(why) => {
            found.messages.push(format!("intervals are not widened by effects that these runs do not show: {why}"))
        }
    }
    Ok(())
}

/// A fit as the chain sees it.
struct Setup<'a> {
    linear: &'a Linear,
    design: Design,
    passages: Vec<Passage>,
    model: Model,
}

impl<'a> Setup<'a> {
    fn of(experiment: &Experiment, found: &Identification, linear: &'a Linear) -> Result<Self, &'static str> {
        let selection = &found.selection;
        let first = linear.runs.first().ok_or("no run is fitted")?;
        if linear.runs.iter().any(|run| run.ball(selection).is_none()) {
            return Err("what is compressed or pulled as a whole has no chain of effects");
        }
        let law = |run: &LinearRun| Values { height_mm: 0.0, ball_mm: 0.0, ..run.values.clone() };
        if linear.runs.iter().any(|run| law(run) != law(first)) {
            return Err("specimens have parameters of their own");
        }
        if linear.kinds.iter().any(|kind| matches!(kind, Kind::Height | Kind::BallRadius)) {
            return Err("a height or a radius is fitted");
        }
        let design =
            Design::of(experiment, &found.material).map_err(|_| "no run can be used by the chain of effects")?;
        let incompressible = design.geometries.iter().any(|geometry| geometry.nu > 0.0);
        if incompressible != (first.values.law == FittedLaw::Ogden) {
            return Err("another law is fitted than the specimens declare");
        }
        let passages = linear.runs.iter().map(|run| run.passage(experiment, selection, &design));
        let passages = passages.collect::<Option<Vec<_>>>().ok_or("a run has no place in the chain of effects")?;
        Ok(Self { linear, model: model(&first.values), passages, design })
    }

    /// Rows of a model, whitened.
    fn rows(&self, chain: &Chain, model: &Model) -> DVector<f64> {
        let contacts: Vec<f64> = self.linear.runs.iter().map(|run| run.contact_mm).collect();
        self.linear.rows(&chain.predict(model, &contacts))
    }

    fn widening(&self, chain: &Chain) -> Option<Widening> {
        let here = self.rows(chain, &self.model);
        let changes = |candidate: &Candidate, each: Vec<Vec<f64>>| {
            let column = |values| {
                let mut model = self.model.clone();
                model.settings.push(Setting { effect: candidate.effect, owner: candidate.owner, values });
                self.rows(chain, &model) - &here
            };
            DMatrix::from_columns(&each.into_iter().map(column).collect::<Vec<_>>())
        };
        let open = unseen::candidates(&self.design).into_iter().filter(|c| !self.is_fitted(c.effect));
        let unseen =
            open.filter_map(|candidate| unseen::columns(&self.design, &candidate, |each| changes(&candidate, each)));
        self.linear.widening(&unseen.collect::<Vec<_>>())
    }

    /// True for what the fit has free itself, contact points always; and for what the model has already.
    fn is_fitted(&self, effect: &Effect) -> bool {
        let kinds = &self.linear.kinds;
        effect.code == contact_offset::EFFECT.code
            || (effect.code == poisson::EFFECT.code
                && kinds.iter().any(|k| matches!(k, Kind::Nu | Kind::Compressibility)))
            || self.model.settings.iter().any(|s| s.effect.code == effect.code)
    }
}

impl LinearRun {
    fn ball(&self, selection: &Selection) -> Option<(usize, usize)> {
        let pairing = &selection.pairings[selection.curves[self.curve].pairing];
        match pairing.grip {
            Grip::Ball { indenter, .. } => Some((pairing.specimen, indenter)),
            _ => None,
        }
    }

    fn passage(&self, experiment: &Experiment, selection: &Selection, design: &Design) -> Option<Passage> {
        let data = &selection.curves[self.curve];
        let (specimen, indenter) = self.ball(selection)?;
        let like = design.series.iter().find(|s| s.specimen == specimen && s.indenter == indenter)?;
        let own = design.series.iter().find(|s| s.run == data.run);
        let first_s = data.time_s.first()?;
        Some(Passage {
            time_s: self.samples.iter().map(|at| data.time_s[*at] - first_s).collect(),
            depth_mm: self.samples.iter().map(|at| data.depth_mm[*at]).collect(),
            start_s: experiment.runs.get(data.run)?.start_s.unwrap_or(0.0),
            geometry: like.geometry,
            specimen,
            indenter,
            pressed_before_mm: own.map_or(0.0, |s| s.pressed_before_mm),
        })
    }
}

/// What was fitted, as a model of the chain.
fn model(values: &Values) -> Model {
    let share = if values.terms > 1 { values.share } else { 0.0 };
    let mut model = Model::base((1.0 - share) * values.mu_mpa, values.alpha[0]);
    let mut add = |effect: &'static Effect, values: Vec<f64>| model.settings.push(Setting { effect, owner: 0, values });
    if share > 0.0 {
        add(&second_term::EFFECT, vec![share / (1.0 - share), values.alpha[1]]);
    }
    match values.prony[..] {
        [(g, _, tau_s)] => add(&relaxation::ONE, vec![g, tau_s]),
        [(g, _, tau_s), (g2, _, tau2_s)] => add(&relaxation::TWO, vec![g, tau_s, g2, tau2_s]),
        _ => {}
    }
    if values.law == FittedLaw::Hyperfoam && values.nu > 0.0 {
        add(&poisson::EFFECT, vec![values.nu]);
    }
    if values.friction > 0.0 {
        add(&friction::EFFECT, vec![values.friction]);
    }
    model
}

/// Puts the wider intervals in, each where the data put its parameter with unseen effects free, the value itself in it.
fn apply(found: &mut Identification, widening: &Widening) {
    let searched = found.fit.iter_mut().flat_map(|fit| &mut fit.parameters).filter(|p| !p.derived);
    for (at, parameter) in searched.enumerate().take(widening.added.len()) {
        let to = |value: f64| if parameter.logarithmic { value.ln() } else { value };
        let noise = parameter.interval95;
        let (x, low, high) = (to(parameter.value), to(noise.low), to(noise.high));
        let added = Z95 * widening.added[at].sqrt();
        let middle = x + widening.shift[at];
        let least = parameter.shown((middle - (x - low).hypot(added)).min(x)).max(parameter.bounds.0);
        let most = parameter.shown((middle + (high - x).hypot(added)).max(x)).min(parameter.bounds.1);
        parameter.interval95 = Interval { low: least.min(parameter.value), high: most.max(parameter.value) };
        let (was, is) = (high - low, to(parameter.interval95.high) - to(parameter.interval95.low));
        let times = if was > 0.0 { is / was } else { 1.0 };
        parameter.unseen = Some(Unseen { noise, times, by: widening.by[at].clone() });
    }
}
