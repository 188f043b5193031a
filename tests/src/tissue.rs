//! A recording of hyper-viscoelastic tissue, pressed and held, and its six parameters back from it (thesis section 2.11).

use std::path::PathBuf;

use lut_gen::solid::contact::{Ball, Interface};
use lut_gen::solid::law::{Material, Ogden, PronyTerm};
use lut_gen::solid::model::{Resolution, Simulation, Specimen as Block};
use lut_gen::solid::solve::{Motion, SolveError};
use palpate::experiment::{Base, BaseLaw, Experiment, Indenter, Length, Recording, Run, Sensor, Specimen};
use palpate::identify::newton::track::Track;
use palpate::identify::newton::verdict::Standing;
use palpate::identify::spec::{FitSpec, FittedLaw};
use palpate::identify::{Identification, fe::ModelError, identify};
use rand::{Rng, SeedableRng};
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64;

/// The six parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tissue {
    /// Instantaneous shear modulus, MPa.
    pub mu_mpa: f64,
    /// Exponent.
    pub alpha: f64,
    /// Compressibility D times modulus.
    pub d_mu: f64,
    /// Share of the shear response that relaxes.
    pub g: f64,
    /// Share of the bulk response that relaxes.
    pub k: f64,
    /// Relaxation time, s.
    pub tau_s: f64,
}

/// Bovine liver as the thesis identified it: D is 2.5 / MPa.
pub const LIVER: Tissue =
    Tissue { mu_mpa: 5.329e-4, alpha: 21.8, d_mu: 2.5 * 5.329e-4, g: 0.822, k: 0.003, tau_s: 0.999 };

impl Tissue {
    /// Names as in the answer of a fit, and values.
    #[must_use]
    pub fn named(&self) -> [(&'static str, f64); 6] {
        let Tissue { mu_mpa, alpha, d_mu, g, k, tau_s } = *self;
        [("mu_MPa", mu_mpa), ("alpha", alpha), ("D_mu", d_mu), ("g", g), ("k", k), ("tau_s", tau_s)]
    }

    fn material(&self) -> Result<Material, SolveError> {
        let elastic: Material = Ogden::one_term(self.mu_mpa, self.alpha, self.d_mu / self.mu_mpa)?.into();
        Ok(elastic.relaxing(vec![PronyTerm { g: self.g, k: self.k, tau_s: self.tau_s }])?)
    }
}

/// How it is pressed. Ball and rate are the thesis'; specimen and hold are not printed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pressed {
    /// Height of the block, mm.
    pub height_mm: f64,
    /// Radius of the ball, mm.
    pub ball_mm: f64,
    /// Depth, mm: a little above the equator of the ball, where the model of a fit ends.
    pub depth_mm: f64,
    /// Rate of the ramp, mm/s.
    pub rate_mm_s: f64,
    /// Duration of the hold, s.
    pub hold_s: f64,
    /// Samples a second.
    pub hz: f64,
    /// Standard deviation of white noise, share of the largest force.
    pub noise: f64,
    /// The recording's mesh is this much finer than a fit's.
    pub finer: f64,
}

impl Default for Pressed {
    fn default() -> Self {
        Pressed {
            height_mm: 30.0,
            ball_mm: 4.0,
            depth_mm: 3.8,
            rate_mm_s: 1.0,
            hold_s: 10.0,
            hz: 50.0,
            noise: 0.01,
            finer: 1.5,
        }
    }
}

