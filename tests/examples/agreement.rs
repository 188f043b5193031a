//! Do the fits that a diagnosis prints agree with those of `palpate identify`? Random experiments whose runs only go
//! down: `cargo run --release -p tests --example agreement -- --cases 200 --seed 90000`.
//!
//! Base: `mu` and `alpha` before, beside `identify` without a model. Extended: those after, beside `identify` with the
//! model that the diagnosis saved. Two fits agree where both parameters differ by less than a standard error of
//! `identify`'s.

use palpate::diagnose::{Models, diagnose};
use palpate::extended::{self, ExtendedModel};
use palpate::identify::identify;
use palpate::identify::spec::FitSpec;
use palpate::infer::covariance::Z95;
use palpate::simulate::Solver;
use tests::arguments::cases_and_seed;
use tests::hidden::{Case, Design};
use tests::score::cores::on_all_cores;
use tests::score::rate::bounded;
use tests::score::suite;

type Outcome<T> = Result<T, Box<dyn std::error::Error + Send + Sync>>;
/// A value with its 95 % interval.
type Estimate = (f64, (f64, f64));

/// Standard errors between the fits of one experiment: of the base, and of what was named.
struct Apart {
    base: f64,
    extended: Option<f64>,
    /// Of the base: the larger difference of both parameters, percent.
    percent: f64,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (count, first) = cases_and_seed(std::env::args().skip(1), (40, 90_000))?;
    let (solver, models) = (Solver::new(), Models::default());
    let designs = [Design::D6, Design::D18];
    let cases: Vec<Case> =
        designs.iter().flat_map(|design| suite::cases(*design, count.div_ceil(designs.len()), first)).collect();
    let told = on_all_cores(&cases, |case| {
        let found = apart(case, &solver, &models);
        match &found {
            Ok(Some(one)) => println!(
                "{} {}: {:.2} ({:.2} %) {:?}",
                case.design.name(),
                case.seed,
                one.base,
                one.percent,
                one.extended
            ),
            Ok(None) => println!("{} {}: not judged", case.design.name(), case.seed),
            Err(error) => println!("{} {}: {error}", case.design.name(), case.seed),
        }
        found
    });
    let all: Vec<&Apart> = told.iter().filter_map(|(_, one)| one.as_ref().ok()?.as_ref()).collect();
    let within = |of: &[f64]| bounded(of.iter().filter(|apart| **apart < 1.0).count(), of.len());
    let base: Vec<f64> = all.iter().map(|one| one.base).collect();
    let extended: Vec<f64> = all.iter().filter_map(|one| one.extended).collect();
    let mut percent: Vec<f64> = all.iter().map(|one| one.percent).collect();
    percent.sort_by(f64::total_cmp);
    let at = |share: usize| percent.get(percent.len() * share / 100).copied().unwrap_or(f64::NAN);
    println!("base within a standard error: {}", within(&base));
    println!("base apart, percent: median {:.2}, nine of ten within {:.2}, worst {:.2}", at(50), at(90), at(100 - 1));
    println!("extended within a standard error: {}", within(&extended));
    Ok(())
}

/// Of one experiment; none where the diagnosis judges nothing.
fn apart(case: &Case, solver: &Solver, models: &Models) -> Outcome<Option<Apart>> {
    let experiment = case.make(solver)?.experiment();
    let found = diagnose(&experiment, models, &|_, _, _| {})?;
    let Some(evidence) = found.first().and_then(|one| one.evidence.as_deref()) else { return Ok(None) };
    let spec = FitSpec::default();
    let fits = identify(&experiment, &spec, &|_, _, _| {})?;
    let fit = fits.first().and_then(|one| one.fit.as_ref()).ok_or("identify found no fit")?;
    let of = |name: &str| -> Outcome<Estimate> {
        let own = fit.parameters.iter().find(|p| p.name == name).ok_or("a parameter is missing")?;
        Ok((own.value, (own.interval95.low, own.interval95.high)))
    };
    let (own, its) = (evidence.before.parameters, [of("mu_MPa")?, of("alpha")?]);
    let percent = own.iter().zip(its).map(|(one, other)| 100.0 * (one.0 / other.0 - 1.0).abs()).fold(0.0, f64::max);
    let base = errors(own, its);
    let extended = match ExtendedModel::of(&experiment, &found[0]).zip(evidence.extended()) {
        None => None,
        Some((model, after)) => {
            let again = extended::identify::identify(&experiment, &model, false, models, &|_, _, _| {})?;
            let of = |at: usize| -> Outcome<Estimate> {
                let own = again.parameters.get(at).ok_or("a parameter is missing")?;
                Ok((own.value, own.interval.ok_or("an interval is missing")?))
            };
            Some(errors(after, [of(0)?, of(1)?]))
        }
    };
    Ok(Some(Apart { base, extended, percent }))
}

/// The larger of two distances in standard errors of the second fit.
fn errors(one: [Estimate; 2], other: [Estimate; 2]) -> f64 {
    let each = one.iter().zip(other).map(|((value, _), (its, (low, high)))| {
        let error = (high.ln() - low.ln()) / (2.0 * Z95);
        (value.ln() - its.ln()).abs() / error
    });
    each.fold(0.0, f64::max)
}
