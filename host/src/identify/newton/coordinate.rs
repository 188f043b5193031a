//! Coordinates of a fit: what each is, its range, and how the force's derivatives become derivatives by it.

use lut_gen::solid::contact::Interface;
use lut_gen::solid::law::{Hyperfoam, Material, Ogden, OgdenTerm, Parameter, PronyTerm, Term};
use lut_gen::solid::solve::SolveError;

use crate::identify::spec::FittedLaw;

/// Within this share of its range a coordinate stands on its bound.
pub const ON_BOUND: f64 = 1e-3;

/// A kind of coordinate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Initial shear modulus `mu_0` of all terms together (MPa). Everything scales with it.
    Modulus,
    /// Share of the second term in it.
    Share,
    /// Exponent of a term.
    Alpha(usize),
    /// Poisson's ratio of all Hyperfoam terms.
    Nu,
    /// Ogden's compressibility `D_1 mu_0` (-): `3 (1 - 2 nu) / (1 + nu)`.
    Compressibility,
    /// Shear relaxation of a Prony term.
    G(usize),
    /// Its bulk relaxation.
    K(usize),
    /// Its relaxation time (s).
    Tau(usize),
    /// Coulomb friction between ball and specimen.
    Friction,
    /// Coulomb friction between platens and specimen.
    PlatenFriction,
    /// Height of a specimen (mm).
    Height,
    /// Radius of a ball (mm).
    BallRadius,
}

/// What a coordinate belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scope {
    /// All runs.
    All,
    /// One specimen, an index into the experiment's.
    Specimen(usize),
    /// One ball, an index into the experiment's indenters.
    Indenter(usize),
}

/// A free parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Unknown {
    /// What it is.
    pub kind: Kind,
    /// What it belongs to.
    pub scope: Scope,
    /// Name in the answer, with its unit.
    pub name: String,
    /// Bounds, in physical units.
    pub low: f64,
    /// Upper bound.
    pub high: f64,
    /// Where the search begins.
    pub start: f64,
}

impl Unknown {
    /// True where ratios count and not differences.
    #[must_use]
    pub fn is_logarithmic(&self) -> bool {
        use Kind::{Alpha, BallRadius, Compressibility, Height, Modulus, Tau};
        matches!(self.kind, Modulus | Alpha(_) | Compressibility | Tau(_) | Height | BallRadius)
    }

    /// The coordinate of a physical value.
    #[must_use]
    pub fn coordinate(&self, value: f64) -> f64 {
        if self.is_logarithmic() { value.ln() } else { value }
    }

    /// The physical value of a coordinate.
    #[must_use]
    pub fn value(&self, x: f64) -> f64 {
        if self.is_logarithmic() { x.exp() } else { x }
    }

    /// Derivative of the value by the coordinate.
    fn slope(&self, value: f64) -> f64 {
        if self.is_logarithmic() { value } else { 1.0 }
    }

    /// True where a coordinate stands on a bound of its range, or within a thousandth of it.
    #[must_use]
    pub fn stands_on_bound(&self, x: f64) -> bool {
        let (low, high) = self.bounds();
        (x - low).min(high - x) < ON_BOUND * (high - low)
    }

    /// Range of the coordinate.
    #[must_use]
    pub fn bounds(&self) -> (f64, f64) {
        (self.coordinate(self.low), self.coordinate(self.high))
    }
}

/// Parameters of one condition, in physical units.
#[derive(Debug, Clone, PartialEq)]
pub struct Values {
    /// Law.
    pub law: FittedLaw,
    /// Number of terms.
    pub terms: usize,
    /// Initial shear modulus, MPa.
    pub mu_mpa: f64,
    /// Share of the second term.
    pub share: f64,
    /// Exponents.
    pub alpha: [f64; 2],
    /// Poisson's ratio.
    pub nu: f64,
    /// `D_1 mu_0`.
    pub compressibility: f64,
    /// Prony terms `(g, k, tau)`.
    pub prony: Vec<(f64, f64, f64)>,
    /// Friction under the ball.
    pub friction: f64,
    /// Friction on platens.
    pub platen_friction: f64,
    /// Height of the specimen, mm.
    pub height_mm: f64,
    /// Radius of the ball, mm.
    pub ball_mm: f64,
}

/// A term's modulus may not vanish: this share of the whole stands for nothing.
pub(super) const LEAST_SHARE: f64 = 1e-6;
/// Friction whose derivative can be formed; its force differs from none by less than the mesh's error.
const LEAST_FRICTION: f64 = 1e-4;

