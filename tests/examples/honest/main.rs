//! What `palpate diagnose` prints as the error before, beside the held-out error of a plain elastic fit of another author's code: every effect of the catalogue at three sizes.
//!
//! `cargo run --release -p tests --example honest` (some twenty minutes); `-- relaxation` for one code.

mod plain;

use std::path::Path;

use lut_gen::solid::law::PronyTerm;
use palpate::diagnose::{Models, diagnose};
use palpate::simulate::{EXAMPLE, Effect, Solver, Spec, parse, simulate};

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

/// Largest departure of what is printed from the plain fit's that is honest.
const WITHIN: f64 = 0.1;

/// The experiment of `palpate simulate --example` with another effect.
fn session(effect: Effect) -> Outcome<Spec> {
    let mut spec = parse(Path::new("example.toml"), EXAMPLE)?;
    spec.effects = vec![effect];
    Ok(spec)
}

/// An effect of the generator at a small, a middle and a large size.
fn effects() -> Vec<(&'static str, [Effect; 3])> {
    let relax = |g| Effect::Relaxation(vec![PronyTerm::alike(g, 1.0)]);
    let each = |of: &dyn Fn(f64) -> Effect, sizes: [f64; 3]| sizes.map(of);
    vec![
        ("relaxation", each(&relax, [0.02, 0.1, 0.3])),
        ("poisson", each(&|nu| Effect::Poisson { nu }, [0.05, 0.1, 0.3])),
        ("second-term", each(&|mu2_ratio| Effect::SecondTerm { mu2_ratio, alpha2: 2.0 }, [0.05, 0.2, 0.5])),
        ("softening", each(&|part| Effect::Softening { r: 1.0 / part, m_mpa: 0.005, beta: 0.1 }, [0.05, 0.15, 0.4])),
        ("thickness", each(&|height_error_mm| Effect::Thickness { height_error_mm }, [0.3, 1.0, 3.0])),
        ("friction", each(&|coefficient| Effect::Friction { coefficient }, [0.1, 0.3, 0.6])),
        ("adhesion", each(&|work_n_per_mm| Effect::Adhesion { work_n_per_mm, range_mm: 0.1 }, [0.002, 0.005, 0.02])),
        ("contact-offset", each(&|offset_mm| Effect::ContactOffset { offset_mm }, [0.03, 0.1, 0.2])),
        ("compliance", each(&|mm_per_n| Effect::Compliance { mm_per_n }, [0.005, 0.02, 0.06])),
        ("radius", each(&|error_mm| Effect::Radius { indenter: "r4".to_owned(), error_mm }, [0.05, 0.15, 0.4])),
        ("lag", each(&|lag_s| Effect::Lag { lag_s }, [0.005, 0.02, 0.06])),
        ("sensor-nonlinearity", each(&|q| Effect::SensorNonlinearity { quadratic_per_n: q }, [0.002, 0.005, 0.02])),
        ("sensor-creep", each(&|amplitude| Effect::SensorCreep { amplitude, tau_s: 2.0 }, [0.01, 0.04, 0.15])),
        ("drift", each(&|n_per_h| Effect::Drift { n_per_h, thermal_n: 0.0, thermal_s: 600.0 }, [0.3, 1.0, 5.0])),
    ]
}

fn main() -> Outcome<()> {
    let only: Vec<String> = std::env::args().skip(1).collect();
    let models = Models::kept();
    println!(
        "effect                size  verdict     mu printed  mu plain  alpha plain  before, N  plain, N   ratio  after, N"
    );
    let (mut honest, mut told) = (0, 0);
    for (code, sizes) in effects().into_iter().filter(|(code, _)| only.is_empty() || only.iter().any(|o| o == code)) {
        for (size, effect) in sizes.into_iter().enumerate() {
            let experiment = simulate(&session(effect)?, &Solver::default(), &|_, _, _| {})?.experiment();
            let Some(found) = diagnose(&experiment, &models, &|_, _, _| {})?.into_iter().next() else { continue };
            let Some(evidence) = found.evidence.as_deref() else { continue };
            let Some(own) = plain::plain(&experiment, &found.material, &models) else { continue };
            let mu = evidence.before.parameters[0].0;
            let (before, after) = match found.held_out() {
                Some(held_out) => (held_out.rmse_before_n, held_out.rmse_after_n),
                None => (f64::NAN, f64::NAN),
            };
            let ratio = before / own.left_out_n;
            told += usize::from(ratio.is_finite());
            honest += usize::from((ratio - 1.0).abs() <= WITHIN);
            println!(
                "{code:20} {size:5}  {:10} {mu:10.4} {:9.4} {:12.2} {before:10.4} {:9.4} {ratio:7.3} {after:9.4}",
                found.verdict.word(),
                own.mu_mpa,
                own.alpha,
                own.left_out_n
            );
        }
    }
    println!("{honest} of {told} errors that were printed lie within {:.0} % of the plain fit's", 100.0 * WITHIN);
    Ok(())
}
