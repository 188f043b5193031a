//! Gains of the position loop as an option.

use firmware::pid::{GAIN_CEILING, gains_are_usable};
use protocol::message;

use crate::tune::Gains;

/// Four finite numbers with commas.
fn four(text: &str) -> Result<Gains, String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|number| number.trim().parse()).collect();
    match numbers.as_deref() {
        Ok(&[kp, ki, kd, n]) if [kp, ki, kd, n].iter().all(|x| x.is_finite()) => Ok(Gains { kp, ki, kd, n }),
        _ => Err("expected four numbers with commas, KP,KI,KD,N".to_owned()),
    }
}

/// Gains of any loop.
///
/// # Errors
/// What is no gain, as clap shows it.
pub(super) fn given(text: &str) -> Result<Gains, String> {
    let gains = four(text)?;
    let Gains { kp, ki, kd, n } = gains;
    if kp < 0.0 || ki < 0.0 || kd < 0.0 || n <= 0.0 {
        return Err("expected none that is negative, the last above 0".to_owned());
    }
    Ok(gains)
}

/// Gains that a board takes.
///
/// # Errors
/// What is no gain, or beyond the board's limits, as clap shows it.
pub(super) fn of_a_board(text: &str) -> Result<message::Gains, String> {
    let gains = four(text)?.sent();
    if !gains_are_usable(&gains) {
        let message::Gains { kp, ki, kd, n } = GAIN_CEILING;
        return Err(format!("no board takes these; expected 0 to {kp}, {ki} and {kd}, and N more than 0 to {n}"));
    }
    Ok(gains)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn what_is_no_gain_is_told() {
        for (text, expected) in [
            ("1,2,3", "expected four numbers with commas"),
            ("1,2,3,x", "expected four numbers with commas"),
            ("1,2,-3,4", "expected none that is negative"),
            ("1,2,3,0", "the last above 0"),
            ("1,2,3,inf", "expected four numbers"),
        ] {
            let told = given(text).unwrap_err();
            assert!(told.contains(expected), "{text}: {told}");
        }
        for text in ["1e6,2,3,4", "1,2,-3,4", "1,2,3,0"] {
            let told = of_a_board(text).unwrap_err();
            assert!(told.contains("no board takes these; expected 0 to"), "{text}: {told}");
        }
    }

    #[test]
    fn gains_are_read() {
        assert_eq!(given(" 1, 0,0 ,50").unwrap(), Gains { kp: 1.0, ki: 0.0, kd: 0.0, n: 50.0 });
        assert_eq!(of_a_board("1,0.5,0,50").unwrap().ki, 0.5);
    }
}
