//! Parameters of the base and of effects, as a fit searches them, and the models that they make.

use lut_gen::chain::{Model, Setting};
use lut_gen::effect::{Effect, Quantity, Sizes, Spread, contact_offset};
use nalgebra::{DMatrix, DVector};

use super::design::Design;

/// An effect that may be at work, with the ball or specimen it belongs to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Candidate {
    /// The effect.
    pub effect: &'static Effect,
    /// Index of the ball or specimen.
    pub owner: usize,
}

impl Candidate {
    /// Sizes that its amounts are in proportion to.
    #[must_use]
    pub fn sizes(&self, design: &Design) -> Sizes {
        design.sizes(self.effect, Some(self.owner))
    }
}

/// One parameter of a fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Coordinate {
    /// Logarithm of the shear modulus, MPa.
    LnMu,
    /// Logarithm of the exponent.
    LnAlpha,
    /// The same of a material that is compressed only, for which no force models are needed.
    LnAlphaAlone,
    /// Offset of a depth that was not zeroed at the contact, mm.
    Zero,
    /// A quantity of a candidate: which candidate, which quantity.
    Of(usize, Quantity),
}

/// Exponents that the force models cover.
const ALPHA: (f64, f64) = (1.8, 26.0);
/// Exponents of the closed form of a coupon, those of rubbers among them.
const ALPHA_ALONE: (f64, f64) = (0.5, 26.0);

impl Coordinate {
    /// Lowest and highest value.
    #[must_use]
    pub fn bounds(&self) -> (f64, f64) {
        match self {
            Coordinate::LnMu => (1e-6_f64.ln(), 1e3_f64.ln()),
            Coordinate::LnAlpha => (ALPHA.0.ln(), ALPHA.1.ln()),
            Coordinate::LnAlphaAlone => (ALPHA_ALONE.0.ln(), ALPHA_ALONE.1.ln()),
            Coordinate::Zero => (-1.0, 1.0),
            Coordinate::Of(_, q) => match q.spread {
                Spread::Even => (q.low, q.high),
                Spread::Logarithmic => (q.low.ln(), q.high.ln()),
            },
        }
    }

    /// True for a place that lies within a thousandth of the way on one of the bounds.
    pub(super) fn is_at_end(&self, x: f64) -> bool {
        let (low, high) = self.bounds();
        (x - low).min(high - x) < 1e-3 * (high - low)
    }

    /// The same for a bound at which its effect, if it has one, is something.
    pub(super) fn is_at_bound(&self, x: f64) -> bool {
        match self {
            Coordinate::Of(_, q) => {
                let (low, high) = self.bounds();
                let is_near = |end: f64| (x - end).abs() < 1e-3 * (high - low);
                [low, high].into_iter().any(|end| is_near(end) && (end - self.of(q.null)).abs() > 1e-9)
            }
            Coordinate::LnMu | Coordinate::LnAlpha | Coordinate::LnAlphaAlone | Coordinate::Zero => self.is_at_end(x),
        }
    }

    /// Step of a difference quotient.
    pub(super) fn step(&self) -> f64 {
        match self {
            Coordinate::LnMu | Coordinate::LnAlpha | Coordinate::LnAlphaAlone => 1e-3,
            Coordinate::Zero => 1e-3,
            Coordinate::Of(_, q) => match q.spread {
                Spread::Even => 0.02 * (q.plausible - q.null).abs(),
                Spread::Logarithmic => 0.01,
            },
        }
    }

    /// The parameter's own value.
    #[must_use]
    pub fn value(&self, x: f64) -> f64 {
        match self {
            Coordinate::LnMu | Coordinate::LnAlpha | Coordinate::LnAlphaAlone => x.exp(),
            Coordinate::Zero => x,
            Coordinate::Of(_, q) => match q.spread {
                Spread::Even => x,
                Spread::Logarithmic => x.exp(),
            },
        }
    }

    /// Values within a half width of a point, no farther than the bounds.
    #[must_use]
    pub fn interval(&self, x: f64, half: f64) -> (f64, f64) {
        let (low, high) = self.bounds();
        (self.value((x - half).max(low)), self.value((x + half).min(high)))
    }

    /// The coordinate of a value.
    #[must_use]
    pub fn of(&self, value: f64) -> f64 {
        match self {
            Coordinate::LnMu | Coordinate::LnAlpha | Coordinate::LnAlphaAlone => value.ln(),
            Coordinate::Zero => value,
            Coordinate::Of(_, q) => match q.spread {
                Spread::Even => value,
                Spread::Logarithmic => value.ln(),
            },
        }
    }
}

