//! Gains of the position loop in f64, and the continuous controller they stand for.

use protocol::message::Gains as Sent;
use serde::Serialize;

use crate::actuator::polynomial::Polynomial;

/// `kp + ki/s + kd n s/(s + n)` on the error (thesis section 5.5).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Gains {
    /// V/mm.
    pub kp: f64,
    /// V/(mm s).
    pub ki: f64,
    /// V s/mm.
    pub kd: f64,
    /// Corner of the derivative's filter, rad/s.
    pub n: f64,
}

impl From<Sent> for Gains {
    fn from(sent: Sent) -> Self {
        Self { kp: sent.kp.into(), ki: sent.ki.into(), kd: sent.kd.into(), n: sent.n.into() }
    }
}

/// The thesis' optimum (section 5.5).
pub const THESIS: Gains = Gains { kp: 3.661, ki: 14.1596, kd: 0.1787, n: 7.4936 };

impl Gains {
    /// As the link carries them.
    pub fn sent(&self) -> Sent {
        Sent { kp: self.kp as f32, ki: self.ki as f32, kd: self.kd as f32, n: self.n as f32 }
    }

    /// What the board computes with: the gains rounded to f32.
    #[must_use]
    pub fn rounded(&self) -> Self {
        self.sent().into()
    }

    /// Numerator and denominator of the controller in `s`, without common factors.
    pub fn continuous(&self) -> (Polynomial, Polynomial) {
        let Self { kp, ki, kd, n } = *self;
        match (ki == 0.0, kd == 0.0) {
            (false, false) => {
                (Polynomial::new(vec![ki * n, kp * n + ki, kp + kd * n]), Polynomial::new(vec![0.0, n, 1.0]))
            }
            (true, false) => (Polynomial::new(vec![kp * n, kp + kd * n]), Polynomial::new(vec![n, 1.0])),
            (false, true) => (Polynomial::new(vec![ki, kp]), Polynomial::new(vec![0.0, 1.0])),
            (true, true) => (Polynomial::new(vec![kp]), Polynomial::new(vec![1.0])),
        }
    }

    /// The same of the board's controller in `z` (backward Euler, `firmware::pid`), times `z^-ticks`.
    pub fn sampled(&self, tick_s: f64, ticks: usize) -> (Polynomial, Polynomial) {
        let Self { kp, ki, kd, n } = *self;
        let (i, d, q) = (ki * tick_s, kd * n, 1.0 + n * tick_s);
        let z = Polynomial::monomial(1.0, 1);
        let difference = Polynomial::new(vec![-1.0, 1.0]);
        let filter = Polynomial::new(vec![-1.0, q]);
        let late = Polynomial::monomial(1.0, ticks);
        let mut numerator = Polynomial::monomial(kp, 0);
        let mut denominator = Polynomial::monomial(1.0, 0);
        if ki != 0.0 {
            numerator = &(&numerator * &difference) + &z.scaled(i);
            denominator = difference.clone();
        }
        if kd != 0.0 {
            numerator = &(&numerator * &filter) + &(&denominator * &difference).scaled(d);
            denominator = &denominator * &filter;
        }
        let lead = denominator.leading();
        (numerator.scaled(1.0 / lead), (&denominator * &late).scaled(1.0 / lead))
    }
}
