#![allow(clippy::unwrap_used)]
use std::path::Path;

use super::uncertain::Coefficient;
use super::*;

const COEFFICIENTS: &str = r#"title = "bench"
source = "by hand"
delay_s = 0.01
rate_limit_mm_per_s = 25
friction_v = 0.03
interval95 = { delay_s = [0.008, 0.012], friction_v = [0.0, 0.05] }
[plant]
numerator = [172]
denominator = [2, 46.8, 172]
interval95 = { numerator = [[170, 174]], denominator = [[2, 2], [40, 50], [160, 180]] }
"#;

const POLES: &str = "[plant]\ngain = 2.0\npoles_per_s = [-10.0, [-5.0, 3.0]]\n\
                     interval95 = { gain = [1.9, 2.1], poles_per_s = [[-11.0, -9.0], [[-5.5, -4.5], [2.5, 3.5]]] }\n";

fn read(text: &str) -> Actuator {
    parse(Path::new("actuator.toml"), text).unwrap()
}

#[test]
fn a_file_is_read_and_written_as_the_same_actuator() {
    for text in [COEFFICIENTS, POLES, "[plant]\ngain = 5\npoles_per_s = [0.0]\n"] {
        let actuator = read(text);
        assert_eq!(read(&actuator.to_toml()), actuator, "{}", actuator.to_toml());
    }
    assert_eq!(read(&Actuator::thesis().to_toml()), Actuator::thesis());
}

#[test]
fn coefficients_become_monic_with_their_intervals() {
    let actuator = read(COEFFICIENTS);
    let plant = actuator.plant();
    assert_eq!((plant.numerator.at(0), plant.denominator.at(1), plant.delay_s), (86.0, 23.4, 0.01));
    let uncertain = actuator.uncertain(0.1);
    assert_eq!(
        uncertain.bounds,
        [
            (Coefficient::Numerator(0), 85.0, 87.0),
            (Coefficient::Denominator(0), 80.0, 90.0),
            (Coefficient::Denominator(1), 20.0, 25.0),
            (Coefficient::Delay, 0.008, 0.012),
        ]
    );
    assert_eq!(actuator.flaws().friction_v, 0.03);
}

/// `2 / ((1 + s/10) (s^2 + 10 s + 34)/34)`: gain at rest and poles are those of the file, and no combination is outside the box.
#[test]
fn gain_and_poles_become_coefficients() {
    let actuator = read(POLES);
    let plant = actuator.plant();
    let near = |a: f64, b: f64| (a - b).abs() < 1e-9 * b.abs();
    assert!(near(plant.numerator.at(0) / plant.denominator.at(0), 2.0) && near(plant.denominator.at(0), 340.0));
    let uncertain = actuator.uncertain(0.1);
    let bound = |i: usize| uncertain.bounds.iter().find(|b| b.0 == Coefficient::Denominator(i)).copied().unwrap();
    for p in [9.0, 10.0, 11.0] {
        for re in [4.5f64, 5.2, 5.5] {
            for im in [2.5f64, 3.1, 3.5] {
                let square = re * re + im * im;
                for (i, value) in [(0, p * square), (1, square + 2.0 * re * p), (2, p + 2.0 * re)] {
                    let (_, low, high) = bound(i);
                    assert!(low <= value + 1e-9 && value <= high + 1e-9, "{i}: {value} in {low}..{high}");
                }
            }
        }
    }
}

#[test]
fn an_integrating_spindle_has_its_gain_a_second() {
    let plant = read("[plant]\ngain = 5\npoles_per_s = [0.0, -20.0]\n").plant();
    // 5 / (s (1 + s/20)) = 100 / (s^2 + 20 s)
    assert_eq!((plant.numerator.at(0), plant.denominator.coefficients()), (100.0, &[0.0, 20.0, 1.0][..]));
}

#[test]
fn mistakes_are_told_with_their_place() {
    for (text, expected) in [
        ("title = 3\n", "plant"),
        ("[plant]\nnumerator = [1]\n", "denominator"),
        ("[plant]\nnumerator = [1, 2, 3]\ndenominator = [1, 2]\n", "numerator has 3 numbers; expected 1 to 1"),
        ("[plant]\nnumerator = [1]\ndenominator = [0, 2]\n", "expected 1 to 6, the first number not 0"),
        ("[plant]\ngain = 1\npoles_per_s = [0.0, 0.0]\n", "at most one of them 0"),
        ("[plant]\ngain = 1\npoles_per_s = [[-1, -2]]\n", "[real, imaginary] of a pair"),
        (
            "[plant]\ngain = 1\npoles_per_s = [-4]\ninterval95 = { poles_per_s = [[-3, -2]] }\n",
            "intervals with their poles inside",
        ),
        ("delay_s = 2\n[plant]\ngain = 1\npoles_per_s = [-4]\n", "a dead time of 0 to 1 s"),
        (
            "delay_s = 0.1\ninterval95 = { delay_s = [0.2, 0.3] }\n[plant]\ngain = 1\npoles_per_s = [-4]\n",
            "the value between them",
        ),
        ("interval95 = { friction_v = [0.2, 0.3] }\n[plant]\ngain = 1\npoles_per_s = [-4]\n", "friction_v"),
        ("rate_limit_mm_per_s = 0\n[plant]\ngain = 1\npoles_per_s = [-4]\n", "the shaft cannot move"),
        (
            "friction_v = 0.1\n[plant]\nnumerator = [1, 1]\ndenominator = [1, 2, 3]\n",
            "need a plant whose numerator is a number",
        ),
        ("[plant]\ngain = 1\npole = [-4]\n", "poles_per_s"),
    ] {
        let error = parse(Path::new("actuator.toml"), text).unwrap_err().to_string();
        assert!(error.contains(expected) && error.contains("actuator.toml"), "{text}: {error}");
    }
}
