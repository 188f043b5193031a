//! Host side of Palpate.

#![cfg_attr(not(test), deny(clippy::print_stdout, clippy::print_stderr))]

#[macro_use]
mod print;

pub mod actuator;
pub mod calibration;
pub mod cli;
pub mod control;
pub mod demo;
pub mod diagnose;
pub mod displacement;
pub mod experiment;
pub mod extended;
pub mod feel;
pub mod finger;
pub mod flash;
pub mod identify;
pub mod infer;
pub mod init;
pub mod link;
pub mod log;
pub mod magnet;
pub mod monitor;
mod ownership;
pub mod plant;
pub mod report;
pub mod response;
pub mod results;
pub mod selftest;
pub mod session;
mod signals;
pub mod simulate;
pub mod simulated_board;
pub mod study;
pub mod sweep;
pub mod tour;
pub mod track;
pub mod trial;
pub mod tune;
pub mod unseen;
