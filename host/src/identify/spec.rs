//! What is fitted: the law, its free parameters, and how differences are judged.

use crate::experiment::{BaseLaw, Experiment};

use super::data::Selection;
use super::grip::Grip;

/// How the parameters are searched.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Method {
    /// Gauss-Newton with finite-element sensitivities inside a trust region.
    #[default]
    GaussNewton,
    /// MultiStart of the thesis: a map of Eq. 14, and a simplex from each candidate (section 2.8, Appendix A). Its loss is always Eq. 14.
    Simplex,
}

/// How a difference between measured and modelled force counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Loss {
    /// Squares.
    Squares,
    /// Squares up to [`HUBER`] standard deviations, linear beyond: a slip or a spike does not pull.
    #[default]
    Huber,
    /// Absolute differences (thesis Eq. 14).
    Absolute,
}

/// Where Huber's loss turns linear, in standard deviations. At 2 the estimate keeps 99 % of the efficiency of least
/// squares under normal noise (Huber 1964, doi:10.1214/aoms/1177703732).
pub const HUBER: f64 = 2.0;

/// The elastic law that is fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FittedLaw {
    /// Thesis Eq. 1.
    Hyperfoam,
    /// Thesis Eq. 2.
    Ogden,
}

impl FittedLaw {
    /// The word in files and answers.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            FittedLaw::Hyperfoam => "hyperfoam",
            FittedLaw::Ogden => "ogden",
        }
    }
}

/// A parameter that is free only when the user says so.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extra {
    /// Poisson's ratio of the Hyperfoam.
    Nu,
    /// Coulomb friction between ball and specimen.
    Friction,
    /// Coulomb friction between platens and specimen, in uniaxial compression.
    PlatenFriction,
    /// Height of every specimen.
    Height,
    /// Radius of every ball.
    BallRadius,
}

/// A parameter of the material that each specimen may have for itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Own {
    /// The shear modulus.
    Mu,
    /// The exponents.
    Alpha,
}

/// What one identification fits, and how.
#[derive(Debug, Clone, PartialEq)]
pub struct FitSpec {
    /// Law; `None` takes what the specimens declare.
    pub law: Option<FittedLaw>,
    /// Terms of the law, 1 or 2; `None` takes what the specimens declare.
    pub terms: Option<usize>,
    /// Prony terms, 0 to 2. With any the hold after the ramp is fitted as well.
    pub relaxation: usize,
    /// Parameters that are free besides the law's own.
    pub free: Vec<Extra>,
    /// Poisson's ratio of the Hyperfoam where it is not free.
    pub nu: f64,
    /// Friction under the ball where it is not free.
    pub friction: f64,
    /// Friction on platens where it is not free; without any a compressed specimen deforms homogeneously.
    pub platen_friction: f64,
    /// Parameters that every specimen has for itself.
    pub own: Vec<Own>,
    /// Loss.
    pub loss: Loss,
    /// Search.
    pub method: Method,
    /// Most finite-element solves of one material's fit.
    pub most_solves: usize,
    /// Longest that one material's fit may take, s, with the best so far when it is over; `None` for as long as it takes. It is looked at between solves.
    pub budget_s: Option<f64>,
}

impl Default for FitSpec {
    fn default() -> Self {
        Self {
            law: None,
            terms: None,
            relaxation: 0,
            free: Vec::new(),
            nu: 0.0,
            friction: 0.0,
            platen_friction: 0.0,
            own: Vec::new(),
            loss: Loss::default(),
            method: Method::default(),
            most_solves: 400,
            budget_s: None,
        }
    }
}

impl FitSpec {
    /// The law and number of terms for one material: what the user asked for, else what the first of its specimens declares.
    #[must_use]
    pub fn resolved(&self, experiment: &Experiment, material: &str) -> (FittedLaw, usize) {
        let declared = experiment.specimens.iter().find(|s| s.material == material);
        let law = self.law.unwrap_or(match declared.map(|s| s.base_law) {
            Some(BaseLaw::Ogden) => FittedLaw::Ogden,
            _ => FittedLaw::Hyperfoam,
        });
        (law, self.terms.unwrap_or(declared.map_or(1, |s| s.terms)))
    }

    /// True when platens are taken to rub.
    #[must_use]
    pub fn rubs(&self) -> bool {
        self.platen_friction > 0.0 || self.free.contains(&Extra::PlatenFriction)
    }

    /// True when Poisson's ratio of a Hyperfoam is free: as asked for, or because runs with the sides free and runs with
    /// the sides held stand beside each other and no ratio is stated.
    #[must_use]
    pub fn frees_nu(&self, selection: &Selection) -> bool {
        let fitted = || selection.curves.iter().filter(|curve| !curve.hold_out);
        let ring = |held: bool| fitted().any(|curve| (selection.pairings[curve.pairing].grip == Grip::Ring) == held);
        self.free.contains(&Extra::Nu) || self.nu == 0.0 && ring(true) && ring(false)
    }
}
