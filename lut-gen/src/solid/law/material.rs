//! The material of a specimen: an elastic law, its relaxation and its softening.

use super::error::demand;
use super::gradient::{Gradient, Response, respond};
use super::{
    Elastic, Hencky, Hyperfoam, Law, LawError, Ogden, OgdenRoxburgh, Parameter, PronyTerm, Relaxation, Strained,
};
use super::{prony, second};
use crate::scalar::{Dual, Real};

/// An elastic law with instantaneous moduli, relaxing and softening or not, at its own temperature or another.
#[derive(Debug, Clone, PartialEq)]
pub struct Material<T = f64> {
    /// The instantaneous response.
    pub elastic: Elastic<T>,
    /// Relaxation, any number of terms; none for an elastic material.
    pub prony: Vec<PronyTerm<T>>,
    /// Softening with cycles, off by default.
    pub softening: Option<OgdenRoxburgh<T>>,
    /// Linear thermal strain `e` (-), above -1; see [`Material::warmed`]. None at the temperature of the reference.
    pub thermal: Option<T>,
}

impl From<Hyperfoam> for Material {
    fn from(law: Hyperfoam) -> Self {
        Self { elastic: Elastic::Hyperfoam(law), prony: Vec::new(), softening: None, thermal: None }
    }
}

impl From<Ogden> for Material {
    fn from(law: Ogden) -> Self {
        Self { elastic: Elastic::Ogden(law), prony: Vec::new(), softening: None, thermal: None }
    }
}

impl From<Hencky> for Material {
    fn from(law: Hencky) -> Self {
        Self { elastic: Elastic::Hencky(law), prony: Vec::new(), softening: None, thermal: None }
    }
}

impl Material {
    /// The same material with a relaxation.
    ///
    /// # Errors
    /// [`LawError`] when a part lies outside [0, 1), their sum reaches 1, or a time is not positive.
    pub fn relaxing(mut self, series: Vec<PronyTerm>) -> Result<Self, LawError> {
        prony::check(&series)?;
        self.prony = series;
        Ok(self)
    }

    /// Checks every parameter again: fields are public, and [`Material::shifted`] checks nothing.
    ///
    /// # Errors
    /// [`LawError`] as the constructors of law, relaxation and softening.
    pub fn check(&self) -> Result<(), LawError> {
        match &self.elastic {
            Elastic::Hyperfoam(law) => Hyperfoam::new(law.terms().to_vec()).map(|_| ())?,
            Elastic::Ogden(law) => Ogden::new(law.terms().to_vec()).map(|_| ())?,
            Elastic::Hencky(law) => Hencky::new(law.shear_modulus_mpa(), law.poisson_ratio()).map(|_| ())?,
        }
        if let Some(s) = self.softening {
            OgdenRoxburgh::new(s.r, s.m_mpa, s.beta)?;
        }
        if let Some(strain) = self.thermal {
            self.clone().warmed(strain)?;
        }
        prony::check(&self.prony)
    }

    /// The same material with softening.
    #[must_use]
    pub fn softening(mut self, softening: OgdenRoxburgh) -> Self {
        self.softening = Some(softening);
        self
    }

    /// The same material at another temperature: free of stress where every length has grown by the linear thermal strain `e`.
    ///
    /// The elastic law takes the elastic stretches `l / (1 + e)`, so that `J_el = J / J_th` with `J_th = (1 + e)^3` (thesis Eqs. 3 to 5);
    /// its energy is still per volume of the reference, which is cold. Moduli do not change with temperature.
    ///
    /// # Errors
    /// [`LawError`] when the strain is not finite, or not above -1.
    pub fn warmed(mut self, strain: f64) -> Result<Self, LawError> {
        let good = strain.is_finite() && strain > -1.0;
        demand(good, "thermal expansion", 0, "strain", strain, "must be above -1")?;
        self.thermal = Some(strain);
        Ok(self)
    }

    /// All parameters and their values.
    #[must_use]
    pub fn parameters(&self) -> Vec<(Parameter, f64)> {
        let mut list = Vec::new();
        self.map(|p, v| {
            list.push((p, v));
            v
        });
        list
    }

