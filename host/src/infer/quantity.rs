//! A parameter of an effect: what it may be, and what is known of it beforehand.

use super::evidence::{Parameter, Prior};

/// A parameter of an effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantity {
    /// Name in answers, with its unit.
    pub name: &'static str,
    /// Value at which the effect is absent; none for a shape, whose amplitude is then null.
    pub null: Option<f64>,
    /// Least and largest value that is physically possible.
    pub bounds: (f64, f64),
    /// An amount that is met: half of all rigs have less, and what a design cannot see of it is a blind spot.
    pub plausible: f64,
    /// Values from which a search begins.
    pub starts: &'static [f64],
    /// Searched in its logarithm.
    pub logarithmic: bool,
}

impl Quantity {
    /// An amount that is absent at nothing.
    #[must_use]
    pub const fn amount(name: &'static str, bounds: (f64, f64), plausible: f64, starts: &'static [f64]) -> Self {
        Self { name, null: Some(0.0), bounds, plausible, starts, logarithmic: false }
    }

    /// The coordinate of a value.
    #[must_use]
    pub fn of(&self, value: f64) -> f64 {
        place(self.logarithmic, value)
    }

    /// Least and largest coordinate.
    #[must_use]
    pub fn ends(&self) -> (f64, f64) {
        (self.of(self.bounds.0), self.of(self.bounds.1))
    }

    /// What is known of it beforehand, as a coordinate: mostly less than the plausible amount, and once in a
    /// while much more; of a shape its bounds are known.
    #[must_use]
    pub fn known(&self) -> Prior {
        match self.null.map(|null| self.of(null)) {
            Some(null) => Prior::Cauchy { null, scale: (self.of(self.plausible) - null).abs() },
            None => Prior::between(self.ends()),
        }
    }

    /// True for an amount of one sign.
    #[must_use]
    pub fn is_one_sided(&self) -> bool {
        self.null.is_some_and(|null| self.bounds.0 >= null || self.bounds.1 <= null)
    }

    /// The amount of an effect in plausible ones, of the first of its quantities that has a null.
    #[must_use]
    pub fn in_plausible_ones(all: &[Self]) -> Parameter {
        let amount = all.iter().find_map(|q| {
            let null = q.of(q.null?);
            let (low, high) = q.ends();
            let plausible = q.of(q.plausible) - null;
            Some(Parameter::in_units(plausible, (low - null, high - null), plausible))
        });
        amount.unwrap_or(Parameter::in_units(1.0, (0.0, f64::MAX), 1.0))
    }

    /// Every combination of some values of each of an effect's quantities.
    #[must_use]
    pub fn combined(all: &[Self], of: impl Fn(&Self) -> Vec<f64>) -> Vec<Vec<f64>> {
        all.iter().map(of).fold(vec![Vec::new()], |lists: Vec<Vec<f64>>, values| {
            lists.iter().flat_map(|list| values.iter().map(|v| [list.as_slice(), &[*v]].concat())).collect()
        })
    }

    /// Its values at plausible amounts, and at every start of a shape.
    #[must_use]
    pub fn plausible_values(&self) -> Vec<f64> {
        if self.null.is_some() { vec![self.plausible] } else { self.starts.to_vec() }
    }
}

/// A parameter as it is searched.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coordinate {
    /// Name in answers, with its unit.
    pub name: &'static str,
    /// Least and largest place.
    pub ends: (f64, f64),
    /// Searched in its logarithm.
    pub logarithmic: bool,
    /// What is known of it beforehand.
    pub prior: Prior,
    /// Where its effect is absent; none of what belongs to no effect, and of a shape.
    pub null: Option<f64>,
    /// Step of a difference quotient.
    pub step: f64,
}

impl Coordinate {
    /// Of an effect's quantity, with the step of its difference quotients.
    #[must_use]
    pub fn of_quantity(q: &Quantity, step: f64) -> Self {
        let null = q.null.map(|null| q.of(null));
        Self { name: q.name, ends: q.ends(), logarithmic: q.logarithmic, prior: q.known(), null, step }
    }

    /// The place of a value.
    #[must_use]
    pub fn of(&self, value: f64) -> f64 {
        place(self.logarithmic, value)
    }

    /// The value of a place.
    #[must_use]
    pub fn value(&self, x: f64) -> f64 {
        if self.logarithmic { x.exp() } else { x }
    }

    /// The parameter of a model that is linearised at a place.
    #[must_use]
    pub fn at(&self, x: f64) -> Parameter {
        Parameter { x, bounds: self.ends, prior: self.prior }
    }

    /// The value of a place, and those to both sides of it, no farther than the ends.
    #[must_use]
    pub fn estimate(&self, x: f64, half: f64) -> (&'static str, f64, (f64, f64)) {
        let (low, high) = self.ends;
        (self.name, self.value(x), (self.value((x - half).max(low)), self.value((x + half).min(high))))
    }

    /// True for a place within a thousandth of the way of an end at which its effect is something.
    #[must_use]
    pub fn is_at_bound(&self, x: f64) -> bool {
        let (low, high) = self.ends;
        let near = 1e-3 * (high - low);
        let is_null = |end: f64| self.null.is_some_and(|null| (null - end).abs() < near);
        (x - low < near && !is_null(low)) || (high - x < near && !is_null(high))
    }
}

/// The place of a value, in its logarithm or not.
fn place(logarithmic: bool, value: f64) -> f64 {
    if logarithmic { value.max(f64::MIN_POSITIVE).ln() } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AMOUNT: Quantity = Quantity::amount("a", (0.0, 1.0), 0.1, &[0.1, 0.3]);
    const SHAPE: Quantity =
        Quantity { name: "t", null: None, bounds: (0.1, 10.0), plausible: 1.0, starts: &[0.5, 2.0], logarithmic: true };

    #[test]
    fn amounts_are_about_nothing_and_shapes_between_their_bounds() {
        assert_eq!(AMOUNT.known(), Prior::Cauchy { null: 0.0, scale: 0.1 });
        assert_eq!(SHAPE.known(), Prior::between((0.1_f64.ln(), 10.0_f64.ln())));
        assert!(AMOUNT.is_one_sided() && !SHAPE.is_one_sided());
        let unit = Quantity::in_plausible_ones(&[SHAPE, AMOUNT]);
        assert_eq!((unit.x, unit.bounds), (0.0, (0.0, 10.0)));
    }

    #[test]
    fn all_starts_are_combined() {
        let all = Quantity::combined(&[AMOUNT, SHAPE], |q| q.starts.to_vec());
        assert_eq!(all, [[0.1, 0.5], [0.1, 2.0], [0.3, 0.5], [0.3, 2.0]]);
        assert_eq!(Quantity::combined(&[AMOUNT, SHAPE], Quantity::plausible_values), [[0.1, 0.5], [0.1, 2.0]]);
    }
}
