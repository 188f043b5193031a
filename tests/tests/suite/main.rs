//! What no single crate can test, in one binary: it links once and its tests share both cores.
//! One file of it: `cargo test -p tests --test suite coupons::`.

mod blind_recovery;
mod board_surface;
mod bounding;
mod cases;
mod cases_of_others;
mod compressions;
mod control_curves;
mod coupons;
mod demo_chain;
mod diagnose_hidden;
mod display_finger;
mod display_hidden;
mod experiment_errors;
mod experiment_modes;
mod extended_model;
mod finger_prints;
mod gain_jitter;
mod golden_protocol;
mod identify_modes;
mod identify_newton;
mod identify_outcomes;
mod identify_recovers;
mod init;
mod link_conversation;
mod logs_recovery;
mod magnets;
mod monitor_screens;
mod monitor_worker;
mod real_modes;
mod real_recordings;
mod reference_curves;
mod relaxing_filter;
mod robustness;
mod rubber_platens;
mod same_bits;
mod six_parameters;
mod tables;
mod thesis_recognition;
mod tuning;
mod unseen_effects;
mod whole_paths;
mod winding;
mod without_specimen;

use std::sync::LazyLock;

use palpate::diagnose::Models;
use palpate::simulate::Solver;

/// Shared by all files, so that every force model and every solve is made once.
static MODELS: LazyLock<Models> = LazyLock::new(Models::default);
static SOLVER: LazyLock<Solver> = LazyLock::new(Solver::new);