impl Pressed {
    /// The recording of one press: ball above the surface, ramp, hold; where it touches is chance.
    ///
    /// # Errors
    /// When the solve fails.
    pub fn record(&self, tissue: &Tissue, seed: u64) -> Result<Experiment, SolveError> {
        let simulation = Simulation {
            material: tissue.material()?,
            specimen: Block { height_mm: self.height_mm, radius_mm: 25.0, base: lut_gen::solid::solve::Base::Bonded },
            ball: Ball { radius_mm: self.ball_mm },
            interface: Interface::default(),
            motion: Motion::ramp(self.depth_mm, self.rate_mm_s).hold(self.hold_s),
            resolution: Resolution::Refined(self.finer),
        };
        let press = simulation.press(&[])?;
        let values: Vec<f64> = press.ramp.iter().chain(&press.hold).copied().collect();
        let track = Track::new(press.depth_max_mm, press.hold_s, &values, 0.0);
        let mut chance = Pcg64::seed_from_u64(seed);
        let contact_mm = chance.random_range(0.2..0.6);
        let peak_n = track.ramp(self.depth_mm).0;
        let normal = Normal::new(0.0, self.noise * peak_n).ok();
        let end_s = (contact_mm + self.depth_mm) / self.rate_mm_s;
        let count = ((end_s + self.hold_s) * self.hz) as usize;
        let (mut time_s, mut depth_mm, mut force_n) = (Vec::new(), Vec::new(), Vec::new());
        for i in 0..count {
            let t = i as f64 / self.hz;
            let at_mm = (self.rate_mm_s * t).min(contact_mm + self.depth_mm);
            let clean = if t <= end_s { track.ramp(at_mm - contact_mm) } else { track.hold(self.depth_mm, t - end_s) };
            time_s.push(t);
            depth_mm.push(at_mm);
            force_n.push(clean.0 + normal.map_or(0.0, |normal| normal.sample(&mut chance)));
        }
        Ok(self.experiment(Recording::from_samples(time_s, depth_mm, force_n)))
    }

    fn experiment(&self, recording: Recording) -> Experiment {
        Experiment {
            name: "tissue, pressed and held".to_owned(),
            folder: PathBuf::new(),
            specimens: vec![Specimen {
                name: "tissue".to_owned(),
                material: "tissue".to_owned(),
                base_law: BaseLaw::Ogden,
                terms: 1,
                height_mm: Length::Known(self.height_mm),
                radius_mm: Length::Known(25.0),
                base: Base::Bonded,
            }],
            indenters: vec![Indenter { name: "ball".to_owned(), radius_mm: Length::Known(self.ball_mm) }],
            sensor: Sensor::default(),
            runs: vec![Run::indentation("ramp and hold".to_owned(), 0, 0, recording)],
        }
    }
}

/// The fit of all six.
#[must_use]
pub fn six() -> FitSpec {
    FitSpec { law: Some(FittedLaw::Ogden), terms: Some(1), relaxation: 1, ..FitSpec::default() }
}

/// What became of one parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Recovered {
    /// Name.
    pub name: &'static str,
    /// Truth.
    pub truth: f64,
    /// Estimate.
    pub value: f64,
    /// Its 95 % interval.
    pub interval: (f64, f64),
    /// What the fit says of it.
    pub standing: Option<Standing>,
}

impl Recovered {
    /// True if the interval holds the truth.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.interval.0 <= self.truth && self.truth <= self.interval.1
    }
}

/// What a fit says of every parameter, beside the truth.
#[must_use]
pub fn recovered(found: &Identification, tissue: &Tissue) -> Vec<Recovered> {
    let parameters = found.fit.as_ref().map_or(&[][..], |fit| &fit.parameters);
    let of = |(name, truth): (&'static str, f64)| {
        let p = parameters.iter().find(|p| p.name == name)?;
        Some(Recovered {
            name,
            truth,
            value: p.value,
            interval: (p.interval95.low, p.interval95.high),
            standing: p.verdict.as_ref().map(|v| v.standing),
        })
    };
    tissue.named().into_iter().filter_map(of).collect()
}

/// Fits the recording and holds every parameter against the truth.
///
/// # Errors
/// When the fit cannot begin.
pub fn recover(experiment: &Experiment, tissue: &Tissue) -> Result<(Identification, Vec<Recovered>), ModelError> {
    let found = identify(experiment, &six(), &|_, _, _| {})?.swap_remove(0);
    let recovered = recovered(&found, tissue);
    Ok((found, recovered))
}
