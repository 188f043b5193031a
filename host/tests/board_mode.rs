//! `palpate board mode` against a served board: the link is held until the press has ended, and the verdict is printed.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::process::{Command, Output};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use palpate::plant::Jitter;
use palpate::session::{Patience, Session};
use palpate::simulated_board::{SimulatedBoard, serve};
use protocol::lut::{AxisSpec, MaterialSpec, Role, Scale, TableSpec, axis_name};

const PALPATE: &str = env!("CARGO_BIN_EXE_palpate");

/// A table that the board accepts; the press ends without contact, which is a verdict too.
fn table() -> Vec<u8> {
    let axis = |name: &str, unit: &str, role, values: &[f64]| AxisSpec {
        name: name.into(),
        unit: unit.into(),
        role,
        scale: Scale::Listed,
        values: values.to_vec(),
    };
    let depths: Vec<f64> = (1..=200).map(|i| 4.0 * f64::from(i) / 200.0).collect();
    let alphas = [4.0, 8.0, 12.0];
    TableSpec {
        columns: alphas.iter().map(|a| depths.iter().map(|d| d.powf(1.5) * (1.0 + 0.01 * a * d)).collect()).collect(),
        axes: vec![
            axis(axis_name::DEPTH, "mm", Role::Row, &depths),
            axis(axis_name::ALPHA, "", Role::Column, &alphas),
            axis(axis_name::MU, "MPa", Role::Factor, &[0.01, 0.1, 0.3]),
        ],
        library: Vec::<MaterialSpec>::new(),
        discretisation: 0.001,
        interpolation: 0.001,
        provenance: "for a test of board mode".into(),
    }
    .to_bytes()
    .unwrap()
}

fn mode(board: &str, words: &[&str]) -> Output {
    Command::new(PALPATE).args(["board", "--board", board, "--json", "mode"]).args(words).output().unwrap()
}

#[test]
fn a_press_is_waited_for_and_its_verdict_printed() {
    let server = serve("127.0.0.1:0", SimulatedBoard::new(1, Jitter::NONE)).unwrap();
    let board = format!("tcp:{}", server.address().unwrap());
    let stop = Arc::new(AtomicBool::new(false));
    let stopped = Arc::clone(&stop);
    let served = std::thread::spawn(move || server.run(|_| {}, || !stopped.load(Ordering::Relaxed)));
    {
        let link = palpate::link::open(&board.parse().unwrap()).unwrap();
        let (mut session, _) = Session::open(link, Patience::default()).unwrap();
        session.upload(&table(), |_| {}).unwrap();
    }
    let refused = mode(&board, &["palpate", "--rate", "9"]);
    assert_eq!(refused.status.code(), Some(2));
    let late = mode(&board, &["palpate", "--timeout", "0.5"]);
    let told = String::from_utf8_lossy(&late.stderr).split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(late.status.code() == Some(2) && told.contains("no verdict within 0.5 s"), "{told}");
    assert!(told.contains("--timeout"), "{told}");

    let done = mode(&board, &["palpate", "--rate", "4"]);
    let told = String::from_utf8_lossy(&done.stderr).into_owned();
    assert_eq!(done.status.code(), Some(0), "{told}");
    let answer: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
    assert_eq!(answer["verdict"]["outcome"], "NoContact", "{answer}");
    let status = Command::new(PALPATE).args(["board", "--board", &board, "--json", "status"]).output().unwrap();
    let status: serde_json::Value = serde_json::from_slice(&status.stdout).unwrap();
    assert_eq!((status["state"].as_str(), status["faults"].as_array().map(Vec::len)), (Some("Idle"), Some(0)));
    stop.store(true, Ordering::Relaxed);
    served.join().unwrap();
}