/// Parameters of the base with candidates.
#[must_use]
pub fn coordinates(design: &Design, candidates: &[Candidate]) -> Vec<Coordinate> {
    let alpha = if design.series.is_empty() { Coordinate::LnAlphaAlone } else { Coordinate::LnAlpha };
    let mut list = vec![Coordinate::LnMu, alpha];
    if !design.zero_is_contact {
        list.push(Coordinate::Zero);
    }
    for (at, candidate) in candidates.iter().enumerate() {
        let sizes = candidate.sizes(design);
        list.extend(candidate.effect.quantities.iter().map(|q| Coordinate::Of(at, q.bounded_at(&sizes))));
    }
    list
}

/// The model of a point.
#[must_use]
pub fn model(coordinates: &[Coordinate], candidates: &[Candidate], x: &DVector<f64>) -> Model {
    let mut model = Model::base(1.0, 1.0);
    let setting = |c: &Candidate| Setting { effect: c.effect, owner: c.owner, values: Vec::new() };
    model.settings = candidates.iter().map(setting).collect();
    let mut zero = None;
    for (coordinate, x) in coordinates.iter().zip(x.iter()) {
        let value = coordinate.value(*x);
        match coordinate {
            Coordinate::LnMu => model.mu_mpa = value,
            Coordinate::LnAlpha | Coordinate::LnAlphaAlone => model.alpha = value,
            Coordinate::Zero => zero = Some(value),
            Coordinate::Of(at, _) => model.settings[*at].values.push(value),
        }
    }
    if let Some(offset_mm) = zero {
        // a contact point that is fitted is no effect, but it acts like one
        model.settings.push(Setting { effect: &contact_offset::EFFECT, owner: 0, values: vec![offset_mm] });
    }
    model
}

/// The point of a model; none of one with other effects.
#[must_use]
pub fn point(coordinates: &[Coordinate], candidates: &[Candidate], model: &Model) -> Option<DVector<f64>> {
    let is_own = |(c, s): (&Candidate, &Setting)| c.effect == s.effect && c.owner == s.owner;
    let zeros = coordinates.iter().filter(|c| **c == Coordinate::Zero).count();
    let same = model.settings.len() == candidates.len() + zeros && candidates.iter().zip(&model.settings).all(is_own);
    let mut values = model.settings.iter().take(candidates.len()).flat_map(|s| s.values.iter().copied());
    let mut value = |c: &Coordinate| match c {
        Coordinate::LnMu => Some(model.mu_mpa),
        Coordinate::LnAlpha | Coordinate::LnAlphaAlone => Some(model.alpha),
        Coordinate::Zero => model.settings.last().and_then(|s| s.values.first().copied()),
        Coordinate::Of(..) => values.next(),
    };
    let each: Option<Vec<f64>> = coordinates.iter().map(&mut value).collect();
    let each = each.filter(|_| same)?;
    Some(DVector::from_iterator(each.len(), coordinates.iter().zip(each).map(|(c, value)| c.of(value))))
}

/// What is known of parameters before any data: a normal distribution that has their bounds at two standard deviations.
pub(super) fn known_before(coordinates: &[Coordinate]) -> DMatrix<f64> {
    let width = |c: &Coordinate| c.bounds().1 - c.bounds().0;
    let each = coordinates.iter().map(|c| 16.0 / width(c).powi(2));
    DMatrix::from_diagonal(&DVector::from_iterator(coordinates.len(), each))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use lut_gen::effect::{drift, relaxation};

    use super::*;

    /// With an offset of the depth, which a model has behind its effects and a point before them.
    #[test]
    fn the_point_of_a_model_is_where_it_was_made() {
        let candidates = [&relaxation::ONE, &drift::EFFECT].map(|effect| Candidate { effect, owner: 0 });
        let of = |at: usize| candidates[at].effect.quantities.iter().map(move |q| Coordinate::Of(at, *q));
        let base = [Coordinate::LnMu, Coordinate::LnAlpha, Coordinate::Zero];
        let list: Vec<Coordinate> = base.into_iter().chain(of(0)).chain(of(1)).collect();
        let x = DVector::from_fn(list.len(), |i, _| 0.1 * (i + 1) as f64);
        let found = point(&list, &candidates, &model(&list, &candidates, &x)).unwrap();
        assert!((found - &x).amax() < 1e-12);
        assert!(point(&list, &candidates[..1], &model(&list, &candidates, &x)).is_none());
        let others = [candidates[1], candidates[0]];
        assert!(point(&list, &others, &model(&list, &candidates, &x)).is_none());
    }
}