    /// The material as numbers that carry the derivative by one parameter.
    #[must_use]
    pub fn lift(&self, by: Parameter) -> Material<Dual> {
        self.map(|p, v| Dual::new(v, f64::from(u8::from(p == by))))
    }

    /// The material with `delta` added to one parameter, unchecked: for difference quotients.
    #[must_use]
    pub fn shifted(&self, by: Parameter, delta: f64) -> Self {
        self.map(|p, v| if p == by { v + delta } else { v })
    }

    fn map<U: Real>(&self, mut f: impl FnMut(Parameter, f64) -> U) -> Material<U> {
        Material {
            elastic: self.elastic.map(&mut f),
            prony: self.prony.iter().enumerate().map(|(i, t)| t.map(i, &mut f)).collect(),
            softening: self.softening.as_ref().map(|s| s.map(&mut f)),
            thermal: self.thermal.map(|strain| f(Parameter::ThermalStrain, strain)),
        }
    }

    /// True when `dP/dF` is symmetric: shear and bulk then relax alike, or not at all.
    #[must_use]
    pub fn is_symmetric(&self) -> bool {
        self.prony.iter().all(|t| t.g == t.k)
    }

    /// One line that names law and parameters, for errors and provenance.
    #[must_use]
    pub fn label(&self) -> String {
        let name = match self.elastic {
            Elastic::Hyperfoam(_) => "hyperfoam",
            Elastic::Ogden(_) => "ogden",
            Elastic::Hencky(_) => "linear elastic",
        };
        let values: Vec<String> = self.parameters().iter().map(|(p, v)| format!("{p} {v}")).collect();
        format!("{name} {}", values.join(", "))
    }
}

/// Second Piola-Kirchhoff stress `[rr, zz, rz, tt]` (MPa).
type Second<T> = [T; 4];

impl<T: Real> Material<T> {
    /// Instantaneous shear modulus (MPa).
    #[must_use]
    pub fn shear_modulus_mpa(&self) -> T {
        self.elastic.shear_modulus_mpa()
    }

    /// True when the response depends on nothing but the gradient.
    #[must_use]
    pub fn is_elastic(&self) -> bool {
        self.prony.is_empty() && self.softening.is_none()
    }

    /// Numbers of history each material point keeps: the largest energy when softening;
    /// when relaxing, the elastic stress (deviatoric and volumetric part) and the same of each element.
    #[must_use]
    pub fn history(&self) -> usize {
        usize::from(self.softening.is_some()) + if self.prony.is_empty() { 0 } else { 8 + 8 * self.prony.len() }
    }

    /// Factors of a time step.
    #[must_use]
    pub fn relaxation(&self, dt_s: f64) -> Relaxation<T> {
        Relaxation::over(&self.prony, dt_s)
    }

    /// Energy (MPa, of the elastic law) and first Piola-Kirchhoff stress (MPa) at the end of a
    /// step from the history `old` to the gradient `f`; `new` receives the history at its end.
    /// `None` when `f` does not preserve orientation.
    #[must_use]
    pub fn stress(&self, step: &Relaxation<T>, f: &[T; 5], old: &[T], new: Option<&mut [T]>) -> Option<(T, [T; 5])>
    where
        T: Strained,
    {
        let Some(strain) = self.thermal else { return self.cold_stress(step, f, old, new) };
        let grown = strain + 1.0;
        let (energy, p) = self.cold_stress(step, &f.map(|x| x / grown), old, new)?;
        Some((energy, p.map(|x| x / grown)))
    }

    fn cold_stress(&self, step: &Relaxation<T>, f: &[T; 5], old: &[T], new: Option<&mut [T]>) -> Option<(T, [T; 5])>
    where
        T: Strained,
    {
        let (energy, mut p) = T::piola(&self.elastic, f)?;
        if self.is_elastic() {
            return Some((energy, p));
        }
        let mut largest = None;
        if let Some(softening) = &self.softening {
            let (eta, _, w) = softening.factor(energy, old[0]);
            p = p.map(|x| x * eta);
            largest = Some(w);
        }
        let skip = usize::from(largest.is_some());
        let mut memory = Memory { old: &old[skip..], deviator: [T::from(0.0); 4], sphere: [T::from(0.0); 4] };
        if !self.prony.is_empty() {
            let parts = second::split(f, &p);
            (memory.deviator, memory.sphere) = parts;
            let s = memory.total(step, &parts);
            p = second::push(f, &s);
        }
        if let Some(new) = new {
            if let Some(w) = largest {
                new[0] = w;
            }
            if !self.prony.is_empty() {
                memory.advance(step, &mut new[skip..]);
            }
        }
        Some((energy, p))
    }
}

