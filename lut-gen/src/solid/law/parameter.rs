//! Names of the parameters a force depends on.

use std::fmt;

/// One parameter of a simulation, for sensitivities. Terms count from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Parameter {
    /// Shear modulus `mu_i` of a term (MPa).
    Mu(usize),
    /// Exponent `alpha_i` of a term (-).
    Alpha(usize),
    /// Poisson's ratio `nu_i` of a Hyperfoam term, or of the linear law (-).
    Nu(usize),
    /// Compressibility `D_i` of an Ogden term (1/MPa).
    Compressibility(usize),
    /// Shear relaxation `g_i` (-).
    PronyG(usize),
    /// Bulk relaxation `k_i` (-).
    PronyK(usize),
    /// Relaxation time `tau_i` (s).
    PronyTau(usize),
    /// Softening `r` of Ogden and Roxburgh (-).
    SofteningR,
    /// Softening's energy scale `m` (MPa).
    SofteningM,
    /// Softening's part `beta` of the largest energy (-).
    SofteningBeta,
    /// Linear thermal strain (-).
    ThermalStrain,
    /// Coefficient of Coulomb friction between the indenter and the specimen (-).
    Friction,
    /// Work of adhesion (N/mm).
    AdhesionWork,
    /// Radius of the ball (mm).
    BallRadius,
    /// Height of the specimen (mm).
    Height,
}

impl fmt::Display for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mu(i) => write!(f, "mu_{}", i + 1),
            Self::Alpha(i) => write!(f, "alpha_{}", i + 1),
            Self::Nu(i) => write!(f, "nu_{}", i + 1),
            Self::Compressibility(i) => write!(f, "d_{}", i + 1),
            Self::PronyG(i) => write!(f, "g_{}", i + 1),
            Self::PronyK(i) => write!(f, "k_{}", i + 1),
            Self::PronyTau(i) => write!(f, "tau_{}", i + 1),
            Self::SofteningR => f.write_str("softening r"),
            Self::SofteningM => f.write_str("softening m"),
            Self::SofteningBeta => f.write_str("softening beta"),
            Self::ThermalStrain => f.write_str("thermal strain"),
            Self::Friction => f.write_str("friction"),
            Self::AdhesionWork => f.write_str("adhesion work"),
            Self::BallRadius => f.write_str("ball radius"),
            Self::Height => f.write_str("height"),
        }
    }
}