impl Values {
    /// Sets the parameter of a kind.
    pub fn set(&mut self, kind: Kind, value: f64) {
        match kind {
            Kind::Modulus => self.mu_mpa = value,
            Kind::Share => self.share = value,
            Kind::Alpha(i) => {
                if let Some(alpha) = self.alpha.get_mut(i) {
                    *alpha = value;
                }
            }
            Kind::Nu => self.nu = value,
            Kind::Compressibility => self.compressibility = value,
            Kind::G(i) | Kind::K(i) | Kind::Tau(i) => {
                if let Some(term) = self.prony.get_mut(i) {
                    match kind {
                        Kind::G(_) => term.0 = value,
                        Kind::K(_) => term.1 = value,
                        _ => term.2 = value,
                    }
                }
            }
            Kind::Friction => self.friction = value.max(LEAST_FRICTION),
            Kind::PlatenFriction => self.platen_friction = value.max(LEAST_FRICTION),
            Kind::Height => self.height_mm = value,
            Kind::BallRadius => self.ball_mm = value,
        }
    }

    /// Moduli of the terms for a whole of 1 MPa.
    fn shares(&self) -> Vec<f64> {
        let share = self.share.clamp(LEAST_SHARE, 1.0 - LEAST_SHARE);
        if self.terms == 1 { vec![1.0] } else { vec![1.0 - share, share] }
    }

    /// The material for `mu_0 = 1 MPa`: forces are those of the material divided by its modulus, exactly.
    ///
    /// # Errors
    /// [`SolveError`] when a parameter lies outside the law's range.
    pub fn unit_material(&self) -> Result<Material, SolveError> {
        self.material_of(1.0)
    }

    /// The material itself.
    ///
    /// # Errors
    /// As [`Values::unit_material`].
    pub fn material(&self) -> Result<Material, SolveError> {
        self.material_of(self.mu_mpa)
    }

    fn material_of(&self, mu_mpa: f64) -> Result<Material, SolveError> {
        let terms = self.shares().into_iter().map(|share| share * mu_mpa).zip(self.alpha);
        let elastic: Material = match self.law {
            FittedLaw::Hyperfoam => {
                let terms = terms.map(|(mu_mpa, alpha)| Term { mu_mpa, alpha, nu: self.nu }).collect();
                Hyperfoam::new(terms)?.into()
            }
            FittedLaw::Ogden => {
                let d = |at: usize| if at == 0 { self.compressibility / mu_mpa } else { 0.0 };
                let terms =
                    terms.enumerate().map(|(at, (mu_mpa, alpha))| OgdenTerm { mu_mpa, alpha, d_per_mpa: d(at) });
                Ogden::new(terms.collect())?.into()
            }
        };
        let prony = self.prony.iter().map(|&(g, k, tau_s)| PronyTerm { g, k, tau_s }).collect();
        Ok(elastic.relaxing(prony)?)
    }

    /// Friction of the contact.
    #[must_use]
    pub fn interface(&self) -> Interface {
        Interface { friction: self.friction, adhesion: None }
    }

    /// `dF/dx` of a coordinate as a sum of derivatives by the simulation's parameters with these factors. The modulus
    /// needs none: the force is proportional to it.
    #[must_use]
    pub fn chain(&self, unknown: &Unknown, value: f64) -> Vec<(Parameter, f64)> {
        let by = unknown.slope(value);
        match unknown.kind {
            Kind::Modulus => Vec::new(),
            Kind::Share => vec![(Parameter::Mu(0), -by), (Parameter::Mu(1), by)],
            Kind::Alpha(i) => vec![(Parameter::Alpha(i), by)],
            Kind::Nu => (0..self.terms).map(|i| (Parameter::Nu(i), by)).collect(),
            Kind::Compressibility => vec![(Parameter::Compressibility(0), by)],
            Kind::G(i) => vec![(Parameter::PronyG(i), by)],
            Kind::K(i) => vec![(Parameter::PronyK(i), by)],
            Kind::Tau(i) => vec![(Parameter::PronyTau(i), by)],
            Kind::Friction | Kind::PlatenFriction => vec![(Parameter::Friction, by)],
            Kind::Height => vec![(Parameter::Height, by)],
            Kind::BallRadius => vec![(Parameter::BallRadius, by)],
        }
    }
}