impl Material {
    /// As [`Material::stress`], with the exact tangent `dP/dF` (consistent with the step).
    #[must_use]
    pub fn respond(&self, step: &Relaxation, f: &Gradient, old: &[f64]) -> Option<Response> {
        let Some(strain) = self.thermal else { return self.cold_respond(step, f, old) };
        let grown = strain + 1.0;
        let cold = self.cold_respond(step, &f.map(|x| x / grown), old)?;
        let tangent = cold.tangent.map(|row| row.map(|a| a / (grown * grown)));
        Some(Response { energy: cold.energy, stress: cold.stress.map(|p| p / grown), tangent })
    }

    fn cold_respond(&self, step: &Relaxation, f: &Gradient, old: &[f64]) -> Option<Response> {
        let mut r = respond(&self.elastic, f)?;
        if self.is_elastic() {
            return Some(r);
        }
        let mut skip = 0;
        if let Some(softening) = &self.softening {
            skip = 1;
            let (eta, slope, _) = softening.factor(r.energy, old[0]);
            for (i, row) in r.tangent.iter_mut().enumerate() {
                for (j, a) in row.iter_mut().enumerate() {
                    *a = eta * *a + slope * r.stress[i] * r.stress[j];
                }
            }
            r.stress = r.stress.map(|x| x * eta);
        }
        if !self.prony.is_empty() {
            let parts = second::split(f, &r.stress);
            let memory = Memory { old: &old[skip..], deviator: parts.0, sphere: parts.1 };
            let kept = memory.kept(step);
            let (g, k) = (step.deviatoric, step.volumetric);
            let sphere = if g == k { None } else { Some(second::spherical_tangent(f, &r)) };
            for i in 0..5 {
                for j in 0..5 {
                    let extra = sphere.as_ref().map_or(0.0, |s| (k - g) * s[i][j]);
                    r.tangent[i][j] = g * r.tangent[i][j] + extra;
                }
            }
            second::add_geometric(&mut r.tangent, &kept);
            r.stress = second::push(f, &memory.total(step, &parts));
        }
        Some(r)
    }
}

/// What the Maxwell elements of a point remember, and the elastic stress of now.
struct Memory<'a, T> {
    /// Elastic deviator and sphere of the step's start, then deviator and sphere of each element.
    old: &'a [T],
    deviator: Second<T>,
    sphere: Second<T>,
}

impl<T: Real> Memory<'_, T> {
    /// The part of the stress that does not move with the gradient: `sum e h - g f S0_old`.
    fn kept(&self, step: &Relaxation<T>) -> Second<T> {
        std::array::from_fn(|c| {
            let mut sum = T::from(0.0);
            for (i, [decay, g, k]) in step.elements.iter().enumerate() {
                let h = 8 + 8 * i;
                sum += *decay * (self.old[h + c] + self.old[h + 4 + c]) - *g * self.old[c] - *k * self.old[4 + c];
            }
            sum
        })
    }

    fn total(&self, step: &Relaxation<T>, (deviator, sphere): &(Second<T>, Second<T>)) -> Second<T> {
        let kept = self.kept(step);
        std::array::from_fn(|c| step.deviatoric * deviator[c] + step.volumetric * sphere[c] + kept[c])
    }

    fn advance(&self, step: &Relaxation<T>, new: &mut [T]) {
        for (i, [decay, g, k]) in step.elements.iter().enumerate() {
            let h = 8 + 8 * i;
            for c in 0..4 {
                new[h + c] = *decay * self.old[h + c] + *g * (self.deviator[c] - self.old[c]);
                new[h + 4 + c] = *decay * self.old[h + 4 + c] + *k * (self.sphere[c] - self.old[4 + c]);
            }
        }
        new[..4].copy_from_slice(&self.deviator);
        new[4..8].copy_from_slice(&self.sphere);
    }
}
